// @modules block_scheduler round_robin
// @proves a launch goes to exactly one unit, which can take it, and launch_unit_o names it; to one that runs
//   no kernel if such a one can take it
// @proves launch_ready_o is high if and only if a unit can take it, whatever launch_valid_i is
// @proves among equals no unit gets a second launch while another waits for its first: after UNITS - 1 others at most
// @parameters UNITS=4
// @parameters UNITS=2
// @break block_scheduler s/ready_i & ~busy_i/ready_i/
// @break block_scheduler s/\|free \? free : ready_i/ready_i | free/
// @break block_scheduler s/launch_ready_o = \|ready_i/launch_ready_o = |free/
// @break block_scheduler s/next & \{UNITS\{launch_valid_i\}\}/ready_i \& {UNITS{launch_valid_i}}/
// @break round_robin s/ \| \(grant_o - ONE\)//
`default_nettype none
module check #(parameter UNITS = 4) (input wire clk_i, launch_i, input wire [UNITS-1:0] ready_i, busy_i);
  localparam [UNITS-1:0] ONE = 1;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire ready;
  wire [1:0] unit;
  wire [UNITS-1:0] valid;
  rp_block_scheduler #(.UNITS(UNITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .launch_valid_i(launch_i), .launch_ready_o(ready), .launch_unit_o(unit),
    .ready_i(ready_i), .busy_i(busy_i), .valid_o(valid));

  (* anyconst *) wire [1:0] waiter;
  (* anyconst *) wire [1:0] other;
  wire [UNITS-1:0] idle = ready_i & ~busy_i;
  wire candidate = rst_n && (|idle ? idle[waiter] : ready_i[waiter]);
  wire launched = rst_n && launch_i && ready;
  wire passed = candidate && !(launched && unit == waiter);
  reg chosen_q = 1'b0;
  reg [2:0] passed_q = 0;
  always @(posedge clk_i) begin
    chosen_q <= passed && (chosen_q || (launched && unit == other));
    passed_q <= passed ? passed_q + launched : 0;
  end
  always @* begin
    assume (waiter < UNITS && other < UNITS && waiter != other);
    if (rst_n) begin
      assert (ready == |ready_i);
      assert (valid == (launched ? ONE << unit : 0));
      assert (!ready || (unit < UNITS && ready_i[unit]));
      assert (!(ready && |idle) || idle[unit]);
      assert (!(passed && chosen_q && launched && unit == other));
      assert (!(passed && launched && passed_q == UNITS - 1));
    end
  end
endmodule
`default_nettype wire
