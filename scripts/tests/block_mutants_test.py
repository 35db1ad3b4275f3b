#!/usr/bin/env python3
"""scripts/block_mutants.py puts faults where expressions read something and nowhere else, the same ones every time, and
what comes of all modules of rtl/ that it is used for is Verilog."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import block_mutants  # noqa: E402  the path comes first

MODULE = """// a_i && b_i: of comments nothing is read
module small #(
  parameter integer WIDTH = 4
) (
  input  wire             clk_i,
  input  wire             a_i,
  input  wire [WIDTH-1:0] b_i,
  output wire             sum_o,
  output reg  [7:0]       state_o
);
  localparam integer LAST = WIDTH - 1;
  wire either = a_i && |b_i, none = !either;
  wire [7:0] next = b_i == 4'd3 ? {state_o[6:0], a_i} : state_o + 8'd1;
  assign sum_o = either != none;
  always @(posedge clk_i) begin
    if (state_o <= 8'd200) state_o <= next;
  end
  ram ram (.clk_i(clk_i), .data_i(next), .data_o(unread));
endmodule
"""


def mutants(count, seed=1):
    return block_mutants.mutants_of(MODULE, count, seed)


class BlockMutants(unittest.TestCase):
    def test_an_expression_is_what_is_assigned_asked_or_given(self):
        places = block_mutants.expressions(block_mutants.without_comments(MODULE))
        self.assertEqual(
            [MODULE[begin:end] for begin, end in places],
            ["a_i && |b_i", "!either", "b_i == 4'd3 ? {state_o[6:0], a_i} : state_o + 8'd1", "either != none",
             "state_o <= 8'd200", "next", "clk_i", "next"],
        )  # fmt: skip

    def test_each_fault_changes_one_token_of_one_expression(self):
        every = [fault for seed in range(1, 40) for fault in mutants(10**6, seed)]
        said = [what for *_, what in every]
        for part in ("|| in place of &&", "! is left out", "== in place of !=", "< in place of <=", "- in place of +",
                     "not 1'b0", "a_i is inverted", "bit 0 of b_i is 1", "bit (WIDTH-1) of b_i is"):  # fmt: skip
            with self.subTest(part):
                self.assertEqual(any(part in what for what in said), part != "not 1'b0", said)
        for begin, end, wrong, what in every:
            self.assertNotEqual(wrong, MODULE[begin:end], what)
            self.assertNotIn("clk_i ", wrong)
            self.assertTrue(what.endswith(" in " + MODULE[begin:end]) or what.endswith("(2)"), what)
        numbers = [re.search(r"(8'd\d+) in place of 8'd200", what) for what in said]
        self.assertTrue({found[1] for found in numbers if found} <= {"8'd199", "8'd201"})

    def test_the_same_seed_is_the_same_faults(self):
        self.assertEqual(mutants(8), mutants(8))
        self.assertNotEqual(mutants(8), mutants(8, 2))
        self.assertEqual(len(mutants(8)), 8)
        # Whatever stands before them.
        longer = MODULE.replace("  wire either", "  reg other;\n  always @(posedge clk_i) other <= a_i;\n  wire either")
        known = {what for *_, what in mutants(8)}
        left = known & {what for *_, what in block_mutants.mutants_of(longer, 8, 1)}
        self.assertGreaterEqual(len(left), 6)

    def test_all_that_make_block_mutants_uses_is_verilog(self):
        makefile = (ROOT / "Makefile").read_text().replace("\\\n", "")
        files = [f"{name}.v" for name in re.search(r"^MODULES +\?= (.*)$", makefile, re.M)[1].split()]
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            script = [sys.executable, ROOT / "scripts/block_mutants.py", ROOT / "rtl", folder / "rtl"]
            subprocess.run([*script, folder / "list.json", "20", "7", *files], check=True, stdout=subprocess.DEVNULL)
            listed = json.loads((folder / "list.json").read_text())
            self.assertEqual([fault["number"] for fault in listed], list(range(1, len(listed) + 1)))
            self.assertEqual({fault["file"] for fault in listed}, set(files))
            lint = ["verilator", "--lint-only", "-DSYNTHESIS", "--default-language", "1364-2005", f"-I{folder}/rtl",
                    "--top-module", "traverser", "-GLANES=1", "-GSLOTS=2", "-GTRIANGLE_PIPES=1",
                    *(folder / "rtl").glob("*.vlt"), folder / "rtl/traverser.v", "-y", folder / "rtl"]  # fmt: skip
            done = subprocess.run(lint, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr[:2000])
            # A module that is not there is refused in a sentence.
            unknown = [*script, folder / "list.json", "1", "1", "nothing.v"]
            done = subprocess.run(unknown, capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (1, "block_mutants.py: there is no rtl/nothing.v\n"))


if __name__ == "__main__":
    unittest.main()
