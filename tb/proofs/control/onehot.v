// @modules
// @proves of items the one with its bit set is chosen, and its number; nothing is 0
// @parameters COUNT=5
// @parameters COUNT=1
// @break onehot.vh s/name \| items\[item\*\(WIDTH\)/name | items[item/
// @break onehot.vh s/name \| item\[/name | ~item[/
`default_nettype none
module check #(parameter COUNT = 5) (
  input wire clk_i, input wire [COUNT-1:0] onehot_i, input wire [COUNT*3-1:0] items_i);
`include "rp_onehot.vh"
  `ONEHOT_SELECT(chosen, COUNT, 3)
  `ONEHOT_NUMBER(number, COUNT, 3)
  wire [COUNT-1:0] below = onehot_i - 1'b1;
  wire [2:0] item = chosen(onehot_i, items_i), place = number(onehot_i);
  (* anyconst *) wire [2:0] watched;
  wire [COUNT*3-1:0] moved = items_i >> (3 * watched);
  always @* begin
    assume ((onehot_i & below) == {COUNT{1'b0}});
    assume (watched < COUNT);
    assert (onehot_i != {COUNT{1'b0}} || (item == 3'd0 && place == 3'd0));
    assert (!onehot_i[watched] || (item == moved[2:0] && place == watched));
  end
  reg clocked_q = 1'b0;
  always @(posedge clk_i) clocked_q <= 1'b1;
endmodule
`default_nettype wire
