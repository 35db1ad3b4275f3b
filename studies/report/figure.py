"""What sections consist of: figures, each of one or more plots, and tables; with what the page writes below them."""

from .point import differing, short_field


class Key:
    """One line of a legend: a `mark` as Matplotlib names it, or a patch of a bar: '', '/' hatched, '-' pale."""

    def __init__(self, name, mark, words, hollow=False):
        self.name, self.mark, self.words, self.hollow = name, mark, words, hollow


class Panel:
    """A plot with its heading, the numbers in words, its legend, and what numbers in the plot stand for."""

    def __init__(self, title, plot, description, keys=(), listed=()):
        self.title, self.plot, self.description = title, plot, description
        self.keys, self.listed = list(keys), list(listed)
        self.svg = None


class Figure:
    """`sentence` has what matters in numbers; `points` are those that are drawn."""

    def __init__(self, title, sentence, points, panels=(), tables=()):
        self.title, self.sentence, self.points = title, sentence, points
        self.panels, self.tables = list(panels), list(tables)
        self.remarks = []
        self.number = 0


class Table:
    """`rows`: lists of cells. A cell is text, or a pair: the first large, the second small below it. `heads` alike."""

    def __init__(self, title, heads, rows):
        self.title, self.heads, self.rows = title, heads, rows


class Section:
    """`figures`: the first is open, the others can be opened. Without any, `missing` explains what would make one."""

    def __init__(self, name, title, intro, figures, missing):
        self.name, self.title, self.intro, self.figures, self.missing = name, title, intro, figures, missing
        self.notes = []
        tell_apart(figures)
        if len(figures) > MOST_FIGURES:
            self.notes.append(f"{len(figures) - MOST_FIGURES} more figures of this kind could be made: "
                              "make report FROM= with fewer folders shows them.")
            self.figures = figures[:MOST_FIGURES]


def tell_apart(figures):
    """Figures of one title get what differs between them behind it."""
    alike = {}
    for figure in figures:
        alike.setdefault(figure.title, []).append(figure)
    for group in alike.values():
        firsts = [figure.points[0] for figure in group]
        names = differing(firsts, "warps", "lanes", "units")
        for figure, point in zip(group, firsts):
            figure.title += "".join(", " + short_field(name, point[name]) for name in names)


MOST_FIGURES = 16
MOST_ROWS = 48


def number(value):
    """With three digits that count, or all in front of the point."""
    if value is None:
        return "–"
    if isinstance(value, int) or abs(value) >= 1000:
        return f"{value:,.0f}"
    places = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2
    return f"{value:.{places}f}"


def percent(share, places=1):
    return "–" if share is None else f"{100 * share:.{places}f}%"


def change(before, after):
    """'+3.2%'."""
    return "–" if not before or after is None else f"{100 * (after / before - 1):+.1f}%"


def several(count, word):
    return f"{count} {word}{'' if count == 1 else 's'}"
