#!/bin/bash
# Icarus as second opinion: scripts/icarus.sh RAYPOOL CONFIG FOLDER SEED... records the random program of each seed on
# the Verilated unit in lockstep (which must be built: scripts/unit.sh CONFIG), and replays it in Icarus, where
# registers and memories begin as X. Instead of a seed, the path of a saved program may be given, also one that breaks
# the rules of random programs. RTL names another folder with the Verilog. Fails if an output differs from the recording
# in any cycle, or is X where it counts.
set -eu -o pipefail
[ $# -ge 4 ] || { echo "usage: scripts/icarus.sh RAYPOOL CONFIG FOLDER SEED..." >&2; exit 1; }
raypool=$(realpath "$1") config=$2 folder=$3
shift 3
cd "$(dirname "$0")/.."
. scripts/icarus.bash
need_icarus
mkdir -p "$folder"
mapfile -t parameters < <("$raypool" config "$config" --verilog-parameters | tr -s ' \n' '\n')
compile_replay unit_replay "$folder" "WARPS LANES" "${parameters[@]}"

for seed in "$@"; do
  if [ -f "$seed" ]; then run=(--replay "$seed" --unchecked)
  else run=(--config "$config" --programs 1 --seed "$seed")
  fi
  "$raypool" cosim "${run[@]}" --vectors "$folder/vectors.txt" --quiet > "$folder/log.txt" ||
    { cat "$folder/log.txt" >&2; exit 1; }
  replay unit_replay "$folder" "$config, program $seed"
done
