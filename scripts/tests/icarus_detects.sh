#!/bin/bash
# Does the replay in Icarus detect what Verilator cannot: scripts/tests/icarus_detects.sh RAYPOOL CHIP_FRAMES FOLDER.
# Registers of the unit and of the chip without their reset, and a program that reads a register which it never wrote,
# must each end with an X on a named output. Needs the Verilated unit of tb/mutants/2w2c.json.
set -u -o pipefail
raypool=$(realpath "$1") chip_frames=$(realpath "$2") folder=$3
cd "$(dirname "$0")/../.." || exit 1
mkdir -p "$folder"
failures=0

# detects WHAT RTL OUTPUT PROGRAM: the replay of PROGRAM on the files of RTL shows an X on OUTPUT.
detects() {
  local what=$1 rtl=$2 output=$3 program=$4
  expect_x "$what" "$output" "$(RTL=$rtl scripts/icarus.sh "$raypool" tb/mutants/2w2c.json "$folder/run" \
    "$program" 2>&1)"
}

# chip_detects WHAT OUTPUT MACHINE [FRAME]: the same of a frame of a chip, the first one if none is named, with the copy
# of rtl/.
chip_detects() {
  expect_x "$1" "$2" "$(RTL=$folder/rtl scripts/icarus_chip.sh "$chip_frames" "$folder/run" "$3" "${4:-1}" 2>&1)"
}

expect_x() {
  local what=$1 output=$2 text=$3
  if grep -q "X on $output" <<< "$text"; then
    echo "ok: $what: $(grep -m 1 "X on $output" <<< "$text" | tr -s ' ')"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: no X on $output, but: $text"
  fi
}

# without_reset FILE REGISTER: a copy of rtl/ in which the reset leaves the register alone.
without_reset() {
  local reset="( *)(if \(!rst_ni\) )?$2 <= [^;]*;"
  rm -rf "$folder/rtl"
  cp -r rtl "$folder/rtl"
  sed -i -E "0,/^$reset/ s/^$reset/\1\2;/" "$folder/rtl/$1"
  if cmp -s "rtl/$1" "$folder/rtl/$1"; then
    failures=$((failures + 1))
    echo "FAILED: rtl/$1 has no assignment of $2 to take out"
  fi
}

text=$(scripts/icarus.sh "$raypool" tb/mutants/2w2c.json "$folder/run" 1 2>&1) ||
  { failures=$((failures + 1)); echo "FAILED: the sound unit: $text"; }
undefined=tb/icarus/undefined_register.json
"$raypool" cosim --replay $undefined --unchecked --show-config > "$folder/undefined.json"
RAYPOOL=$raypool scripts/unit.sh "$folder/undefined.json"
detects "a register that is read before it is written" rtl "retire_data" $undefined
without_reset compute/rp_compute_unit.v fault_q
detects "the fault flag without reset" "$folder/rtl" "fault_valid" 1
without_reset compute/rp_launcher.v running_o
detects "the launcher's state without reset" "$folder/rtl" "busy" 1

# Of a chip with the traverser inside: 22 is the smallest, 26 has several rays in flight.
for machine in 22 26; do
  text=$(scripts/icarus_chip.sh "$chip_frames" "$folder/run" $machine 1 2>&1) ||
    { failures=$((failures + 1)); echo "FAILED: the sound chip: $text"; }
done
without_reset chip/rp_controller.v busy_o
chip_detects "whether a frame is drawn, without reset" busy 22
without_reset traverser/rp_tree_port.v request_valid_o
chip_detects "a request of the traverser without reset" tree_request_valid 22
without_reset traverser/rp_tree_cache.v valid_q
chip_detects "which lines a cache has, without reset" tree_request_valid 22
without_reset traverser/rp_leaf_reader.v held_q
chip_detects "how many lines a lane holds, without reset" tree_request_address 26 2

[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
