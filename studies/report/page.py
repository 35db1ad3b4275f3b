"""Puts sections, pictures and the table of all points into index.html."""
import json
import os
import shlex

import jinja2
import markupsafe
from matplotlib.markers import MarkerStyle

from plots import style

from . import area, changes, effects, pictures, point_table, published, rows, speed, synthesis, trace
from .point import near

# Of the parts that are not sections of figures: what would fill them.
PICTURES_MISSING = ("No run here has left a picture; make sim ENGINE=model and make sim ENGINE=native HITS=embree "
                    "leave two to compare.")
WORK_MISSING = "No run here has left a trace; make sim ENGINE=model TRACE=1 leaves one."
SYNTHESIS_MISSING = "There is no synthesis report here; make synth CONFIG=4w4c leaves one."
POINTS_MISSING = "There is no run here, only synthesis reports; make sim ENGINE=model makes one."

TEMPLATES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "templates")


def key_picture(key):
    """A line of a legend's mark, as SVG; the shapes are those of the plots."""
    if key.mark in ("", "/", "-"):
        kind = {"": "", "/": " hatched", "-": " pale"}[key.mark]
        return markupsafe.Markup(f'<i class="patch{kind}" style="background-color: var(--{key.name})"></i>')
    marker = MarkerStyle(key.mark)
    path = marker.get_path().transformed(marker.get_transform())
    words = []
    for vertices, code in path.iter_segments(curves=True):
        letter = {1: "M", 2: "L", 3: "Q", 4: "C", 79: "Z"}[int(code)]
        numbers = " ".join(f"{7 + 9 * x if place % 2 == 0 else 7 - 9 * x:.2f}" for place, x in enumerate(vertices))
        words.append(letter + ("" if letter == "Z" else numbers))
    fill = "var(--paper)" if key.hollow else f"var(--{key.name})" if marker.is_filled() else "none"
    return markupsafe.Markup(
        f'<svg class="key" viewBox="-1 -1 16 16" aria-hidden="true"><path d="{"".join(words)}" '
        f'style="fill: {fill}; stroke: var(--{key.name}); stroke-width: 1.6"/></svg>')


def sections_of(sources):
    timed = [point for point in sources.points if point.timed]
    return [
        changes.section(sources.sweeps),
        published.section(timed),
        speed.section(timed),
        rows.alus_section(timed),
        rows.cycles_section(timed),
        rows.ceilings_section(timed),
        effects.units_section(timed),
        effects.policies_section(timed),
        effects.fields_section(timed),
        area.area_section(timed),
        area.power_section(timed),
    ]


def parts_of(sections, sources, drawn, traces):
    """(name, title, why it is missing) of every part of the page, in order; empty: it has something to show."""
    points = "" if sources.points else POINTS_MISSING
    return [
        *((section.name, section.title, "" if section.figures else section.missing) for section in sections),
        ("synthesis", "Synthesis reports", "" if sources.synthesis else SYNTHESIS_MISSING),
        ("pictures", "Pictures", "" if drawn else PICTURES_MISSING),
        ("work", "The machine at work", "" if traces else WORK_MISSING),
        ("points", "All points", points),
        ("machines", "Machines", points),
    ]


def contents_of(sources):
    """'21 points of 3 sweeps, 1 single run'."""
    words = []
    if sources.sweeps:
        points = sum(len(sweep.points) for sweep in sources.sweeps)
        words.append(f"{several_words(points, 'point')} of {several_words(len(sources.sweeps), 'sweep')}")
    if sources.runs:
        words.append(several_words(len(sources.runs), "single run"))
    if sources.synthesis:
        words.append(several_words(len(sources.synthesis), "synthesis report"))
    return ", ".join(words)


def draw(sections):
    """Numbers the figures, and has every plot drawn."""
    panels = 0
    figures = [figure for section in sections for figure in section.figures]
    for place, figure in enumerate(figures, 1):
        figure.number = place
        for panel in figure.panels:
            panels += 1
            panel.svg = markupsafe.Markup(panel.plot.finish(panels, panel.title, panel.description))
    return len(figures)


def commands_of(points):
    """The commands that make these points again: those of their sweeps, and of single runs."""
    sweeps = dict.fromkeys(point.sweep.command for point in points if point.sweep and point.sweep.command)
    runs = [point for point in points if not (point.sweep and point.sweep.command)]
    return list(sweeps), runs


def versions_of(points):
    return list(dict.fromkeys(point.version for point in points))


def render(sources, folders):
    """The whole page as text, and how many figures it has."""
    points = sources.points
    for place, point in enumerate(points, 1):
        point.number = place
    sections = sections_of(sources)
    figures = draw(sections)
    notes = list(sources.notes)
    drawn = pictures.collect(points, notes)
    traces = trace.collect(points, notes)
    columns = point_table.columns(points) if points else []
    parts = parts_of(sections, sources, drawn, traces)
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    environment.globals.update(
        key_picture=key_picture, commands_of=commands_of, versions_of=versions_of, machine_id=machine_ids(points),
        engines_and_machines=pictures.engines_and_machines, arithmetic_label=pictures.arithmetic_label,
        code=lambda value: json.dumps(value), several=several_words)
    page = environment.get_template("page.html").render(
        variables=markupsafe.Markup(style.css()), sections=[section for section in sections if section.figures],
        present=[(name, title) for name, title, missing in parts if not missing],
        absent=[(title, missing) for _, title, missing in parts if missing], contents=contents_of(sources),
        synthesis=synthesis.table(sources.synthesis), notes=notes, pictures=drawn, traces=traces, alus=style.ALUS,
        columns=columns,
        rows=point_table.rows(points, columns), machines=point_table.machines(points),
        command=f"make report FROM={shlex.quote(' '.join(near(folder) for folder in folders))}",
        versions=versions_of(points))
    return page, figures, notes


def several_words(count, word):
    return f"{count:,} {word}{'' if count == 1 else 's'}"


def machine_ids(points):
    """The id of a point's machine in the list at the end."""
    ids = {}
    for place, (_, _, members) in enumerate(point_table.machines(points), 1):
        ids.update({id(point): f"machine-{place}" for point in members})
    return lambda point: ids[id(point)]
