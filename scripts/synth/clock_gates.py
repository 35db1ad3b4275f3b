"""Registers that load by an enable get a clock gate for each enable, where the library's set-up names that cell: a
register of 32 bits then costs one gate instead of 32 multiplexers. What reads a netlist as logic gets the enable back.
"""

# Below this many bits of a register a gate costs more than the multiplexers.
FEWEST_BITS = 3

MAP = """
// Registers with an enable: CLK reaches them in cycles after which they hold something new.
module raypool_gate (input wire CLK, input wire EN, output wire GATED);
  {cell} clock_gate (.{clock}(CLK), .{enable}(EN), {test}.{output}(GATED));
endmodule

(* techmap_celltype = "$dffe" *)
module raypool_dffe (CLK, EN, D, Q);
  parameter WIDTH = 1, CLK_POLARITY = 1, EN_POLARITY = 1;
  input wire CLK, EN;
  input wire [WIDTH-1:0] D;
  output wire [WIDTH-1:0] Q;
  wire _TECHMAP_FAIL_ = WIDTH < {fewest} || !CLK_POLARITY;
  wire gated;
  raypool_gate gate (.CLK(CLK), .EN(EN_POLARITY ? EN : ~EN), .GATED(gated));
  \\$dff #(.WIDTH(WIDTH), .CLK_POLARITY(1'b1)) register (.CLK(gated), .D(D), .Q(Q));
endmodule

// A reset that counts without the enable opens the gate too.
(* techmap_celltype = "$sdffe" *)
module raypool_sdffe (CLK, SRST, EN, D, Q);
  parameter WIDTH = 1, CLK_POLARITY = 1, EN_POLARITY = 1, SRST_POLARITY = 1, SRST_VALUE = 0;
  input wire CLK, SRST, EN;
  input wire [WIDTH-1:0] D;
  output wire [WIDTH-1:0] Q;
  wire _TECHMAP_FAIL_ = WIDTH < {fewest} || !CLK_POLARITY;
  wire gated;
  raypool_gate gate (.CLK(CLK), .EN((EN_POLARITY ? EN : ~EN) | (SRST_POLARITY ? SRST : ~SRST)), .GATED(gated));
  \\$sdff #(.WIDTH(WIDTH), .CLK_POLARITY(1'b1), .SRST_POLARITY(SRST_POLARITY), .SRST_VALUE(SRST_VALUE)) register
    (.CLK(gated), .SRST(SRST), .D(D), .Q(Q));
endmodule

(* techmap_celltype = "$sdffce" *)
module raypool_sdffce (CLK, SRST, EN, D, Q);
  parameter WIDTH = 1, CLK_POLARITY = 1, EN_POLARITY = 1, SRST_POLARITY = 1, SRST_VALUE = 0;
  input wire CLK, SRST, EN;
  input wire [WIDTH-1:0] D;
  output wire [WIDTH-1:0] Q;
  wire _TECHMAP_FAIL_ = WIDTH < {fewest} || !CLK_POLARITY;
  wire gated;
  raypool_gate gate (.CLK(CLK), .EN(EN_POLARITY ? EN : ~EN), .GATED(gated));
  \\$sdff #(.WIDTH(WIDTH), .CLK_POLARITY(1'b1), .SRST_POLARITY(SRST_POLARITY), .SRST_VALUE(SRST_VALUE)) register
    (.CLK(gated), .SRST(SRST), .D(D), .Q(Q));
endmodule
"""


def map_text(library):
    """Verilog for Yosys' techmap, which puts the gates in; empty where the library has none."""
    if not library.clock_gate:
        return ""
    pins = {pin.gate: name for name, pin in library.cells[library.clock_gate].pins.items() if pin.gate}
    return MAP.format(
        cell=library.clock_gate,
        fewest=FEWEST_BITS,
        clock=pins["clock"],
        enable=pins["enable"],
        output=pins["output"],
        test=f".{pins['test']}(1'b0), " if "test" in pins else "",
    )


def enables(library, module):
    """Of a mapped block: the net behind each clock gate, with the nets of its clock and enable."""
    found = {}
    for cell, pins in module.gates.values():
        if library.cells[cell].kind == "clock_gate":
            net = {library.cells[cell].pins[pin].gate: net for pin, net in pins.items()}
            found[net["output"]] = (net["clock"], net["enable"])
    return found


def flop_clock(cell):
    """The name of a flip-flop's clock pin."""
    return cell.sequential.attributes["clocked_on"].strip("() ")
