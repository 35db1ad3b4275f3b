#!/usr/bin/python3
"""The tables of docs/studies/experiments.md show what the sweep's table has, and report what is not there."""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "studies"))
import experiments  # noqa: E402


def row(config, units, depth, policy, remedy, timed=True):
    """Cycles and rays that make simple figures, if they are timed; all cycles of warps issue or import."""
    warps, cores = (int(part) for part in config[:-1].split("w"))
    rate = 10.0 * units * cores * (2 if policy == "fill" else 1) * (1 if remedy else 0.5)
    found = {
        "config": config, "units": units, "depth": depth, "chip.policy": policy, "chip.window_remedy": remedy,
        "machine": config, "mrays_per_second": rate, "mrays_per_second_thesis": rate, "cycles": 1000,
        "instructions": 400, "time_utilisation": 0.9, "resource_utilisation": 0.8,
        "pools.intersection_port_utilisation": 0.25, "warp_cycles.all": 1000 * warps, "warp_cycles.issued": 400 * warps,
        "warp_cycles.import": 600 * warps, "ceilings.issue": 77.0, "ceilings.alus.flt": 66.0, "ceilings.lowest": "flt",
        "ceilings.reached": 0.5,
    }  # fmt: skip
    for alu in experiments.ALUS:
        found.update({f"alus.{alu}.utilisation": 0.1, f"alus.{alu}.issued": 100, f"warp_cycles.waiting.{alu}": 0,
                      f"warp_cycles.executing.{alu}": 0})
    for kernel in experiments.PUBLISHED_KERNELS:
        found.update({f"kernels.{kernel}.{what}": value for what, value in
                      (("launches", 10), ("threads", 150), ("cycles", 4000))})
    if not timed:
        found.update({name: None for name, value in found.items() if isinstance(value, (int, float)) and "." not in name
                      and name not in ("units", "depth")})
    return found


class Experiments(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        with open(ROOT / "configs/experiments/published.json", encoding="utf-8") as file:
            self.product = json.load(file)["product"]
        self.rows = [row(*values) for values in itertools.product(*self.product.values())]
        self.rows.append(row("8w8c", 1, 1, "thesis", True, timed=False))  # a picture of Embree's hits

    def call(self, *words, code=0):
        table = self.folder / "table.json"
        table.write_text(json.dumps({"rows": self.rows}))
        command = [sys.executable, ROOT / "studies/experiments.py", words[0], table, *words[1:]]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return [line.split() for line in done.stdout.splitlines()] if code == 0 else done.stderr

    def test_every_published_machine_is_swept(self):
        machines = [f"{warps}w{cores}c" for warps, cores in experiments.published()]
        self.assertEqual(len(machines), 16)
        self.assertEqual(machines, self.product["config"])

    def test_tables_say_what_the_sweep_does(self):
        self.assertEqual(self.call("published")[3], ["4w4c", "18.69", "40.00", "2.14", "80.00", "4.28"])
        self.assertEqual(self.call("use")[3], ["4w4c", "100/90", "99/80", "23/10", "16/10", "20/10", "15/10"])
        self.assertEqual(self.call("issue")[3], ["4w4c", "0.40", "0.20", "0.40", "77.00", "18.69"])
        self.assertEqual(self.call("kernels")[1], ["cast_eye", "636", "400", "10", "15.0"])
        self.assertEqual(self.call("window")[3], ["4w4c", "20.00", "40.00", "+100%"])
        self.assertEqual(self.call("units")[3], ["4w8c", "80.00", "160.00", "320.00", "160.00", "320.00", "640.00",
                                                 "25.0"])
        cycles = self.call("cycles")[3]
        self.assertEqual(cycles[:2] + cycles[6:7] + cycles[-3:], ["4w4c", "40.0", "60.0", "flt", "66.0", "50.0"])

    def test_what_is_not_right_gets_a_sentence(self):
        self.assertIn("chip.thresholds.intersections=16", self.call("thresholds", code=1))
        self.rows[0]["warp_cycles.import"] += 1
        self.assertIn("not the whole", self.call("cycles", code=1))
        self.rows = []
        self.assertIn("1w16c", self.call("published", code=1))
        self.rows = [{"size": "8x8"}]
        self.assertIn("not the table", self.call("published", code=1))

    def test_plots_are_drawn(self):
        for plot in experiments.PLOTS:
            picture = self.folder / f"{plot}.png"
            self.call(plot, picture)
            self.assertGreater(picture.stat().st_size, 5000)


if __name__ == "__main__":
    unittest.main()
