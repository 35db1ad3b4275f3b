"""The rays in the scene, as a picture: along the axis in which they go least."""
from diagrams.svg import NAME, NAME_WIDTH, WIDTH, Picture

from . import packages, picture
from .packages import DIRECTION, ORIGIN
from .scene import add, scale

RAY = "#d98a00"  # on light and on dark ground
HEIGHT = 480  # of the scene at most
MOST_FILLED = 500  # triangles: of more only the outlines are drawn
SEEN = ("from +x", "from above", "from +z")


def ends_of(life):
    """From where to where a ray goes; of one that hits nothing, as far as its direction is long."""
    origin, direction = (tuple(packages.floats(life.words, first)) for first in (ORIGIN, DIRECTION))
    t = packages.to_float(life.put.words[packages.DISTANCE]) if life.fate == "hit" else 1.0
    return origin, add(origin, scale(direction, t))


def crosses(box, line):
    """Whether a line comes through a box, at one of its many points."""
    (x0, y0), (x1, y1) = line
    points = ((x0 + n / 100 * (x1 - x0), y0 + n / 100 * (y1 - y0)) for n in range(101))
    return any(box[0] < x < box[2] and box[1] < y < box[3] for x, y in points)


def meet(box, other):
    return box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3]


class Labels:
    """Words beside lines, where no line and no other words are."""

    def __init__(self, drawn, lines):
        self.drawn, self.lines, self.taken = drawn, lines, []

    def put(self, places, words, kind="part"):
        """At the first of the places, each with what it is of the words, that is free; else at the first."""
        boxes = [(self.box(x, y, words, anchor), x, y, anchor) for x, y, anchor in places]
        free = [one for one in boxes if one[0][0] > 6 and one[0][2] < WIDTH - 6
                and not any(crosses(one[0], line) for line in self.lines)
                and not any(meet(one[0], other) for other in self.taken)]  # fmt: skip
        box, x, y, anchor = (free or boxes)[0]
        self.taken.append(box)
        self.drawn.text(x, y, words, kind, anchor)

    @staticmethod
    def box(x, y, words, anchor):
        left = x - (len(words) * NAME_WIDTH if anchor == "end" else 0)
        return left - 3, y - NAME, left + len(words) * NAME_WIDTH + 3, y + 4


class View:
    """Which axes are seen, and where a point is in the picture."""

    def __init__(self, points, rays):
        extent = [max(p[axis] for p in rays) - min(p[axis] for p in rays) for axis in range(3)]
        self.along = extent.index(min(extent))
        self.across, self.down = {0: (2, 1), 1: (0, 2), 2: (0, 1)}[self.along]
        self.low = [min(point[axis] for point in points) for axis in range(3)]
        self.high = [max(point[axis] for point in points) for axis in range(3)]
        size = [high - low for low, high in zip(self.low, self.high)]
        self.factor = min((WIDTH - 240) / size[self.across], HEIGHT / size[self.down])
        self.left = (WIDTH - size[self.across] * self.factor) / 2
        self.height = size[self.down] * self.factor

    def place(self, point):
        upwards = self.down == 1
        y = self.high[1] - point[1] if upwards else point[self.down] - self.low[self.down]
        return self.left + (point[self.across] - self.low[self.across]) * self.factor, 60 + y * self.factor

    def title(self):
        way = "upwards" if self.down == 1 else "downwards"
        axes = f"{'xyz'[self.across]} to the right, {'xyz'[self.down]} {way}"
        return f"The rays in the scene, seen {SEEN[self.along]}: {axes}"


def draw_triangles(drawn, view, tree, materials):
    filled = len(tree.triangles) <= MOST_FILLED
    for triangle in sorted(tree.triangles, key=lambda one: max(corner[view.along] for corner in one.corners)):
        outline = " L".join("%.1f %.1f" % view.place(corner) for corner in triangle.corners)
        colour = ",".join(str(picture.to_srgb8(kd)) for kd in materials[triangle.material][0])
        fill = f'fill="rgb({colour})" fill-opacity="0.45"' if filled else 'fill="none"'
        width = "0.6" if filled else "0.2"
        drawn.shapes.append(f'<path d="M{outline} Z" {fill} stroke="#808890" stroke-width="{width}"/>')


def way_picture(journey, tree, materials):
    lives = [life for life in journey.lives.values() if life.fate != "dropped"]
    ends = [ends_of(life) for life in lives]
    rays = [point for pair in ends for point in pair]
    view = View([corner for triangle in tree.triangles for corner in triangle.corners] + rays, rays)
    drawn = Picture(round(view.height) + 84, "raypool: the path of the light through the scene")
    drawn.text(16, 24, view.title(), "part")
    draw_triangles(drawn, view, tree, materials)
    lines = [(view.place(begin), view.place(end)) for begin, end in ends]
    labels = Labels(drawn, lines)
    for life, ((x0, y0), (x1, y1)) in zip(lives, lines):
        dashes = ' stroke-dasharray="6 4"' if packages.is_shadow(life.words) else ""
        drawn.shapes.append(f'<path d="M{x0:.1f} {y0:.1f} L{x1:.1f} {y1:.1f}" fill="none" stroke="{RAY}" '
                            f'stroke-width="2.2"{dashes}/>')  # fmt: skip
        drawn.shapes.append(f'<circle cx="{x1:.1f}" cy="{y1:.1f}" r="4" fill="{RAY}"/>')
    around = ((10, 4, "start"), (-10, 4, "end"), (0, 20, "start"), (0, -10, "start"))
    (x, y), lights = lines[0][0], [line[1] for life, line in zip(lives, lines) if packages.is_shadow(life.words)]
    labels.put([(x + dx, y + dy, anchor) for dx, dy, anchor in around], "camera", "part")
    for x, y in lights[:1]:
        labels.put([(x + dx, y + dy, anchor) for dx, dy, anchor in around], "light", "part")
    for life, ((x0, y0), (x1, y1)) in zip(lives, lines):
        places = [(x0 + at * (x1 - x0) + dx, y0 + at * (y1 - y0) + dy, anchor)
                  for at in (0.5, 0.35, 0.65, 0.2, 0.8) for dx, dy, anchor in around]  # fmt: skip
        labels.put(places, life.name, "name")
    return drawn
