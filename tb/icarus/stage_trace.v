// Prints in which stage of the two routines each warp is, cycle by cycle, by the registers of its instruction buffer:
// vvp -n stage_trace.vvp +program=FILE, as `raypool asm` writes it. The program is launched twice; what is printed is
// the second time, when the instruction cache has it. A line is: cycle, warp, stage, PC.
`default_nettype none
`timescale 1ns / 1ns
module stage_trace #(
  parameter integer WARPS = 2,
  parameter integer LANES = 4
);
  localparam integer THREADS = WARPS * LANES;
  reg clk = 1'b0, rst_n = 1'b0, launch = 1'b0, printing = 1'b0;
  always #5 clk = !clk;

  // A memory that takes a read at once and answers it from the next cycle on.
  reg [63:0] program [0:255];
  reg [1023:0] file;
  wire request;
  wire [31:0] request_address;
  wire [4:0] request_id;
  reg [31:0] address;
  reg [4:0] id;
  reg [2:0] beat = 3'd4;
  wire [7:0] pair = address[10:3] + {5'd0, beat[1:0], 1'b0};
  always @(posedge clk)
    if (request && beat[2]) {address, id, beat} <= {request_address, request_id, 3'd0};
    else if (!beat[2]) beat <= beat + 3'd1;

  wire kernel_done;
  rp_compute_unit #(.WARPS(WARPS), .LANES(LANES)) unit (
    .clk_i(clk), .rst_ni(rst_n), .program_length_i(16'd256), .memory_limit_i(32'd2048),
    .argument_write_i(1'b0), .argument_index_i(5'd0), .argument_data_i(32'd0),
    .launch_valid_i(launch), .launch_pc_i(16'd0), .launch_threads_i(THREADS[10:0]),
    .launch_block_i(32'd0), .launch_blocks_i(32'd1), .launch_import_i(2'd0), .kernel_done_o(kernel_done),
    .memory_request_valid_o(request), .memory_request_ready_i(beat[2]), .memory_request_address_o(request_address),
    .memory_request_id_o(request_id), .memory_response_valid_i(!beat[2]), .memory_response_id_i(id),
    .memory_response_beat_i(beat[1:0]), .memory_response_data_i({program[pair + 8'd1], program[pair]}),
    .import_request_ready_i(1'b0), .import_beat_valid_i(1'b0), .import_beat_data_i(128'd0), .export_ready_i(1'b0),
    .frame_ready_i(1'b0), .counter_select_i(6'd0));

  integer cycle = 0;
  genvar w;
  generate
    for (w = 0; w < WARPS; w = w + 1) begin : gen_warp
      `define BUFFER unit.gen_warp[w].warp.instruction_buffer
      always @(negedge clk)
        if (printing && `BUFFER.active_o) begin
          case (`BUFFER.fetch_q)
            // In this stage the PC is that of the stack, unless an entry is popped.
            `BUFFER.F_STACK: if (`BUFFER.pc_valid_i) $display("%0d %0d PCStack %0d", cycle, w, `BUFFER.pc_i);
            `BUFFER.F_ARBITER: $display("%0d %0d IArb %0d", cycle, w, `BUFFER.fetch_pc_o);
            `BUFFER.F_CACHE: $display("%0d %0d ICache %0d", cycle, w, `BUFFER.fetch_pc_o);
            `BUFFER.F_FULL: $display("%0d %0d IBuf %0d", cycle, w, `BUFFER.fetch_pc_o);
            default: ;
          endcase
          case (`BUFFER.data_q)
            `BUFFER.D_READ: $display("%0d %0d RegFile %0d", cycle, w, `BUFFER.pc_o);
            `BUFFER.D_WANT: $display("%0d %0d Dispatch %0d", cycle, w, `BUFFER.pc_o);
            `BUFFER.D_EXECUTE:
              if (`BUFFER.done_i) $display("%0d %0d WriBack %0d", cycle, w, `BUFFER.pc_o);
              else $display("%0d %0d ALUEx %0d", cycle, w, `BUFFER.pc_o);
            default: ;
          endcase
        end
    end
  endgenerate

  always @(posedge clk) cycle <= cycle + 1;

  task run;
    begin
      @(negedge clk) launch = 1'b1;
      @(negedge clk) launch = 1'b0;
      @(posedge kernel_done);
      @(negedge clk) ;
    end
  endtask

  initial begin
    if (!$value$plusargs("program=%s", file)) begin
      $display("stage_trace: pass +program=FILE, one hexadecimal 64-bit word a line");
      $finish;
    end
    $readmemh(file, program);
    repeat (2) @(negedge clk);
    rst_n = 1'b1;
    run;
    printing = 1'b1;
    run;
    $finish;
  end

  initial #100000 begin
    $display("stage_trace: the program does not end within 10000 cycles");
    $finish;
  end
endmodule
`default_nettype wire
