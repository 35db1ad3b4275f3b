#!/usr/bin/env python3
"""make follow on small frames: scripts/tests/follow_test.py RAYPOOL [TEST]... Needs the Verilated chip of 4w4c with
waveforms beside it.

The journey is whole, and all that the host can compute itself is the same; a word that is altered anywhere on the way
is detected; what cannot be followed gets a sentence.
"""
import contextlib
import io
import json
import os
import pathlib
import re
import shutil
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from follow import __main__ as follow, packages, picture, ports, vcd  # noqa: E402
from follow.errors import FollowError  # noqa: E402
from follow.journey import Journey  # noqa: E402

TITLE = re.compile(r"\w+: the (eye|reflection|shadow) ray")
SMALL = ("--size", "8x6", "--pixel", "5,2")


def followed(*arguments):
    """(exit code, what was printed, what was complained of)"""
    said, complained = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        code = follow.main(list(arguments))
    return code, said.getvalue(), complained.getvalue()


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def refused(self, sentence, *arguments):
        with self.assertRaises(FollowError) as caught:
            followed(*arguments)
        self.assertIn(sentence, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))


class Tour(Case):
    def check_whole(self, said, rays):
        """Each of the rays is there, its cycles rise, and nothing differs."""
        titles = [line.split(":")[0] for line in said.splitlines() if TITLE.match(line)]
        self.assertEqual(sorted(titles), sorted(rays))
        last = 0
        for line in said.splitlines():
            if TITLE.match(line):
                last = 0
            elif line[:10].strip().isdigit() and line[10:12] == "  ":
                self.assertGreaterEqual(int(line[:10]), last, line)
                last = int(line[:10])
        self.assertIn(": 0 differ", said)

    def test_the_page_shows_what_is_drawn(self):
        code, said, complained = followed("--out", str(self.folder))
        self.assertEqual((code, complained), (0, ""))
        self.check_whole(said, ["eye", "reflection2", "shadow1", "reflection3", "shadow2"])
        for way in ("traverser: set-up: lane", "of its boxes 3 met", "hit at t 7.27261", "the ray leaves its lane",
                    "controller -> multiprocessor: launch", "multiprocessor -> ray_pool: a ray",
                    "ray_pool -> traverser", "traverser -> intersection_pool", "intersection_pool -> multiprocessor",
                    "multiprocessor -> frame_port", "frame_port -> frame buffer", "120 instructions"):  # fmt: skip
            self.assertIn(way, said)
        for name in ("time", "way", "export", "node", "triangle", "launch", "import", "frame"):
            shown = (ROOT / f"docs/images/tour-{name}.svg").read_text()
            self.assertEqual((self.folder / f"{name}.svg").read_text(), shown, f"tour-{name}.svg: run make tour")
        shown, drawn = (picture.read(path) for path in (ROOT / "docs/images/tour-pixel.png", self.folder / "pixel.png"))
        self.assertEqual(shown, drawn, "tour-pixel.png: run make tour")

    def test_cornell(self):
        code, said, complained = followed("--scene", "cornell", "--detail", "0.1", "--size", "12x12", "--pixel", "4,6",
                                          "--depth", "3", "--out", str(self.folder))  # fmt: skip
        self.assertEqual((code, complained), (0, ""))
        self.check_whole(said, ["eye", "shadow1", "reflection2", "shadow2", "reflection3", "shadow3", "reflection4"])

    def test_a_pixel_that_sees_nothing(self):
        code, said, complained = followed("--size", "8x6", "--pixel", "0,0", "--out", str(self.folder))
        self.assertEqual((code, complained), (0, ""))
        self.check_whole(said, ["eye"])
        self.assertIn("it hits nothing", said)

    def test_a_frame_is_drawn_once(self):
        def drawn(*arguments):
            code, _, complained = followed(*SMALL, *arguments, "--out", str(self.folder))
            self.assertEqual((code, complained), (0, ""))
            return (self.folder / "waves.fst").stat().st_mtime_ns

        first = drawn()
        self.assertEqual(drawn("--ray", "eye"), first)
        moved = drawn("--light=-2,4,3")
        self.assertNotEqual(moved, first)
        (self.folder / "followed.vcd").write_text("", encoding="utf-8")
        (self.folder / "followed.sha256").unlink()
        self.assertNotEqual(drawn("--light=-2,4,3"), moved)

    def test_instructions_and_tree(self):
        _, said, _ = followed(*SMALL, "--ray", "eye", "--station", "instructions", "--out", str(self.folder))
        self.assertIn("  0  arg r0, 19", said)
        self.assertIn("rout", said)
        _, said, _ = followed(*SMALL, "--ray", "eye", "--station", "tree,arguments", "--out", str(self.folder))
        self.assertIn("nearest: triangle", said)
        self.assertIn("offset", said)


class Detects(Case):
    """A run with a waveform of only what is read, and what happens when a word of it is another one."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.run_folder = pathlib.Path(cls.temporary.name)
        code, _, complained = followed(*SMALL, "--out", str(cls.run_folder))
        assert code == 0, complained
        cls.lines = list(vcd.lines_of(cls.run_folder / follow.FOLLOWED))
        cls.chip = ports.Chip(vcd.Wave(cls.lines, ports.SIGNALS))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def run_with(self, lines, change=None):
        """Of a run with this waveform."""
        for name in ("report.json", "image.png"):
            shutil.copy(self.run_folder / name, self.folder / name)
        (self.folder / "waves.vcd").write_bytes(b"".join(lines))
        if change is not None:
            change(self.folder)
        return ("--from", str(self.folder), *SMALL, "--out", str(self.folder / "out"))

    def without(self, signal, bit):
        """The waveform in which this bit of a signal of any lane is zero, always."""
        codes = {line.split()[3] for line in self.lines if line.startswith(b"$var") and line.split()[4] == signal}
        for line in self.lines:
            digits, _, code = line.strip().partition(b" ")
            if line.startswith(b"b") and code in codes:
                line = b"b%s %s\n" % (f"{vcd.number(digits[1:]) & ~(1 << bit):b}".encode(), code)
            elif line[:1] == b"1" and line[1:].strip() in codes and bit == 0:
                line = b"0" + line[1:]
            yield line

    def code_of(self, signal):
        return next(line.split()[3] for line in self.lines if line.startswith(b"$var") and line.split()[4] == signal)

    def altered(self, signals, word, other):
        """The waveform in which this word, wherever it stands on one of these buses, is another."""
        codes = {self.code_of(signal) for signal in signals}
        old, new = f"{word:032b}".encode(), f"{other:032b}".encode()
        changed = 0
        for line in self.lines:
            digits, _, code = line.strip().partition(b" ")
            if line.startswith(b"b") and code in codes:
                bits = digits[1:].rjust(-(-len(digits[1:]) // 32) * 32, b"0")
                parts = [bits[at : at + 32] for at in range(0, len(bits), 32)]
                if old in parts:
                    changed += 1
                    line = b"b" + b"".join(new if part == old else part for part in parts) + b" " + code + b"\n"
            yield line
        assert changed, "nothing was altered"

    def ray(self, name):
        return next(ray for ray in self.chip.exports
                    if packages.pixel_of(ray.words[7]) == (5, 2) and packages.name_of(ray.words) == name)  # fmt: skip

    def walk(self, name):
        journey = Journey(self.chip, (5, 2), {})
        return journey.lives[name].walk

    def put(self, name):
        return next(put for put in self.chip.puts
                    if packages.pixel_of(put.words[7]) == (5, 2) and packages.name_of(put.words) == name)  # fmt: skip

    def differs(self, sentence, lines, change=None):
        code, said, complained = followed(*self.run_with(lines, change))
        self.assertEqual(code, 3, said)
        self.assertIn(sentence, complained)

    def test_nothing_where_nothing_is_altered(self):
        code, said, complained = followed(*self.run_with(self.lines))
        self.assertEqual((code, complained), (0, ""))
        self.assertIn(": 0 differ", said)

    def test_a_word_of_a_ray_on_its_way_into_the_pool(self):
        word = self.ray("eye").words[3]
        self.differs("eye: exported, and read by the traverser", self.altered([b"export_data"], word, word ^ 1))

    def test_a_word_of_a_ray_on_its_way_to_the_traverser(self):
        word = self.ray("eye").words[4]
        self.differs("eye: exported, and read by the traverser", self.altered([b"ray_data"], word, word ^ 1))

    def test_a_hit_on_its_way_to_the_unit(self):
        word = self.put("eye").words[12]
        self.differs("eye: put, and imported", self.altered([b"import_beat_data"], word, word ^ 1))

    def test_a_box_that_is_not_met(self):
        visit = self.walk("eye").visits[0]
        self.assertTrue(visit.met)
        self.differs("eye, boxes met: ", self.without(b"met", visit.met[0]))

    def test_another_triangle_at_the_end_of_the_walk(self):
        best = self.walk("eye").best()
        self.differs("eye, triangle of the walk: ", self.altered([b"result_number_i"], best.number, best.number ^ 1))

    def test_a_ray_that_no_lane_is_done_with(self):
        self.refused("is never done in lane", *self.run_with(self.without(b"done_valid_o", 0)))

    def test_a_node_or_triangle_that_nothing_comes_of(self):
        for signal, sentence in ((b"asked", "is never asked for"), (b"boxes_valid", "is never tested"),
                                 (b"result_valid_i", "triangles that lane")):  # fmt: skip
            with self.subTest(signal):
                self.refused(sentence, *self.run_with(self.without(signal, 0)))

    def test_a_wrong_hit_that_all_agree_on(self):
        word = self.put("eye").words[12]
        other = packages.to_word(packages.to_float(word) * 1.001)
        self.differs("eye, t: ", self.altered([b"put_data", b"import_beat_data"], word, other))

    def test_a_wrong_direction_that_all_agree_on(self):
        word = self.ray("eye").words[3]
        everywhere = [b"export_data", b"ray_data", b"put_data", b"import_beat_data"]
        self.differs(
            "eye, direction: ", self.altered(everywhere, word, packages.to_word(packages.to_float(word) + 0.01))
        )

    def test_a_contribution_at_the_frame_buffer(self):
        word = self.put("shadow2").words[8]
        self.differs(
            "shadow2: contributed, and out of the frame port", self.altered([b"frame_color_o"], word, word ^ 1)
        )

    def test_a_picture_of_another_colour(self):
        def repaint(folder):
            rows = picture.read(folder / "image.png")
            rows[2][5] = (1, 2, 3)
            (folder / "image.png").write_bytes(picture.encode(rows))

        self.differs("image.png: (1, 2, 3), but", self.lines, repaint)

    def test_a_report_of_another_run(self):
        def change(folder):
            report = json.loads((folder / "report.json").read_text())
            report["cycles"] += 1
            (folder / "report.json").write_text(json.dumps(report))

        self.differs("cycles of the frame", self.lines, change)

    def test_a_ray_of_no_pixel(self):
        word = self.ray("eye").words[7]
        lines = self.altered([b"export_data"], word, word + 64)
        self.refused("pixel 5,2 has 0 eye rays in the waveform", *self.run_with(lines))

    def test_a_waveform_without_a_signal(self):
        lines = [line.replace(b" launch_valid ", b" launch_invalid ") for line in self.lines]
        self.refused("no signal 'launch_valid' in rtl/chip/rp_chip.v", *self.run_with(lines))

    def test_a_chip_without_a_traverser(self):
        lines = [line.replace(b" gen_inside ", b" gen_outside ") for line in self.lines]
        self.refused("has no traverser inside: draw with chip.traverser=hardware", *self.run_with(lines))

    def test_a_frame_that_never_ends(self):
        times = [number for number, line in enumerate(self.lines) if line.startswith(b"#")]
        self.refused("the frame does not end in the waveform", *self.run_with(self.lines[: times[len(times) // 2]]))

    def test_no_frame_at_all(self):
        times = [number for number, line in enumerate(self.lines) if line.startswith(b"#")]
        self.refused("start_i is never high", *self.run_with(self.lines[: times[10]]))


class Refusals(Case):
    def test_pixels(self):
        self.refused("the picture has 32x24 pixels, numbered from 0", "--pixel", "32,0")
        self.refused("the picture has 8x6 pixels, numbered from 0", "--pixel", "0,6", "--size", "8x6")
        self.refused("give it as X,Y", "--pixel", "middle")

    def test_what_raypool_refuses(self):
        self.refused("sphere.obj", "--scene", "sphere.obj", "--out", str(self.folder))
        self.refused("99w4c", "--config", "99w4c", "--out", str(self.folder))

    def test_names(self):
        self.refused("--station bus: there are launch, ", "--station", "bus")
        self.refused("--ray shadow7: this pixel has eye", "--ray", "shadow7", *SMALL, "--out", str(self.folder))

    def test_folders(self):
        self.refused("report.json: this is not a report", "--from", str(self.folder))
        (self.folder / "report.json").write_text('{"size": {"width": 8, "height": 6}}')
        self.refused("there is neither waves.fst nor waves.vcd", "--from", str(self.folder), *SMALL)
        (self.folder / "waves.fst").write_text("no waveform")
        self.refused("fst2vcd cannot read it", "--from", str(self.folder), *SMALL)

    def test_missing_tools(self):
        with unittest.mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.refused("fst2vcd was not found: install the Debian package gtkwave", "--out", str(self.folder))
        with unittest.mock.patch.dict(os.environ, {"RAYPOOL": str(self.folder / "raypool")}):
            self.refused("was not found: build it with make program", "--out", str(self.folder))

    def test_compact_records(self):
        wave = unittest.mock.Mock()
        wave.constant.return_value = 16
        with self.assertRaisesRegex(FollowError, "compact records of 16 words"):
            ports.Chip(wave)


if __name__ == "__main__":
    os.environ["RAYPOOL"] = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
