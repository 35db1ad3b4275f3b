// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Joins the instruction side (reads, id 16) and the data side (reads with ids 0 .. 15, writes) to the unit's memory
// port, and routes responses by their id. One request a cycle; the instruction side goes first, and as it has one fetch
// at a time the data side cannot starve. Promises: the port's outputs are registers and stay until taken; requests
// leave in the order in which they were taken.
`default_nettype none
module rp_memory_arbiter (
  input  wire         clk_i,
  input  wire         rst_ni,
  // instruction side
  input  wire         instruction_request_valid_i,
  output wire         instruction_request_ready_o,
  input  wire [31:0]  instruction_request_address_i,
  output wire         instruction_response_valid_o,
  // data side
  input  wire         data_request_valid_i,
  output wire         data_request_ready_o,
  input  wire         data_request_write_i,
  input  wire [31:0]  data_request_address_i,
  input  wire [127:0] data_request_data_i,
  input  wire [3:0]   data_request_mask_i,
  input  wire [4:0]   data_request_id_i,
  output wire         data_response_valid_o,
  // memory port
  output wire         request_valid_o,
  input  wire         request_ready_i,
  output wire         request_write_o,
  output wire [31:0]  request_address_o,
  output wire [127:0] request_data_o,
  output wire [3:0]   request_mask_o,
  output wire [4:0]   request_id_o,
  input  wire         response_valid_i,
  input  wire [4:0]   response_id_i,
  output wire         idle_o            // no request waits here
);
  localparam [4:0] INSTRUCTION_ID = 5'd16;

  reg         valid_q;
  reg         write_q;
  reg [31:0]  address_q;
  reg [127:0] data_q;
  reg [3:0]   mask_q;
  reg [4:0]   id_q;

  wire free = !valid_q || request_ready_i;
  assign instruction_request_ready_o = free;
  assign data_request_ready_o = free && !instruction_request_valid_i;

  always @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else if (free) valid_q <= instruction_request_valid_i || data_request_valid_i;
    if (free && instruction_request_valid_i) begin
      write_q <= 1'b0;
      address_q <= instruction_request_address_i;
      id_q <= INSTRUCTION_ID;
    end else if (free && data_request_valid_i) begin
      write_q <= data_request_write_i;
      address_q <= data_request_address_i;
      data_q <= data_request_data_i;
      mask_q <= data_request_mask_i;
      id_q <= data_request_id_i;
    end
  end

  assign request_valid_o = valid_q;
  assign request_write_o = write_q;
  assign request_address_o = address_q;
  assign request_data_o = data_q;
  assign request_mask_o = mask_q;
  assign request_id_o = id_q;
  assign idle_o = !valid_q;

  wire response_of_instruction = response_id_i == INSTRUCTION_ID;
  assign instruction_response_valid_o = response_valid_i && response_of_instruction;
  assign data_response_valid_o = response_valid_i && !response_of_instruction;
endmodule
`default_nettype wire
