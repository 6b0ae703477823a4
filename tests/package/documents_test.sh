#!/usr/bin/env bash
# What is generated from the command line: documents_test.sh man|bash|zsh FOLDER LACUNA
# The scripts are loaded by the shells themselves, which then complete lines as for a user.
set -euo pipefail
kind=$1 documents=$2 lacuna=$3
failures=0

expect() {  # expect WHAT WANTED FOUND
  [[ $2 == "$3" ]] && return
  printf '%s\n  expected: %s\n  found:    %s\n' "$1" "$2" "$3" >&2
  failures=$((failures + 1))
}

commands_of() {  # the commands that `lacuna ... --help` lists
  "$lacuna" "$@" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9]\+\) .*/\1/p'
}

check_man() {
  local page=$documents/lacuna.1 command option section commands
  mapfile -t commands < <(commands_of; commands_of sweep | sed 's/^/sweep /')
  ((${#commands[@]} > 15)) || expect "commands of --help" "more than 15" "${#commands[@]}"
  for command in "${commands[@]}"; do
    expect "a section for $command" 1 "$(grep -cx "\.SS $command" "$page")"
    section=$(sed -n "/^\.SS $command\$/,/^\.S/p" "$page")
    # shellcheck disable=SC2086
    for option in $("$lacuna" $command --help | grep -oE '^  (-[a-z],)?--[a-z0-9-]+' |
                    sed 's/.*--/--/'); do
      [[ $section == *"${option//-/\\-}\\fR"* ]] || expect "$command" "$option" "not on the page"
    done
  done
  # Nothing on the page may be a request of roff by accident.
  expect "requests" ".PP .SH .SS .TH .TP .fi .nf" \
    "$(grep -oE '^\.[A-Za-z]+' "$page" | sort -u | paste -sd ' ')"
  if command -v mandoc >/dev/null; then
    expect "mandoc's warnings" "" \
      "$(mandoc -T lint -W warning "$page" | grep -v 'missing date' || true)"
  fi
}

# What bash offers for the last of the words.
offered() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  "$(complete -p "$1" | sed 's/.*-F \([^ ]*\) .*/\1/')"
  printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort | paste -sd ' '
}

check_bash() {
  # shellcheck disable=SC1091
  source "$documents/lacuna.bash"
  # shellcheck disable=SC1091
  source "$documents/lacuna-trials.bash"
  expect "lacuna fi" "figures fit" "$(offered lacuna fi)"
  expect "lacuna" "$(commands_of | LC_ALL=C sort | paste -sd ' ')" "$(offered lacuna '')"
  expect "lacuna sweep" "collect plan run" "$(offered lacuna sweep '')"
  expect "lacuna sweep run --l" "--launcher" "$(offered lacuna sweep run --l)"
  expect "values" "local slurm" "$(offered lacuna sweep run --launcher '')"
  expect "values after =" "slurm" "$(offered lacuna sweep run --launcher = s)"
  expect "no command where a file is expected" "" "$(offered lacuna fit f)"
  expect "an option of another command" "" "$(offered lacuna fit --unt)"
  expect "an option of this command" "--until-done" "$(offered lacuna diagnose RUN --unt)"
  expect "lacuna-trials re" "redecide report" "$(offered lacuna-trials re)"
}

check_zsh() {
  command -v zsh >/dev/null || { echo "zsh is not installed"; exit 77; }
  # A zsh on a terminal of its own, into which the line and a tab are typed.
  typed() {
    zsh -f -c '
      zmodload zsh/zpty
      zpty -b shell "TERM=dumb PS1=ready\> zsh -f -i"
      say() { zpty -w shell "$1" }
      say "stty -echo cols 200; fpath=($1 \$fpath); autoload -Uz compinit; compinit -u -D"
      say "setopt noautomenu nolistbeep; bindkey \"^I\" complete-word; LISTMAX=0"
      # The offers are printed rather than drawn.
      say "compadd() {
        builtin compadd -O offers \"\$@\"
        (( \$#offers )) && print -rl -- offered:\$^offers >&3
        builtin compadd \"\$@\"
      }"
      say "exec 3>$3; print loaded\\d"
      zpty -r shell text "*loadedd*"
      zpty -w -n shell "$2"$'"'\\t'"'
      for i in {1..50}; do sleep 0.1; [[ -s $3 ]] && break; done
      sleep 0.2
      zpty -d shell
    ' zsh "$documents" "$1" "$work/offers" >/dev/null 2>&1 || true
    sed -n 's/^offered://p' "$work/offers" | LC_ALL=C sort -u | paste -sd ' '
    rm -f "$work/offers"
  }
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  expect "lacuna fi" "figures fit" "$(typed 'lacuna fi')"
  expect "lacuna sweep" "collect plan run" "$(typed 'lacuna sweep ')"
  expect "values" "local slurm" "$(typed 'lacuna sweep run --launcher ')"
  expect "lacuna diagnose --unt" "--until-done" "$(typed 'lacuna diagnose --unt')"
  expect "an option that may be repeated" "--case" "$(typed 'lacuna sweep run --case 1 --ca')"
}

"check_$kind"
((failures == 0))
