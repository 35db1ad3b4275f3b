"""Follows one pixel through the chip in Verilog, from port to port of rtl/chip/rp_chip.v, in a waveform of the frame.

    PYTHONPATH=scripts python3 -m follow [--pixel X,Y] [--scene SCENE] [--config CONFIG] [--out FOLDER] ...

Draws the frame (raypool sim --engine rtl --boundary chip --waves), reads the waveform, prints the journey, draws
pictures of it into FOLDER, and compares all that the host can compute itself. Exit code 1, and a sentence, if the frame
cannot be followed, 3 if something differs. RAYPOOL names the program, BUILD the folder it is in if not.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import sys

from . import packages, picture
from .check import Check
from .errors import FollowError, build, need, run
from .journey import STATIONS, Journey
from .pictures import draw_pictures
from .ports import SIGNALS, Chip
from .scene import HostPixel, Tree, materials_of
from .table import check_lines, journey_lines, last_lines
from .vcd import Wave, followed, lines_of

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ.get("BUILD", "build"))
SCENE, VIEW = "examples/tour.obj", "examples/tour.json"
# A traverser inside the chip, which is as small as can be: it is Verilated with it.
TRAVERSER = ("chip.traverser=hardware chip.hardware_traverser.lanes=2 chip.hardware_traverser.triangle_pipes=1 "
             "chip.hardware_traverser.rays=16 chip.hardware_traverser.cache_banks=2 "
             "chip.hardware_traverser.node_cache_bytes=2048 chip.hardware_traverser.triangle_cache_bytes=2048 "
             "chip.hardware_traverser.node_cache_mshrs=8 "
             "chip.hardware_traverser.triangle_cache_mshrs=8")  # fmt: skip
FOLLOWED = "followed.vcd"  # of the waveform what is read
LOOK = ("view", "camera", "eye", "look-at", "up", "fov", "light", "detail")
MORE = ("arguments", "tree", "host")  # stations that are no steps of a ray


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="follow", description=__doc__.splitlines()[0])
    parser.add_argument("--pixel", default="20,10", metavar="X,Y", help="from 0, y downwards (default: %(default)s)")
    parser.add_argument("--scene", default=SCENE, help="as of raypool sim (default: %(default)s, with its own view)")
    parser.add_argument("--size", default="32x24", metavar="WxH", help="pixels (default: %(default)s)")
    parser.add_argument("--depth", default="2", help="1: eye and shadow rays; more: reflections (default: %(default)s)")
    parser.add_argument("--config", default="4w4c", help="machine (default: %(default)s)")
    parser.add_argument("--set", default="", metavar="FIELDS", help="change further fields of it")
    parser.add_argument("--units", default="1", help="compute units (default: %(default)s)")
    for name in LOOK:
        parser.add_argument(f"--{name}", help="as of raypool sim")
    parser.add_argument("--out", help="folder of waveform, report and pictures (default: build/out/follow)")
    parser.add_argument(
        "--from", dest="run", metavar="FOLDER", help="a run that is there: waves.fst or .vcd, report.json, image.png"
    )
    parser.add_argument("--ray", default="", help="show only these: eye, shadow1, reflection2, ...")
    parser.add_argument("--station", default="", help="show only these: " + ", ".join((*STATIONS, *MORE)))
    options = parser.parse_args(arguments)
    options.stations = options.station.replace(",", " ").split()
    options.rays = options.ray.replace(",", " ").split()
    wrong = [name for name in options.stations if name not in (*STATIONS, *MORE)]
    if wrong:
        raise FollowError(f"--station {wrong[0]}: there are {', '.join((*STATIONS, *MORE))}")
    if not re.fullmatch(r"\d+,\d+", options.pixel):
        raise FollowError(f"--pixel {options.pixel}: give it as X,Y, such as 20,10")
    options.pixel = tuple(map(int, options.pixel.split(",")))
    if options.scene == SCENE:
        options.scene = str(ROOT / SCENE)
        options.view = options.view or str(ROOT / VIEW)
    return options


def check_pixel(pixel, width, height):
    if pixel[0] >= width or pixel[1] >= height:
        raise FollowError(f"--pixel {pixel[0]},{pixel[1]}: the picture has {width}x{height} pixels, numbered from 0")


class Frame:
    """The run: its folder, its report, and the commands that show more of it."""

    def __init__(self, options):
        self.options = options
        self.raypool = os.environ.get("RAYPOOL", str(BUILD / "raypool"))
        if shutil.which(self.raypool) is None:
            raise FollowError(f"{self.raypool} was not found: build it with make program, or name it in RAYPOOL")
        self.look = [f"--{name}={value}" for name in LOOK if (value := getattr(options, name.replace("-", "_")))]
        self.machine = ["--config", options.config, "--set", f"{TRAVERSER} {options.set}".strip()]
        self.folder = pathlib.Path(options.run or options.out or BUILD / "out/follow")
        self.out = pathlib.Path(options.out or BUILD / "out/follow")
        if not options.run:
            size = re.fullmatch(r"(\d+)x(\d+)", options.size)
            if size:
                check_pixel(options.pixel, *map(int, size.groups()))
            need("fst2vcd", "gtkwave")
            build([ROOT / "scripts/unit.sh", *self.machine[1:], "--units", options.units, "--boundary", "chip",
                   "--waves"])  # fmt: skip
        self.tree, self.materials = self.tree_and_materials()
        if not options.run:
            self.draw_once()
        self.report = self.read("report.json")
        self.size = self.report["size"]["width"], self.report["size"]["height"]
        check_pixel(options.pixel, *self.size)

    def draw(self, size, depth, folder, *how):
        run([self.raypool, "sim", self.options.scene, *self.look, "--size", size, "--depth", depth, *self.machine, *how,
             "--out", folder, "--quiet"])  # fmt: skip

    def draw_once(self):
        """The frame and its followed signals, unless they are there, of the same program, hardware and scene."""
        how = (self.options.size, self.options.depth, self.folder, "--engine", "rtl", "--boundary", "chip",
               "--units", self.options.units, "--waves")  # fmt: skip
        stamp, digest = self.folder / "followed.sha256", self.digest(how)
        if stamp.is_file() and stamp.read_text(encoding="utf-8") == digest:
            return
        stamp.unlink(missing_ok=True)
        self.draw(*how)
        with (self.folder / FOLLOWED).open("wb") as file:
            file.writelines(followed(lines_of(self.folder / "waves.fst"), SIGNALS))
        stamp.write_text(digest, encoding="utf-8")

    def digest(self, how):
        """Of all that the waveform depends on."""
        of = hashlib.sha256(repr((how, self.machine, self.look, SIGNALS)).encode())
        units = pathlib.Path(self.raypool).resolve().parent / "units"
        for path in (self.raypool, self.out / "scene.bvh", self.out / "scene.mtl", self.options.view,
                     *sorted(units.glob("*-chip-waves/*.stamp"))):  # fmt: skip
            if path and pathlib.Path(path).is_file():
                of.update(pathlib.Path(path).read_bytes())
        return of.hexdigest()

    def read(self, name):
        try:
            return json.loads((self.folder / name).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise FollowError(f"{self.folder / name}: this is not a report of raypool sim ({error})") from error

    def waveform(self):
        if not self.options.run:
            return Wave(lines_of(self.folder / FOLLOWED), SIGNALS)
        path = next((path for path in (self.folder / "waves.fst", self.folder / "waves.vcd") if path.is_file()), None)
        if path is None:
            raise FollowError(f"{self.folder}: there is neither waves.fst nor waves.vcd")
        return Wave(followed(lines_of(path), SIGNALS), SIGNALS)

    def native(self):
        """The picture that the kernels draw as C++."""
        folder = self.out / "native"
        self.draw("%dx%d" % self.size, self.report["depth"], folder, "--engine", "native")
        return (folder / "image.png").read_bytes()

    def tree_and_materials(self):
        self.out.mkdir(parents=True, exist_ok=True)
        tree, scene = self.out / "scene.bvh", self.out / "scene.obj"
        run([self.raypool, "scene", self.options.scene, *self.look, "--write-bvh", tree, "--write-obj", scene])
        return Tree(tree.read_bytes()), materials_of(scene.with_suffix(".mtl").read_text(encoding="utf-8"))

    def texts(self, entries):
        """The text of each instruction, by its PC."""
        texts = {}
        for entry, kernel in entries.items():
            lines = run([self.raypool, "kernels", kernel, *self.machine]).splitlines()
            listed = [re.fullmatch(r"(.*\S)\s+# (\d+)", line.strip()) for line in lines]
            texts.update({entry + int(found[2]): " ".join(found[1].split()) for found in listed if found})
        return texts


def compare(options, frame, chip, journey, tree, materials):
    """What the host computes beside it."""
    check = Check()
    cycles = frame.report["cycles"]
    check.note("cycles of the frame", chip.wave.cycles, cycles, chip.wave.cycles == cycles)
    offset = packages.to_float(chip.arguments[18])
    host = HostPixel(tree, materials, frame.report["view"], offset, frame.size, frame.report["depth"])
    host.follow(options.pixel)
    check.rays(journey, host)
    image = frame.folder / "image.png"
    check.colour(journey, host, picture.read(image), options.pixel)
    same = image.read_bytes() == frame.native()
    check.note("image.png and that of engine native", "the same" if same else "not the same", "the same", same)
    return check


def main(arguments):
    options = options_of(arguments)
    frame = Frame(options)
    chip = Chip(frame.waveform())
    journey = Journey(chip, options.pixel, frame.texts(chip.entries))
    unknown = [name for name in options.rays if name not in journey.lives]
    if unknown:
        raise FollowError(f"--ray {unknown[0]}: this pixel has {', '.join(journey.lives)}")
    check = compare(options, frame, chip, journey, frame.tree, frame.materials)
    names = draw_pictures(options, frame, chip, journey, frame.tree, frame.materials)
    wrong = journey.mismatches + journey.missing() + check.differ
    lines = [*journey_lines(options, frame, chip, journey, frame.tree), *check_lines(options, check),
             *last_lines(options, frame, journey, check, wrong, names)]  # fmt: skip
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:  # the reader has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    for line in wrong:
        print(f"follow: {line}", file=sys.stderr)
    return 3 if wrong else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except FollowError as error:
        print(f"follow: {error}", file=sys.stderr)
        sys.exit(1)
