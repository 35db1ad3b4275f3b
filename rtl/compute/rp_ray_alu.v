// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray ALU: three sets of local ray memory, of which every warp has a slice each; the slices change roles (input,
// current, output) warp by warp. docs/machine/ray-alu.md has the contract and the cycles.
// Promises: rin, rout and rfb that have to wait do not block other warps; every task of a warp sees the effects of the
// warp's earlier ones.
// Must be given: one task at a time of a warp; tasks only after ready_o; for each package requested its beats, in
// order.
`default_nettype none
module rp_ray_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer INTERSECTION_WORDS = 21,
  parameter integer WIDE_RAY_MEMORY = 0   // rld and rst move all lanes a cycle, else four
) (
  // import of a launch: one cycle of start, not while import_active_o, which is high from the next cycle on
  input  wire                   import_start_i,
  input  wire [1:0]             import_start_kind_i,      // 0 none, 1 normal, 2 shadow
  input  wire [10:0]            import_start_threads_i,   // 1 .. WARPS*LANES
  output wire                   import_active_o,          // packages are left to be requested or received
  // intersection pool
  output wire                   import_request_valid_o,
  output wire [1:0]             import_request_kind_o,
  input  wire                   import_request_ready_i,
  input  wire                   import_beat_valid_i,
  input  wire [127:0]           import_beat_data_i,
  // ray pool
  output wire                   export_valid_o,
  input  wire                   export_ready_i,
  output wire [127:0]           export_data_o,
  output wire                   export_last_o,
  // frame buffer
  output wire                   frame_valid_o,
  input  wire                   frame_ready_i,
  output wire [31:0]            frame_pixel_o,
  output wire [95:0]            frame_color_o,
  output wire                   exporting_o,              // something waits to be exported
  output wire [15:0]            exports_o,                // packages of the rout and rfb that have arrived, modulo 2^16
  // for the performance counters: rin without its package; rout or rfb behind one that is still being exported
  output wire [WARPS-1:0]       import_wait_o,
  output wire [WARPS-1:0]       export_wait_o,
  // trace: one cycle for each rst, that of its done_valid_o
  output wire                   ray_trace_valid_o,
  output wire [WARP_BITS-1:0]   ray_trace_warp_o,
  output wire [4:0]             ray_trace_word_o,
  output wire [LANES-1:0]       ray_trace_mask_o,
  output wire [LANES*32-1:0]    ray_trace_data_o,
  // one cycle; the task is dropped
  output wire                   fault_valid_o,
  output wire [3:0]             fault_code_o,
  output wire [WARP_BITS-1:0]   fault_warp_o,
  // ALU framework
`include "rp_alu_ports.vh"
);
  `include "rp_isa.vh"
  localparam integer LANE_BITS = $clog2(LANES);
  localparam integer BANKS = (WIDE_RAY_MEMORY != 0 && LANES > 4) ? LANES : 4;   // of a set
  localparam integer BANK_BITS = $clog2(BANKS);
  localparam integer STEPS = (LANES > BANKS) ? LANES / BANKS : 1;   // port cycles of an access: rld, rst
  localparam integer LAST_STEP = STEPS - 1;
  localparam integer LAST_WORD = INTERSECTION_WORDS - 1;
  localparam [LANES-1:0] NO_LANE = 0;

  // ---- Roles: which set is a warp's input, current and output.
  reg [WARPS*2-1:0] input_q, current_q, output_q;

  // ---- Arrival. A task is an access or a swap; a swap is parked.
  wire task_access = task_operation_i == ISA_RAY_RLD || task_operation_i == ISA_RAY_RST;
  wire task_legal = task_word_i <= LAST_WORD[4:0];
  wire arrive_access = task_valid_i && task_access && task_legal;
  wire arrive_swap = task_valid_i && !task_access;
  wire arrive_out = arrive_swap && task_operation_i != ISA_RAY_RIN;
  wire [1:0] task_set = current_q[task_warp_i*2 +: 2];

  // ---- Import has the port of its set whenever it writes.
  wire         import_write;
  wire [1:0]   import_set;
  wire [9:0]   import_thread;
  wire [4:0]   import_word;
  wire [7:0]   import_mask;
  wire [255:0] import_data;

  // ---- Access. Its first step may be made in the cycle of arrival, from the task's ports; later ones are made from
  // what was held.
  reg                hold_q;                 // steps are left
  reg [2:0]          step_q;                 // 0 while nothing is held
  reg [WARP_BITS-1:0] hold_warp_q;
  reg [1:0]          hold_set_q;
  reg [4:0]          hold_word_q;
  reg                hold_write_q;
  reg [LANES-1:0]    hold_mask_q;
  reg [LANES*32-1:0] hold_data_q;

  wire access = hold_q || arrive_access;
  wire [WARP_BITS-1:0] access_warp = hold_q ? hold_warp_q : task_warp_i;
  wire [1:0] access_set = hold_q ? hold_set_q : task_set;
  wire [4:0] access_word = hold_q ? hold_word_q : task_word_i;
  wire access_write = hold_q ? hold_write_q : task_operation_i == ISA_RAY_RST;
  wire access_last = step_q == LAST_STEP[2:0];
  wire access_granted = access && !(import_write && import_set == access_set);
  // The thread of the step's first lane
  wire [9:0] access_lane = ({{10-WARP_BITS{1'b0}}, access_warp} << LANE_BITS) | {5'd0, step_q, 2'b00};
  wire [9:0] access_thread = {access_lane[9:BANK_BITS], {BANK_BITS{1'b0}}};
  reg [BANKS-1:0] access_mask;
  reg [BANKS*32-1:0] access_data;

  // What arrives is executed at once when nothing is held after this cycle. Of an access that arrives now this only
  // looks at what is quickly known: it has one step, and no import is in the way of any set.
  assign ready_o = hold_q ? access_last && !(import_write && import_set == hold_set_q)
                          : !(task_valid_i && task_access && (STEPS > 1 || import_write));

  always @(posedge clk_i) begin
    if (!rst_ni) begin
      hold_q <= 1'b0;
      step_q <= 3'd0;
    end else if (access) begin
      hold_q <= !(access_granted && access_last);
      if (access_granted) step_q <= access_last ? 3'd0 : step_q + 3'd1;
    end
    if (arrive_access) begin
      hold_warp_q <= task_warp_i;
      hold_set_q <= task_set;
      hold_word_q <= task_word_i;
      hold_write_q <= task_operation_i == ISA_RAY_RST;
      if (task_operation_i == ISA_RAY_RST) begin
        hold_mask_q <= task_mask_i;
        hold_data_q <= task_operand_b_i;
      end
    end
  end

  // ---- Result: the cycle after a step. The held task is still that of the step.
  reg result_q, result_last_q;
  reg [2:0] result_step_q;
  reg [BANKS*32-1:0] result_read;
  reg [LANES*32-1:0] done_data_q;
  wire [3*BANKS*32-1:0] memory_data;
  wire result_end = result_q && result_last_q;

  always @* begin
    result_read = memory_data[0 +: BANKS*32];
    if (result_q)
      case (hold_set_q)
        2'd0: result_read = memory_data[0 +: BANKS*32];
        2'd1: result_read = memory_data[BANKS*32 +: BANKS*32];
        default: result_read = memory_data[2*BANKS*32 +: BANKS*32];
      endcase
  end

  always @(posedge clk_i) begin
    if (!rst_ni) result_q <= 1'b0;
    else result_q <= access_granted;
    if (access_granted) begin
      result_step_q <= step_q;
      result_last_q <= access_last;
    end
  end

  // The lanes of a step and the elements of its memory access
  generate
    if (STEPS > 1) begin : gen_wide
      localparam integer STEP_BITS = $clog2(STEPS);
      wire [STEP_BITS-1:0] step = step_q[STEP_BITS-1:0];
      wire [STEP_BITS-1:0] result_step = result_step_q[STEP_BITS-1:0];
      wire unused_wide = &{1'b0, access_lane, result_step_q};
      always @* begin
        access_mask = 4'd0;
        access_data = 128'd0;
        if (access && access_write) begin
          access_mask = hold_q ? hold_mask_q[{step, 2'b00} +: 4] : task_mask_i[3:0];
          access_data = hold_q ? hold_data_q[{step, 7'd0} +: 128] : task_operand_b_i[127:0];
        end
      end
      always @(posedge clk_i)
        if (result_q) begin
          if (!hold_write_q) done_data_q[{result_step, 7'd0} +: 128] <= result_read;
          else if (result_last_q) done_data_q <= hold_data_q;
        end
    end else begin : gen_narrow
      // Several warps may share a row of threads: the element's number is the lower bits of the thread's.
      wire [9:0] hold_lane = {{10-WARP_BITS{1'b0}}, hold_warp_q} << LANE_BITS;
      wire [BANKS*32-1:0] elements = result_read >> {hold_lane[BANK_BITS-1:0], 5'd0};
      wire unused_narrow = &{1'b0, hold_lane, elements, result_step_q};
      reg [BANKS-1:0] lanes;
      always @* begin
        lanes = {BANKS{1'b0}};
        access_mask = {BANKS{1'b0}};
        access_data = {BANKS{32'd0}};
        if (access && access_write) begin
          lanes[LANES-1:0] = hold_q ? hold_mask_q : task_mask_i;
          access_mask = lanes << access_lane[BANK_BITS-1:0];
          access_data = hold_q ? {BANKS/LANES{hold_data_q}} : {BANKS/LANES{task_operand_b_i}};
        end
      end
      always @(posedge clk_i)
        if (result_q) done_data_q <= hold_write_q ? hold_data_q : elements[LANES*32-1:0];
    end
  endgenerate

  // ---- Swaps. One a cycle, of the lowest warp that can; the done port goes to an access first.
  reg [WARPS-1:0] parked_in_q, parked_out_q, parked_empty_q;   // rin; rout or rfb; of these with an empty mask
  wire [WARPS-1:0] full, busy;
  wire [WARPS-1:0] can = (parked_in_q & full) | (parked_out_q & ~busy);
  assign import_wait_o = parked_in_q & ~full;
  assign export_wait_o = parked_out_q & busy;
  wire swap = |can && !result_end;
  reg [WARP_BITS-1:0] swap_warp;
  integer w;
  always @* begin
    swap_warp = {WARP_BITS{1'b0}};
    if (|can)
      for (w = WARPS - 1; w >= 0; w = w - 1)
        if (can[w]) swap_warp = w[WARP_BITS-1:0];
  end
  wire swap_in = swap && parked_in_q[swap_warp];
  wire swap_out = swap && !parked_in_q[swap_warp];

  always @(posedge clk_i)
    if (!rst_ni) begin
      parked_in_q <= {WARPS{1'b0}};
      parked_out_q <= {WARPS{1'b0}};
      input_q <= {WARPS{2'd0}};
      current_q <= {WARPS{2'd1}};
      output_q <= {WARPS{2'd2}};
    end else begin
      if (arrive_swap) begin
        if (arrive_out) parked_out_q[task_warp_i] <= 1'b1;
        else parked_in_q[task_warp_i] <= 1'b1;
        parked_empty_q[task_warp_i] <= task_mask_i == NO_LANE;
      end
      if (swap_in) begin
        parked_in_q[swap_warp] <= 1'b0;
        input_q[swap_warp*2 +: 2] <= current_q[swap_warp*2 +: 2];
        current_q[swap_warp*2 +: 2] <= input_q[swap_warp*2 +: 2];
      end
      if (swap_out) begin
        parked_out_q[swap_warp] <= 1'b0;
        output_q[swap_warp*2 +: 2] <= current_q[swap_warp*2 +: 2];
        current_q[swap_warp*2 +: 2] <= output_q[swap_warp*2 +: 2];
      end
    end

  // ---- Packages that rout and rfb have asked to export
  function [5:0] lanes_of(input [LANES-1:0] mask);
    integer l;
    begin
      lanes_of = 6'd0;
      for (l = 0; l < LANES; l = l + 1) lanes_of = lanes_of + {5'd0, mask[l]};
    end
  endfunction
  reg [15:0] exports_q;
  always @(posedge clk_i)
    if (!rst_ni) exports_q <= 16'd0;
    else if (arrive_out) exports_q <= exports_q + {10'd0, lanes_of(task_mask_i)};
  assign exports_o = exports_q;

  // ---- Done, trace, fault
  reg done_q, trace_q, fault_q;
  reg [WARP_BITS-1:0] done_warp_q, fault_warp_q;
  reg [4:0] trace_word_q;
  reg [LANES-1:0] trace_mask_q;
  always @(posedge clk_i) begin
    if (!rst_ni) begin
      done_q <= 1'b0;
      trace_q <= 1'b0;
      fault_q <= 1'b0;
    end else begin
      done_q <= result_end || swap;
      trace_q <= result_end && hold_write_q;
      fault_q <= task_valid_i && task_access && !task_legal;
    end
    if (result_end) begin
      done_warp_q <= hold_warp_q;
      trace_word_q <= hold_word_q;
      trace_mask_q <= hold_mask_q;
    end else if (swap) begin
      done_warp_q <= swap_warp;
    end
    if (task_valid_i) fault_warp_q <= task_warp_i;
  end
  assign done_valid_o = done_q;
  assign done_warp_o = done_warp_q;
  assign done_data_o = done_data_q;
  assign done_predicate_o = NO_LANE;
  assign ray_trace_valid_o = trace_q;
  assign ray_trace_warp_o = done_warp_q;
  assign ray_trace_word_o = trace_word_q;
  assign ray_trace_mask_o = trace_mask_q;
  assign ray_trace_data_o = done_data_q;   // an rst leaves its operand there
  assign fault_valid_o = fault_q;
  assign fault_code_o = {1'b0, {3{fault_q}}};
  assign fault_warp_o = fault_warp_q;

  // ---- Engines
  rp_ray_import #(
    .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .INTERSECTION_WORDS(INTERSECTION_WORDS), .WIDE(BANKS > 4)
  ) ray_import (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i(import_start_i),
    .start_kind_i(import_start_kind_i),
    .start_threads_i(import_start_threads_i),
    .active_o(import_active_o),
    .request_valid_o(import_request_valid_o),
    .request_kind_o(import_request_kind_o),
    .request_ready_i(import_request_ready_i),
    .beat_valid_i(import_beat_valid_i),
    .beat_data_i(import_beat_data_i),
    .input_set_i(input_q),
    .full_o(full),
    .take_i(swap_in),
    .take_warp_i(swap_warp),
    .write_o(import_write),
    .write_set_o(import_set),
    .write_thread_o(import_thread),
    .write_word_o(import_word),
    .write_mask_o(import_mask),
    .write_data_o(import_data)
  );

  // As elements of an access to a set
  localparam integer IMPORTED = (BANKS > 4) ? 8 : 4;   // words a cycle
  wire unused_import = &{1'b0, import_mask, import_data};   // the upper half, if it is not written
  reg [BANKS-1:0] import_banks;
  reg [BANKS*32-1:0] import_elements;
  always @* begin
    import_banks = {BANKS{1'b0}};
    import_banks[IMPORTED-1:0] = import_mask[IMPORTED-1:0];
    import_elements = {BANKS/IMPORTED{import_data[IMPORTED*32-1:0]}};
  end

  wire [3*128-1:0] package_data;
  wire       export_read, export_granted;
  wire [1:0] export_set;
  wire [9:0] export_thread;
  wire [4:0] export_word;
  assign export_granted = export_read && !(import_write && import_set == export_set) &&
                          !(access && access_set == export_set);

  rp_ray_export #(.WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS)) ray_export (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .park_i(arrive_out),
    .park_warp_i(task_warp_i),
    .park_frame_i(task_operation_i == ISA_RAY_RFB),
    .park_mask_i(task_mask_i),
    .push_i(swap_out && !parked_empty_q[swap_warp]),
    .push_warp_i(swap_warp),
    .output_set_i(output_q),
    .busy_o(busy),
    .exporting_o(exporting_o),
    .read_o(export_read),
    .read_set_o(export_set),
    .read_thread_o(export_thread),
    .read_word_o(export_word),
    .read_grant_i(export_granted),
    .memory_data_i(package_data),
    .export_valid_o(export_valid_o),
    .export_ready_i(export_ready_i),
    .export_data_o(export_data_o),
    .export_last_o(export_last_o),
    .frame_valid_o(frame_valid_o),
    .frame_ready_i(frame_ready_i),
    .frame_pixel_o(frame_pixel_o),
    .frame_color_o(frame_color_o)
  );

  // ---- The three sets. The port goes to import, then to the kernel's access, then to export. Of a package's access
  // only the first four elements count.
  genvar s;
  generate
    for (s = 0; s < 3; s = s + 1) begin : gen_set
      localparam [1:0] SET = s;
      wire by_import = import_write && import_set == SET;
      wire by_access = access && access_set == SET && !by_import;
      wire by_export = export_read && export_set == SET && !by_import && !by_access;
      rp_ray_memory #(.CONTENTS(WARPS * LANES), .WORDS(INTERSECTION_WORDS), .BANKS(BANKS)) ray_memory (
        .clk_i(clk_i),
        .read_i((by_access && !access_write) || by_export),
        .write_i(by_import ? import_banks : by_access ? access_mask : {BANKS{1'b0}}),
        .package_i(by_import || by_export),
        .thread_i(by_import ? import_thread : by_access ? access_thread : export_thread),
        .word_i(by_import ? import_word : by_access ? access_word : export_word),
        .data_i(by_import ? import_elements : access_data),
        .data_o(memory_data[s*BANKS*32 +: BANKS*32])
      );
      assign package_data[s*128 +: 128] = memory_data[s*BANKS*32 +: 128];
    end
  endgenerate
endmodule
`default_nettype wire
