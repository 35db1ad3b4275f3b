// Replays a vector file (written by arith_vectors) through the Flt, Slw and Brh ALUs of one configuration in Icarus:
// the same sources, another simulator. Plus-arguments: vectors=FILE, a line a task: unit (0 Flt, 1 Slw, 2 Brh),
// operation, a, b, c, expected, in hexadecimal. One lane, one task a cycle. Brh takes its predicates from the lowest
// bits of c and gives one. Prints "arith_icarus: N results agree" at the end, or the first differences and FAILED.
`default_nettype none
module arith_icarus #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer SLOW_UNIT = 0,
  parameter integer FMA = 0
);
  localparam integer FLT_DEPTH = (FMA != 0) ? 5 : 3;
  localparam integer BRH_DEPTH = 2;
  localparam integer SLW_DEPTH = (SLOW_UNIT <= 1) ? 11 : (SLOW_UNIT == 2) ? 8 : 6;
  reg clk = 1'b0;
  reg rst_n = 1'b0;
  reg flt_valid = 1'b0, slw_valid = 1'b0, brh_valid = 1'b0;
  reg [2:0] warp = 3'd0;
  reg [4:0] op = 5'd0;
  reg [31:0] a = 32'd0, b = 32'd0, c = 32'd0, expected = 32'd0;
  wire flt_done, slw_done, brh_done, brh_pred;
  wire [2:0] flt_warp, slw_warp, brh_warp;
  wire [31:0] flt_data, slw_data;

  rp_flt_alu #(.WARPS(8), .LANES(1), .LATENCY(1), .DEPTH(FLT_DEPTH), .SUBNORMALS(SUBNORMALS),
      .SIGNIFICAND(SIGNIFICAND), .FMA(FMA)) flt (
    .clk_i(clk), .rst_ni(rst_n), .task_valid_i(flt_valid), .task_warp_i(warp), .task_operation_i(op),
    .task_mask_i(1'b1), .task_operand_a_i(a), .task_operand_b_i(b), .task_operand_c_i(c), .task_immediate_i(32'd0),
    .task_word_i(5'd0), .task_predicate_x_i(1'b0), .task_predicate_b_i(1'b0), .ready_o(), .done_valid_o(flt_done),
    .done_warp_o(flt_warp), .done_data_o(flt_data), .done_predicate_o(), .done_subnormal_o());
  rp_slw_alu #(.WARPS(8), .LANES(1), .LATENCY(1), .DEPTH(SLW_DEPTH), .SUBNORMALS(SUBNORMALS),
      .SIGNIFICAND(SIGNIFICAND), .SLOW_UNIT(SLOW_UNIT)) slw (
    .clk_i(clk), .rst_ni(rst_n), .task_valid_i(slw_valid), .task_warp_i(warp), .task_operation_i(op),
    .task_mask_i(1'b1), .task_operand_a_i(a), .task_operand_b_i(b), .task_operand_c_i(32'd0), .task_immediate_i(32'd0),
    .task_word_i(5'd0), .task_predicate_x_i(1'b0), .task_predicate_b_i(1'b0), .ready_o(), .done_valid_o(slw_done),
    .done_warp_o(slw_warp), .done_data_o(slw_data), .done_predicate_o(), .done_subnormal_o());

  rp_brh_alu #(.WARPS(8), .LANES(1), .WARP_BITS(3), .LATENCY(1), .DEPTH(BRH_DEPTH), .SUBNORMALS(SUBNORMALS),
      .SIGNIFICAND(SIGNIFICAND)) brh (
    .clk_i(clk), .rst_ni(rst_n), .task_valid_i(brh_valid), .task_warp_i(warp), .task_operation_i(op),
    .task_mask_i(1'b1), .task_operand_a_i(a), .task_operand_b_i(b), .task_operand_c_i(32'd0), .task_immediate_i(32'd0),
    .task_word_i(5'd0), .task_predicate_x_i(c[0]), .task_predicate_b_i(c[1]), .ready_o(), .done_valid_o(brh_done),
    .done_warp_o(brh_warp), .done_data_o(), .done_predicate_o(brh_pred), .done_subnormal_o());

  // What is expected, beside the pipelines: entry k arrived k cycles ago.
  reg [SLW_DEPTH:0] flt_due = 0, slw_due = 0, brh_due = 0;
  reg [31:0] due_data [0:SLW_DEPTH];
  reg [2:0] due_warp [0:SLW_DEPTH];

  reg [8*1024-1:0] path;
  integer file, fields, unit, operation, agreed, failed, drain, k;

  always #1 clk = !clk;

  // Called between edges, after the inputs of this cycle have been set.
  task check;
    begin
      due_data[0] = expected;
      due_warp[0] = warp;
      flt_due[0] = flt_valid;
      slw_due[0] = slw_valid;
      brh_due[0] = brh_valid;
      if (flt_done !== flt_due[FLT_DEPTH] || slw_done !== slw_due[SLW_DEPTH] || brh_done !== brh_due[BRH_DEPTH]) begin
        failed = failed + 1;
        $display("arith_icarus: done at the wrong time, flt %b slw %b brh %b, time %0d", flt_done, slw_done, brh_done,
                 $time);
      end
      if (flt_due[FLT_DEPTH]) compare("flt", flt_data, flt_warp, due_data[FLT_DEPTH], due_warp[FLT_DEPTH]);
      if (slw_due[SLW_DEPTH]) compare("slw", slw_data, slw_warp, due_data[SLW_DEPTH], due_warp[SLW_DEPTH]);
      if (brh_due[BRH_DEPTH]) compare("brh", {31'd0, brh_pred}, brh_warp, due_data[BRH_DEPTH], due_warp[BRH_DEPTH]);
      for (k = SLW_DEPTH; k > 0; k = k - 1) begin
        due_data[k] = due_data[k-1];
        due_warp[k] = due_warp[k-1];
      end
      flt_due = flt_due << 1;
      slw_due = slw_due << 1;
      brh_due = brh_due << 1;
    end
  endtask

  task compare(input [23:0] name, input [31:0] data, input [2:0] from, input [31:0] good, input [2:0] good_from);
    begin
      if (data === good && from === good_from) agreed = agreed + 1;
      else begin
        failed = failed + 1;
        if (failed < 10)
          $display("arith_icarus: %0s gives %h for warp %0d, expected %h for %0d", name, data, from, good, good_from);
      end
    end
  endtask

  initial begin
    agreed = 0;
    failed = 0;
    if (!$value$plusargs("vectors=%s", path)) begin
      $display("arith_icarus: FAILED, no +vectors=FILE");
      $finish;
    end
    file = $fopen(path, "r");
    if (file == 0) begin
      $display("arith_icarus: FAILED, cannot read %0s", path);
      $finish;
    end
    repeat (3) @(negedge clk);
    rst_n = 1'b1;
    fields = $fscanf(file, "%h %h %h %h %h %h\n", unit, operation, a, b, c, expected);
    while (fields == 6) begin
      op = operation[4:0];
      warp = warp + 3'd1;
      flt_valid = unit == 0;
      slw_valid = unit == 1;
      brh_valid = unit == 2;
      #0 check;
      @(negedge clk);
      fields = $fscanf(file, "%h %h %h %h %h %h\n", unit, operation, a, b, c, expected);
    end
    flt_valid = 1'b0;
    slw_valid = 1'b0;
    brh_valid = 1'b0;
    for (drain = 0; drain <= SLW_DEPTH; drain = drain + 1) begin
      #0 check;
      @(negedge clk);
    end
    if (failed == 0 && agreed > 0) $display("arith_icarus: %0d results agree", agreed);
    else $display("arith_icarus: FAILED, %0d of %0d results differ", failed, agreed + failed);
    $finish;
  end
endmodule
`default_nettype wire
