#!/usr/bin/env python3
"""Checks that what the pages name is there: README, docs and what else is for people in the root; exit code 1 if
something is not: scripts/pages.py

That is: the files and headings of links; and between backquotes paths of the project, in which a star stands for any
letters, members of C++ classes (Class::member), targets of make, and what looks like an identifier: with an underscore,
or with a capital behind a small letter. Fences and quoted output are left to the checks that run them. The README's
figures, in bold at the head of a list's item, must stand in the page that the item links to.
"""
import pathlib
import re
import sys

import module_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").rglob("*.md"))
FOLDERS = (
    "bench",
    "cmake",
    "configs",
    "constraints",
    "cpp_model",
    "docs",
    "examples",
    "program",
    "rtl",
    "schemas",
    "scripts",
    "shaders",
    "sim",
    "studies",
    "tb",
)
PATH = re.compile(rf"^(?:{'|'.join(FOLDERS)})/[\w./*+-]*$")
MEMBER = re.compile(r"^([A-Z]\w+)::(\w+)$")
IDENTIFIER = re.compile(r"^\w*(?:[a-z0-9]_[a-z0-9]|[A-Z]_[A-Z]|[a-z][A-Z])\w*$")
HISTORY = ("CHANGELOG.md",)  # names what is gone, too: only its links are looked at
MADE = {  # what the page itself makes
    "docs/develop/add-an-alu.md": ("box", "Box", "BOX", "near_of_b"),
    "docs/start/first-change.md": ("CACHE_LRU",),
    "docs/use/shaders.md": ("gl_",),  # built-in names of GLSL
}


def without_code(text):
    """The page without fences and quoted output, which other checks read."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    return "\n".join(line for line in text.splitlines() if not line.startswith("    "))


def anchor(heading):
    """As GitHub and GitLab make it of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def link_error(page, target):
    if re.match(r"[a-z]+:", target):
        return None
    file, _, part = target.partition("#")
    path = (page.parent / file).resolve() if file else page
    if not path.exists():
        return f"links to {target}, which is not there"
    if part and part not in {anchor(heading) for heading in re.findall(r"^#+ (.*)$", path.read_text(), re.M)}:
        return f"links to {target}, but there is no such heading"
    return None


def figure_errors(readme):
    """Which of the README's figures the page beside them does not have; and how many figures it has."""
    errors, looked = [], 0
    for item in re.findall(r"^- \*\*(.*?)\*\*(.*?)(?=^-|^#|\Z)", readme, re.M | re.S):
        page = re.search(r"\]\((docs/[\w/-]+\.md)", item[1])
        text = (ROOT / page.group(1)).read_text() if page else ""
        known = set(re.findall(r"\d+(?:\.\d+)?", text))
        for figure in re.findall(r"\d[\d,]*(?:\.\d+)?", item[0]):
            looked += 1
            if figure.replace(",", "") not in known:
                errors.append(f"README.md has {figure}, which {page.group(1) if page else 'no page'} does not have")
    return errors, looked


def has_identifiers(path):
    """Not a page, a picture or this check."""
    return path.is_file() and path.suffix not in (".md", ".svg", ".png", ".pyc") and path.name != "pages.py"


class Project:
    """What there is of each kind."""

    def __init__(self):
        folders = ("cpp_model", "sim", "studies", "program", "tb")
        files = [path for folder in folders for path in (ROOT / folder).rglob("*.[ch]pp")]
        self.sources = [re.sub(r"//.*", "", path.read_text()) for path in files]
        cmake = "".join(path.read_text() for path in [ROOT / "CMakeLists.txt"] + list(ROOT.glob("*/CMakeLists.txt")))
        self.words = {name + "_test" for name in re.findall(r"raypool_library\((\w+)", cmake)}
        everything = [path for name in FOLDERS for path in (ROOT / name).rglob("*")]
        for path in filter(has_identifiers, everything + [ROOT / "CMakeLists.txt", ROOT / "Makefile"]):
            own = {path.stem, path.stem.removeprefix(module_table.PREFIX)}
            self.words |= own | set(re.findall(r"\w+", path.read_text(errors="replace")))
        makefiles = (ROOT / "Makefile").read_text() + (ROOT / "studies/studies.mk").read_text()
        self.targets = set(re.findall(r"^([a-z-]+):", makefiles, re.M))

    def has_member(self, owner, member):
        inside = re.compile(rf"\b(?:class|struct|enum class) {owner}\b[^;]*\{{")
        named = re.compile(rf"\b{member}\b")
        whole = f"{owner}::{member}"
        return any(named.search(text) and (whole in text or inside.search(text)) for text in self.sources)

    def lacks(self, word):
        """Whether a word names something that is not there; None if it names nothing of these kinds."""
        if PATH.match(word):
            return not any(ROOT.glob(word.rstrip("/")))
        if MEMBER.match(word):
            return not self.has_member(*MEMBER.match(word).groups())
        return word not in self.words if IDENTIFIER.match(word) else None


def words_of(text):
    """Words between backquotes, and with `make` in front the targets."""
    for code in re.findall(r"`([^`\n]+)`", text):
        words = code.split()
        yield from words
        if words[0] == "make" and len(words) > 1 and re.match(r"^[a-z-]+$", words[1]):
            yield "make " + words[1]


def errors_of(page, project):
    """What is wrong in a page; and how many links and names it has."""
    name, text = str(page.relative_to(ROOT)), without_code(page.read_text())
    targets = re.findall(r"\]\(([^)\s]+)\)", text)
    errors, looked = [link_error(page, target) for target in targets], len(targets)
    for word in () if name in HISTORY else words_of(text):
        if any(made in word for made in MADE.get(name, ())):
            continue
        lacks = word[5:] not in project.targets if word.startswith("make ") else project.lacks(word)
        looked += lacks is not None
        errors.append(f"names {word}, which is not there" if lacks else None)
    return [f"{name} {error}" for error in errors if error], looked


def main():
    project = Project()
    found = [errors_of(page, project) for page in PAGES]
    found.append(figure_errors((ROOT / "README.md").read_text()))
    if found[-1][1] == 0:
        found[-1][0].append("README.md has no figures, or none at the head of a list's item")
    errors = sorted({error for page_errors, _ in found for error in page_errors})
    for error in errors:
        print(error, file=sys.stderr)
    if not errors:
        looked = sum(number for _, number in found)
        print(f"pages.py: {looked} links, names and figures in {len(PAGES)} pages, all there")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
