"""A module of rtl/ alone, once for each set of parameters: area and slack, by the flow of the unit."""
import difflib
import os
import re

from . import elaborate, flow
from .errors import SynthError, progress
from .library import BUILD, Library
from .memories import MemoryModel
from .phases import Phases


def parsed(text):
    """{"A": "1", "B": "2"} of A=1,B=2"""
    found = {}
    for word in text.split(","):
        name, equals, value = word.partition("=")
        if not equals or not name.isidentifier() or not value.isdigit():
            raise SynthError(f"{text}: parameters of a module are written BITS=8 or A=1,B=2")
        found[name] = value
    return found


def named(name):
    """The module that the user means, with the prefix or without; what is none is refused with the nearest."""
    name = name.removeprefix(elaborate.PREFIX)
    files = [os.path.basename(path) for path in elaborate.rtl_files()]
    known = [os.path.splitext(file)[0].removeprefix(elaborate.PREFIX) for file in files]
    if not name:
        raise SynthError("name a module of rtl/: MODULE=box_pipe")
    if name not in known:
        near = difflib.get_close_matches(name, known, 1)
        raise SynthError(f"{name}: no such module in rtl/{f': did you mean {near[0]}?' if near else ''}")
    return name


def synthesise(name, rows, options):
    """[(parameters as text, design)], in the order of `rows`; without any, the module as it is."""
    name = named(name)
    found = []
    for text in rows or [""]:
        library = Library(options.liberty)
        folder = os.path.join(BUILD, "modules", "-".join(filter(None, (name, text, flow.suffix(options, library)))))
        os.makedirs(folder, exist_ok=True)
        flow.lock(folder)
        design = flow.Design(options, library, parsed(text) if text else {}, folder, top=name)
        design.options.config = f"{name} {text}".strip()
        design.memory = MemoryModel(library)
        design.phases = Phases(flow.phases_of(design.options, report=False), folder)
        try:
            flow.synthesise(design)
        except SynthError as error:
            unknown = re.search(r"object for defparam `(\w+)", str(error))
            if unknown:
                raise SynthError(f"{name} has no parameter {unknown[1]}") from error
            raise
        design.phases.end()
        progress(f"synth: {design.options.config} is done")
        found.append((text, design))
    return found


def table(found):
    """Area of the logic without memories, which a module that stands alone need not have."""
    library, clock = found[0][1].library, found[0][1].clock_ns
    width = max(len(text) for text, _ in [("parameters", None), *found])
    lines = [
        f"{library.name}, {clock:g} ns",
        f"{'parameters':<{width}} {'kGE':>8} {'flip-flops':>11} {'slack, ns':>10}  slowest end point",
    ]
    for text, design in found:
        netlist, end = design.netlist, design.endpoints[0]
        identities = [identity for _, identity in netlist.instances() if identity in netlist.modules]
        area = sum(netlist.own_area(identity) for identity in identities)
        flops = sum(netlist.own_flops(identity) for identity in identities)
        lines.append(f"{text or '-':<{width}} {library.kge(area):>8.1f} {flops:>11} {end.slack:>+10.3f}  {end.pin}")
    return "\n".join(lines)
