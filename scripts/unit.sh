#!/bin/bash
# Builds the Verilated compute unit of a configuration if it is missing or older than the Verilog: scripts/unit.sh CONFIG [--units N] [--waves]
# --units: a multiprocessor of 1, 2 or 4 units (default 1). --waves: one that can write waveforms, kept beside the fast one. Needs
# build/raypool, or another one that RAYPOOL names. The library's folder follows from the parameters, so builds do not disturb each other.
set -eu -o pipefail
cd "$(dirname "$0")/.."
config=$1; shift
units=1 waves=
while [ $# -gt 0 ]; do
  case $1 in
    --units) units=$2; shift ;;
    --waves) waves=--waves ;;
    *) echo "unit.sh: '$1' is neither --units nor --waves" >&2; exit 1 ;;
  esac
  shift
done
raypool=${RAYPOOL:-build/raypool}
library=$("$raypool" config "$config" --unit-library --units "$units")
parameters=$("$raypool" config "$config" --verilog-parameters)
folder=$(dirname "$library")$([ "$waves" = --waves ] && echo -waves || true)
mkdir -p "$folder"
# Unquoted: each parameter is a word.
JOBS=$(nproc) flock "$folder/.lock" scripts/verilate.sh "$folder" ${waves:+--trace} UNITS="$units" $parameters | { grep -v 'is up to date$' || true; }
