#!/bin/sh
# Runs every fuzzer for a number of inputs, beginning with its corpus:
#   tests/fuzz/run_all.sh build/fuzz 100000
# An input may take 5 s and 2 GB. Inputs at which a reader fails are kept, with the fuzzer's output,
# in a folder that is named at the end; the exit status is then 1.
set -u
if [ $# -ne 2 ]; then
  echo "usage: $0 BUILD RUNS" >&2
  exit 2
fi
: "${TMPDIR:=/dev/shm}"  # Some readers need temporary files.
export TMPDIR
build=$1
runs=$2
here=$(dirname "$0")
kept=$(mktemp -d)
ran=0
failed=0
for corpus in "$here"/corpus/*/; do
  name=$(basename "$corpus")
  program=$build/tests/fuzz/fuzz_$name
  if [ ! -x "$program" ]; then
    echo "$name: there is no $program; cmake --build --preset fuzz makes it" >&2
    failed=$((failed + 1))
    continue
  fi
  ran=$((ran + 1))
  found=$(mktemp -d)
  if "$program" -runs="$runs" -timeout=5 -rss_limit_mb=2048 -max_len=4096 \
    -artifact_prefix="$kept/${name}_" "$found" "$corpus" >"$kept/$name.log" 2>&1; then
    echo "$name: no failure"
    rm "$kept/$name.log"
  else
    echo "$name: FAILED"
    tail -n 5 "$kept/$name.log"
    failed=$((failed + 1))
  fi
  rm -r "$found"
done
echo "$ran fuzzers ran with $runs inputs each; $failed failed or are missing"
if [ "$failed" -eq 0 ]; then
  rm -r "$kept"
else
  echo "inputs and outputs: $kept"
  exit 1
fi
