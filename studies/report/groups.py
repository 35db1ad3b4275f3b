"""Points of one figure: those that differ in the figure's own fields alone."""


def grouped(points, *fields):
    """Lists of points that differ in nothing but `fields`, the largest first, each set-up once; none of one point."""
    groups = {}
    for point in points:
        group = groups.setdefault((point.version, point.key(*fields)), {})
        group.setdefault(tuple(str(point[field]) for field in fields), point)
    found = [list(group.values()) for group in groups.values() if len(group) > 1]
    return sorted(found, key=lambda group: -len(group))


def values(points, field):
    """Of a field: numbers in order, all else as it comes."""
    found = list(dict.fromkeys(point[field] for point in points))
    numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in found)
    return sorted(found) if numbers else found
