# For the proofs of arithmetic: prove_zero FOLDER WHAT READ proves the one output of a combinational design, registers
# read as wires, to be 0 for all inputs. READ: the Yosys commands that read it and name its top.
prove_zero() {
  local folder=$1 what=$2 read=$3
  yosys -q -l "$folder/log" -p "$read; proc; flatten; opt_expr; opt_clean
    techmap -map tb/proofs/without_registers.v; select -assert-none t:*dff*;
    opt -full; techmap; opt -fast; abc -g AND -fast; opt_clean; write_aiger $folder/miter.aig" > /dev/null
  yosys-abc -c "read_aiger $folder/miter.aig; fraig; dc2; fraig; iprove; print_status" > "$folder/abc" 2>&1 || true
  if ! grep -q "UNSATISFIABLE" "$folder/abc"; then
    echo "FAILED: $what:"
    tail -5 "$folder/abc"
    return 1
  fi
  echo "proved: $what"
}
