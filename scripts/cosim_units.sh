#!/bin/bash
# Builds the Verilated units of all machines that `raypool cosim` runs without --config: scripts/cosim_units.sh
# Silent when there is nothing to do. RAYPOOL names the program, as for unit.sh.
set -eu -o pipefail
cd "$(dirname "$0")/.."
"${RAYPOOL:-${BUILD:-build}/raypool}" cosim --machines | while read -r file units; do
  scripts/unit.sh "$file" --units "$units" < /dev/null
done
