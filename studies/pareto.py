#!/usr/bin/python3
"""Area of the unit against error of the picture: a frame on machines of several arithmetic modes, whole and fitted.

    studies/pareto.py [--machines "24 20-flush-newton1 24-fit ..."] [--no-area] [--out FOLDER] [options of raypool sim]

Each picture is held against the frame in double precision, that of a shader set against that of the full machine.
Prints a table and leaves pareto.json (docs/use/speed-and-accuracy.md), pareto.svg, and in machines/ each machine's
picture and the configuration of those that were fitted, in FOLDER. `make pareto` calls it. RAYPOOL names the program,
default raypool in the build folder (BUILD).
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
import subprocess
import sys
import typing

import fidelity
from experiments import show
from fidelity import INPUT_FAILURE, INTERRUPTED, RAYPOOL, Failed, FidelityError, say
from plots.plot import Plot, legend, plain
from plots.style import colour
import synth.fit
from synth.errors import SynthError

# What a designer chooses among. Of whether subnormal numbers may be left out altogether a fit decides.
MACHINES = (
    "24 24-newton2 24-flush 24-flush-newton1 24-flush-newton0 20 20-flush-newton1 18-flush-newton1 16 "
    "16-flush-newton1 16-flush-newton0 14-flush-newton1 13 13-flush-newton1 12-flush-newton1 11 11-flush-newton0 "
    "24-fit smallest-fit"
).split()
# The fit of the smallest machine with a picture that passes, whichever that turns out to be.
SMALLEST_FIT = "smallest-fit"
SUBNORMALS, SLOW_UNIT = "subnormals", "slow_unit"
# What all pictures are held against: of the built-in kernels, of shader sets.
REFERENCES = ("double precision", "full single precision")
REFERENCE = "reference"  # its folder


class Machine(typing.NamedTuple):
    """An arithmetic, and whether the machine has only what the frame needs."""

    name: str
    fields: tuple  # "arithmetic.significand=20", ...: all four
    fitted: bool = False


class Row:
    """A machine, and what has come out of it."""

    def __init__(self, machine):
        self.machine = machine
        self.report = None
        self.picture = self.criterion = None  # against the reference; what makes it pass, as raypool compare prints it
        self.area = None

    @property
    def off(self):
        """Share of the pixels."""
        return self.picture["off_by_more"]

    @property
    def passes(self):
        return self.off <= self.criterion["most_off"]


# Machines


def arithmetic():
    """Values of each field, as the schema of configurations has them; the first is that of the full machine."""
    with open(fidelity.ROOT / "schemas/configuration.json", encoding="utf-8") as file:
        fields = json.load(file)["properties"]["arithmetic"]["properties"]
    bits = fields["significand"]
    return {"significand": [str(value) for value in range(bits["maximum"], bits["minimum"] - 1, -1)],
            SUBNORMALS: fields[SUBNORMALS]["enum"], SLOW_UNIT: fields[SLOW_UNIT]["enum"],
            "fma": ["false", "true"]}  # fmt: skip


def machine_of(name):
    """The machine that a name of BITS[-SUBNORMALS][-SLOW_UNIT][-fma][-fit] means."""
    values = arithmetic()
    bits, *words = name.split("-")
    fitted = words[-1:] == ["fit"]
    words = words[:-1] if fitted else words
    chosen = {field: names[0] for field, names in values.items()}
    if bits not in values["significand"]:
        raise FidelityError(f"'{name}' is not a machine: it begins with the bits of a significand, "
                            f"{values['significand'][-1]} to {values['significand'][0]}")
    chosen["significand"] = bits
    of_word = {"fma": ("fma", "true"), **{word: (field, word) for field in (SLOW_UNIT, SUBNORMALS)
                                          for word in values[field][1:]}}  # fmt: skip
    for word in words:
        if word not in of_word:
            raise FidelityError(f"'{name}' is not a machine: '{word}' is none of {', '.join(of_word)}, with fit at its "
                                "end")  # fmt: skip
        field, value = of_word.pop(word)
        of_word = {word: of for word, of in of_word.items() if of[0] != field}
        chosen[field] = value
    return Machine(name, tuple(f"arithmetic.{field}={value}" for field, value in chosen.items()), fitted)


def chosen_machines(text):
    """Names, each once, without the full machine, which is always there."""
    names = list(dict.fromkeys(text.replace(",", " ").split() if text else MACHINES))
    if not names:
        raise FidelityError("no machine is named: 24 20-flush 16-newton1-fit ...")
    for name in names:
        if name != SMALLEST_FIT:
            machine_of(name)
    return [name for name in names if name != full().name]


def full():
    return machine_of(arithmetic()["significand"][0])


# Pictures and areas


def call(*command):
    """Its output is progress."""
    code = subprocess.run([RAYPOOL, *command], stdout=sys.stderr, check=False).returncode
    if code != 0:
        raise Failed(code if code > 0 else 128 - code)


def run_sim(options, out):
    code = subprocess.run([RAYPOOL, "sim", *options, "--quiet", "--out", out], stdout=subprocess.DEVNULL,
                          check=False).returncode  # fmt: skip
    if code != 0:
        raise Failed(code if code > 0 else 128 - code)


def without(options, *names):
    return [word for word in options if not word.startswith(tuple(f"--{name}=" for name in names))]


def reference_of(arguments):
    return REFERENCES[bool(arguments.shaders)]


def draw_reference(arguments, options, folder):
    """In double precision it has neither arithmetic nor hits of a machine."""
    say(f"pareto: {reference_of(arguments)}: drawing")
    how = ([*options, *(f"--set={field}" for field in full().fields)] if arguments.shaders else
           [*without(options, "set", "traverser"), "--precision", "double"])  # fmt: skip
    run_sim([*how, "--engine", "native"], folder / "drawn" / REFERENCE)


def draw(row, options, folder):
    """The frame by the machine's own code, so that what it must not meet, such as a subnormal number, is detected."""
    name, fields = row.machine.name, [f"--set={field}" for field in row.machine.fields]
    out = folder / "drawn" / name
    if row.machine.fitted:
        say(f"pareto: {name}: what the frame needs of it")
        config = folder / "machines" / f"{name}.json"
        call("fit", *options, *fields, "--quiet", "--out", config)
        # Its own name is that of a file that the user may take elsewhere.
        options = without(options, "config", "set", "traverser")
        fields = [f"--config={config}"]
    say(f"pareto: {name}: drawing")
    run_sim([*options, *fields, "--engine", "functional"], out)
    with open(out / "report.json", encoding="utf-8") as file:
        row.report = json.load(file)
    row.picture, row.criterion = fidelity.compare_pictures(name, out, folder / "drawn" / REFERENCE)
    shutil.copy(out / "image.png", folder / "machines" / f"{name}.png")


def measure(row, jobs):
    say(f"pareto: {row.machine.name}: area")
    row.area = synth.fit.area(row.report["configuration"], jobs)


def smallest(rows):
    """Of those that pass the one with the least logic, or None."""
    return min((row for row in rows if row.passes), key=lambda row: row.area["logic_kge"], default=None)


def front(points):
    """Of (area, share of pixels that are off) those that no other is better than in one and as good in both."""
    return [point for point in points
            if not any(other[0] <= point[0] and other[1] <= point[1] and other[:2] != point[:2] for other in points)]


# What it leaves


def summary(rows, arguments):
    report = rows[0].report
    # A fitted machine draws less than a whole one: each competes with its like.
    kinds = [[row for row in rows if row.machine.fitted == fitted] for fitted in (False, True)]
    best = [{(row.area["logic_kge"], row.off) for row in kind} for kind in kinds] if arguments.area else []
    best = [set(front(points)) for points in best]
    least = [smallest(kind) for kind in kinds] if arguments.area else [None, None]
    return {
        "raypool": report["raypool"],
        "command": sys.argv,
        **{name: report[name] for name in ("scene", "size", "depth", "units")},
        **fidelity.shaders_of(report),
        "config": pathlib.Path(arguments.config).stem,
        "reference": reference_of(arguments),
        "criterion": rows[0].criterion,
        "smallest": least[0] and least[0].machine.name,
        "smallest_fitted": least[1] and least[1].machine.name,
        "machines": [{
            "machine": row.machine.name,
            "configuration": row.report["configuration"],
            "fitted": row.machine.fitted,
            "picture": row.picture,
            "passes": row.passes,
            "area": None if row.area is None else {key: row.area[key] for _, key, _ in synth.fit.FIGURES},
            "pareto": bool(best) and (row.area["logic_kge"], row.off) in best[row.machine.fitted],
        } for row in rows],
    }  # fmt: skip


def criterion_words(found):
    """'at most 1% of the pixels off by 2 or more'"""
    criterion = found["criterion"]
    return f"at most {100 * criterion['most_off']:g}% of the pixels off by {criterion['off_by']} or more"


def print_table(found):
    rows = found["machines"]
    with_area = rows[0]["area"] is not None
    print(f"{fidelity.title(found)}, against {found['reference']}")
    header = ["machine", *(["logic kGE", "less", "memory bits"] if with_area else []),
              f"off by {found['criterion']['off_by']}+", "pixels differ", "largest of 255", "dB",
              *(["Pareto"] if with_area else [])]  # fmt: skip
    lines = []
    for row in sorted(rows, key=lambda row: -row["area"]["logic_kge"] if with_area else 0):
        area, picture = row["area"], row["picture"]
        cells = [row["machine"]]
        if with_area:
            less = 1 - area["logic_kge"] / rows[0]["area"]["logic_kge"]
            cells += [f"{area['logic_kge']:.1f}", f"{100 * less:.1f}%", str(area["memory_bits"])]
        cells += [f"{100 * picture['off_by_more']:.3f}%", str(picture["differ"]), str(picture["largest_difference"]),
                  "equal" if picture["psnr"] is None else f"{picture['psnr']:.1f}"]  # fmt: skip
        lines.append(cells + (["*" if row["pareto"] else ""] if with_area else []))
    show(header, lines)
    if with_area:
        kge = {row["machine"]: f"{row['machine']}, {row['area']['logic_kge']:.1f} kGE" for row in rows}
        least, fitted = found["smallest"], found["smallest_fitted"]
        print(f"smallest with {criterion_words(found)}: {kge[least] if least else 'none'}"
              f"{'; fitted ' + kge[fitted] if fitted else ''}")


# The plot

WIDTH, HEIGHT = 900, 560
# The axes' box, as shares of the picture.
LEFT, RIGHT, BOTTOM, TOP = 0.08, 0.98, 0.11, 0.88
LETTER, LINE = 6.6, 14  # pixels of a letter and of a line of labels
KEY_WIDTH, KEY_HEIGHT = 380, 84  # of the lines that explain, in the corner at the right and below


def boxes_overlap(one, other):
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def candidates(x, y, width):
    """Boxes (left, bottom, right, top) for a name, the nearest to its point first."""
    for distance in range(9, 200, 8):
        yield (x - distance - width, y - LINE / 2, x - distance, y + LINE / 2)
        yield (x + distance, y - LINE / 2, x + distance + width, y + LINE / 2)
        for up in (1, -1):
            middle = y + up * (distance + LINE / 2)
            for shift in (0, 0.5, -0.5):
                centre = x + shift * width
                yield (centre - width / 2, middle - LINE / 2, centre + width / 2, middle + LINE / 2)


def place(points, taken, width, height):
    """[(x, y, name)] in pixels to a box for each name, which lies on no other, on no point and on no box of `taken`."""
    marks = [*taken, *((x - 6, y - 6, x + 6, y + 6) for x, y, _ in points)]
    placed = []
    for x, y, name in points:
        for box in candidates(x, y, LETTER * len(name) + 4):
            inside = box[0] >= 2 and box[1] >= 2 and box[2] <= width and box[3] <= height
            if inside and not any(boxes_overlap(box, other) for other in [*placed, *marks]):
                break
        else:
            raise FidelityError(f"pareto.svg has no place for the name {name}: draw fewer machines")
        placed.append(box)
    return placed


def decades(share):
    """Height of a share of the pixels in the plot: 0 for all of them, 2 for 1%; of none it is not known."""
    return -math.log10(share)


def plot(found, svg):
    """The axis of errors is logarithmic, the best above; pictures with no pixel off lie above all others, with room for
    names around them."""
    rows = found["machines"]
    limit = decades(found["criterion"]["most_off"])
    known = [limit, *(decades(row["picture"]["off_by_more"]) for row in rows if row["picture"]["off_by_more"])]
    worst = math.floor(min(known) - 0.3)
    none = math.ceil(max(known)) + 1
    best = none + 1
    areas = [row["area"]["logic_kge"] for row in rows]
    span = max(max(areas) - min(areas), 1)
    low, high = min(areas) - 0.08 * span, max(areas) + 0.08 * span
    width, height = WIDTH * (RIGHT - LEFT), HEIGHT * (TOP - BOTTOM)
    points = []
    for row in sorted(rows, key=lambda row: not row["pareto"]):  # those on the front get the best places
        off = row["picture"]["off_by_more"]
        points.append((row, row["area"]["logic_kge"], decades(off) if off else none))
    at = [(width * (x - low) / (high - low), height * (y - worst) / (best - worst), row["machine"])
          for row, x, y in points]  # fmt: skip
    drawn = Plot(HEIGHT, WIDTH)
    drawn.figure.set_layout_engine("none")
    axes = drawn.axes
    axes.set_position((LEFT, BOTTOM, RIGHT - LEFT, TOP - BOTTOM))
    axes.set_xlim(low, high)
    axes.set_ylim(worst, best)
    line = height * (limit - worst) / (best - worst)
    steps = sorted((x, y) for (row, _, _), (x, y, _) in zip(points, at) if row["pareto"] and not row["fitted"])
    taken = [(width - KEY_WIDTH, 0, width, KEY_HEIGHT), (0, line, width, line)]
    for (x, y), (next_x, next_y) in zip(steps, steps[1:]):  # the front: to the right, then up
        taken += [(x, y, next_x, y), (next_x, y, next_x, next_y)]
    for (row, _, _), (x, y, name), box in zip(points, at, place(at, taken, width, height)):
        middle = ((box[0] + box[2]) / 2 / width, (box[1] + box[3]) / 2 / height)
        axes.text(*middle, plain(name), transform=axes.transAxes, ha="center", va="center",
                  color=colour("accent" if row["pareto"] else "muted"))  # fmt: skip
        near = (min(max(x, box[0]), box[2]), min(max(y, box[1]), box[3]))
        if math.dist((x, y), near) > 14:
            axes.plot([x / width, near[0] / width], [y / height, near[1] / height], transform=axes.transAxes,
                      color=colour("registers"), linewidth=0.5)  # fmt: skip
    axes.axhline(limit, color=colour("flt"), linestyle="--", linewidth=1, label=f"above: {criterion_words(found)}")

    def some(words, name, mark, wanted, **style):
        axes.plot(*zip(*[(x, y) for row, x, y in points if wanted(row)] or [(math.nan, math.nan)]), mark, label=words,
                  color=colour(name), zorder=3, **style)  # fmt: skip

    optimal = sorted((x, y) for row, x, y in points if row["pareto"] and not row["fitted"])
    axes.step(*zip(*optimal or [(math.nan, math.nan)]), where="post", color=colour("s1"), linewidth=1.2, zorder=2)
    some("another is smaller and as good", "muted", "o", lambda row: not row["pareto"] and not row["fitted"],
         markerfacecolor=colour("paper"))  # fmt: skip
    some("Pareto-optimal", "accent", "o", lambda row: row["pareto"] and not row["fitted"])
    some("fitted to the frame", "mem", "s", lambda row: row["fitted"])
    ticks = range(max(worst, 0), none + 1)
    axes.set_yticks(ticks, [*(f"{100 * 10**-tick:g}%" for tick in ticks[:-1]), "none"])
    axes.set_xlabel("logic, kGE")
    axes.set_ylabel(f"pixels off by {found['criterion']['off_by']} or more")
    legend(axes, loc="lower right")
    drawn.title(fidelity.title(found),
                f"logic of the unit against pixels that differ from {found['reference']}")
    drawn.save(svg, "Logic of the unit against the pixels of its picture that are off")


# The command


def positive(text):
    if not re.fullmatch(r"0*[1-9]\d{0,2}", text):
        raise argparse.ArgumentTypeError(f"'{text}' must be from 1 to 999")
    return int(text)


def parser():
    options = fidelity.Parser(prog="pareto", description=__doc__.splitlines()[0], allow_abbrev=False)
    options.add_argument("--machines", help="names of BITS[-flush][-newtonN][-fma][-fit]")
    options.add_argument("--no-area", dest="area", action="store_false", help="pictures only: no synthesis, no plot")
    options.add_argument("--jobs", type=positive, default=os.cpu_count() or 1, help="blocks that are mapped at a time")
    options.add_argument("--out", help="folder (default: build/pareto/ and the frame's name)")
    for name in (*fidelity.DEFAULTS, *fidelity.OTHERS):
        default = fidelity.DEFAULTS.get(name)
        options.add_argument(f"--{name}", default=default, help="of raypool sim" + (f": {default}" if default else ""))
    return options


def publish(out, folder, names):
    """All of it at its place, in a moment that nothing interrupts."""
    old = folder / "old"
    old.mkdir()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    for name in ("machines", "pareto.svg", "pareto.json"):
        with contextlib.suppress(FileNotFoundError):
            (out / name).rename(old / name)
    for name in names:
        (folder / name).rename(out / name)
    print(f"wrote {out}/{', '.join(names[1:])}, and each machine's picture in machines/")


def compare_machines(arguments, options, out, folder):
    """In `folder`, a new one in `out`."""
    wanted = chosen_machines(arguments.machines)
    if arguments.samples:
        # The kernels of several frames hold more than those of one, which fit looks at.
        if arguments.machines and any(name.endswith("fit") for name in wanted):
            raise FidelityError("a machine is fitted to one frame: leave --samples or the machines with -fit out")
        wanted = [name for name in wanted if not name.endswith("fit")]
    (folder / "machines").mkdir()
    draw_reference(arguments, options, folder)
    rows = [Row(machine) for machine in (full(), *(machine_of(name) for name in wanted if name != SMALLEST_FIT))]
    for row in rows:
        draw(row, options, folder)
    if arguments.area:
        for row in rows:
            measure(row, arguments.jobs)
        best = smallest([row for row in rows if not row.machine.fitted])
        if SMALLEST_FIT in wanted and best and f"{best.machine.name}-fit" not in (row.machine.name for row in rows):
            rows.append(Row(machine_of(f"{best.machine.name}-fit")))
            draw(rows[-1], options, folder)
            measure(rows[-1], arguments.jobs)
    found = summary(rows, arguments)
    with open(folder / "pareto.json", "w", encoding="utf-8") as file:
        json.dump(found, file, indent=2)
        file.write("\n")
    if arguments.area:
        plot(found, folder / "pareto.svg")
    print_table(found)
    publish(out, folder, ["machines", *(["pareto.svg"] if arguments.area else []), "pareto.json"])


def main():
    def interrupt(*_):
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupt)
    os.environ["RAYPOOL"] = RAYPOOL  # for the synthesis
    try:
        arguments = parser().parse_args()
        chosen_machines(arguments.machines)
        fidelity.run_study("pareto", arguments, compare_machines)
    except (FidelityError, SynthError) as error:
        say(f"pareto: {error}")
        return getattr(error, "code", INPUT_FAILURE)
    except Failed as error:
        return error.args[0]
    except (OSError, subprocess.CalledProcessError) as error:
        say(f"pareto: {error}")
        return INPUT_FAILURE
    except KeyboardInterrupt:
        say("\npareto: interrupted; earlier results are as they were")
        return INTERRUPTED
    return 0


if __name__ == "__main__":
    sys.exit(main())
