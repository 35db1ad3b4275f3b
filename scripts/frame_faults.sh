#!/bin/bash
# How many of the mistakes of tb/faults/catalogue.json in chip and traverser do random frames find, with no bench of a
# single block? scripts/frame_faults.sh FOLDER [OPTION]... builds raypool_chip_frames from a copy of rtl/ that carries
# them all, and runs it with one after another; OPTION: for raypool_faults (--only 266 267, --least 90, --resume).
# MACHINES: numbers of machines, with , between, instead of all; FRAMES: of each (default 50); CATALOGUE: other
# mistakes. tb/faults/frame_survivors.json has those that no chip can show, and why.
set -eu -o pipefail
[ $# -ge 1 ] || { echo "usage: scripts/frame_faults.sh FOLDER [OPTION]..." >&2; exit 1; }
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
build=${BUILD:-build}
catalogue=$(realpath "${CATALOGUE:-$root/tb/faults/catalogue.json}")
cd "$root"

# verilate.sh builds from the tree that it stands in: one of links, but for rtl/.
for link in cpp_model sim scripts; do ln -sfn "$root/$link" "$folder/$link"; done
python3 scripts/faults.py "$catalogue" rtl "$folder/rtl"
scripts/build.sh "$build" raypool_faults
scripts/configure.sh "$folder/frames" ON "-DRAYPOOL_RTL=$folder/rtl" -DRAYPOOL_UNIT_BENCHES=OFF
scripts/build.sh "$folder/frames" raypool_chip_frames

# Builds the machines, which may take longer than a bench may.
read -ra machines <<< "${MACHINES:+--machine $MACHINES}"
"$folder/frames/raypool_chip_frames" --frames 1 "${machines[@]}" > "$folder/built.txt" ||
  { cat "$folder/built.txt" >&2; exit 1; }

python3 - tb/faults/chip_frames.json "--frames ${FRAMES:-50} ${MACHINES:+--machine $MACHINES}" \
  > "$folder/chip_frames.json" << 'END'
import json, sys
benches = json.load(open(sys.argv[1]))
for bench in benches:
    bench["arguments"] += " " + sys.argv[2]
print(json.dumps(benches))
END
"$build/raypool_faults" "$folder" --catalogue "$catalogue" --beside-units --benches "$folder/frames" \
  --survivors tb/faults/frame_survivors.json --bench-list "$folder/chip_frames.json" --json "$folder/outcomes.json" "$@"
