"""Boolean functions as Liberty writes them: ! and ' invert, ^ binds next, then * & and a mere space, then + and |."""
import itertools
import re

from .errors import SynthError


def parse(text):
    """A tree of ("not", a), ("xor" | "and" | "or", a, b), a name, 0 or 1."""
    tokens = re.findall(r"[A-Za-z_]\w*|[01]|[!'^*&+|()]", text)
    place = 0

    def peek():
        return tokens[place] if place < len(tokens) else None

    def take():
        nonlocal place
        place += 1
        return tokens[place - 1]

    def atom():
        token = peek()
        if token is None:
            raise SynthError(f"a Liberty function is not understood: {text}")
        take()
        if token == "!":
            return ("not", atom())
        if token == "(":
            value = lowest()
            if peek() != ")":
                raise SynthError(f"a Liberty function is not understood: {text}")
            take()
        elif token in ("0", "1"):
            value = int(token)
        elif re.match(r"[A-Za-z_]", token):
            value = token
        else:
            raise SynthError(f"a Liberty function is not understood: {text}")
        while peek() == "'":
            take()
            value = ("not", value)
        return value

    def exclusive():
        value = atom()
        while peek() == "^":
            take()
            value = ("xor", value, atom())
        return value

    def both():
        value = exclusive()
        while peek() is not None and peek() not in ("+", "|", ")"):
            if peek() in ("*", "&"):
                take()
            value = ("and", value, exclusive())
        return value

    def lowest():
        value = both()
        while peek() in ("+", "|"):
            take()
            value = ("or", value, both())
        return value

    tree = lowest()
    if place != len(tokens):
        raise SynthError(f"a Liberty function is not understood: {text}")
    return tree


def value_of(tree, values):
    if isinstance(tree, int):
        return tree
    if isinstance(tree, str):
        return values[tree]
    parts = [value_of(t, values) for t in tree[1:]]
    return {
        "not": lambda: 1 - parts[0],
        "xor": lambda: parts[0] ^ parts[1],
        "and": lambda: parts[0] & parts[1],
        "or": lambda: parts[0] | parts[1],
    }[tree[0]]()


def truth(text, inputs):
    """The truth table as an integer: bit i is the value for the inputs' bits i, the first input lowest."""
    tree, table = parse(text), 0
    for i, bits in enumerate(itertools.product((0, 1), repeat=len(inputs))):
        try:
            table |= value_of(tree, dict(zip(reversed(inputs), bits))) << i
        except KeyError as error:
            raise SynthError(f"the Liberty function {text} has a variable {error} that is no input") from error
    return table
