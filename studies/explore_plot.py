#!/usr/bin/python3
"""Draws what `raypool explore` has found: speed against area of all machines, and their front.

    studies/explore_plot.py EXPLORE.json [PLOT.svg]

PLOT is EXPLORE.svg beside the file if not given.
"""
import json
import pathlib
import sys

import paths  # noqa: F401  so that plots are found
from plots.plot import WIDE, Plot, legend
from plots.style import colour

HEIGHT = 380
MOST_MARKS = 1000  # of a kind: a file of thousands of marks is slow to show


def speed(found, cycles):
    """Mrays/s at 1 GHz."""
    return 1e3 * found["rays"] / cycles


def draw(found, path):
    plot = Plot(HEIGHT, WIDE)
    axes = plot.axes
    of_kind = {
        "guessed": [row for row in found["machines"] if "estimated_cycles" not in row and "cycles" not in row],
        "estimated": [row for row in found["machines"] if "estimated_cycles" in row and "cycles" not in row],
        "simulated": [row for row in found["machines"] if "cycles" in row and not row["front"]],
    }
    for kind, name, size, field in (
        ("guessed", "other", 2, "guessed_cycles"),
        ("estimated", "muted", 9, "estimated_cycles"),
        ("simulated", "flt", 14, "cycles"),
    ):
        rows = of_kind[kind]
        shown = rows[:: len(rows) // MOST_MARKS + 1]
        axes.scatter([row["mm2"] for row in shown], [speed(found, row[field]) for row in shown], s=size, linewidths=0,
                     color=colour(name), label=f"{kind}, {len(rows)}")  # fmt: skip
    front = sorted((row["mm2"], speed(found, row["cycles"])) for row in found["machines"] if row["front"])
    axes.step([x for x, _ in front], [y for _, y in front], where="post", color=colour("accent"), marker="o",
              markersize=4.5, label=f"front, simulated, {len(front)}", zorder=3)  # fmt: skip
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0, top=1.6 * max(y for _, y in front))
    axes.set_xlabel("area of the chip, mm2 at 40 nm")
    axes.set_ylabel("Mrays/s at 1 GHz")
    legend(axes, loc="upper left")
    size = found["size"]
    plot.title(f"{len(found['machines'])} machines around {found['config']}: {found['scene']['name']}, "
               f"{size['width']}x{size['height']}, depth {found['depth']}")  # fmt: skip
    plot.save(path, "Speed against area of machines, and the front that none of them beats")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    try:
        found = json.loads(source.read_text(encoding="utf-8"))
        found["machines"][0]["mm2"], found["rays"], found["size"]
    except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
        sys.exit(f"explore_plot.py: {source} is not what raypool explore writes ({error})")
    path = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else source.with_suffix(".svg")
    draw(found, path)
    print(f"plot      {path}")


if __name__ == "__main__":
    main()
