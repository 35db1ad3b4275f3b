// Replays a recorded frame on chip in a 4-state simulator: vvp -n chip_replay.vvp +vectors=FILE, which
// sim/cosim/chip_recorder.hpp has written. A payload that no valid goes with must not be looked at: it is X. Ports
// between blocks are compared where they leave one; those of a traverser inside only there.
// The parameters of the chip come as the macro CHIP_PARAMETERS, ".WARPS(2), .LANES(2), ...", so that they need not be
// repeated here.
`default_nettype none
`timescale 1ns / 1ns
module chip_replay #(
  parameter integer CULLING = 0,
  parameter integer RAY_POOL_SIZE = 512
);
  localparam integer KINDS = 2 + CULLING;
  localparam integer PLACE_BITS = (RAY_POOL_SIZE > 1) ? $clog2(RAY_POOL_SIZE) : 1;
  localparam integer SETUP_BITS = 16 + 32 + 16 + 16 + 8 + 1 + 4 * 16 + 32 + 2 * 96 + 3 * 26 + 32 + 105;
  localparam integer TRAVERSER_BITS = 1 + 2 + PLACE_BITS + 131 + 129 + 35 + 256;
  localparam integer IN_BITS = 1 + SETUP_BITS + 39 + 130 + 1 + TRAVERSER_BITS;
  localparam integer OUT_BITS = 2 + 167 + 1 + 129 + 130 + PLACE_BITS + KINDS + 2 + 131 + 5 + 132 + 1 + TRAVERSER_BITS +
                                30;

  reg clk = 1'b0;
  reg [IN_BITS-1:0] in;

  // Inputs, the highest bits first.
  wire         rst_n, reflections, start, argument_write, memory_request_ready, memory_beat_valid, frame_ready;
  wire [15:0]  program_length, width, height, eye_pc, secondary_pc, direct_pc, shade_pc;
  wire [31:0]  memory_limit, tree_root, material_base, argument_data, contribution_pixel, tree_request_address;
  wire [7:0]   depth_limit;
  wire [95:0]  tree_lower, tree_upper, contribution_color;
  wire [25:0]  triangles_line, triangle_lines, stacks_line;
  wire [104:0] record;
  wire [4:0]   argument_index;
  wire [127:0] memory_beat_data, put_data;
  wire         ray_ready, free_valid, free_shadow, put_valid, contribution_valid, tree_request_valid;
  wire         tree_request_write, tree_request_second;
  wire [PLACE_BITS-1:0] free_place;
  wire [1:0]   put_kind;
  wire [255:0] tree_request_data;
  assign {rst_n, program_length, memory_limit, width, height, depth_limit, reflections, eye_pc, secondary_pc, direct_pc,
          shade_pc, tree_root, tree_lower, tree_upper, triangles_line, triangle_lines, stacks_line, material_base,
          record, start, argument_write, argument_index, argument_data, memory_request_ready, memory_beat_valid,
          memory_beat_data, frame_ready, ray_ready, free_valid, free_place, free_shadow, put_valid, put_kind, put_data,
          contribution_valid, contribution_pixel, contribution_color, tree_request_valid, tree_request_write,
          tree_request_second, tree_request_address, tree_request_data} = in;

  // Outputs of the chip alone.
  wire         ready, busy, memory_request_valid, memory_request_traverser, memory_request_write, memory_beat_ready;
  wire         frame_valid, fault_valid, tree_fault_valid;
  wire [31:0]  memory_request_address, frame_pixel;
  wire [127:0] memory_request_data;
  wire [3:0]   memory_request_mask;
  wire [95:0]  frame_color;
  wire [2:0]   tree_fault_code;
  wire [25:0]  tree_fault_line;

  rp_chip #(`CHIP_PARAMETERS) chip (
    .clk_i(clk), .rst_ni(rst_n), .program_length_i(program_length), .memory_limit_i(memory_limit),
    .argument_write_i(argument_write), .argument_index_i(argument_write ? argument_index : 5'bx),
    .argument_data_i(argument_write ? argument_data : 32'bx), .start_i(start), .width_i(width), .height_i(height),
    .depth_limit_i(depth_limit), .reflections_i(reflections), .eye_pc_i(eye_pc), .secondary_pc_i(secondary_pc),
    .direct_pc_i(direct_pc), .shade_pc_i(shade_pc), .tree_root_i(tree_root), .tree_lower_i(tree_lower),
    .tree_upper_i(tree_upper), .triangles_line_i(triangles_line), .triangle_lines_i(triangle_lines),
    .stacks_line_i(stacks_line), .material_base_i(material_base), .record_i(record), .ready_o(ready), .busy_o(busy),
    .memory_request_valid_o(memory_request_valid), .memory_request_ready_i(memory_request_ready),
    .memory_request_traverser_o(memory_request_traverser), .memory_request_write_o(memory_request_write),
    .memory_request_address_o(memory_request_address), .memory_request_data_o(memory_request_data),
    .memory_request_mask_o(memory_request_mask), .memory_beat_valid_i(memory_beat_valid),
    .memory_beat_ready_o(memory_beat_ready), .memory_beat_data_i(memory_beat_valid ? memory_beat_data : 128'bx),
    .frame_valid_o(frame_valid), .frame_ready_i(frame_ready), .frame_pixel_o(frame_pixel), .frame_color_o(frame_color),
    .ray_ready_i(ray_ready), .free_valid_i(free_valid), .free_place_i(free_valid ? free_place : {PLACE_BITS{1'bx}}),
    .free_shadow_i(free_valid ? free_shadow : 1'bx), .put_valid_i(put_valid), .put_kind_i(put_valid ? put_kind : 2'bx),
    .put_data_i(put_valid ? put_data : 128'bx), .contribution_valid_i(contribution_valid),
    .contribution_pixel_i(contribution_valid ? contribution_pixel : 32'bx),
    .contribution_color_i(contribution_valid ? contribution_color : 96'bx), .tree_request_valid_i(tree_request_valid),
    .tree_request_write_i(tree_request_valid ? tree_request_write : 1'bx),
    .tree_request_second_i(tree_request_valid ? tree_request_second : 1'bx),
    .tree_request_address_i(tree_request_valid ? tree_request_address : 32'bx),
    .tree_request_data_i({tree_request_valid && tree_request_write && tree_request_second
                            ? tree_request_data[255:128] : 128'bx,
                          tree_request_valid && tree_request_write ? tree_request_data[127:0] : 128'bx}),
    .fault_valid_o(fault_valid), .tree_fault_valid_o(tree_fault_valid), .tree_fault_code_o(tree_fault_code),
    .tree_fault_line_o(tree_fault_line), .counter_unit_i(2'd0), .counter_select_i(6'd0));

  wire [OUT_BITS-1:0] actual = {
    ready, busy, memory_request_valid, memory_request_traverser, memory_request_write, memory_request_address,
    memory_request_data, memory_request_mask, memory_beat_ready, frame_valid, frame_pixel, frame_color,
    chip.ray_valid, chip.ray_last, chip.ray_place, chip.ray_data, chip.put_ready, chip.contribution_ready,
    chip.tree_request_ready, chip.tree_response_valid, chip.tree_response_beat, chip.tree_response_data,
    chip.import_request_valid, chip.import_request_kind, chip.import_request_unit, chip.export_valid, chip.export_last,
    chip.export_unit, chip.export_data, fault_valid, chip.ray_ready, chip.free_valid, chip.free_place, chip.free_shadow,
    chip.put_valid, chip.put_kind, chip.put_data, chip.contribution_valid, chip.contribution_pixel,
    chip.contribution_color, chip.tree_request_valid, chip.tree_request_write, chip.tree_request_second,
    chip.tree_request_address, chip.tree_request_data, tree_fault_valid, tree_fault_code, tree_fault_line};
  wire events = chip.ray_valid && chip.ray_ready && chip.ray_last;
  localparam REPLAYED = "rays come to the traverser";
`include "replay.vh"

  task explain;
    begin
      field("ready", 1); field("busy", 1); field("memory_request_valid", 1); field("memory_request_traverser", 1);
      field("memory_request_write", 1); field("memory_request_address", 32); field("memory_request_data", 128);
      field("memory_request_mask", 4); field("memory_beat_ready", 1);
      field("frame_valid", 1); field("frame_pixel", 32); field("frame_color", 96);
      field("ray_valid", 1); field("ray_last", 1); field("ray_place", PLACE_BITS); field("ray_data", 128);
      field("put_ready", KINDS); field("contribution_ready", 1);
      field("tree_request_ready", 1); field("tree_response_valid", 1); field("tree_response_beat", 2);
      field("tree_response_data", 128);
      field("import_request_valid", 1); field("import_request_kind", 2); field("import_request_unit", 2);
      field("export_valid", 1); field("export_last", 1); field("export_unit", 2); field("export_data", 128);
      field("fault_valid", 1);
      field("ray_ready", 1); field("free_valid", 1); field("free_place", PLACE_BITS); field("free_shadow", 1);
      field("put_valid", 1); field("put_kind", 2); field("put_data", 128);
      field("contribution_valid", 1); field("contribution_pixel", 32); field("contribution_color", 96);
      field("tree_request_valid", 1); field("tree_request_write", 1); field("tree_request_second", 1);
      field("tree_request_address", 32); field("tree_request_data", 256);
      field("tree_fault_valid", 1); field("tree_fault_code", 3); field("tree_fault_line", 26);
    end
  endtask
endmodule
`default_nettype wire
