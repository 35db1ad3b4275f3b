"""Settings of Sphinx for the site that scripts/docs.sh makes of README.md and docs/."""
import pathlib
import re
import sys

import furo

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

project = "raypool"
html_title = "raypool"
language = "en"
extensions = ["myst_parser", "plain_pages"]
root_doc = "index"
source_suffix = {".md": "markdown"}
# Two hyphens and straight quotes stay what they are.
smartquotes = False
highlight_language = "none"

html_theme = "furo"
# Debian's Furo is dark where you choose so, but not where the browser prefers it: the same colours for both.
dark = re.search(r'body\[data-theme="dark"\] \{(.*?)\}', (furo.THEME_PATH / "static/styles/furo.css").read_text(), re.S)
html_theme_options = {"dark_css_variables": dict(re.findall(r"--([\w-]+): ([^;]+);", dark[1]))}
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
# An index of terms would be empty. Without its text below each result, the search works from disk.
html_use_index = False
html_show_search_summary = False
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_sphinx = False
# GitHub takes a heading of any level.
suppress_warnings = ["myst.header"]
