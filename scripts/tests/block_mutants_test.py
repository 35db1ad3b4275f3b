#!/usr/bin/env python3
"""scripts/faults/blocks.py puts faults where expressions read something and nowhere else, the same ones every time, and
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
import faults.__main__  # noqa: E402  the path comes first
from faults import blocks, errors, mutants  # noqa: E402

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


def faults_of(count, seed=1):
    return blocks.mutants_of(MODULE, count, seed)


class Blocks(unittest.TestCase):
    def test_an_expression_is_what_is_assigned_asked_or_given(self):
        places = blocks.expressions(blocks.without_comments(MODULE))
        self.assertEqual(
            [MODULE[begin:end] for begin, end in places],
            ["a_i && |b_i", "!either", "b_i == 4'd3 ? {state_o[6:0], a_i} : state_o + 8'd1", "either != none",
             "state_o <= 8'd200", "next", "clk_i", "next"],
        )  # fmt: skip

    def test_each_fault_changes_one_token_of_one_expression(self):
        every = [fault for seed in range(1, 40) for fault in faults_of(10**6, seed)]
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
        self.assertEqual(faults_of(8), faults_of(8))
        self.assertNotEqual(faults_of(8), faults_of(8, 2))
        self.assertEqual(len(faults_of(8)), 8)
        # Whatever stands before them.
        longer = MODULE.replace("  wire either", "  reg other;\n  always @(posedge clk_i) other <= a_i;\n  wire either")
        known = {what for *_, what in faults_of(8)}
        left = known & {what for *_, what in blocks.mutants_of(longer, 8, 1)}
        self.assertGreaterEqual(len(left), 6)

    def test_all_that_make_faults_uses_is_verilog(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            files = [f"rp_{module}.v" for module in faults.__main__.MODULES]
            options = faults.__main__.arguments_of(["blocks", name, "--count", "20", "--seed", "7"])
            faults.__main__.put_in("blocks", folder, options)
            told = json.loads((folder / "faults.json").read_text())
            self.assertEqual(told["judged"], "none")
            listed = told["faults"]
            self.assertEqual([fault["number"] for fault in listed], list(range(1, len(listed) + 1)))
            self.assertEqual({fault["file"] for fault in listed}, set(files))
            lint = ["verilator", "--lint-only", "-DSYNTHESIS", "--default-language", "1364-2005",
                    f"-I{folder}/rtl/include", "--top-module", "rp_traverser", "-GLANES=1", "-GSLOTS=2",
                    "-GTRIANGLE_PIPES=1",
                    *(folder / "rtl").glob("*.vlt"), *(folder / "rtl").glob("*/*.v")]  # fmt: skip
            done = subprocess.run(lint, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr[:2000])

    def test_a_module_that_is_not_there_is_refused(self):
        for put_in in (lambda: blocks.put_in({}, 1, 1, ["nothing.v"]),
                       lambda: mutants.put_in({}, None, 1, 1, ["nothing.v"], [])):  # fmt: skip
            with self.assertRaisesRegex(errors.Refused, "^there is no rtl/nothing.v"):
                put_in()

    def test_survivors_are_judged_of_the_faults_that_the_file_is_about_alone(self):
        for words, judged, count in (([], "all", 300), (["--modules", "box_axis"], "some", 10),
                                     (["--count", "3"], "none", 90),
                                     (["--seed", "2", "--modules", "box_axis"], "none", 10)):  # fmt: skip
            with tempfile.TemporaryDirectory() as name:
                options = faults.__main__.arguments_of(["blocks", name, *words])
                faults.__main__.put_in("blocks", pathlib.Path(name), options)
                told = json.loads((pathlib.Path(name) / "faults.json").read_text())
                self.assertEqual((told["judged"], len(told["faults"])), (judged, count), words)


class Mutants(unittest.TestCase):
    def test_are_named_without_the_numbers_that_yosys_makes_up(self):
        line = (r"mutate -ctrl mutant_i 9 7 -mode cnot1 -module rp_compute_unit "
                r"-cell $flatten\gen_warp[0].warp.$eq$rtl/include/x.vh:13$4711 -port A -portbit 2 -ctrlbit 5 "
                r"-wire \warp.q -wirebit 8 -src rtl/compute/rp_warp.v:0.0-0.0 "
                r"-src rtl/compute/rp_pc_stack.v:52.7-83.14 "
                r"-src rtl/compute/rp_warp.v:55.19-57.70")
        self.assertEqual(mutants.fault_of(7, line), {
            "number": 7, "file": "rp_pc_stack.v",
            "bug": r"cnot1, A[2] of gen_warp[0].warp.eq at x.vh:13, by bit 5, wire \warp.q[8]"})  # fmt: skip
        made = mutants.fault_of(1, "mutate -mode inv -cell $auto$opt_reduce.cc:134:opt_pmux$99 -port Y -portbit 0")
        self.assertEqual((made["file"], made["bug"]), ("(made by Yosys)", "inv, Y[0] of opt_pmux"))


if __name__ == "__main__":
    unittest.main()
