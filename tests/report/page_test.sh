#!/usr/bin/env bash
# Opens reports in Chromium: page_test.sh SOURCES WORK [LACUNA [LARGE_RUN]]
# Runs the tests of tests/report/page, with their dependencies installed in WORK. With the program
# LACUNA, a coarse model is fitted to the bundled recording and compared with it, and the tests that
# suit any report open the report that was written. With LARGE_RUN (large_run.cc) too, the reports of
# two large motions are written and opened, and what that takes is printed. Ends with 77 (skipped)
# where a tool is absent.
set -euo pipefail
sources=$1
work=$2
only=()
skip() { echo "page_test.sh: skipped: $1" >&2; exit 77; }
chromium=${CHROMIUM:-$(command -v chromium || true)}
[[ -n $chromium ]] || skip "there is no chromium; apt-get install chromium"
command -v node >/dev/null && command -v npm >/dev/null ||
  skip "there is no node or no npm; apt-get install nodejs npm"
major=$(node -p 'process.versions.node.split(".")[0]')
((major >= 18)) || skip "node $major is too old; 18 is needed"

# The tests find the page by its place relative to them.
tests=$work/tests/report/page
mkdir -p "$tests" "$work/src/report"
ln -sfn "$sources/src/report/page" "$work/src/report/page"
cp "$sources"/tests/report/page/{*.mjs,package.json,package-lock.json} "$tests"
cd "$tests"
if ! cmp -s package-lock.json node_modules/.installed; then
  npm ci --no-audit --no-fund --loglevel=error || skip "npm cannot install playwright-core"
  cp package-lock.json node_modules/.installed
fi

if (($# > 3)); then
  for size in 10000x30 100000x100; do
    "$4" "$work/$size" "${size%x*}" "${size#*x}"
    "$3" report --quiet "$work/$size" --output "$work/report_of_$size.html"
  done
  export LACUNA_LARGE_REPORTS=$work/report_of_10000x30.html:$work/report_of_100000x100.html
  only=(--test-name-pattern='a large report')
elif (($# > 2)); then
  cat >"$work/coarse.yaml" <<EXPERIMENT
use: $sources/experiments/hidden_effect.yaml
output: run
mesh: {max_volume: 4000 mm^3, order: 2, preserve_surface: false}
motion: {time_step: 6 ms}
EXPERIMENT
  "$3" fit --quiet "$work/coarse.yaml"
  "$3" compare --quiet "$work/run"
  cp "$work/run/report.html" "$work/report_of_a_run.html"
  export LACUNA_REPORT_FILES=$work/report_of_a_run.html
  only=(--test-name-pattern=report_of_a_run)
fi
CHROMIUM=$chromium exec node --test "${only[@]}" report_page.test.mjs
