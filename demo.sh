#!/usr/bin/env bash
# Builds what is needed, reconstructs the bundled recording of a bent soft bar, and then finds what
# the model of a second bar lacks. Further arguments go to the first command; run again, it resumes.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
if [[ -x build.sh ]]; then
  ./build.sh lacuna
  lacuna=build/release/src/app/lacuna
else  # in a copy of the installed examples
  lacuna=lacuna
fi
"$lacuna" reconstruct experiments/bend.yaml "$@"

# Its physics is known to experiments/recordings/hidden_effect/truth.json alone, which nothing reads.
echo
echo "A bar that does what its model does not: experiments/hidden_effect.yaml"
"$lacuna" fit experiments/hidden_effect.yaml
"$lacuna" compare results/hidden_effect --files-only
"$lacuna" diagnose results/hidden_effect --until-done
