#!/usr/bin/env python3
"""The synthesis flow on small blocks: what it refuses, what it measures, what it proves. RAYPOOL names the program."""
import ctypes
import json
import os
import random
import select
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))

from synth import elaborate, flow, function, library, mapping, netlist, prove, replay, report, timing  # noqa: E402
from synth.errors import SynthError  # noqa: E402
from synth.memories import MemoryModel  # noqa: E402


def small_design(folder, top, parameters):
    """One block mapped alone, as a design."""
    lib = library.Library()
    design = flow.Design(flow.Options(config=top), lib, {}, folder, 4.0, 0.1)
    design.kinds = elaborate.tree(parameters, folder, top)
    design.memory = MemoryModel(lib)
    mapper = mapping.Mapper(lib, folder, 4.0, 2)
    paths = mapper.map_all([k for k in design.kinds.values() if not k.memory])
    design.netlist = netlist.Netlist(design.kinds, paths, lib, top)
    return design


class Synthesis(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(subprocess.run, ["rm", "-rf", self.folder], check=False)

    def command(self, *arguments):
        done = subprocess.run(
            [sys.executable, "-m", "synth", *arguments],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "scripts")},
        )
        return done.returncode, done.stderr.strip()

    def test_bad_input_gets_one_sentence(self):
        run = os.path.join(self.folder, "run.json")
        with open(run, "w", encoding="utf-8") as file:
            json.dump({"mrays_per_second": 1.0, "config": "4w4c"}, file)
        for arguments, word in (
            (["report", "--liberty", "/no/such.lib"], "Liberty"),
            (["report", "--config", "5w5c"], "5"),
            (["report", "--memories", "clay", "--config", "1w1c"], "clay"),
            (["report", "--config", "1w1c", "--against", "/dev/null"], "/dev/null"),
            (["report", "--config", "1w1c", "--run", "/dev/null"], "RUN=/dev/null"),
            (["report", "--config", "1w1c", "--run", run], "4w4c"),
            (["report", "--config", "1w1c", "--clock", "soon"], "CLOCK=soon"),
            (["prove", "--config", "1w1c", "--only", "teapot"], "has no block teapot"),
            (["growth", "--plan", run], "not a plan"),
        ):
            code, text = self.command(*arguments)
            self.assertEqual(code, 1, text)
            self.assertIn(word, text)
            self.assertNotIn("Traceback", text)

    def test_two_in_one_folder_take_turns(self):
        opens = (
            "import sys; from synth import flow; flow.open_design(flow.Options(config='1w1c', out=sys.argv[1])); "
            "print('open', flush=True); sys.stdin.read()"
        )

        def start():
            return subprocess.Popen(
                [sys.executable, "-c", opens, self.folder], text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.PIPE, env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "scripts")},
            )  # fmt: skip

        with start() as first, start() as second:
            both = {first.stdout: (first, second), second.stdout: (second, first)}
            ready = select.select(list(both), [], [], 60)[0]
            self.assertEqual(len(ready), 1)
            has, waits = both[ready[0]]
            ready = select.select([waits.stdout, waits.stderr], [], [], 60)[0]
            self.assertEqual(ready, [waits.stderr])
            self.assertIn("waiting for another synthesis", waits.stderr.readline())
            self.assertFalse(select.select([waits.stdout], [], [], 0.5)[0])
            # However it ends.
            has.kill()
            self.assertEqual(waits.stdout.readline(), "open\n")
            waits.stdin.close()

    def test_cell_functions_and_fo4(self):
        lib = library.Library()
        self.assertEqual(function.truth("(!(A B))", ["A", "B"]), 0b0111)
        self.assertEqual(function.truth("A ^ B' + 0", ["A", "B"]), 0b1001)
        self.assertEqual(function.truth("!A*B | A&!B", ["A", "B"]), 0b0110)
        self.assertEqual(lib._smallest("nand", 2, 0b0111), lib.nand2)  # pylint: disable=protected-access
        self.assertNotIn("LATCH", lib.usable)
        fo4 = timing.measure_fo4(lib, self.folder)
        self.assertTrue(0.03 < fo4 < 0.3, fo4)

    def test_a_latch_is_refused(self):
        path = os.path.join(self.folder, "rtl", "held.v")
        os.makedirs(os.path.dirname(path))
        with open(path, "w", encoding="utf-8") as file:
            file.write(
                "module held (input wire e_i, input wire d_i, output reg q_o);\n  always @* if (e_i) q_o = "
                "d_i;\nendmodule\n"
            )
        mapper = mapping.Mapper(library.Library(), self.folder, 4.0)
        kind = elaborate.Kind(
            "held", "held", {}, {"e_i": ("input", 1), "d_i": ("input", 1), "q_o": ("output", 1)}, {}, "held"
        )
        mapper.texts["rtl/held.v"] = ""
        original = elaborate.rtl_files
        elaborate.rtl_files = lambda: [path]
        try:
            with self.assertRaisesRegex(SynthError, "dlatch"):
                mapper.map_all([kind])
        finally:
            elaborate.rtl_files = original

    def test_memories_are_priced_and_areas_add_up(self):
        design = small_design(self.folder, "ray_memory", {"CONTENTS": "16"})
        rows, _ = report.blocks(design)
        self.assertEqual(rows[0]["memory_bits"], 4 * 84 * 32)
        self.assertEqual(rows[0]["flip_flops"], 2)
        self.assertEqual(sum(r["memory_bits"] for r in rows[1:]), rows[0]["memory_bits"])
        self.assertGreater(rows[0]["logic_um2"], 100 * design.library.nand2_area)
        report.check({**{g: {n: 0 for n in names} for g, names in report.NEEDED.items()}, "blocks": rows})

    def simulate(self, design, events):
        """The values of the mapped counter while it is given events, cycle by cycle."""
        replay.simulator(design, self.folder, False)
        root = subprocess.run(
            ["verilator", "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=True
        ).stdout.strip()
        path = os.path.join(self.folder, "gates.so")
        subprocess.run(
            [
                "g++",
                "-std=c++17",
                "-shared",
                "-fPIC",
                f"-I{root}/include/vltstd",
                f"{ROOT}/sim/rtl/gate_simulator.cpp",
                "-o",
                path,
            ],
            check=True,
        )
        gates = ctypes.CDLL(path)
        gates.netlist_open.restype = ctypes.c_void_p
        unit = ctypes.c_void_p(gates.netlist_open(os.path.join(self.folder, "netlist.bin").encode()))
        inputs, outputs, values = (ctypes.c_uint32 * 1)(), (ctypes.c_uint32 * 1)(), []
        for cycle, event in enumerate(events):
            inputs[0] = (cycle > 0) | event << 1
            gates.netlist_settle(unit, inputs, outputs)
            values.append(outputs[0] & 0x7FFF)
            gates.netlist_clock(unit)
        gates.netlist_close(unit, False)
        return values

    def test_a_netlist_is_simulated_as_its_rtl_says_and_a_swapped_cell_shows(self):
        # Few enough bits that every one of them changes, so that no cell can be swapped unseen.
        design = small_design(self.folder, "event_counter", {"EVENT_BITS": "6", "BITS": "15"})
        numbers = random.Random(1)
        events = [numbers.randrange(64) for _ in range(2000)]
        # Reset takes the first cycle; the carry reaches the high part a cycle later.
        low, carry, high, expected = 0, 0, 0, []
        for cycle, event in enumerate(events):
            expected.append((high << 12 | low) & 0x7FFF)
            high, total = (high + carry, low + event) if cycle else (0, 0)
            low, carry = total & 0xFFF, total >> 12
        self.assertGreater(high, 8)
        self.assertEqual(self.simulate(design, events), expected)
        replay.broken(design, 1, "event_counter")
        self.assertNotEqual(self.simulate(design, events), expected)

    def test_a_block_is_proved_and_a_swapped_cell_noticed(self):
        design = small_design(self.folder, "fetch_arbiter", {"WARPS": "4", "WARP_BITS": "2"})
        self.assertEqual(set(prove.prove(design).values()), {"proved"})
        largest = max(design.netlist.modules.values(), key=lambda m: len(m.gates))
        self.assertIn("became", replay.broken(design, 1, largest.kind.base))
        self.assertEqual(prove.prove(design)[largest.name], "different")


if __name__ == "__main__":
    unittest.main(verbosity=2)
