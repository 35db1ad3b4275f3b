#!/bin/bash
# Proves mutants equivalent: scripts/mutants_prove.sh FOLDER NUMBER..., FOLDER = what scripts/mutants.sh has filled.
# Yosys takes the netlist without a fault and with fault NUMBER apart into gates, leaves out what nothing reads, and
# proves that outputs and next state are the same in every state. A line a mutant: "equivalent", or "not proved" (only
# states that cannot be reached may differ, or a program could tell). Ends with 1 when one was not proved.
set -eu -o pipefail
[ $# -ge 2 ] || { echo "usage: scripts/mutants_prove.sh FOLDER NUMBER..." >&2; exit 1; }
netlist=$1/netlist.v
shift
[ -f "$netlist" ] || { echo "mutants_prove.sh: $netlist is not there: make it with make mutants" >&2; exit 1; }
command -v yosys > /dev/null ||
  { echo "mutants_prove.sh: yosys was not found: install it (Debian package yosys)" >&2; exit 1; }
bits=$(($(sed -nE 's/^ *wire \[([0-9]+):0\] mutant_i;/\1/p' "$netlist") + 1))
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

gates() {   # NUMBER NAME: the unit with this fault, as a module of this name
  yosys -q -p "read_verilog $netlist; hierarchy -top compute_unit; proc; memory_collect; cd compute_unit
    connect -set mutant_i $bits'd$1; cd; opt_expr; simplemap; opt_expr; opt_clean -purge
    rename compute_unit $2; write_rtlil $work/$2.il" > "$work/log" 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
}
gates 0 gold
status=0
for number in "$@"; do
  gates "$number" gate
  yosys -q -l "$work/log" -p "read_rtlil $work/gold.il; read_rtlil -overwrite $work/gate.il; equiv_make gold gate equiv
    hierarchy -top equiv; equiv_struct -icells; equiv_simple -undef -short
    tee -o $work/status equiv_status" > /dev/null 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
  if grep -q 'Equivalence successfully proven' "$work/status"; then
    echo "$number: equivalent"
  else
    echo "$number: not proved"
    status=1
  fi
done
exit $status
