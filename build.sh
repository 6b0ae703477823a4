#!/usr/bin/env bash
# Installs what is missing, configures and builds: ./build.sh [target...]
# Says nothing when there is nothing to do.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
build=build/release

if ! command -v dpkg-query apt-get >/dev/null; then
  echo "build.sh: this is not Debian; install what third_party_notes/debian-packages.txt names," \
       "then run: cmake --workflow --preset release" >&2
  exit 1
fi
mapfile -t wanted < third_party_notes/debian-packages.txt
# Everything, tests included: these open a page in a browser and run exported models. Node need not
# be Debian's.
if (($# == 0)); then
  while read -r package; do
    command -v "${package/nodejs/node}" >/dev/null || wanted+=("$package")
  done < third_party_notes/debian-test-packages.txt
fi
installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
            sed -n 's/^installed //p') || true
mapfile -t missing < <(printf '%s\n' "${wanted[@]}" | grep -vxF -f <(printf '%s\n' "$installed"))
if ((${#missing[@]} > 0)); then
  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}"
fi

# A build folder that was moved, or whose configuration was interrupted, is configured afresh.
if [[ ! -f $build/build.ninja ]] ||
   ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$build/CMakeCache.txt"; then
  mkdir -p "$build"
  echo "Configuring $build"
  if ! cmake --preset release --fresh >"$build/configure.log" 2>&1; then
    cat "$build/configure.log" >&2
    exit 1
  fi
fi

# PCL and CGAL want up to 2 GB for one file: fewer jobs than cores where memory is short.
jobs=$(awk -v cores="$(nproc)" '/^MemAvailable/ {
  jobs = int($2 / 2e6); print jobs < 1 ? 1 : (jobs < cores ? jobs : cores) }' /proc/meminfo)
if ! ninja -C "$build" -n "$@" | grep -q 'no work to do'; then
  ninja -C "$build" -j "$jobs" "$@"
fi
