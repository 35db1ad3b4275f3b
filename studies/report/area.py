"""Speed against area and power, with the machines that no other one beats in both."""
from plots.plot import LETTERS, Plot
from plots.style import colour

from .figure import Figure, Key, Panel, Section, number
from .point import common, labels

RUN = ("scene", "view", "size", "depth")
AREA_MISSING = ("No area is known for two of the machines here: make synth CONFIG=8w8c for each of them, or "
                '"area": true in an experiment.')
POWER_MISSING = "No power is known for two of the machines here: make synth CONFIG=4w4c POWER=1 for each of them."


def front(places):
    """Indices of those for which nothing else is both less x and more y, by x."""
    best, found = float("-inf"), []
    for place in sorted(range(len(places)), key=lambda place: (places[place][0], -places[place][1])):
        if places[place][1] > best:
            best = places[place][1]
            found.append(place)
    return found


def number_front(plot, places, best):
    """Numbers beside the marks of the front, where there is room; the list below the plot has all."""
    renderer = plot.figure.canvas.get_renderer()
    plot.figure.draw_without_rendering()
    taken = []
    for count, place in enumerate(best, 1):
        for shift, side in (((-5, 5), "right"), ((5, -13), "left")):
            note = plot.axes.annotate(str(count), places[place], shift, textcoords="offset points", ha=side,
                                      fontsize=LETTERS - 1, zorder=4)
            box = note.get_window_extent(renderer)
            if not any(box.overlaps(other) for other in taken):
                taken.append(box)
                break
            note.remove()


def scatter(title, points, axes_words, place_of):
    """(panel, indices of the front)"""
    plot = Plot(290)
    names = labels(points, *RUN)
    places = [place_of(point) for point in points]
    best = front(places)
    steps = [places[place] for place in best]
    plot.axes.step([x for x, _ in steps], [y for _, y in steps], where="post", color=colour("accent"), zorder=2)
    for place, ((x, y), name) in enumerate(zip(places, names)):
        words = f"{name}: {number(y)} {axes_words[1]} at {number(x)} {axes_words[0]}"
        plot.mark(x, y, "accent" if place in best else "muted", "o", words, hollow=place not in best)
    plot.axes.set_xlim(left=0)
    plot.axes.set_ylim(0, 1.12 * max(y for _, y in places))
    plot.axes.set_xlabel(axes_words[0])
    plot.axes.set_ylabel(axes_words[1])
    number_front(plot, places, best)
    listed = [f"{names[place]}: {number(places[place][1])} at {number(places[place][0])}" for place in best]
    description = (f"{axes_words[1]} against {axes_words[0]}. On the front: {'; '.join(listed)}. "
                   f"{len(points)} machines in all.")
    keys = [Key("accent", "o", "on the front: no other is at least as good in both"),
            Key("muted", "o", "others", hollow=True)]
    return Panel(title, plot, description, keys, listed), best, names


def runs_alike(points):
    groups = {}
    for point in points:
        key = point.key(*(name for name in point.fields if name not in RUN))
        groups.setdefault((point.version, key), {}).setdefault(point.key(), point)
    return sorted((list(group.values()) for group in groups.values() if len(group) > 1), key=lambda group: -len(group))


def area_figure(points):
    panel, best, names = scatter("Speed against area, and the Pareto front", points,
                                 ("mm2 of all units at 40 nm", "Mrays/s"), lambda p: (p.area_mm2, p.rate))
    thrifty = max(range(len(points)), key=lambda place: points[place].rate / points[place].area_mm2)
    small = [place for place in range(len(points)) if points[place].area_mm2 < 1]
    sentence = f"{len(best)} of {len(points)} machines are on the front"
    if small:
        fast = max(small, key=lambda place: points[place].rate)
        sentence += (f"; the fastest below 1 mm2 is {names[fast]}, {number(points[fast].rate)} Mrays/s in "
                     f"{number(points[fast].area_mm2)} mm2")
    rate = points[thrifty].rate / points[thrifty].area_mm2
    sentence += f"; the most for its area does {names[thrifty]}, {number(rate)} Mrays/s a mm2."
    return Figure(f"Area: {common(points)}", sentence, points, [panel])


def power_figure(points):
    clock, library = points[0].watts_mhz, points[0].watts_library

    def place_of(point):
        return point.watts, point.rate * clock / 1000

    words = f"W of all units, {library} at {clock:.0f} MHz", f"Mrays/s at {clock:.0f} MHz"
    panel, best, names = scatter("Speed against power, and the Pareto front", points, words, place_of)
    thrifty = min(range(len(points)), key=lambda place: points[place].watts / points[place].rate)
    energy = 1000 * place_of(points[thrifty])[0] / place_of(points[thrifty])[1]
    sentence = (f"{len(best)} of {len(points)} machines are on the front; least for a ray takes {names[thrifty]}, "
                f"{number(energy)} nJ in this library.")
    return Figure(f"Power: {common(points)}", sentence, points, [panel])


def area_section(points):
    points = [point for point in points if point.area_mm2]
    intro = "make synth's area, scaled to 40 nm (docs/use/synthesis.md), without the chip around the units."
    figures = [area_figure(group) for group in runs_alike(points)]
    return Section("area", "Speed against area", intro, figures, AREA_MISSING)


def power_section(points):
    alike = {}
    for point in points:
        if point.watts:
            alike.setdefault((point.watts_library, point.watts_mhz), []).append(point)
    figures = [power_figure(group) for members in alike.values() for group in runs_alike(members)]
    intro = ("Power is that of make synth POWER=1 while drawing, in its own library and at its clock, so speed is "
             "given at that clock too.")
    return Section("power", "Speed against power", intro, figures, POWER_MISSING)
