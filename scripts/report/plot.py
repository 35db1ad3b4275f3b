"""A plot as inline SVG: Matplotlib draws it, and what it writes is made fit for a page: colours become the page's
variables, ids are the page's own, marks get their words, and a title and a description stand for the whole."""
import io
import re
import xml.etree.ElementTree as ElementTree

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .style import VARIABLES, colour

# Pixels at which letters have their size; a phone shows a plot a little smaller, a wide page a little larger.
WIDTH = 350
LETTERS = 11
SVG = "http://www.w3.org/2000/svg"
LINK = "{http://www.w3.org/1999/xlink}href"
COLOUR = re.compile(r"#[0-9a-f]{6}\b")

matplotlib.rcParams.update({
    "svg.fonttype": "none", "svg.hashsalt": "raypool", "font.family": "DejaVu Sans", "font.size": LETTERS,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
    "axes.edgecolor": colour("muted"), "axes.labelcolor": colour("muted"), "axes.linewidth": 0.8,
    "axes.labelsize": LETTERS, "xtick.labelsize": LETTERS - 0.5, "ytick.labelsize": LETTERS - 0.5,
    "xtick.color": colour("muted"), "ytick.color": colour("muted"), "text.color": colour("ink"),
    "xtick.major.size": 3, "ytick.major.size": 0, "grid.color": colour("line"), "grid.linewidth": 0.7,
    "lines.linewidth": 1.6, "lines.markersize": 6, "hatch.linewidth": 0.6,
})  # fmt: skip


class Plot:
    """`axes` is Matplotlib's. `tip` gives an artist its words, which show when it is pointed at."""

    def __init__(self, height=250):
        self.figure = Figure(figsize=(WIDTH / 72, height / 72), layout="constrained")
        # Which knows how large letters are.
        FigureCanvasAgg(self.figure)
        self.axes = self.figure.subplots()
        self.figure.patch.set_visible(False)
        self.axes.patch.set_visible(False)
        self.tips = {}

    def tip(self, artist, words):
        name = f"tip{len(self.tips)}"
        artist.set_gid(name)
        self.tips[name] = words

    def mark(self, x, y, name, marker="o", words="", hollow=False, size=6.5):
        """One point. `name` is that of its colour."""
        face = colour("paper") if hollow else colour(name)
        (artist,) = self.axes.plot([x], [y], marker=marker, color=colour(name), markerfacecolor=face, linestyle="none",
                                   markersize=size, markeredgewidth=1.3, zorder=3, clip_on=False)
        if words:
            self.tip(artist, words)

    def finish(self, number, title, description):
        """The SVG. Ids begin with p and the number."""
        out = io.StringIO()
        self.figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
        root = ElementTree.fromstring(out.getvalue())
        # What it is made with, and a style for all of the document.
        for parent in list(root.iter()):
            for child in list(parent):
                if child.tag in (f"{{{SVG}}}metadata", f"{{{SVG}}}style"):
                    parent.remove(child)
        _name_ids(root, f"p{number}-")
        _colours(root)
        for group in root.iter(f"{{{SVG}}}g"):
            words = self.tips.get(group.attrib.pop("id", ""))
            if words:
                title_of_mark = ElementTree.Element(f"{{{SVG}}}title")
                title_of_mark.text = words
                group.insert(0, title_of_mark)
        _unwrap(root)
        _describe(root, number, title, description)
        return _serialised(root)


def _name_ids(root, prefix):
    """Ids that something refers to are numbered; groups of tips keep theirs for now, all others go."""
    used = set(re.findall(r"url\(#([^)]+)\)", " ".join(v for e in root.iter() for v in e.attrib.values())))
    used |= {e.attrib[LINK][1:] for e in root.iter() if LINK in e.attrib}
    names = {}
    for element in root.iter():
        name = element.attrib.get("id")
        if name in used:
            element.set("id", names.setdefault(name, f"{prefix}{len(names)}"))
        elif name is not None and not re.fullmatch(r"tip\d+", name):
            del element.attrib["id"]
    for element in root.iter():
        for attribute, value in list(element.attrib.items()):
            if attribute == LINK:
                del element.attrib[LINK]
                element.set("href", "#" + names[value[1:]])
            elif "url(#" in value:
                element.set(attribute, re.sub(r"url\(#([^)]+)\)", lambda match: f"url(#{names[match[1]]})", value))


def _colours(root):
    """Styles with the page's variables and the page's letters."""
    for element in list(root.iter()):
        for attribute in ("style", "fill", "stroke"):
            value = element.attrib.get(attribute)
            if value is None:
                continue
            style = value if attribute == "style" else f"{attribute}: {value}"
            style = COLOUR.sub(lambda match: f"var(--{VARIABLES[match[0]]})", style)
            style = re.sub(r"font: ([\d.]+)px [^;]*", r"font-size: \1px", style)
            if attribute == "style":
                element.set("style", style)
            elif "var(" in style:
                del element.attrib[attribute]
                element.set("style", style + "; " + element.attrib.get("style", ""))
        if element.tag == f"{{{SVG}}}text" and "fill:" not in element.attrib.get("style", ""):
            element.set("style", element.attrib.get("style", "") + "; fill: var(--ink)")


def _unwrap(parent):
    """Groups that say nothing of their own go, which is half of the text."""
    children = []
    for child in parent:
        _unwrap(child)
        plain = child.tag == f"{{{SVG}}}g" and not child.attrib and not any(c.tag.endswith("title") for c in child)
        children += list(child) if plain else [child]
    parent[:] = children


def _describe(root, number, title, description):
    for place, (tag, words) in enumerate((("title", title), ("desc", description))):
        element = ElementTree.Element(f"{{{SVG}}}{tag}", {"id": f"p{number}-{tag}"})
        element.text = words
        root.insert(place, element)
    root.attrib.pop("width"), root.attrib.pop("height"), root.attrib.pop("version", None)
    root.set("role", "img")
    root.set("class", "plot")
    root.set("aria-labelledby", f"p{number}-title p{number}-desc")


def _serialised(root):
    ElementTree.register_namespace("", SVG)
    text = ElementTree.tostring(root, encoding="unicode")
    # Three digits behind the point are a thousandth of a pixel.
    text = re.sub(r"(\d+\.\d{3})\d+", r"\1", text)
    text = re.sub(r' transform="rotate\(-?0 [^)]*\)"', "", text)
    text = re.sub(r"<(g|defs) />", "", text)
    return re.sub(r">\s+<", "><", text)
