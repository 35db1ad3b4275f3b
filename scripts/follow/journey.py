"""One pixel's rays from port to port of the chip."""
from dataclasses import dataclass, field

from . import packages
from .errors import FollowError
from .packages import RAY_WORDS, name_of
from .ports import KINDS
from .walk import Walk, walk_lines

STATIONS = ("launch", "instructions", "kernel", "export", "pool", "walk", "traverser", "import", "frame")


@dataclass
class Step:
    """A row of the table."""

    station: str
    cycle: int
    way: str
    what: str
    details: list = field(default_factory=list)


@dataclass
class Span:
    """Where a ray was, for the picture of times."""

    block: str
    begin: int
    end: int


@dataclass
class Life:
    """A ray, and what became of it."""

    name: str
    words: list
    export: object
    steps: list = field(default_factory=list)
    spans: list = field(default_factory=list)
    fate: str = ""  # hit, missed, free, blocked, dropped
    read: object = None
    walk: object = None
    put: object = None
    come: object = None
    asked: int = 0  # the cycle in which the request for it is taken
    launch: object = None  # that imports it; of the eye ray before, that casts it
    thread: int = 0
    contribution: object = None


class Journey:
    """`texts`: the instructions of each kernel, to be shown beside their PCs."""

    def __init__(self, chip, pixel, texts):
        self.chip, self.texts, self.word = chip, texts, pixel[0] | pixel[1] << 16
        self.mismatches = []  # where the waveform contradicts itself
        self.compared = 0
        self.lives = {}
        exported = [number for number, ray in enumerate(chip.exports) if ray.words[packages.PIXEL] == self.word]
        names = [name_of(chip.exports[number].words) for number in exported]
        if names.count("eye") != 1:
            raise FollowError(f"pixel {pixel[0]},{pixel[1]} has {names.count('eye')} eye rays in the waveform, not one")
        for number in exported:
            life = self.live(number)
            if life.name in self.lives:
                raise FollowError(f"pixel {pixel[0]},{pixel[1]} has two rays {life.name} in the waveform")
            self.lives[life.name] = life

    def same(self, what, one, other):
        """What the waveform has in two places."""
        self.compared += 1
        differ = [f"word {n} is {a:08x} and {b:08x}" for n, (a, b) in enumerate(zip(one, other)) if a != b]
        if differ:
            self.mismatches.append(f"{what}: {', '.join(differ)}")

    def live(self, number):
        chip, ray = self.chip, self.chip.exports[number]
        life = Life(name_of(ray.words), ray.words, ray)
        if life.name == "eye":
            self.cast(life)
        life.steps.append(Step(
            "export", ray.offered, "multiprocessor -> ray_pool",
            f"a ray of unit {ray.unit}; its {len(ray.cycles)} beats pass in cycles {ray.cycles[0]} .. {ray.cycles[-1]}",
            packages.ray_text(ray.words)))  # fmt: skip
        outcome = chip.outcomes[number]
        if not chip.wave.value("outcome_kept", outcome):
            deep = chip.wave.value("outcome_deep", outcome)
            life.fate = "dropped"
            life.steps.append(Step(
                "pool", outcome, "ray_pool -> controller", "the ray is dropped: " + (
                    f"depth {packages.depth_of(ray.words)} is more than {chip.wave.constant('depth_limit_i')}"
                    if deep else "it has no weight")))  # fmt: skip
            life.spans.append(Span("ray_pool", ray.cycles[0], outcome))
            return life
        kept = sum(chip.wave.value("outcome_kept", cycle) for cycle in chip.outcomes[:number])
        self.trace(life, outcome, kept)
        return life

    def cast(self, life):
        """The eye ray's kernel."""
        chip = self.chip
        log2, mask = chip.arguments[19], chip.arguments[20]
        x, y = packages.pixel_of(self.word)
        for launch in chip.launches:
            left, top = packages.pixel_of(launch.block)
            thread = (y - top << log2) + x - left
            if launch.kernel == "cast_eye" and 0 <= x - left <= mask and top <= y and thread < launch.threads:
                life.launch, life.thread = launch, thread
                self.run(life, launch, thread, f"block {left},{top} is the tile's first pixel; this pixel's")
                return
        raise FollowError(f"no launch of cast_eye has pixel {x},{y} in its tile")

    def run(self, life, launch, thread, of):
        """A launch, and the instructions of the thread's warp."""
        chip = self.chip
        warp, lane = thread // chip.lanes, thread % chip.lanes
        life.steps.append(Step(
            "launch", launch.cycle, "controller -> multiprocessor",
            f"launch {launch.number}: {launch.kernel}, PC {launch.pc}, {launch.threads} threads, unit {launch.unit}",
            [f"{of} thread is {thread}: warp {warp}, lane {lane}"]))  # fmt: skip
        retired = chip.instructions(launch, thread)
        if not retired:
            raise FollowError(f"launch {launch.number} retires no instruction of thread {thread} in the waveform")
        masked = sum(mask for _, _, mask, _, _ in retired)
        life.steps.append(Step(
            "kernel", retired[0][0], f"unit {launch.unit}",
            f"warp {warp} retires {len(retired)} instructions in cycles {retired[0][0]} .. {retired[-1][0]}, "
            f"{masked} of them for lane {lane}"))  # fmt: skip
        for cycle, pc, mask, data, predicate in retired:
            text = self.texts.get(pc, "")
            result = result_text(text, data, predicate) if mask else "not this lane"
            life.steps.append(Step("instructions", cycle, "", f"{pc:>3}  {text:<28}{result}".rstrip()))
        life.spans.append(Span("unit", launch.cycle, retired[-1][0]))

    def trace(self, life, outcome, kept):
        """From the ray pool through the traverser."""
        chip, ray = self.chip, life.export
        life.read = read = chip.rays[kept]
        self.same(f"{life.name}: exported, and read by the traverser", ray.words, read.words)
        life.steps.append(Step("pool", outcome, "ray_pool -> controller", f"the ray is kept, in place {read.place}"))
        life.steps.append(Step(
            "pool", read.cycles[0], "ray_pool -> traverser",
            f"the ray in place {read.place}, in cycles {read.cycles[0]} .. {read.cycles[-1]}"))  # fmt: skip
        freed = next((cycle for cycle, place in chip.freed if place == read.place and cycle > read.cycles[-1]), None)
        if freed is None:
            raise FollowError(f"the traverser never gives back place {read.place} of the ray {life.name}")
        life.spans += [Span("ray_pool", ray.cycles[0], read.cycles[-1]), Span("traverser", read.cycles[-1], freed)]
        life.walk = Walk(chip, read, freed)
        life.steps += [Step("walk", cycle, "traverser", text) for cycle, text in walk_lines(life.walk)]
        shadow = packages.is_shadow(life.words)
        place = self.put_of(life.words, read.cycles[-1])
        handed = [one for one in chip.handed if one[1] == self.word and read.cycles[-1] < one[0] < freed]
        if place is not None:
            self.put(life, place, shadow)
        elif shadow and handed:
            life.fate = "free"
            life.contribution = of_color(handed, life.words[8:11])
            self.same(f"{life.name}: exported, and contributed", life.words[8:11], life.contribution[2])
            life.steps.append(Step("traverser", life.contribution[0], "traverser -> frame_port",
                                   f"the light is seen: {color_text(life.contribution[2])} for the pixel"))  # fmt: skip
        else:
            life.fate = "blocked" if shadow else "missed"
        end = {"hit": "", "free": "", "blocked": "; something is between surface and light",
               "missed": "; it hits nothing"}[life.fate]  # fmt: skip
        life.steps.append(Step("traverser", freed, "traverser -> ray_pool", f"place {read.place} is free{end}"))
        if life.come:
            self.bring(life)
        if life.contribution:
            self.to_frame(life)

    def put_of(self, words, after):
        """The number of the package that this ray becomes; None if it becomes none."""
        mine = words[packages.PIXEL], words[packages.FLAGS]
        for number, put in enumerate(self.chip.puts):
            if put.cycles[0] > after and (put.words[packages.PIXEL], put.words[packages.FLAGS]) == mine:
                return number
        return None

    def put(self, life, place, shadow):
        chip, put = self.chip, self.chip.puts[place]
        life.put, life.fate = put, "free" if shadow else "hit"
        self.same(f"{life.name}: read by the traverser, and put", life.read.words, put.words[:RAY_WORDS])
        number = sum(1 for one in chip.puts[:place] if one.kind == put.kind)
        life.steps.append(Step(
            "traverser", put.cycles[0], "traverser -> intersection_pool",
            f"{KINDS[put.kind]} intersection, in cycles {put.cycles[0]} .. {put.cycles[-1]}: "
            + ("the light is seen" if shadow else "the ray and"),
            [] if shadow else packages.hit_text(put.words)))  # fmt: skip
        same_kind = (n for n, request in enumerate(chip.requests) if request[1] == put.kind)
        asked = next((n for at, n in enumerate(same_kind) if at == number), None)
        if asked is None or asked >= len(chip.imports):
            raise FollowError(f"no unit imports the intersection of the ray {life.name}")
        life.come = chip.imports[asked]
        self.same(f"{life.name}: put, and imported", put.words[:21], life.come.words[:21])
        life.asked = chip.requests[asked][0]
        life.launch, life.thread = chip.launch_of_import(asked)

    def bring(self, life):
        """Into a kernel, and what the frame buffer gets of it."""
        launch, come, put = life.launch, life.come, life.put
        life.spans.append(Span("intersection_pool", put.cycles[-1], come.cycles[0]))
        life.steps.append(Step(
            "import", launch.reserved, "controller -> intersection_pool",
            f"{launch.threads} {KINDS[put.kind]} intersections are promised to launch {launch.number}"))  # fmt: skip
        begin = len(life.steps)
        self.run(life, launch, life.thread, "the intersection's")
        bringing = Step(
            "import", life.asked, "intersection_pool -> multiprocessor",
            f"the request for thread {life.thread} is taken; 6 beats in cycles "
            f"{come.cycles[0]} .. {come.cycles[-1]}:", packages.beats_text(come.words))  # fmt: skip
        life.steps.insert(begin + 1, bringing)
        life.spans[-1].begin = come.cycles[0]
        if put.kind == 2:
            mine = [one for one in self.chip.shaded if one[1] == self.word and one[0] > come.cycles[-1]]
            life.contribution = of_color(mine, life.words[8:11])
            if life.contribution is None:
                raise FollowError(f"the contribution of the ray {life.name} never leaves the unit")
            self.same(f"{life.name}: exported, and contributed", life.words[8:11], life.contribution[2])
            life.steps.append(Step("frame", life.contribution[0], "multiprocessor -> frame_port",
                                   f"{color_text(life.contribution[2])} for the pixel"))  # fmt: skip

    def to_frame(self, life):
        out = [one for one in self.chip.frame if one[1] == self.word and one[0] > life.contribution[0]]
        if not out:
            raise FollowError(f"the contribution of the ray {life.name} never leaves the frame port")
        self.same(f"{life.name}: contributed, and out of the frame port", life.contribution[2], out[0][2])
        life.spans.append(Span("frame_port", life.contribution[0], out[0][0] + 1))
        life.steps.append(Step("frame", out[0][0], "frame_port -> frame buffer", f"{color_text(out[0][2])} is added"))

    def contributions(self):
        """Colours that have left the chip for this pixel."""
        return [[packages.to_float(word) for word in one[2]] for one in self.chip.frame if one[1] == self.word]

    def missing(self):
        """What a whole journey has, and this one has not."""
        return [
            f"the ray {life.name} hits something, and casts no ray {name}"
            for life in self.lives.values()
            if life.fate == "hit" and life.launch.kernel != "shade"
            for name in self.children(life)
            if name not in self.lives
        ]

    def children(self, life):
        depth = packages.depth_of(life.words)
        culling = self.chip.wave.constant("CULLING")
        children = [] if culling else [f"shadow{depth}"]
        return children + ([f"reflection{depth + 1}"] if life.launch.kernel == "cast_secondary" else [])


def of_color(contributions, color):
    """Of several for one pixel that of this colour, if there is one; else the first, which is then another one."""
    return next((one for one in contributions if one[2] == color), contributions[0] if contributions else None)


def color_text(words):
    return packages.text([packages.to_float(word) for word in words])


def result_text(text, data, predicate):
    """What an instruction leaves in the lane: of its first operand one sees whether that is a number or a bit."""
    words = text.replace(",", " ").split()
    words = words[1:] if words and words[0].startswith("@") else words
    if len(words) < 2 or not words[0].startswith("rst") and words[1][0] not in "rp":
        return ""
    if words[1][0] == "p":
        return f"{words[1]} = {predicate}"
    value = f"{packages.to_float(data):.6g}"
    if data & 0x7F800000 == 0 and data != 1 << 31:  # a small whole number, or one with flags above it
        value = data if data < 1 << 31 else f"0x{data:08x}"
    return f"word {words[1]} = {value}" if words[0].startswith("rst") else f"{words[1]} = {value}"
