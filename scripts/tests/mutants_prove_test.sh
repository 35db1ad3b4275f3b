#!/bin/bash
# `python3 -m faults prove` proves a mutant equivalent that is, and neither one with another output nor one with another
# next state: a unit of one register with four faults, as `python3 -m faults mutants` leaves them.
set -u -o pipefail
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/netlist.v" <<'END'
module rp_compute_unit (input clk_i, input [3:0] a_i, input [3:0] b_i, output [3:0] sum_o, output [3:0] state_o);
  wire [2:0] mutant_i;
  reg [3:0] state_q;
  // 1: the same by other gates; 2: one bit of the output, for one pair of operands.
  wire [3:0] sum = mutant_i == 3'd1 ? a_i - ~b_i - 4'd1 : a_i + b_i;
  assign sum_o = sum ^ {3'd0, mutant_i == 3'd2 && a_i == 4'd9 && b_i == 4'd14};
  // 3: the next state, when the old one is 11; 4: a fault in a bit that is masked by what it meets.
  always @(posedge clk_i) state_q <= mutant_i == 3'd3 && state_q == 4'd11 ? sum : sum ^ state_q;
  assign state_o = state_q & ~(state_q & {3'd0, mutant_i == 3'd4 && !state_q[0]});
endmodule
END
failures=0

# expect WHAT STATUS SAID NUMBER...: the proof of these mutants ends with the status, and prints just this.
expect() {
  local what=$1 status=$2 wanted=$3 said ended
  shift 3
  said=$(PYTHONPATH=scripts python3 -m faults prove "$folder" "$@" 2>&1)
  ended=$?
  if [ "$ended" = "$status" ] && [ "$said" = "$wanted" ]; then
    echo "ok: $what"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: ended with $ended, not $status, and prints: $said"
  fi
}

expect "the same by other gates, and a bit that is masked" 0 $'1: equivalent\n4: equivalent' 1 4
expect "an output that differs for one pair" 1 "2: not proved" 2
expect "a next state that differs in one state" 1 "3: not proved" 3
expect "one of several" 1 $'1: equivalent\n2: not proved\n4: equivalent' 1 2 4
mv "$folder/netlist.v" "$folder/kept.v"
expect "mutants that have not been made" 1 \
  "faults: $folder/netlist.v is not there: make it with make faults SOURCE=mutants" 1
[ "$failures" = 0 ]
