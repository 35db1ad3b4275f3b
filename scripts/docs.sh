#!/bin/bash
# Makes of the pages (README.md, docs/) a site that works from disk: scripts/docs.sh FOLDER
# Its first page is FOLDER/index.html. A warning is an error: it ends the script with 1, after the whole site is made.
set -eu -o pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
folder=$1
# Debian's modules are those of Debian's Python, whatever stands first in PATH.
python=$(PATH=/usr/bin:$PATH command -v python3)
# For a host of pages: folders that begin with an underscore are part of the site.
mark=$folder/.nojekyll
if [ -e "$folder" ] && [ ! -e "$mark" ]; then
  echo "docs: $folder is there, and it is not a site: name another folder" >&2
  exit 1
fi
rm -rf "$folder"
mkdir -p "$folder"
touch "$mark"
trees=$(mktemp -d)
trap 'rm -rf "$trees"' EXIT
"$python" -m sphinx -q -b html -W --keep-going -d "$trees" -c "$root/scripts/website" "$root" "$folder"
echo "docs: open $folder/index.html"
