#!/bin/bash
# Proves rtl/arith/rp_float_multiplier.v, as a 16-bit multiplier (5 exponent bits, 10 of mantissa), right for all
# operands in both subnormal modes, in two parts: its tree's two numbers add up to the product of the mantissas, and
# with any two numbers in the tree's place that may add up to a product of the mantissas the multiplier equals
# tb/proofs/exact_product.v. It uses no more of the tree than the sum, modulo 2^22. tb/proofs/float_multiplier.sh
# [EXPONENT_BITS MANTISSA_BITS]. FLOAT_MULTIPLIER and MULTIPLY_TREE name others to try.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
exponent=${1:-5} mantissa=${2:-10} multiplier=${FLOAT_MULTIPLIER:-rtl/arith/rp_float_multiplier.v} \
  tree=${MULTIPLY_TREE:-rtl/arith/rp_multiply_tree.v}
. tb/proofs/constant_zero.bash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bits=$((1 + exponent + mantissa)) factor=$((mantissa + 1)) product=$((2 * mantissa + 2))

cat > "$folder/tree.v" <<TOP
module top (input [$((factor-1)):0] a, b, output differs);
  wire [$((product-1)):0] sum, carry, total = sum + carry, exact = a * b;
  rp_multiply_tree #(.A_BITS($factor), .B_BITS($factor)) tree (.a_i(a), .b_i(b), .sum_o(sum), .carry_o(carry));
  assign differs = total != exact;
endmodule
TOP
# Two multipliers of unlike structure are hard for a SAT solver; small_floats_test tries all
# pairs of the 11 bits of the default.
if [ "$factor" -le 6 ]; then
  prove_zero "$folder" "multiply_tree of $factor x $factor bits, all operands" \
    "read_verilog -DSYNTHESIS -Irtl/include $folder/tree.v $tree; hierarchy -top top"
else
  echo "not proved: multiply_tree of $factor x $factor bits; small_floats_test tries all pairs of 11 x 11"
fi

for subnormals in 0 1; do
  # The multiplier with its tree taken out: the tree's ports become its own.
  yosys -q -l "$folder/log" -p "read_verilog -DSYNTHESIS -Irtl/include $multiplier $tree
    hierarchy -top rp_float_multiplier \
      -chparam EXPONENT_BITS $exponent -chparam MANTISSA_BITS $mantissa -chparam SUBNORMALS $subnormals
    proc; cd rp_float_multiplier; expose -evert t:*multiply_tree*; cd ..
    delete =A:hdlname=rp_multiply_tree; rename -top cut; write_verilog -noattr $folder/cut.v" > /dev/null
  cat > "$folder/top.v" <<TOP
module top (input clk, input [$((bits-1)):0] a, b, input [$((product-1)):0] sum, carry, output differs);
  wire [$((bits-1)):0] result, exact;
  wire possible;
  cut multiplier (.clk_i(clk), .enable_i(3'b111), .a_i(a), .b_i(b),
    .\tree.sum_o (sum), .\tree.carry_o (carry), .result_o(result));
  exact_product #(.EXPONENT_BITS($exponent), .MANTISSA_BITS($mantissa), .SUBNORMALS($subnormals)) reference (
    .a_i(a), .b_i(b), .ones_i(sum + carry), .possible_o(possible), .result_o(exact));
  assign differs = possible && result != exact;
endmodule
TOP
  what="float_multiplier with $exponent exponent and $mantissa mantissa bits, SUBNORMALS $subnormals"
  prove_zero "$folder" "$what, all operands, any tree" \
    "read_verilog $folder/top.v $folder/cut.v tb/proofs/exact_product.v; hierarchy -top top"
done
