#!/usr/bin/env bash
# Whether template.html in the folder PAGE was bundled from the sources there: template_test.sh PAGE
# Its meta element source-sha256 is the hash of the sources' hashes (bundle.mjs).
set -euo pipefail
cd "$1"
export LC_ALL=C
expected=$(sha256sum LICENSES.txt bundle.mjs package-lock.json package.json page.css page.html src/*.js |
           sha256sum | cut -d ' ' -f 1)
found=$(sed -n 's/.*name="source-sha256" content="\([0-9a-f]*\)".*/\1/p' template.html)
if [[ $found != "$expected" ]]; then
  echo "template.html does not belong to the sources in $1: run \`npm ci && npm run bundle\` there" >&2
  exit 1
fi
