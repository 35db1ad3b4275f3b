"""Maps each kind of module once to the library's cells, with Yosys and ABC,
and keeps the result under a key of all it was made from.
"""
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import time

from . import clock_gates
from .elaborate import PREFIX, defines, read_rtl, rtl_texts, text_of
from .errors import SynthError, need, run
from .library import ROOT, keep
from .phases import Phases, about

# ABC sees neither clock-to-output nor set-up time: it gets this share of the period.
LOGIC_SHARE = 0.7
# A block that is still on a failing path when it has been mapped for speed has only a part of that path:
# its gates are sized for this share, and for the other one where that is not enough.
FAST_SHARE = 0.4
LAST_SHARE = 0.3
# A block is fast enough if its slowest logic takes no more than this share, as far as one can see while it is mapped
# alone.
ACCEPTED_SHARE = 0.8
# The limit that `map` gets in its own units, in targets.
RELAXED = 2.15


def versions():
    """The tools that make the netlist."""
    text = subprocess.run([need("yosys", "yosys"), "-V"], capture_output=True, text=True, check=True).stdout
    return {"yosys": text.split()[1]}


# Ways of mapping: for area, for speed with area won back, for speed, for few levels before that, and with more buffers,
# each for fewer gates, after one or two searches for few levels. Each ends with buffers and drive strengths for the
# target {d}, and prints its delay. What `map` takes for a delay is some two times that: with {d} as its limit it never
# wins area back.
_SIZING = "topo;buffer,-c;upsize,-D,{d};dnsize,-D,{d};stime"
_SPREAD = _SIZING.replace("buffer,-c", "buffer,-c,-N,6")
_LEVELS = "dch;if,-g;strash;"
_SPEED = "dch;map,-B,0.9,-D,{d};"
ABC_SCRIPTS = {
    "area": "+strash;dc2;dch,-f;amap,-m;" + _SIZING,
    "balance": "+strash;dch;map,-B,0.9,-D,{relaxed};" + _SIZING,
    "speed": "+strash;" + _SPEED + _SIZING,
    "levels": "+strash;" + _LEVELS + _SPEED + _SIZING,
    "spread": "+strash;" + _LEVELS + _SPEED + _SPREAD,
    "twice": "+strash;" + 2 * _LEVELS + _SPEED + _SPREAD,
}

# From this effort on every way is tried and the fastest taken.
FAST_EFFORT = 2
LAST_EFFORT = 3
# Area however slow: only for blocks that turn out to have the time, when the whole has been timed.
AREA_EFFORT = 4


def efforts_of(library, thorough=False):
    """The first try, and what a block on a failing path gets then, one more each time. Ways in this order, until one is
    fast enough (of the fast efforts all, and the fastest is taken), and the share they aim at. The second is the
    set-up's: in most libraries area won back for a shorter target is both smaller and faster than speed alone. What is
    thorough takes twice as long for the last effort.
    """
    again = library.setup.get("again", {"way": "balance", "share": 0.5})
    return [
        (["area", "balance", "speed"], LOGIC_SHARE),
        ([again["way"]], again["share"]),
        (["speed", "levels"], FAST_SHARE),
        (["speed", "levels", *(["spread", "twice"] if thorough else [])], LAST_SHARE),
        (["area"], LOGIC_SHARE),
    ]


def constant(bits):
    return str(int(bits, 2)) if len(bits) == 32 else f"{len(bits)}'b{bits}"


class Remaining:
    """How long the mapping of kinds of block still takes, by their sizes and the time that those that are done took."""

    # Of all sizes: before that the guess is worth nothing.
    LEAST_SHARE = 0.3
    # What is shorter is not worth a word.
    LEAST_SECONDS = 30
    # Reading the Verilog and the library takes as long for every kind as the logic of so many bits: most of the time of
    # a small one. Measured with 4w4c (scripts/tests/synth_test.py).
    FIXED = 20000

    def __init__(self, kinds, now=time.monotonic):
        self.all = sum(kind.bits + self.FIXED for kind in kinds)
        self.done = 0
        self.now = now
        self.begun = now()

    def seconds_after(self, kind):
        """When `kind` is done too; None where that cannot be estimated."""
        self.done += kind.bits + self.FIXED
        share = self.done / self.all
        left = (self.now() - self.begun) * (1 / share - 1)
        return left if share >= self.LEAST_SHARE and left >= self.LEAST_SECONDS else None

    def after(self, kind):
        """When `kind` is done too: words that go at the end of a line, or none where that cannot be estimated."""
        left = self.seconds_after(kind)
        return "" if left is None else f", about {about(left)} left"


class Mapper:
    def __init__(self, library, folder, clock_ns, jobs=2, thorough=False, phases=None):
        self.library = library
        self.folder = os.path.join(folder, "kinds")
        os.makedirs(self.folder, exist_ok=True)
        self.clock_ns = clock_ns
        self.jobs = jobs
        self.phases = phases or Phases()
        self.cells = library.usable_file(os.path.join(folder, "libraries"))
        self.constraints = self.cells.removesuffix(".lib") + ".constr"
        self.output_load = f"{1000 * library.loads_pf['output']:.4g}"
        self.gated = bool(library.clock_gate)
        self.efforts = efforts_of(library, thorough)
        self.gating = self.gating_script()
        self.texts = rtl_texts()
        self.version = versions()["yosys"]

    def gating_script(self):
        """Yosys: clock gates into a kind, one for each enable; nothing where the library has none."""
        text = clock_gates.map_text(self.library)
        if not text:
            return ""
        path = keep(self.cells.removesuffix(".lib") + f"-gates{hashlib.sha256(text.encode()).hexdigest()[:8]}.v", text)
        merge = f"opt_expr\nopt_merge\nopt_merge -share_all t:{self.library.clock_gate}\nopt_clean"
        return f"techmap -map {path}\n{merge}\n"

    def included(self, text):
        """The headers that a text includes, those of the headers too."""
        found = {}
        waiting = [text]
        while waiting:
            for name in re.findall(r'`include\s+"([^"]+)"', waiting.pop()):
                path = f"rtl/include/{name}"
                if path not in found:
                    found[path] = self.texts[path]
                    waiting.append(found[path])
        return found

    def prepare_script(self, kind, result):
        """Yosys: one kind down to generic gates and library flip-flops. Its children stay blocks."""
        chosen = " ".join(f"-chparam {n} {constant(v)}" for n, v in sorted(kind.parameters.items()))
        return f"""{read_rtl(self.gated)}
hierarchy -check -top {PREFIX}{kind.base} {chosen}
select -set kids * A:top %d
blackbox @kids
select -clear
proc
opt_clean
select -assert-none t:$dlatch t:$adlatch t:$dlatchsr
check -assert
synth -run coarse:fine -noabc
opt -fast -full
memory_map
opt -undriven -fine
{self.gating}techmap
opt -fast
select -assert-none t:$_DLATCH_* t:$_DLATCHSR_*
dfflibmap -liberty {self.cells}
opt
write_rtlil {result}
"""

    def map_script(self, way, prepared, result, share=LOGIC_SHARE):
        """Yosys: the gates of a prepared kind."""
        target = self.clock_ns * 1000 * share
        script = ABC_SCRIPTS[way].format(d=int(target), relaxed=int(RELAXED * target))
        return f"""read_rtlil {prepared}
abc -liberty {self.cells} -constr {self.constraints} -script {script}
opt_clean -purge
read_liberty -lib -ignore_miss_func {self.cells}
check -assert
write_json {result}
"""

    def key(self, kind, effort):
        """All that decides the result. The text of a module and what it includes;
        its children only by their interface.
        """
        scripts = self.prepare_script(kind, "") + "".join(self.map_script(w, "", "") for w in self.efforts[effort][0])
        # Neither where the project lies nor which other files it has.
        scripts = (
            scripts.split("\n", 1)[1]
            .replace(ROOT, "")
            .replace(self.constraints.replace(ROOT, ""), "/abc.constr")
            .replace(self.cells.replace(ROOT, "").removesuffix(".lib"), "")
        )
        source = text_of(self.texts, kind.base)
        parts = [
            self.version,
            self.library.digest,
            defines(self.gated),
            scripts,
            source,
            json.dumps(self.included(source), sort_keys=True),
            self.output_load,
            str(ACCEPTED_SHARE),
            str(self.efforts[effort][1]),
            json.dumps(sorted(kind.children.items())),
            json.dumps(sorted(kind.parameters.items())),
        ]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]

    def path(self, kind, effort):
        return os.path.join(self.folder, f"{kind.base}-{self.key(kind, effort)}.json")

    def yosys(self, script, stem):
        with open(stem + ".ys", "w", encoding="utf-8") as file:
            file.write(script)
        run([need("yosys", "yosys"), "-q", "-l", stem + ".yosys", stem + ".ys"], stem + ".log")
        os.remove(stem + ".ys")

    def map_one(self, kind, effort):
        """Takes the first way with a delay within the accepted share of the period, else the fastest; of a fast effort
        the fastest.
        """
        final = self.path(kind, effort)
        # Two runs may map the same kind at a time: each works on files of its own.
        stem = f"{final[:-len('.json')]}.{os.getpid()}"
        prepared = stem + ".il"
        self.yosys(self.prepare_script(kind, prepared), stem)
        if rtl_texts() != self.texts:
            raise SynthError("rtl/ changed while it was being mapped; run it again")
        best = None
        for way in self.efforts[effort][0]:
            result = f"{stem}.{way}"
            self.yosys(self.map_script(way, prepared, result, self.efforts[effort][1]), stem)
            with open(stem + ".yosys", encoding="utf-8", errors="replace") as file:
                delays = re.findall(r"Delay = *([\d.]+) ps", file.read())
            delay = float(delays[-1]) if delays else 0.0
            if best is None or delay < best[0]:
                best = (delay, way, result)
            if effort < FAST_EFFORT and delay <= self.clock_ns * 1000 * ACCEPTED_SHARE:
                break
        with open(best[2], encoding="utf-8") as file:
            module = next(m for m in json.load(file)["modules"].values() if "top" in m["attributes"])
        slim = {
            "way": best[1],
            "delay_ps": best[0],
            "ports": {n: {"direction": p["direction"], "bits": p["bits"]} for n, p in module["ports"].items()},
            "cells": {n: {"type": c["type"], "connections": c["connections"]} for n, c in module["cells"].items()},
            "netnames": {n: {"bits": w["bits"]} for n, w in module["netnames"].items() if not w["hide_name"]},
        }
        with open(stem + ".new", "w", encoding="utf-8") as file:
            json.dump(slim, file)
        os.rename(stem + ".new", final)
        for leftover in [prepared, stem + ".log", stem + ".yosys", *(f"{stem}.{w}" for w in ABC_SCRIPTS)]:
            if os.path.exists(leftover):
                os.remove(leftover)
        return kind

    def result(self, kind, effort):
        """A kept result: its way, its delay and its cells."""
        with open(self.path(kind, effort), encoding="utf-8") as file:
            return json.load(file)

    def area(self, kind, effort):
        """um2 of the cells of a kept result, before large nets get buffers."""
        types = [cell["type"] for cell in self.result(kind, effort)["cells"].values()]
        return sum(self.library.cells[t].area for t in types if t in self.library.cells)

    def kept(self, kind, effort):
        """The path of a kept result, or None."""
        path = self.path(kind, effort)
        return path if os.path.exists(path) else None

    def map_all(self, kinds, efforts=None, again_for=""):
        """Maps what is not kept yet; `efforts`: by identity, where it is not the first; `again_for`: speed or area,
        where all of them have been mapped before. Returns the paths of the results, by identity.
        """
        efforts = efforts or {}
        new = f"{self.constraints}.{os.getpid()}"
        with open(new, "w", encoding="utf-8") as file:
            file.write(f"set_driving_cell {self.library.driver}\nset_load {self.output_load} [all_outputs]\n")
        os.rename(new, self.constraints)
        # Two kinds that differ in nothing that is mapped have one result: two threads would take each other's files.
        of_path = {self.path(k, efforts.get(k.identity, 0)): k for k in kinds}
        missing = [k for path, k in of_path.items() if not os.path.exists(path)]
        if missing:
            again = f" again, for {again_for}" if again_for else ""
            kept = f"; {len(kinds) - len(missing)} are kept" if len(missing) < len(kinds) else ""
            self.phases.note(f"{len(missing)} kinds of block to map{again}{kept}")
        # The large ones first, so that the last to finish is a small one.
        missing.sort(key=lambda k: -k.bits)
        left = Remaining(missing)
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            pending = {pool.submit(self.map_one, k, efforts.get(k.identity, 0)): k for k in missing}
            for count, done in enumerate(concurrent.futures.as_completed(pending), 1):
                kind = pending[done]
                try:
                    done.result()
                except SynthError as error:
                    pool.shutdown(cancel_futures=True)
                    raise SynthError(f"{kind.name} cannot be mapped: {error}") from error
                self.phases.note(f"block {count} of {len(missing)}: {kind.base}{left.after(kind)}")
        return {k.identity: self.kept(k, efforts.get(k.identity, 0)) for k in kinds}
