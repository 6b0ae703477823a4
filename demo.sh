#!/usr/bin/env bash
# Builds what is needed and reconstructs the bundled recording of a bent soft bar.
# Further arguments go to the command; run again, it resumes.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
./build.sh lacuna
exec build/release/src/app/lacuna reconstruct experiments/bend.yaml "$@"
