#!/usr/bin/env python3
"""Checks the tables of counters in docs/develop/coverage.md: scripts/counter_table.py; exit code 1 if a row is
missing.

Each register of rtl/ that is set to a sum or difference with itself has its row in one of two tables: of those that
wrap, with the tests in which they do, and of those that never wrap. Every register that the tables name must be in the
Verilog, and every test that they name must build its module.
"""
import re
import sys

import module_table

PAGE = module_table.ROOT / "docs/develop/coverage.md"
HEADS = ("| wraps |", "| never wraps |")
LEVELS = 2  # of wires between a register and its sum


def wires(text):
    """[name] = what a wire or an assignment has it be."""
    found = {}
    for statement in re.findall(r"(?:\bwire\b|\bassign\b)\s*(?:\[[^;=]*?\])?\s*(\w+\s*=[^;]*);", text):
        for part in re.split(r",\s*(?=\w+ = )", statement):
            name, _, value = part.partition("=")
            found.setdefault(name.strip(), value)
    return found


def counters(text):
    """Registers that are set to a sum or a difference with themselves."""
    text = re.sub(r"//.*", "", text)
    known, found = wires(text), set()
    for targets, value in re.findall(r"(\{[\w, ]+\}|\w+\s*(?:\[[^;=]*?\])?)\s*<=\s*([^;]*);", text):
        for name in re.findall(r"\w+", targets) if targets.startswith("{") else re.findall(r"^\w+", targets):
            whole = value
            for _ in range(LEVELS):
                whole = re.sub(
                    r"\b[a-z]\w*\b", lambda word: f"({known[word[0]]})" if word[0] in known else word[0], whole
                )
            itself = rf"\b{name}\b(?:\[[^\]]*\])?"
            if re.search(rf"{itself}\}}?\)*\s[+-]\s|\s[+-]\s\(*{itself}", whole):
                found.add(name)
    return found


def rows():
    """Cells of each row of the two tables."""
    inside = False
    for line in PAGE.read_text().splitlines():
        if line.startswith(HEADS):
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and not line.startswith("| ---"):
            yield [cell.strip() for cell in line.strip("| ").split(" | ")]


def main():
    texts = module_table.modules()
    holds = module_table.inside(texts)
    built = module_table.tests(holds)
    errors, seen = [], set()
    for cells in rows():
        named = re.findall(r"`(\w+)\.(\w+)`", cells[0])
        if not named:
            errors.append(f"a row names no register: {cells[0]}")
        for module, register in named:
            if not re.search(rf"\b{register}\b", texts.get(module, "")):
                errors.append(f"{module}.{register}: rtl/ has no such register")
            if (module, register) in seen:
                errors.append(f"{module}.{register}: it stands there twice")
            seen.add((module, register))
        named_tests = re.findall(r"`(\w+_test)`", " ".join(cells[1:]))
        for test in named_tests:
            for module, register in named:
                if module in texts and module not in built.get(test, ()):
                    errors.append(f"{module}.{register}: {test} does not build it")
        if len(cells) == 4 and not named_tests:
            errors.append(f"{cells[0]}: the row names no test in which it wraps")
    for module, text in texts.items():
        errors += [
            f"{module}.{register}: a counter without a row"
            for register in sorted(counters(text))
            if (module, register) not in seen
        ]
    for error in errors:
        print(f"docs/develop/coverage.md: {error}", file=sys.stderr)
    if not errors:
        print(f"docs/develop/coverage.md: {len(seen)} counters, each with its row")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
