#!/usr/bin/python3
"""The tables of docs/studies/best.md: they show what the sweep's table has, and what is not there is reported."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def row(config, depth, cycles, triples, first, second, **others):
    return {"config": config, "depth": depth, "triples": triples, "chip.ray_pool.pipelined": first,
            "chip.intersection_pool.pipelined": second, "cycles": cycles, "mrays_per_second": 1e5 / cycles, **others}


def table(rows):
    return {"swept": ["config", "triples", "chip.ray_pool.pipelined", "chip.intersection_pool.pipelined", "depth"],
            "base": {"config": "8w8c"}, "rows": rows}


ROWS = [
    row("8w8c", 1, 1000, False, False, False), row("8w8c", 5, 4000, False, False, False),
    row("8w8c", 1, 800, True, False, False), row("8w8c", 5, 3000, True, False, False),
    row("best_8w8c", 1, 500, True, True, True), row("best_8w8c", 5, 1000, True, True, True),
    row("best_8w8c", 1, 600, True, False, False), row("best_8w8c", 5, 1500, True, False, False),
]  # fmt: skip


class Features(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def call(self, word, rows, *words, code=0):
        path = self.folder / "table.json"
        path.write_text(json.dumps(table(rows)))
        done = subprocess.run([sys.executable, ROOT / "studies/features.py", word, path, *words], check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return [line.split() for line in done.stdout.splitlines()] if code == 0 else done.stderr

    def test_cycles_are_compared_with_the_plain_machine_of_the_same_configuration(self):
        lines = self.call("alone", ROWS)[1:]
        self.assertEqual(lines[0], ["8w8c", "1000", "100.0", "4000", "25.0"])
        self.assertEqual(lines[1], ["triples=true", "800", "-20.0", "125.0", "3000", "-25.0", "33.3"])
        self.assertEqual(lines[2], ["best_8w8c", "500", "200.0", "1000", "100.0"])
        # What two parts have alike is one name.
        self.assertEqual(lines[3], ["pipelined=false", "600", "+20.0", "166.7", "1500", "+50.0", "66.7"])

    def test_the_way_names_what_is_new_in_each_step(self):
        rows = [{**ROWS[0]}, {**ROWS[2]}, row("8w8c", 1, 500, True, True, True)]
        for each in rows:
            del each["config"]   # not swept: the base has it
        self.assertEqual(self.call("way", rows)[1:],
                         [["8w8c", "100.0"], ["+", "triples=true", "125.0"], ["+", "pipelined=true", "200.0"]])
        self.call("way", rows, self.folder / "way.png")
        self.assertGreater((self.folder / "way.png").stat().st_size, 5000)

    def test_areas_are_compared_and_divide_the_speed(self):
        sizes = (0.5, 0.4)
        rows = [{**each, "kge": 300.0, "area_mm2": size} for each, size in zip((ROWS[4], ROWS[6]), sizes)]
        lines = self.call("area", rows)[1:]
        self.assertEqual(lines[0], ["best_8w8c", "300.0", "0.500", "-", "200.0", "400"])
        self.assertEqual(lines[1], ["pipelined=false", "300.0", "0.400", "-20.0", "-", "166.7", "417"])
        rows[1]["power_mw"] = 123.4
        self.assertEqual(self.call("area", rows)[2][4], "123")

    def test_what_is_no_such_table_is_told_in_a_sentence(self):
        self.assertIn("has no areas", self.call("area", ROWS[:1], code=1))
        self.assertIn("not the table of a whole sweep", self.call("alone", ROWS[:3], code=1))
        self.assertIn("give alone TABLE.json", self.call("nothing", ROWS, code=1))

    def test_the_way_ends_at_best(self):
        """The last point of way.json has what configs/best.json has, but for the traverser that is not used there."""
        with open(ROOT / "configs/experiments/way.json", encoding="utf-8") as file:
            last = json.load(file)["points"][-1]
        with open(ROOT / "configs/best.json", encoding="utf-8") as file:
            best = json.load(file)
        best.pop("name")
        self.assertEqual(last, {field: value for field, value in flat(best).items()
                                if not field.startswith("chip.hardware_traverser.")})


def flat(json_object, prefix=""):
    found = {}
    for key, value in json_object.items():
        found.update(flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value})
    return found


if __name__ == "__main__":
    unittest.main()
