"""Puts small random faults into the text of modules. A fault inverts or ties a bit of a signal where an expression
reads it, or takes one operator for another, leaves out a negation, or is off by one in a number. Each is behind its
number, as the faults of the catalogue are, so all instances of the module, of any size, have it.
"""
import hashlib
import random
import re

from .catalogue import with_faults, with_selector
from .errors import Refused

NAME = r"[A-Za-z_$][\w$]*"
DECLARED = re.compile(
    rf"\b(?:wire|reg)\b\s*(signed\b)?\s*(?:\[([^\]:]+):([^\]]+)\])?\s*({NAME}(?:\s*,\s*{NAME})*)\s*(?=[;=,)\n])"
)
OTHER = {
    "&&": "||",
    "||": "&&",
    "==": "!=",
    "!=": "==",
    "<": "<=",
    "<=": "<",
    ">": ">=",
    ">=": ">",
    "+": "-",
    "-": "+",
    "&": "|",
    "|": "&",
    "^": "|",
}
TOKEN = re.compile(rf"\d*'[bdh][\da-fA-F_xz]+|\d+|{NAME}|&&|\|\||[=!]=|<<<?|>>>?|<=|>=|\*\*|\S")
# A faulty expression may be of another width than the right one was, or be constant.
QUIET = "".join(
    f"/* verilator lint_off {rule} */\n" for rule in ("WIDTH", "UNSIGNED", "CMPCONST", "UNOPTFLAT", "CASEINCOMPLETE")
)
NUMBER = re.compile(r"(\d+)'d(\d+)$")
OPEN, CLOSE = "([{", ")]}"


def without_comments(text):
    """The same, with blanks for comments, functions and headers."""

    def blank(found):
        return re.sub(r"[^\n]", " ", found[0])

    for pattern in (r"//[^\n]*", r"\bfunction\b.*?\bendfunction\b", r"^`[^\n]*", r'"[^"\n]*"'):
        text = re.sub(pattern, blank, text, flags=re.DOTALL | re.MULTILINE)
    return text


def closing(text, begin):
    """Where the bracket closes that opens at `begin`."""
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] in OPEN) - (text[at] in CLOSE)
        if depth == 0:
            return at
    return len(text)


def signals_of(text):
    """{name: (signed, upper, lower)} of what is declared; no bounds: one bit."""
    signals = {}
    for signed, upper, lower, names in DECLARED.findall(text):
        for name in re.split(r"\s*,\s*", names):
            signals[name] = (bool(signed), upper.strip(), lower.strip())
    return {name: signal for name, signal in signals.items() if name not in ("clk_i", "rst_ni")}


def expressions(text):
    """Where something is assigned, asked or given to an input: [(begin, end)]."""
    places = set()
    body = re.search(r"^\);\n", text, re.MULTILINE)
    begin = at = body.end() if body else 0
    depth, assigned = 0, None
    while at < len(text):
        depth += (text[at] in OPEN) - (text[at] in CLOSE)
        if depth == 0 and assigned is None and text[at] == "=" and text[at - 1] not in "=!<>" and text[at + 1] != "=":
            assigned = at + 1
        if depth == 0 and assigned is None and text.startswith("<=", at):
            assigned = at + 2
        if depth == 0 and text[at] in ";,":
            before = text[begin : assigned or at]
            if assigned is not None and not re.search(r"\b(parameter|localparam|genvar|integer|initial)\b", before):
                places.add((assigned, at))
            begin, assigned = at + 1, None
        at += 1
    for found in re.finditer(r"\b(?:if|case) \(|\.\w+_i\s*\(", text):
        places.add((found.end(), closing(text, found.end() - 1)))
    trimmed = []
    for begin, end in sorted(places):
        inside = text[begin:end]
        if inside.strip():
            trimmed.append((begin + len(inside) - len(inside.lstrip()), begin + len(inside.rstrip())))
    return trimmed


def bit_of(signal, rng):
    """A bit of it, counted from its lowest."""
    _, upper, lower = signal
    if not upper:
        return "0"
    if upper.isdigit() and lower.isdigit():
        return str(rng.randrange(int(upper) - int(lower) + 1))
    return rng.choice(["0", f"({upper} - {lower})" if lower != "0" else f"({upper})"])


def faulty_read(text, name, signal, rng):
    """What is read, `text`, with a faulty bit, and which."""
    whole = text == name
    bit = bit_of(signal, rng) if whole else "0"
    mask = f"(1'b1 << {bit})" if whole and signal[1] else "1'b1"
    kind = rng.choice(["inverted", "0", "1"])
    wrong = {"inverted": f"{text} ^ {mask}", "0": f"{text} & ~({mask})", "1": f"{text} | {mask}"}[kind]
    if whole and signal[0]:
        wrong = f"$signed({wrong})"
    return f"({wrong})", f"bit {bit} of {' '.join(text.split())} is {kind}"


def counts_of_copies(inside, signals):
    """Where the number of copies of something stands, as in {COUNT{x}}: [(begin, end)]."""
    groups = re.finditer(r"\{([^{},]*)(?=\{)", inside)
    return [found.span(1) for found in groups if not any(word in signals for word in re.findall(NAME, found[1]))]


def edits_of(inside, signals, rng):
    """Faults of one expression: [(what it becomes, sentence)]."""
    copies = counts_of_copies(inside, signals)
    edits, depth, behind, last = [], 0, -1, None
    for token in TOKEN.finditer(inside):
        word, at = token[0], token.start()
        depth += (word == "[") - (word == "]")
        unary = last is None or last in OTHER or last in tuple("([{,?:~!=")
        previous, last = last, word
        if depth or at < behind or word == "[" or any(begin <= at < end for begin, end in copies):
            continue

        def put(new, what, upto, at=at):
            edits.append((inside[:at] + new + inside[upto:], what))

        if word in signals and previous != ".":
            upto = token.end()
            while inside[upto : upto + 1] == "[":
                upto = behind = closing(inside, upto) + 1
            for _ in range(2):
                new, what = faulty_read(inside[at:upto], word, signals[word], rng)
                put(new, what, upto)
        elif word in OTHER and not unary:
            put(OTHER[word], f"{OTHER[word]} in place of {word}", token.end())
        elif word in ("!", "~") and unary:
            put(" ", f"{word} is left out", token.end())
        elif NUMBER.match(word):
            width, value = map(int, NUMBER.match(word).groups())
            other = (value + rng.choice([1, -1])) % (1 << width)
            put(f"{width}'d{other}", f"{width}'d{other} in place of {word}", token.end())
        elif word in ("1'b0", "1'b1"):
            put("1'b1" if word == "1'b0" else "1'b0", f"not {word}", token.end())
    return edits


def mutants_of(raw, count, seed):
    """So many faults of one file: [(begin, end, wrong, sentence)]. Which they are depends on their expressions and the
    seed alone: so what is changed elsewhere in the file leaves most of them as they are.
    """
    text = without_comments(raw)
    signals = signals_of(text)
    seen, ordered = {}, []
    for place in expressions(text):
        inside = raw[place[0] : place[1]]
        if "//" in inside or not any(word in signals for word in re.findall(NAME, inside)):
            continue
        said = " ".join(inside.split())
        seen[said] = seen.get(said, 0) + 1
        said += f" ({seen[said]})" if seen[said] > 1 else ""
        for number, (wrong, what) in enumerate(edits_of(inside, signals, random.Random(f"{seed} {said}"))):
            order = hashlib.sha256(f"{seed} {said} {number}".encode()).hexdigest()
            ordered.append((order, (*place, wrong, f"{what} in {said}")))
    result, sentences = [], set()
    for _, fault in sorted(ordered):
        # Of two places one may lie in the other, or they are apart.
        begin, end, _, what = fault
        partly = any(a < end and begin < b and not (a <= begin and end <= b or begin <= a and b <= end)
                     for a, b, *_ in result)  # fmt: skip
        if partly or what in sentences or len(result) == count:
            continue
        sentences.add(what)
        result.append(fault)
    return sorted(result, key=lambda fault: (fault[0], fault[3]))


def put_in(texts, each, seed, names):
    """So many faults for each of the files, which are put into the texts {name: text}."""
    faults = []
    for name in names:
        if name not in texts:
            raise Refused(f"there is no rtl/{name}")
        edits = []
        for begin, end, wrong, what in mutants_of(texts[name], each, f"{seed} {name}"):
            faults.append({"number": len(faults) + 1, "file": name, "bug": what})
            edits.append((begin, end, len(faults), wrong))
        texts[name] = QUIET + with_selector(name, with_faults(texts[name], edits))
    return faults
