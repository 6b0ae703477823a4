#!/usr/bin/env bash
# Installs into a temporary folder and builds a program there that knows nothing but
# find_package(Lacuna): consumer_test.sh SOURCE BUILD
# The program predicts and fits; the installed lacuna must agree with it. The installed folder is
# moved first: nothing in it may depend on where it was installed.
set -euo pipefail
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "$*" >&2; exit 1; }

# The list of what an installation by hand has installed stays.
manifest=$build/install_manifest.txt
[[ ! -f $manifest ]] || cp -p "$manifest" "$work/install_manifest.txt"
cmake --install "$build" --prefix "$work/first" >"$work/install.log" ||
  fail "$(tail "$work/install.log")"
rm -f "$manifest"
[[ ! -f $work/install_manifest.txt ]] || cp -p "$work/install_manifest.txt" "$manifest"
mv "$work/first" "$work/prefix"
prefix=$work/prefix
if grep -rlF -e "$source" -e "$build" "$prefix" --include='*.cmake' --include='*.h'; then
  fail "these installed files refer to the source tree"
fi

cmake -G Ninja -S "$source/tests/package/consumer" -B "$work/consumer" \
  -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release >"$work/configure.log" 2>&1 ||
  fail "$(cat "$work/configure.log")"
cmake --build "$work/consumer"

# The examples of the installation, in a copy to which runs can write.
cp -r "$prefix/share/lacuna/examples" "$work/examples"
sed s/EXPERIMENTS/experiments/ "$source/tests/package/small.yaml.in" >"$work/examples/small.yaml"
cd "$work/examples"
"$work/consumer/consumer" small.yaml | tee "$work/numbers"
stretch=$(awk '/stretch/ {print $2}' "$work/numbers")
modulus=$(awk '/young/ {print $2}' "$work/numbers")

# ρ g L² / (2 E) = 1.962 mm for a small strain; at the 2 % strain of the upper end, the law's
# nonlinearity changes this by less than 3 %.
awk -v s="$stretch" 'BEGIN { exit !(s > 1.90 && s < 2.02) }' || fail "stretch: $stretch mm"

# A fit by the installed program gives the same bytes.
mv run again
"$prefix/bin/lacuna" fit small.yaml --quiet --no-report
cmp run/calibration/calibration.json again/calibration/calibration.json
grep -q "\"value\": ${modulus%.*}" run/calibration/calibration.json || fail "modulus: $modulus"
"$prefix/bin/lacuna-trials" --help >/dev/null
echo "installed programs and libraries agree"
