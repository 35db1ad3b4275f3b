"""Colours and marks, the same for the same thing in every figure; those of ALUs can be distinguished by the
colour-blind (Okabe and Ito), and in every figure a mark or a word repeats what the colour means.

A plot is drawn in the light colour; in the page it becomes the variable of that name, which dark has another value of.
"""

# name: (light, dark)
COLOURS = {
    "ink": ("#1b1f24", "#e7eaee"),
    "muted": ("#5b6570", "#a3adb8"),
    "line": ("#d5dae0", "#363d46"),
    "paper": ("#fefefe", "#14171b"),
    "accent": ("#1f4e79", "#8ec1f0"),
    "published": ("#8a5a00", "#e2b04a"),
    "tid": ("#6b6b6c", "#a8a8a9"),
    "brh": ("#4ba3d9", "#7cc4ee"),
    "mem": ("#018f68", "#2cc199"),
    "int": ("#0069a8", "#4d9fdc"),
    "flt": ("#cf5600", "#f2813a"),
    "slw": ("#b8659a", "#dd94c3"),
    "ray": ("#d18f00", "#efb63c"),
    "other": ("#7d6b91", "#b3a2c9"),
    "issued": ("#24292f", "#f0f3f6"),
    "fetch": ("#8b949e", "#767f8a"),
    "registers": ("#adb5bd", "#59616b"),
    "import": ("#7a4a2b", "#c08a66"),
    "export": ("#b08968", "#8f6a4c"),
    "idle1": ("#c6cdd5", "#3b434d"),
    "idle2": ("#d9dee4", "#2f363e"),
    "idle3": ("#ebeef1", "#242a31"),
    "s1": ("#55a3bd", "#3f829f"),
    "s2": ("#3c8aa8", "#559bbb"),
    "s3": ("#2b7191", "#73b5d1"),
    "s4": ("#1e5878", "#98cde2"),
    "s5": ("#15405e", "#bfe1ee"),
    "s6": ("#0c2840", "#e4f3f9"),
}
ALUS = ("int", "flt", "slw", "mem", "ray", "brh", "tid")
# Of an ALU, and of a place in an ordered series.
MARKS = {"int": "o", "flt": "s", "slw": "D", "mem": "^", "ray": "v", "brh": "P", "tid": "X", "other": "*"}
SHADES = ("s1", "s2", "s3", "s4", "s5", "s6")
SERIES_MARKS = ("o", "s", "^", "D", "v", "P")


def colour(name):
    """For the plot; variable_of() finds the name again."""
    return COLOURS[name][0]


def series(count):
    """(colour, mark) for each place of an ordered series, from faint to strong; beyond six they begin again."""
    shown = min(count, len(SHADES))
    step = (len(SHADES) - 1) / max(1, shown - 1)
    return [(SHADES[round(place % shown * step)], SERIES_MARKS[place % len(SERIES_MARKS)]) for place in range(count)]


def alu_colour(alu):
    return alu if alu in ALUS else "other"


VARIABLES = {light: name for name, (light, _) in COLOURS.items()}
assert len(VARIABLES) == len(COLOURS), "two colours are the same in light"


def css():
    """The variables, light and dark; print is light."""
    def block(index, indent):
        return "\n".join(f"{indent}--{name}: {pair[index]};" for name, pair in COLOURS.items())

    return (f":root {{\n{block(0, '  ')}\n}}\n@media screen and (prefers-color-scheme: dark) {{\n  :root {{\n"
            f"{block(1, '    ')}\n  }}\n}}\n")
