#!/usr/bin/env bash
# Makes the Debian packages and uses what is in them, unpacked: deb_test.sh BUILD
set -euo pipefail
build=$1
for tool in dpkg-deb dpkg-shlibdeps file; do
  command -v "$tool" >/dev/null || { echo "$tool is not installed"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

(cd "$build" && cpack -G DEB -B "$work" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip) >"$work/log" 2>&1 ||
  fail "$(cat "$work/log")"
for package in "$work"/*.deb; do
  name=$(dpkg-deb -f "$package" Package)
  dpkg-deb -x "$package" "$work/root"
  [[ -n $(dpkg-deb -f "$package" Depends) ]] || fail "$name depends on nothing"
  [[ -f $work/root/usr/share/doc/$name/copyright ]] || fail "$name has no copyright"
  dpkg-deb -c "$package" | awk '$1 !~ /^(-rw-r--r--|-rwxr-xr-x|drwxr-xr-x)$/ || $2 != "root/root"' \
    >"$work/modes"
  [[ ! -s $work/modes ]] || fail "$name: modes or owners: $(head -n 3 "$work/modes")"
done
# The libraries that the program is linked to come from the packages that it depends on.
depends=$(dpkg-deb -f "$work"/lacuna_*.deb Depends)
for library in libvtk9.1 libtet1.5 libopenblas0 libpcl-io1.13 libyaml-cpp0.7; do
  [[ $depends == *"$library"* ]] || fail "lacuna does not depend on $library"
done

cd "$work/root/usr"
version=$(dpkg-deb -f "$work"/lacuna_*.deb Version)
[[ $(bin/lacuna --version) == "$version" ]] || fail "lacuna --version: $(bin/lacuna --version)"
bin/lacuna validate share/lacuna/examples/experiments/hidden_effect.yaml
bin/lacuna validate share/lacuna/examples/experiments/bend.yaml
gzip -dc share/man/man1/lacuna.1.gz | grep -q '^\.SH COMMANDS'
[[ -f share/bash-completion/completions/lacuna && -f share/zsh/vendor-completions/_lacuna ]]
if [[ -d lib/python3/dist-packages/lacuna ]]; then
  PYTHONPATH=lib/python3/dist-packages /usr/bin/python3 -c '
import lacuna
assert lacuna.program().endswith("/usr/bin/lacuna"), lacuna.program()
print("python3-lacuna", lacuna.__version__)'
fi
