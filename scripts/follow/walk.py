"""A ray's walk through the tree, from the wires of rtl/traverser/rp_traverser.v and of the lane that had it: nodes and
triangles, each with the cycles of its test and what came of it."""
from dataclasses import dataclass

from . import packages
from .errors import FollowError

INSIDE = "gen_inside.traverser."
LANE = INSIDE + "gen_lane[*].lane."
TRAVERSER_SIGNALS = [INSIDE + name for name in ("LANES", "SLOT_BITS", "enters", "enter_grant", "enter_slot",
                                                "set_valid", "set_place", "scale", "meets")]  # fmt: skip
LANE_SIGNALS = [LANE + name for name in (
    "asked", "asked_slot", "asked_line", "given_q", "given_slot_q", "number", "boxes_valid", "boxes_slot", "met",
    "node_valid_q", "children", "nearest", "test_valid_o", "test_ready_i", "test_tag_o",
    "test_number_o", "result_valid_i", "result_tag_i", "result_number_i", "result_hit_i", "result_t_i", "done_valid_o",
    "done_ready_i", "done_slot_o")]  # fmt: skip
LEAF = 1 << 31
ORDERED = 1  # cycles from the boxes' result to the children in their order


@dataclass
class Visit:
    """A node: looked up, there, and its boxes tested."""

    asked: int
    given: int
    node: int
    tested: int
    met: list  # numbers of the boxes that are met
    nearest: str  # where the ray goes on; empty if no box is met


@dataclass
class Test:
    """A triangle: into the pipe, and out of it."""

    begun: int
    ended: int
    number: int
    hit: bool  # the ray's best one from now on
    t: float


class Walk:
    """Of a ray that `read` has brought. Cycles are those of the frame."""

    def __init__(self, chip, read, freed):
        self.wave = wave = chip.wave
        self.entered = read.cycles[-1]
        if not wave.value(INSIDE + "enters", self.entered):
            raise FollowError(f"no ray enters the traverser in cycle {self.entered}, though its last beat passes")
        self.lane = wave.value(INSIDE + "enter_grant", self.entered).bit_length() - 1
        self.slot = wave.value(INSIDE + "enter_slot", self.entered)
        self.set = next((cycle for cycle in wave.high(INSIDE + "set_valid") if self.entered < cycle < freed
                         and wave.value(INSIDE + "set_place", cycle) == read.place), None)  # fmt: skip
        if self.set is None:
            raise FollowError(f"the ray in place {read.place} is never set up in the traverser")
        self.meets = bool(wave.value(INSIDE + "meets", self.set))
        self.done = next((cycle for cycle in wave.transfers(self.name("done_valid_o"), self.name("done_ready_i"))
                          if self.set < cycle < freed and self.of_slot("done_slot_o", cycle)), None)  # fmt: skip
        if self.done is None:
            raise FollowError(f"the ray in place {read.place} is never done in lane {self.lane}")
        self.visits = [self.visit(cycle) for cycle in self.mine("given_q", "given_slot_q")]
        begun = [cycle for cycle in wave.transfers(self.name("test_valid_o"), self.name("test_ready_i"))
                 if self.set < cycle < self.done and self.of_slot("test_tag_o", cycle)]  # fmt: skip
        ended = list(self.mine("result_valid_i", "result_tag_i"))
        if len(begun) != len(ended):
            raise FollowError(f"of {len(begun)} triangles that lane {self.lane} tests for a ray {len(ended)} come back")
        self.tests = [self.test(*cycles) for cycles in zip(begun, ended)]

    def name(self, signal):
        """Of the ray's lane."""
        return LANE.replace("*", str(self.lane)) + signal

    def value(self, signal, cycle):
        return self.wave.value(self.name(signal), cycle)

    def of_slot(self, signal, cycle):
        """A tag has the slot in its lowest bits."""
        return self.value(signal, cycle) % (1 << self.wave.constant(INSIDE + "SLOT_BITS")) == self.slot

    def mine(self, valid, slot):
        for cycle in self.wave.high(self.name(valid)):
            if self.set < cycle < self.done and self.of_slot(slot, cycle):
                yield cycle

    def visit(self, given):
        node = self.value("number", given)
        asked = max((cycle for cycle in self.wave.high(self.name("asked"))
                     if cycle < given and self.of_slot("asked_slot", cycle)), default=None)  # fmt: skip
        tested = min((cycle for cycle in self.mine("boxes_valid", "boxes_slot") if cycle > given), default=None)
        if asked is None or tested is None:
            said = "never asked for" if asked is None else "never tested"
            raise FollowError(f"node {node}, which lane {self.lane} has in cycle {given}, is {said}")
        met = self.value("met", tested)
        children, nearest = (self.value(signal, tested + ORDERED) for signal in ("children", "nearest"))
        return Visit(asked, given, node, tested, [n for n in range(4) if met >> n & 1],
                     reference_text(nearest) if children else "")  # fmt: skip

    def test(self, begun, ended):
        scale = self.wave.value(INSIDE + "scale", self.set)
        t = packages.to_float(self.value("result_t_i", ended)) * 2.0 ** (scale - (scale >> 8 << 9))
        return Test(begun, ended, self.value("result_number_i", ended), bool(self.value("result_hit_i", ended)), t)

    def best(self):
        """The last hit, which is the nearest; None if there is none."""
        return next((test for test in reversed(self.tests) if test.hit), None)


def reference_text(reference):
    return f"a leaf of {(reference >> 29 & 3) + 1}" if reference & LEAF else f"node {reference}"


def walk_lines(walk):
    """(cycle, text), in the order of the cycles."""
    lines = [(walk.set, f"set-up: lane {walk.lane}, slot {walk.slot}"
              + ("" if walk.meets else "; it does not come near the scene"))]  # fmt: skip
    for visit in walk.visits:
        met = " and ".join(map(str, visit.met)) or "none"
        on = f"; on to {visit.nearest}" if visit.nearest else ""
        lines.append((visit.given, f"node {visit.node}, asked for in cycle {visit.asked}, is there"))
        lines.append((visit.tested, f"of its boxes {met} met{on}"))
    for test in walk.tests:
        lines.append((test.begun, f"triangle {test.number} goes into the pipe"))
        found = f"hit at t {test.t:.6g}" if test.hit else "no better hit"
        lines.append((test.ended, f"triangle {test.number}: {found}"))
    lines.append((walk.done, "all is visited that could be hit: the ray leaves its lane"))
    return sorted(lines, key=lambda line: line[0])
