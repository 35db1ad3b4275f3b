"""Figures with a row for each point: use of the ALUs, waiting, where the cycles of warps went, and ceilings."""
from matplotlib import ticker

from plots.plot import Plot
from plots.style import ALUS, MARKS, alu_colour, colour

from .figure import MOST_ROWS, Figure, Key, Panel, Section, number, percent
from .groups import grouped
from .point import common, labels

ROW = 17
# Of `warp_cycles`, beside those of ALUs: field, colour, words; in the order of a bar, work first, idle last.
WORK = [("issued", "issued", "issued")]
STEPS = [("registers", "registers", "reading operands"), ("fetch", "fetch", "waiting for an instruction")]
REST = [
    ("import", "import", "import"),
    ("export", "export", "export"),
    ("ended", "idle1", "ended, others run"),
    ("not_launched", "idle2", "kernel not full"),
    ("without_kernel", "idle3", "without kernel"),
]
LEAST_SHARE = 0.01


def row_sets(points):
    """Sets of points that go into one figure: machines of several shapes; what is left by sweep, and runs."""
    groups = [group for group in grouped(points, "warps", "lanes") if len(group) > 2]
    # By what they are, as a run and a point of a sweep may be the same.
    covered = {(point.version, point.key()) for group in groups for point in group}
    rest = {}
    for point in points:
        if (point.version, point.key()) not in covered:
            rest.setdefault(point.sweep.folder if point.sweep else "", []).append(point)
    sets = groups + list(rest.values())
    return [part[first:first + MOST_ROWS] for part in sets for first in range(0, len(part), MOST_ROWS)]


def rows_plot(names):
    """A plot with a row for each name, first at the top; the places of the rows, and the height of a bar. Long names
    stand above their row."""
    above = max(map(len, names)) > 9
    height = ROW * (2.1 if above else 1)
    plot = Plot(height=64 + height * len(names))
    places = [float(-place) for place in range(len(names))]
    axes = plot.axes
    axes.set_ylim(-len(names) + (0.45 if above else 0.4), 0.75 if above else 0.6)
    axes.set_yticks(places, ["" if above else name for name in names])
    axes.grid(axis="y", visible=False)
    axes.spines["left"].set_visible(False)
    # Room for marks at zero.
    axes.tick_params(axis="y", pad=9)
    if above:
        for place, name in zip(places, names):
            axes.annotate(name, (0, place), (0, 8), xycoords=("axes fraction", "data"), textcoords="offset points",
                          fontsize=10, color=colour("muted"))
    return plot, places, 0.42 if above else 0.72


def in_order(alus):
    """Each once, as all figures have them; those that a user has added at the end."""
    found = dict.fromkeys(alus)
    return [alu for alu in ALUS if alu in found] + [alu for alu in found if alu not in ALUS]


def alus_of(points):
    return in_order(alu for point in points for alu in point.report["alus"])


def dots(title, points, field, words, scale):
    """A mark for each ALU of each point."""
    names = labels(points)
    plot, places, _ = rows_plot(names)
    alus = alus_of(points)
    described = []
    for point, place, name in zip(points, places, names):
        plot.axes.axhline(place, color=colour("line"), linewidth=0.7, zorder=1)
        said = []
        for alu in reversed(alus):
            value = point.report["alus"].get(alu, {}).get(field)
            if value is None:
                continue
            said.insert(0, f"{alu} {number(scale * value)}")
            plot.mark(scale * value, place, alu_colour(alu), MARKS[alu_colour(alu)],
                      f"{name}, {alu}: {number(scale * value)} {words}")
        described.append(f"{name}: {', '.join(said)}")
    plot.axes.set_xlim(left=0, right=100 if scale == 100 else None)
    plot.axes.set_xlabel(words)
    return Panel(title, plot, f"{words}, by ALU. {'; '.join(described)}.",
                 [Key(alu_colour(alu), MARKS[alu_colour(alu)], alu) for alu in alus])


def extreme(points, field):
    """The (point, alu, value) that is highest."""
    return max(((point, alu, figures[field]) for point in points for alu, figures in point.report["alus"].items()
                if figures[field] is not None), key=lambda found: found[2])


def alus_figure(points):
    names = {id(point): name for point, name in zip(points, labels(points))}
    busy, alu, share = extreme(points, "utilisation")
    waits, wanted, count = extreme(points, "waiting")
    sentence = (f"The busiest is {alu} of {names[id(busy)]}, at work {percent(share)} of busy time; the most waited "
                f"for is {wanted} of {names[id(waits)]}, by {number(count)} warps on average.")
    return Figure(f"ALUs: {common(points)}", sentence, points, [
        dots("Utilisation of each ALU", points, "utilisation", "% of busy time", 100),
        dots("Waiting for each ALU", points, "waiting", "warps that wait, on average", 1),
    ])


def alus_section(points):
    intro = ("Utilisation: 1 - the share of busy time in which the ALU was free for a new task and got none. Waiting: "
             "warps that wanted this ALU and did not get it.")
    missing = "No run here knows time; make sim ENGINE=model leaves one that does."
    return Section("alus", "Use of the ALUs, and waiting for them", intro, [alus_figure(s) for s in row_sets(points)],
                   missing)


def segments(points):
    """[(words, colour, kind, share(cycles))] of a bar; kinds as Key has them. ALUs that never count are together."""
    def part(group, alu):
        return lambda cycles: cycles[group].get(alu, 0) / cycles["all"]

    def rest(group, alus):
        return lambda cycles: sum(cycles[group].get(alu, 0) for alu in alus) / cycles["all"]

    def plain(fields):
        return [(words, name, "", lambda cycles, field=field: cycles[field] / cycles["all"])
                for field, name, words in fields]

    found = {}
    for group, kind, words in (("executing", "-", "executing: {}"), ("waiting", "/", "waiting: {}")):
        alus = in_order(alu for point in points for alu in point.report["warp_cycles"][group])
        seen = [alu for alu in alus if any(part(group, alu)(p.report["warp_cycles"]) >= LEAST_SHARE for p in points)]
        found[group] = [(words.format(alu), alu_colour(alu), kind, part(group, alu)) for alu in seen]
        unseen = [alu for alu in alus if alu not in seen]
        found[group] += [(words.format("another"), "other", kind, rest(group, unseen))] if unseen else []
    return plain(WORK) + found["executing"] + plain(STEPS) + found["waiting"] + plain(REST)


def cycles_figure(points):
    names = labels(points)
    plot, places, height = rows_plot(names)
    parts = segments(points)
    shares = {}
    for point, place, name in zip(points, places, names):
        left = 0.0
        shares[id(point)] = []
        for words, colour_name, kind, share in parts:
            width = 100 * share(point.report["warp_cycles"])
            shares[id(point)].append((width, words))
            if width <= 0:
                continue
            (bar,) = plot.axes.barh([place], [width], left=left, height=height, color=colour(colour_name),
                                    edgecolor=colour("paper"), linewidth=0.4, hatch="////" if kind == "/" else None,
                                    alpha=0.5 if kind == "-" else None, zorder=2)
            plot.tip(bar, f"{name}: {words} {width:.1f}%")
            left += width
    plot.axes.set_xlim(0, 100)
    plot.axes.set_xlabel("% of the cycles of all warps")
    described = "; ".join(f"{name}: " + ", ".join(f"{words} {width:.1f}" for width, words in shares[id(point)])
                          for point, name in zip(points, names))
    worked = [shares[id(point)][0][0] for point in points]
    best, worst = worked.index(max(worked)), worked.index(min(worked))
    most = sorted(shares[id(points[best])][1:], reverse=True)[:2]
    sentence = (f"An instruction is issued in {worked[best]:.1f}% of the cycles of the warps of {names[best]}"
                + (f" and {worked[worst]:.1f}% of {names[worst]}" if len(points) > 1 else "")
                + f"; what {names[best]} loses most to: "
                + ", ".join(f"{words} {width:.1f}%" for width, words in most) + ".")
    panel = Panel("Where the cycles of the warps went", plot, f"Percent of the cycles of all warps. {described}.",
                  [Key(name, kind, words) for words, name, kind, _ in parts])
    return Figure(f"Cycles: {common(points)}", sentence, points, [panel])


def cycles_section(points):
    points = [point for point in points if point.report.get("warp_cycles")]
    intro = ("Every cycle of every warp is in one part; together they are 100%. Executing: what the warp has given "
             "to an ALU is under way there. Waiting: it wanted this ALU and did not get it.")
    missing = ("No report here has warp_cycles; make sim ENGINE=model with this version leaves one that has, and "
               "a sweep that is started again too.")
    return Section("cycles", "Where the cycles went", intro, [cycles_figure(s) for s in row_sets(points)], missing)


def ceilings_of(point):
    """{name: Mrays/s} of all that set one."""
    ceilings = point.report["ceilings"]
    alus = {alu: rate for alu, rate in (ceilings.get("alus") or {}).items() if rate}
    others = {name: ceilings.get(name) for name in OTHER_CEILINGS}
    return {**{name: rate for name, rate in others.items() if rate}, **alus}


# Ceilings this many times as high as the highest that binds are not drawn.
FARTHEST = 8
OTHER_CEILINGS = {
    "issue": "issued", "latency": "fetch", "ray_port": "export", "intersection_port": "import", "frame_port": "other",
    "memory_port": "s3", "traverser": "s5", "box_pipes": "s5", "triangle_pipes": "s5", "rays_in_flight": "s5",
}  # fmt: skip
CEILING_MARKS = {"issue": "|", "latency": "x", "ray_port": "<", "intersection_port": ">", "frame_port": "d",
                 "memory_port": "h", "traverser": "p",
                 "box_pipes": "s", "triangle_pipes": "^", "rays_in_flight": "*"}  # fmt: skip


def ceiling_style(name):
    if name in OTHER_CEILINGS:
        return OTHER_CEILINGS[name], CEILING_MARKS[name]
    return alu_colour(name), MARKS[alu_colour(name)]


def ceilings_figure(points):
    names = labels(points)
    plot, places, _ = rows_plot(names)
    axes = plot.axes
    seen, described = {}, []
    most = FARTHEST * max(min(ceilings_of(point).values(), default=point.rate) for point in points)
    for point, place, name in zip(points, places, names):
        ceilings = {ceiling: rate for ceiling, rate in ceilings_of(point).items() if rate <= most}
        lowest = str(point.report["ceilings"].get("lowest"))
        limit = min(ceilings.values()) if ceilings else point.rate
        axes.plot([point.rate, limit], [place, place], color=colour("ink"), linewidth=2.2, zorder=2)
        for ceiling, rate in sorted(ceilings.items(), key=lambda pair: -pair[1]):
            style = ceiling_style(ceiling)
            seen[ceiling] = style
            plot.mark(rate, place, *style, f"{name}: {ceiling} alone would allow {number(rate)} Mrays/s", size=5.5)
        plot.mark(point.rate, place, "ink", "o", f"{name}: {number(point.rate)} Mrays/s", hollow=True, size=7)
        described.append(f"{name}: {number(point.rate)} of {number(limit)} Mrays/s that {lowest} allows")
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.10g}"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.set_xlabel("Mrays/s, logarithmic")
    reached = [point.rate / min(ceilings_of(point).values(), default=point.rate) for point in points]
    best, worst = reached.index(max(reached)), reached.index(min(reached))
    sentence = (f"{names[best]} reaches {percent(reached[best], 0)} of its lowest ceiling "
                f"({points[best].report['ceilings'].get('lowest')})"
                + (f", {names[worst]} {percent(reached[worst], 0)} ({points[worst].report['ceilings'].get('lowest')})."
                   if len(points) > 1 else "."))
    keys = [Key("ink", "o", "reached", hollow=True)]
    keys += [Key(*seen[name], name.replace("_", " ")) for name in [*OTHER_CEILINGS, *alus_of(points)] if name in seen]
    described.append(f"What allows more than {number(most)} Mrays/s is not drawn")
    panel = Panel("Reached, and what each resource alone would allow", plot, "; ".join(described) + ".", keys)
    return Figure(f"Ceilings: {common(points)}", sentence, points, [panel])


def ceilings_section(points):
    points = [point for point in points if point.report.get("ceilings")]
    intro = ("Each mark is what one resource would allow if nothing else were in the way; the circle is what was "
             "reached, and the bar leads from it to the lowest of them.")
    missing = ("No report here has ceilings; make sim ENGINE=model with this version leaves one that has, and a "
               "sweep that is started again too.")
    return Section("ceilings", "Ceilings (roofline)", intro, [ceilings_figure(s) for s in row_sets(points)], missing)
