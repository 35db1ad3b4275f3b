#!/usr/bin/env python3
"""The site that scripts/docs.sh makes of the pages works from disk: scripts/tests/site_test.py

Every link and anchor leads somewhere, every page is in the navigation and in the search index, pictures are there, and
no page loads anything from a network. A page that no index names, or a dead link, fails the build.
"""
import html.parser
import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import pages  # noqa: E402

MISSING = [name for name in ("sphinx", "myst_parser", "furo") if importlib.util.find_spec(name) is None]
LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "object": "data", "embed": "src"}
LOADING = {"stylesheet", "icon", "shortcut icon", "preload", "modulepreload", "manifest"}


class Page(html.parser.HTMLParser):
    """Of a page of the site: its ids, what it links to, what it loads, and its pictures."""

    def __init__(self, path):
        super().__init__()
        self.path, self.ids, self.links, self.loads, self.pictures = path, set(), [], [], 0
        self.text = path.read_text()
        self.feed(self.text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.ids.add(values.get("id"))
        if "href" in values and tag in ("a", "link"):
            self.links.append(values["href"])
            if LOADING & {values.get("rel")}:
                self.loads.append(values["href"])
        if tag in LOADED and values.get(LOADED[tag]):
            self.loads.append(values[LOADED[tag]])
        self.pictures += tag == "img"

    def file_of(self, address):
        """The file that an address within the site is."""
        return (self.path.parent / urllib.parse.unquote(re.split("[?#]", address)[0])).resolve()


def place(page):
    """Where the site has a page of the project."""
    if page == ROOT / "docs/README.md":
        return "docs.html"
    name = str(page.relative_to(ROOT)).removeprefix("docs/") if page.parent != ROOT else page.name.lower()
    return re.sub("(?i)readme.md$", "index.md", name).replace(".md", ".html")


def build(root, folder):
    script = root / "scripts/docs.sh"
    return subprocess.run([script, folder], capture_output=True, text=True, check=False)


def is_elsewhere(address):
    return re.match(r"(https?:)?//|data:|mailto:", address)


@unittest.skipIf(MISSING, f"{', '.join(MISSING)} is not installed (scripts/setup.sh docs)")
class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name).resolve() / "site"
        cls.done = build(ROOT, cls.folder)
        cls.pages = {str(path.relative_to(cls.folder)): Page(path) for path in sorted(cls.folder.rglob("*.html"))}
        cls.wanted = {place(page): page for page in pages.PAGES}

    def test_it_is_made_without_a_warning(self):
        self.assertEqual((self.done.returncode, self.done.stderr), (0, ""))
        self.assertEqual(self.done.stdout, f"docs: open {self.folder}/index.html\n")

    def test_it_has_every_page(self):
        self.assertGreater(len(self.wanted), 20)
        self.assertEqual(set(self.wanted) - set(self.pages), set())

    def test_every_link_and_anchor_leads_somewhere(self):
        dead, looked = [], 0
        known = {page.path: page for page in self.pages.values()}
        for name, page in self.pages.items():
            for address in filter(lambda link: not is_elsewhere(link), page.links):
                file, anchor = page.file_of(address) if address[0] != "#" else page.path, address.partition("#")[2]
                looked += 1
                if not file.is_file() or (anchor and file in known and anchor not in known[file].ids):
                    dead.append(f"{name}: {address}")
        self.assertGreater(looked, 1000)
        self.assertEqual(dead, [])

    def test_headings_have_the_anchors_of_the_sources(self):
        for name, source in self.wanted.items():
            headings = re.findall(r"^#+ (.*)$", pages.without_code(source.read_text()), re.M)
            self.assertEqual({pages.anchor(heading) for heading in headings} - self.pages[name].ids, set(), name)

    def test_every_page_is_reachable_from_the_first(self):
        seen, waiting = set(), ["index.html"]
        while waiting:
            name = waiting.pop()
            if name not in seen and name in self.pages:
                seen.add(name)
                page = self.pages[name]
                here = filter(lambda link: not is_elsewhere(link), page.links)
                files = {page.file_of(link) for link in here}
                waiting += [str(file.relative_to(self.folder)) for file in files if self.folder in file.parents]
        self.assertEqual(set(self.pages) - seen, set())

    def test_the_books_stand_beside_every_page(self):
        folders = {path.name.capitalize() for path in (ROOT / "docs").iterdir() if list(path.glob("*.md"))}
        folders.add("Project")
        for name, page in self.pages.items():
            captions = re.findall(r'<span class="caption-text">(.*?)</span>', page.text)
            self.assertEqual((set(captions), len(captions)), (folders, len(folders)), name)

    def test_the_search_index_has_every_page(self):
        index = (self.folder / "searchindex.js").read_text()
        names = json.loads(re.search(r'"?docnames"?:\s*(\[.*?\])', index)[1])
        self.assertEqual(sorted(f"{name}.html" for name in names), sorted(self.wanted))

    def test_pictures_are_there(self):
        for name, source in self.wanted.items():
            wanted = len(re.findall(r"!\[", pages.without_code(source.read_text())))
            self.assertEqual(self.pages[name].pictures, wanted, name)

    def test_nothing_is_loaded_from_a_network(self):
        for name, page in self.pages.items():
            self.assertGreater(len(page.loads), 5, name)
            self.assertEqual([address for address in page.loads if is_elsewhere(address)], [], name)
            missing = [address for address in page.loads if not page.file_of(address).is_file()]
            self.assertEqual(missing, [], name)
        for sheet in self.folder.rglob("*.css"):
            loads = re.findall(r"(?:@import |url\()(?!['\"]?data:)['\"]?([^'\")]*)", sheet.read_text())
            self.assertEqual([load for load in loads if not (sheet.parent / load).is_file()], [], sheet.name)

    def test_scripts_run_from_disk(self):
        scripts = {page.file_of(load) for page in self.pages.values() for load in page.loads if ".js" in load}
        self.assertGreater(len(scripts), 3)
        for script in scripts:
            self.assertNotRegex(script.read_text(), r"(?m)^\s*(import|export) ", f"{script.name} is a module")

    def test_it_is_dark_where_the_browser_prefers_it(self):
        preferred = re.search(r"prefers-color-scheme: dark\).*?\}", self.pages["index.html"].text, re.S)[0]
        self.assertIn("--color-background-primary: #", preferred)

    def test_quotes_are_consoles_and_comments_do_not_show(self):
        looked = 0
        for name, source in self.wanted.items():
            self.assertNotRegex(self.pages[name].text, "<!-- (quote|file|run|expect|insert|replace)", name)
            quoted = re.findall(r"^    \$ (.*)$", source.read_text(), re.M)
            commands = re.findall(r'<span class="gp">\$ </span><span class="gs">(.*)</span>', self.pages[name].text)
            commands = {html.unescape(command) for command in commands}
            self.assertEqual({line.rstrip() for line in quoted} - commands, set(), name)
            looked += len(quoted)
        self.assertGreater(looked, 50)


@unittest.skipIf(MISSING, f"{', '.join(MISSING)} is not installed (scripts/setup.sh docs)")
class Refusals(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp()).resolve()
        self.addCleanup(shutil.rmtree, self.folder)

    def test_a_page_that_no_index_names_and_dead_links_are_errors(self):
        copy = self.folder / "copy"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns("build*", ".git", "__pycache__", "scenes"))
        links = "[a](nowhere.md), [b](#no-heading), [c](../../Makefile)"
        (copy / "docs/use/unnamed.md").write_text(f"# Unnamed\n\n{links}\n")
        done = build(copy, self.folder / "site")
        self.assertEqual(done.returncode, 1)
        for warning in (
            ": WARNING: no index names this page",
            ":3: WARNING: links to nowhere.md, which is not there",
            ":3: WARNING: links to #no-heading, but there is no such heading",
        ):
            self.assertIn(f"docs/use/unnamed.md{warning}", done.stderr)
        self.assertEqual(done.stderr.count("WARNING"), 3, done.stderr)
        self.assertIn('href="use/unnamed.html"', (self.folder / "site/index.html").read_text())
        self.assertIn("MAKEFLAGS", (self.folder / "site/files/Makefile.html").read_text())

    def test_a_folder_that_is_no_site_stays(self):
        (self.folder / "mine").write_text("")
        done = build(ROOT, self.folder)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("it is not a site: name another folder", done.stderr)
        self.assertTrue((self.folder / "mine").exists())


if __name__ == "__main__":
    if MISSING:
        print(f"site_test.py: {', '.join(MISSING)} is not installed (scripts/setup.sh docs)")
    unittest.main()
