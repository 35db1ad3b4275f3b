// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// 1, 2 or 4 compute units behind one set of ports: a block scheduler, and arbiters for memory, imports, exports and
// frame contributions. docs/machine/multiprocessor.md gives their cycles. With one unit all of it is wires.
// Promises: no output depends combinationally on an input (counter_o excepted, which depends on its selection); every
// valid/ready pair keeps its payload until taken; a ray's beats are not mixed with those of another unit.
// Must be given: what a compute unit must; beats of imports in the order of the requests, from the cycle after the
// request on.
`default_nettype none
module rp_multiprocessor #(
  parameter integer UNITS = 1,
`include "rp_unit_parameters.vh"
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1
) (
  input  wire                            clk_i,
  input  wire                            rst_ni,
  // for every unit: set by the host before a launch, constant while a kernel runs
  input  wire [15:0]                     program_length_i,   // instructions
  input  wire [31:0]                     memory_limit_i,     // bytes
  input  wire                            argument_write_i,   // while idle; invalidates the caches
  input  wire [4:0]                      argument_index_i,
  input  wire [31:0]                     argument_data_i,
  // launch of one block
  input  wire                            launch_valid_i,
  output wire                            launch_ready_o,
  output wire [1:0]                      launch_unit_o,      // that takes it in this cycle; valid with launch_ready_o
  input  wire [15:0]                     launch_pc_i,
  input  wire [10:0]                     launch_threads_i,   // 1 .. WARPS*LANES
  input  wire [31:0]                     launch_block_i,
  input  wire [31:0]                     launch_blocks_i,
  input  wire [1:0]                      launch_import_i,    // 0 none, 1 normal, 2 shadow
  // one bit a unit
  output wire [UNITS-1:0]                kernel_done_o,      // one cycle a kernel
  output wire [UNITS-1:0]                busy_o,             // a kernel is running
  output wire [UNITS-1:0]                idle_o,             // nothing runs, waits, is being exported or stored
  // packages that each unit's kernels have asked to export since reset, modulo 2^16; unit 0 in the low bits
  output wire [UNITS*16-1:0]             exports_o,
  // memory port; the upper two bits of an id are the unit's number
  output wire                            memory_request_valid_o,
  input  wire                            memory_request_ready_i,
  output wire                            memory_request_write_o,
  output wire [31:0]                     memory_request_address_o,
  output wire [127:0]                    memory_request_data_o,
  output wire [3:0]                      memory_request_mask_o,
  output wire [6:0]                      memory_request_id_o,
  input  wire                            memory_response_valid_i,
  input  wire [6:0]                      memory_response_id_i,
  input  wire [1:0]                      memory_response_beat_i,
  input  wire [127:0]                    memory_response_data_i,
  // pools
  output wire                            import_request_valid_o,
  output wire [1:0]                      import_request_kind_o,
  output wire [1:0]                      import_request_unit_o,
  input  wire                            import_request_ready_i,
  input  wire                            import_beat_valid_i,
  input  wire [127:0]                    import_beat_data_i,
  output wire                            export_valid_o,
  input  wire                            export_ready_i,
  output wire [127:0]                    export_data_o,
  output wire                            export_last_o,
  output wire [1:0]                      export_unit_o,
  // frame buffer
  output wire                            frame_valid_o,
  input  wire                            frame_ready_i,
  output wire [31:0]                     frame_pixel_o,
  output wire [95:0]                     frame_color_o,      // red in the low word
  output wire [1:0]                      frame_unit_o,
  // the first unit's fault, sticky; the other units go on
  output wire                            fault_valid_o,
  output wire [3:0]                      fault_code_o,
  output wire [WARP_BITS-1:0]            fault_warp_o,
  output wire [15:0]                     fault_pc_o,
  output wire [1:0]                      fault_unit_o,
  // performance counters, docs/machine/architecture.md
  input  wire [1:0]                      counter_unit_i,
  input  wire [5:0]                      counter_select_i,
  output wire [63:0]                     counter_o,          // the exception: depends on counter_*_i
  // trace of each unit, valid in the cycle of write-back; unit 0 in the low bits
  output wire [UNITS*WARPS-1:0]          retire_valid_o,
  output wire [UNITS*WARPS*16-1:0]       retire_pc_o,
  output wire [UNITS*WARPS*64-1:0]       retire_instruction_o,
  output wire [UNITS*WARPS*LANES-1:0]    retire_mask_o,
  output wire [UNITS*WARPS*LANES*32-1:0] retire_data_o,
  output wire [UNITS*WARPS*LANES-1:0]    retire_predicate_o,
  output wire [UNITS-1:0]                store_trace_valid_o,
  output wire [UNITS*WARP_BITS-1:0]      store_trace_warp_o,
  output wire [UNITS*32-1:0]             store_trace_address_o,
  output wire [UNITS*128-1:0]            store_trace_data_o,
  output wire [UNITS*4-1:0]              store_trace_mask_o,
  output wire [UNITS-1:0]                ray_trace_valid_o,
  output wire [UNITS*WARP_BITS-1:0]      ray_trace_warp_o,
  output wire [UNITS*5-1:0]              ray_trace_word_o,
  output wire [UNITS*LANES-1:0]          ray_trace_mask_o,
  output wire [UNITS*LANES*32-1:0]       ray_trace_data_o
);
  generate
    if (UNITS != 1 && UNITS != 2 && UNITS != 4) begin : gen_bad_units
      multiprocessor_UNITS_must_be_1_2_or_4 illegal ();
    end
  endgenerate

  // of each unit, unit 0 in the low bits
  wire [UNITS-1:0] launch_valid, launch_ready;
  wire [UNITS-1:0] request_valid, request_ready, request_write, response_valid;
  wire [UNITS*32-1:0] request_address;
  wire [UNITS*128-1:0] request_data;
  wire [UNITS*4-1:0] request_mask;
  wire [UNITS*5-1:0] request_id;
  wire [UNITS-1:0] import_valid, import_ready, beat_valid;
  wire [UNITS*2-1:0] import_kind;
  wire [UNITS-1:0] export_valid, export_ready, export_last;
  wire [UNITS*129-1:0] export_beat;                  // last, data
  wire [UNITS-1:0] frame_valid, frame_ready;
  wire [UNITS*128-1:0] frame;                        // color, pixel
  localparam integer FAULT_BITS = 4 + WARP_BITS + 16;
  wire [UNITS-1:0] fault_valid;
  wire [UNITS*FAULT_BITS-1:0] fault;                 // code, warp, PC
  wire [UNITS*64-1:0] counter;

  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      rp_compute_unit #(
`include "rp_unit_parameter_map.vh"
        .UNIT(SHARING != 0 ? u : 0), .WARP_BITS(WARP_BITS)
      ) compute_unit (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .program_length_i(program_length_i),
        .memory_limit_i(memory_limit_i),
        .argument_write_i(argument_write_i),
        .argument_index_i(argument_index_i),
        .argument_data_i(argument_data_i),
        .launch_valid_i(launch_valid[u]),
        .launch_ready_o(launch_ready[u]),
        .launch_pc_i(launch_pc_i),
        .launch_threads_i(launch_threads_i),
        .launch_block_i(launch_block_i),
        .launch_blocks_i(launch_blocks_i),
        .launch_import_i(launch_import_i),
        .kernel_done_o(kernel_done_o[u]),
        .busy_o(busy_o[u]),
        .idle_o(idle_o[u]),
        .memory_request_valid_o(request_valid[u]),
        .memory_request_ready_i(request_ready[u]),
        .memory_request_write_o(request_write[u]),
        .memory_request_address_o(request_address[u*32 +: 32]),
        .memory_request_data_o(request_data[u*128 +: 128]),
        .memory_request_mask_o(request_mask[u*4 +: 4]),
        .memory_request_id_o(request_id[u*5 +: 5]),
        .memory_response_valid_i(response_valid[u]),
        .memory_response_id_i(memory_response_id_i[4:0]),
        .memory_response_beat_i(memory_response_beat_i),
        .memory_response_data_i(memory_response_data_i),
        .import_request_valid_o(import_valid[u]),
        .import_request_kind_o(import_kind[u*2 +: 2]),
        .import_request_ready_i(import_ready[u]),
        .import_beat_valid_i(beat_valid[u]),
        .import_beat_data_i(import_beat_data_i),
        .export_valid_o(export_valid[u]),
        .export_ready_i(export_ready[u]),
        .export_data_o(export_beat[u*129 +: 128]),
        .export_last_o(export_last[u]),
        .exports_o(exports_o[u*16 +: 16]),
        .frame_valid_o(frame_valid[u]),
        .frame_ready_i(frame_ready[u]),
        .frame_pixel_o(frame[u*128 +: 32]),
        .frame_color_o(frame[u*128 + 32 +: 96]),
        .fault_valid_o(fault_valid[u]),
        .fault_code_o(fault[u*FAULT_BITS + 16 + WARP_BITS +: 4]),
        .fault_warp_o(fault[u*FAULT_BITS + 16 +: WARP_BITS]),
        .fault_pc_o(fault[u*FAULT_BITS +: 16]),
        .counter_select_i(counter_select_i),
        .counter_o(counter[u*64 +: 64]),
        .retire_valid_o(retire_valid_o[u*WARPS +: WARPS]),
        .retire_pc_o(retire_pc_o[u*WARPS*16 +: WARPS*16]),
        .retire_instruction_o(retire_instruction_o[u*WARPS*64 +: WARPS*64]),
        .retire_mask_o(retire_mask_o[u*WARPS*LANES +: WARPS*LANES]),
        .retire_data_o(retire_data_o[u*WARPS*LANES*32 +: WARPS*LANES*32]),
        .retire_predicate_o(retire_predicate_o[u*WARPS*LANES +: WARPS*LANES]),
        .store_trace_valid_o(store_trace_valid_o[u]),
        .store_trace_warp_o(store_trace_warp_o[u*WARP_BITS +: WARP_BITS]),
        .store_trace_address_o(store_trace_address_o[u*32 +: 32]),
        .store_trace_data_o(store_trace_data_o[u*128 +: 128]),
        .store_trace_mask_o(store_trace_mask_o[u*4 +: 4]),
        .ray_trace_valid_o(ray_trace_valid_o[u]),
        .ray_trace_warp_o(ray_trace_warp_o[u*WARP_BITS +: WARP_BITS]),
        .ray_trace_word_o(ray_trace_word_o[u*5 +: 5]),
        .ray_trace_mask_o(ray_trace_mask_o[u*LANES +: LANES]),
        .ray_trace_data_o(ray_trace_data_o[u*LANES*32 +: LANES*32])
      );
      assign export_beat[u*129 + 128] = export_last[u];
    end

    if (UNITS == 1) begin : gen_one
      wire [3:0] unused = {counter_unit_i, memory_response_id_i[6:5]};
      assign launch_valid = launch_valid_i;
      assign launch_ready_o = launch_ready;
      assign launch_unit_o = 2'd0;
      assign memory_request_valid_o = request_valid;
      assign request_ready = memory_request_ready_i;
      assign memory_request_write_o = request_write;
      assign memory_request_address_o = request_address;
      assign memory_request_data_o = request_data;
      assign memory_request_mask_o = request_mask;
      assign memory_request_id_o = {2'd0, request_id};
      assign response_valid = memory_response_valid_i;
      assign import_request_valid_o = import_valid;
      assign import_request_kind_o = import_kind;
      assign import_request_unit_o = 2'd0;
      assign import_ready = import_request_ready_i;
      assign beat_valid = import_beat_valid_i;
      assign export_valid_o = export_valid;
      assign export_ready = export_ready_i;
      assign {export_last_o, export_data_o} = export_beat;
      assign export_unit_o = 2'd0;
      assign frame_valid_o = frame_valid;
      assign frame_ready = frame_ready_i;
      assign {frame_color_o, frame_pixel_o} = frame;
      assign frame_unit_o = 2'd0;
      assign fault_valid_o = fault_valid;
      assign {fault_code_o, fault_warp_o, fault_pc_o} = fault;
      assign fault_unit_o = 2'd0;
      assign counter_o = counter;
    end else begin : gen_several
      rp_block_scheduler #(.UNITS(UNITS)) block_scheduler (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .launch_valid_i(launch_valid_i),
        .launch_ready_o(launch_ready_o),
        .launch_unit_o(launch_unit_o),
        .ready_i(launch_ready),
        .busy_i(busy_o),
        .valid_o(launch_valid)
      );

      rp_unit_memory_arbiter #(.UNITS(UNITS)) unit_memory_arbiter (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .unit_request_valid_i(request_valid),
        .unit_request_ready_o(request_ready),
        .unit_request_write_i(request_write),
        .unit_request_address_i(request_address),
        .unit_request_data_i(request_data),
        .unit_request_mask_i(request_mask),
        .unit_request_id_i(request_id),
        .unit_response_valid_o(response_valid),
        .request_valid_o(memory_request_valid_o),
        .request_ready_i(memory_request_ready_i),
        .request_write_o(memory_request_write_o),
        .request_address_o(memory_request_address_o),
        .request_data_o(memory_request_data_o),
        .request_mask_o(memory_request_mask_o),
        .request_id_o(memory_request_id_o),
        .response_valid_i(memory_response_valid_i),
        .response_unit_i(memory_response_id_i[6:5])
      );

      rp_import_arbiter #(.UNITS(UNITS), .INTERSECTION_WORDS(INTERSECTION_WORDS)) import_arbiter (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .unit_request_valid_i(import_valid),
        .unit_request_ready_o(import_ready),
        .unit_request_kind_i(import_kind),
        .unit_beat_valid_o(beat_valid),
        .request_valid_o(import_request_valid_o),
        .request_ready_i(import_request_ready_i),
        .request_kind_o(import_request_kind_o),
        .request_unit_o(import_request_unit_o),
        .beat_valid_i(import_beat_valid_i)
      );

      // A ray is a package of three transfers.
      rp_port_arbiter #(.COUNT(UNITS), .WIDTH(129)) export_arbiter (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .valid_i(export_valid),
        .ready_o(export_ready),
        .data_i(export_beat),
        .last_i(export_last),
        .valid_o(export_valid_o),
        .ready_i(export_ready_i),
        .data_o({export_last_o, export_data_o}),
        .number_o(export_unit_o)
      );

      rp_port_arbiter #(.COUNT(UNITS), .WIDTH(128)) frame_arbiter (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .valid_i(frame_valid),
        .ready_o(frame_ready),
        .data_i(frame),
        .last_i({UNITS{1'b1}}),
        .valid_o(frame_valid_o),
        .ready_i(frame_ready_i),
        .data_o({frame_color_o, frame_pixel_o}),
        .number_o(frame_unit_o)
      );

      // Never taken: the fault that is shown first stays.
      wire [UNITS-1:0] unused;
      rp_port_arbiter #(.COUNT(UNITS), .WIDTH(FAULT_BITS)) fault_arbiter (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .valid_i(fault_valid),
        .ready_o(unused),
        .data_i(fault),
        .last_i({UNITS{1'b1}}),
        .valid_o(fault_valid_o),
        .ready_i(1'b0),
        .data_o({fault_code_o, fault_warp_o, fault_pc_o}),
        .number_o(fault_unit_o)
      );

      assign counter_o = counter[counter_unit_i*64 +: 64];
    end
  endgenerate
endmodule
`default_nettype wire
