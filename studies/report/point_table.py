"""The table of all points: its columns and rows."""
from .figure import number
from .point import differing, text
from .rows import ceilings_of

MOST_FIELDS = 12


class Column:
    """`value(point)` is a number, a text or None; `head` is what a filter calls it."""

    def __init__(self, head, value, shown=None):
        self.head, self.value, self.shown = head, value, shown or (lambda value: "–" if value is None else str(value))


class Cell:
    def __init__(self, column, point):
        value = column.value(point)
        self.numeric = isinstance(value, (int, float)) and not isinstance(value, bool)
        self.raw = repr(value) if self.numeric else None
        self.shown = column.shown(value)


def lowest_ceiling(point):
    ceilings = point.report.get("ceilings")
    return ceilings.get("lowest") if ceilings and ceilings_of(point) else None


def report_share(field):
    def value(point):
        share = point.report[field]
        return None if share is None else round(100 * share, 2)

    return value


def field(name):
    def value(point):
        found = point[name]
        return text(found) if isinstance(found, bool) else found

    return value


def at_clock_of(library):
    """Mrays/s at the clock that a library allows; a run's own count a clock of 1 GHz."""
    def value(point):
        mhz = point.clocks.get(library)
        return point.rate * mhz / 1000 if mhz and point.rate is not None else None

    return value


def columns(points):
    fixed = [
        Column("no", lambda point: point.number),
        Column("machine", lambda point: point.machine),
        Column("scene", lambda point: point.report["scene"]["name"]),
        Column("size", field("size")),
        Column("depth", field("depth")),
        Column("engine", field("engine")),
        Column("units", field("units")),
        Column("warps", field("warps")),
        Column("lanes", field("lanes")),
        Column("Mrays/s", lambda point: point.rate, number),
        *(Column(f"Mrays/s {library}", at_clock_of(library), number)
          for library in sorted({library for point in points for library in point.clocks})),
        Column("cycles", lambda point: point.report["cycles"], number),
        Column("rays", lambda point: point.report["rays"], number),
        Column("time%", report_share("time_utilisation")),
        Column("threads%", report_share("resource_utilisation")),
        Column("ceiling", lowest_ceiling),
        Column("mm2", lambda point: point.area_mm2, number),
        Column("Mrays/s/mm2", lambda p: p.rate / p.area_mm2 if p.area_mm2 and p.rate is not None else None, number),
        Column("W", lambda point: point.watts, number),
    ]
    shown = {"scene", "view", "size", "depth", "engine", "units", "warps", "lanes"}
    more = [name for name in differing(points) if name not in shown][:MOST_FIELDS]
    kept = [column for column in fixed if column.head in ("no", "machine")
            or any(column.value(point) is not None for point in points)]
    return kept + [Column(name, field(name)) for name in more] + [Column("from", place_of)]


def place_of(point):
    return point.sweep.title if point.sweep else "run"


def rows(points, all_columns):
    return [(point, [Cell(column, point) for column in all_columns]) for point in points]


def machines(points):
    """[(name, configuration, points)], each distinct machine once."""
    found = {}
    for point in points:
        found.setdefault((point.machine, str(point.report["configuration"])), []).append(point)
    return [(name, members[0].report["configuration"], members) for (name, _), members in found.items()]
