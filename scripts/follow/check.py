"""The journey beside what the host computes (scene.py), and beside the pictures that were written."""
import math

from . import packages, picture
from .packages import COLOR, DIRECTION, DISTANCE, NORMAL, ORIGIN, TRIANGLE

WITHIN = 1e-5  # of what a value's parts are as large as: what single precision may add up to on the way


class Check:
    """What was compared, a line each."""

    def __init__(self):
        self.lines, self.differ = [], []

    def note(self, what, seen, expected, good):
        line = f"{what}: {seen}" + ("" if good else f", but {expected} by the host's computation")
        self.lines.append(line + ("" if good else "  <-- differs"))
        if not good:
            self.differ.append(line)

    def vector(self, what, seen, expected, size=0.0):
        """`size`: of what has been added and subtracted for it."""
        most = WITHIN * (max(*map(abs, expected), size) or 1)
        good = all(math.isfinite(one) and abs(one - other) <= most for one, other in zip(seen, expected))
        self.note(what, packages.text(seen), packages.text(expected), good)

    def rays(self, journey, host):
        """All that are expected are there, and no others; a chip that culls leaves out what adds nothing."""
        culling = journey.chip.wave.constant("CULLING")
        for name, expected in host.rays.items():
            if name not in journey.lives and (expected.useful or not culling):
                self.note(name, "there is none", "there is one", False)
        for name, life in journey.lives.items():
            if name in host.rays:
                self.ray(name, life, host.rays[name], host)
            else:
                self.note(name, "there is one", "there is none", False)

    def ray(self, name, life, expected, host):
        size = host.tree.largest
        self.vector(f"{name}, origin", packages.floats(life.words, ORIGIN), expected.origin, size)
        self.vector(f"{name}, direction", packages.floats(life.words, DIRECTION), expected.direction,
                    size if packages.is_shadow(life.words) else 0)  # fmt: skip
        self.vector(f"{name}, colour", packages.floats(life.words, COLOR), expected.color, expected.brightest)
        if life.walk:
            self.walk(name, life, host.tree)
        if packages.is_shadow(life.words):
            fates = ("blocked", "free")
            if life.fate != "dropped":
                self.note(
                    f"{name}, path to the light", life.fate, fates[expected.free], life.fate == fates[expected.free]
                )
        elif life.fate in ("hit", "missed"):
            self.hit(name, life, expected.hit, host)

    def hit(self, name, life, expected, host):
        fate = "missed" if expected is None else "hit"
        if life.fate != fate or expected is None:
            self.note(f"{name}, scene", life.fate, fate, life.fate == fate)
            return
        t, number = packages.to_float(life.put.words[DISTANCE]), life.put.words[TRIANGLE]
        self.note(f"{name}, triangle", number, expected.triangle, number == expected.triangle)
        size = host.tree.largest / max(map(abs, packages.floats(life.words, DIRECTION)))
        self.vector(f"{name}, t", [t], [expected.t], size)
        triangle = host.tree.by_number[expected.triangle]
        self.vector(f"{name}, u and v", packages.floats(life.put.words, DISTANCE + 1, 2), [expected.u, expected.v], 10)
        self.vector(f"{name}, normal", packages.floats(life.put.words, NORMAL), triangle.normal())
        tree_hit, _ = host.tree.walk(*query(life.words))
        self.note(f"{name}, triangle by the tree", number, tree_hit and tree_hit.triangle,
                  tree_hit is not None and tree_hit.triangle == number)  # fmt: skip

    def walk(self, name, life, tree):
        """No box may be missed that the ray is in before its nearest hit, nor the hit's leaf, which may be flat; and
        the walk ends with the hit."""
        origin, direction, limit = query(life.words)
        best = life.walk.best()
        limit = min(limit, best.t) if best else limit
        met = [(number in visit.met, child) for visit in life.walk.visits
               for number, child in enumerate(tree.nodes[visit.node])]  # fmt: skip
        needed = [is_met for is_met, child in met
                  if is_in(child, origin, direction, limit) or best and tree.has(child, best.number)]  # fmt: skip
        self.note(f"{name}, boxes met", f"{sum(is_met for is_met, _ in met)} of {len(met)}",
                  f"{len(needed)} that {len(needed) - sum(needed)} of are not", all(needed))  # fmt: skip
        if life.fate in ("hit", "missed"):
            hit = life.put.words[TRIANGLE] if life.put else None
            self.note(f"{name}, triangle of the walk", best and best.number, hit, (best and best.number) == hit)
        else:
            self.note(f"{name}, walk", "hit" if best else "free", life.fate, bool(best) == (life.fate == "blocked"))

    def colour(self, journey, host, drawn, pixel):
        """The sum of what has left the chip, as the frame buffer adds it, and the picture."""
        x, y = pixel
        fixed = [sum(picture.to_fixed(one[channel]) for one in journey.contributions()) for channel in range(3)]
        linear = [value / 2**32 for value in fixed]
        brightest = sum(ray.brightest for name, ray in host.rays.items() if name.startswith("shadow"))
        self.vector("sum of the contributions", linear, host.color, brightest)
        bytes_of_sum = tuple(map(picture.to_srgb8, linear))
        self.note("image.png", drawn[y][x], bytes_of_sum, drawn[y][x] == bytes_of_sum)


def is_in(child, origin, direction, limit):
    begin, end = child.interval(origin, direction, limit)
    return begin <= end


def query(words):
    """Origin, direction and limit of a ray."""
    return (tuple(packages.floats(words, ORIGIN)), tuple(packages.floats(words, DIRECTION)),
            packages.to_float(words[packages.LIMIT]))  # fmt: skip
