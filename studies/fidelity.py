#!/usr/bin/python3
"""One frame at every level of simulation, from the fastest to the hardware: what each takes, and what it is worth.

    studies/fidelity.py [--levels native,model,...] [--runs N] [--out FOLDER] [options of raypool sim]

Prints a table and leaves fidelity.json (docs/use/speed-and-accuracy.md), fidelity.svg and each level's picture and
report in FOLDER. `make fidelity` calls it. RAYPOOL names the program, default raypool in the build folder (BUILD).
"""
import argparse
import contextlib
import json
import math
import os
import pathlib
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import typing
import zlib

from experiments import show
from plots.plot import WIDE, Plot, plain
from plots.style import colour

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = os.environ.get("BUILD", "build")
RAYPOOL = os.path.abspath(os.environ.get("RAYPOOL", os.path.join(BUILD, "raypool")))
INPUT_FAILURE, DIFFERENCE, INTERRUPTED = 1, 3, 130


class Level(typing.NamedTuple):
    """A way to simulate a frame. Nothing else here knows which there are."""

    name: str
    options: tuple  # of raypool sim
    exact: bool = False  # takes the hardware's time: all such levels must agree in all that they count and draw
    verilated: bool = False  # needs the Verilated unit


# From the fastest to the hardware. The last one that runs is the reference of all others.
LEVELS = (
    Level("native", ("--engine", "native")),
    Level("estimate", ("--engine", "estimate")),
    Level("functional", ("--engine", "functional")),
    Level("sampled", ("--engine", "sampled")),
    Level("model", ("--engine", "model"), exact=True),
    Level("rtl", ("--engine", "rtl"), exact=True, verilated=True),
)
HARDWARE = LEVELS[-1].name
# What reports of one frame may have of their own: which engine drew it, and how fast.
OF_THE_RUN = ("command", "engine", "boundary", "hits", "wall_seconds", "simulation_seconds", "simulated_per_second")
# Options of raypool sim that are passed on; those with a default name the folder.
DEFAULTS = {"scene": "room", "config": "8w8c", "units": "1", "size": "200x200", "depth": "3"}
OTHERS = ("set", "traverser", "view", "camera", "eye", "look-at", "up", "fov", "light", "detail", "shaders",
          "samples")  # fmt: skip


class FidelityError(Exception):
    """A sentence for the user, and the exit code."""

    def __init__(self, sentence, code=INPUT_FAILURE):
        super().__init__(sentence)
        self.code = code


class Failed(Exception):
    """A program that was called failed, and has said why."""


class Run:
    """A level of the frame, as it was drawn."""

    def __init__(self, level):
        self.level = level
        self.report = None
        self.walls = []  # seconds, a run each
        self.drawings = []
        self.picture = None  # against the reference

    def add(self, wall, report):
        self.walls.append(wall)
        self.drawings.append(report["simulation_seconds"])
        if self.report is None:
            self.report = report
        elif what := differences(self.report, report):
            raise FidelityError(f"{self.level.name}: run {len(self.walls)} is not as run 1 was: {what}", DIFFERENCE)


# Reports


def flat(value, prefix=""):
    """{'alus.int.utilisation': 0.5, ...}"""
    if not isinstance(value, dict):
        return {prefix[:-1]: value}
    return {name: inner for key, part in value.items() for name, inner in flat(part, f"{prefix}{key}.").items()}


def differences(report, other):
    """'' when two reports count the same, else what differs first."""
    a, b = (flat({key: part for key, part in each.items() if key not in OF_THE_RUN}) for each in (report, other))
    names = [name for name in {**a, **b} if a.get(name) != b.get(name)]
    said = ", ".join(f"{name} {a.get(name)} and {b.get(name)}" for name in names[:3])
    return said + (f", and {len(names) - 3} more" if len(names) > 3 else "")


def utilisations(report):
    """({ALU: share}, {port: share}); what the level does not know is None or left out."""
    if estimates := report.get("sampled") or report.get("estimated"):
        return tuple({name.replace("_", " "): interval["value"] for name, interval in estimates[kind].items()}
                     for kind in ("alus", "ports"))  # fmt: skip
    alus = {name: alu["utilisation"] for name, alu in report.get("alus", {}).items()}
    ports = {name.removesuffix("_utilisation").removeprefix("pools.").replace("_", " ").replace(".", " "): share
             for name, share in flat(report).items() if name.endswith("port_utilisation")}
    return alus, ports


def compare_pictures(name, folder, reference):
    """(picture, criterion) of `raypool compare`: that of `folder`, which is called `name`, against the reference's."""
    done = subprocess.run([RAYPOOL, "compare", reference, folder, "--json"], text=True, stdout=subprocess.PIPE,
                          check=False)  # fmt: skip
    if done.returncode != 0:
        raise Failed(done.returncode)
    comparison = json.loads(done.stdout)
    picture = comparison["picture"]
    if not picture.pop("compared"):
        raise FidelityError(f"{name}: the picture cannot be compared: {picture['reason']}", DIFFERENCE)
    return picture, comparison["criterion"]


# Drawing


def say(text):
    print(text, file=sys.stderr, flush=True)


def call(*command):
    """For what it does; what it prints is progress."""
    environment = {**os.environ, "RAYPOOL": RAYPOOL}
    code = subprocess.run(command, env=environment, stdout=sys.stderr, check=False).returncode
    if code != 0:
        raise Failed(code if code > 0 else 128 - code)


def draw(level, options, folder):
    """(seconds of the whole command, report)"""
    command = [RAYPOOL, "sim", *options, *level.options, "--out", folder / level.name]
    begin = time.perf_counter()
    code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
    wall = time.perf_counter() - begin
    if code < 0:
        raise FidelityError(f"level {level.name} was ended by signal {-code}", 128 - code)
    if code != 0:
        raise Failed(code)
    with open(folder / level.name / "report.json", encoding="utf-8") as file:
        return wall, json.load(file)


def draw_all(levels, arguments, options, folder):
    """Each level as often as asked for, in turn, so that what else the machine does meets all of them alike."""
    runs = {level.name: Run(level) for level in levels}
    for number in range(1, arguments.runs + 1):
        for level in levels:
            if level.verilated and number == 1:
                call(ROOT / "scripts/unit.sh", arguments.config, "--units", arguments.units,
                     *(["--set", arguments.set] if arguments.set else []))
            name = level.name + (f", run {number} of {arguments.runs}" if arguments.runs > 1 else "")
            say(f"fidelity: {name} begins")
            wall, report = draw(level, options, folder)
            runs[level.name].add(wall, report)
            cycles = "" if report["cycles"] is None else f", {report['cycles']} cycles"
            say(f"fidelity: {name} ends after {wall:.2f} s{cycles}")
    return list(runs.values())


def check_exact(runs, reference, out, folder):
    """Those that take the hardware's time agree with the reference, or what they drew is kept to be looked at."""
    for run in runs:
        if run is reference or not (run.level.exact and reference.level.exact):
            continue
        what = differences(reference.report, run.report)
        if not what and run.picture["differ"]:
            what = f"{run.picture['differ']} of {run.picture['pixels']} pixels"
        if what:
            kept = out / "different"
            shutil.rmtree(kept, ignore_errors=True)
            kept.mkdir()
            for each in (reference, run):
                (folder / each.level.name).rename(kept / each.level.name)
            raise FidelityError(f"{reference.level.name} and {run.level.name} differ: {what}; raypool compare "
                                f"{kept / reference.level.name} {kept / run.level.name} shows all", DIFFERENCE)


# Figures


def times(seconds):
    return {"median": statistics.median(seconds), "least": min(seconds), "most": max(seconds), "runs": seconds}


def relative(value, reference):
    return None if value is None or not reference else value / reference - 1


def minus(shares, reference):
    """{name: {"utilisation", "error"}}; the error in shares of 1, where both know it."""
    return {name: {"utilisation": share, "error": None if None in (share, reference.get(name))
                   else share - reference[name]} for name, share in shares.items()}  # fmt: skip


def figures(run, reference, base):
    report, true = run.report, reference.report if reference.level.exact else {}
    wall = times(run.walls)
    cycles = report["cycles"]
    alus, ports = utilisations(report)
    true_alus, true_ports = utilisations(true)
    return {
        "level": run.level.name,
        "wall_seconds": wall,
        "simulation_seconds": times(run.drawings),
        "speed_up": statistics.median(base.walls) / wall["median"],
        "rays_per_second": report["rays"] / wall["median"],
        "cycles_per_second": None if cycles is None else cycles / wall["median"],
        "rays": report["rays"],
        "cycles": cycles,
        "cycles_error": relative(cycles, true.get("cycles")),
        "mrays_per_second": report["mrays_per_second"],
        "mrays_per_second_error": relative(report["mrays_per_second"], true.get("mrays_per_second")),
        "alus": minus(alus, true_alus),
        "ports": minus(ports, true_ports),
        "picture": run.picture,
    }


def shaders_of(report):
    """What of the set is found in the results; nothing of the built-in kernels."""
    shaders = report.get("shaders")
    return {"shaders": {name: shaders[name] for name in ("folder", "samples")}} if shaders else {}


def summary(runs, reference, base):
    report = reference.report
    return {
        "raypool": report["raypool"],
        "command": sys.argv,
        **{name: report[name] for name in ("scene", "size", "depth", "config", "units", "traverser")},
        **shaders_of(report),
        "reference": reference.level.name,
        "speed_up_over": base.level.name,
        "levels": [figures(run, reference, base) for run in runs],
    }


# The table


def title(found):
    """'room, 331494 triangles, 320x320, depth 3, 8w8c, 1 compute unit'"""
    units, shaders = found["units"], found.get("shaders")
    drawn = f", {shaders['folder']}" if shaders else ""
    if shaders and shaders["samples"] > 1:
        drawn += f" with {shaders['samples']} samples"
    return (f"{found['scene']['name']}, {found['scene']['triangles']} triangles, {found['size']['width']}x"
            f"{found['size']['height']}, depth {found['depth']}, {found['config']}, {units} compute unit"
            f"{'s' if units > 1 else ''}{drawn}")


def cell(value, form, scale=1):
    return "-" if value is None else form.format(scale * value)


def error_cell(error, form, is_reference=False):
    if is_reference and error is not None:
        return "reference"
    return "exact" if error == 0 else cell(error, form, 100)


def picture_cell(picture, is_reference):
    if is_reference:
        return "reference"
    if picture["differ"] == 0:
        return "equal"
    return f"{picture['differ']} pixels differ, by {picture['largest_difference']} at most"


def print_tables(found):
    repeated = len(found["levels"][0]["wall_seconds"]["runs"])
    print(title(found) + (f"; medians of {repeated} runs" if repeated > 1 else ""))
    header = ["level", "   wall s", *(["  spread"] if repeated > 1 else []), "drawing s",
              f"speed-up over {found['speed_up_over']}", "krays/s", "kcycles/s", "cycles", "error",
              "Mrays/s", "picture"]  # fmt: skip
    speeds, uses = [header], []
    for row in found["levels"]:
        wall, is_reference = row["wall_seconds"], row["level"] == found["reference"]
        spread = 100 * (wall["most"] - wall["least"]) / wall["median"]
        speeds.append([
            row["level"], f"{wall['median']:.2f}", *([f"{spread:.0f}%"] if repeated > 1 else []),
            f"{row['simulation_seconds']['median']:.2f}", f"{row['speed_up']:.1f}",
            cell(row["rays_per_second"], "{:.1f}", 1e-3), cell(row["cycles_per_second"], "{:.1f}", 1e-3),
            cell(row["cycles"], "{}"), error_cell(row["cycles_error"], "{:+.2f}%", is_reference),
            cell(row["mrays_per_second"], "{:.2f}"), picture_cell(row["picture"], is_reference),
        ])  # fmt: skip
        columns = {**row["alus"], **row["ports"]}
        uses.append([row["level"], *(cell(use["utilisation"], "{:.1f}%", 100) for use in columns.values())])
        if not is_reference and any(use["error"] is not None for use in columns.values()):
            uses.append(["  error, points", *(error_cell(use["error"], "{:+.2f}") for use in columns.values())])
    show(speeds[0], speeds[1:])
    print()
    names = next(([*row["alus"], *row["ports"]] for row in reversed(found["levels"]) if row["ports"]), [])
    if names:
        show(["utilisation", *names], [line + ["-"] * (1 + len(names) - len(line)) for line in uses])
        print()


# The plot


def nice(value):
    """The next of 1, 2, 5, 10, ... that is not below."""
    step = 1
    while True:
        for factor in (1, 2, 5):
            if step * factor >= value:
                return step * factor
        step *= 10


def plot(found, svg):
    """A point a level: its wall time against its error in cycles; a column at the right for what has no cycles."""
    known = [abs(100 * row["cycles_error"]) for row in found["levels"] if row["cycles_error"] is not None]
    most = nice(max([1, *known]))
    beyond = 1.3 * most
    points = []
    for row in found["levels"]:
        x = beyond if row["cycles_error"] is None else abs(100 * row["cycles_error"])
        wall = row["wall_seconds"]
        points.append((x, wall["median"], wall["least"], wall["most"], f"{row['level']}, {row['speed_up']:.1f} x"))
    drawn = Plot(330, WIDE)
    axes = drawn.axes
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    low = 10 ** math.floor(math.log10(min(point[2] for point in points)))
    high = 10 ** math.ceil(math.log10(max(point[3] for point in points) * 1.1))
    tics = {0: "exact", **{most * part / 4: f"{most * part / 4:g}%" for part in range(1, 5)}}
    if len(known) < len(points):
        tics[beyond] = "no cycles"
        axes.axvline(1.12 * most, color=colour("muted"), linestyle="--", linewidth=0.8)
    # Names of points that lie close together move apart: a line of text is a twentieth of the axis.
    line = (high / low) ** (1 / 20)
    heights = []
    for x, y, least, longest, text in sorted(points, key=lambda point: point[1]):
        axes.errorbar([x], [y], [[y - least], [longest - y]], color=colour("accent"), marker="o", capsize=3)
        while any(near < y * line and y < near * line for at, near in heights if abs(at - x) < most / 3):
            y *= line ** 0.25
        heights.append((x, y))
        axes.annotate(plain(text), (x, y), (9, 0), textcoords="offset points", va="center")
    axes.set_xticks(list(tics), list(tics.values()))
    axes.set_xlim(-0.08 * most, (1.75 if len(known) < len(points) else 1.4) * most)
    axes.set_ylim(low, high)
    axes.set_xlabel("error in cycles")
    axes.set_ylabel("wall time of the whole command, s")
    drawn.title(title(found), f"beside each level: speed-up over {found['speed_up_over']}")
    drawn.save(svg, "Wall time of each level against its error in cycles")


# The command


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise FidelityError(message)


def positive(text):
    if not re.fullmatch(r"0*[1-9]\d{0,2}", text):
        raise argparse.ArgumentTypeError(f"'{text}' must be from 1 to 999")
    return int(text)


def chosen_levels(text):
    names = [level.name for level in LEVELS]
    wanted = text.replace(",", " ").split()
    for name in wanted:
        if name not in names:
            raise argparse.ArgumentTypeError(f"'{name}' is not a level; there are {', '.join(names)}")
    if not wanted:
        raise argparse.ArgumentTypeError(f"no level is named; there are {', '.join(names)}")
    return [level for level in LEVELS if level.name in wanted]


def parser():
    options = Parser(prog="fidelity", description=__doc__.splitlines()[0], allow_abbrev=False)
    names = ",".join(level.name for level in LEVELS)
    options.add_argument("--levels", type=chosen_levels,
                         help=f"default: {names}; of shader sets, those that know them")  # fmt: skip
    options.add_argument("--runs", type=positive, default=1, help="times that each level draws; medians are printed")
    options.add_argument("--out", help="folder (default: build/fidelity/ and the frame's name)")
    for name in (*DEFAULTS, *OTHERS):
        default = DEFAULTS.get(name)
        options.add_argument(f"--{name}", default=default, help="of raypool sim" + (f": {default}" if default else ""))
    return options


def frame(arguments):
    """The options of raypool sim, and a name for the folder: two frames that differ have two."""
    given = {name: vars(arguments)[name.replace("-", "_")] for name in (*DEFAULTS, *OTHERS)}
    options = [f"--{name}={value}" for name, value in given.items() if value is not None]
    scene, config = (pathlib.Path(given[name]).stem for name in ("scene", "config"))
    name = f"{scene}-{config}-{given['units']}cu-{given['size']}-depth{given['depth']}"
    shown = {"scene": scene, "config": config, **{field: given[field] for field in ("units", "size", "depth")}}
    if rest := [f"{field}={value}" for field, value in given.items() if value not in (None, shown.get(field))]:
        name += f"-{zlib.crc32(' '.join(rest).encode(errors='surrogateescape')):08x}"
    return options, name.replace("/", "_")


def publish(levels, out, folder):
    """All of it at its place, in a moment that nothing interrupts."""
    old = folder / "old"
    old.mkdir()
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, signal.SIG_IGN)
    for level in levels:
        with contextlib.suppress(FileNotFoundError):
            (out / level.name).rename(old / level.name)
        (folder / level.name).rename(out / level.name)
    shutil.rmtree(out / "different", ignore_errors=True)
    for name in ("fidelity.svg", "fidelity.json"):
        (folder / name).replace(out / name)
    print(f"wrote {out}/fidelity.json, fidelity.svg, and of each level image.png and report.json")


def measure(arguments, options, out, folder):
    """In `folder`, a new one in `out`."""
    unknown = (["estimate"] if arguments.shaders else []) + (["sampled"] if arguments.samples else [])
    levels = arguments.levels or [level for level in LEVELS if level.name not in unknown]
    runs = draw_all(levels, arguments, options, folder)
    reference = runs[-1]
    slowest = max(runs, key=lambda run: statistics.median(run.walls))
    base = next((run for run in runs if run.level.name == HARDWARE), slowest)
    for run in runs[:-1]:
        name = run.level.name
        run.picture, _ = compare_pictures(name, folder / name, folder / reference.level.name)
    check_exact(runs, reference, out, folder)
    found = summary(runs, reference, base)
    with open(folder / "fidelity.json", "w", encoding="utf-8") as file:
        json.dump(found, file, indent=2)
        file.write("\n")
    plot(found, folder / "fidelity.svg")
    print_tables(found)
    publish(levels, out, folder)


def run_study(study, arguments, measured):
    """Calls measured(arguments, options of the frame, folder of the results, a temporary folder in it). A folder that
    was made for the results is removed if none came into it."""
    if not os.access(RAYPOOL, os.X_OK):
        raise FidelityError(f"{RAYPOOL} was not found: make {study} builds it, or RAYPOOL names one")
    options, name = frame(arguments)
    out = pathlib.Path(arguments.out or os.path.join(BUILD, study, name))
    made = not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
        temporary = tempfile.TemporaryDirectory(dir=out, prefix=f".{study}-")
    except OSError as error:
        raise FidelityError(f"the folder {out} cannot be written: {error.strerror}") from error
    try:
        with temporary as folder:
            measured(arguments, options, out, pathlib.Path(folder))
    finally:
        if made:
            with contextlib.suppress(OSError):
                out.rmdir()


def main():
    def interrupt(*_):
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupt)
    try:
        run_study("fidelity", parser().parse_args(), measure)
    except FidelityError as error:
        say(f"fidelity: {error}")
        return error.code
    except Failed as error:
        return error.args[0]
    except (OSError, subprocess.CalledProcessError) as error:
        say(f"fidelity: {error}")
        return INPUT_FAILURE
    except KeyboardInterrupt:
        say("\nfidelity: interrupted; earlier results are as they were")
        return INTERRUPTED
    return 0


if __name__ == "__main__":
    sys.exit(main())
