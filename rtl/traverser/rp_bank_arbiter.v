// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which lines the banks of a cache look up: of each lane two lines are wanted, of which one can be taken, the first
// rather. Each bank chooses a lane, in rotation among those that want a line of it, and the first of its wants that go
// to the bank. Then each lane takes the first of its wants with a line that a ready bank has chosen, for whichever
// lane.
// Promises: a bank looks up one line, for all lanes that take it; of a lane one want is taken at most; one that stays
// the lane's first is taken when its bank has been ready LANES times, if the lane is not silent meanwhile.
// valid_o of a bank does not depend on its own ready_i, but on those of others: their lanes then take no want of it. A
// ready bank looks up nothing if the lane that it has chosen takes another want and no lane takes its line.
`default_nettype none
module rp_bank_arbiter #(
  parameter integer LANES = 8,
  parameter integer BANKS = 8,         // a power of two: a line's last bits are the number of its bank
  parameter integer LINE_BITS = 26,
  parameter integer SLOT_BITS = 5,
  parameter integer BANK_LINE_BITS = LINE_BITS - $clog2(BANKS)
) (
  input  wire                             clk_i,
  input  wire                             rst_ni,
  // of each lane two, the first one below; silent: they do not count in this cycle
  input  wire [2*LANES-1:0]               want_valid_i,
  input  wire [2*LANES*LINE_BITS-1:0]     want_line_i,
  input  wire [2*LANES*SLOT_BITS-1:0]     want_slot_i,
  input  wire [2*LANES-1:0]               want_prefetch_i, // no ray waits for it yet
  input  wire [LANES-1:0]                 silent_i,
  output wire [2*LANES-1:0]               taken_o,
  // of each bank
  output wire [BANKS-1:0]                 valid_o,
  input  wire [BANKS-1:0]                 ready_i,
  output reg  [BANKS*BANK_LINE_BITS-1:0]  line_o,         // without the bits that choose the bank
  output wire [BANKS*LANES-1:0]           lanes_o,        // none: a prefetch
  output wire [BANKS*LANES*SLOT_BITS-1:0] slots_o
);
  localparam integer WANTS = 2 * LANES;
  localparam integer LAST_BANK = BANKS - 1;
  localparam [LANES-1:0] ONE_LANE = 1;
  genvar b, l, k, i;

  // ---- The choice of the banks

  // As in rp_round_robin.v, but the order of the lanes is known from registers alone.
  wire [BANKS*WANTS-1:0] goes;       // [bank][want]
  wire [BANKS*LANES-1:0] grant;      // [bank][lane]
  generate
    for (b = 0; b < BANKS; b = b + 1) begin : gen_bank
      reg [LANES-1:0] behind_q;      // the lanes behind the one chosen last
      wire [LANES-1:0] asks;
      for (l = 0; l < LANES; l = l + 1) begin : gen_lane
        for (i = 0; i < 2; i = i + 1) begin : gen_want
          assign goes[b*WANTS+2*l+i] =
            want_valid_i[2*l+i] &&
            (want_line_i[(2*l+i)*LINE_BITS +: LINE_BITS] & LAST_BANK[LINE_BITS-1:0]) == b[LINE_BITS-1:0];
        end
        assign asks[l] = |goes[b*WANTS+2*l +: 2] && !silent_i[l];
        wire [LANES-1:0] ahead;
        for (k = 0; k < LANES; k = k + 1) begin : gen_ahead
          if (k < l) begin : gen_below
            assign ahead[k] = behind_q[k] || !behind_q[l];
          end else begin : gen_above
            assign ahead[k] = k != l && behind_q[k] && !behind_q[l];
          end
        end
        assign grant[b*LANES+l] = asks[l] && !(|(asks & ahead));
      end
      always @(posedge clk_i)
        if (!rst_ni) behind_q <= {LANES{1'b1}};
        else if (ready_i[b] && |asks)
          behind_q <= ~(grant[b*LANES +: LANES] | (grant[b*LANES +: LANES] - ONE_LANE));
    end
  endgenerate

  integer bank, lane;
  always @* begin
    line_o = {BANKS*BANK_LINE_BITS{1'b0}};
    for (bank = 0; bank < BANKS; bank = bank + 1)
      for (lane = 0; lane < LANES; lane = lane + 1)
        if (grant[bank*LANES+lane])
          line_o[bank*BANK_LINE_BITS +: BANK_LINE_BITS] = line_o[bank*BANK_LINE_BITS +: BANK_LINE_BITS] |
            want_line_i[(goes[bank*WANTS+2*lane] ? 2*lane+1 : 2*lane+2)*LINE_BITS-1 -: BANK_LINE_BITS];
  end

  // ---- Which wants are chosen

  // If the bank of a want chooses a lane, does it choose the want's line? Lines are compared with each other while the
  // banks choose, not with what they have chosen.
  wire [WANTS*LANES-1:0] same;       // [want][lane]
  wire [BANKS*WANTS-1:0] matches;    // [bank][want]
  generate
    for (i = 0; i < WANTS; i = i + 1) begin : gen_match
      for (l = 0; l < LANES; l = l + 1) begin : gen_with
        if (i == 2 * l) begin : gen_itself
          assign same[i*LANES+l] = 1'b1;
        end else begin : gen_other
          wire [LINE_BITS-1:0] from_first =
            want_line_i[i*LINE_BITS +: LINE_BITS] ^ want_line_i[2*l*LINE_BITS +: LINE_BITS];
          wire first = want_valid_i[2*l] && (from_first & LAST_BANK[LINE_BITS-1:0]) == {LINE_BITS{1'b0}};
          assign same[i*LANES+l] = first ? from_first == {LINE_BITS{1'b0}} :
            want_line_i[i*LINE_BITS +: LINE_BITS] == want_line_i[(2*l+1)*LINE_BITS +: LINE_BITS];
        end
      end
      for (b = 0; b < BANKS; b = b + 1) begin : gen_of
        assign matches[b*WANTS+i] =
          goes[b*WANTS+i] && !silent_i[i/2] && |(grant[b*LANES +: LANES] & same[i*LANES +: LANES]);
      end
    end
  endgenerate

  // ---- What each lane takes; ready_i comes late

  wire [LANES-1:0] first_taken;
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_take
      wire [BANKS-1:0] first, second;
      for (b = 0; b < BANKS; b = b + 1) begin : gen_by
        assign first[b] = matches[b*WANTS+2*l];
        assign second[b] = matches[b*WANTS+2*l+1];
        assign lanes_o[b*LANES+l] = (first[b] && !want_prefetch_i[2*l]) ||
                                    (second[b] && !want_prefetch_i[2*l+1] && !first_taken[l]);
        assign slots_o[(b*LANES+l)*SLOT_BITS +: SLOT_BITS] =
          want_slot_i[(first[b] ? 2*l : 2*l+1)*SLOT_BITS +: SLOT_BITS];
      end
      assign first_taken[l] = |(first & ready_i);
      assign taken_o[2*l +: 2] = {|(second & ready_i) && !first_taken[l], first_taken[l]};
    end
    for (b = 0; b < BANKS; b = b + 1) begin : gen_look
      wire [LANES-1:0] looks;
      for (l = 0; l < LANES; l = l + 1) begin : gen_for
        assign looks[l] = matches[b*WANTS+2*l] || (matches[b*WANTS+2*l+1] && !first_taken[l]);
      end
      assign valid_o[b] = |looks;
    end
  endgenerate
endmodule
`default_nettype wire
