#!/usr/bin/python3
"""make pareto: studies/tests/pareto_test.py RAYPOOL. Pictures of a tiny frame; areas are those that the tests name.

The front is what nothing beats; table, pareto.json and pareto.svg agree; no two names of the plot lie on each other;
the pictures are those of the arithmetic that a name means; what cannot be used gets a sentence.
"""
import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "studies"))
import pareto  # noqa: E402

RAYPOOL = ""
# Some pixels of it differ from those in double precision.
FRAME = ("--scene", "room", "--detail", "0.05", "--size", "48x48", "--depth", "3", "--config", "2w2c")


def schema():
    return jsonschema.Draft7Validator(json.loads((ROOT / "schemas/pareto.json").read_text()))


class Fronts(unittest.TestCase):
    def test_the_front_is_what_nothing_beats(self):
        points = [(10, 0.05), (10, 0.06), (9, 0.06), (12, 0.05), (12, 0.01), (20, 0), (21, 0), (9, 0.07), (20, 0)]
        best = [(10, 0.05), (9, 0.06), (12, 0.01), (20, 0), (20, 0)]
        self.assertEqual(pareto.front(points), best)
        for point in points:
            beaten = any(other != point and other[0] <= point[0] and other[1] <= point[1] for other in points)
            self.assertEqual(point not in best, beaten)

    def test_names_mean_an_arithmetic(self):
        machine = pareto.machine_of("16-flush-newton1-fma-fit")
        self.assertTrue(machine.fitted)
        self.assertEqual(set(machine.fields), {"arithmetic.significand=16", "arithmetic.subnormals=flush",
                                               "arithmetic.slow_unit=newton1", "arithmetic.fma=true"})  # fmt: skip
        self.assertEqual(set(pareto.full().fields), {"arithmetic.significand=24", "arithmetic.subnormals=ieee",
                                                     "arithmetic.slow_unit=exact", "arithmetic.fma=false"})  # fmt: skip
        self.assertGreaterEqual(len(pareto.chosen_machines(None)), 18)


class Results(unittest.TestCase):
    """Of machines with known areas and pictures."""

    def found(self, *machines):
        """(name, logic kGE, share of pixels that are off)"""
        rows = []
        for name, area, off in machines:
            row = pareto.Row(pareto.machine_of(name))
            row.report = {"raypool": "0.1.0", "scene": {"name": "s'c`ene", "triangles": 1, "materials": 1}, "depth": 1,
                          "size": {"width": 8, "height": 8}, "units": 1, "configuration": {"warps": 4}}  # fmt: skip
            row.picture = {"pixels": 64, "differ": 9 if off else 0, "off_by_more": off, "largest_difference": 7,
                           "psnr": 50.0 if off else None, "mean_difference": 0}  # fmt: skip
            row.criterion = {"off_by": 2, "most_off": 0.01}
            row.area = {"logic_kge": area, "memory_kge": 10.0, "memory_bits": 1000, "flip_flops": 5, "mm2": 1}
            rows.append(row)
        arguments = pareto.parser().parse_args(FRAME)
        return pareto.summary(rows, arguments)

    def printed(self, found):
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            pareto.print_table(found)
        return text.getvalue()

    def test_table_and_json(self):
        found = self.found(("24", 300.0, 0), ("20-flush", 250.0, 0.001), ("18", 255.0, 0.01), ("16", 240.0, 0.0101),
                           ("24-fit", 200.0, 0.002))  # fmt: skip
        self.assertEqual([error.message for error in schema().iter_errors(found)], [])
        best = [row["machine"] for row in found["machines"] if row["pareto"]]
        self.assertEqual(best, ["24", "20-flush", "16", "24-fit"], "fits compete with fits")
        self.assertEqual((found["smallest"], found["smallest_fitted"]), ("20-flush", "24-fit"))
        found = self.found(("24", 300.0, 0), ("20-flush", 250.0, 0.001), ("18", 255.0, 0.01), ("16", 240.0, 0.0101))
        self.assertEqual([row["machine"] for row in found["machines"] if row["pareto"]], ["24", "20-flush", "16"])
        self.assertEqual([row["machine"] for row in found["machines"] if not row["passes"]], ["16"], "1% may be off")
        text = self.printed(found)
        self.assertRegex(text, r", against double precision\n")
        self.assertRegex(text, r"\n24 +300\.0 +0\.0% +1000 +0\.000% +0 +7 +equal +\*\n"
                               r"18 +255\.0 +15\.0% +1000 +1\.000% +9 +7 +50\.0\n20-flush +250\.0 ")  # fmt: skip
        self.assertTrue(text.endswith("smallest with at most 1% of the pixels off by 2 or more: 20-flush, 250.0 kGE\n"))

    def test_it_may_be_that_no_machine_passes(self):
        found = self.found(("24", 300.0, 0.02), ("16", 240.0, 0.03))
        self.assertEqual([error.message for error in schema().iter_errors(found)], [])
        self.assertEqual((found["smallest"], found["smallest_fitted"]), (None, None))
        self.assertTrue(self.printed(found).endswith("off by 2 or more: none\n"))

    def test_no_two_names_of_the_plot_lie_on_each_other(self):
        names = [name for name in pareto.MACHINES if not name.endswith("fit")] + ["24-fit"]
        spread = [(name, 300 - 3.1 * number, 0 if number % 5 == 0 else 1e-4 * 1.6**number)
                  for number, name in enumerate(names)]  # fmt: skip
        crowd = [(name, 300 - 0.1 * number, 0.001) for number, name in enumerate(names[:12])]
        for machines in (spread, crowd, [("24", 300.0, 0)], [("24", 300.0, 1)]):
            found = self.found(*machines)
            with tempfile.TemporaryDirectory() as folder:
                pareto.plot(found, pathlib.Path(folder, "plot.svg"))
                root = xml.etree.ElementTree.parse(pathlib.Path(folder, "plot.svg")).getroot()
            boxes = self.names_in(root, [name for name, _, _ in machines])
            self.assertEqual(len(boxes), len(machines))
            for name, box in boxes.items():
                for other, second in boxes.items():
                    self.assertFalse(name < other and pareto.boxes_overlap(box, second), f"{name} and {other}")

    def names_in(self, root, names):
        """{name: (left, bottom, right, top)}, from where the middle of each text is."""
        boxes = {}
        for text in root.iter("{http://www.w3.org/2000/svg}text"):
            name = "".join(text.itertext()).strip()
            if name in names and "middle" in text.get("style"):
                x, y = float(text.get("x")), float(text.get("y"))
                half = 6.2 * len(name) / 2
                boxes[name] = (x - half, y - 12, x + half, y)
        return boxes


class Runs(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"

    def run_it(self, *words, code=0, **environment):
        done = subprocess.run([sys.executable, ROOT / "studies/pareto.py", *FRAME, "--out", self.out, *words], cwd=ROOT,
                              capture_output=True, text=True, check=False, timeout=240,
                              env={**os.environ, "RAYPOOL": RAYPOOL, **environment})  # fmt: skip
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def test_pictures_are_those_of_the_arithmetic(self):
        done = self.run_it("--no-area", "--machines", "24-flush 11 24-fit")
        found = json.loads((self.out / "pareto.json").read_text())
        self.assertEqual([error.message for error in schema().iter_errors(found)], [])
        rows = {row["machine"]: row for row in found["machines"]}
        self.assertEqual(list(rows), ["24", "24-flush", "11", "24-fit"])
        self.assertEqual(found["reference"], "double precision")
        self.assertEqual(found["criterion"], {"off_by": 2, "most_off": 0.01})
        self.assertGreater(rows["24"]["picture"]["differ"], 0, "single precision has an error of its own")
        self.assertEqual(rows["24-fit"]["picture"], rows["24"]["picture"])
        self.assertGreater(rows["11"]["picture"]["differ"], 10 * rows["24"]["picture"]["differ"])
        self.assertEqual(rows["11"]["configuration"]["arithmetic"]["significand"], 11)
        self.assertEqual(rows["24-flush"]["configuration"]["arithmetic"]["subnormals"], "flush")
        self.assertLess(rows["24-fit"]["configuration"]["intersection_words"], 21)
        self.assertRegex(done.stdout, r"\n24 +\d\.\d{3}% +[1-9]\d* +\d+ +\d+\.\d\n")
        self.assertEqual(sorted(os.listdir(self.out)), ["machines", "pareto.json"])
        # The picture is that of raypool sim, and so is what is reported of it.
        subprocess.run([RAYPOOL, "sim", *FRAME, "--set", "arithmetic.significand=11", "--engine", "native", "--quiet",
                        "--out", self.folder / "sim"], check=True, stdout=subprocess.DEVNULL)  # fmt: skip
        picture = (self.out / "machines/11.png").read_bytes()
        self.assertEqual(picture, (self.folder / "sim/image.png").read_bytes())
        self.assertNotEqual(picture, (self.out / "machines/24.png").read_bytes())
        self.assertEqual((self.out / "machines/24-fit.png").read_bytes(), (self.out / "machines/24.png").read_bytes())

    def test_pictures_of_shaders_stand_beside_the_full_machines(self):
        self.run_it("--no-area", "--machines", "24-flush 11", "--shaders", "preview", "--samples", "2")
        found = json.loads((self.out / "pareto.json").read_text())
        self.assertEqual([error.message for error in schema().iter_errors(found)], [])
        self.assertEqual(found["reference"], "full single precision")
        self.assertEqual(found["shaders"], {"folder": "preview", "samples": 2})
        rows = {row["machine"]: row["picture"] for row in found["machines"]}
        self.assertEqual(rows["24"]["differ"], 0)
        self.assertGreater(rows["11"]["differ"], 0)

    def refuses(self, sentence, *words, **environment):
        """One line after what is progress, nothing is left."""
        done = self.run_it(*words, code=1, **environment)
        self.assertRegex([line for line in done.stderr.splitlines() if "drawing" not in line][0], sentence)
        self.assertEqual(done.stdout, "")
        self.assertFalse(self.out.exists())

    def test_what_cannot_be_used_gets_a_sentence(self):
        self.refuses("'25' is not a machine: it begins with the bits of a significand, 11 to 24", "--machines", "24 25")
        self.refuses("'20-fluse' is not a machine: 'fluse' is none of fma", "--machines", "20-fluse")
        self.refuses("'20-newton1-newton0' is not a machine: 'newton0' is none of", "--machines", "20-newton1-newton0")
        self.refuses("no machine is named", "--machines", ",")
        self.refuses("is fitted to one frame", "--machines", "24-fit", "--shaders", "ao", "--samples", "2")
        self.refuses("'0' must be from 1 to 999", "--jobs", "0")
        self.refuses("nosuchscene", "--scene", "nosuchscene")
        (self.folder / "matplotlib.py").write_text("raise ImportError")
        self.refuses("^Matplotlib.*was not found: scripts/setup.sh", PYTHONPATH=str(self.folder))
        self.refuses("none was not found: make pareto builds it", RAYPOOL=str(self.folder / "none"))

    def test_earlier_results_stay_when_a_run_fails(self):
        self.run_it("--no-area", "--machines", "24")
        before = {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()}
        self.run_it("--no-area", "--depth", "0", code=1)
        self.assertEqual({path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()}, before)


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
