// A pipeline that nothing holds up computes the same as the one with wires in place of
// its registers: a map for `techmap`.
(* techmap_celltype = "$dff" *)
module without_registers (CLK, D, Q);
  parameter WIDTH = 1;
  parameter CLK_POLARITY = 1;
  input CLK;
  input [WIDTH-1:0] D;
  output [WIDTH-1:0] Q;
  assign Q = D;
endmodule
