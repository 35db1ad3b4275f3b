// @modules frame_port request_queue event_counter
// @proves nothing is lost, nothing comes twice, the order is kept: any one contribution leaves as it came, after as
//   many as were before it; what is offered stays until it is taken
// @proves whether a unit's is taken does not depend on the traverser; the traverser's is taken if there is room and no
//   unit offers one; a frame buffer that takes one a cycle gets one a cycle
// @proves each contribution of a unit is reported once, in the cycle after it, and no other one
// @break frame_port s/unit_valid_i \? \{unit_color_i/traverser_valid_i ? {unit_color_i/
// @break frame_port s/room && !unit_valid_i/room/
// @break frame_port s/unit_ready_o = room/unit_ready_o = room \&\& !traverser_valid_i/
// @break frame_port s/room = count != 2'd2/room = 1'b1/
// @break frame_port s/room = count != 2'd2/room = count == 2'd0/
// @break frame_port s/unit_valid_i && unit_ready_o;/(unit_valid_i || traverser_valid_i) \&\& unit_ready_o;/
// @break frame_port s/exported_pixel_o <= unit_pixel_i/exported_pixel_o <= traverser_pixel_i/
`default_nettype none
module check (
  input wire clk_i, unit_valid, traverser_valid, frame_ready, choose, input wire [127:0] unit_data, traverser_data,
  input wire [1:0] number);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire unit_ready, traverser_ready, frame_valid, exported;
  wire [127:0] data;
  wire [1:0] exported_unit;
  wire [31:0] exported_pixel;
  wire [47:0] unused;
  rp_frame_port dut (
    .clk_i(clk_i), .rst_ni(rst_n), .unit_valid_i(unit_valid), .unit_ready_o(unit_ready),
    .unit_pixel_i(unit_data[31:0]), .unit_color_i(unit_data[127:32]), .unit_number_i(number),
    .traverser_valid_i(traverser_valid), .traverser_ready_o(traverser_ready),
    .traverser_pixel_i(traverser_data[31:0]), .traverser_color_i(traverser_data[127:32]), .frame_valid_o(frame_valid),
    .frame_ready_i(frame_ready), .frame_pixel_o(data[31:0]), .frame_color_o(data[127:32]),
    .exported_valid_o(exported), .exported_unit_o(exported_unit), .exported_pixel_o(exported_pixel),
    .taken_o(unused));

  wire from_unit = rst_n && unit_valid && unit_ready;
  wire from_traverser = rst_n && traverser_valid && traverser_ready;
  wire leaves = rst_n && frame_valid && frame_ready;
  reg [2:0] held_q = 0;
  reg tracked_q = 1'b0, offered_q = 1'b0, exported_q = 1'b0, stalled_q = 1'b0;
  reg [2:0] before_q = 0;       // contributions before the tracked one
  reg [127:0] value_q, data_q;
  reg [33:0] export_q;
  wire came = from_unit || from_traverser;
  wire track = came && choose && !tracked_q;
  always @(posedge clk_i) begin
    held_q <= held_q + from_unit + from_traverser - leaves;
    if (track) begin
      tracked_q <= 1'b1;
      before_q <= held_q - leaves;
      value_q <= from_unit ? unit_data : traverser_data;
    end else if (tracked_q && leaves) begin
      tracked_q <= before_q != 0;
      before_q <= before_q - 1;
    end
    offered_q <= rst_n && frame_valid && !frame_ready;
    data_q <= data;
    exported_q <= from_unit;
    export_q <= {number, unit_data[31:0]};
    if (rst_n && !frame_ready) stalled_q <= 1'b1;
  end
  always @* if (rst_n) begin
    assert (!(from_unit && from_traverser));
    assert (held_q <= 2);
    assert (frame_valid == (held_q != 0));
    assert (unit_ready == (held_q < 2));
    assert (traverser_ready == (held_q < 2 && !unit_valid));
    assert (stalled_q || unit_ready);
    assert (!(tracked_q && before_q == 0) || (frame_valid && data == value_q));
    assert (!offered_q || (frame_valid && data == data_q));
    assert (exported == exported_q);
    assert (!exported || {exported_unit, exported_pixel} == export_q);
  end
endmodule
`default_nettype wire
