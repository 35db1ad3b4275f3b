#!/usr/bin/env python3
"""Tables and plots of docs/experiments.md, of the table.json that a sweep of configs/experiments/published.json, or for
thresholds that of thresholds.json, leaves; with the published figures of configs/experiments/published.csv:

    scripts/experiments.py published|use|issue|kernels|cycles|... TABLE.json
    scripts/experiments.py plot-speed|plot-cycles TABLE.json PICTURE.png
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

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
HEAD = """set terminal pngcairo size {width},{height} font 'Sans,11' background 'white'
set output '{png}'
set style data histograms
set style fill solid noborder
set border 3 lc rgb '#666666'
set tics nomirror
set grid ytics lc rgb '#dddddd'
"""
SPEED = """set style histogram clustered gap 1
set boxwidth 0.9
set ylabel 'Mrays/s'
set yrange [0:*]
set key top left
plot '{data}' using 2:xtic(1) title 'published' lc rgb '#999999', \\
  '' using 3 title 'here, policy thesis' lc rgb '#4472a8', '' using 4 title 'here, policy fill' lc rgb '#c9824a'
"""
CYCLES = """set style histogram rowstacked
set boxwidth 0.8
set yrange [0:100]
set key outside right center reverse Left invert
set xtics rotate by -45
set multiplot layout 2,1
set ylabel 'policy thesis, %'
plot {thesis}
set ylabel 'policy fill, %'
plot {fill}
"""
COLOURS = ("#2f5d8a", "#6f9bc8", "#a9c5e3", "#c9824a", "#e3b48f", "#5a9367", "#a3c9ad", "#8d6a9f", "#bbbbbb", "#e0e0e0")


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


def gnuplot(script, **files):
    """Draws; `files` become the names of files with these rows."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {}
        for file, lines in files.items():
            paths[file] = pathlib.Path(folder, file)
            paths[file].write_text("".join(" ".join(map(str, line)) + "\n" for line in lines), encoding="utf-8")
        subprocess.run(["gnuplot"], input=script(paths), text=True, check=True)


def plot_speed(rows, png):
    lines = [[name(machine), there["mrays_per_s"], *(speed_of(of(rows, machine, policy=p)) for p in POLICIES)]
             for machine, there in published().items()]
    gnuplot(lambda files: (HEAD + SPEED).format(width=1000, height=400, png=png, data=files["data"]), data=lines)


def plot_cycles(rows, png):
    lines = {policy: [[name(machine), *parts_of(of(rows, machine, policy=policy))] for machine in published()]
             for policy in POLICIES}

    def script(files):
        stacks = {
            policy: ", ".join(f"'{path}' using {at + 2}:xtic(1) title '{PARTS[at].replace('_', ' ')}' lc rgb '{colour}'"
                              for at, colour in enumerate(COLOURS))
            for policy, path in files.items()
        }
        return (HEAD + CYCLES).format(width=1000, height=720, png=png, **stacks)

    gnuplot(script, **lines)


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
        raise ExperimentsError(f"say {'|'.join(TABLES)} TABLE.json, or {'|'.join(PLOTS)} TABLE.json PICTURE.png")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (ExperimentsError, OSError, subprocess.CalledProcessError) as problem:
        print(f"experiments.py: {problem}", file=sys.stderr)
        sys.exit(1)
