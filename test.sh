#!/usr/bin/env bash
# Builds everything and runs the tests; further arguments go to ctest, e.g. ./test.sh -R Npy
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
./build.sh
report=$PWD/build/release/tests.xml
rm -f "$report"
status=0
ctest --test-dir build/release -j 2 --output-on-failure --no-tests=error \
  --output-junit "$report" "$@" || status=$?
[[ -f $report ]] || exit "$status"

# What neither passed nor skipped itself has failed, tests that could not be started among them.
tests=$(sed -n 's/^[[:space:]]*tests="\([0-9]*\)".*/\1/p' "$report" | head -n 1)
passed=$(grep -c 'status="run"' "$report") || true
skipped=$(grep -c '<skipped message="SKIP_' "$report") || true
echo "$passed passed, $((tests - passed - skipped)) failed, $skipped skipped"
exit "$status"
