"""Puts every fault of tb/faults/catalogue.json into a copy of rtl/, each behind its number: where the catalogue has
`right`, the copy has `designer_fault == N ? wrong : right`, or an `if` of statements. With number 0 the copy is what
rtl/ is. The number comes from the environment variable RAYPOOL_FAULT in Verilator, from +fault=N in Icarus.
"""
import json
import re

from .errors import Refused

SELECTED = r'''$c32("(std::getenv(\"RAYPOOL_FAULT\") ? std::atoi(std::getenv(\"RAYPOOL_FAULT\")) : 0)")'''
SELECTOR = f"""
  // The fault that this module has; 0: none.
  reg [31:0] designer_fault;
`ifdef VERILATOR
  initial designer_fault = {SELECTED};
`else
  initial if (!$value$plusargs("fault=%d", designer_fault)) designer_fault = 32'd0;
`endif
"""


def places(piece, text):
    """Where a piece of Verilog stands in a text, however either is broken into lines: all [(begin, end)]."""
    pattern = r"\s+".join(re.escape(word) for word in piece.split())
    return [found.span() for found in re.finditer(pattern, text)]


def place(fault, text):
    """Where in the file's text `right` stands: begin and end."""
    name = f"fault {fault['number']} ({fault['file']}: {fault['bug']})"
    around = fault.get("at", fault["right"])
    begin, end = 0, len(text)
    for what, piece, where in (("at", around, f"in rtl/{fault['file']}"), ("right", fault["right"], "in its `at`")):
        found = places(piece, text[begin:end])
        if len(found) != 1:
            raise Refused(
                f"{name}: `{piece}` is {where} {len(found)} times, not once: "
                f"bring its `{what}` in the catalogue up to date"
            )
        begin, end = begin + found[0][0], begin + found[0][1]
    if fault["wrong"] == fault["right"]:
        raise Refused(f"{name}: `wrong` is the same as `right`")
    return begin, end


def chosen(number, wrong, right):
    """Verilog that is `wrong` for this number."""
    if re.search(r"(;|\bend)\s*$", right):
        return f"if (designer_fault == 32'd{number}) begin {wrong} end else begin {right} end"
    return f"(designer_fault == 32'd{number} ? ({wrong}) : ({right}))"


def with_faults(text, edits):
    """The text with all edits [(begin, end, number, wrong)]; of two places one lies in the other, or they are apart."""
    done = []
    for begin, end, number, wrong in sorted(edits, key=lambda edit: (edit[1] - edit[0], edit[2])):
        inside = [d for d in done if begin <= d[0] and d[1] <= end]
        if any(d[0] < end and begin < d[1] for d in done if d not in inside):
            raise Refused(f"fault {number}: its place is partly that of another fault")
        right = text[begin:end]
        for d in sorted(inside, reverse=True):
            right = right[: d[0] - begin] + d[2] + right[d[1] - begin :]
        done = [d for d in done if d not in inside] + [(begin, end, chosen(number, wrong, right))]
    for begin, end, new in sorted(done, reverse=True):
        text = text[:begin] + new + text[end:]
    return text


def with_selector(name, text):
    """The module with the number of the fault that is active."""
    ports = re.search(r"^\);\n", text, re.MULTILINE)
    if ports is None:
        raise Refused(f"rtl/{name}: its port list does not end with a line `);`")
    return text[: ports.end()] + SELECTOR + text[ports.end() :]


def put_in(texts, catalogue):
    """The faults of the file, which are put into the texts {name: text}."""
    faults = json.loads(catalogue.read_text())
    numbers = [fault["number"] for fault in faults]
    if numbers != list(range(1, len(faults) + 1)):
        raise Refused(f"{catalogue}: the faults must be numbered from 1 on, in order")
    for name in sorted({fault["file"] for fault in faults}):
        if name not in texts:
            raise Refused(f"{catalogue}: there is no rtl/{name}")
        own = [fault for fault in faults if fault["file"] == name]
        edits = [(*place(fault, texts[name]), fault["number"], fault["wrong"]) for fault in own]
        texts[name] = with_selector(name, with_faults(texts[name], edits))
    return faults
