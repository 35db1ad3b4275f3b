#!/usr/bin/env python3
"""The JSON Schemas of what studies write: studies/tests/study_schemas_test.py RAYPOOL [ENGINE...]

What studies/fidelity.py leaves of each ENGINE (default: those without a Verilated unit) and studies/pareto.py of a
small frame, and what raypool fit --json writes, are valid; a field that is missing, unknown or of another kind is not,
and each is named in its page of docs/.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "studies"), str(ROOT / "scripts/tests")]
import fidelity  # noqa: E402  the path comes first
import schemas_test  # noqa: E402


class Fidelity(schemas_test.Written):
    """Of a small frame at the levels that are among the engines."""

    def test_fidelity(self):
        valid = schemas_test.validator("fidelity.json")
        levels = [level.name for level in fidelity.LEVELS if level.name in schemas_test.ENGINES]
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, ROOT / "studies/fidelity.py", "--scene", "cornell", "--size", "8x8",
                       "--config", "4w4c", "--levels", ",".join(levels), "--out", folder]  # fmt: skip
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False,
                                  env={**os.environ, "RAYPOOL": schemas_test.RAYPOOL})
            self.assertEqual(done.returncode, 0, done.stderr)
            document = schemas_test.read(folder + "/fidelity.json")
        self.assertEqual([error.message for error in valid.iter_errors(document)], [])
        self.assertEqual([row["level"] for row in document["levels"]], levels)
        self.refuses(valid, document, lambda path: path[-2:-1] not in (("alus",), ("ports",)),
                     [("x",), ("scene", "x"), ("levels", 0, "x"), ("levels", 0, "picture", "x")])

    def test_docs_name_each_field(self):
        self.names_each_field("use/speed-and-accuracy.md", "fidelity.json")


class Pareto(schemas_test.Written):
    """Pictures of a small frame; what has areas is in the test `pareto`."""

    def test_pareto(self):
        valid = schemas_test.validator("pareto.json")
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, ROOT / "studies/pareto.py", "--scene", "cornell", "--size", "8x8",
                       "--config", "2w2c", "--machines", "11", "--no-area", "--out", folder]  # fmt: skip
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False,
                                  env={**os.environ, "RAYPOOL": schemas_test.RAYPOOL})
            self.assertEqual(done.returncode, 0, done.stderr)
            document = schemas_test.read(folder + "/pareto.json")
        for row, area in zip(document["machines"], (1.5, 1.25)):
            row["area"] = {"logic_kge": area, "memory_kge": area, "memory_bits": 3, "flip_flops": 4}
            self.assertTrue(schemas_test.validator("configuration.json").is_valid(row.pop("configuration")))
            row["configuration"] = {}
        self.assertEqual([error.message for error in valid.iter_errors(document)], [])
        self.refuses(valid, document, lambda path: True,
                     [("x",), ("scene", "x"), ("criterion", "x"), ("machines", 0, "x"), ("machines", 0, "picture", "x"),
                      ("machines", 0, "area", "x")])  # fmt: skip

    def test_docs_name_each_field(self):
        self.names_each_field("use/speed-and-accuracy.md", "pareto.json")


class Fit(schemas_test.Written):
    """Of a small frame."""

    def test_fit(self):
        valid = schemas_test.validator("fit.json")
        with tempfile.TemporaryDirectory() as folder:
            done = schemas_test.raypool("fit", "cornell", "--size", "8x8", "--config", "4w4c",
                                        "--out", folder + "/fitted.json", "--json", folder + "/found.json")  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stderr)
            document = schemas_test.read(folder + "/found.json")
            fitted = schemas_test.read(folder + "/fitted.json")
        self.assertEqual([error.message for error in valid.iter_errors(document)], [])
        self.assertTrue(document["changes"])
        self.assertTrue(schemas_test.validator("configuration.json").is_valid(fitted))
        self.refuses(valid, document, lambda path: path[0] not in ("base", "fitted"),
                     [("x",), ("scene", "x"), ("cycles", "x"), ("changes", 0, "x"), ("fitted", "x")])

    def test_docs_name_each_field(self):
        self.names_each_field("use/fit.md", "fit.json")


if __name__ == "__main__":
    schemas_test.RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    schemas_test.ENGINES = sys.argv[2:] or schemas_test.ENGINES
    unittest.main(argv=sys.argv[:1])
