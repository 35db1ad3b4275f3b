#!/usr/bin/python3
"""Tables and plots of docs/studies/experiments.md, of the table.json that a sweep of
configs/experiments/published.json, or for thresholds that of thresholds.json, leaves; with the published figures of
configs/experiments/published.csv:

    studies/experiments.py published|use|issue|kernels|cycles|... TABLE.json
    studies/experiments.py plot-speed|plot-cycles TABLE.json PICTURE.png
"""
import csv
import json
import pathlib
import sys

import paths  # noqa: F401  so that plots are found

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Nanoseconds that the thesis' kernels take on 4w4c (its table 5.1).
PUBLISHED_KERNELS = {"cast_eye": 636, "cast_secondary_direct": 643, "shade": 292}
# What may differ between the points, and what it is where it is not swept.
SWEPT = {"units": 1, "depth": 1, "chip.policy": "thesis", "chip.window_remedy": True,
         "chip.thresholds.intersections": 8}  # fmt: skip
POLICIES = ("thesis", "fill")
ALUS = ("tid", "brh", "mem", "int", "flt", "slw", "ray")
# The parts of warp_cycles as the tables and the plot show them.
PARTS = ("issued", "registers", "executing", "fetch", "waiting", "import", "export", "ended", "not_launched",
         "without_kernel")
COLOURS = ("issued", "registers", "s2", "fetch", "flt", "import", "export", "idle1", "idle2", "idle3")


class ExperimentsError(Exception):
    pass


def load(path):
    """{(warps, cores, units, depth, policy, remedy, threshold): row} of a sweep's table."""
    try:
        with open(path, encoding="utf-8") as file:
            rows = json.load(file)["rows"]
        found = {}
        for row in rows:
            if row["cycles"] is None:  # a picture of Embree's hits
                continue
            warps, cores = (int(part) for part in row["config"].rstrip("c").split("w"))
            found[warps, cores, *(row.get(field, default) for field, default in SWEPT.items())] = row
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ExperimentsError(f"{path}: not the table of a sweep of published.json or thresholds.json") from error
    return found


def published():
    """{(warps, cores): row} in the order of the file."""
    with open(ROOT / "configs/experiments/published.csv", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(int(row["warps"]), int(row["cores"])): row for row in rows}


def of(rows, machine, units=1, depth=1, policy="thesis", remedy=True, threshold=8):
    key = *machine, units, depth, policy, remedy, threshold
    if key not in rows:
        said = ", ".join(f"{field}={value}" for field, value in zip(SWEPT, key[2:]))
        raise ExperimentsError(f"the table has no point with config={name(machine)}, {said}")
    return rows[key]


def show(header, rows):
    """Columns, the first to the left, all others to the right."""
    lines = [header, *([cell if isinstance(cell, str) else f"{cell:.2f}" for cell in row] for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    for line in lines:
        cells = [line[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(line[1:], widths[1:]))]
        print("  ".join(cells).rstrip())


def name(machine):
    return f"{machine[0]}w{machine[1]}c"


def percent(share):
    return f"{100 * share:.1f}"


def speed_of(row):
    return row["mrays_per_second_thesis"]


def show_published(rows):
    lines = []
    for machine, there in published().items():
        rate = float(there["mrays_per_s"])
        thesis, fill = (speed_of(of(rows, machine, policy=policy)) for policy in POLICIES)
        lines.append([name(machine), rate, thesis, thesis / rate, fill, fill / rate])
    show(["machine", "published", "thesis", "ratio", "fill", "ratio"], lines)


def show_use(rows):
    lines = []
    for machine, there in published().items():
        row = of(rows, machine)
        pairs = [("time_util", "time_utilisation"), ("resource_util", "resource_utilisation")]
        pairs += [(f"{alu}_util", f"alus.{alu}.utilisation") for alu in ("int", "flt", "mem", "ray")]
        lines.append([name(machine), *(f"{float(there[a]):.0f}/{100 * row[b]:.0f}" for a, b in pairs)])
    show(["machine", "time", "resources", "int", "flt", "mem", "ray"], lines)


def show_issue(rows):
    lines = []
    for machine, there in published().items():
        row = of(rows, machine)
        lines.append([name(machine), (float(there["int_util"]) + float(there["flt_util"])) / 100,
                      row["alus.int.issued"] / row["cycles"] + row["alus.flt.issued"] / row["cycles"],
                      row["instructions"] / row["cycles"], row["ceilings.issue"], float(there["mrays_per_s"])])
    show(["machine", "published int + flt", "here", "here, all", "ceiling, Mrays/s", "published, Mrays/s"], lines)


def show_kernels(rows):
    row = of(rows, (4, 4))
    lines = []
    for kernel, published_ns in PUBLISHED_KERNELS.items():
        launches = row[f"kernels.{kernel}.launches"]
        lines.append([kernel, f"{published_ns}", f"{row[f'kernels.{kernel}.cycles'] / launches:.0f}", f"{launches}",
                      f"{row[f'kernels.{kernel}.threads'] / launches:.1f}"])
    show(["kernel on 4w4c", "published, ns", "here, ns", "launches", "threads each"], lines)


def parts_of(row):
    """Shares of all cycles of all warps, in the order of PARTS."""
    parts = [row.get(f"warp_cycles.{part}") or 0 for part in PARTS]
    for part in ("executing", "waiting"):
        parts[PARTS.index(part)] = sum(row[f"warp_cycles.{part}.{alu}"] for alu in ALUS)
    if sum(parts) != row["warp_cycles.all"]:
        raise ExperimentsError(f"{row['machine']}: the parts of warp_cycles are not the whole")
    return [100 * part / row["warp_cycles.all"] for part in parts]


def show_cycles(rows, policy):
    lines = []
    for machine in published():
        row = of(rows, machine, policy=policy)
        lines.append([name(machine), *(f"{part:.1f}" for part in parts_of(row)), row["ceilings.lowest"],
                      f"{row[ceiling(row)]:.1f}", percent(row["ceilings.reached"])])
    show(["machine", *(part.replace("_", " ") for part in PARTS), "lowest ceiling", "Mrays/s", "reached"], lines)


def ceiling(row):
    lowest = row["ceilings.lowest"]
    return f"ceilings.alus.{lowest}" if lowest in ALUS else f"ceilings.{lowest}"


def show_window(rows):
    lines = []
    for machine in published():
        off, on = (speed_of(of(rows, machine, remedy=remedy)) for remedy in (False, True))
        lines.append([name(machine), off, on, f"{100 * (on / off - 1):+.0f}%"])
    show(["machine", "off", "on", "gain"], lines)


def show_thresholds(rows):
    lines = []
    for machine, there in published().items():
        cells = [of(rows, machine, threshold=threshold) for threshold in (8, 16, 32)]
        lines.append([name(machine), float(there["mrays_per_s"]), *map(speed_of, cells), float(there["resource_util"]),
                      *(100 * cell["resource_utilisation"] for cell in cells)])
    show(["machine", "published", "8", "16", "32", "resources, published", "8", "16", "32"], lines)


def show_units(rows, depth, contents):
    lines = []
    for machine, there in published().items():
        if int(there["contents"]) < contents:
            continue
        cells = [of(rows, machine, units, depth, policy) for policy in POLICIES for units in (1, 2, 4)]
        lines.append([name(machine), *(cell["mrays_per_second"] for cell in cells),
                      percent(cells[-1]["pools.intersection_port_utilisation"])])
    show(["machine", "thesis 1", "2", "4", "fill 1", "2", "4", "import port %"], lines)


def plot_speed(rows, png):
    from plots.plot import WIDE, Plot, legend  # late, as Matplotlib takes a second to load

    machines = published()
    plot = Plot(290, WIDE)
    plot.bars([name(machine) for machine in machines], [
        ("published", "published", [float(there["mrays_per_s"]) for there in machines.values()]),
        *((f"here, policy {policy}", tone, [speed_of(of(rows, machine, policy=policy)) for machine in machines])
          for policy, tone in zip(POLICIES, ("accent", "s1")))])  # fmt: skip
    plot.axes.set_ylabel("Mrays/s")
    legend(plot.axes, loc="upper left")
    plot.save(png, "Speed of each machine, published and here")


def plot_cycles(rows, png):
    from plots.plot import WIDE, Plot, legend

    plot = Plot(520, WIDE, (2, 1))
    for policy, axes in zip(POLICIES, plot.panels):
        shares = zip(*(parts_of(of(rows, machine, policy=policy)) for machine in published()))
        plot.bars([name(machine) for machine in published()],
                  [(part.replace("_", " "), *rest) for part, *rest in zip(PARTS, COLOURS, shares)], True, axes)
        axes.set_ylim(0, 100)
        axes.set_ylabel(f"policy {policy}, % of cycles")
        legend(axes, loc="center left", bbox_to_anchor=(1.01, 0.5), reverse=True)
    plot.save(png, "Where the cycles of all warps go")


TABLES = {
    "published": show_published,
    "use": show_use,
    "issue": show_issue,
    "kernels": show_kernels,
    "cycles": lambda rows: show_cycles(rows, "thesis"),
    "cycles-fill": lambda rows: show_cycles(rows, "fill"),
    "window": show_window,
    "thresholds": show_thresholds,
    "units": lambda rows: show_units(rows, 1, 32),
    "units-5": lambda rows: show_units(rows, 5, 64),
}


PLOTS = {"plot-speed": plot_speed, "plot-cycles": plot_cycles}


def main(words):
    if len(words) == 2 and words[0] in TABLES:
        TABLES[words[0]](load(words[1]))
    elif len(words) == 3 and words[0] in PLOTS:
        PLOTS[words[0]](load(words[1]), words[2])
    else:
        raise ExperimentsError(f"give {'|'.join(TABLES)} TABLE.json, or {'|'.join(PLOTS)} TABLE.json PICTURE.png")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (ExperimentsError, OSError) as problem:
        print(f"experiments.py: {problem}", file=sys.stderr)
        sys.exit(1)
