#!/bin/bash
# Icarus as second opinion on the whole chip: scripts/icarus_chip.sh CHIP_FRAMES FOLDER MACHINE FRAME... records random
# frames of a tiny chip as its model draws them (CHIP_FRAMES is raypool_chip_frames, which numbers machines and frames)
# and replays each on rtl/chip/rp_chip.v in Icarus, where registers and memories begin as X and so does what the chip is
# given while it is not valid. RTL names another folder with the Verilog. Fails if an output differs from the recording
# in any cycle, or is X where it counts.
set -eu -o pipefail
[ $# -ge 4 ] || { echo "usage: scripts/icarus_chip.sh CHIP_FRAMES FOLDER MACHINE FRAME..." >&2; exit 1; }
chip_frames=$(realpath "$1") folder=$2 machine=$3
shift 3
cd "$(dirname "$0")/.."
. scripts/icarus.bash
need_icarus
mkdir -p "$folder"
compiled=
for frame in "$@"; do
  "$chip_frames" --machine "$machine" --frame "$frame" --record "$folder" > "$folder/log.txt" ||
    { cat "$folder/log.txt" >&2; exit 1; }
  read -ra parameters < "$folder/parameters.txt"
  [ -n "$compiled" ] || compile_replay chip_replay "$folder" "CULLING RAY_POOL_SIZE" "${parameters[@]}"
  compiled=yes
  replay chip_replay "$folder" "machine $machine, frame $frame"
done
