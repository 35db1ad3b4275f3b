#!/usr/bin/python3
"""make fidelity on a tiny frame: studies/tests/fidelity_test.py RAYPOOL. Needs the Verilated unit of 4w4c beside it.

Table, fidelity.json and fidelity.svg show what the reports have; a model that is not exactly the hardware is detected;
input that cannot be used gets a sentence; and earlier results stay whole whatever happens.
"""
import contextlib
import io
import json
import os
import pathlib
import re
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "studies"))
import fidelity  # noqa: E402

RAYPOOL = ""
LEVELS = [level.name for level in fidelity.LEVELS]
FRAME = ("--scene", "cornell", "--size", "16x12", "--depth", "2", "--config", "4w4c")
# A program that stands in for raypool: it draws with raypool, then CHANGE does something to the folder `out`.
STAND_IN = """#!{python}
import json, pathlib, shutil, subprocess, sys, time
words = sys.argv[1:]
code = subprocess.run([{raypool!r}, *words]).returncode
if words[0] == "sim":
    out = pathlib.Path(words[words.index("--out") + 1])
    report = json.loads((out / "report.json").read_text())
    engine = report["engine"]
{change}
    (out / "report.json").write_text(json.dumps(report))
sys.exit(code)
"""


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"
        self.raypool = RAYPOOL

    def command(self, *words):
        return [sys.executable, ROOT / "studies/fidelity.py", *FRAME, "--out", self.out, *words]

    def run_it(self, *words, code=0, **environment):
        done = subprocess.run(self.command(*words), cwd=ROOT, capture_output=True, text=True, check=False, timeout=120,
                              env={**os.environ, "RAYPOOL": str(self.raypool), **environment})  # fmt: skip
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def stand_in(self, change):
        self.raypool = self.folder / "stand-in"
        lines = "\n".join("    " + line for line in change.splitlines())
        self.raypool.write_text(STAND_IN.format(python=sys.executable, raypool=RAYPOOL, change=lines))
        self.raypool.chmod(self.raypool.stat().st_mode | stat.S_IXUSR)

    def contents(self):
        """Of all files in OUT."""
        return {path.relative_to(self.out): path.read_bytes() for path in self.out.rglob("*") if path.is_file()}

    def read(self, name):
        return json.loads((self.out / name).read_text())


class Runs(Case):
    def test_all_that_is_said_is_what_the_reports_say(self):
        lines = self.run_it().stdout.splitlines()
        self.assertIn("16x12, depth 2, 4w4c", lines[0])
        self.assertIn("speed-up over rtl", lines[1])
        table = {line.split()[0]: line.split() for line in lines[2 : 2 + len(LEVELS)]}
        self.assertEqual(list(table), LEVELS)
        found = self.read("fidelity.json")
        self.assertEqual((found["reference"], found["speed_up_over"]), ("rtl", "rtl"))
        rows = {row["level"]: row for row in found["levels"]}
        walls = {}
        for name, row in rows.items():
            report = self.read(f"{name}/report.json")
            self.assertEqual((row["rays"], row["cycles"]), (report["rays"], report["cycles"]))
            self.assertEqual(row["simulation_seconds"]["runs"], [report["simulation_seconds"]])
            walls[name] = row["wall_seconds"]["median"]
            self.assertGreater(walls[name], report["wall_seconds"], "of the whole command")
            self.assertAlmostEqual(row["rays_per_second"], report["rays"] / walls[name])
            self.assertEqual(table[name][1], f"{walls[name]:.2f}")
        for name, row in rows.items():
            self.assertAlmostEqual(row["speed_up"], walls["rtl"] / walls[name])
        for name in ("native", "functional"):
            self.assertEqual(table[name][5:], ["-", "-", "-", "-", "equal"])
            self.assertIsNone(rows[name]["cycles_error"])
        cycles = str(rows["rtl"]["cycles"])
        self.assertEqual(table["model"][6:8] + table["model"][9:], [cycles, "exact", "equal"])
        self.assertEqual(table["rtl"][6:8] + table["rtl"][9:], [cycles, "reference", "reference"])
        self.uses(lines, self.read("rtl/report.json"))
        self.assertEqual(rows["model"]["picture"], {"pixels": 192, "differ": 0, "off_by_more": 0,
                                                    "largest_difference": 0, "mean_difference": 0,
                                                    "psnr": None})  # fmt: skip
        svg = " ".join(xml.etree.ElementTree.parse(self.out / "fidelity.svg").getroot().itertext())
        for name in LEVELS:
            self.assertRegex(svg, rf"\b{name}, \d+\.\d x")

    def uses(self, lines, report):
        """Of each ALU and each port, in the table."""
        begin = next(number for number, line in enumerate(lines) if line.startswith("utilisation"))
        header = lines[begin].split(maxsplit=1)[1]
        self.assertEqual(header.split("  ")[-1], "memory port")
        shares = [alu["utilisation"] for alu in report["alus"].values()]
        pools = report["pools"]
        shares += [pools["ray_port_utilisation"], pools["intersection_port_utilisation"],
                   report["memory"]["port_utilisation"]]  # fmt: skip
        table = {line.split()[0]: line.split()[1:] for line in lines[begin + 1 :] if line}
        self.assertEqual(table["rtl"], [f"{100 * share:.1f}%" for share in shares])
        self.assertEqual(table["model"], table["rtl"])
        self.assertEqual(table["error,"], ["points", *["exact"] * len(shares)])

    def test_levels_are_left_out_and_repeated(self):
        done = self.run_it("--levels", "model native", "--runs", "3")
        self.assertEqual([line.split()[0] for line in done.stdout.splitlines()[2:4]], ["native", "model"])
        begins = [line for line in done.stderr.splitlines() if "begins" in line]
        self.assertEqual(len(begins), 6)
        self.assertIn("native, run 3 of 3", begins[4])
        found = self.read("fidelity.json")
        self.assertEqual(found["reference"], "model")
        for row in found["levels"]:
            wall = row["wall_seconds"]
            self.assertEqual(sorted(wall["runs"]), [wall["least"], wall["median"], wall["most"]])
        slowest = max(found["levels"], key=lambda row: row["wall_seconds"]["median"])
        self.assertEqual(found["speed_up_over"], slowest["level"])

    def test_the_page_says_what_each_level_is_for(self):
        page = (ROOT / "docs/use/speed-and-accuracy.md").read_text(encoding="utf-8").split("## ")[0]
        self.assertEqual(re.findall(r"^\| `(\w+)` \|", page, re.M), LEVELS)

    def test_frames_that_differ_have_folders_of_their_own(self):
        names = set()
        for words in ((), ("--depth", "4"), ("--size", "8x8"), ("--scene", "a/cornell.obj"), ("--set", "warps=2"),
                      ("--traverser", "static"), ("--eye=-1,2,3",)):  # fmt: skip
            options, name = fidelity.frame(fidelity.parser().parse_args([*FRAME, *words]))
            self.assertIn("--config=4w4c", options)
            names.add(name)
        self.assertEqual(len(names), 7)
        self.assertIn("cornell-4w4c-1cu-16x12-depth2", names)


class Differences(Case):
    def detected(self, change, sentence, *words):
        """The frame of before stays, and what differs is kept beside it."""
        self.run_it("--levels", "native,model")
        before = self.contents()
        self.stand_in(change)
        done = self.run_it(*words, code=3)
        self.assertRegex(done.stderr.splitlines()[-1], sentence)
        self.assertEqual({path: text for path, text in self.contents().items() if path.parts[0] != "different"}, before)
        self.assertEqual(done.stdout, "")

    def other_picture(self):
        folder = self.folder / "other"
        subprocess.run([RAYPOOL, "sim", "--scene", "cornell", "--size", "16x12", "--depth", "1", "--engine", "native",
                        "--quiet", "--out", folder], check=True)  # fmt: skip
        return str(folder / "image.png")

    def test_a_cycle(self):
        self.detected("if engine == 'model': report['cycles'] += 1",
                      r"rtl and model differ: cycles \d+ and \d+; raypool compare")
        kept = [self.read(f"different/{name}/report.json")["cycles"] for name in ("rtl", "model")]
        self.assertEqual(kept[0] + 1, kept[1])
        self.raypool = RAYPOOL
        self.run_it("--levels", "native")
        self.assertFalse((self.out / "different").exists())

    def test_a_counter(self):
        self.detected("report['warp_cycles']['waiting']['flt'] += engine == 'rtl'",
                      r"differ: warp_cycles\.waiting\.flt \d+ and \d+;", "--levels", "model,rtl")  # fmt: skip

    def test_the_picture(self):
        change = f"if engine == 'model': shutil.copy({self.other_picture()!r}, out / 'image.png')"
        self.detected(change, r"differ: \d+ of 192 pixels;", "--levels", "model,rtl")

    def test_a_level_that_does_not_claim_to_be_exact_may_differ(self):
        self.stand_in(f"if engine == 'native': shutil.copy({self.other_picture()!r}, out / 'image.png')")
        done = self.run_it("--levels", "native,model")
        self.assertRegex(done.stdout, r"native .* \d+ pixels differ, by \d+ at most\n")

    def test_a_second_run_that_is_another(self):
        self.detected(f"if {str(self.folder)!r} in str(out) and (out.parent / 'again').exists(): report['rays'] += 1\n"
                      "(out.parent / 'again').touch()",
                      r"native: run 2 is not as run 1 was: rays", "--levels", "native", "--runs", "2")  # fmt: skip


class Errors(unittest.TestCase):
    """Of a level that is not exact, which has errors: they are those against the hardware, wherever they are shown."""

    def run_of(self, level, cycles, flt):
        run = fidelity.Run(level)
        run.add(10.0 if level.verilated else 0.5, {
            "raypool": "0.1.0", "scene": {"name": "s'c`ene", "triangles": 1}, "size": {"width": 8, "height": 8},
            "depth": 1, "config": "4w4c", "units": 1, "traverser": "static", "rays": 100, "cycles": cycles,
            "mrays_per_second": 1e5 / cycles, "simulation_seconds": 0.25, "alus": {"flt": {"utilisation": flt}},
            "pools": {"ray_port_utilisation": 0.5}, "memory": {"port_utilisation": None},
        })  # fmt: skip
        run.picture = {"pixels": 64, "differ": 3, "off_by_more": 0.03125, "largest_difference": 2,
                       "mean_difference": 0.01, "psnr": 55.0}
        return run

    def test_errors(self):
        rough = fidelity.Level("rough", (), exact=False)
        runs = [self.run_of(rough, 990, 0.2), self.run_of(rough._replace(name="just"), 1000, 0.25),
                self.run_of(fidelity.LEVELS[-1], 1000, 0.25)]  # fmt: skip
        found = fidelity.summary(runs, runs[-1], runs[-1])
        row = found["levels"][0]
        self.assertAlmostEqual(row["cycles_error"], -0.01)
        self.assertAlmostEqual(row["mrays_per_second_error"], 1 / 0.99 - 1)
        self.assertAlmostEqual(row["alus"]["flt"]["error"], -0.05)
        self.assertEqual(row["ports"], {"ray port": {"utilisation": 0.5, "error": 0},
                                        "memory port": {"utilisation": None, "error": None}})  # fmt: skip
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            fidelity.print_tables(found)
        text = printed.getvalue()
        self.assertRegex(text, r"rough +0\.50 +0\.25 +20\.0 +0\.2 +2\.0 +990 +-1\.00% +101\.01 +3 pixels differ, by 2 ")
        self.assertRegex(text, r"just .* exact ")
        self.assertRegex(text, r"\nrough +20\.0% +50\.0% +-\n  error, points +-5\.00 +exact +-\n")
        with tempfile.TemporaryDirectory() as folder:
            fidelity.plot(found, pathlib.Path(folder, "plot.svg"))
            svg = pathlib.Path(folder, "plot.svg").read_text(encoding="utf-8")
        self.assertIn("rough, 20.0 x", svg)
        self.assertIn("s'c`ene", "".join(xml.etree.ElementTree.fromstring(svg).itertext()))

    def test_without_the_hardware_nothing_says_what_the_error_is(self):
        runs = [self.run_of(fidelity.Level("rough", ()), 990, 0.2)]
        row = fidelity.summary(runs, runs[-1], runs[-1])["levels"][0]
        self.assertEqual((row["cycles_error"], row["mrays_per_second_error"], row["alus"]["flt"]["error"]), (None,) * 3)


class Refusals(Case):
    def refuses(self, sentence, *words, **environment):
        """One line, and nothing is left."""
        done = self.run_it(*words, code=1, **environment)
        said = [line for line in done.stderr.splitlines() if not line.endswith("begins")]
        self.assertEqual(len(said), 1, done.stderr)
        self.assertRegex(said[0], sentence)
        self.assertFalse(self.out.exists())

    def test_what_cannot_be_used_gets_a_sentence(self):
        self.refuses("'moodel' is not a level; there are native, estimate, functional", "--levels", "native,moodel")
        self.refuses("no level is named", "--levels", ",")
        for runs in ("0", "-1", "two", "1000"):
            self.refuses(f"'{runs}' must be from 1 to 999", f"--runs={runs}")
        self.refuses("unrecognized arguments: --engine", "--engine", "model")
        self.refuses("nosuchscene", "--scene", "nosuchscene")
        self.refuses("none.obj", "--scene", str(self.folder / "none.obj"))
        self.refuses("3", "--config", "3w4c")
        self.refuses("depth is 0", "--depth", "0")
        (self.folder / "matplotlib.py").write_text("raise ImportError")
        self.refuses("^Matplotlib.*was not found: scripts/setup.sh", PYTHONPATH=str(self.folder))
        self.raypool = self.folder / "none"
        self.refuses("none was not found: make fidelity builds it")

    def test_a_folder_that_cannot_be_written_gets_one_too(self):
        (self.folder / "file").write_text("")
        self.refuses("the folder .*file/out cannot be written: Not a directory", "--out", self.folder / "file/out")

    def test_what_is_interrupted_leaves_earlier_results(self):
        self.run_it("--levels", "native")
        before = self.contents()
        self.stand_in("print('drawn', file=sys.stderr, flush=True); time.sleep(60)")
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process = subprocess.Popen(self.command("--levels", "native"), cwd=ROOT, stderr=subprocess.PIPE,
                                           stdout=subprocess.PIPE, text=True,
                                           env={**os.environ, "RAYPOOL": str(self.raypool)})  # fmt: skip
                for line in process.stderr:
                    if "drawn" in line:
                        break
                process.send_signal(number)
                begin = time.monotonic()
                said = process.communicate(timeout=30)[1]
                self.assertLess(time.monotonic() - begin, 20)
                self.assertEqual(process.returncode, 130, said)
                self.assertIn("interrupted; earlier results are as they were", said)
                self.assertEqual(self.contents(), before)
                self.assertEqual(sorted(os.listdir(self.out)), ["fidelity.json", "fidelity.svg", "native"])


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
