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
for tool in iverilog vvp; do
  command -v $tool > /dev/null ||
    { echo "icarus.sh: $tool was not found: install it (Debian package iverilog)" >&2; exit 1; }
done
mkdir -p "$folder"
rtl=${RTL:-rtl}

declare -A value
list=
for parameter in $("$raypool" config "$config" --verilog-parameters); do
  value[${parameter%=*}]=${parameter#*=}
  list+="${list:+, }.${parameter%=*}(${parameter#*=})"
done
iverilog -g2005 -Wall -Wno-timescale -I"$rtl" -s unit_replay -DUNIT_PARAMETERS="$list" \
  -Punit_replay.WARPS="${value[WARPS]}" -Punit_replay.LANES="${value[LANES]}" \
  -o "$folder/unit_replay.vvp" tb/icarus/unit_replay.v "$rtl"/*.v

for seed in "$@"; do
  if [ -f "$seed" ]; then run=(--replay "$seed" --unchecked)
  else run=(--config "$config" --programs 1 --seed "$seed")
  fi
  "$raypool" cosim "${run[@]}" --vectors "$folder/vectors.txt" --quiet > "$folder/log.txt" ||
    { cat "$folder/log.txt" >&2; exit 1; }
  result=$(vvp -n "$folder/unit_replay.vvp" +vectors="$folder/vectors.txt")
  echo "$config, program $seed: $result"
  # A bench that stops early says nothing.
  grep -q 'retire as recorded' <<< "$result" ||
    { echo "icarus.sh: FAILED; the recording is $folder/vectors.txt" >&2; exit 1; }
done
