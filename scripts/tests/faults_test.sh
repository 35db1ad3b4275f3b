#!/bin/bash
# The catalogue of seeded faults: scripts/tests/faults_test.sh RAYPOOL RAYPOOL_FAULTS FOLDER. Every fault can be put
# into today's rtl/, the copy with all of them is plain Verilog and agrees with the model when none is chosen, some are
# detected soon, and what does not fit is refused.
set -u -o pipefail
RAYPOOL=$(realpath "$1")
export RAYPOOL
faults=$(realpath "$2") folder=$3
cd "$(dirname "$0")/../.." || exit 1
mkdir -p "$folder"
folder=$(realpath "$folder")
# shellcheck source=scripts/tests/expect.bash
. scripts/tests/expect.bash

# changed SCRIPT: a copy of the catalogue that sed has changed.
changed() {
  sed "$1" tb/faults/catalogue.json > "$folder/changed.json"
  cmp -s tb/faults/catalogue.json "$folder/changed.json" &&
    { failures=$((failures + 1)); echo "FAILED: '$1' changes nothing in the catalogue"; }
}

export PYTHONPATH=scripts
rtl=$folder/catalogue/rtl
expect "the small machine with every fault is built" 0 "650 faults" python3 -m faults units "$folder" --machines 2w2c
expect "it is plain Verilog" 0 "" iverilog -g2005 -I"$rtl/include" -s rp_multiprocessor -o /dev/null "$rtl"/*/*.v
expect "so it is with several units and every option" 0 "" verilator --lint-only --default-language 1364-2005 \
  -I"$rtl/include" --top-module rp_multiprocessor \
  -GUNITS=4 -GWARPS=2 -GLANES=2 -GFMA=1 -GFLT_DEPTH=5 -GSUBNORMALS=1 -GSLOW_UNIT=1 "$rtl"/*.vlt "$rtl"/*/*.v
expect "so it is where products have digits, as benches have them" 0 "" verilator --lint-only -DSYNTHESIS \
  --default-language 1364-2005 -I"$rtl/include" --top-module rp_multiply_tree "$rtl"/*.vlt \
  "$rtl/arith/rp_multiply_tree.v"
expect "so it is with the features of best" 0 "" verilator --lint-only --default-language 1364-2005 -I"$rtl/include" \
  --top-module rp_multiprocessor -GWARPS=2 -GLANES=8 -GTRIPLES=1 -GKERNEL_OVERLAP=1 -GWIDE_RAY_MEMORY=1 -GSLOW_LANES=2 \
  -GSLW_DEPTH=13 -GFLT_DEPTH=5 -GFMA=1 "$rtl"/*.vlt "$rtl"/*/*.v
expect "faults are detected, and without one the unit agrees" 0 "no fault: 40 programs agree" \
  "$faults" units "$folder" --programs 40 --only 16 21 44 79 96
# Each of these once led to another file: of the block beside it, or of the one above.
expect "reports name the right file first or second" 0 "the first or the second: 9 of 9" \
  "$faults" units "$folder" --programs 60 --only 6 10 11 13 28 33 67 81 88
expect "a run that was interrupted goes on" 0 "units: 9 of 9" \
  "$faults" units "$folder" --programs 60 --only 6 10 11 13 28 33 67 81 88 --resume
expect "few kills can be an error" 1 "units: 0 of 1" "$faults" units "$folder" --programs 1 --only 160 --least 90
echo '{"catalogue": []}' > "$folder/none.json"
expect "a survivor is an error" 1 "NOT JUDGED" \
  "$faults" catalogue "$folder" --programs 1 --only 160 --bench-list "$folder/none.json"
expect "a bench that is not there is an error" 1 "there is no bench" "$faults" catalogue "$folder" --only 160
expect "so is a machine" 1 "has no machine that is asked for" "$faults" units "$folder" --machines 9w9c
expect "of which the builder lists what there are" 1 "there is no machine 9w9c: 2w2c, 2w8c-best, 2w2c-4cu, " \
  python3 -m faults units "$folder" --machines 9w9c
changed 's/next_pc >= program_length_i/next_pc >= program_size_i/'
expect "a fault that does not fit is refused" 1 \
  "fault 30 (rp_instruction_buffer.v: The instruction behind the program's last one is let through.)" \
  python3 -m faults units "$folder/refused" --catalogue "$folder/changed.json"
changed 's/"number": 7/"number": 77/'
expect "a catalogue with a number left out is refused" 1 "must be numbered" \
  python3 -m faults units "$folder/refused" --catalogue "$folder/changed.json"

[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
