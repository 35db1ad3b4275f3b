"""Speed against cores and warps, and for each core: figures over machines that differ in warps and lanes alone."""
from matplotlib import ticker

from plots.plot import Plot
from plots.style import colour, series

from .figure import Figure, Key, Panel, Section, number
from .groups import grouped, values
from .point import common

MISSING = ("No three machines here differ in warps and lanes alone; make sweep "
           "EXPERIMENT=configs/experiments/published.json runs such a set, and so does any file with "
           '"product": {"warps": [2, 4, 8], "lanes": [2, 4, 8]}.')


def series_of(points, field):
    """[(value, colour, mark, points)] for each value of `field`."""
    found = values(points, field)
    return [(value, *style, [point for point in points if point[field] == value])
            for value, style in zip(found, series(len(found)))]


def curves(title, points, axis, line, axis_words, rate):
    """Rate against the field `axis` (doubling), a line for each value of the field `line`."""
    plot = Plot()
    axes = plot.axes
    described, keys = [], []
    for value, name, mark, members in series_of(points, line):
        members.sort(key=lambda point: point[axis])
        axes.plot([point[axis] for point in members], [rate(point) for point in members], color=colour(name), zorder=2)
        for point in members:
            plot.mark(point[axis], rate(point), name, mark, f"{point.shape}: {number(rate(point))} {axis_words[1]}")
        word = f"{value} {line if value != 1 or line == 'contents' else line[:-1]}"
        keys.append(Key(name, mark, word))
        described.append(word + ": " + ", ".join(f"{number(rate(point))} at {point[axis]}" for point in members))
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_locator(ticker.FixedLocator(values(points, axis)))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.xaxis.set_major_formatter(ticker.FormatStrFormatter("%d"))
    axes.set_ylim(bottom=0)
    axes.set_xlabel(axis_words[0])
    axes.set_ylabel(axis_words[1])
    description = f"{axis_words[1]} against {axis_words[0]}. " + "; ".join(described) + "."
    return Panel(title, plot, description, keys)


def figure(points):
    def rate(point):
        return point.rate

    def per_core(point):
        return point.rate / point["lanes"] / point["units"]

    best = max(points, key=rate)
    thrifty = max(points, key=per_core)
    sentence = (f"The fastest is {best.shape} with {number(best.rate)} Mrays/s; for each core {thrifty.shape} does "
                f"most, {number(per_core(thrifty))} Mrays/s, where {best.shape} does {number(per_core(best))}.")
    cores = "cores (lanes of a unit)"
    # Splits of the same contents go together; else machines that have the other number in common.
    splits = len(values(points, "contents")) < min(len(values(points, field)) for field in ("warps", "lanes"))
    lines = ("contents", "contents") if splits else ("warps", "lanes")
    return Figure(f"Speed: {common(points)}", sentence, points, [
        curves("Speed against cores", points, "lanes", lines[0], (cores, "Mrays/s"), rate),
        curves("Speed against warps", points, "warps", lines[1], ("warps", "Mrays/s"), rate),
        curves("Speed for each core", points, "lanes", lines[0], (cores, "Mrays/s for each core"), per_core),
    ])


def section(points):
    groups = [group for group in grouped(points, "warps", "lanes") if len(group) > 2]
    intro = "A core is a lane of a compute unit. Mrays/s are millions of traced rays in a second of simulated time."
    return Section("speed", "Speed against cores and warps", intro, [figure(group) for group in groups], MISSING)
