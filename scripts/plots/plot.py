"""A plot, which Matplotlib draws: as SVG inside a page (finish), where colours become the page's variables, ids are the
page's own, marks get their words, and a title and a description stand for the whole; or as a picture of its own (save).
"""
import io
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

try:
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
except ImportError:
    sys.exit("Matplotlib, which draws plots, was not found: scripts/setup.sh report installs it, for /usr/bin/python3")

from .style import VARIABLES, colour, css

# Pixels at which letters have their size: in a page, where a phone shows a plot a little smaller and a wide page a
# little larger; and of a picture of its own.
WIDTH = 350
WIDE = 720
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
    """`axes` is Matplotlib's, of several `panels` the first of `panels`. `tip` gives an artist its words, which show
    when it is pointed at."""

    def __init__(self, height=250, width=WIDTH, panels=(1, 1)):
        self.figure = Figure(figsize=(width / 72, height / 72), layout="constrained")
        # Which knows how large letters are.
        FigureCanvasAgg(self.figure)
        self.panels = list(self.figure.subplots(*panels, squeeze=False).flat)
        self.axes = self.panels[0]
        self.figure.patch.set_visible(False)
        for axes in self.panels:
            axes.patch.set_visible(False)
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

    def title(self, *lines):
        self.figure.suptitle("\n".join(map(plain, lines)), fontsize=LETTERS + 1)

    def bars(self, names, series, stacked=False, axes=None):
        """For each name a group, or a stack, of bars; `series` are (words, colour, values). Returns the axes."""
        axes = axes or self.axes
        width = 0.8 / (1 if stacked else len(series))
        base = [0.0] * len(names)
        for place, (words, name, values) in enumerate(series):
            shift = 0 if stacked else (place - (len(series) - 1) / 2) * width
            axes.bar([at + shift for at in range(len(names))], values, width, bottom=base if stacked else 0,
                     color=colour(name), label=plain(words))
            base = [low + value for low, value in zip(base, values)]
        axes.set_xlim(-0.6, len(names) - 0.4)
        axes.grid(axis="x", visible=False)
        named_places(axes, names)
        return axes

    def line(self, xs, ys, name, marker="o", words=None):
        self.axes.plot(xs, ys, color=colour(name), marker=marker, label=words and plain(words), clip_on=False, zorder=3)

    def finish(self, number, title, description):
        """The SVG for a page. Ids begin with p and the number."""
        root = self._drawn(number)
        _describe(root, number, title, description)
        return _serialised(root)

    def save(self, path, title):
        """As SVG with colours for light and dark readers, or as PNG, by the name of the file."""
        if pathlib.Path(path).suffix != ".svg":
            self.figure.patch.set(visible=True, facecolor=colour("paper"))
            self.figure.savefig(path, dpi=100, metadata={"Software": None})
            return
        root = self._drawn(0)
        _describe(root, 0, title, title)
        width, height = (round(72 * size) for size in self.figure.get_size_inches())
        root.set("width", str(width)), root.set("height", str(height))
        style = ElementTree.Element(f"{{{SVG}}}style")
        style.text = css() + "text { font-family: 'DejaVu Sans', Verdana, sans-serif }"
        plate = {"width": str(width), "height": str(height), "style": "fill: var(--paper)"}
        root.insert(2, style)
        root.insert(3, ElementTree.Element(f"{{{SVG}}}rect", plate))
        pathlib.Path(path).write_text(_serialised(root) + "\n", encoding="utf-8")

    def _drawn(self, number):
        """What Matplotlib writes, with the page's variables and ids."""
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
        return root


def plain(words):
    """Words that Matplotlib does not take for a formula, nor refuses."""
    return re.sub(r"[\x00-\x1f\x7f]", "?", words).replace("$", r"\$")


def named_places(axes, names):
    """Names below the places 0, 1, ..., aslant if they are long."""
    aslant = sum(map(len, names)) > 90
    axes.set_xticks(range(len(names)), [plain(name) for name in names], rotation=35 if aslant else 0,
                    ha="right" if aslant else "center", rotation_mode="anchor")


def legend(axes, reverse=False, **where):
    """Of what is named; `reverse`: the last one first, as it lies at the top of a stack."""
    step = -1 if reverse else 1
    handles, words = (found[::step] for found in axes.get_legend_handles_labels())
    axes.legend(handles, words, **{"frameon": False, "fontsize": LETTERS - 0.5, "handlelength": 1.4,
                                   "borderaxespad": 0.2, **where})  # fmt: skip


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
    """Groups that add nothing go, which is half of the text."""
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
