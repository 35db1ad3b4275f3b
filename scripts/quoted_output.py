#!/usr/bin/env python3
"""Runs the commands that README and docs quote and compares what they print.

    scripts/quoted_output.py [--long] [--update] [--rules] [--only TEXT] [--file NAME=PATH]... [PAGE...]

In a page an indented block is a command and its output: lines "$ COMMAND", each followed by what it prints. Everything
else stands in a fence. A line "..." stands for any lines. Seconds and minutes are not compared. A comment above a block
marks what else is special:

    <!-- quoted: long -->        takes more than half a minute: run with --long only
    <!-- quoted: measured -->    its figures are rates of a machine: only the words between them are compared
    <!-- quoted: needs FILE -->  not part of the project: run only with --file FILE=PATH, which takes its place

Commands run in the project's folder; `raypool` and `build/` are those of the build folder (BUILD, default build).
--update writes what was printed into the page. The exit code is 1 when something differs, 2 for a wrong call, a command
that fails, or a page that breaks these rules.
"""
import argparse
import difflib
import os
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = ["README.md"] + sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md"))
INDENT = "    "
OPTION = re.compile(r"<!-- quoted: (.*) -->$")
TIME = re.compile(r"\b\d+(\.\d+)? (s|min|h)\b")
FIGURE = re.compile(r"\s*[-+]?\d+(\.\d+)?%?")


class PageError(Exception):
    pass


class Quote:
    """One command of a page: its text, the lines below it without the indent, and where they begin and end."""

    def __init__(self, page, line, options, command):
        self.page, self.line, self.options, self.command = page, line, options, command
        self.begin = self.end = line + 1
        self.output = []

    def place(self):
        return f"{self.page}:{self.line + 1}"


def quotes_of(page, lines):
    """The quotes of a page, in their order. Throws PageError at an indented block that is none."""
    quotes, fenced, inside, options = [], False, False, []
    for number, line in enumerate(lines):
        if line.startswith("```"):
            fenced = not fenced
        if fenced or line.startswith("```"):
            inside = False
            continue
        if line.startswith(INDENT):
            text = line[len(INDENT) :]
            if text.startswith("$ "):
                quotes.append(Quote(page, number, options, text[2:].strip()))
            elif not inside:
                raise PageError(
                    f"{page}:{number + 1}: an indented block begins with '$ COMMAND'; "
                    "put anything else into a fence (```)"
                )
            else:
                quote = quotes[-1]
                quote.output += [""] * (number - quote.end) + [text]
                quote.end = number + 1
            inside = True
        elif line:
            inside = False
            match = OPTION.match(line)
            options = [option.strip() for option in match.group(1).split(",")] if match else []
            for option in options:
                if option not in ("long", "measured") and not re.fullmatch(r"needs \S+", option):
                    raise PageError(f"{page}:{number + 1}: '{option}' is neither long, measured nor needs FILE")
    return quotes


def run(quote, files):
    """What the command prints. Throws PageError when it fails."""
    build = os.environ.get("BUILD", "build")
    command = re.sub(r"(?<![\w./-])build/", lambda match: shlex.quote(build) + "/", quote.command)
    for name, path in files.items():
        command = command.replace(name, shlex.quote(path))
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    environment["PATH"] = str((ROOT / build).resolve()) + os.pathsep + environment["PATH"]
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=ROOT,
        env=environment,
        check=False,
        text=True,
        errors="replace",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    if done.returncode != 0:
        raise PageError(
            f"{quote.place()}: '{quote.command}' ends with {done.returncode}:\n"
            f"{done.stdout[-2000:]}{done.stderr[-2000:]}"
        )
    printed = [line.rstrip().replace(build, "build") for line in done.stdout.splitlines()]
    while printed and not printed[-1]:
        printed.pop()
    return printed


def comparable(line, measured):
    line = TIME.sub(lambda match: "# " + match.group(2), line)
    return FIGURE.sub(" #", line) if measured else line


def omits(line):
    return line.strip() == "..."


def same(quoted, printed, measured):
    """Do the printed lines fit the quoted ones, in which "..." stands for any lines?"""
    if not any(map(omits, quoted)):
        return [comparable(line, measured) for line in quoted] == [comparable(line, measured) for line in printed]
    at = next(number for number, line in enumerate(quoted) if omits(line))
    if not same(quoted[:at], printed[:at], measured):
        return False
    rest = quoted[at + 1 :]
    return any(same(rest, printed[begin:], measured) for begin in range(at, len(printed) + 1))


def abridged(quoted, printed):
    """The printed lines, with as many at both ends as the quoted ones have around their one "..."."""
    omitted = [number for number, line in enumerate(quoted) if omits(line)]
    if not omitted:
        return printed
    if len(omitted) > 1:
        raise PageError("a quote with several '...' must be mended by hand")
    at = omitted[0]
    return printed[:at] + [quoted[at]] + printed[len(printed) - (len(quoted) - at - 1) :]


def check_page(page, options, files):
    """Runs the page's quotes; the number of those that differ and the number of those that were run."""
    path = ROOT / page
    lines = path.read_text(encoding="utf-8").split("\n")
    differ = ran = 0
    updates = []
    for quote in quotes_of(page, lines):
        if options.only not in quote.command:
            continue
        needed = [option.split()[1] for option in quote.options if option.startswith("needs ")]
        if ("long" in quote.options and not options.long) or any(name not in files for name in needed):
            print(f"{quote.place()}: left out: {quote.command}", flush=True)
            continue
        printed = run(quote, files)
        ran += 1
        measured = "measured" in quote.options
        if same(quote.output, printed, measured) and not (options.update and measured):
            print(f"{quote.place()}: as quoted: {quote.command}", flush=True)
            continue
        differ += 1
        if options.update:
            print(f"{quote.place()}: updated: {quote.command}", flush=True)
            updates.append((quote, abridged(quote.output, printed)))
            continue
        print(f"{quote.place()}: '{quote.command}' prints something else than is quoted there:")
        shown = [[comparable(line, measured) for line in text] for text in (quote.output, printed)]
        print("\n".join(difflib.unified_diff(*shown, "quoted", "printed", lineterm="", n=1)), flush=True)
    for quote, printed in reversed(updates):
        lines[quote.begin : quote.end] = [(INDENT + line).rstrip() for line in printed]
    if updates:
        path.write_text("\n".join(lines), encoding="utf-8")
    return differ, ran


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="default: README.md and all of docs/")
    parser.add_argument("--long", action="store_true", help="those that take long too")
    parser.add_argument("--update", action="store_true", help="write what was printed into the pages")
    parser.add_argument(
        "--rules", action="store_true", help="run nothing; check only that every indented block is a quote"
    )
    parser.add_argument("--only", default="", metavar="TEXT", help="only commands that have this in them")
    parser.add_argument("--file", action="append", default=[], metavar="NAME=PATH", help="a file that quotes need")
    options = parser.parse_args()
    unknown = [page for page in options.pages if page not in PAGES]
    if unknown:
        parser.error(f"'{unknown[0]}' is not a page: README.md or one of docs/**/*.md, named from the project's folder")
    wrong = [text for text in options.file if "=" not in text or not pathlib.Path(text.split("=", 1)[1]).is_file()]
    if wrong:
        parser.error(f"--file {wrong[0]}: NAME=PATH of a file that is there")
    files = {name: str(pathlib.Path(path).resolve()) for name, path in (text.split("=", 1) for text in options.file)}
    differ = ran = 0
    for page in options.pages or PAGES:
        if options.rules:
            ran += len(quotes_of(page, (ROOT / page).read_text(encoding="utf-8").split("\n")))
            continue
        page_differs, page_ran = check_page(page, options, files)
        differ, ran = differ + page_differs, ran + page_ran
    print(f"quoted output: {ran} commands, {differ} {'updated' if options.update else 'differ'}")
    return 1 if differ and not options.update else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PageError as error:
        print(f"quoted_output.py: {error}", file=sys.stderr)
        sys.exit(2)
