"""From a configuration to a timed netlist: elaborate, map, time, map the blocks on failing paths for speed,
time again; in the end win area back where speed was not needed.
"""
import dataclasses
import fcntl
import hashlib
import json
import os
from collections import Counter
from dataclasses import dataclass, field

from . import elaborate, fanout, macros, mapping, timing
from .errors import SynthError, progress
from .library import BUILD, ROOT, Library
from .memories import MemoryModel
from .netlist import Netlist
from .phases import Phases

# Rounds of mapping for speed what lies on failing paths; how many there are at most where the user wants more.
CLOSURE_ROUNDS = 4
MOST_ROUNDS = 8
# Failing end points that have their paths looked at in a round.
PATHS_A_ROUND = 60
# What a kind of block must save to be tried with a lower effort again, as a share of all logic.
WORTH_TRYING = 0.0005
# The lock file of each folder that this program works in.
LOCKS = {}


@dataclass
class Options:
    config: str = "8w8c"
    liberty: str = None
    clock_ns: float = None
    memories: str = "macros"
    jobs: int = 2
    out: str = None
    units: int = 0  # of the whole chip; 0: a unit alone
    rounds: int = CLOSURE_ROUNDS  # another number: no area is won back

    @property
    def name(self):
        """The configuration's, as raypool reports it: of a file its own, without the folder."""
        return os.path.splitext(os.path.basename(self.config))[0]

    @property
    def title(self):
        """The configuration's name, and that it is a chip's."""
        return self.name + (f"-chip-{self.units}cu" if self.units else "")


@dataclass
class Design:
    """A configuration as netlist; what the later steps need."""

    options: Options
    library: Library
    parameters: dict
    folder: str
    clock_ns: float = 0.0
    fo4_ns: float = 0.0
    kinds: dict = field(default_factory=dict)
    netlist: Netlist = None
    memory: MemoryModel = None
    endpoints: list = field(default_factory=list)
    efforts: dict = field(default_factory=dict)  # by kind's identity, where it is not the first
    buffers: dict = field(default_factory=dict)  # added to each kind for fan-out
    top: str = "compute_unit"
    phases: Phases = field(default_factory=Phases)

    @property
    def verilog(self):
        return os.path.join(self.folder, "netlist.v")

    @property
    def macros(self):
        path = os.path.join(self.folder, "memories.lib")
        return path if any(k.memory for k in self.blocks()) else None

    def blocks(self):
        """Kinds that stay blocks: the memories, unless they are made of flip-flops."""
        return [] if self.options.memories == "flops" else [k for k in self.kinds.values() if k.memory]


def label(options, library):
    """The folder's name: the configuration and whatever is not the default."""
    return "-".join(filter(None, (options.title, suffix(options, library))))


def suffix(options, library):
    """Whatever is not the default."""
    parts = ([library.name] if library.name != "osu018" else []) + (
        [os.path.basename(options.memories.rstrip("/"))] if options.memories != "macros" else []
    )
    if options.clock_ns is not None:
        parts.append(f"{options.clock_ns:g}ns")
    if options.rounds != CLOSURE_ROUNDS:
        parts.append(f"{options.rounds}rounds")
    return "-".join(parts)


def open_design(options):
    """Checks the input; nothing is synthesised yet."""
    if options.memories not in ("macros", "flops") and not os.path.isdir(options.memories):
        raise SynthError(f"MEMORIES={options.memories}: macros, flops, or a folder with Liberty files of memory macros")
    library = Library(options.liberty)
    parameters = elaborate.configuration(options.config, options.units)
    folder = options.out or os.path.join(BUILD, label(options, library))
    os.makedirs(folder, exist_ok=True)
    lock(folder)
    listed = macros.read(options.memories) if os.path.isdir(options.memories) else []
    top = "chip" if options.units else Design.top
    return Design(options, library, parameters, folder, memory=MemoryModel(library, listed), top=top)


def lock(folder):
    """Until this program ends no other one has the folder: two would write over each other's netlist. One that
    has waited finds the report of the one before."""
    folder = os.path.realpath(folder)
    if folder in LOCKS:
        return
    file = open(os.path.join(folder, ".lock"), "a", encoding="utf-8")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        progress(f"synth: waiting for another synthesis in {folder}")
        fcntl.flock(file, fcntl.LOCK_EX)
    LOCKS[folder] = file


def digest(design):
    """Everything a report depends on."""
    sources = dict(elaborate.rtl_texts())
    here = os.path.dirname(os.path.abspath(__file__))
    # Of libraries' set-ups that of this one, in the library's digest.
    for folder in (here, os.path.join(ROOT, "constraints")):
        for name in sorted(os.listdir(folder)):
            if name.endswith((".py", ".json", ".sdc")):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    sources[name] = file.read()
    parts = [
        sources,
        design.top,
        design.parameters,
        design.library.digest,
        mapping.versions(),
        timing.version(),
        str(design.options.clock_ns),
        design.options.memories,
        design.options.rounds,
        [dataclasses.astuple(macro) for macro in design.memory.listed],
    ]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16]


def phases_of(options, report=True):
    """What synthesise() does, by name; with `report` what makes a report of it too."""
    found = {
        "elaborate": f"measure the library and elaborate {options.title}",
        "map": "map each kind of block to the library's cells, most of the time where few are kept",
        "time": "time the netlist",
    }
    if options.rounds:
        found["close"] = "map again, for speed, the blocks on paths that miss the clock"
    if options.rounds == CLOSURE_ROUNDS:
        found["recover"] = "recover area: map again, for area, the blocks that have time to spare"
    if report:
        found["report"] = "trace the slowest path and write the report"
    return found


def prepare(design):
    """Elaborates, and measures the library."""
    design.phases.begin("elaborate")
    work = os.path.join(design.folder, "work")
    os.makedirs(work, exist_ok=True)
    design.fo4_ns = timing.measure_fo4(design.library, work)
    # A library without a clock of its own gets the default library's, counted in its own FO4.
    default = 40.0 * design.fo4_ns
    design.clock_ns = design.options.clock_ns or design.library.setup.get("clock_ns") or round(default, 3)
    design.kinds = elaborate.tree(design.parameters, work, design.top, gated=bool(design.library.clock_gate))
    return work


def mapper_of(design):
    options = design.options
    # A user with more rounds than usual has the time.
    thorough = options.rounds > CLOSURE_ROUNDS
    return mapping.Mapper(design.library, BUILD, design.clock_ns, options.jobs, thorough, design.phases)


def map_design(design, again_for=""):
    """Maps what is not kept yet; `again_for`: speed or area, where all of it has been mapped before."""
    mapper = mapper_of(design)
    stay = {k.identity for k in design.blocks()}
    kinds = [k for k in design.kinds.values() if k.identity not in stay]
    paths = mapper.map_all(kinds, design.efforts, again_for)
    design.netlist = Netlist(design.kinds, paths, design.library, design.top)
    design.buffers = fanout.repair(design.netlist)
    design.netlist.write(design.verilog)
    if design.blocks():
        design.memory.liberty(design.blocks(), design.fo4_ns, os.path.join(design.folder, "memories.lib"))


def time_design(design, work):
    design.endpoints, loops = timing.time_netlist(
        design.verilog, design.library, design.macros, design.clock_ns, work, design.top
    )
    if loops:
        raise SynthError(f"the netlist has combinational loops:\n{loops}")
    return design.endpoints[0].slack


def identities_on(design, pins):
    """The kinds of block that own the given pins."""
    owners = {"/".join(path): identity for path, identity in design.netlist.instances()}
    found = set()
    for pin in pins:
        path = pin.split("/")[:-1]
        while path and "/".join(path) not in owners:
            path = path[:-1]
        found.add(owners["/".join(path)] if path else design.netlist.top)
    return found


def next_effort(design, identities):
    """Which of these kinds of block are mapped with one effort more. The last one only where all have had the others:
    it costs most, and often one block alone is what a path lacks.
    """
    for limit in (mapping.FAST_EFFORT, mapping.LAST_EFFORT):
        more = {i for i in identities if i in design.netlist.modules and design.efforts.get(i, 0) < limit}
        if more:
            return more
    return set()


def on_failing_paths(design, work, needed=0.0):
    """The kinds of block on paths that have less slack."""
    # Lanes fail alike: one end point of each name is enough.
    seen, chosen = set(), []
    for end in design.endpoints:
        name = "".join(c for c in end.pin if not c.isdigit())
        if end.slack < needed and name not in seen:
            seen.add(name)
            chosen.append(end.pin)
    paths = timing.describe(
        chosen[:PATHS_A_ROUND], design.verilog, design.library, design.macros, design.clock_ns, work, design.top
    )
    return identities_on(design, [step[0] for _, _, steps in paths for step in steps])


def lower_efforts(design, mapper):
    """What would save area and is fast enough alone: the efforts of each kind of block, what saves most first."""
    netlist = design.netlist
    places = Counter(identity for _, identity in netlist.instances() if identity in netlist.modules)
    slower = {}
    for identity in places:
        kind, effort = design.kinds[identity], design.efforts.get(identity, 0)
        # The first effort is area alone where that was fast enough.
        small = mapper.result(kind, 0)["way"] == "area"
        slower[identity] = [*range(effort), *([] if small else [mapping.AREA_EFFORT])]
    late = [i for i, efforts in slower.items() if mapping.AREA_EFFORT in efforts]
    mapper.map_all([design.kinds[i] for i in late], dict.fromkeys(late, mapping.AREA_EFFORT), "area")
    worth = WORTH_TRYING * sum(netlist.own_area(i) * n for i, n in places.items())
    found = {}
    for identity, efforts in slower.items():
        kind = design.kinds[identity]
        now = mapper.area(kind, design.efforts.get(identity, 0))
        saved = {e: (now - mapper.area(kind, e)) * places[identity] for e in efforts}
        fast = [
            e for e in efforts if saved[e] > worth and mapper.result(kind, e)["delay_ps"] < 1000 * design.clock_ns
        ]
        if fast:
            found[identity] = sorted(fast, key=lambda e: -saved[e])
    return found


def win_back(design, work, slack):
    """Gives blocks lower efforts where the whole is as fast without the higher ones: the first effort looks at a block
    alone, and a round for speed takes all that lies on a failing path, whether it had to be faster or another one had.
    All get their lowest effort at once; then those on failing paths the next one, in the end the one they had.
    """
    needed = min(slack, 0.0)
    before = {i: design.efforts.get(i, 0) for i in design.netlist.modules}
    lower = lower_efforts(design, mapper_of(design))
    if not lower:
        return slack
    while lower:
        design.efforts.update({i: efforts[0] for i, efforts in lower.items()})
        map_design(design, "area")
        reached = time_design(design, work)
        names = elaborate.in_words(design.kinds[i] for i in lower)
        design.phases.note(f"slack {reached:+.3f} ns; for area: {names}")
        if reached >= needed:
            design.efforts = {i: effort for i, effort in design.efforts.items() if effort}
            return reached
        for identity in on_failing_paths(design, work, needed) & set(lower) or set(lower):
            design.efforts[identity] = before[identity]
            del lower[identity][0]
        lower = {i: efforts for i, efforts in lower.items() if efforts}
    design.efforts = {i: effort for i, effort in before.items() if effort}
    map_design(design)
    return time_design(design, work)


def close_timing(design, work, slack):
    """Maps for speed what lies on failing paths, round by round. A round can lose: a block that is mapped again drives
    its neighbours otherwise. So the fastest netlist stays, not the last one.
    """
    efforts = dict(design.efforts)
    best = slack
    for number in range(1, design.options.rounds + 1):
        if slack >= 0:
            break
        more = next_effort(design, on_failing_paths(design, work))
        if not more:
            break
        names = elaborate.in_words(design.kinds[i] for i in more)
        turn = f"round {number} of at most {design.options.rounds}"
        design.phases.note(f"{turn}: slack {slack:+.3f} ns; for speed: {names}")
        design.efforts.update({i: design.efforts.get(i, 0) + 1 for i in more})
        map_design(design, "speed")
        slack = time_design(design, work)
        if slack > best:
            best, efforts = slack, dict(design.efforts)
    if slack == best:
        design.phases.note(f"slack {slack:+.3f} ns")
        return slack
    design.phases.note(f"slack {slack:+.3f} ns; back to the netlist with {best:+.3f} ns")
    design.efforts = efforts
    map_design(design)
    return time_design(design, work)


def synthesise(design):
    """The whole of it. design.netlist and design.endpoints hold the result."""
    work = prepare(design)
    design.phases.begin("map")
    map_design(design)
    design.phases.begin("time")
    slack = time_design(design, work)
    design.phases.note(f"{design.options.title}: slack {slack:+.3f} ns at {design.clock_ns:g} ns")
    design.phases.begin("close")
    slack = close_timing(design, work, slack)
    if design.options.rounds == CLOSURE_ROUNDS:
        design.phases.begin("recover")
        slack = win_back(design, work, slack)
    return slack
