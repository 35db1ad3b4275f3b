"""What each point of a small sweep gains or loses against its first: speed, area, power, picture."""
from .figure import Figure, Section, Table, change, number
from .pictures import compare
from .point import common, differing, short_field

MOST_POINTS = 12
COLUMNS = [
    ("Mrays/s", lambda point: point.rate),
    ("cycles", lambda point: point.report["cycles"]),
    ("mm2", lambda point: point.area_mm2),
    ("Mrays/s a mm2", lambda point: point.rate / point.area_mm2 if point.area_mm2 else None),
    ("W", lambda point: point.watts),
]
MISSING = ("A sweep of 2 to 12 points is compared here, point by point with its first: make sweep "
           "EXPERIMENT=configs/experiments/caches.json is one.")


def said(first, point):
    names = differing([first, point], "engine")
    return ", ".join(short_field(name, point[name]) for name in names) or "the same machine"


def picture_words(first, point):
    if not (first.picture and point.picture):
        return "–"
    found = compare(first, point)
    if not found.get("compared"):
        return "another size" if "sizes" in str(found.get("reason")) else "–"
    if not found["differ"]:
        return "the same"
    return (f"{found['differ']:,} pixels differ",
            f"of {found['pixels']:,}, by at most {found['largest_difference']} of 255")


def sentence(first, point):
    """In words, for the last point: what it gains or loses."""
    words = f"With {said(first, point)}: {change(first.rate, point.rate)} Mrays/s"
    if first.area_mm2 and point.area_mm2:
        gain = change(first.rate / first.area_mm2, point.rate / point.area_mm2)
        words += f", {change(first.area_mm2, point.area_mm2)} area, {gain} Mrays/s for the area"
    else:
        words += ", area not known (make synth for both machines, or \"area\": true in the experiment)"
    picture = picture_words(first, point)
    picture = picture if isinstance(picture, str) else picture[0] + " " + picture[1]
    return f"{words}; picture: {picture}."


def figure(sweep):
    points = [point for point in sweep.points if point.timed]
    first = points[0]
    columns = [(head, value) for head, value in COLUMNS if any(value(point) is not None for point in points)]
    heads = ["change", *(head for head, _ in columns), "picture"]

    def cell(value, point):
        return number(value(point)), "" if point is first else change(value(first), value(point))

    def row(point):
        own = f"{point.machine} (first)" if point is first else said(first, point)
        return [own, *(cell(value, point) for _, value in columns),
                "" if point is first else picture_words(first, point)]

    return Figure(f"{sweep.title}: {common(points)}", sentence(first, points[-1]), points,
                  tables=[Table("Against the first point", heads, [row(point) for point in points])])


def section(sweeps):
    small = [sweep for sweep in sweeps if 2 <= sum(point.timed for point in sweep.points) <= MOST_POINTS]
    intro = "Each point of a small sweep beside its first: what was changed, and what that did."
    return Section("changes", "What a change does", intro, [figure(sweep) for sweep in small], MISSING)
