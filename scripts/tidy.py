#!/usr/bin/env python3
"""clang-tidy on the C++ sources that the build compiles: scripts/tidy.py BUILD [FOLDER...]; exit code 1 if it finds
anything. FOLDER: only what lies in it.

Nearly all of its time goes to the headers of libraries, which most sources share. So sources of a folder are read in
one piece, behind each other, as far as their names allow; what clashes goes to another piece. A finding's line is
that of its source again. BUILD has the compile_commands.json.
"""
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


def compiled_sources(commands, within):
    """[folder] = the sources in these folders that the build compiles, and [folder] = what the compiler is told
    there."""
    listed = subprocess.run([ROOT / "scripts/sources.sh", "cpp"], cwd=ROOT, check=True, capture_output=True, text=True)
    ours = {ROOT / name for name in listed.stdout.split() if name.endswith(".cpp")}
    ours = {path for path in ours if not within or any(folder in path.parents for folder in within)}
    sources, flags = collections.defaultdict(dict), collections.defaultdict(dict)
    for entry in json.loads(commands.read_text()):
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
    """What clang-tidy says of a piece, and whether it is content."""
    run = subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", piece.file, "--", *flags],
                         capture_output=True, text=True)
    text = "\n".join(line for line in (run.stdout + run.stderr).splitlines() if not NOISE.match(line))
    return piece.translated(text), run.returncode == 0


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: scripts/tidy.py BUILD [FOLDER...]")
    commands = pathlib.Path(sys.argv[1], "compile_commands.json")
    sources, flags = {}, {}
    if commands.is_file():
        sources, flags = compiled_sources(commands, [pathlib.Path(name).resolve() for name in sys.argv[2:]])
    if not sources:
        sys.exit(f"tidy.py: {commands} names no such file of the project; run make lint, not scripts/lint.sh")
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
