#!/usr/bin/python3
"""Tables and a plot of docs/studies/best.md, of the table.json that a sweep of configs/experiments/features.json,
way.json or features_area.json leaves:

    studies/features.py alone TABLE.json              each feature alone and last: cycles
    studies/features.py area TABLE.json               each feature last: area and power
    studies/features.py way TABLE.json [PICTURE.png]  one feature after another, and as a plot
"""
import json
import sys

from experiments import ExperimentsError, show

RUN_FIELDS = ("config", "depth", "units")


def load(path):
    """What was swept, and {run: rows in the order of the experiment}; a run is (depth, units)."""
    try:
        with open(path, encoding="utf-8") as file:
            table = json.load(file)
        runs = {}
        for row in table["rows"]:
            row.setdefault("config", table["base"]["config"])
            runs.setdefault((row.get("depth", 1), row.get("units", 1)), []).append(row)
        fields = [field for field in table["swept"] if field not in RUN_FIELDS]
        if len({len(rows) for rows in runs.values()}) != 1:
            raise ValueError
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ExperimentsError(f"{path}: not the table of a whole sweep of features.json or way.json") from error
    return fields, runs


def change(row, other, fields):
    """What `row` has that `other` has not: 'triples=false'. What two parts have alike is shown once, without them."""
    new = [(field, json.dumps(row[field]).strip('"')) for field in fields if row[field] != other[field]]
    ends = [f"{field.split('.')[-1]}={value}" for field, value in new]
    words = [end if ends.count(end) > 1 else f"{field.removeprefix('chip.')}={value}"
             for (field, value), end in zip(new, ends)]
    return ", ".join(dict.fromkeys(words))


def named(rows, fields):
    """(name, row, the plain row of its configuration); a configuration's first row is its plain one."""
    plain = {}
    for row in rows:
        first = plain.setdefault(row["config"], row)
        yield (row["config"] if row is first else f"  {change(row, first, fields)}"), row, first


def heads(runs, first, *others):
    return [head for run in runs for head in (f"{first}, {depth_units(run)}", *others)]


def depth_units(run):
    depth, units = run
    return f"depth {depth}" + (f", {units} units" if units > 1 else "")


def show_alone(path):
    fields, runs = load(path)
    lines = []
    for cells in zip(*(named(rows, fields) for rows in runs.values())):
        line = [cells[0][0]]
        for _, row, plain in cells:
            more = 100 * (row["cycles"] / plain["cycles"] - 1)
            line += [str(row["cycles"]), "" if row is plain else f"{more:+.1f}", f"{row['mrays_per_second']:.1f}"]
        lines.append(line)
    show(["machine", *heads(runs, "cycles", "%", "Mrays/s")], lines)


def show_area(path):
    fields, runs = load(path)
    if len(runs) != 1:
        raise ExperimentsError(f"{path}: areas are of one depth and one number of units")
    lines = []
    for what, row, plain in named(next(iter(runs.values())), fields):
        if row.get("area_mm2") is None:
            raise ExperimentsError(f"{path}: has no areas: its experiment needs \"area\": true")
        more = 100 * (row["area_mm2"] / plain["area_mm2"] - 1)
        speed = row["mrays_per_second"]
        lines.append([what, f"{row['kge']:.1f}", f"{row['area_mm2']:.3f}", "" if row is plain else f"{more:+.1f}",
                      f"{row['power_mw']:.0f}" if "power_mw" in row else "-", f"{speed:.1f}",
                      f"{speed / row['area_mm2']:.0f}"])
    show(["machine", "kGE", "mm2", "%", "mW", "Mrays/s", "a mm2"], lines)


def steps(rows, fields):
    """(what is new in it, row), from one row to the next."""
    for before, row in zip([None, *rows], rows):
        yield (row["config"] if before is None else "+ " + change(row, before, fields)), row


def show_way(path):
    fields, runs = load(path)
    lines = [[cells[0][0], *(f"{row['mrays_per_second']:.1f}" for _, row in cells)]
             for cells in zip(*(steps(rows, fields) for rows in runs.values()))]
    show(["Mrays/s", *(depth_units(run) for run in runs)], lines)


def plot_way(path, png):
    from plots.plot import WIDE, Plot, legend, named_places  # late, as Matplotlib takes a second to load
    from plots.style import series

    fields, runs = load(path)
    rows = next(iter(runs.values()))
    names = [what.split(", ")[0].split("=")[0].split(".")[-1] for what, _ in steps(rows, fields)]
    plot = Plot(345, WIDE)
    for (run, rows), (tone, mark) in zip(runs.items(), series(len(runs))):
        plot.line(range(len(rows)), [row["mrays_per_second"] for row in rows], tone, mark, depth_units(run))
    named_places(plot.axes, [word if at == 0 else "+ " + word.removeprefix("+ ") for at, word in enumerate(names)])
    plot.axes.set_ylim(bottom=0)
    plot.axes.set_ylabel("Mrays/s")
    legend(plot.axes, loc="upper left")
    plot.save(png, "Speed with one feature after another")


def main(words):
    if len(words) == 2 and words[0] == "alone":
        show_alone(words[1])
    elif len(words) == 2 and words[0] == "area":
        show_area(words[1])
    elif len(words) == 2 and words[0] == "way":
        show_way(words[1])
    elif len(words) == 3 and words[0] == "way":
        plot_way(words[1], words[2])
    else:
        raise ExperimentsError("give alone TABLE.json, area TABLE.json, or way TABLE.json [PICTURE.png]")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (ExperimentsError, OSError) as problem:
        print(f"features.py: {problem}", file=sys.stderr)
        sys.exit(1)
