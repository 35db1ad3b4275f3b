"""The scene, and what a ray hits in it: computed here in double precision from the files that raypool scene writes
(docs/use/tree-file.md), without a line of what the chip's traverser is made of."""
import math
import struct
from dataclasses import dataclass

from .errors import FollowError

LEAF, NO_CHILD = 1 << 31, 0xFFFFFFFF


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(a, factor):
    return tuple(x * factor for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return scale(a, 1 / math.sqrt(dot(a, a)))


@dataclass
class Hit:
    t: float
    u: float
    v: float
    triangle: int


@dataclass
class Triangle:
    corners: list
    number: int
    material: int

    def normal(self):
        a, b, c = self.corners
        return unit(cross(subtract(b, a), subtract(c, a)))

    def hit(self, origin, direction, limit):
        """Moeller and Trumbore's test."""
        a, b, c = self.corners
        ab, ac = subtract(b, a), subtract(c, a)
        p = cross(direction, ac)
        determinant = dot(ab, p)
        if determinant == 0:
            return None
        s = subtract(origin, a)
        u = dot(s, p) / determinant
        q = cross(s, ab)
        v = dot(direction, q) / determinant
        t = dot(ac, q) / determinant
        return Hit(t, u, v, self.number) if u >= 0 and v >= 0 and u + v <= 1 and 0 < t < limit else None


@dataclass
class Child:
    """A child of a node: its box, and the node or the leaf's triangles."""

    lower: tuple
    upper: tuple
    node: int = -1
    first: int = 0
    count: int = 0

    def name(self):
        return f"node {self.node}" if self.count == 0 else f"leaf of {self.count}"

    def interval(self, origin, direction, limit):
        """From which t to which the ray is in the box; from is greater where it never is."""
        begin, end = 0.0, limit
        for o, d, low, high in zip(origin, direction, self.lower, self.upper):
            if d == 0:
                if not low <= o <= high:
                    return 1.0, 0.0
                continue
            near, far = sorted(((low - o) / d, (high - o) / d))
            begin, end = max(begin, near), min(end, far)
        return begin, end


class Tree:
    """A file of raypool scene --write-bvh."""

    def __init__(self, data):
        if data[:8] != b"rayp-bvh" or struct.unpack_from("<I", data, 8) != (1,):
            raise FollowError("what raypool scene --write-bvh wrote is not a tree of version 1")
        nodes, triangles, node_place, triangle_place = struct.unpack_from("<IIQQ", data, 40)
        self.nodes = [self.node(data, node_place + 64 * number) for number in range(nodes)]
        self.triangles = [self.triangle(data, triangle_place + 44 * place) for place in range(triangles)]
        self.largest = max((abs(x) for one in self.triangles for corner in one.corners for x in corner), default=0)
        self.by_number = {triangle.number: triangle for triangle in self.triangles}

    @staticmethod
    def triangle(data, place):
        values = struct.unpack_from("<9f2I", data, place)
        return Triangle([values[0:3], values[3:6], values[6:9]], values[9], values[10])

    def has(self, leaf, number):
        """Whether it is a leaf with this triangle."""
        return any(one.number == number for one in self.triangles[leaf.first : leaf.first + leaf.count])

    @staticmethod
    def node(data, place):
        origin = struct.unpack_from("<3f", data, place)
        steps = [2.0**exponent for exponent in struct.unpack_from("<3b", data, place + 12)]
        children = []
        for i in range(data[place + 15]):
            lower, upper = (
                tuple(origin[axis] + data[place + first + 4 * axis + i] * steps[axis] for axis in range(3))
                for first in (16, 28)
            )
            (word,) = struct.unpack_from("<I", data, place + 40 + 4 * i)
            child = Child(lower, upper)
            if word & LEAF:
                child.first, child.count = word & 0x1FFFFFFF, (word >> 29 & 3) + 1
            else:
                child.node = word
            children.append(child)
        return children

    def nearest_of_all(self, origin, direction, limit):
        """Every triangle in turn; of two at the same t that of the lower number."""
        hits = (triangle.hit(origin, direction, limit) for triangle in self.triangles)
        return min((hit for hit in hits if hit), key=lambda hit: (hit.t, hit.triangle), default=None)

    def walk(self, origin, direction, limit, any_hit=False):
        """The hit that the tree leads to, with `any_hit` in the first leaf that has one; and what is tested on the way:
        ("node", number, [(child, begin, end)]) and ("leaf", child, [(triangle, hit)]), and ("skip", child, begin) for
        what lies behind the best hit when its turn comes."""
        best, steps, stack = None, [], [(0.0, Child((), (), node=0))] if self.nodes else []
        while stack:
            begin, child = stack.pop()
            if best and begin > best.t:
                steps.append(("skip", child, begin))
                continue
            if child.count:
                tests = []
                for triangle in self.triangles[child.first : child.first + child.count]:
                    hit = triangle.hit(origin, direction, limit)
                    tests.append((triangle, hit))
                    if hit and (best is None or (hit.t, hit.triangle) < (best.t, best.triangle)):
                        best = hit
                steps.append(("leaf", child, tests))
                if best and any_hit:
                    break
                continue
            boxes = [
                (one, *one.interval(origin, direction, best.t if best else limit)) for one in self.nodes[child.node]
            ]
            steps.append(("node", child.node, boxes))
            # The nearest comes first: it is pushed last.
            stack += sorted(((b, one) for one, b, e in boxes if b <= e), key=lambda item: -item[0])
        return best, steps


def materials_of(text):
    """(diffuse, mirror reflectance) of each material of an MTL file."""
    materials = []
    for line in text.splitlines():
        words = line.split()
        if words and words[0] == "newmtl":
            materials.append([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
        elif words and words[0] in ("Kd", "Ks"):
            materials[-1][words[0] == "Ks"] = tuple(map(float, words[1:4]))
    return materials


@dataclass
class Light:
    """What is expected of a ray, and of what it hits."""

    origin: tuple
    direction: tuple
    color: tuple
    useful: bool  # it may add to the picture
    brightest: float  # the largest that the colour could be: of a shadow ray, were the surface to face the light
    hit: object = None
    free: bool = True  # of a shadow ray


class HostPixel:
    """The light of one pixel, from the camera on: `rays` by the names of packages.name_of()."""

    def __init__(self, tree, materials, view, offset, size, depth):
        self.tree, self.materials, self.view, self.offset, self.depth = tree, materials, view, offset, depth
        self.width, self.height = size
        self.rays, self.color = {}, (0.0, 0.0, 0.0)

    def eye_direction(self, pixel):
        """Through the centre of the pixel."""
        forward = unit(self.view["direction"])
        right = unit(cross(forward, self.view["up"]))
        up = cross(right, forward)
        side = 2 * math.tan(math.radians(self.view["fov"]) / 2) / self.height
        across, down = pixel[0] - (self.width - 1) / 2, pixel[1] - (self.height - 1) / 2
        return add(forward, add(scale(right, across * side), scale(up, -down * side)))

    def follow(self, pixel):
        self.cast(tuple(self.view["eye"]), self.eye_direction(pixel), (1.0, 1.0, 1.0), 1)

    def cast(self, origin, direction, weight, depth):
        ray = Light(origin, direction, weight, any(weight) and depth <= self.depth, max(weight))
        self.rays["eye" if depth == 1 else f"reflection{depth}"] = ray
        if depth > self.depth:
            return
        ray.hit = self.tree.nearest_of_all(origin, direction, math.inf)
        if ray.hit is None:
            return
        triangle = self.tree.by_number[ray.hit.triangle]
        diffuse, mirror = self.materials[triangle.material]
        normal = triangle.normal()
        facing = normal if dot(direction, normal) <= 0 else scale(normal, -1)
        hit = add(origin, scale(direction, ray.hit.t))
        point = add(hit, scale(facing, self.offset * (max(map(abs, hit)) + ray.hit.t)))
        self.shade(point, facing, [w * kd for w, kd in zip(weight, diffuse)], depth)
        if self.depth > 1 and any(any(ks) for _, ks in self.materials):
            reflected = subtract(direction, scale(normal, 2 * dot(direction, normal)))
            self.cast(point, reflected, tuple(w * ks for w, ks in zip(weight, mirror)), depth + 1)

    def shade(self, point, facing, weight, depth):
        to_light = subtract(self.view["light"]["position"], point)
        cosine = min(1.0, max(0.0, dot(facing, to_light) / math.sqrt(dot(to_light, to_light))))
        full = [w * light for w, light in zip(weight, self.view["light"]["color"])]
        color = tuple(one * cosine for one in full)
        ray = Light(point, to_light, color, any(color), max(full))
        ray.free = self.tree.nearest_of_all(point, to_light, 1.0) is None
        self.rays[f"shadow{depth}"] = ray
        if ray.free:
            self.color = add(self.color, color)
