"""What one field does when nothing else changes: several units, policies, and every other field that was swept."""
from matplotlib import ticker

from plots.plot import Plot
from plots.style import SERIES_MARKS, colour, series

from .figure import MOST_ROWS, Figure, Key, Panel, Section, change, number
from .groups import grouped, values
from .point import common, labels, short_field
from .rows import rows_plot

# Those with figures of their own, and those that make another picture of another scene.
OWN = ("warps", "lanes", "units", "chip.policy", "scene", "view", "size", "engine")


def group_names(groups, *without):
    """What distinguishes each group from the others, without the field that varies inside."""
    return labels([group[0] for group in groups], *without)


def units_figure(groups):
    names = group_names(groups, "units")
    plot = Plot(260)
    axes = plot.axes
    described, keys, gains = [], [], []
    for (tone, mark), group, name in zip(series(len(groups)), groups, names):
        group = sorted(group, key=lambda point: point["units"])
        axes.plot([p["units"] for p in group], [p.rate for p in group], color=colour(tone), zorder=2)
        for point in group:
            plot.mark(point["units"], point.rate, tone, mark, f"{name}, {short_field('units', point['units'])}: "
                      f"{number(point.rate)} Mrays/s")
        keys.append(Key(tone, mark, name))
        described.append(f"{name}: " + ", ".join(f"{number(p.rate)} with {p['units']}" for p in group))
        gains.append((group[-1].rate / group[0].rate, name, group))
    axes.xaxis.set_major_locator(ticker.FixedLocator([1, 2, 4]))
    axes.set_ylim(bottom=0)
    axes.set_xlabel("compute units")
    axes.set_ylabel("Mrays/s")
    (most, most_name, group), (least, least_name, _) = max(gains, key=first), min(gains, key=first)
    sentence = f"{group[-1]['units']} units draw {most:.2f} times as many rays as {group[0]['units']} with {most_name}"
    sentence += f", {least:.2f} times with {least_name}." if len(groups) > 1 else "."
    points = [point for group in groups for point in group]
    panel = Panel("Speed against compute units", plot, "Mrays/s. " + "; ".join(described) + ".", keys)
    return Figure(f"Units: {common(points)}", sentence, points, [panel])


def first(found):
    return found[0]


def families(groups):
    """Groups that make one figure: of the same scene, depth and chip."""
    found = {}
    for group in groups:
        found.setdefault((group[0].version, group[0].key("warps", "lanes", "units")), []).append(group)
    return list(found.values())


def units_section(points):
    groups = [group for family in families(grouped(points, "units")) for group in in_sixes(family)]
    return Section("units", "Several compute units", "They share the pools, the memory and all ports of the chip.",
                   [units_figure(family) for family in groups],
                   "No machine here has been run with several numbers of units: make sim ENGINE=model CUS=2, or "
                   '"product": {"units": [1, 2, 4]} in an experiment.')


def in_sixes(family):
    """As many as there are marks."""
    return [family[begin:begin + len(SERIES_MARKS)] for begin in range(0, len(family), len(SERIES_MARKS))]


def effect_panel(field, groups, title, styles, most):
    """A row for each group, a mark for each value of the field; the axis ends at `most`."""
    names = group_names(groups, field)
    plot, places, _ = rows_plot(names)
    described = []
    for group, place, name in zip(groups, places, names):
        rates = [point.rate for point in group]
        plot.axes.plot([min(rates), max(rates)], [place, place], color=colour("line"), linewidth=2.2, zorder=2)
        for point in group:
            words = f"{name}, {short_field(field, point[field])}: {number(point.rate)} Mrays/s"
            plot.mark(point.rate, place, *styles[point[field]], words)
        described.append(f"{name}: " + ", ".join(f"{point[field]} {number(point.rate)}" for point in group))
    plot.axes.set_xlim(0, most)
    plot.axes.set_xlabel("Mrays/s")
    keys = [Key(*style, short_field(field, value)) for value, style in styles.items()]
    return Panel(title, plot, "Mrays/s. " + "; ".join(described) + ".", keys)


def effect_figure(field, groups, title):
    """A plot for each number of units."""
    order = values([point for group in groups for point in group], field)
    styles = dict(zip(order, series(len(order))))
    groups = [sorted(group, key=lambda point: order.index(point[field])) for group in groups]
    # One scale, so that plots compare.
    most = 1.04 * max(point.rate for group in groups for point in group)
    panels = []
    for units in values([group[0] for group in groups], "units"):
        members = [group for group in groups if group[0]["units"] == units]
        panels.append(effect_panel(field, members, f"{title}, {short_field('units', units)}", styles, most))

    def gain(found):
        _, group = found
        return group[-1].rate / group[0].rate

    def said(found):
        name, (before, *_, after) = found
        return (f"{name}: {number(before.rate)} Mrays/s with {short_field(field, before[field])}, {number(after.rate)} "
                f"with {short_field(field, after[field])} ({change(before.rate, after.rate)})")

    named = list(zip(group_names(groups, field), groups))
    best, worst = max(named, key=gain), min(named, key=gain)
    sentence = said(best) + ("; " + said(worst) if worst is not best else "") + "."
    points = [point for group in groups for point in group]
    return Figure(f"{title}: {common(points)}", sentence, points, panels)


def effect_figures(points, field, title):
    by_family = {}
    for group in grouped(points, field):
        key = group[0].version, group[0].key("warps", "lanes", "units", field)
        by_family.setdefault(key, []).append(group)
    parts = [family[begin:begin + MOST_ROWS] for family in by_family.values()
             for begin in range(0, len(family), MOST_ROWS)]
    return [effect_figure(field, part, title) for part in parts]


def policies_section(points):
    return Section("policies", "Policies", "A policy chooses the next kernel; nothing else differs in a row.",
                   effect_figures(points, "chip.policy", "Speed under each policy"),
                   "No machine here has been run under several policies: make sim ENGINE=model SET=chip.policy=fill, "
                   'or "product": {"chip.policy": ["thesis", "fill"]} in an experiment.')


def fields_section(points):
    """One figure for each other field; those that never change alone have none."""
    names = [name for name in dict.fromkeys(name for point in points for name in point.fields) if name not in OWN]
    figures = [figure for name in names if len(values_of(points, name)) > 1
               for figure in effect_figures(points, name, f"Speed with another {name}")]
    return Section("fields", "Other fields, one at a time", "Nothing else differs in a row.", figures,
                   "No other field was changed alone: make sim ENGINE=model SET=data_cache.bytes=4096, or make sweep "
                   "EXPERIMENT=configs/experiments/caches.json.")


def values_of(points, name):
    return {str(point[name]) for point in points}
