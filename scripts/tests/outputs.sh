#!/bin/bash
# What is written is whole, at the place that was named, or an error: scripts/tests/outputs.sh RAYPOOL [COMMAND]...
# With commands of raypool only these: each must be an error on a full disk.
# A small file system that fills up is mounted where that is allowed (root); elsewhere
# /dev/full alone stands for a full disk.
set -u -o pipefail
raypool=$(realpath "$1")
shift
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
disk=$folder/disk
mounted=no
cleanup() {
  [ "$mounted" = no ] || umount "$disk"
  rm -rf "$folder"
}
trap cleanup EXIT
failures=0

# promise WHAT TEST...: the test command succeeds.
promise() {
  local what=$1; shift
  if "$@" > "$folder/log" 2>&1; then
    echo "ok: $what"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: $(printf ' %q' "$@")"
    cat "$folder/log"
  fi
}

# full COMMAND...: ends with 1 and one sentence that gives the reason.
full() {
  local code=0
  timeout 120 "$@" 2> "$folder/stderr" || code=$?
  [ "$code" = 1 ] && [ "$(wc -l < "$folder/stderr")" = 1 ] && grep -q 'No space left on device' "$folder/stderr" &&
    return
  echo "exit $code, and:"
  cat "$folder/stderr"
  return 1
}
printed_on_full() { full "$raypool" "$@" > /dev/full; }
all_on_full() {
  local command
  for command in "$@"; do
    # shellcheck disable=SC2086 # words
    promise "$command on a full disk is an error" printed_on_full $command
  done
}
if [ $# -gt 0 ]; then
  all_on_full "$@"
  [ "$failures" = 0 ]
  exit
fi

printf '.kernel a\ntid r1\nexit\n' > "$folder/a.asm"
"$raypool" asm "$folder/a.asm" > "$folder/a.hex"
sim=(sim cornell --engine native --size 8x8 --depth 1)

# raypool errors takes long: a test of its own has it as COMMAND.
all_on_full --help kernels "kernels saxpy" isa "isa --verilog" "config 4w4c" "config 4w4c --json" \
  "asm $folder/a.asm" "disasm $folder/a.hex" \
  "scene cornell" "hits cornell --size 4x4" "boxes cornell --size 4x4 --quiet" \
  "triangles cornell --size 4x4 --bits 24 --quiet" configurations \
  "numerics --catalogue" "referee --cases 18 --quiet" \
  "run saxpy --n 8 --engine functional" "${sim[*]} --out $folder/out"

# Links, FIFOs and devices.
ln -s target "$folder/link"
promise "asm -o writes to a link that leads nowhere yet" "$raypool" asm "$folder/a.asm" -o "$folder/link"
promise "... follows it" cmp "$folder/a.hex" "$folder/target"
promise "... and leaves it a link" test -L "$folder/link"
mkfifo "$folder/fifo"
cat "$folder/fifo" > "$folder/read" &
reader=$!
promise "asm -o writes to a FIFO" timeout 20 "$raypool" asm "$folder/a.asm" -o "$folder/fifo"
wait "$reader"
promise "... through it" cmp "$folder/a.hex" "$folder/read"
promise "... and leaves it a FIFO" test -p "$folder/fifo"
promise "asm -o /dev/full is an error" full "$raypool" asm "$folder/a.asm" -o /dev/full
promise "... and leaves the device" test -c /dev/full
"$raypool" asm "$folder/a.asm" -o /dev/stdout > "$folder/stdout"
promise "asm -o /dev/stdout writes to where it was sent" cmp "$folder/a.hex" "$folder/stdout"
mkdir "$folder/out2"
ln -s ../picture.png "$folder/out2/image.png"
promise "sim draws through a link" "$raypool" "${sim[@]}" --out "$folder/out2" --quiet
promise "... to the picture" test -s "$folder/picture.png"

# A disk that fills up.
mkdir "$disk"
if [ "$(id -u)" = 0 ] && mount -t tmpfs -o size=8k none "$disk" 2> /dev/null; then
  mounted=yes
  echo earlier > "$disk/room.obj"
  promise "scene --write-obj on a full disk is an error" full "$raypool" scene room --detail 0.02 \
    --write-obj "$disk/room.obj"
  promise "... and leaves the earlier file and nothing else" test "$(ls -A "$disk"; cat "$disk/room.obj")" = \
    $'room.obj\nearlier'
  echo earlier > "$disk/room.bvh"
  promise "scene --write-bvh on a full disk is an error" full "$raypool" scene room --detail 0.02 \
    --write-obj "$folder/room.obj" --write-bvh "$disk/room.bvh"
  promise "... and leaves the earlier file and nothing else" test "$(cd "$disk" && ls -A && cat room.bvh)" = \
    $'room.bvh\nroom.obj\nearlier'
  promise "... and no OBJ" test ! -e "$folder/room.obj"
  promise "a picture on a full disk is an error" full "$raypool" sim cornell --engine native --size 256x256 --depth 1 \
    --out "$disk/out"
  promise "... and leaves no part of it" test -z "$(ls -A "$disk/out")"
else
  echo "no small disk: mounting a tmpfs needs root"
fi

# Names that are not UTF-8.
odd=$folder/$'caf\xe9'
mkdir "$odd"
printf 'mtllib m\xe9.mtl\nusemtl caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > "$odd/"$'s\xe9.obj'
printf 'newmtl caf\xe9\nKd 1 0 0\n' > "$odd/"$'m\xe9.mtl'
promise "a scene with a name that is not UTF-8 is drawn" "$raypool" sim "$odd/"$'s\xe9.obj' --engine native --size 8x8 \
  --out "$odd/out"
promise "... and its report is UTF-8" iconv -f utf-8 -t utf-8 "$odd/out/report.json"
promise "such a name is written as OBJ" "$raypool" scene "$odd/"$'s\xe9.obj' --write-obj "$odd/"$'again\xe9.obj'
promise "... which is read again" "$raypool" scene "$odd/"$'again\xe9.obj'
echo '{"warps": 2}' > "$odd/"$'c\xe9.json'
promise "and as a configuration" "$raypool" "${sim[@]}" --config "$odd/"$'c\xe9.json' --out "$odd/out"

# Results that differ go to different folders, beside the program: a copy of it.
mkdir "$folder/bin" && cp "$raypool" "$folder/bin/raypool"
draw() { "$folder/bin/raypool" sim --engine native --size 8x8 --depth 1 "$@" > /dev/null; }
cat > "$folder/view.json" << 'END'
{"eye": [2.5, 2.5, 5], "direction": [0, 0, -1], "light": {"position": [2.5, 5, 2.5]}}
END
sed 's/2.5, 5,/2.5, 4,/' "$folder/view.json" > "$folder/out2/view.json"
for warps in 2 4; do
  mkdir "$folder/$warps"; echo "{\"name\": \"mine\", \"warps\": $warps}" > "$folder/$warps/mine.json"
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > "$folder/cornell.obj"
promise "draws cornell" draw cornell
promise "... to a folder named by it" test -d "$folder/bin/out/cornell-8w8c-1cu-8x8-depth1-native"
promise "... in less detail" draw cornell --detail 0.5
promise "... from a view" draw cornell --view "$folder/view.json"
promise "... and another of that name" draw cornell --view "$folder/out2/view.json"
promise "... on a user's hardware" draw cornell --config "$folder/2/mine.json"
promise "... and another of that name" draw cornell --config "$folder/4/mine.json"
promise "... and an OBJ of its name" draw "$folder/cornell.obj"
promise "each into a folder of its own" test "$(find "$folder/bin/out" -mindepth 1 -maxdepth 1 | wc -l)" = 7
draw "$folder/cornell.obj"
promise "... and again into the same" test "$(find "$folder/bin/out" -mindepth 1 -maxdepth 1 | wc -l)" = 7

[ "$failures" = 0 ] || { echo "$failures promises are not kept"; exit 1; }
