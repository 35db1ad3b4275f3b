#!/bin/bash
# Builds the Verilated compute unit of a configuration if it is missing or older than the Verilog:
# scripts/unit.sh CONFIG [--units N] [--boundary unit|chip] [--waves]
# --units: a multiprocessor of 1, 2 or 4 units (default 1). --boundary chip: the whole chip around it. --waves: one that
# can write waveforms, kept beside the fast one. Needs build/raypool, or another one that RAYPOOL names.
# Silent when there is nothing to do.
set -eu -o pipefail
cd "$(dirname "$0")/.."
config=$1; shift
"${RAYPOOL:-${BUILD:-build}/raypool}" unit --config "$config" "$@" |
  { grep --line-buffered -v 'is up to date$' || true; }
