#!/usr/bin/env python3
"""Checks that what README and docs point to is there: scripts/page_paths.py; exit code 1 if something is not.

That is: the files and headings of links, and each path of the project between backquotes, in which a star stands for
any letters. Fences and quoted output are left to the checks that run them.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md"] + sorted((ROOT / "docs").glob("*.md"))
FOLDERS = [path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "build"))]
PATH = re.compile(rf"^(?:{'|'.join(FOLDERS)})/[\w./*+-]*$")
MADE = {"docs/add-an-alu.md": ("box",)}   # files that the page itself makes


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


def path_error(name, word):
    if any(made in word for made in MADE.get(name, ())):
        return None
    return None if any(ROOT.glob(word.rstrip("/"))) else f"names {word}, which is not there"


def main():
    errors, looked = [], 0
    for page in PAGES:
        name, text = str(page.relative_to(ROOT)), without_code(page.read_text())
        words = [word for code in re.findall(r"`([^`\n]+)`", text) for word in code.split() if PATH.match(word)]
        found = [link_error(page, target) for target in re.findall(r"\]\(([^)\s]+)\)", text)]
        found += [path_error(name, word) for word in words]
        looked += len(found)
        errors += [f"{name} {error}" for error in found if error]
    for error in sorted(set(errors)):
        print(error, file=sys.stderr)
    if not errors:
        print(f"page_paths.py: {looked} links and names in {len(PAGES)} pages, all there")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
