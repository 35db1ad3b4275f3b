#!/bin/bash
# Proves rtl/arith/rp_float_adder.v, as a 16-bit adder (5 exponent bits, 10 of mantissa), equal to
# tb/proofs/exact_adder.v for all operands, added and subtracted, in both subnormal modes: tb/proofs/float_adder.sh
# [EXPONENT_BITS MANTISSA_BITS]. FLOAT_ADDER names another adder to try.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
exponent=${1:-5} mantissa=${2:-10} adder=${FLOAT_ADDER:-rtl/arith/rp_float_adder.v}
. tb/proofs/constant_zero.bash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for subnormals in 0 1; do
  parameters="-set EXPONENT_BITS $exponent -set MANTISSA_BITS $mantissa -set SUBNORMALS $subnormals"
  cat > "$folder/top.v" <<'TOP'
module top #(parameter EXPONENT_BITS = 5, MANTISSA_BITS = 10, SUBNORMALS = 0, BITS = 1 + EXPONENT_BITS + MANTISSA_BITS)
  (input clk, subtract, input [BITS-1:0] a, b, output differs);
  wire [BITS-1:0] sum, exact;
  rp_float_adder #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(SUBNORMALS)) adder (
    .clk_i(clk), .enable_i(3'b111), .subtract_i(subtract), .a_i(a), .b_i(b), .result_o(sum));
  exact_adder #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(SUBNORMALS)) reference (
    .subtract_i(subtract), .a_i(a), .b_i(b), .result_o(exact));
  assign differs = sum != exact;
endmodule
TOP
  prove_zero "$folder" \
    "float_adder with $exponent exponent and $mantissa mantissa bits, SUBNORMALS $subnormals, all operands" \
    "read_verilog -Irtl/include $folder/top.v $adder tb/proofs/exact_adder.v; chparam $parameters top
    hierarchy -top top"
done
