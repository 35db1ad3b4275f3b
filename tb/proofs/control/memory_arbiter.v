// @modules memory_arbiter
// @proves takes one request a cycle at most; each leaves once, in order, with its address, data, mask
//   and id, and stays until it is taken
// @proves with one fetch under way at a time, a waiting request of the data side is taken after one fetch at most
// @proves a response goes to the side that its id names, and to no other
// @break memory_arbiter s/free && !instruction_request_valid_i/free/
// @break memory_arbiter s/!valid_q \|\| request_ready_i/1'b1/
// @break memory_arbiter s/(data_response_valid_o = response_valid_i) && !response/\1; wire u = response/
// @break memory_arbiter s/data_request_ready_o = free/data_request_ready_o = !valid_q/;s/(else if \()free/\1!valid_q/;
//   s/\|\| (data_request_valid_i);/|| (\1 \&\& !valid_q);/
`default_nettype none
module check (
  input wire clk_i, fetch_i, data_i, write_i, ready_i, response_i,
  input wire [31:0] fetch_address_i, address_i, input wire [127:0] quad_i, input wire [3:0] mask_i,
  input wire [4:0] id_i, response_id_i
);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire fetch_ready, fetch_response, data_ready, data_response, valid, write, idle;
  wire [31:0] address;
  wire [127:0] quad;
  wire [3:0] mask;
  wire [4:0] id;
  rp_memory_arbiter dut (
    .clk_i(clk_i), .rst_ni(rst_n),
    .instruction_request_valid_i(fetch_i), .instruction_request_ready_o(fetch_ready),
    .instruction_request_address_i(fetch_address_i), .instruction_response_valid_o(fetch_response),
    .data_request_valid_i(data_i), .data_request_ready_o(data_ready), .data_request_write_i(write_i),
    .data_request_address_i(address_i), .data_request_data_i(quad_i), .data_request_mask_i(mask_i),
    .data_request_id_i(id_i), .data_response_valid_o(data_response), .request_valid_o(valid), .request_ready_i(ready_i),
    .request_write_o(write), .request_address_o(address), .request_data_o(quad), .request_mask_o(mask),
    .request_id_o(id), .response_valid_i(response_i), .response_id_i(response_id_i), .idle_o(idle));

  wire fetch_taken = rst_n && fetch_i && fetch_ready;
  wire data_taken = rst_n && data_i && data_ready;
  wire leaves = rst_n && valid && ready_i;
  // What was taken and has not left
  reg held_q = 1'b0;
  reg [169:0] request_q;        // of a fetch, mask and data have no meaning
  wire fetch_held = request_q[4:0] == 5'd16;
  // A fetch: taken, then sent, then answered
  reg fetch_q = 1'b0, sent_q = 1'b0;
  // Waiting requests stay
  reg data_waits_q = 1'b0, fetch_waits_q = 1'b0;
  reg [169:0] waiting_q;
  reg [31:0] fetch_address_q;
  reg passed_q = 1'b0;
  always @(posedge clk_i) begin
    if (fetch_taken || data_taken) held_q <= 1'b1;
    else if (leaves) held_q <= 1'b0;
    if (fetch_taken) request_q <= {132'd0, 1'b0, fetch_address_i, 5'd16};
    else if (data_taken) request_q <= {quad_i, mask_i, write_i, address_i, id_i};
    fetch_q <= fetch_taken || (fetch_q && !fetch_response);
    sent_q <= (leaves && fetch_held) || (sent_q && !fetch_response);
    data_waits_q <= rst_n && data_i && !data_ready;
    fetch_waits_q <= rst_n && fetch_i && !fetch_ready;
    waiting_q <= {quad_i, mask_i, write_i, address_i, id_i};
    fetch_address_q <= fetch_address_i;
    passed_q <= rst_n && data_i && !data_ready && (passed_q || fetch_taken);
  end
  always @* begin
    assume (!data_i || id_i < 16);
    assume (!data_waits_q || (data_i && {quad_i, mask_i, write_i, address_i, id_i} == waiting_q));
    assume (!fetch_waits_q || (fetch_i && fetch_address_i == fetch_address_q));
    assume (!fetch_i || !fetch_q);
    assume (!(response_i && response_id_i == 16) || sent_q);
    if (rst_n) begin
      assert (!(fetch_taken && data_taken));
      assert (valid == held_q && idle == !held_q);
      assert (!((fetch_taken || data_taken) && held_q && !leaves));
      assert (!valid || {write, address, id} == request_q[37:0]);
      assert (!valid || fetch_held || {quad, mask} == request_q[169:38]);
      assert (!(passed_q && fetch_taken));
      assert (!(data_i && !fetch_i && (ready_i || !valid)) || data_taken);
      assert (fetch_response == (response_i && response_id_i == 16));
      assert (data_response == (response_i && response_id_i != 16));
    end
  end
endmodule
`default_nettype wire
