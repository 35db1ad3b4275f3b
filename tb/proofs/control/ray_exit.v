// What becomes of rays, by place. What reads triangles and computes a package's numbers is replaced: a ray that is
// begun comes back after any time, before or after others, and is finished four cycles later. A ray's pixel is its
// place; a package is its pixel, its flags, and t, which has all bits set in a hit.
// @modules ray_exit round_robin free_list ram_queue ram_1r1w
// @zeros
// @slow
// @proves a ray that is done gives its slot back once, and its place once, when what it has become has left: nothing,
//   if it hit nothing, or is a shadow ray that met something; a contribution or a shadow package; a package of its
//   hit; the place at most four cycles after that
// @proves one package leaves at a time, all of its beats of one ray; it is begun only with room for its kind; shadow
//   rays leave in the order in which they were done
// @proves hits are finished three cycles apart at least
// @proves with MISS_RECORDS a ray that returns leaves exactly one package, whose flags say whether it has met
//   something, with the words of a hit unless it has met nothing or any hit would do; such a plain one within nine
//   cycles with room; of all others the flags stay
// @parameters SHADING=1 CULLING=0 MISS_RECORDS=1
// @parameters SHADING=1 CULLING=1 MISS_RECORDS=0
// @parameters SHADING=0 CULLING=0 MISS_RECORDS=0
// @break ray_exit s/drops = shadow == fate_hit_q/drops = !shadow \&\& !fate_hit_q/
// @break ray_exit s/shadow_moves = !fate_hit_q \|\| drop_freed/shadow_moves = 1'b1/
// @break ray_exit s/!fate_q \|\| normal_moves/!fate_q || shadow_moves/
// @break ray_exit s/\{LANES\{fate_q && fate_moves\}\}/{LANES{fate_q}}/
// @break ray_exit s/drop_freed = !put_free_q && !contributed/drop_freed = !put_free_q/
// @break ray_exit s/contributed && !put_free_q/contributed/
// @break ray_exit s/pause_q <= 2'd2/pause_q <= 2'd1/
// @break ray_exit s/waits & put_ready_i/waits/
// @break ray_exit s/put_free_shadow_q <= put_kind_o == 2'd2/put_free_shadow_q <= 1'b1/
// @break ray_exit s/if \(!puts_q\) begin/if (1'b1) begin/
// @break ray_exit s/contributes && !contributed/contributes/
// @break ray_exit s/plain_moves = !finished/plain_moves = 1'b1/
// @break ray_exit s/fate_hit_q \? first : returns/fate_hit_q ? first : 1'b0/
// @break ray_exit s/1'b1, fate_hit_q, place/1'b1, !fate_hit_q, place/
// @break ray_exit s/ \|\| put_plain\)/)/
// @break ray_exit s/put_met_q : put_ray/put_ray[RAY_MET] : put_ray/
`default_nettype none
module rp_leaf_reader #(parameter SLOTS = 2, parameter LINE_BITS = 26, parameter SLOT_BITS = 1) (
  input wire clk_i, rst_ni, input wire [1:0] start_i, input wire [2*SLOT_BITS-1:0] start_slot_i,
  input wire [61:0] start_leaf_i, output wire [1:0] want_o, want_prefetch_o, output wire [2*LINE_BITS-1:0] want_line_o,
  output wire [2*SLOT_BITS-1:0] want_slot_o, input wire [1:0] taken_i, output wire room_o, input wire waited_i, given_i,
  input wire [SLOT_BITS-1:0] given_slot_i, input wire [511:0] given_data_i, output wire load_o,
  output wire [SLOT_BITS-1:0] load_slot_o, output wire triangle_valid_o, input wire triangle_ready_i,
  output wire [SLOT_BITS-1:0] triangle_slot_o, output wire triangle_last_o, output wire [28:0] triangle_place_o,
  output wire [351:0] triangle_o);
  reg [SLOTS-1:0] waits_q = 0;
  reg held_q = 1'b0;
  reg [SLOT_BITS-1:0] slot_q;
  wire [SLOTS-1:0] starts = start_i[1] ? {{SLOTS-1{1'b0}}, 1'b1} << start_slot_i[SLOT_BITS +: SLOT_BITS] :
                            start_i[0] ? {{SLOTS-1{1'b0}}, 1'b1} << start_slot_i[0 +: SLOT_BITS] : 0;
  // Both are inputs of the check, in the lines that the cache gives.
  assign load_o = given_i && waits_q[given_slot_i] && (!held_q || triangle_ready_i);
  assign load_slot_o = given_slot_i;
  assign triangle_valid_o = held_q;
  assign triangle_slot_o = slot_q;
  assign triangle_o = {given_data_i[0], 351'd0};    // whether its material is for the kernel that reflects
  wire [SLOTS-1:0] loads = load_o ? {{SLOTS-1{1'b0}}, 1'b1} << given_slot_i : 0;
  always @(posedge clk_i) begin
    waits_q <= rst_ni ? (waits_q | starts) & ~loads : 0;
    held_q <= rst_ni && (load_o || (held_q && !triangle_ready_i));
    if (load_o) slot_q <= load_slot_o;
  end
  always @* if (rst_ni) assert ((waits_q & starts) == 0);
endmodule

module rp_ray_finish #(parameter TAG_BITS = 2) (
  input wire clk_i, rst_ni, valid_i, input wire [TAG_BITS-1:0] tag_i, input wire [287:0] corners_i,
  input wire [95:0] origin_i, input wire [1:0] main_axis_i, input wire [63:0] shear_i, input wire [31:0] t_i,
  input wire [8:0] scale_i, output wire valid_o, output wire [TAG_BITS-1:0] tag_o, output wire [31:0] t_o, u_o, v_o,
  output wire [95:0] normal_o);
  reg [4:1] valid_q = 0;
  reg [4*TAG_BITS-1:0] tags_q;
  always @(posedge clk_i) begin
    valid_q <= rst_ni ? {valid_q[3:1], valid_i} : 4'd0;
    tags_q <= {tags_q[3*TAG_BITS-1:0], tag_i};
  end
  assign valid_o = valid_q[4];
  assign tag_o = tags_q[4*TAG_BITS-1 -: TAG_BITS];
  assign t_o = 32'hffffffff;
  assign {u_o, v_o, normal_o} = 160'd0;
  always @* if (rst_ni) assert (!valid_i || valid_q[2:1] == 0);
endmodule

module check #(parameter SHADING = 0, parameter CULLING = 0, parameter MISS_RECORDS = 0) (
  input wire clk_i, ray_valid, ray_place, set_slot, set_place, set_deep, comes, comes_slot, reflects,
  contribution_takes, input wire [3:0] ray_flags, input wire [1:0] set_valid, done_valid, done_slot, done_hit,
  input wire [1+CULLING:0] put_ready);
  localparam KINDS = 2 + CULLING;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [1:0] done_ready, slot_free, put_kind;
  wire slot_free_slot, free, free_place, free_shadow, put, contribution;
  wire [127:0] put_data;
  wire [31:0] pixel;
  // Of each place, from the flags of its ray: met, first, returns, shadow.
  reg [3:0] flags_q [0:1];
  reg [1:0] shadow_q, returns_q, any_q;          // any_q: any hit ends a ray that returns
  wire [3:0] set_flags = flags_q[set_place];
  wire set_returns = set_flags[2] && !set_flags[3];
  rp_ray_exit #(.LANES(2), .SLOTS(2), .POOL(2), .RECORD_WORDS(8), .SHADING(SHADING), .CULLING(CULLING),
                .MISS_RECORDS(MISS_RECORDS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .material_base_i(32'd0), .record_i({{18{5'd7}}, 5'd12, 5'd11, 5'd7}),
    .depth_limit_i(8'd1),
    .reflections_i(1'b1), .ray_valid_i(ray_valid), .ray_place_i(ray_place),
    .ray_words_i({ray_flags, 28'd0, 96'd0, 31'd0, ray_place, 224'd0}), .set_valid_i(set_valid), .set_slot_i(set_slot),
    .set_place_i(set_place), .set_depth_i({7'd0, set_deep}), .set_shadow_i(set_flags[3]),
    .set_returns_i(set_returns), .set_first_i(set_returns && set_flags[1]), .set_origin_i(96'd0),
    .set_main_axis_i(2'd0), .set_shear_i(64'd0), .set_scale_i(9'd0), .done_valid_i(done_valid),
    .done_ready_o(done_ready), .done_slot_i(done_slot), .done_hit_i(done_hit), .done_t_i(64'd0), .done_place_i(58'd0),
    .slot_free_o(slot_free), .slot_free_slot_o(slot_free_slot), .taken_i(2'd0), .waited_i(1'b0), .given_i(comes),
    .given_slot_i(comes_slot), .given_data_i({511'd0, reflects}), .free_valid_o(free), .free_place_o(free_place),
    .free_shadow_o(free_shadow), .put_valid_o(put), .put_ready_i(put_ready), .put_kind_o(put_kind),
    .put_data_o(put_data), .contribution_valid_o(contribution), .contribution_ready_i(contribution_takes),
    .contribution_pixel_o(pixel));

  // ---- Each place: 0 empty, 1 a ray has come, 2 it is set up, 3 it has been done, 4 what it became has left
  reg [2:0] state_q [0:1];
  reg [1:0] slots_q = 0;                         // it has a slot of a lane
  reg [1:0] lane_q, slot_q, hit_q;
  initial {state_q[0], state_q[1]} = 0;
  // What a ray that has been done becomes: nothing; a package without the words of a hit.
  wire [1:0] nothing = ~returns_q & ~(shadow_q ^ hit_q);
  wire [1:0] plain = returns_q & (any_q | ~hit_q);
  wire beat = rst_n && put && put_ready[put_kind - 1];
  reg second_q = 1'b0;                           // beat of a package
  wire leaves = beat && second_q;
  wire contributes = rst_n && contribution && contribution_takes;
  always @(posedge clk_i) second_q <= second_q ^ beat;
  reg [2:0] idle_q [0:1];                        // cycles since nothing of the ray was left
  initial {idle_q[0], idle_q[1]} = 0;
  reg [3:0] waited_q [0:1];                      // cycles with room since a plain package has had to leave
  initial {waited_q[0], waited_q[1]} = 0;
  integer p;
  always @(posedge clk_i)
    for (p = 0; p < 2; p = p + 1) begin
      waited_q[p] <= (state_q[p] == 3 && plain[p] && !slots_q[p]) ? waited_q[p] + (&put_ready) : 0;
      idle_q[p] <= (state_q[p] == 4 || (state_q[p] == 3 && nothing[p])) ? idle_q[p] + 1 : 0;
      if (rst_n && ray_valid && ray_place == p) begin
        state_q[p] <= 1;
        flags_q[p] <= ray_flags;
      end
      if (rst_n && |set_valid && set_place == p) begin
        state_q[p] <= 2;
        {slots_q[p], lane_q[p], slot_q[p], shadow_q[p]} <= {1'b1, set_valid[1], set_slot, set_flags[3]};
        returns_q[p] <= MISS_RECORDS != 0 && set_returns;
        any_q[p] <= set_flags[1];
      end
      if (state_q[p] == 2 && done_valid[lane_q[p]] && done_ready[lane_q[p]] && done_slot[lane_q[p]] == slot_q[p]) begin
        state_q[p] <= 3;
        hit_q[p] <= done_hit[lane_q[p]];
      end
      if (slots_q[p] && slot_free[lane_q[p]] && slot_free_slot == slot_q[p]) slots_q[p] <= 1'b0;
      if ((leaves && put_data[0] == p) || (contributes && pixel[0] == p)) state_q[p] <= 4;
      if (rst_n && free && free_place == p) state_q[p] <= 0;
    end

  // What a lane offers stays.
  reg [1:0] waits_q = 0, waits_slot_q, waits_hit_q;
  reg first_q = 1'b0, first_place_q, begun_q = 1'b0;
  reg [1:0] first_kind_q;
  reg [KINDS-1:0] room_q;
  always @(posedge clk_i) begin
    waits_q <= rst_n ? done_valid & ~done_ready : 2'd0;
    {waits_slot_q, waits_hit_q} <= {done_slot, done_hit};
    if (beat && !second_q) {first_place_q, first_kind_q} <= {put_data[0], put_kind};
    room_q <= put_ready;
    begun_q <= rst_n && put && !leaves;
  end

  // Which shadow ray was done first.
  reg later_q;                                   // the place of the one that was done last
  reg [1:0] waiting;
  always @* for (p = 0; p < 2; p = p + 1) waiting[p] = state_q[p] == 3 && shadow_q[p] && !hit_q[p];
  always @(posedge clk_i)
    for (p = 0; p < 2; p = p + 1)
      if (state_q[p] == 2 && done_valid[lane_q[p]] && done_ready[lane_q[p]] && done_slot[lane_q[p]] == slot_q[p])
        later_q <= p;

  integer l;
  always @* begin
    assume (!ray_valid || state_q[ray_place] == 0);
    assume (set_valid != 2'd3);
    assume (set_valid == 0 || state_q[set_place] == 1);
    for (p = 0; p < 2; p = p + 1)
      assume (!(slots_q[p] && set_valid[lane_q[p]] && set_slot == slot_q[p]));
    for (l = 0; l < 2; l = l + 1) begin
      assume (!done_valid[l] || (state_q[0] == 2 && lane_q[0] == l && slot_q[0] == done_slot[l]) ||
              (state_q[1] == 2 && lane_q[1] == l && slot_q[1] == done_slot[l]));
      assume (!waits_q[l] || (done_valid[l] && done_slot[l] == waits_slot_q[l] && done_hit[l] == waits_hit_q[l]));
    end
    if (rst_n) begin
      for (p = 0; p < 2; p = p + 1) assert (idle_q[p] <= 4 && waited_q[p] <= 8);
      assert ((done_ready & ~done_valid) == 0);
      assert (slot_free != 2'd3);
      for (l = 0; l < 2; l = l + 1)
        assert (!slot_free[l] ||
                (slots_q[0] && state_q[0] >= 3 && lane_q[0] == l && slot_q[0] == slot_free_slot) ||
                (slots_q[1] && state_q[1] >= 3 && lane_q[1] == l && slot_q[1] == slot_free_slot));
      if (free) begin
        assert (state_q[free_place] == (nothing[free_place] ? 3 : 4));
        assert (free_shadow == shadow_q[free_place]);
        assert (!slots_q[free_place] || slot_free[lane_q[free_place]]);
      end
      if (put) begin
        assert (state_q[put_data[0]] == 3 && !nothing[put_data[0]]);
        if (!second_q) begin
          assert (put_data[63:60] == {flags_q[put_data[0]][3:1], returns_q[put_data[0]] ? hit_q[put_data[0]] :
                                      flags_q[put_data[0]][0]});
          assert (put_data[95:64] == ((put_kind == 2 || plain[put_data[0]]) ? 32'd0 : 32'hffffffff));
        end
        assert ((put_kind == 2) == shadow_q[put_data[0]]);
        assert (put_kind == 1 || put_kind == 2 || (CULLING != 0 && put_kind == 3));
        assert (SHADING == 0 || put_kind != 2);
        assert (begun_q || room_q[put_kind - 1]);
        assert (!second_q || (put_data[0] == first_place_q && put_kind == first_kind_q));
        assert (put_kind != 2 || !(&waiting) || put_data[0] != later_q);
      end
      if (contribution) begin
        assert (SHADING != 0 && state_q[pixel[0]] == 3 && shadow_q[pixel[0]] && !hit_q[pixel[0]]);
        assert (!(&waiting) || pixel[0] != later_q);
      end
    end
  end
endmodule
`default_nettype wire
