#!/usr/bin/env python3
"""raypool.core describes rtl/ as it is: scripts/tests/core_test.py RAYPOOL-TABLES

It is what scripts/core.py writes; every file of rtl/ is in it once; its parameters are those of
rtl/compute/rp_multiprocessor.v
with their defaults; and Verilator, given its files, options and a value for each parameter, has nothing to complain
about.
"""
import pathlib
import re
import subprocess
import sys
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def declared(path):
    """Parameters of a module and their defaults, also of what its parameter list includes."""
    for line in path.read_text().splitlines():
        if line.startswith(") ("):
            return
        if include := re.match(r'`include "(.*)"', line):
            yield from declared(ROOT / "rtl/include" / include[1])
        if parameter := re.match(r"\s*parameter integer ([A-Z_]+) = (\d+),?$", line):
            yield parameter[1], int(parameter[2])


class Core(unittest.TestCase):
    def setUp(self):
        text = (ROOT / "raypool.core").read_text()
        self.assertEqual(text.splitlines()[0], "CAPI=2:")
        self.core = yaml.safe_load(text)
        self.files = []
        for fileset in self.core["filesets"].values():
            for entry in fileset["files"]:
                self.files.append((next(iter(entry)), True) if isinstance(entry, dict) else (entry, False))

    def test_is_what_the_script_writes(self):
        subprocess.run([ROOT / "scripts" / "core.py", TABLES, "--check"], check=True)

    def test_lists_every_file_once(self):
        rtl = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "rtl").rglob("*") if path.is_file())
        self.assertEqual(sorted(name for name, _ in self.files), rtl)
        self.assertEqual(
            [name for name, include in self.files if include], [name for name in rtl if name.endswith(".vh")]
        )

    def test_has_the_parameters_of_the_top(self):
        target = self.core["targets"]["default"]
        top = dict(declared(next((ROOT / "rtl").glob(f"*/{target['toplevel']}.v"))))
        given = {name: row["default"] for name, row in self.core["parameters"].items()}
        self.assertEqual(given, top)
        self.assertEqual(target["parameters"], list(top))

    def test_verilator_lints_it(self):
        target = self.core["targets"]["lint"]
        tool = target["tools"]["verilator"]
        self.assertEqual(tool["mode"], "lint-only")
        parameters = [f"-G{name}={row['default']}" for name, row in self.core["parameters"].items()]
        waivers = [name for name, _ in self.files if name.endswith(".vlt")]
        verilog = [name for name, include in self.files if not include and name not in waivers]
        command = ["verilator", "--lint-only", *tool["verilator_options"], "--top-module", target["toplevel"],
                   "-Irtl/include"]  # fmt: skip
        done = subprocess.run(
            command + parameters + waivers + verilog, cwd=ROOT, capture_output=True, text=True, check=False
        )
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))


if __name__ == "__main__":
    TABLES = sys.argv[1]
    unittest.main(argv=sys.argv[:1])
