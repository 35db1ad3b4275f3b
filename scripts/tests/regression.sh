#!/bin/bash
# Replays one saved program in lockstep, on a Verilated unit of the configuration that it names:
# scripts/tests/regression.sh RAYPOOL FILE FOLDER
set -eu -o pipefail
export RAYPOOL
RAYPOOL=$(realpath "$1")
file=$2 folder=$3
cd "$(dirname "$0")/../.."
mkdir -p "$folder"
config=$folder/$(basename "$file")
"$RAYPOOL" cosim --replay "$file" --show-config > "$config"
units=$(sed -nE 's/^ *"units": ([0-9]+),/\1/p' "$file" | head -n 1)
scripts/unit.sh "$config" --units "$units"
"$RAYPOOL" cosim --replay "$file"
