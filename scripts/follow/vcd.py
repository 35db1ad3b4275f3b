"""Signals of the instance `chip` and of what is inside it, in a waveform, cycle by cycle.

A waveform is written after each edge of the clock. At a rising edge the registers have their new values already, which
are those of the cycle that begins, while the inputs still stand as they were in the cycle that ends. So the outputs of
cycle c are read after the edge before it, and its inputs after the edge that ends it. Cycle 0 is that of start_i.
What is inside is named by its path from the chip, with dots between instances, and [*] for all of a row of them.
"""
import bisect
import re
import subprocess

from .errors import FollowError, need

CLOCK = "clk_i"
ALWAYS = (CLOCK, "start_i", "busy_o")
EACH = re.compile(r"\[\d+\]")
NO_DIGITS = bytes.maketrans(b"xXzZ", b"0000")


def lines_of(path):
    """The lines of a VCD, or of an FST as fst2vcd writes them."""
    if not path.is_file():
        raise FollowError(f"{path}: there is no waveform")
    if path.suffix == ".vcd":
        with path.open("rb") as file:
            yield from file
        return
    with subprocess.Popen(
        [need("fst2vcd", "gtkwave"), str(path)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as tool:
        yield from tool.stdout
    if tool.returncode != 0:
        raise FollowError(f"{path}: fst2vcd cannot read it as a waveform")


class Signal:
    """Times of its changes, and its values from then on, as digits: few of them are ever asked for."""

    def __init__(self):
        self.times, self.values = [], []

    def at(self, time):
        place = bisect.bisect_right(self.times, time) - 1
        return number(self.values[place]) if place >= 0 else 0


def number(digits):
    return int(digits.translate(NO_DIGITS), 2)


def followed(lines, names):
    """Of a VCD's lines those of the signals in `names`, and of what marks a frame."""
    lines, names, codes = iter(lines), {*ALWAYS, *names}, set()
    for line, code, name in header(lines):
        if code is None:
            yield line
        elif EACH.sub("[*]", name) in names:
            codes.add(code)
            yield line
    longest = max(map(len, codes), default=0)
    for line in lines:
        kind = line[0]
        if kind == 0x62:  # b: a bus; its code is the end
            place = line.rfind(b" ", -longest - 2)
            if place > 0 and line[place + 1 : -1] in codes:
                yield line
        elif kind == 0x23 or len(line) < longest + 3 and line[1:-1] in codes:  # #: a time
            yield line


def header(lines):
    """Each line up to the end of the definitions; of a signal with its code and name, else with None."""
    scopes = []
    for line in lines:
        words = line.split()
        kind = words[0] if words else b""
        if kind == b"$scope":
            scopes.append(words[2])
        elif kind == b"$upscope":
            scopes.pop()
        yield (line, words[3], name_in_chip(scopes, words[4])) if kind == b"$var" else (line, None, None)
        if kind == b"$enddefinitions":
            return


def name_in_chip(scopes, name):
    """Its path from the innermost scope of this name; empty outside of it."""
    if b"rp_chip" not in scopes:
        return ""
    return b".".join((*scopes[len(scopes) - scopes[::-1].index(b"rp_chip") :], name)).decode()


class Wave:
    """`lines` of a VCD, which must have `names`, as followed() leaves them. Cycles are those of the frame."""

    def __init__(self, lines, names):
        lines = iter(lines)
        codes = self.read_names(lines, {*ALWAYS, *names})
        self.read_changes(lines, codes)
        clock = self.signals[CLOCK]
        self.edges = [time for time, value in zip(clock.times, clock.values) if value == b"1"]
        starts = [edge for edge in self.edges if self.signals["start_i"].at(edge)]
        if not starts:
            raise FollowError("the waveform has no frame: start_i is never high")
        self.first = self.edges.index(starts[0])
        self.cycles = self.length_of_frame()

    def read_names(self, lines, names):
        """The signals by their codes in the file."""
        codes, self.signals = {}, {}
        for _, code, name in header(lines):
            if code is not None:
                self.signals[name] = codes.setdefault(code, Signal())
        missing = names - {EACH.sub("[*]", name) for name in self.signals}
        ports = sorted(name for name in missing if "." not in name)
        if ports:
            raise FollowError(f"the waveform has no signal '{ports[0]}' in rtl/chip/rp_chip.v: it is of something else")
        if missing:
            raise FollowError("the chip of this waveform has no traverser inside: draw with chip.traverser=hardware")
        return codes

    @staticmethod
    def read_changes(lines, codes):
        time = 0
        for line in lines:
            kind = line[:1]
            if kind == b"#":
                time = int(line[1:])
                continue
            value, _, code = line[1:-1].rpartition(b" ") if kind == b"b" else (kind, b"", line[1:-1])
            if code in codes:
                codes[code].times.append(time)
                codes[code].values.append(value)

    def length_of_frame(self):
        """Cycles from the start of the frame until busy_o has fallen."""
        busy = self.signals["busy_o"]
        for cycle in range(1, len(self.edges) - self.first + 1):
            if not busy.at(self.time("busy_o", cycle)) and busy.at(self.time("busy_o", cycle - 1)):
                return cycle
        raise FollowError("the frame does not end in the waveform: busy_o stays high")

    def time(self, name, cycle):
        """Where the waveform has the value of a cycle. There may be none: then the nearest."""
        place = self.first + cycle - lateness(name)
        return self.edges[min(max(place, 0), len(self.edges) - 1)]

    def value(self, name, cycle):
        return self.signals[name].at(self.time(name, cycle))

    def constant(self, name):
        """A parameter, or what stays while the frame is drawn."""
        return self.value(name, 1)

    def high(self, name):
        """The cycles of the frame in which any bit of it is set, in their order."""
        signal = self.signals[name]
        ends = signal.times[1:] + [self.edges[-1] + 1]
        late = self.first - lateness(name)
        for begin, end, value in zip(signal.times, ends, signal.values):
            if number(value):
                first, last = bisect.bisect_left(self.edges, begin) - late, bisect.bisect_left(self.edges, end) - late
                yield from range(max(first, 0), min(last, self.cycles + LATER))

    def transfers(self, valid, ready):
        """The cycles in which both sides of a port want."""
        return [cycle for cycle in self.high(valid) if self.value(ready, cycle)]


def lateness(name):
    """Edges from the one before which a value of cycle 0 stands to that of start_i: only the chip's inputs wait."""
    return 0 if name.endswith("_i") and "." not in name else 1


LATER = 64  # cycles behind the frame's end, in which what was on its way arrives
