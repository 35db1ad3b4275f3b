#!/usr/bin/env python3
"""The synthesis flow on small blocks: what it refuses and what it measures. RAYPOOL names the program."""
import fnmatch
import json
import os
import re
import select
import subprocess
import sys
import unittest
from unittest import mock

from small_blocks import ROOT, SmallBlocks, small_design

from synth import elaborate, fit, flow, function, library, macros, mapping, module, netlist, phases, power, report
from synth import timing
from synth.errors import SynthError
from synth.memories import MemoryModel

# Of each kind of block of 4w4c its size in bits, and the seconds that a processor took to map it.
MAPPED = [
    (32042, 11), (31535, 7), (25635, 5), (24727, 6), (15130, 5), (13659, 13), (12455, 4), (11968, 5), (11556, 9),
    (8963, 15), (7465, 55), (7072, 5), (6725, 8), (6056, 9), (5965, 6), (5828, 7), (3797, 6), (3506, 7), (3330, 5),
    (3211, 6), (3159, 5), (3029, 8), (2997, 7), (2783, 7), (2783, 7), (2783, 6), (2532, 4), (2254, 6), (2141, 7),
    (1949, 6), (1675, 6), (1607, 6), (1267, 6), (1160, 6), (1059, 6), (1047, 5), (993, 10), (776, 6), (730, 5),
    (552, 6), (509, 5), (509, 5), (304, 5), (234, 8), (150, 5), (149, 5), (149, 6), (149, 5), (136, 4), (53, 5),
    (42, 5), (19, 6), (14, 5), (6, 4), (5, 4), (2, 4), (0, 5),
]
# One port; the semicolon after `when` is missing in files that are in use.
MACRO = """library (of_a_memory) { time_unit : "1ns"; cell (sram_64x20) {
  area : 4000; memory () { type : ram; address_width : 6; word_width : 20; }
  pin (CLK) { direction : input; clock : true; }
  bus (A) { direction : input; timing () { timing_type : setup_rising; related_pin : "CLK"; when : "(E)"
    rise_constraint (t) { values ("0.1, 0.2, 0.3", "0.2, 0.35, 0.4", "0.5, 0.6, 0.7"); } } }
  bus (TEST) { direction : input; timing () { timing_type : setup_rising; related_pin : "CLK_TEST";
    rise_constraint (t) { values ("9"); } } }
  bus (Q) { direction : output; timing () { related_pin : "CLK"; timing_type : rising_edge;
    cell_rise (t) { values ("1.5"); } cell_fall (t) { values ("1.25"); } } }
} }
"""


class Synthesis(SmallBlocks):
    """One block at a time, and what the flow decides."""

    def test_what_a_fit_saves_is_told_by_change_and_in_all(self):
        """Units of which each part has a price stand in for synthesised ones."""
        base = {"name": "whole", "warps": 8, "slow_lanes": 8, "alus": {"int": {"without": []}}, "chip": {"size": 1}}
        fitted = {**base, "name": "less", "slow_lanes": 1, "alus": {"int": {"without": ["imul"]}}}
        changes = [("slow_lanes", 1), ("alus.int.without", ["imul"]), ("chip.size", 2)]
        found = {"base": base, "fitted": fitted, "file": "less.json", "config": "8w8c", "set": ["chip.size=1 warps=8"],
                 "changes": [{"field": field, "to": to, "why": ""} for field, to in changes]}  # fmt: skip
        path = self.written("found.json", json.dumps(found))
        names, printed = [], []

        def priced(unit, jobs, name):
            self.assertNotIn("chip", unit)
            names.append(name)
            logic = 100.0 + 10 * unit["slow_lanes"] - 5 * len(unit["alus"]["int"]["without"])
            return {"logic_kge": logic, "memory_kge": 1.0, "memory_bits": 64, "flip_flops": 8 * unit["slow_lanes"]}

        with mock.patch.object(fit, "area_of", priced), mock.patch.object(fit, "say", printed.append):
            results = fit.fit(path, 1)
        saved = [line.split() for line in printed[1:]]
        self.assertEqual(saved[0], ["slow_lanes", "70.0", "0.0", "0", "56", "38.9%"])
        self.assertEqual(saved[1], ["alus.int.without", "5.0", "0.0", "0", "0", "2.8%"])
        self.assertEqual(saved[2], ["chip.size", "0.0", "0.0", "0", "0", "0.0%"])
        self.assertEqual(saved[3], ["all", "of", "it", "75.0", "0.0", "0", "56", "41.7%"])
        self.assertEqual(results["fitted"]["logic_kge"], 105.0)
        self.assertEqual(names[0], names[3], "a chip makes no other unit")
        self.assertEqual(len(set(names)), 4)

    def test_set_ups_are_complete_and_their_cells_must_be_there(self):
        known = library.setups()
        self.assertLessEqual({"osu018", "sky130hd", "sg13g2", "nangate45"}, set(known))
        fields = {"matches", "where", "nand2", "inverter", "driver", "avoid"}
        optional = {"liberty", "verilog", "clock_ns", "clock_gate", "loads_ff", "again"}
        inverter = "library (LIBRARY) { cell (INV) { area : 1; pin (A) { direction : input; capacitance : 1; } "
        inverter += 'pin (Y) { direction : output; function : "!A"; } } }'
        for name, setup in known.items():
            self.assertLessEqual(fields, set(setup), name)
            self.assertLessEqual(set(setup), fields | optional, name)
            for cell in (setup["nand2"], setup["inverter"], setup["driver"], setup.get("clock_gate", "")):
                self.assertFalse([p for p in setup["avoid"] if fnmatch.fnmatchcase(cell, p)], cell)
            path = self.written("other.lib", inverter.replace("LIBRARY", setup["matches"].replace("*", "x")))
            with self.assertRaisesRegex(SynthError, f"{name}.json: the library {path} has no cell {setup['nand2']}"):
                library.Library(path)

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
        wires = 'wire_load ("long") { capacitance : 0.001; resistance : 0; slope : 10; fanout_length (1, 10); } '
        wires += 'default_wire_load : "long"; '
        place = lib.text.index("lu_table_template")
        wired = library.Library(self.written("wired.lib", lib.text[:place] + wires + lib.text[place:]))
        self.assertEqual((lib.wire_load, wired.wire_load), ("", "long"))
        self.assertGreater(timing.measure_fo4(wired, self.folder), 1.2 * fo4)

    def test_the_last_effort_waits_for_the_others(self):
        def chosen(**efforts):
            design = flow.Design(None, None, {}, "", efforts=efforts)
            design.netlist = mock.Mock(modules=["a", "b"])
            return flow.next_effort(design, {"a", "b", "memory"})

        self.assertEqual(chosen(), {"a", "b"})
        self.assertEqual(chosen(a=2, b=1), {"b"})
        self.assertEqual(chosen(a=2, b=2), {"a", "b"})
        self.assertEqual(chosen(a=3, b=2), {"b"})
        self.assertEqual(chosen(a=3, b=3), set())
        self.assertEqual(len(mapping.efforts_of(library.Library())), mapping.AREA_EFFORT + 1)
        self.assertEqual(mapping.AREA_EFFORT, mapping.LAST_EFFORT + 1)

    def won_back(self, efforts, slack_of):
        """The efforts that are left when area has been won back, of two kinds that were mapped in every way, one of
        them with three instances; `slack_of`: what the clock leaves with given efforts.
        """
        area = {"a": [50, 60, 70, 90, 50], "b": [31, 32, 33, 34, 28]}
        late = {"a": [], "b": [mapping.AREA_EFFORT]}
        way = {"a": "area", "b": "balance"}
        mapper = mock.Mock()
        mapper.area = lambda kind, effort: area[kind.name][effort]
        mapper.result = lambda kind, effort: {
            "way": way[kind.name],
            "delay_ps": 4100 if effort in late[kind.name] else 3000,
        }
        design = flow.Design(mock.Mock(), library.Library(), {}, "", 4.0, efforts=efforts)
        design.kinds = {name: elaborate.Kind(name, "round_robin", {}, {}, {}, name) for name in area}
        design.netlist = mock.Mock(modules=["a", "b"])
        design.netlist.instances.return_value = [((), "a"), (("x",), "b"), (("y",), "b"), (("z",), "b")]
        design.netlist.own_area = lambda identity: area[identity][design.efforts.get(identity, 0)]
        tried = []

        def time_design(_design, _work):
            tried.append(dict(design.efforts))
            return slack_of(design.efforts)

        with mock.patch.multiple(
            flow,
            mapper_of=lambda _: mapper,
            map_design=mock.Mock(),
            time_design=time_design,
            on_failing_paths=lambda *_: {"a"},
        ):
            slack = flow.win_back(design, "", slack_of(efforts))
            self.assertEqual(slack, slack_of(design.efforts))
        return design.efforts, tried

    def test_area_is_won_back_where_the_clock_allows(self):
        # All the time there is: both as small as they can be; area alone of `b` is too slow in itself.
        left, tried = self.won_back({"a": 3, "b": 2}, lambda efforts: 0.5)
        self.assertEqual((left, tried), ({}, [{"a": 0, "b": 0}]))
        # `a` needs one effort.
        left, tried = self.won_back({"a": 3, "b": 2}, lambda efforts: 0.1 if efforts.get("a", 0) >= 1 else -0.1)
        self.assertEqual((left, tried), ({"a": 1}, [{"a": 0, "b": 0}, {"a": 1, "b": 0}]))
        # `b` needs its efforts, though `a` alone lies on the failing paths.
        left, _ = self.won_back({"a": 3, "b": 2}, lambda efforts: 0.1 if efforts.get("b", 0) == 2 else -0.1)
        self.assertEqual(left, {"a": 3, "b": 2})
        # A unit that is too slow anyhow does not get slower.
        self.assertEqual(self.won_back({"a": 1}, lambda efforts: -0.3 if efforts.get("a") else -0.31)[0], {"a": 1})
        self.assertEqual(self.won_back({"a": 1}, lambda efforts: -0.3)[0], {})

    def test_a_latch_is_refused(self):
        path = os.path.join(self.folder, "rtl", "common", "rp_held.v")
        os.makedirs(os.path.dirname(path))
        with open(path, "w", encoding="utf-8") as file:
            file.write(
                "module rp_held (input wire e_i, input wire d_i, output reg q_o);\n  always @* if (e_i) q_o = "
                "d_i;\nendmodule\n"
            )
        mapper = mapping.Mapper(library.Library(), self.folder, 4.0)
        kind = elaborate.Kind(
            "held", "held", {}, {"e_i": ("input", 1), "d_i": ("input", 1), "q_o": ("output", 1)}, {}, "held"
        )
        mapper.texts["rtl/common/rp_held.v"] = ""
        original = elaborate.rtl_files
        elaborate.rtl_files = lambda: [path]
        try:
            with self.assertRaisesRegex(SynthError, "dlatch"):
                mapper.map_all([kind])
        finally:
            elaborate.rtl_files = original

    def test_kinds_that_are_mapped_alike_are_mapped_once(self):
        kinds = [elaborate.Kind(identity, "round_robin", {}, {}, {}, identity) for identity in ("one", "other")]
        mapper = mapping.Mapper(library.Library(), self.folder, 4.0, 2)
        mapped = []

        def map_one(kind, effort):
            mapped.append(kind)
            with open(mapper.path(kind, effort), "w", encoding="utf-8") as file:
                file.write("{}")

        mapper.map_one = map_one
        paths = mapper.map_all(kinds)
        self.assertEqual(len(mapped), 1)
        self.assertEqual(paths["one"], paths["other"])

    def test_memories_are_priced_and_areas_add_up(self):
        design = small_design(self.folder, "ray_memory", {"CONTENTS": "16"})
        rows, _ = report.blocks(design)
        self.assertEqual(rows[0]["memory_bits"], 4 * 84 * 32)
        self.assertEqual(rows[0]["flip_flops"], 2)
        self.assertEqual(sum(r["memory_bits"] for r in rows[1:]), rows[0]["memory_bits"])
        self.assertGreater(rows[0]["logic_um2"], 100 * design.library.nand2_area)
        report.check({**{g: {n: 0 for n in names} for g, names in report.NEEDED.items()}, "blocks": rows})

    def test_power_follows_activity(self):
        design = small_design(self.folder, "event_counter", {"EVENT_BITS": "6"})
        design.netlist.write(design.verilog)
        os.makedirs(os.path.join(self.folder, "power"))

        def estimated(toggles):
            with mock.patch.object(power, "measure", lambda *_: ({"": (toggles, 100)}, {}, 1000)):
                return power.estimate(design)

        less, more = estimated(5000), estimated(10000)
        self.assertEqual([row["block"] for row in more["blocks"]], ["event_counter"])
        self.assertEqual(more["blocks"][0]["activity"], 0.1)
        self.assertGreater(more["blocks"][0]["switching_w"], 1.5 * less["blocks"][0]["switching_w"])
        self.assertGreater(less["blocks"][0]["switching_w"], 0)

    def test_memory_macros_have_their_own_price_and_times(self):
        self.written("sram.lib", MACRO)
        listed = macros.read(self.folder)
        self.assertEqual(listed, [macros.Macro("sram_64x20", 64, 20, 4000.0, 1.5, 0.35)])
        lib = library.Library()
        model = MemoryModel(lib, listed)

        def ram(base, width, depth):
            return elaborate.Kind("", base, {"WIDTH": f"{width:b}", "DEPTH": f"{depth:b}"}, {}, {})

        fits, other = ram("ram_1rw", 18, 40), MemoryModel(lib)
        self.assertEqual((model.price(fits).nominal, model.access_ns(fits, 0.1)), (4000.0, 1.5))
        self.assertEqual(model.setup_ns(fits, 0.1), 0.35)
        # Too wide, too deep, mostly empty, of two ports.
        for kind in (ram("ram_1rw", 21, 64), ram("ram_1rw", 20, 65), ram("ram_1rw", 20, 31), ram("ram_1r1w", 20, 64)):
            self.assertEqual(model.price(kind), other.price(kind))
            self.assertEqual(model.access_ns(kind, 0.1), other.access_ns(kind, 0.1))
            self.assertEqual(model.setup_ns(kind, 0.1), other.setup_ns(kind, 0.1))

    def test_a_rate_is_given_at_the_clock_that_the_library_allows(self):
        made = {"timing": {"mhz": 250.0}, "forty_nm": {"total_mm2": 0.5}, "area": {"total_kge": 400.0}}
        found = report.efficiency(made, "run", {"mrays_per_second": 60.0, "units": 2})
        self.assertEqual((found["mrays_per_second"], found["mrays_per_second_allowed"]), (60.0, 15.0))
        self.assertEqual(found["mrays_per_second_mm2"], 60.0)
        # The area of a chip is that of all its units.
        chip = report.efficiency(made, "run", {"mrays_per_second": 60.0, "units": 2}, whole_chip=True)
        self.assertEqual((chip["mrays_per_second_mm2"], chip["mrays_per_second_kge"]), (120.0, 0.15))

    def test_other_rounds_map_as_often_for_speed_and_win_no_area_back(self):
        for rounds in (0, 2, flow.CLOSURE_ROUNDS, 6):
            options = flow.Options(config="1w1c", out=self.folder, rounds=rounds)
            design = flow.open_design(options)
            self.assertEqual(flow.label(options, design.library), f"1w1c-{rounds}rounds" if rounds != 4 else "1w1c")
            with mock.patch.multiple(flow, prepare=mock.DEFAULT, map_design=mock.DEFAULT, time_design=mock.DEFAULT,
                                     on_failing_paths=mock.DEFAULT, next_effort=mock.DEFAULT,
                                     win_back=mock.DEFAULT) as done:  # fmt: skip
                done["time_design"].return_value = -1.0
                done["next_effort"].return_value = {"kind"}
                design.kinds = {"kind": elaborate.Kind("kind", "round_robin", {}, {}, {})}
                done["win_back"].return_value = -0.5
                slack = flow.synthesise(design)
            self.assertEqual(done["map_design"].call_count, 1 + rounds)
            self.assertEqual(done["win_back"].call_count, 1 if rounds == flow.CLOSURE_ROUNDS else 0)
            self.assertEqual(slack, -0.5 if rounds == flow.CLOSURE_ROUNDS else -1.0)

    def test_every_phase_says_which_of_how_many_it_is_and_how_long_it_took_last_time(self):
        def lines(rounds, slack, wanted):
            options = flow.Options(config="1w1c", rounds=rounds)
            design = flow.Design(options, library.Library(), {}, self.folder)
            printed = []
            with mock.patch.multiple(flow, timing=mock.DEFAULT, elaborate=mock.DEFAULT, map_design=mock.DEFAULT,
                                     time_design=mock.DEFAULT, win_back=mock.DEFAULT) as done, \
                 mock.patch.object(phases, "progress", printed.append):  # fmt: skip
                done["timing"].measure_fo4.return_value = 0.1
                done["time_design"].return_value = slack
                design.phases = phases.Phases({**flow.phases_of(options), **wanted}, self.folder)
                flow.synthesise(design)
                design.phases.begin("report")
                for name in wanted:
                    design.phases.begin(name)
                design.phases.end()
            return printed

        first = lines(flow.CLOSURE_ROUNDS, 0.1, {"power": "estimate power"})
        numbered = [line for line in first if ": phase " in line and "slack" not in line]
        self.assertEqual([line.split(":")[1].strip() for line in numbered], [f"phase {k} of 7" for k in range(1, 8)])
        self.assertEqual(numbered[-1], "synth: phase 7 of 7: estimate power")
        self.assertTrue(any(line.startswith("synth: phase 3 of 7, 1w1c: slack +0.100 ns") for line in first), first)
        # With other rounds no area is recovered, and with none nothing is mapped for speed: no number is left out.
        for rounds, count in ((2, 5), (0, 4)):
            self.assertIn(f"synth: phase {count} of {count}: trace", lines(rounds, 0.1, {})[-1])
        with open(os.path.join(self.folder, "phases.json"), "w", encoding="utf-8") as file:
            json.dump({"map": 221.0, "time": 2.0}, file)
        again = lines(flow.CLOSURE_ROUNDS, 0.1, {})
        self.assertRegex(again[1], r"phase 2 of 6: map each .* \(last time 4 min\)$")
        self.assertNotIn("last time", again[2])

    def test_mapping_says_how_long_it_still_takes_when_it_knows(self):
        # Of 200,000 in all, what each costs at any size included.
        kinds = [mock.Mock(bits=bits) for bits in (20000, 40000, 60000, 0)]
        seconds = iter((0, 60, 100, 180, 200))
        left = mapping.Remaining(kinds, lambda: next(seconds))
        self.assertEqual([left.after(kind) for kind in kinds], ["", ", about 2 min left", "", ""])

    def test_the_time_that_mapping_still_takes_is_right_to_a_third(self):
        # Two processors take one kind after another, the largest first, as map_all() has them do.
        free, ends = [0, 0], []
        for bits, seconds in MAPPED:
            end = min(free) + seconds
            free[free.index(min(free))] = end
            ends.append((end, bits))
        now = 0
        left = mapping.Remaining([mock.Mock(bits=bits) for bits, _ in MAPPED], lambda: now)
        said = []
        for now, bits in sorted(ends):
            seconds = left.seconds_after(mock.Mock(bits=bits))
            if seconds is not None:
                said.append((seconds, max(free) - now))
        self.assertGreater(len(said), 20)
        self.assertGreater(said[0][1], 0.6 * max(free))
        for seconds, true in said:
            self.assertAlmostEqual(seconds / true, 1, delta=0.34, msg=f"{seconds:.0f} s where {true} s were left")

    def test_progress_names_modules_and_counts_their_kinds(self):
        kinds = [elaborate.Kind(str(n), base, {}, {}, {}, f"{base}_a_bits{n}_b_bits25")
                 for n, base in enumerate(("multiply_tree", "float_lane", "multiply_tree"))]  # fmt: skip
        self.assertEqual(elaborate.in_words(kinds), "float_lane, multiply_tree (2 kinds)")
        printed = []
        with mock.patch.object(phases, "progress", printed.append), \
             mock.patch.multiple(mapping.Mapper, map_one=lambda self, kind, effort: kind,
                                 path=lambda self, kind, effort: f"{self.folder}/{kind.name}"):  # fmt: skip
            mapping.Mapper(library.Library(), self.folder, 4.0).map_all(kinds[:2])
        self.assertEqual(sorted(line.split(": ")[-1] for line in printed[1:]), ["float_lane", "multiply_tree"])

    def test_kinds_that_are_mapped_again_are_said_to_be_and_what_for(self):
        kinds = [elaborate.Kind(str(n), "adder", {}, {}, {}, f"adder{n}") for n in range(2)]
        for again_for, words in (("", ""), ("speed", " again, for speed"), ("area", " again, for area")):
            printed = []
            with mock.patch.object(phases, "progress", printed.append), \
                 mock.patch.multiple(mapping.Mapper, map_one=lambda self, kind, effort: kind,
                                     path=lambda self, kind, effort: f"{self.folder}/{kind.name}"):  # fmt: skip
                mapping.Mapper(library.Library(), self.folder, 4.0).map_all(kinds, {"0": 4}, again_for)
            self.assertEqual(printed[0], f"synth: 2 kinds of block to map{words}")

    def test_a_lane_that_is_larger_than_its_goal_is_said_to_miss_it(self):
        for kge, words in ((11.99, ": met"), (12.0, ": met"), (12.48, ": missed")):
            line = report.lane_line("Flt lane", {"kge": kge, "goal_kge": 12.0})
            self.assertEqual(line, f"Flt lane {kge:.2f} kGE, goal at most 12{words}")
        self.assertEqual(report.lane_line("Slw lane", {"kge": 9.0, "goal_kge": None}), "Slw lane 9.00 kGE")

    def test_a_file_is_reported_by_its_name_and_not_by_its_folder(self):
        options = flow.Options(config="/elsewhere/configurations/4w4c+1_change.json", units=2, rounds=6)
        self.assertEqual(options.title, "4w4c+1_change-chip-2cu")
        self.assertEqual(flow.label(options, library.Library()), "4w4c+1_change-chip-2cu-6rounds")

    def test_more_rounds_than_there_are_try_more_ways(self):
        for rounds, ways in ((1, 2), (flow.CLOSURE_ROUNDS, 2), (flow.CLOSURE_ROUNDS + 1, 4)):
            design = flow.Design(flow.Options(rounds=rounds), library.Library(), {}, "", clock_ns=4.0)
            with mock.patch.object(flow, "BUILD", self.folder):
                mapper = flow.mapper_of(design)
            self.assertEqual([len(e[0]) for e in mapper.efforts[2:4]], [2, ways])

    def test_the_fastest_netlist_of_all_rounds_stays(self):
        for slacks, best, maps in (([-0.9, -0.2, -0.5], {"a": 2}, 4), ([-0.9, -0.9, -0.4], {"a": 3}, 3),
                                   ([-2.0, -1.5, -1.2], {}, 4)):  # fmt: skip
            design = flow.Design(flow.Options(rounds=3), None, {}, "")
            design.kinds = {"a": elaborate.Kind("a", "round_robin", {}, {}, {})}
            with mock.patch.multiple(flow, map_design=mock.DEFAULT, time_design=mock.DEFAULT,
                                     on_failing_paths=mock.DEFAULT, next_effort=mock.DEFAULT) as done:  # fmt: skip
                done["next_effort"].return_value = {"a"}
                done["time_design"].side_effect = slacks + [max(slacks + [-1.0])]
                self.assertEqual(flow.close_timing(design, "", -1.0), max(slacks + [-1.0]))
            self.assertEqual(design.efforts, best)
            self.assertEqual(done["map_design"].call_count, maps)

    def test_published_chips_are_scaled_by_the_square_of_the_feature_size(self):
        lines = report.published()
        sgrt = next(line for line in lines if "SGRT" in line)
        self.assertIn("184 Mrays/s (conference), 25 mm2 at 65 nm, 9.5 at 40: 19.4 a mm2", sgrt)
        self.assertIn("36.7 at 40: 5.3 to 6.5 a mm2", next(line for line in lines if "RayCore" in line))
        self.assertIn("16.0 at 40", next(line for line in lines if "thesis" in line))


class Whole(SmallBlocks):
    """Commands as they are called, and chips."""

    def command(self, *arguments):
        done = subprocess.run(
            [sys.executable, "-m", "synth", *arguments],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "scripts")},
        )
        return done.returncode, done.stderr.strip()

    def test_a_module_alone_has_a_row_for_each_set_of_parameters(self):
        options = flow.Options(memories="flops", jobs=1)
        with mock.patch.object(module, "BUILD", self.folder):
            found = module.synthesise("free_list", ["SIZE=4", "SIZE=8,NUMBER_BITS=3"], options)
        lines = [line.split() for line in module.table(found).splitlines()]
        self.assertEqual(lines[0], ["osu018,", "4", "ns"])
        self.assertEqual([line[0] for line in lines[2:]], ["SIZE=4", "SIZE=8,NUMBER_BITS=3"])
        (kge, flops, slack), (more_kge, more_flops, less_slack) = ([float(x) for x in line[1:4]] for line in lines[2:])
        self.assertGreater(more_kge, kge)
        # Counts of 0 .. SIZE twice, whether there is one and more than one, two addresses, SIZE + 1 places of
        # NUMBER_BITS, what is read, whether it came alone.
        self.assertEqual(flops, 3 + 3 + 2 + 2 + 2 + 4 * 2 + 2 + 2 + 1)
        self.assertGreater(more_flops, flops)
        self.assertTrue(0 < less_slack <= slack < 4)

    def test_bad_input_gets_one_sentence(self):
        run = os.path.join(self.folder, "run.json")
        with open(run, "w", encoding="utf-8") as file:
            json.dump({"mrays_per_second": 1.0, "config": "4w4c", "units": 1, "traverser": "static"}, file)
        self.written("run.json.gz", "not packed")
        for arguments, word in (
            (["report", "--liberty", "/no/such.lib"], "no such Liberty file; LIBERTY=NAME prints where"),
            (["report", "--liberty", "sg13g2"], "IHP-Open-PDK"),
            (["report", "--liberty", "/dev/null"], "not a Liberty file"),
            (["report", "--liberty", run + ".gz"], "cannot be read"),
            (["report", "--memories", self.folder, "--config", "1w1c"], "no Liberty file (*.lib, *.lib.gz) of a"),
            (["report", "--config", "5w5c"], "5"),
            (["report", "--memories", "clay", "--config", "1w1c"], "clay"),
            (["report", "--config", "1w1c", "--against", "/dev/null"], "/dev/null"),
            (["report", "--config", "1w1c", "--run", "/dev/null"], "RUN=/dev/null"),
            (["report", "--config", "1w1c", "--run", run], "4w4c"),
            (["report", "--config", "1w1c", "--clock", "soon"], "CLOCK=soon"),
            (["report", "--config", "1w1c", "--chip", "--units", "3"], "CUS=3: a chip has 1, 2 or 4 compute units"),
            (["report", "--config", "1w1c", "--rounds", "9"], "ROUNDS=9: 0 to 8"),
            (["report", "--config", "4w4c", "--chip", "--run", run], "drawn with traverser static, which has no known"),
            (["report", "--config", "4w4c", "--chip", "--units", "4", "--run", run], "of 1 units, but this one has 4"),
            (["prove", "--config", "1w1c", "--only", "teapot"], "has no block teapot"),
            (["growth", "--plan", run], "not a plan"),
            (["fit", run], "not what raypool fit --json writes"),
            (["fit", "/no/such.json"], "not what raypool fit --json writes"),
            (["module", "teapot"], "teapot: no such module in rtl/"),
            (["module", "rp_box_pip"], "box_pip: no such module in rtl/: did you mean box_pipe?"),
            (["module", ""], "name a module of rtl/: MODULE="),
            (["module", "free_list", "SIZE"], "written BITS=8 or A=1,B=2"),
            (["module", "rp_free_list", "SPOUT=1"], "free_list has no parameter SPOUT"),
        ):
            code, text = self.command(*arguments)
            self.assertEqual(code, 1, text)
            self.assertIn(word, text)
            self.assertNotIn("Traceback", text)
            said = [line for line in text.splitlines() if not line.startswith("synth: phase ")]
            self.assertEqual(len(said), 1, text)

    def mapped_chip(self, units, real):
        """A chip of which the blocks of these names are mapped; in the others are their blocks and a clock alone."""
        design = flow.open_design(flow.Options(config="1w1c", out=self.folder, units=units))
        flow.prepare(design)
        mapper = mapping.Mapper(design.library, self.folder, design.clock_ns, 2)
        paths = mapper.map_all([kind for kind in design.kinds.values() if kind.base in real])
        for identity, kind in design.kinds.items():
            if kind.memory or identity in paths:
                continue
            bits, ports = 2, {}
            for name, (direction, width) in kind.ports.items():
                ports[name] = {"direction": direction, "bits": list(range(bits, bits + width))}
                bits += width
            cells = {}
            for name, child in kind.children.items():
                clock = {p: ports[p]["bits"] for p in ("clk_i",) if p in design.kinds[child].ports and p in ports}
                cells[name] = {"type": child, "connections": clock}
            text = json.dumps({"ports": ports, "cells": cells, "netnames": {}})
            paths[identity] = self.written(f"{len(paths)}.json", text)
        design.netlist = netlist.Netlist(design.kinds, paths, design.library, design.top)
        design.netlist.write(design.verilog)
        design.memory.liberty(design.blocks(), design.fo4_ns, os.path.join(self.folder, "memories.lib"))
        flow.time_design(design, self.folder)
        return design

    def test_a_chip_is_reported_by_block_and_its_units_are_mapped_once(self):
        design = self.mapped_chip(2, {"frame_port", "launcher"})
        self.assertEqual(flow.label(design.options, design.library), "1w1c-chip-2cu")
        self.assertEqual(len([k for k in design.kinds.values() if k.base == "compute_unit"]), 1)
        path = timing.describe([design.endpoints[0].pin], design.verilog, design.library, design.macros,
                               design.clock_ns, self.folder, design.top)[0]  # fmt: skip
        made = report.make(design, "key", path)
        report.check(made)
        rows = {row["block"]: row for row in made["blocks"]}
        self.assertEqual(next(iter(rows)), "chip")
        first = {"multiprocessor", "controller", "ray_pool", "intersection_pool", "memory_port", "frame_port",
                 "traverser"}  # fmt: skip
        self.assertEqual({name for name in rows if "/" not in name}, {"chip"} | first)
        self.assertEqual(made["area"]["logic_um2"], rows["chip"]["logic_um2"])
        self.assertEqual(rows["chip"]["memory_bits"], sum(rows[name]["memory_bits"] for name in first))
        self.assertEqual(rows["ray_pool/ram_1r1w"]["memory_bits"], 512 * 3 * 128)
        unit, launches = "multiprocessor/compute_unit", "multiprocessor/compute_unit/launcher"
        alone = design.netlist.own_flops(next(i for i, k in design.kinds.items() if k.base == "launcher"))
        self.assertEqual((rows[unit]["instances"], rows[launches]["instances"]), (2, 2))
        self.assertEqual((rows[unit]["flip_flops"], rows[launches]["flip_flops"]), (2 * alone, 2 * alone))
        self.assertIn(made["timing"]["to_block"], ("frame_port", launches))
        self.assertGreater(rows["frame_port"]["flip_flops"], 0)
        # The thesis' area is that of a unit; of the chip every block is reported, however small.
        printed = report.table(made)
        self.assertNotIn("thesis", printed)
        self.assertRegex(printed, r"\nmissed   the clock: no block\n")
        self.assertTrue(printed.startswith("1w1c-chip-2cu "))
        told = {line.split()[0] for line in printed.splitlines()[2:] if line.strip()}
        self.assertLessEqual(first | {"chip"}, told)
        # A unit with its instances counted once would be detected.
        rows["multiprocessor"]["memory_um2"] /= 2
        with self.assertRaisesRegex(SynthError, "add up"):
            report.check(made)

    def test_power_of_a_chip_is_reported_by_place_and_adds_up(self):
        design = self.mapped_chip(2, {"frame_port", "launcher", "event_counter"})
        os.makedirs(os.path.join(self.folder, "power"))
        toggles, accesses = {}, {}
        for path, identity in design.netlist.instances():
            if identity in design.netlist.modules:
                gates = len(design.netlist.modules[identity].gates)
                toggles["/".join(path)] = (300 * gates, gates)
            else:
                accesses["/".join(path)] = 1000
        launchers = [path for path in toggles if path.endswith("/launcher")]
        self.assertEqual(len(launchers), 2)
        toggles[launchers[1]] = (600 * toggles[launchers[1]][1], toggles[launchers[1]][1])
        with mock.patch.object(power, "measure", lambda *_: (toggles, accesses, 1000)):
            found = power.estimate(design)
        places = {place["block"]: place for place in found["places"]}
        unit, launcher = "multiprocessor/compute_unit", "multiprocessor/compute_unit/launcher"
        self.assertEqual([places[name]["instances"] for name in ("chip", unit, launcher)], [1, 2, 2])
        self.assertAlmostEqual(places["frame_port"]["activity"], 0.3)
        self.assertAlmostEqual(places[launcher]["activity"], 0.45)
        rows = {row["block"]: row for row in found["blocks"]}
        self.assertAlmostEqual(rows[launchers[1]]["switching_w"], 2 * rows[launchers[0]]["switching_w"], 7)
        # The cells of a block and of all below it, as OpenSTA's own report of them all has them.
        below = [path for path, (_, gates) in toggles.items() if gates and path.split("/")[0] == "frame_port"]
        self.assertEqual(len(below), 2)
        cells = " ".join(path + "/*" for path in below)
        text = timing.run_sta(
            timing.set_up(design.verilog, design.library, design.macros, design.clock_ns, design.top)
            + "set_power_activity -global -activity 0.3\nset_power_activity -input -activity 0.3\n"
            + f"report_power -instances [get_cells {{{cells}}}] -digits 9\n",
            self.folder, "listed",
        )  # fmt: skip
        listed = re.findall(r"^ *(\S+) +(\S+) +(\S+) +\S+ frame_port/", text, re.M)
        self.assertGreater(len(listed), 500)
        for what, column, share in (("internal_w", 0, 0.5), ("switching_w", 1, 1), ("leakage_w", 2, 1)):
            expected = share * sum(float(cell[column]) for cell in listed)
            self.assertAlmostEqual(places["frame_port"][what] / expected, 1, 4)
        # Every access of a memory counts, at its own place and above.
        self.assertGreater(places["ray_pool"]["memory_w"], 0)
        first = [place for name, place in places.items() if name != "chip" and "/" not in name]
        for what in ("internal_w", "switching_w", "leakage_w", "memory_w", "total_w"):
            self.assertAlmostEqual(sum(place[what] for place in first), places["chip"][what])
            self.assertAlmostEqual(sum(row[what] for row in found["blocks"]), places["chip"][what])
        told = "\n".join(report.power_lines(found, True))
        self.assertRegex(told, r"\n +multiprocessor/compute_unit/launcher +2 ")


if __name__ == "__main__":
    unittest.main(verbosity=2)
