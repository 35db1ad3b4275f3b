#!/usr/bin/env python3
"""The table of areas: what is fitted to blocks, and that the program adds it up as the fit does."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
RAYPOOL = os.environ["RAYPOOL"] = os.path.abspath(sys.argv.pop(1))

from synth import areas  # noqa: E402
from synth.errors import SynthError  # noqa: E402

FIELDS = {"warps": 4, "lanes": 8, "triples": 1, "chip.shading=kernel": 1}


class Terms(unittest.TestCase):
    def test_are_products_and_roots(self):
        for term, value in (("1", 1), ("warps", 4), ("warps * lanes", 32), ("sqrt(warps * warps)", 4),
                            ("chip.shading=kernel * lanes", 8), ("chip.shading=traverser * lanes", 0)):  # fmt: skip
            self.assertEqual(areas.value_of(term, FIELDS), value, term)

    def test_of_no_field_are_refused(self):
        with self.assertRaisesRegex(SynthError, "wraps: no such field"):
            areas.value_of("wraps", FIELDS)


class Blocks(unittest.TestCase):
    FOUND = {"chip": (10, 20), "units": (6, 8), "units/unit": (5, 7), "pool": (1, 3)}

    def test_lose_what_is_named_below_them(self):
        own = areas.own(self.FOUND, ["chip", "units", "units/unit", "pool", "not there"])
        self.assertEqual(own, {"chip": (3, 9), "units": (1, 1), "units/unit": (5, 7), "pool": (1, 3)})
        self.assertEqual([sum(part[i] for part in own.values()) for i in (0, 1)], [10, 20])

    def test_without_names_stay_in_what_is_around_them(self):
        self.assertEqual(areas.own(self.FOUND, ["chip", "units"]), {"chip": (4, 12), "units": (6, 8)})


class Fit(unittest.TestCase):
    ROWS = [[1, 4], [1, 8], [1, 16]]

    def test_finds_the_terms(self):
        found = areas.fit(["1", "lanes"], self.ROWS, [0.5 + 0.25 * row[1] for row in self.ROWS])
        self.assertAlmostEqual(found[0], 0.5)
        self.assertAlmostEqual(found[1], 0.25)

    def test_refuses_terms_that_the_designs_do_not_tell_apart(self):
        with self.assertRaisesRegex(SynthError, "do not tell 1, lanes apart"):
            areas.fit(["1", "lanes"], [[1, 4], [1, 4]], [1, 1])


class Table(unittest.TestCase):
    def setUp(self):
        with open(areas.TABLE, encoding="utf-8") as file:
            self.table = json.load(file)

    def test_has_the_blocks_and_terms_of_the_plan(self):
        with open(areas.PLAN, encoding="utf-8") as file:
            plan = json.load(file)
        for block in self.table["blocks"]:
            terms = plan["blocks"][block["scope"]].pop(block["block"])
            self.assertLessEqual(set(block["mm2"]), set(terms), block["block"])
        self.assertFalse(any(plan["blocks"].values()), "blocks of the plan that the table lacks: make areas")

    def test_is_added_up_by_the_program_as_by_the_fit(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "explore.json")
            command = [RAYPOOL, "explore", "cornell", "--size", "8x8", "--depth", "1", "--machines", "12", "--quiet"]
            subprocess.run([*command, "--out", path], stdout=subprocess.DEVNULL, check=True)
            with open(path, encoding="utf-8") as file:
                machines = json.load(file)["machines"]
        self.assertGreater(len(machines), 5)
        for machine in machines:
            fields = areas.fields_of("best_8w8c", [machine["changes"]] if machine["changes"] else [])
            self.assertAlmostEqual(areas.area_of(self.table, fields, machine["units"]), machine["mm2"], places=9)


if __name__ == "__main__":
    unittest.main()
