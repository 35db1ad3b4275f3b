#!/usr/bin/env python3
"""Mapped blocks do what their RTL does, and where a cell is another one, simulation and proof detect it."""
import ctypes
import os
import random
import subprocess
import unittest
from collections import Counter
from unittest import mock

from small_blocks import ROOT, SmallBlocks, small_design

from synth import clock_gates, library, prove, replay, report
from synth.errors import SynthError


class MappedBlocks(SmallBlocks):
    def simulated(self, design, cycles, wires=0):
        """What the outputs of a mapped block are while it is given inputs, cycle by cycle; the first port lowest. Above
        them are so many bits of wires that are read.
        """
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
        bits = Counter({"input": -1, "output": wires})  # the clock is none
        for direction, width in design.kinds[design.netlist.top].ports.values():
            bits[direction] += width
        inputs, outputs = ((ctypes.c_uint32 * ((bits[way] + 31) // 32))() for way in ("input", "output"))
        values = []
        for given in cycles:
            for place in range(len(inputs)):
                inputs[place] = (given & (1 << bits["input"]) - 1) >> (32 * place) & 0xFFFFFFFF
            gates.netlist_settle(unit, inputs, outputs)
            values.append(sum(word << (32 * place) for place, word in enumerate(outputs)))
            gates.netlist_clock(unit)
        gates.netlist_close(unit, False)
        return values

    def simulate(self, design, events):
        """The values of the mapped counter while it is given events, cycle by cycle."""
        cycles = [(cycle > 0) | event << 1 for cycle, event in enumerate(events)]
        return [outputs & 0x7FFF for outputs in self.simulated(design, cycles)]

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

    def test_wires_that_a_wrapper_reads_are_found_in_the_netlist(self):
        design = small_design(self.folder, "frame_port", {})
        probes = self.written("frame_port_probes.vlt", 'public_flat_rd -module "rp_frame_port" -var "count"\n')
        numbers = random.Random(1)
        cycles = [numbers.getrandbits(300) & ~1 | (cycle > 0) for cycle in range(300)]
        with mock.patch.object(replay, "PROBES", os.path.join(self.folder, "{}_probes.vlt")):
            values = self.simulated(design, cycles, wires=2)
            shell = os.path.join(self.folder, "frame_port.sv")
            with open(shell, encoding="utf-8") as file:
                self.assertIn("wire [1:0] count;", file.read())
            ports = sum(w for d, w in design.kinds["frame_port"].ports.values() if d == "output")
            counts = [value >> ports for value in values]
            self.assertEqual(set(counts), {0, 1, 2})
            # Its first output is high when there is room.
            self.assertEqual([count != 2 for count in counts], [bool(value & 1) for value in values])
            with open(probes, "a", encoding="utf-8") as file:
                file.write('public_flat_rd -module "rp_frame_port" -var "take"\n')
            with self.assertRaisesRegex(SynthError, "rp_frame_port.v has no wire take that one of its blocks"):
                self.simulated(design, cycles)

    def test_clock_gates_load_registers_when_their_enables_say_so(self):
        lib = self.gated_library()
        # Its set-up is for this library alone.
        self.assertEqual((lib.name, lib.clock_gate, library.Library().clock_gate), ("gated", "ICG", None))
        chosen = {"WARPS": "2", "LANES": "1", "WARP_BITS": "1", "TYPE": "4"}
        gated = small_design(self.folder, "task_register", chosen, lib)
        plain = small_design(self.folder, "task_register", chosen)
        module = gated.netlist.modules["task_register"]
        gates = len(clock_gates.enables(lib, module))
        self.assertGreater(gates, 0)
        # The library has one flip-flop.
        whole = report.blocks(gated)[0][0]
        self.assertEqual(whole["clocked_um2"], whole["flip_flops"] * lib.cells["DFFPOSX1"].area + gates * 112)
        self.assertLess(gated.netlist.own_area("task_register"), plain.netlist.own_area("task_register"))
        self.assertEqual(set(prove.prove(gated).values()), {"proved"})
        numbers = random.Random(1)
        # The first cycle is one of reset, at the lowest bit.
        cycles = [numbers.getrandbits(384) & ~1 | (cycle > 0) for cycle in range(1000)]
        values = self.simulated(plain, cycles)
        self.assertGreater(len(set(values)), 100)
        self.assertEqual(self.simulated(gated, cycles)[2:], values[2:])
        # Gates that are always open.
        for _, pins in [gate for gate in module.gates.values() if gate[0] == "ICG"]:
            pins["E"] = "1"
        self.assertNotEqual(self.simulated(gated, cycles)[2:], values[2:])
        self.assertEqual(set(prove.prove(gated).values()), {"different"})

    def test_a_block_is_proved_and_a_swapped_cell_detected(self):
        design = small_design(self.folder, "fetch_arbiter", {"WARPS": "4", "WARP_BITS": "2"})
        self.assertEqual(set(prove.prove(design).values()), {"proved"})
        largest = max(design.netlist.modules.values(), key=lambda m: len(m.gates))
        self.assertIn("became", replay.broken(design, 1, largest.kind.base))
        self.assertEqual(prove.prove(design)[largest.name], "different")


if __name__ == "__main__":
    unittest.main(verbosity=2)
