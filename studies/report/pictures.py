"""The pictures that were drawn, each once, and beside them Embree's own: that of engine native with Embree's hits, with
exact arithmetic where there is one."""
import base64
import json
import shlex

from sweep import raypool
from sweep.errors import SweepError
from sweep.raypool import digest_of_file

from .point import differing, labels, near

# So that the page stays one that opens.
MOST_BYTES = 24_000_000
PNG_END = b"IEND\xaeB`\x82"
EXACT = {"arithmetic.subnormals": "ieee", "arithmetic.significand": 24, "arithmetic.slow_unit": "exact",
         "arithmetic.fma": False}  # fmt: skip
# Options of raypool sim that are of other engines, or of a machine, which Embree's own picture does not ask for.
OF_OTHERS = ("--engine", "--boundary", "--unit-library", "--hits", "--set", "--traverser", "--trace", "--error",
             "--within", "--seed", "--cycles", "--inspect")  # fmt: skip


class Picture:
    """`points` drew it; `reference` is the point it is compared with, None where there is none."""

    def __init__(self, points, reference):
        self.points, self.reference = points, reference
        self.point = points[0]
        self.comparison = None
        self.data = None

    @property
    def size(self):
        return self.point.report["size"]

    @property
    def differ(self):
        return self.comparison["differ"] if self.comparison and self.comparison.get("compared") else None

    @property
    def is_ours(self):
        """Machines drew it, and not Embree alone."""
        return any(not point.is_embrees for point in self.points)

    @property
    def reference_command(self):
        """That would draw Embree's own."""
        words, kept = iter(shlex.split(self.point.command)), []
        for word in words:
            if word in OF_OTHERS:
                next(words, None)
            elif word.split("=")[0] not in (*OF_OTHERS, "--waves"):
                kept.append(word)
        return "build/" + shlex.join([*kept, "--engine", "native", "--hits", "embree"])


def scene_key(point):
    return tuple(str(point[name]) for name in ("scene", "view", "size", "depth"))


def compare(a, b):
    """What `raypool compare` reports of two points' pictures."""
    try:
        return json.loads(raypool.ask("compare", a.folder, b.folder, "--json"))["picture"]
    except SweepError as error:
        return {"compared": False, "reason": str(error)}


def references_of(points):
    """{scene: point} of Embree's hits; exact arithmetic is preferred."""
    found = {}
    for point in points:
        if point.is_embrees and point.picture:
            kept = found.setdefault(scene_key(point), point)
            if not is_exact(kept) and is_exact(point):
                found[scene_key(point)] = point
    return found


def is_exact(point):
    # None: a report from before there was the field.
    return all(point[name] in (value, None) for name, value in EXACT.items())


def collect(points, notes):
    """[[Picture]]: those of one scene, view, size and depth together, Embree's own first if it is there."""
    references = references_of(points)
    scenes = {}
    for point in points:
        if point.picture:
            try:
                digest = digest_of_file(point.picture)
            except OSError as error:
                notes.append(f"{near(point.picture)} cannot be read ({error.strerror})")
                continue
            scenes.setdefault(scene_key(point), {}).setdefault(digest, []).append(point)
    used, found = 0, []
    for key, by_digest in scenes.items():
        reference = references.get(key)
        pictures = [Picture(members, reference) for members in by_digest.values()]
        pictures.sort(key=lambda picture: reference not in picture.points)
        shown = []
        for picture in pictures:
            with open(picture.point.picture, "rb") as file:
                data = file.read()
            if not data.endswith(PNG_END):
                notes.append(f"{near(picture.point.picture)} is no whole PNG file: run its report's command again")
                continue
            if used + len(data) > MOST_BYTES:
                notes.append(f"{near(picture.point.picture)}, as the page has {MOST_BYTES // 10**6} MB of pictures: "
                             "make report FROM= with fewer folders shows it")
                continue
            used += len(data)
            picture.data = base64.b64encode(data).decode()
            if reference is not None:
                picture.comparison = compare(reference, picture.point)
            shown.append(picture)
        if shown:
            found.append(shown)
    return found


def engines_and_machines(picture):
    """Which engines and machines drew it, in words."""
    engines = ", ".join(dict.fromkeys(point["engine"] for point in picture.points))
    machines = list(dict.fromkeys(point.machine for point in picture.points))
    more = f" and {len(machines) - 3} more machines" if len(machines) > 3 else ""
    return f"engine {engines}; {', '.join(machines[:3])}{more}"


def arithmetic_label(pictures):
    """What distinguishes these pictures from each other, if anything chosen does."""
    points = [picture.point for picture in pictures]
    names = [name for name in differing(points) if name.startswith("arithmetic.")]
    every = {name for point in points for name in point.fields}
    return labels(points, *(every - set(names))) if names else [""] * len(pictures)
