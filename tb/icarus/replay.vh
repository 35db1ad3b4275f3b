// What all replays do: drive `in`, and compare `actual` with what was recorded, cycle by cycle. A line of the file is a
// cycle: inputs, outputs that are expected, and which of their bits count. An output that differs or is X in a bit that
// counts fails.
// Around it: IN_BITS and OUT_BITS, `clk`, `in` and `actual`; `events`, how much of what is counted happens in a cycle,
// and REPLAYED, what that is called; task explain, which calls `field` for all outputs from the highest on.
  reg [OUT_BITS-1:0] expected, care;
  wire [OUT_BITS-1:0] difference = (actual ^ expected) & care;

  // Names the field, of the next `bits` bits from the top, that differs.
  integer at, bit_number;
  reg is_unknown, is_different;
  task field;
    input [8*24-1:0] name;
    input integer bits;
    begin
      is_unknown = 1'b0;
      is_different = 1'b0;
      for (bit_number = at - bits; bit_number < at; bit_number = bit_number + 1) begin
        if (difference[bit_number] === 1'bx) is_unknown = 1'b1;
        if (difference[bit_number] === 1'b1) is_different = 1'b1;
      end
      if (is_unknown) $display("  X on %0s", name);
      if (is_different) $display("  %0s is not as recorded", name);
      at = at - bits;
    end
  endtask

  reg [8*256-1:0] path;
  integer file, read, cycles, counted, checked;
  reg failed;
  initial begin
    failed = 1'b0;
    cycles = 0;
    counted = 0;
    checked = 0;
    if (!$value$plusargs("vectors=%s", path)) begin
      $display("FAILED: give the recorded vectors as +vectors=FILE");
      $finish;
    end
    file = $fopen(path, "r");
    if (file == 0) begin
      $display("FAILED: %0s cannot be read", path);
      $finish;
    end
    read = $fscanf(file, "%h %h %h", in, expected, care);
    while (read == 3) begin
      #5;
      if (|care) checked = checked + 1;
      if (difference !== {OUT_BITS{1'b0}}) begin
        $display("FAILED: cycle %0d", cycles);
        at = OUT_BITS;
        explain;
        if (at != 0) $display("  the bench's list of fields is %0d bits off", at);
        failed = 1'b1;
        read = 0;
      end else begin
        if (|care) counted = counted + events;
        clk = 1'b1;
        #5 clk = 1'b0;
        cycles = cycles + 1;
        read = $fscanf(file, "%h %h %h", in, expected, care);
      end
    end
    if (!failed && counted > 0)
      $display("%0d %0s as recorded in %0d cycles, and no X is seen", counted, REPLAYED, checked);
    else $display("FAILED: %0d %0s in %0d cycles", counted, REPLAYED, checked);
    $finish;
  end
