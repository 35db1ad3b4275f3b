#!/bin/bash
# Every kind of text file may begin with a byte order mark and have the lines of any machine, and gets one sentence as
# UTF-16: scripts/tests/text_files.sh RAYPOOL
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

failed() {
  failures=$((failures + 1))
  echo "FAILED: $1"
  head -5 "$folder/log"
}

# What stands in all forms: one file of each kind.
mkdir "$folder/plain"
printf 'mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n' > "$folder/plain/s.obj"
printf 'newmtl red\nKd 0.75 0.25 0.125\n' > "$folder/plain/s.mtl"
printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
  'element face 1' 'property list uchar int vertex_indices' end_header '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' \
  > "$folder/plain/s.ply"
printf '.kernel a\ntid r1\nexit\n' > "$folder/plain/a.asm"
"$raypool" asm "$folder/plain/a.asm" > "$folder/plain/a.hex"
printf '{"warps": 2,\n "name": "two"}\n' > "$folder/plain/c.json"
printf '{"eye": [0, 0, 5],\n "direction": [0, 0, -1], "light": {"position": [0, 0, 9]}}\n' > "$folder/plain/view.json"
"$raypool" sim cornell --engine native --size 8x8 --quiet --out "$folder/frame" > /dev/null
cp "$folder/frame/report.json" "$folder/plain/report.json"
triangle=$(printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0' | base64 -w0)
printf '%s\n' '{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],' \
  '"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],' \
  '"accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],' \
  '"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":' \
  "\"data:;base64,$triangle\"}]}" \
  > "$folder/plain/s.gltf"

# use KIND FOLDER: the command that reads such a file; what it prints has no names of folders.
use() {
  case $1 in
    s.ply | s.gltf) "$raypool" scene "$2/$1" ;;
    s.*) "$raypool" scene "$2/s.obj" --write-obj "$folder/w.obj" > /dev/null && cat "$folder/w.obj" "$folder/w.mtl" ;;
    a.asm) "$raypool" asm "$2/$1" ;;
    a.hex) "$raypool" disasm "$2/$1" ;;
    c.json) "$raypool" config "$2/$1" ;;
    view.json) "$raypool" scene cornell --view "$2/$1" ;;
    report.json) "$raypool" compare "$2/$1" "$folder/frame" --json | sed "s|$2/||" ;;
  esac
}

declare -A forms=([mark]='s/^/\xef\xbb\xbf/;:a;n;ba' [windows]='s/$/\r/' [marked-windows]='1s/^/\xef\xbb\xbf/;s/$/\r/')
for kind in s.obj s.mtl s.ply s.gltf a.asm a.hex c.json view.json report.json; do
  use "$kind" "$folder/plain" > "$folder/wanted" 2>&1 || { cp "$folder/wanted" "$folder/log"; failed "$kind is read"; }
  for form in "${!forms[@]}" old-mac; do
    mkdir -p "$folder/$form"
    cp "$folder"/plain/* "$folder/$form"
    if [ "$form" = old-mac ]; then
      tr '\n' '\r' < "$folder/plain/$kind" > "$folder/$form/$kind"
    else
      sed "${forms[$form]}" "$folder/plain/$kind" > "$folder/$form/$kind"
    fi
    if use "$kind" "$folder/$form" > "$folder/log" 2>&1 && cmp "$folder/log" "$folder/wanted"; then
      echo "ok: $kind, $form"
    else
      failed "$kind, $form, must print what the plain one prints"
    fi
  done
  for encoding in UTF-16 UTF-16LE UTF-16BE; do
    mkdir -p "$folder/wide"
    cp "$folder"/plain/* "$folder/wide"
    iconv -f UTF-8 -t "$encoding" "$folder/plain/$kind" > "$folder/wide/$kind"
    use "$kind" "$folder/wide" > "$folder/log" 2>&1
    if [ $? = 1 ] && [ "$(wc -l < "$folder/log")" = 1 ] &&
      grep -q "$kind: the .* is UTF-16 text.*UTF-8" "$folder/log"; then
      echo "ok: $kind, $encoding"
    else
      failed "$kind as $encoding is refused in one sentence"
    fi
  done
done
[ "$failures" = 0 ]
