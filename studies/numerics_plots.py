#!/usr/bin/python3
"""Draws what `raypool numerics` has measured: studies/numerics_plots.py FOLDER, with numerics.json. It gets
quality.png, the error of the colours of each mode, and pareto.png, quality against gates and against cycles with a line
through the modes that no other one beats in both; what is known of fewer than two modes is left out.
"""
import json
import pathlib
import sys

import paths  # noqa: F401  so that plots are found
from plots.plot import WIDE, Plot, legend
from plots.style import colour, series

EQUAL = 160  # a bar's height for pictures that are equal
SAME_QUALITY = 0.05  # dB within which two modes are equally good
ROUNDING = 58.9  # of linear values to 8 bits: 10 log10(12 * 255^2)
UNITS = {"exact": "int", "newton2": "mem", "newton1": "ray", "newton0": "slw"}
COSTS = {"one lane of Flt and one of Slw, kGE (less is better)": ("flt_lane_kge", "slw_lane_kge"),
         "cycles a ray (less is better)": ("cycles_per_ray",)}  # fmt: skip


def points_of(found, fields):
    """[(cost, dB, mode)] of the first scene: what a far one loses by its coordinates hides what the modes lose."""
    first = found["quality"][0]["scene"]
    quality = {row["mode"]: row["psnr_same_paths_db"] for row in found["quality"] if row["scene"] == first}
    rows = [(row["mode"], [row[field] for field in fields]) for row in found["cost"]]
    return [(sum(cost), quality[mode], mode) for mode, cost in rows if None not in cost and quality[mode] is not None]


def front(points):
    """Of those which cost more only what is also better."""
    best = []
    for cost, decibels, _ in sorted(points, key=lambda point: (point[0], -point[1])):
        if not best or decibels > best[-1][1] + SAME_QUALITY:
            best.append((cost, decibels))
    return best


def panels_of(found):
    """{words of the cost: points}, of two modes at least."""
    known = {words: points_of(found, fields) for words, fields in COSTS.items()}
    return {words: points for words, points in known.items() if len(points) > 1}


def plot_quality(found, png):
    plot = Plot(432, WIDE)
    modes = [row["mode"] for row in found["cost"]]
    scenes = list(dict.fromkeys(row["scene"] for row in found["quality"]))
    rows = {(row["scene"], row["mode"]): row["psnr_same_paths_db"] for row in found["quality"]}
    plot.bars(modes, [(scene, tone, [rows[scene, mode] or EQUAL for mode in modes])
                      for scene, (tone, _) in zip(scenes, series(len(scenes)))])  # fmt: skip
    plot.title("Error of the colours alone: pixels with all rays hitting what they should")
    plot.axes.axhline(ROUNDING, color=colour("flt"), linestyle="--", label="8-bit rounding")
    plot.axes.set_ylabel("PSNR before quantisation, dB (more is better)")
    legend(plot.axes, loc="lower center", bbox_to_anchor=(0.5, 1), ncol=4)
    plot.save(png, "PSNR of equal paths by mode and scene")


def mark_of(mode):
    """Colour and size by slow unit, the better the larger, so that several at one place show as rings; filled with
    subnormals, open without; a triangle with a fused multiply-add."""
    subnormals, unit, *fused = mode.split("-")
    tone = colour(UNITS[unit])
    return {"marker": "^" if fused else "o", "color": tone, "linestyle": "none", "label": mode,
            "markersize": 9 - 1.5 * list(UNITS).index(unit) + (0 if subnormals == "ieee" else 3),
            "markerfacecolor": tone if subnormals == "ieee" else "none", "markeredgewidth": 1.4}  # fmt: skip


def plot_pareto(found, png):
    """True if something is known."""
    panels = panels_of(found)
    if not panels:
        return False
    plot = Plot(460, 540 * len(panels), (1, len(panels)))
    for axes, (words, points) in zip(plot.panels, panels.items()):
        axes.step(*zip(*front(points)), where="post", color=colour("muted"))
        for cost, decibels, mode in points:
            axes.plot([cost], [decibels], **mark_of(mode))
        axes.margins(0.1)
        axes.set_xlabel(words)
        axes.set_ylabel(f"PSNR of equal paths, {found['quality'][0]['scene']}, dB (more is better)")
        legend(axes, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=4, labelspacing=0.9)
    plot.title(f"Arithmetic on {found['configuration']}: quality against cost; a line joins what none beats in both")
    plot.save(png, "PSNR of equal paths against cost")
    return True


def main(folder):
    found = json.loads((folder / "numerics.json").read_text(encoding="utf-8"))
    plot_quality(found, folder / "quality.png")
    (folder / "pareto.png").unlink(missing_ok=True)
    drawn = plot_pareto(found, folder / "pareto.png")
    print(f"drawn in {folder}: quality.png{', pareto.png' if drawn else ''}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: numerics_plots.py FOLDER")
    main(pathlib.Path(sys.argv[1]))
