// Replays a recorded program on compute_unit in a 4-state simulator: vvp -n unit_replay.vvp +vectors=FILE, which
// sim/cosim/vector_recorder.hpp has written.
// The parameters of the unit come as the macro UNIT_PARAMETERS, ".WARPS(2), .LANES(2), ...", so
// that they need not be repeated here.
`default_nettype none
`timescale 1ns / 1ns
module unit_replay #(
  parameter integer WARPS = 2,
  parameter integer LANES = 2
);
  localparam integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1;
  localparam integer RETIRE_BITS = 1 + 16 + 64 + LANES + LANES * 32 + LANES;
  localparam integer IN_BITS = 1 + 16 + 32 + 38 + 94 + 1 + 136 + 1 + 129 + 2;
  localparam integer OUT_BITS = 4 + 171 + 3 + 130 + 16 + 129 + 1 + 4 + WARP_BITS + 16 + WARPS * RETIRE_BITS + 1 +
                                WARP_BITS + 164 + 1 + WARP_BITS + 5 + LANES + LANES * 32;

  reg clk = 1'b0;
  reg [IN_BITS-1:0] in;

  // Inputs, the highest bits first.
  wire        rst_n, argument_write, launch_valid, memory_request_ready, memory_response_valid, import_request_ready;
  wire        import_beat_valid, export_ready, frame_ready;
  wire [15:0] program_length, launch_pc;
  wire [31:0] memory_limit, argument_data, launch_block, launch_blocks;
  wire [4:0]  argument_index, memory_response_id;
  wire [10:0] launch_threads;
  wire [1:0]  launch_import, memory_response_beat;
  wire [127:0] memory_response_data, import_beat_data;
  assign {rst_n, program_length, memory_limit, argument_write, argument_index, argument_data, launch_valid, launch_pc,
          launch_threads, launch_block, launch_blocks, launch_import, memory_request_ready, memory_response_valid,
          memory_response_id, memory_response_beat, memory_response_data, import_request_ready, import_beat_valid,
          import_beat_data, export_ready, frame_ready} = in;

  // Outputs.
  wire        launch_ready, kernel_done, busy, idle, memory_request_valid, memory_request_write, import_request_valid;
  wire        export_valid, export_last, frame_valid, fault_valid, store_trace_valid, ray_trace_valid;
  wire [31:0] memory_request_address, frame_pixel, store_trace_address;
  wire [127:0] memory_request_data, export_data, store_trace_data;
  wire [3:0]  memory_request_mask, fault_code, store_trace_mask;
  wire [4:0]  memory_request_id, ray_trace_word;
  wire [1:0]  import_request_kind;
  wire [95:0] frame_color;
  wire [WARP_BITS-1:0] fault_warp, store_trace_warp, ray_trace_warp;
  wire [15:0] exports, fault_pc;
  wire [63:0] counter;
  wire [WARPS-1:0] retire_valid;
  wire [WARPS*16-1:0] retire_pc;
  wire [WARPS*64-1:0] retire_instruction;
  wire [WARPS*LANES-1:0] retire_mask, retire_predicate;
  wire [WARPS*LANES*32-1:0] retire_data;
  wire [LANES-1:0] ray_trace_mask;
  wire [LANES*32-1:0] ray_trace_data;

  rp_compute_unit #(`UNIT_PARAMETERS) unit (
    .clk_i(clk), .rst_ni(rst_n), .program_length_i(program_length), .memory_limit_i(memory_limit),
    .argument_write_i(argument_write), .argument_index_i(argument_index), .argument_data_i(argument_data),
    .launch_valid_i(launch_valid), .launch_ready_o(launch_ready), .launch_pc_i(launch_pc),
    .launch_threads_i(launch_threads), .launch_block_i(launch_block), .launch_blocks_i(launch_blocks),
    .launch_import_i(launch_import), .kernel_done_o(kernel_done), .busy_o(busy), .idle_o(idle),
    .memory_request_valid_o(memory_request_valid), .memory_request_ready_i(memory_request_ready),
    .memory_request_write_o(memory_request_write), .memory_request_address_o(memory_request_address),
    .memory_request_data_o(memory_request_data), .memory_request_mask_o(memory_request_mask),
    .memory_request_id_o(memory_request_id), .memory_response_valid_i(memory_response_valid),
    .memory_response_id_i(memory_response_id), .memory_response_beat_i(memory_response_beat),
    .memory_response_data_i(memory_response_data), .import_request_valid_o(import_request_valid),
    .import_request_kind_o(import_request_kind), .import_request_ready_i(import_request_ready),
    .import_beat_valid_i(import_beat_valid), .import_beat_data_i(import_beat_data), .export_valid_o(export_valid),
    .export_ready_i(export_ready), .export_data_o(export_data), .export_last_o(export_last), .exports_o(exports),
    .frame_valid_o(frame_valid), .frame_ready_i(frame_ready), .frame_pixel_o(frame_pixel), .frame_color_o(frame_color),
    .fault_valid_o(fault_valid), .fault_code_o(fault_code), .fault_warp_o(fault_warp), .fault_pc_o(fault_pc),
    .counter_select_i(6'd1), .counter_o(counter), .retire_valid_o(retire_valid), .retire_pc_o(retire_pc),
    .retire_instruction_o(retire_instruction), .retire_mask_o(retire_mask), .retire_data_o(retire_data),
    .retire_predicate_o(retire_predicate), .store_trace_valid_o(store_trace_valid),
    .store_trace_warp_o(store_trace_warp), .store_trace_address_o(store_trace_address),
    .store_trace_data_o(store_trace_data), .store_trace_mask_o(store_trace_mask), .ray_trace_valid_o(ray_trace_valid),
    .ray_trace_warp_o(ray_trace_warp), .ray_trace_word_o(ray_trace_word), .ray_trace_mask_o(ray_trace_mask),
    .ray_trace_data_o(ray_trace_data));

  wire [WARPS*RETIRE_BITS-1:0] retirements;   // the highest warp first
  genvar w;
  generate
    for (w = 0; w < WARPS; w = w + 1) begin : gen_retirement
      assign retirements[w*RETIRE_BITS +: RETIRE_BITS] = {
        retire_valid[w], retire_pc[w*16 +: 16], retire_instruction[w*64 +: 64], retire_mask[w*LANES +: LANES],
        retire_data[w*LANES*32 +: LANES*32], retire_predicate[w*LANES +: LANES]};
    end
  endgenerate
  wire [OUT_BITS-1:0] actual = {
    launch_ready, kernel_done, busy, idle, memory_request_valid, memory_request_write, memory_request_address,
    memory_request_data, memory_request_mask, memory_request_id, import_request_valid, import_request_kind,
    export_valid, export_data, export_last, exports, frame_valid, frame_pixel, frame_color, fault_valid, fault_code,
    fault_warp, fault_pc, retirements, store_trace_valid, store_trace_warp, store_trace_address, store_trace_data,
    store_trace_mask, ray_trace_valid, ray_trace_warp, ray_trace_word, ray_trace_mask, ray_trace_data};
  reg [5:0] events;                           // instructions that retire
  localparam REPLAYED = "instructions retire";
  integer n;
  always @* begin
    events = 6'd0;
    for (n = 0; n < WARPS; n = n + 1) events = events + {5'd0, retire_valid[n]};
  end
`include "replay.vh"

  integer warp;
  task explain;
    begin
      field("launch_ready", 1); field("kernel_done", 1); field("busy", 1); field("idle", 1);
      field("memory_request_valid", 1); field("memory_request_write", 1); field("memory_request_address", 32);
      field("memory_request_data", 128); field("memory_request_mask", 4); field("memory_request_id", 5);
      field("import_request_valid", 1); field("import_request_kind", 2); field("export_valid", 1);
      field("export_data", 128);
      field("export_last", 1); field("exports", 16);
      field("frame_valid", 1); field("frame_pixel", 32); field("frame_color", 96);
      field("fault_valid", 1); field("fault_code", 4); field("fault_warp", WARP_BITS); field("fault_pc", 16);
      for (warp = WARPS - 1; warp >= 0; warp = warp - 1) begin
        field("retire_valid", 1); field("retire_pc", 16); field("retire_instruction", 64); field("retire_mask", LANES);
        field("retire_data", LANES * 32); field("retire_predicate", LANES);
      end
      field("store_trace_valid", 1); field("store_trace_warp", WARP_BITS); field("store_trace_address", 32);
      field("store_trace_data", 128); field("store_trace_mask", 4);
      field("ray_trace_valid", 1); field("ray_trace_warp", WARP_BITS); field("ray_trace_word", 5);
      field("ray_trace_mask", LANES);
      field("ray_trace_data", LANES * 32);
    end
  endtask
endmodule
`default_nettype wire
