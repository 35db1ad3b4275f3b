#!/usr/bin/env python3
"""Sweeps: studies/tests/sweep_test.py RAYPOOL [TEST]...

What is wrong with an experiment is said before anything runs; a sweep that is killed goes on without losing a point or
running one twice; a failed point does not stop the others; what a result depends on is in its key."""
import csv
import json
import lzma
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RAYPOOL = ""
sys.path.insert(0, str(ROOT / "studies"))
TINY = {"scene": "cornell", "detail": 0.01, "size": "8x8", "depth": 1, "config": "1w1c", "engine": "functional"}
HALL = "mtllib colours.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
# Stands in for the program: does what it does, but for the points that the test has made special.
WRAPPER = """#!/bin/bash
# {version}
out=${{!#}}
case "$1 $* " in
  "config "*--json*) echo >> {folder}/machines ;;&
  "sim "*--modules*) ;;
  "sim "*--depth=13*) [ -e {folder}/works ] || {{ echo 'raypool: depth 13 brings bad luck' >&2; exit 3; }} ;;
  "sim "*--depth=7*)
    # Half-written until it is killed.
    if [ -e {folder}/hang ]; then
      {raypool} "$@"; truncate -s 100 "$out/report.json"
      echo "$SLURMD_NODENAME $SLURM_JOB_ID" > {folder}/hang; mv {folder}/hang {folder}/hangs
      exec sleep 60
    fi ;;
esac
exec {raypool} "$@"
"""


def children(pid):
    """All processes below this one."""
    parents = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents.setdefault(int(fields[1]), []).append(int(path.parent.name))
    found = list(parents.get(pid, []))
    for child in found:
        found += parents.get(child, [])
    return found


def kill(pids):
    for pid in pids:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass


class SweepTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"
        self.program = self.folder / "raypool"
        self.wrap("first")

    def wrap(self, version):
        self.program.write_text(WRAPPER.format(raypool=RAYPOOL, folder=self.folder, version=version))
        self.program.chmod(0o755)

    def command(self, *words, out=None):
        experiment = str(self.folder / "experiment.json")
        return [sys.executable, "-m", "sweep", experiment, "--out", str(out or self.out), *words]

    def environment(self):
        return {**os.environ, "PYTHONPATH": str(ROOT / "studies"), "RAYPOOL": str(self.program)}

    def scenes_here_and_there(self):
        places = {"SCENES": f"{self.folder}/here:{self.folder}/there", "BUILD": str(self.folder / "build")}
        return unittest.mock.patch.dict(os.environ, places)

    def write(self, document):
        text = document if isinstance(document, str) else json.dumps(document)
        (self.folder / "experiment.json").write_text(text)

    def run_sweep(self, document, *words, code=0, out=None):
        self.write(document)
        command = self.command(*words, out=out)
        done = subprocess.run(command, env=self.environment(), capture_output=True, text=True, check=False)
        log = (out or self.out) / "snakemake.log"
        more = log.read_text() if log.exists() and done.returncode != code else ""
        self.assertEqual(done.returncode, code, done.stdout + done.stderr + more)
        return done

    def start(self, *words):
        return subprocess.Popen(
            self.command(*words), env=self.environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def finished(self):
        return {path.parent.name for path in self.out.glob("points/*/point.json")}

    def starts(self, out=None):
        log = (out or self.out) / "starts.log"
        return [line.split()[1] for line in log.read_text().splitlines() if line.startswith("start ")]

    def until(self, condition, what):
        end = time.monotonic() + 100
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.05)

    def rows(self, out=None):
        return json.loads(((out or self.out) / "table.json").read_text())["rows"]


class Refusals(SweepTest):
    """One sentence, exit code 1, and nothing has run."""

    def refuses(self, document, *words):
        begin = time.monotonic()
        done = self.run_sweep(document, code=1)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        for word in ("experiment.json", *words):
            self.assertIn(word, lines[0])
        self.assertFalse(self.out.exists())
        return time.monotonic() - begin

    def test_an_experiment_that_is_not_there_names_the_nearest(self):
        for name, beside, words in (
            ("chaces.json", (), "did you mean configs/experiments/caches.json?"),
            ("mnie.json", ("mine.json", "caches.json"), f"{self.folder.name}/mine.json?"),
            ("xyzzy.json", (), "there is no such experiment\n"),
        ):
            for other in beside:
                (self.folder / other).write_text("{}")
            done = subprocess.run([sys.executable, "-m", "sweep", str(self.folder / name)], cwd=ROOT, text=True,
                                  env=self.environment(), capture_output=True, check=False)  # fmt: skip
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(f"{name}: there is no such experiment", done.stderr)
            self.assertIn(words, done.stderr)

    def test_form(self):
        self.refuses('{"base": ', "not valid JSON")
        self.refuses('{"product": {"warps": [1]}, "product": {"lanes": [1]}}', "'product' stands twice")
        self.refuses({"products": {}}, "there is no 'products'", "product")
        self.refuses({"product": {"warps": []}}, "product.warps", "empty")
        self.refuses({"points": []}, "points", "empty")
        self.refuses({"product": {"warps": 4}}, "product.warps", "array")
        self.refuses({"product": {"warps": [[4]]}}, "product.warps.1", "number")
        self.refuses({"base": {"warps": None}}, "base.warps", "null")

    def test_fields(self):
        self.refuses({"product": {"flt.count": [1]}}, "product", "'flt.count': did you mean alus.flt.count?")
        self.refuses({"base": {"scen": "room"}}, "base", "'scen': did you mean scene?")
        self.refuses({"points": [{}, {"dept": 1}]}, "point 2 of points", "'dept'", "depth")
        self.refuses({"points": [{"warps": 1}], "product": {"warps": [2]}}, "warps", "both")
        self.refuses({"base": {"warps": "4 lanes=2"}}, "one word")

    def test_values(self):
        for field, value, *words in (
            ("warps", 3, "power of two"),
            ("warps", "eight", "warps must be"),
            ("alus.flt.count", 9, "flt"),
            ("chip.held_limit", 0, "held_limit"),
            ("chip.policy", "magic", "thesis"),
            ("config", "nothing", "nothing"),
            ("depth", 0, "from 1 to"),
            ("depth", "deep", "deep"),
            ("units", 3, "1, 2 or 4"),
            ("size", "8by8", "8by8"),
            ("size", "0x8", "0x8"),
            ("engine", "spice", "native, estimate, functional, sampled, model, rtl or lockstep"),
            ("boundary", "chip", "engine model has no Verilog"),
            ("hits", "embree", "engine model has the hits of its traverser"),
            ("detail", 0, "detail"),
            ("shaders", "debgu", "debgu"),
            ("samples", 2, "give --shaders too"),
            ("scene", "none.obj", "none.obj"),
            ("view", "none.json", "none.json"),
        ):
            with self.subTest(field=field, value=value):
                good = {"config": "1w1c", "warps": 1}.get(field, TINY.get(field, value))
                document = {"base": {"detail": 0.01}, "points": [{field: good}, {field: value}]}
                place = "point 1 " if good == value else "point 2 "
                self.refuses(document, place, f"{field}=", *words)

    def test_fields_that_a_machine_does_not_look_at(self):
        pipes = "chip.hardware_traverser.lanes"
        words = (f"{pipes} is not looked at", "chip.traverser is static", "or leave it out")
        self.refuses({"base": {**TINY, "chip.traverser": "static"}, "product": {pipes: [1, 4]}}, "point 1 ", *words)
        both = {"base": TINY, "product": {"chip.traverser": ["hardware", "static"], pipes: [4, 8]}}
        self.refuses(both, "point 3 ", *words)
        points = [{}, {"chip.policy": "thesis"}, {"chip.static_traverser.stall_cycles": 9}]
        self.refuses({"base": TINY, "points": points}, "point 3 ", "chip.traverser is not static")

    def test_a_scene_that_is_not_part_of_the_project(self):
        with self.scenes_here_and_there():
            document = {"base": {**TINY, "scene": "hall.obj"}, "scene_source": "ask the caretaker"}
            self.refuses(document, "hall.obj", "/here", "/there", "ask the caretaker", "SCENES=FOLDER")
            (self.folder / "there").mkdir()
            (self.folder / "there/hall.obj.xz").write_bytes(b"this is not packed")
            self.refuses(document, "hall.obj.xz", "cannot be unpacked")

    def test_jobs(self):
        for jobs in ("0", "-1", "10001", "two", "1.5", ""):
            done = self.run_sweep({"base": TINY}, f"--jobs={jobs}", code=1)
            self.assertEqual(done.stderr, f"sweep: JOBS={jobs}: points at a time, from 1 to 10000\n")
        self.assertFalse(self.out.exists())

    def test_too_many_points(self):
        ten = list(range(1, 11))
        fields = ["depth", "warps", "lanes", "stack_depth", "chip.held_limit", "chip.memory.latency"]
        product = {field: ten for field in (*fields, "chip.memory.queue")}
        seconds = self.refuses({"base": TINY, "product": product}, "10,000,000 points", "10,000")
        self.assertLess(seconds, 10)

    def test_filters(self):
        for text, *words in (
            ("contents >", "no expression"),
            ("content > 1", "'content'", "contents"),
            ("__import__('os').system('true')", "not taken"),
            ("().__class__", "not taken"),
            ("2 ** 100000000 > 1", "not taken"),
            ("warps", "neither true nor false"),
            ("warps / (lanes - 1) > 1", "division by zero"),
            ("config < 4", "not supported"),
            ("'a' * 1000000 == 'b'", "not a number"),
            ("contents > 5", "leaves out all"),
        ):
            with self.subTest(filter=text):
                self.refuses({"base": TINY, "filter": text}, *words)

    def test_power_is_of_synthesised_units(self):
        self.refuses({"base": TINY, "power": True}, '"area": true')


class Runs(SweepTest):
    def test_a_killed_sweep_goes_on_where_it_was(self):
        document = {"base": TINY, "product": {"depth": list(range(1, 13)), "size": ["8x8", "9x8"]}}
        whole = self.folder / "whole"
        self.run_sweep(document, out=whole)
        self.write(document)
        # Killed while a point is half-written, it and all that it has started.
        (self.folder / "hang").touch()
        sweep = self.start()
        self.until((self.folder / "hangs").exists, "no point hangs")
        below = children(sweep.pid)
        kill([sweep.pid, *below])
        sweep.wait()
        first, first_starts = self.finished(), self.starts()
        self.assertTrue(list(self.out.glob(".work/unfinished/*/report.json")))
        self.assertLess(len(first), 24)
        # Killed alone; points that are under way end by themselves.
        sweep = self.start()
        self.until(lambda: len(self.finished()) >= len(first) + 3, "nothing goes on")
        second = self.finished()
        second_starts = self.starts()
        sweep.kill()
        sweep.wait()
        self.run_sweep(document)
        self.assertEqual(len(self.finished()), 24)
        # Started once, but for what was under way when all was killed.
        starts = self.starts()
        twice = {key for key in starts if starts.count(key) > 1}
        for finished, before in ((first, first_starts), (second, second_starts)):
            self.assertFalse({key for key in finished if starts.count(key) > before.count(key)})
        self.assertLessEqual(len(twice), os.cpu_count())
        for name in ("table.json", "table.csv"):
            self.assertEqual((self.out / name).read_bytes(), (whole / name).read_bytes())
        self.assertEqual([row["depth"] for row in self.rows()], [depth for depth in range(1, 13) for _ in "ab"])
        self.assertFalse(list(self.out.glob(".work/unfinished/*")))
        self.run_sweep(document)
        self.assertEqual(self.starts(), starts)

    def test_a_failed_point_is_told_and_tried_again(self):
        document = {"base": TINY, "product": {"depth": [13, 1, 2]}}
        done = self.run_sweep(document, code=3)
        self.assertIn("point 1 (depth=13) failed: depth 13 brings bad luck", done.stderr)
        self.assertEqual([row["depth"] for row in self.rows()], [1, 2])
        (self.folder / "works").touch()
        self.run_sweep(document)
        self.assertEqual([row["depth"] for row in self.rows()], [13, 1, 2])
        self.assertEqual(len(self.starts()), 4)
        self.assertFalse(list(self.out.glob("failed/*")))

    def test_what_a_result_depends_on_runs_again(self):
        scene, view = self.folder / "scene.obj", self.folder / "view.json"
        (self.folder / "colours.mtl").write_text("newmtl red\nKd 1 0 0\n")
        scene.write_text(HALL)
        view.write_text('{"eye": [0.3, 0.3, 2], "target": [0.3, 0.3, 0], "light": {"position": [0, 0, 3]}}')
        document = {"base": {**TINY, "engine": "model", "scene": "scene.obj", "view": "view.json"}}
        changes = [
            lambda: None,
            lambda: (self.folder / "colours.mtl").write_text("newmtl red\nKd 0 1 0\n"),
            lambda: scene.write_text(scene.read_text() + "f 1 3 2\n"),
            lambda: view.write_text(view.read_text().replace("0.3, 2", "0.3, 3")),
            lambda: document["base"].update({"chip.memory.latency": 60}),
            lambda: document["base"].update(size="8x9"),
            lambda: self.wrap("second"),
        ]
        for number, change in enumerate(changes, 1):
            change()
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), number)
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), number)

    def test_scenes_are_found_and_unpacked(self):
        (self.folder / "there").mkdir()
        (self.folder / "there/hall.obj.xz").write_bytes(lzma.compress(HALL.encode()))
        (self.folder / "there/colours.mtl").write_text("newmtl red\nKd 1 0 0\n")
        with self.scenes_here_and_there():
            document = {"base": {**TINY, "scene": "hall.obj"}}
            self.run_sweep(document)
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), 1)
            # Another file of that name in the same place is another scene, and so are other colours.
            (self.folder / "there/colours.mtl").write_text("newmtl red\nKd 0 1 0\n")
            self.run_sweep(document)
            (self.folder / "there/hall.obj.xz").write_bytes(lzma.compress((HALL + "f 1 3 2\n").encode()))
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), 3)
            # One beside the experiment is nearer.
            (self.folder / "hall.obj").write_text(HALL.replace("mtllib colours.mtl\n", ""))
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), 4)

    def test_a_result_depends_on_libraries_however_they_are_named(self):
        (self.folder / "sub").mkdir()
        libraries = [self.folder / "sub/my colours.mtl", self.folder / "more.mtl"]
        for library in libraries:
            library.write_text("newmtl red\nKd 1 0 0\n")
        named = "\ufeffmtllib sub\\My Colours.mtl \\\r\n C:\\hall\\more.mtl\r\n"
        (self.folder / "hall.obj").write_text(named + HALL.replace("mtllib colours.mtl\n", ""))
        document = {"base": {**TINY, "scene": "hall.obj"}}
        self.run_sweep(document)
        for number, library in enumerate(libraries, 2):
            library.write_text("newmtl red\nKd 0 1 0\n")
            self.run_sweep(document)
            self.assertEqual(len(self.starts()), number)
        # An experiment with a byte order mark is the same one.
        self.run_sweep("\ufeff" + json.dumps(document))
        self.assertEqual(len(self.starts()), number)

    def test_a_point_whose_program_was_changed_meanwhile_does_not_run(self):
        self.run_sweep({"base": TINY})
        (key,) = self.finished()
        shutil.rmtree(self.out / "points" / key)
        self.wrap("second")
        command = [sys.executable, "-m", "sweep.point", self.out, key]
        self.assertEqual(subprocess.run(command, env=self.environment(), check=False).returncode, 1)
        self.assertIn("was changed while the sweep was running", (self.out / "failed" / key / "error.txt").read_text())
        self.assertFalse((self.out / "failed" / key / "log.txt").exists())
        self.assertFalse(self.finished())

    def test_filter_and_tables(self):
        document = {
            "base": {**TINY, "engine": "model"},
            "product": {"warps": [1, 2, 4], "data_cache.bytes": [512, 1024]},
            "filter": "contents < 4 and (data_cache.bytes == 512 or not warps in (2, 4)) and chip.policy == 'thesis'",
        }
        done = self.run_sweep(document)
        self.assertIn("3 left out by the filter", done.stdout)
        rows = self.rows()
        self.assertEqual([(row["warps"], row["data_cache.bytes"]) for row in rows], [(1, 512), (1, 1024), (2, 512)])
        with open(self.out / "table.csv", encoding="utf-8") as file:
            lines = list(csv.DictReader(file))
        for row, line in zip(rows, lines):
            report = json.loads((self.out / "points" / row["key"] / "report.json").read_text())
            self.assertEqual(row["cycles"], report["cycles"])
            self.assertEqual(float(line["alus.flt.utilisation"]), report["alus"]["flt"]["utilisation"])
            self.assertEqual(report["configuration"]["warps"], row["warps"])
            self.assertNotIn("wall_seconds", row)

    def test_a_filter_leaves_out_points_with_fields_that_are_not_looked_at(self):
        pipes = "chip.hardware_traverser.lanes"
        document = {"base": TINY, "product": {"chip.traverser": ["static", "hardware"], pipes: [4, 8]},
                    "filter": "chip.traverser == 'hardware'"}  # fmt: skip
        self.run_sweep(document)
        self.assertEqual([row[pipes] for row in self.rows()], [4, 8])

    def test_every_engine_is_a_point(self):
        engines = ["native", "functional", "model", "rtl", "lockstep"]
        self.run_sweep({"base": {**TINY, "config": "4w4c", "depth": 2}, "product": {"engine": engines}})
        rows = self.rows()
        self.assertEqual([row["engine"] for row in rows], engines)
        self.assertEqual(len({row["picture"] for row in rows}), 1)
        self.assertEqual([row["cycles"] for row in rows[:2]], [None, None])
        self.assertEqual(len({row["cycles"] for row in rows[2:]}), 1)
        self.assertGreater(rows[2]["cycles"], 0)
        self.assertGreater(rows[4]["lockstep.instructions"], 0)

    def test_boundary_and_hits_are_those_of_the_point(self):
        points = [{"engine": "native", "hits": "embree"}, {"chip.traverser": "static"},
                  {"engine": "lockstep", "boundary": "chip", "chip.traverser": "static"}]  # fmt: skip
        self.run_sweep({"base": {**TINY, "config": "4w4c", "depth": 2, "engine": "model"}, "points": points})
        rows = self.rows()
        self.assertEqual([(row["hits"], row["boundary"]) for row in rows], [("embree", ""), ("", ""), ("", "chip")])
        self.assertEqual(len({row["picture"] for row in rows}), 1)
        self.assertEqual(rows[1]["cycles"], rows[2]["cycles"])
        reports = [json.loads((self.out / "points" / row["key"] / "report.json").read_text()) for row in rows]
        self.assertEqual([(report.get("hits"), report.get("boundary")) for report in reports],
                         [("embree", None), (None, None), (None, "chip")])  # fmt: skip

    def test_shader_sets_are_those_of_the_point_and_of_today(self):
        own = self.folder / "mine"
        shutil.copytree(ROOT / "shaders" / "debug", own)
        document = {"base": {**TINY, "config": "4w4c"}, "product": {"shaders": ["debug", "./mine"], "samples": [1, 2]}}
        self.run_sweep(document)
        rows = self.rows()
        self.assertEqual([row["shaders.samples"] for row in rows], [1, 2, 1, 2])
        self.assertEqual(rows[0]["picture"], rows[2]["picture"])
        before = self.finished()
        self.assertEqual(len(before), 4)
        shader = next(own.glob("*.rmiss"), None) or next(own.glob("*.rgen"))
        shader.write_text(shader.read_text() + "// changed\n")
        self.run_sweep(document)
        self.assertEqual(len(self.finished() - before), 2)

    def test_a_machine_has_what_raypool_adds_for_a_shader_set(self):
        shaders = str(ROOT / "cpp_model" / "shader" / "cases" / "reflections")
        base = {**TINY, "config": "4w4c", "engine": "model", "shaders": shaders}
        self.run_sweep({"base": base, "product": {"units": [1, 2]}})
        rows = self.rows()
        reports = [json.loads((self.out / "points" / row["key"] / "report.json").read_text()) for row in rows]
        machines = [report["configuration"] for report in reports]
        self.assertEqual([machine["chip"]["miss_records"] for machine in machines], [True, True])
        self.assertEqual([machine["sharing"] for machine in machines], [False, True])
        self.assertEqual(len({row["picture"] for row in rows}), 1)

    def test_an_interrupt_while_machines_are_checked_does_not_wait_for_the_rest(self):
        self.write({"base": TINY, "product": {"chip.memory.latency": list(range(1, 1001))}})
        calls = self.folder / "machines"
        sweep = self.start()
        self.until(lambda: calls.exists() and len(calls.read_text()) > 5, "no machine is checked")
        sweep.send_signal(signal.SIGINT)
        self.assertEqual(sweep.wait(), 130)
        self.assertLess(len(calls.read_text()), 500)
        self.assertFalse(self.out.exists())

    def test_two_in_one_folder_are_refused(self):
        self.write({"base": TINY, "product": {"depth": [7]}})
        (self.folder / "hang").touch()
        sweep = self.start()
        self.until((self.folder / "hangs").exists, "no point hangs")
        below = children(sweep.pid)
        done = subprocess.run(self.command(), env=self.environment(), capture_output=True, text=True, check=False)
        kill([sweep.pid, *below])
        sweep.wait()
        self.assertEqual(done.returncode, 1)
        self.assertIn("another sweep is running", done.stderr)


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
