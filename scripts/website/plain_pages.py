"""Sphinx extension: a site of pages that stay the plain Markdown which GitHub and GitLab show.

The pages are those of scripts/pages.py. The navigation follows the links in docs/README.md and in the READMEs of its
folders, each of which is a book; pages beside README.md come last. A link leads to a page, or to a view of a file or
folder of the project. Anchors are those that GitHub makes of headings.
"""
import html
import itertools
import pathlib
import re
import shutil

import pages
from docutils import nodes
from pygments.lexer import RegexLexer
from pygments.lexers import find_lexer_class_for_filename
from pygments.token import Comment, Generic, Keyword, Name, Number, Text
from sphinx import addnodes
from sphinx.project import Project
from sphinx.transforms import SphinxTransform
from sphinx.util import logging
from sphinx.util.osutil import relative_uri

LOG = logging.getLogger(__name__)
DOCS = pages.ROOT / "docs"
ALL_PAGES = DOCS / "README.md"


def name_of(page):
    """A page's name in the site: README.md is index, SECURITY.md security, docs/README.md docs, docs/use/README.md
    use/index, docs/use/fit.md use/fit."""
    if page == ALL_PAGES:
        return "docs"
    if page.parent == pages.ROOT:
        return "index" if page.name == "README.md" else page.stem.lower()
    name = page.relative_to(DOCS).with_suffix("")
    return str(name.with_name("index") if name.name == "README" else name)


PATHS = {name_of(page): page for page in pages.PAGES}
NAMES = {page: name for name, page in PATHS.items()}


class Pages(Project):
    """The pages of the project, in place of every file below a folder."""

    def discover(self, *_):
        self.docnames = set(PATHS)
        return self.docnames

    def path2doc(self, filename):
        return NAMES.get((pages.ROOT / filename).resolve())

    def doc2path(self, docname, basedir=True):
        path = PATHS.get(docname, DOCS / f"{docname}.md")
        return str(path if basedir else path.relative_to(pages.ROOT))


def linked(page):
    """Names of the pages that a page links to, in their order."""
    if not page.exists():
        return []
    targets = re.findall(r"\]\(([^)#\s]+)", pages.without_code(page.read_text()))
    return [NAMES[path] for path in ((page.parent / target).resolve() for target in targets) if path in NAMES]


def books():
    """The folders of docs in the order in which docs/README.md first links to them, and the pages of each."""
    folder_of = {name: path.parent.name for name, path in PATHS.items() if path.parent.parent == DOCS}
    everywhere = linked(ALL_PAGES)
    for folder in dict.fromkeys(folder_of[name] for name in [*everywhere, *sorted(folder_of)] if name in folder_of):
        indexed = [f"{folder}/index", *linked(DOCS / folder / "README.md"), *everywhere]
        inside = [name for name in dict.fromkeys([*indexed, *sorted(folder_of)]) if folder_of.get(name) == folder]
        for name in inside:
            if name not in indexed:
                LOG.warning("no index names this page: link to it in docs/README.md", location=name)
        yield folder, inside


def toctree(option, names):
    return "\n".join(["", "", "```{toctree}", ":hidden:", option, *(f"/{name}" for name in names), "```", ""])


def add_navigation(app, docname, source):
    """Appends the navigation to the first page; it stands beside every page."""
    if docname == app.config.root_doc:
        beside = [name for name, path in PATHS.items() if path.parent == pages.ROOT and name != docname]
        trees = [toctree(f":caption: {title.capitalize()}", names) for title, names in [*books(), ("project", beside)]]
        source[0] += toctree("", [NAMES[ALL_PAGES]]) + "".join(trees)


def text_of(path):
    """None where it is a picture or other data."""
    try:
        return None if path.suffix == ".svg" else path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def view_of(path):
    """Where the site has a file or folder of the project that is no page: shown in a page, or else as it is."""
    copy = f"files/{path.relative_to(pages.ROOT)}"
    return f"{copy}.html" if path.is_dir() or text_of(path) is not None else copy


class PlainMarkdown(SphinxTransform):
    """What GitHub makes of a page: its anchors and links, and no comments."""

    default_priority = 200

    def apply(self, **_):
        self.set_anchors()
        for node in list(self.document.findall(nodes.raw)):
            if node.astext().startswith("<!--"):
                node.parent.remove(node)
        for node in self.document.findall(nodes.literal_block):
            if node.astext().startswith("$ "):
                node["language"] = Quote.name
        for kind in (addnodes.pending_xref, addnodes.download_reference):
            for node in list(self.document.findall(kind)):
                self.resolve(node)

    def set_anchors(self):
        used = set()
        for section in self.document.findall(nodes.section):
            anchor = pages.anchor(section[0].astext())
            numbered = (f"{anchor}-{number}" for number in itertools.count(1))
            section["ids"] = [next(name for name in itertools.chain([anchor], numbered) if name not in used)]
            used.update(section["ids"])

    def resolve(self, node):
        page, target = PATHS[self.env.docname], node["reftarget"]
        if error := pages.link_error(page, target):
            LOG.warning(error, location=node)
            node.replace_self(node[0].children)
            return
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        name = NAMES.get(path / "README.md" if path.is_dir() else path)
        if name is None:
            self.env.metadata[self.env.docname].setdefault("views", []).append(path)
        uri = relative_uri(f"{self.env.docname}.html", f"{name}.html" if name else view_of(path))
        uri += f"#{anchor}" if anchor else ""
        node.replace_self(nodes.reference("", "", *node[0].children, refuri=uri, internal=True))


def views(app):
    """What pages link to that is no page: yields the pages that show it, and copies the rest."""
    paths = [path for metadata in app.env.metadata.values() for path in metadata.get("views", [])]
    for path in paths:
        paths += inside(path)
    for path in sorted(set(paths)):
        place = view_of(path)
        if place.endswith(".html"):
            title = html.escape(str(path.relative_to(pages.ROOT)))
            body = folder_view(path) if path.is_dir() else file_view(app, path)
            yield place.removesuffix(".html"), {"title": title, "body": f"<h1>{title}</h1>\n{body}"}, "page.html"
        else:
            copy = pathlib.Path(app.outdir) / place
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)


def inside(path):
    hidden = (".", "__pycache__")
    return sorted(child for child in path.iterdir() if not child.name.startswith(hidden)) if path.is_dir() else []


def folder_view(path):
    rows = [(relative_uri(view_of(path), view_of(child)), html.escape(child.name)) for child in inside(path)]
    return "<ul>" + "".join(f'<li><a href="{address}">{name}</a></li>' for address, name in rows) + "</ul>"


def file_view(app, path):
    lexer = find_lexer_class_for_filename(path.name)
    language = lexer.aliases[0] if lexer else "none"
    return app.builder.highlighter.highlight_block(text_of(path), language, force=True, linenos="inline")


class Quote(RegexLexer):
    """Commands, each behind a dollar sign, and what they print."""

    name = "quote"
    tokens = {"root": [(r"\$ ", Generic.Prompt, "command"), (r".*\n", Generic.Output)],
              "command": [(r".*\n", Generic.Strong, "#pop")]}  # fmt: skip


class Assembly(RegexLexer):
    """The compute unit's (docs/machine/isa.md)."""

    name = "assembly"
    tokens = {
        "root": [
            (r"#.*", Comment),
            (r"\.\w+|^\s*\w+:", Name.Label),
            (r"@?!?\b[rp]\d+\b|@!?p\d+", Name.Variable),
            (r"-?\b(0x[\da-f]+|\d+(\.\d*)?(e[-+]?\d+)?|inf)\b", Number),
            (r"\w+", Keyword),
            (r"[^\w#.@-]+|.", Text),
        ]
    }


def place_pages(app):
    app.project = app.env.project = Pages(app.srcdir, app.config.source_suffix)


def mend_theme(app, _):
    """Debian's Furo imports a style sheet from where a web server has it, and has a script that imports a module, which
    no browser does from disk."""
    static = pathlib.Path(app.outdir) / "_static"
    style, script = static / "styles/furo.css", static / "scripts/furo.js"
    served = re.compile(r"@import url\((/javascript/[^)]*)\);")
    style.write_text(served.sub(lambda match: pathlib.Path("/usr/share" + match[1]).read_text(), style.read_text()))
    script.write_text(re.sub(r"^import .*\n", "", script.read_text(), flags=re.M))


def setup(app):
    app.connect("builder-inited", place_pages)
    app.connect("build-finished", mend_theme)
    # The module, loaded as a script.
    app.add_js_file("scripts/gumshoe-patched.js", priority=190)
    app.connect("source-read", add_navigation)
    app.connect("html-collect-pages", views)
    app.add_transform(PlainMarkdown)
    app.add_lexer(Quote.name, Quote)
    app.add_lexer("asm", Assembly)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
