#!/bin/bash
# A section of the page that `make report` makes, as a picture:
# studies/section_picture.sh INDEX.html SECTION PICTURE.png
set -eu -o pipefail
[ $# = 3 ] || { echo "usage: studies/section_picture.sh INDEX.html SECTION PICTURE.png" >&2; exit 1; }
browser=$(command -v chromium-headless-shell || command -v chromium) ||
  { echo "section_picture.sh: there is no headless Chromium: scripts/setup.sh report-test installs it" >&2; exit 1; }
grep -q "<section id=\"$2\">" "$1" || { echo "section_picture.sh: $1 has no section $2" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
style="section:not(#$2), header, footer { display: none } section { border: 0 !important; margin: 0 !important }"
sed "s|</head>|<style>$style</style></head>|" "$1" > "$folder/page.html"
"$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,690 --virtual-time-budget=5000 \
  --user-data-dir="$folder/profile" --screenshot="$folder/picture.png" "file://$folder/page.html" \
  > "$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
cp "$folder/picture.png" "$3"
