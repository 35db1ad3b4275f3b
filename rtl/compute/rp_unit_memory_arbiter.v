// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Joins the memory ports of 2 to 4 units. A request's id grows by the unit's number, and a response
// goes to the unit that its id names.
// Promises: one request a cycle, in rotation (port_arbiter); requests of one unit keep
// their order; responses are not delayed.
`default_nettype none
module rp_unit_memory_arbiter #(
  parameter integer UNITS = 4
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  // units
  input  wire [UNITS-1:0]     unit_request_valid_i,
  output wire [UNITS-1:0]     unit_request_ready_o,
  input  wire [UNITS-1:0]     unit_request_write_i,
  input  wire [UNITS*32-1:0]  unit_request_address_i,
  input  wire [UNITS*128-1:0] unit_request_data_i,
  input  wire [UNITS*4-1:0]   unit_request_mask_i,
  input  wire [UNITS*5-1:0]   unit_request_id_i,
  output wire [UNITS-1:0]     unit_response_valid_o,
  // memory port
  output wire                 request_valid_o,
  input  wire                 request_ready_i,
  output wire                 request_write_o,
  output wire [31:0]          request_address_o,
  output wire [127:0]         request_data_o,
  output wire [3:0]           request_mask_o,
  output wire [6:0]           request_id_o,
  input  wire                 response_valid_i,
  input  wire [1:0]           response_unit_i     // the upper bits of its id
);
  localparam integer WIDTH = 1 + 32 + 128 + 4 + 5;
  wire [UNITS*WIDTH-1:0] requests;

  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      localparam [1:0] UNIT = u;
      assign requests[u*WIDTH +: WIDTH] = {unit_request_write_i[u], unit_request_address_i[u*32 +: 32],
                                           unit_request_data_i[u*128 +: 128], unit_request_mask_i[u*4 +: 4],
                                           unit_request_id_i[u*5 +: 5]};
      assign unit_response_valid_o[u] = response_valid_i && response_unit_i == UNIT;
    end
  endgenerate

  rp_port_arbiter #(.COUNT(UNITS), .WIDTH(WIDTH)) port_arbiter (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(unit_request_valid_i),
    .ready_o(unit_request_ready_o),
    .data_i(requests),
    .last_i({UNITS{1'b1}}),
    .valid_o(request_valid_o),
    .ready_i(request_ready_i),
    .data_o({request_write_o, request_address_o, request_data_o, request_mask_o, request_id_o[4:0]}),
    .number_o(request_id_o[6:5])
  );
endmodule
`default_nettype wire
