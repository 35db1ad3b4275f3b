"""The published tables with what was measured here beside them, machine by machine."""
import csv
import functools
import os

from sweep import raypool
from sweep.errors import SweepError

from plots.style import colour

from .errors import ReportError
from .figure import Figure, Key, Panel, Section, Table, number, percent
from .rows import ceilings_of, rows_plot, segments

FILE = os.path.join(raypool.ROOT, "configs", "experiments", "published.csv")
# What the published figures are of.
SCENE, SIZE, DEPTH = "conference", "512x512", 1
TABLES = {16: "5.3", 32: "5.4", 64: "5.5"}
SHARES = [("time_util", "time"), ("resource_util", "threads"), ("int_util", "int"), ("flt_util", "flt"),
          ("mem_util", "mem"), ("ray_util", "ray")]
WAITS = [("int_wait", "int"), ("flt_wait", "flt"), ("mem_wait", "mem"), ("ray_wait", "ray")]
MISSING = (f"No run here is one of the published ones, the {SCENE} scene at {SIZE}, depth {DEPTH}, one unit, the "
           "thesis' chip: make sweep EXPERIMENT=configs/experiments/published.json runs them all.")
WHY_PARTS = 3


def rows_of(path=FILE):
    """Of published.csv, numbers as such."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = [line for line in file if not line.startswith("#")]
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]
        return [row for row in rows if row["contents"] and row["warps"] and row["cores"] and row["mrays_per_s"]]
    except OSError:
        return []
    except (ValueError, KeyError, TypeError) as error:
        raise ReportError(f"{path}: not a table of published figures: {error}") from error


@functools.lru_cache(maxsize=None)
def plain_machine(shape):
    """All fields of the machine of this name, as the program has them by default, with the thesis' traverser."""
    try:
        machine = raypool.flat(raypool.machine(shape, {"chip.traverser": "static"}))
    except SweepError:
        return None
    return {name: value for name, value in machine.items() if name != "name"}


def is_published(point):
    """The scene, view and machine of the tables, but for its shape."""
    if point.report["scene"]["name"] != SCENE or (point["size"], point["depth"], point["units"]) != (SIZE, DEPTH, 1):
        return False
    machine = plain_machine(point.shape)
    return machine is not None and all(point[name] == value for name, value in machine.items())


def matches(points, rows):
    """[(row, point)], in the order of the rows; of several the first."""
    ours = {}
    for point in points:
        if is_published(point):
            ours.setdefault((point["warps"], point["lanes"]), point)
    return [(row, ours[row["warps"], row["cores"]]) for row in rows if (row["warps"], row["cores"]) in ours]


def ratio(row, point):
    return point.report["mrays_per_second_thesis"] / row["mrays_per_s"]


def ours(point, column):
    """What stands in that column here; as there, in percent."""
    name = column.split("_")[0]
    if column in ("time_util", "resource_util"):
        return 100 * point.report[column + "isation"]
    found = point.report["alus"][name]
    return 100 * found["utilisation"] if column.endswith("util") else found["waiting"]


def tables(pairs):
    """Speed, utilisation and waiting for one number of contents."""
    contents = int(pairs[0][0]["contents"])
    name = f"Table {TABLES[contents]}: " if contents in TABLES else ""
    speed = [[point.shape, number(point.report["mrays_per_second_thesis"]), number(row["mrays_per_s"]),
              f"{ratio(row, point):.2f}"] for row, point in pairs]

    def both(columns):
        return [[point.shape, *((f"{ours(point, column):.2f}", f"{row[column]:.2f}") for column, _ in columns)]
                for row, point in pairs]

    return [
        Table(f"{name}{contents} contents, Mrays/s", ["machine", "ours", "published", "ratio"], speed),
        Table(f"{contents} contents, utilisation in %, ours above published", ["machine", *(w for _, w in SHARES)],
              both(SHARES)),
        Table(f"{contents} contents, warps that wait, ours above published", ["machine", *(w for _, w in WAITS)],
              both(WAITS)),
    ]


def why(row, point):
    """A sentence for a machine that is behind, from its report."""
    rate = point.report["mrays_per_second_thesis"]
    words = [f"{point.shape} is behind: {number(rate)} against {number(row['mrays_per_s'])} Mrays/s. Its kernels "
             f"fill {ours(point, 'resource_util'):.1f}% of the threads there are (published: "
             f"{row['resource_util']:.1f}%)"]
    if point.report.get("ceilings"):
        ceilings = ceilings_of(point)
        lowest = point.report["ceilings"].get("lowest")
        words.append(f"its lowest ceiling is {lowest}, {number(min(ceilings.values(), default=None))} Mrays/s, of "
                     f"which {percent(point.report['ceilings'].get('reached'), 0)} are reached")
    if point.report.get("warp_cycles"):
        parts = sorted(((share(point.report["warp_cycles"]), said) for said, _, _, share in segments([point])),
                       reverse=True)
        words.append("most cycles of its warps: " + ", ".join(f"{said} {percent(s)}" for s, said in parts[:WHY_PARTS]))
    else:
        words.append("this report does not show where its cycles went")
    return "; ".join(words) + "."


def figure(pairs):
    names = [point.shape for _, point in pairs]
    plot, places, _ = rows_plot(names)
    for (row, point), place in zip(pairs, places):
        rate, there = point.report["mrays_per_second_thesis"], row["mrays_per_s"]
        plot.axes.plot([there, rate], [place, place], color=colour("line"), linewidth=3, zorder=2)
        words = f"{point.shape}, published: {number(there)} Mrays/s"
        plot.mark(there, place, "published", "D", words, hollow=True, size=6)
        words = f"{point.shape}, ours: {number(rate)} Mrays/s, {ratio(row, point):.2f} times"
        plot.mark(rate, place, "accent", "o", words)
    plot.axes.set_xlim(left=0)
    plot.axes.set_xlabel("Mrays/s, counted as the thesis does")
    ratios = [ratio(row, point) for row, point in pairs]
    ahead = sum(value >= 1 for value in ratios)
    sentence = (f"{ahead} of {len(pairs)} machines are at least as fast as published, {min(ratios):.2f} to "
                f"{max(ratios):.2f} times.")
    described = "; ".join(f"{point.shape}: {number(point.report['mrays_per_second_thesis'])}, published "
                          f"{number(row['mrays_per_s'])}" for row, point in pairs)
    keys = [Key("accent", "o", "ours"), Key("published", "D", "published", hollow=True)]
    contents = sorted({row["contents"] for row, _ in pairs})
    all_tables = [table for count in contents for table in tables([p for p in pairs if p[0]["contents"] == count])]
    found = Figure("One unit, each split of its contents into warps and cores", sentence, [point for _, point in pairs],
                   [Panel("Ours and published", plot, f"Mrays/s. {described}.", keys)], all_tables)
    found.remarks = [why(row, point) for row, point in pairs if ratio(row, point) < 1]
    return found


def section(points, path=FILE):
    rows = rows_of(path)
    pairs = matches(points, rows)
    intro = ("The tables of the thesis: conference scene, 512x512, primary and shadow rays, one unit. Rays are counted "
             "as there, an eye and a shadow ray a pixel.")
    built = Section("published", "The published tables, and ours", intro, [figure(pairs)] if pairs else [], MISSING)
    if pairs and len(pairs) < len(rows):
        here = {id(row) for row, _ in pairs}
        names = ", ".join(f"{row['warps']:.0f}w{row['cores']:.0f}c" for row in rows if id(row) not in here)
        built.notes.append(f"Of {len(rows)} published machines {len(pairs)} have been run; not: {names}. "
                           "make sweep EXPERIMENT=configs/experiments/published.json runs them all.")
    return built
