"""Has Yosys put small faults into a compute unit, all into one netlist, in which a number selects the one that is
active (none: 0)."""
import hashlib
import re
import subprocess

from .catalogue import SELECTED
from .errors import Refused, yosys

# The memories stay whole: faults are in what drives them. `-norom`: no table becomes one. Only logic that can matter
# gets faults: in one flat netlist Yosys takes out what an instance does not use (an operand that its ALU has no use
# for), and what the language makes wider than needed (a loop's 32-bit index); a choice by position is first made one
# of multiplexers, or bits that no position chooses would get some. Each instance has its own logic, so a fault is in
# one lane of one warp. A cell keeps its own place in the source, without those of the instances around it. At the
# end the wires are split where their drivers are, or Verilator would see loops through words with bits that depend on
# each other, and be four times as slow.
MUTATE = """read_verilog -Irtl/include rtl/*/*.v
hierarchy -check -top rp_compute_unit {parameters}
proc -norom
setattr -mod -set keep_hierarchy 1 *ram_1rw *ram_1r1w *ram_2r1w
setattr -unset src t:$paramod* t:[a-z]*
flatten
opt_expr
wreduce
techmap -max_iter 1 t:$shiftx t:$shift
opt -full
wreduce
opt -full
cd rp_compute_unit
mutate -list {count} -seed {seed} -o {folder}/list.txt -ctrl mutant_i {width} 1 {chosen} t:$mem* %d
cd
tee -q -o {folder}/apply.log script {folder}/list.txt
delete -input rp_compute_unit/w:mutant_i
splitnets -driver
opt_clean
write_verilog -noattr {folder}/netlist.v
"""
QUIET = ("UNOPTFLAT", "WIDTH", "PINMISSING", "CASEINCOMPLETE", "CASEOVERLAP", "UNSIGNED", "CMPCONST")


def option_of(line, name):
    found = re.search(f" -{name} ([^ ]+)", line)
    return found[1] if found else ""


def fault_of(number, line):
    """What Yosys' `mutate -list` prints of one, without the numbers that it makes up."""
    # Lines of rtl/*/*.v, the first one with a number (line 0 is a whole loop); a header's place helps little.
    places = re.findall(r"-src rtl/[a-z]+/([a-z_0-9]+\.v):([0-9]+)\.", line)
    file, at = next((place for place in places if place[1] != "0"), places[0] if places else ("", ""))
    # A cell's name: where it is in the hierarchy, what it is, its place, and a running number, which means nothing.
    cell = re.sub(r"\$([a-z_]+)\$[^ $]*?([a-z_0-9]+\.vh?:[0-9]+)\$[0-9]+", r"\1 at \2", option_of(line, "cell"))
    cell = re.sub(r"\$[^ $]*\.cc:[0-9]+:", "", cell)
    cell = re.sub(r"^\$(flatten|auto|techmap)+|\\|\$[0-9]+|\$", "", cell)
    if " at " not in cell and file:
        cell += f" at {file}:{at}"
    what = f"{option_of(line, 'mode')}, {option_of(line, 'port')}[{option_of(line, 'portbit')}] of {cell}"
    if option_of(line, "ctrlbit"):
        what += f", by bit {option_of(line, 'ctrlbit')}"
    if option_of(line, "wire"):
        what += f", wire {option_of(line, 'wire')}[{option_of(line, 'wirebit')}]"
    return {"number": number, "file": file or "(made by Yosys)", "bug": what}


def with_number(netlist, parameters, declared):
    """The netlist with its parameters, which stand for themselves now, and the number of its fault from outside."""
    given = [name.split("=")[0] for name in parameters]
    declarations = parameters + [f"{name}=0" for name in declared if name not in given]
    head, begin, rest = netlist.partition("module rp_compute_unit(")
    body, end, rest = rest.partition("endmodule")
    body, found = re.subn(r"^  wire (\[\d+:0\]) mutant_i;",
                          lambda wire: f"  reg {wire[1]} mutant_i;\n  initial mutant_i = {SELECTED};", body, flags=re.M)
    if found != 1:
        raise Refused("the netlist has no fault selector")
    quiet = "".join(f"/* verilator lint_off {rule} */\n" for rule in QUIET)
    listed = ", ".join(f"parameter {name}" for name in declarations)
    return f"{quiet}{head}module rp_compute_unit #({listed})({body}{end}{rest}"


def around(texts):
    """Names of the files that stand around the unit: the multiprocessor, and what it instantiates."""
    names = ["rp_multiprocessor.v"]
    for name in names:
        instances = {f"{module}.v" for module in re.findall(r"^ *([a-z_0-9]+) (?:#\(|[a-z_]+ \()", texts[name], re.M)}
        names += sorted((instances & texts.keys()) - {*names, "rp_compute_unit.v"})
    return names


def put_in(texts, folder, count, seed, names, parameters):
    """So many faults in the unit with these parameters, or in what the files describe only; `texts` becomes what
    Verilator gets. A netlist that is up to date is not made again."""
    for name in names:
        if name not in texts:
            raise Refused(f"there is no rtl/{name}: name files of rtl/")
    chosen = " ".join(f"a:src=*/{name}:*" + (" %u" if place else "") for place, name in enumerate(names)) or "*"
    script = MUTATE.format(folder=folder, count=count, seed=seed, width=count.bit_length(), chosen=chosen,
                           parameters=" ".join(f"-chparam {value.replace('=', ' ')}" for value in parameters))
    version = subprocess.run(["yosys", "-V"], capture_output=True, text=True, check=False).stdout
    made_of = "\n".join([version, script, *(texts[name] for name in sorted(texts))])
    digest = hashlib.sha256(made_of.encode()).hexdigest()
    stamp = folder / "stamp"
    if not stamp.exists() or stamp.read_text() != digest:
        yosys(script, folder / "yosys.log")
        stamp.write_text(digest)
    lines = (folder / "list.txt").read_text().splitlines()
    if len(lines) != count:
        raise Refused(f"Yosys has found only {len(lines)} places for faults")
    declared = re.findall(r"^ *parameter integer ([A-Z_]+)",
                          re.search(r"^module.*?^\) \(", texts["rp_compute_unit.v"], re.S | re.M)[0], re.M)  # fmt: skip
    kept = {name: text for name, text in texts.items() if not name.endswith(".v")}
    kept |= {name: texts[name] for name in around(texts)}
    texts.clear()
    texts |= kept | {"rp_compute_unit.v": with_number((folder / "netlist.v").read_text(), parameters, declared)}
    return [fault_of(number, line) for number, line in enumerate(lines, 1)]
