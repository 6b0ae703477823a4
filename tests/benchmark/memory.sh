#!/bin/bash
# Prints the largest memory that each command occupies, as rows of a Markdown table:
#   tests/benchmark/memory.sh LACUNA STATIC_CASE
# for the demo, and for static cases (static_case.cc) of about 29 000, 60 000 and 190 000 tetrahedra.
# LACUNA and STATIC_CASE are the programs. Needs GNU time. Takes half an hour of processor time.
set -euo pipefail
lacuna=$(realpath "$1")
static_case=$(realpath "$2")
source=$(realpath "$(dirname "$0")/../..")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# row BODY COMMAND ARGUMENT...
row() {
  local body=$1
  shift
  /usr/bin/time -o "$folder/time" -f '%M %U %S' "$lacuna" "$@" > "$folder/output" 2>&1 || {
    cat "$folder/output" >&2
    exit 1
  }
  awk -v body="$body" -v command="$1" \
    '{ printf "| %s | %s | %.0f MB | %.0f s |\n", body, command, $1 / 1024, $2 + $3 }' "$folder/time"
}

# commands BODY EXPERIMENT RUN
commands() {
  row "$1" validate "$2"
  row "$1" fit "$2" --no-report
  row "$1" compare "$3" --no-report
  row "$1" report "$3"
  row "$1" export "$3" --to msh --allow-missing
}

echo '| body | command | memory | processor time |'
echo '|---|---|---|---|'
cp -r "$source/experiments" "$folder/experiments"
commands demo "$folder/experiments/hidden_effect.yaml" "$folder/results/hidden_effect"
row demo diagnose "$folder/results/hidden_effect" --no-report
row bend reconstruct "$folder/experiments/bend.yaml" --no-report
for volume in 2.6 1.2 0.37; do
  "$static_case" "$folder/$volume"
  sed -i "s/max_volume: [0-9.]* mm^3/max_volume: $volume mm^3/" "$folder/$volume/experiment.yaml"
  commands "$volume mm³" "$folder/$volume/experiment.yaml" "$folder/$volume/run"
done
