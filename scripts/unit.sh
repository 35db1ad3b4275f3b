#!/bin/bash
# Builds the Verilated compute unit of a configuration if it is missing or older than the Verilog: scripts/unit.sh CONFIG [--waves]
# --waves: one that can write waveforms, kept beside the fast one. Needs build/raypool, or another one that RAYPOOL names. The library's
# folder follows from the configuration's parameters, so configurations do not disturb each other.
set -eu -o pipefail
cd "$(dirname "$0")/.."
config=$1 waves=${2:-}
raypool=${RAYPOOL:-build/raypool}
library=$("$raypool" config "$config" --unit-library)
parameters=$("$raypool" config "$config" --verilog-parameters)
folder=$(dirname "$library")$([ "$waves" = --waves ] && echo -waves || true)
mkdir -p "$folder"
# Unquoted: each parameter is a word.
JOBS=$(nproc) flock "$folder/.lock" scripts/verilate.sh "$folder" ${waves:+--trace} $parameters | { grep -v 'is up to date$' || true; }
