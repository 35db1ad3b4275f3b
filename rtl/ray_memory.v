// One set of local ray memory: four 32-bit single-port banks, 21 words for each of CONTENTS threads. Word k of
// thread t lies in bank (t+k)%4, row k*ceil(CONTENTS/4) + t/4, so that an access moves four words a cycle, either of
// one word for four threads or of one thread.
// Element e (0 .. 3) of an access is word word_i + e of thread thread_i with package_i, else word word_i of
// thread thread_i + e; then thread_i must be a multiple of 4. A cycle with write_i other than 0 writes these
// elements, else read_i reads all four; they appear in data_o in the next cycle and stay until the next read.
// Words written or looked at must be 0 .. 20.
`default_nettype none
module ray_memory #(
  parameter integer CONTENTS = 64
) (
  input  wire         clk_i,
  input  wire         read_i,
  input  wire [3:0]   write_i,
  input  wire         package_i,
  input  wire [9:0]   thread_i,
  input  wire [4:0]   word_i,
  input  wire [127:0] data_i,
  output reg  [127:0] data_o
);
  localparam integer COLUMNS = (CONTENTS > 4) ? CONTENTS / 4 : 1;
  localparam integer COLUMN_BITS = $clog2(COLUMNS);
  localparam integer DEPTH = 21 * COLUMNS;
  localparam integer ADDRESS_BITS = $clog2(DEPTH);

  // Element e is in bank (e + shift) % 4.
  wire [1:0] shift = thread_i[1:0] + word_i[1:0];
  reg [3:0] bank_write;
  reg [127:0] bank_data;
  wire [127:0] bank_read;
  reg [1:0] shift_q;

  always @* begin
    bank_write = 4'd0;
    bank_data = data_i;
    if (write_i != 4'd0)
      case (shift)
        2'd0: bank_write = write_i;
        2'd1: begin
          bank_write = {write_i[2:0], write_i[3]};
          bank_data = {data_i[95:0], data_i[127:96]};
        end
        2'd2: begin
          bank_write = {write_i[1:0], write_i[3:2]};
          bank_data = {data_i[63:0], data_i[127:64]};
        end
        default: begin
          bank_write = {write_i[0], write_i[3:1]};
          bank_data = {data_i[31:0], data_i[127:32]};
        end
      endcase
  end

  always @(posedge clk_i) if (read_i && write_i == 4'd0) shift_q <= shift;

  always @*
    case (shift_q)
      2'd0: data_o = bank_read;
      2'd1: data_o = {bank_read[31:0], bank_read[127:32]};
      2'd2: data_o = {bank_read[63:0], bank_read[127:64]};
      default: data_o = {bank_read[95:0], bank_read[127:96]};
    endcase

  genvar b;
  generate
    for (b = 0; b < 4; b = b + 1) begin : gen_bank
      localparam [1:0] BANK = b;
      wire [1:0] element = BANK - shift;
      wire [4:0] word = package_i ? word_i + {3'd0, element} : word_i;
      wire [12:0] row = ({8'd0, word} << COLUMN_BITS) | {5'd0, thread_i[9:2]};
      wire unused = &{1'b0, row};   // a small set leaves the upper bits
      ram_1rw #(.WIDTH(32), .DEPTH(DEPTH)) u_bank (
        .clk_i(clk_i), .enable_i(bank_write[b] || (read_i && write_i == 4'd0)), .write_i(bank_write[b]),
        .address_i(row[ADDRESS_BITS-1:0]), .data_i(bank_data[b*32 +: 32]), .data_o(bank_read[b*32 +: 32])
      );
    end
  endgenerate
endmodule
`default_nettype wire
