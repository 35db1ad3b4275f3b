#!/usr/bin/env python3
"""clang-tidy on the C++ sources that the build compiles: scripts/tidy.py BUILD [--since COMMIT | --share K/N]
[FOLDER...]; exit code 1 if it finds anything.
--since: only what differs from COMMIT, in commits or not yet in one; for a header, a source that includes it.
--share: only the K-th of N parts of the sources. FOLDER: only what lies in it.

Nearly all of its time goes to the headers of libraries, which most sources share. So sources of a folder are read in
one piece, behind each other, as far as their names allow; what clashes goes to another piece. A finding's line is
that of its source again. BUILD has the compile_commands.json.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST = 16  # sources of a piece, so that there are pieces for all cores
MESSAGE = re.compile(r"^(?P<file>/[^:\n]+):(?P<line>\d+):(?P<rest>\d+: (?P<kind>\w+).*)$", re.M)
NOISE = re.compile(r"^(\d+ warnings? (generated|treated)|Suppressed|Use -header-filter)")


def git(*arguments):
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"tidy.py: git {' '.join(arguments)}: {run.stderr.strip()}")
    return run.stdout


def includers(headers):
    """[header] = the sources and headers that include it, by path, where a file's name in quotes is one of these."""
    by_name = collections.defaultdict(list)
    for header in headers:
        by_name[header.name].append(header)
    found = collections.defaultdict(list)
    for name in git("ls-files", "*.cpp", "*.hpp").split():
        path = ROOT / name
        if not path.is_file():
            continue
        for included in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
            for header in by_name[included.rsplit("/", 1)[-1]]:
                if str(header).endswith("/" + included):
                    found[header].append(path)
    return found


def changed_sources(since):
    """The sources that differ from a commit, and for each header that does one that includes it: that of its name, or
    else the first that is found, directly or through other headers."""
    names = git("diff", "--name-only", since, "--", "*.cpp", "*.hpp").split()
    names += git("ls-files", "--others", "--exclude-standard", "--", "*.cpp", "*.hpp").split()
    changed = {ROOT / name for name in names}
    sources = {path for path in changed if path.suffix == ".cpp"}
    headers = {ROOT / name for name in git("ls-files", "*.hpp").split()} | (changed - sources)
    users = includers(headers)
    for header in sorted(changed - sources):
        own = header.with_suffix(".cpp")
        if own.is_file():
            sources.add(own)
            continue
        seen, next_ones = {header}, collections.deque([header])
        while next_ones:
            known = users[next_ones.popleft()]
            source = next((path for path in known if path.suffix == ".cpp"), None)
            if source:
                sources.add(source)
                break
            next_ones += [path for path in known if path not in seen]
            seen.update(known)
    return sources


def share_of(sources, share):
    """The K-th of N parts of the sources, which stand beside each other."""
    match = re.fullmatch(r"(\d+)/(\d+)", share)
    if not match or not 1 <= int(match[1]) <= int(match[2]):
        sys.exit(f"tidy.py: --share is '{share}', and wants K/N with K of 1 .. N, such as 3/10")
    k, n = int(match[1]), int(match[2])
    listed = sorted(sources)
    return set(listed[len(listed) * (k - 1) // n:len(listed) * k // n])


def of_sources(commands):
    """Commands of single sources: those that are compiled in batches take the command of their batch."""
    for entry in commands:
        file = pathlib.Path(entry["file"])
        if file.parent.name != "Unity":
            yield entry
            continue
        for source in re.findall(r'^#include "(.*)"$', file.read_text(), re.M):
            yield {**entry, "file": source}


def make_headers(build, commands, sources):
    """The headers of Verilated models that these sources include, which are made when their bench is built."""
    targets = set()
    for entry in commands:
        if pathlib.Path(entry["file"]) in sources:
            match = re.search(r"CMakeFiles/([^/]+)\.dir/", entry["command"])
            targets.add(match[1] + "_headers")
    known = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], check=True, capture_output=True, text=True)
    targets &= set(re.findall(r"^(\w+_headers): phony", known.stdout, re.M))
    if targets:
        subprocess.run([ROOT / "scripts/build.sh", build, *sorted(targets)], check=True, stdout=subprocess.DEVNULL)


def compiled_sources(commands, ours):
    """[folder] = those of these sources that the build compiles, and [folder] = the compiler's options there."""
    sources, flags = collections.defaultdict(dict), collections.defaultdict(dict)
    for entry in commands:
        path = pathlib.Path(entry["file"])
        if path not in ours:
            continue
        sources[path.parent][path] = None
        words = iter(shlex.split(entry["command"]))
        for word in words:
            if word == "-isystem":
                flags[path.parent][word + next(words)] = None
            elif word.startswith(("-I", "-D", "-std")):
                flags[path.parent][word] = None
    # A file includes what lies beside it, which the piece does not.
    return ({folder: sorted(of) for folder, of in sources.items()},
            {folder: [f"-I{folder}", *of] for folder, of in flags.items()})


class Piece:
    """Sources behind each other in one file, and where each begins."""

    def __init__(self, file, sources):
        self.file, self.sources, self.begins = file, sources, []
        lines = []
        for source in sources:
            self.begins.append(len(lines))
            lines += source.read_text().splitlines()
        file.write_text("\n".join(lines) + "\n")

    def place(self, line):
        """Source and line in it, of a line of the piece."""
        number = max(i for i, begin in enumerate(self.begins) if begin < line)
        return self.sources[number], line - self.begins[number]

    def translated(self, text):
        """The output of a tool, with the places of the sources. Errors of names that clash are of the later source."""
        def translate(match):
            if match["file"] != str(self.file):
                return match[0]
            source, line = self.place(int(match["line"]))
            return f"{source.relative_to(ROOT)}:{line}:{match['rest']}"
        return MESSAGE.sub(translate, text)

    def clashing(self, flags):
        """The sources that do not compile behind the others."""
        run = subprocess.run(["clang++", "-fsyntax-only", "-ferror-limit=0", "-w", *flags, self.file],
                             capture_output=True, text=True)
        if run.returncode == 0:
            return set()
        # An error in a header is of the source that includes it.
        places = re.findall(rf"^(?:In file included from )?{re.escape(str(self.file))}:(\d+):(?:\d+: error)?",
                            run.stderr, re.M)
        return {self.place(int(line))[0] for line in places} - {self.sources[0]}


def pieces(folder, sources, flags, scratch):
    """The folder's sources in as few pieces as their names allow."""
    made, waiting = [], sources
    while waiting:
        chosen, waiting, later = waiting[:MOST], waiting[MOST:], []
        while True:
            name = f"{'_'.join(folder.relative_to(ROOT).parts)}_{len(made)}.cpp"
            piece = Piece(scratch / name, chosen)
            clashing = piece.clashing(flags) if len(chosen) > 1 else set()
            if not clashing:
                break
            later += [source for source in chosen if source in clashing]
            chosen = [source for source in chosen if source not in clashing]
        made.append(piece)
        waiting = later + waiting
    return made


def tidy(piece, flags):
    """What clang-tidy reports of a piece, and whether it is content."""
    run = subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", piece.file, "--", *flags],
                         capture_output=True, text=True)
    text = "\n".join(line for line in (run.stdout + run.stderr).splitlines() if not NOISE.match(line))
    return piece.translated(text), run.returncode == 0


def main():
    parser = argparse.ArgumentParser(prog="tidy.py", description=__doc__,
                                     usage="scripts/tidy.py BUILD [--since COMMIT | --share K/N] [FOLDER...]",
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("folders", nargs="*")
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("--since")
    chosen.add_argument("--share")
    options = parser.parse_intermixed_args()
    file = pathlib.Path(options.build, "compile_commands.json")
    if not file.is_file():
        sys.exit(f"tidy.py: there is no {file}: configure the build with tests, or run make lint")
    # Sources that a larger variant of a bench is built from too are read as those of make test.
    commands = [entry for entry in of_sources(json.loads(file.read_text()))
                if "-DRAYPOOL_LARGE" not in entry["command"]]
    listed = subprocess.run([ROOT / "scripts/sources.sh", "cpp"], cwd=ROOT, check=True, capture_output=True, text=True)
    ours = {ROOT / name for name in listed.stdout.split() if name.endswith(".cpp")}
    within = [pathlib.Path(name).resolve() for name in options.folders]
    ours = {path for path in ours if not within or any(folder in path.parents for folder in within)}
    if not ours & {pathlib.Path(entry["file"]) for entry in commands}:
        sys.exit(f"tidy.py: {file} names no such file of the project; run make lint, not scripts/lint.sh")
    if options.since:
        ours &= changed_sources(options.since)
    elif options.share:
        ours = share_of(ours, options.share)
    make_headers(options.build, commands, ours)
    sources, flags = compiled_sources(commands, ours)
    content = True
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        splits = {folder: pool.submit(pieces, folder, of, flags[folder], pathlib.Path(scratch))
                  for folder, of in sources.items()}
        runs = [pool.submit(tidy, piece, flags[folder]) for folder, split in splits.items()
                for piece in split.result()]
        for run in runs:
            text, clean = run.result()
            content &= clean
            if text:
                print(text)
    count = sum(len(of) for of in sources.values())
    print(f"{count} files in {len(runs)} pieces: {'clean' if content else 'NOT clean'}")
    return 0 if content else 1


if __name__ == "__main__":
    sys.exit(main())
