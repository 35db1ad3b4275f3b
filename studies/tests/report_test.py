#!/usr/bin/env python3
"""The page: studies/tests/report_test.py RAYPOOL [TEST]...

It is one well-formed file that asks no network, has every section that there is data for, and says of every figure in
words what it shows and which command makes it; its figures are those of the reports; what is broken is named and left
out."""
import csv
import html.parser
import http.server
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import chromium

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RAYPOOL = ""
sys.path[:0] = [str(ROOT / "studies"), str(ROOT / "scripts")]
SECTIONS = ("changes", "published", "speed", "alus", "cycles", "ceilings", "units", "policies", "fields", "area",
            "power", "synthesis", "pictures", "work", "points", "machines")  # fmt: skip
OF_EVERY_RUN = ["points", "machines"]
VOID = {"meta", "link", "br", "img", "input", "hr", "path", "use", "rect"}
TINY = {"scene": "cornell", "detail": 0.01, "size": "16x16", "depth": 2, "engine": "model"}
EXPERIMENTS = {
    "shapes": {"title": "shapes & <units>", "base": TINY,
               "product": {"warps": [1, 2], "lanes": [1, 4], "units": [1, 2], "chip.policy": ["thesis", "fill"]}},
    "question": {"base": {**TINY, "size": "64x64"}, "points": [
        {}, {"alus.flt.count": 2, "data_cache.bytes": 4096, "arithmetic.slow_unit": "newton1"},
        {"engine": "native", "hits": "embree"}]},
    "depth": {"base": TINY, "product": {"depth": [1, 3]}},
}  # fmt: skip


def make_sweeps(folder):
    for name, document in EXPERIMENTS.items():
        path = folder / f"{name}.json"
        path.write_text(json.dumps(document))
        command = [sys.executable, "-m", "sweep", str(path), "--out", str(folder / "sweeps" / name)]
        done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def environment():
    return {**os.environ, "PYTHONPATH": f"{ROOT}/studies:{ROOT}/scripts", "RAYPOOL": RAYPOOL}


class Reader(html.parser.HTMLParser):
    """Ids, links and texts of a page with elements that are closed in their order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.errors, self.sections = [], [], [], {}
        self.feed(text)
        self.close()
        self.errors += [f"<{name}> is never closed" for name in self.open]

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "section":
            self.sections[dict(attributes)["id"]] = self.getpos()

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        if not self.open or self.open.pop() != tag:
            self.errors.append(f"</{tag}> closes another element in line {self.getpos()[0]}")

    def ids(self):
        return [attributes["id"] for _, attributes in self.elements if "id" in attributes]


class ReportTest(unittest.TestCase):
    """`sweeps` of all tests are made once."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.made = pathlib.Path(cls.temporary.name)
        make_sweeps(cls.made)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        shutil.copytree(self.made / "sweeps", self.folder / "sweeps")

    def run_report(self, *folders, code=0, out="page"):
        command = [sys.executable, "-m", "report", "--out", str(self.folder / out)]
        command += ["--from", *map(str, folders)] if folders else []
        done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertNotIn("Warning", done.stderr)
        return done

    def page(self, *folders):
        """Of these folders; without any of all sweeps as they were made, which all tests share."""
        if folders:
            self.run_report(*folders)
            return (self.folder / "page/index.html").read_text()
        if not (self.made / "page").exists():
            self.run_report(self.made / "sweeps", out=self.made / "page")
        return (self.made / "page/index.html").read_text()

    def reports(self, sweep):
        """(path, report) of its points, in the order of its table."""
        folder = self.folder / "sweeps" / sweep
        rows = json.loads((folder / "table.json").read_text())["rows"]
        paths = [folder / "points" / row["key"] / "report.json" for row in rows]
        return [(path, json.loads(path.read_text())) for path in paths]

    def change(self, sweep, action):
        """action(report, number) for each report of the sweep, which is written again."""
        for number, (path, report) in enumerate(self.reports(sweep)):
            action(report, number)
            path.write_text(json.dumps(report))

    def absent(self, page):
        """(title, what would fill it) of each section that is left out."""
        return re.findall(r"<dt>([^<]+)</dt><dd>([^<]+)</dd>", page)

    def section(self, page, name):
        begin = page.index(f'<section id="{name}">')
        return page[begin : page.index("</section>", begin)]

    def traced(self):
        """The folder of a run with a trace."""
        folder = self.folder / "runs" / "traced"
        done = subprocess.run(
            [RAYPOOL, "sim", "--scene=cornell", "--detail=0.01", "--size=8x8", "--depth=2", "--engine=model",
             "--units=2", "--config=best_2w2c", "--trace=:", "--quiet", f"--out={folder}"],
            capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder

    def synthesis(self, name, machine, mm2, power=None):
        """What make synth leaves, of a unit of the machine's parameters."""
        words = [RAYPOOL, "config", *machine, "--verilog-parameters"]
        lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
        document = {"schema": "raypool-synth-2", "config": name, "parameters": dict(line.split("=") for line in lines),
                    "area": {"total_kge": 1000 * mm2}, "forty_nm": {"total_mm2": mm2},
                    "timing": {"clock_ns": 4, "allowed_ns": 3.2},
                    "library": {"name": "osu018"}, "power": {"total_w": power} if power else None}  # fmt: skip
        place = self.folder / "synth" / name
        place.mkdir(parents=True)
        (place / "report.json").write_text(json.dumps(document))


class Page(ReportTest):
    """What holds for the whole file."""

    def test_it_is_well_formed_and_complete(self):
        page = self.page()
        reader = Reader(page)
        self.assertFalse(reader.errors)
        self.assertEqual(len(reader.ids()), len(set(reader.ids())))
        self.assertEqual([name for name in SECTIONS if name not in reader.sections],
                         ["published", "area", "power", "synthesis", "work"])  # fmt: skip
        ids = set(reader.ids())
        for tag, attributes in reader.elements:
            self.assertNotIn(tag, ("iframe", "object", "embed"))
            for name in ("href", "src", "aria-labelledby", "for"):
                for word in attributes.get(name, "").split():
                    if name in ("href", "src"):
                        self.assertRegex(word, r"^(#|data:)")
                    if not word.startswith("data:"):
                        self.assertIn(word.lstrip("#"), ids)
        for address in re.findall(r"(?:https?:|[\"'(])//[a-z][^\s\"<]*", page):
            self.assertEqual(address, "http://www.w3.org/2000/svg")
        self.assertNotRegex(page, r"@import|url\((?!#)")
        self.assertIn("shapes &amp; &lt;units&gt;", page)
        self.assertLess(len(page), 3_000_000)

    def test_every_plot_has_words_and_every_figure_its_command(self):
        page = self.page()
        plots = re.findall(r'<svg [^>]*class="plot".*?</svg>', page, re.S)
        self.assertGreater(len(plots), 8)
        for plot in plots:
            self.assertIn('role="img"', plot)
            title, words = re.search(r"<title id=[^>]*>([^<]+)</title><desc id=[^>]*>([^<]+)</desc>", plot).groups()
            self.assertTrue(title)
            self.assertRegex(words, r"\d")
            self.assertNotRegex(plot, r"#[0-9a-fA-F]{6}\b", "a colour that dark has no other value of")
            self.assertNotRegex(plot, r'(?:width|height)="[\d.]+pt"')
        figures = re.findall(r'<figure id="figure-\d+">.*?</figure>', page, re.S)
        self.assertGreater(len(figures), 6)
        for figure in figures:
            self.assertRegex(figure, r'<p class="finding">[^<]*\d')
            self.assertRegex(figure, r"<code>make sweep EXPERIMENT=\S+\.json</code>")
            self.assertRegex(figure, r"raypool \d+\.\d+\.\d+")
            self.assertRegex(figure, r'href="#machine-\d+"')
            self.assertRegex(figure, r"<code>build/raypool sim [^<]*--config=")

    def test_the_same_folders_give_the_same_bytes(self):
        one = self.page()
        self.run_report(self.made / "sweeps", out="two")
        self.assertEqual((self.folder / "two/index.html").read_text(), one)
        self.assertEqual(os.listdir(self.folder / "two"), ["index.html"])

    def test_a_command_of_a_point_draws_the_same(self):
        page = self.page()
        commands = re.findall(r"<code>build/(raypool sim [^<]*newton1[^<]*)</code>", page)
        words = commands[0].split()
        self.assertNotIn("--out", words)
        out = self.folder / "again"
        subprocess.run([RAYPOOL, *words[1:], "--quiet", "--out", str(out)], cwd=ROOT, check=True)
        _, report = self.reports("question")[1]
        again = json.loads((out / "report.json").read_text())
        for field in ("cycles", "configuration", "view", "size"):
            self.assertEqual(again[field], report[field])

    def test_the_table_has_what_the_reports_say(self):
        page = self.page()
        rows = re.findall(r'<tr id="point-\d+">(.*?)</tr>', page)
        heads = re.findall(r'data-head="([^"]+)"', page)
        reports = [report for name in sorted(EXPERIMENTS) for _, report in self.reports(name)]
        self.assertEqual(len(rows), len(reports))
        for row, report in zip(rows, reports):
            values = re.findall(r'<td(?: data-v="([^"]*)")?>', row)
            found = dict(zip(heads, values))
            for head, field in (("cycles", "cycles"), ("Mrays/s", "mrays_per_second"), ("rays", "rays")):
                self.assertEqual(found[head], "" if report[field] is None else repr(report[field]))

    def sections(self, page):
        """Those of the page, which its contents list too, and no others are linked."""
        found = re.findall(r'<section id="([a-z]+)">', page)
        contents = re.search(r"<nav .*?</nav>", page, re.S)[0]
        self.assertEqual(re.findall(r'href="#([a-z]+)"', contents), found)
        self.assertEqual(len(found) + len(self.absent(page)), len(SECTIONS))
        self.assertEqual(Reader(page).errors, [])
        return found

    def run_of(self, engine):
        out = self.folder / "run"
        words = ["sim", "cornell", "--size", "8x8", "--config", "1w1c", "--engine", engine, "--quiet"]
        subprocess.run([RAYPOOL, *words, "--out", str(out)], check=True)
        return out

    def test_a_single_run_has_only_sections_of_a_run(self):
        page = self.page(self.run_of("model"))
        self.assertEqual(self.sections(page), ["alus", "cycles", "ceilings", "pictures", *OF_EVERY_RUN])
        self.assertIn('<p class="lead">1 single run.', page)

    def test_a_sweep_has_only_sections_of_a_sweep(self):
        page = self.page(self.folder / "sweeps/question")
        self.assertEqual(self.sections(page), ["changes", "alus", "cycles", "ceilings", "pictures", *OF_EVERY_RUN])
        self.assertIn('<p class="lead">3 points of 1 sweep.', page)

    def test_a_synthesis_report_has_only_its_table(self):
        self.synthesis("2w4c", ["2w4c"], 0.7, power=0.1)
        page = self.page(self.folder / "synth")
        self.assertEqual(self.sections(page), ["synthesis"])
        row = re.search(r'<tr><th scope="row">2w4c.*?</tr>', self.section(page, "synthesis"))[0]
        self.assertEqual(re.findall(r"<td>([^<]*)</td>", row), ["osu018", "700", "0.70", "312", "0.10"])
        self.assertIn('<p class="lead">1 synthesis report.', page)

    def test_what_is_absent_names_a_command(self):
        page = self.page(self.run_of("functional"))
        self.assertEqual(self.sections(page), ["pictures", *OF_EVERY_RUN])
        makefiles = (ROOT / "Makefile").read_text() + (ROOT / "studies/studies.mk").read_text()
        targets = set(re.findall(r"^([a-z-]+):", makefiles, re.M))
        for title, words in self.absent(page):
            named = re.findall(r"make ([a-z-]+)", words)
            self.assertTrue(named, title)
            self.assertLessEqual(set(named), targets)
            for path in re.findall(r"configs/[\w/]+\.json", words):
                self.assertTrue((ROOT / path).exists(), path)
        self.assertIn("--engine native --hits embree", self.section(page, "pictures"))


class Refusals(ReportTest):
    """One sentence each."""

    def refuses(self, *folders, words=()):
        done = self.run_report(*folders, code=1)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        for word in words:
            self.assertIn(word, lines[0])
        self.assertFalse((self.folder / "page").exists())

    def test_folders(self):
        self.refuses(self.folder / "none", words=["none", "does not exist"])
        self.refuses(self.folder / "sweeps/question/table.json", words=["is not a folder"])
        (self.folder / "empty").mkdir()
        self.refuses(self.folder / "empty", words=["empty", "no sweep, run or synthesis report", "make sim"])

    def test_nothing_but_broken_reports(self):
        place = self.folder / "broken/run"
        place.mkdir(parents=True)
        (place / "report.json").write_text('{"raypool": "0.')
        self.refuses(self.folder / "broken", words=["run/report.json", "not valid JSON"])

    def test_broken_ones_are_named_and_left_out(self):
        (first, _), (second, report), *_ = self.reports("shapes")
        first.write_text(first.read_text()[:200])
        report["cycles"] = "many"
        second.write_text(json.dumps(report))
        third = self.reports("question")[0][0].parent
        (third / "point.json").write_text("{}")
        (self.folder / "sweeps/depth/table.json").unlink()
        picture = self.reports("question")[2][0].parent / "image.png"
        picture.write_bytes(picture.read_bytes()[:100])
        runs = self.folder / "sweeps/odd"
        runs.mkdir()
        (runs / "report.json").write_text('{"schema": "raypool-synth-1"}')
        done = self.run_report(self.folder / "sweeps")
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 6, done.stderr)
        for word in ("not valid JSON", "cycles: 'many'", "point.json", "has points and no table.json",
                     "another version of make synth", "no whole PNG"):
            self.assertEqual(sum(word in line for line in lines), 1, word)
        page = (self.folder / "page/index.html").read_text()
        self.assertEqual(page.count("Left out: "), 6)
        self.assertEqual(page.count('<tr id="point-'), 16 - 2 + 3 - 1)

    def test_a_page_that_cannot_be_written_leaves_the_old_one(self):
        (self.folder / "page").write_text("mine")
        done = self.run_report(self.folder / "sweeps/depth", code=1)
        self.assertIn("cannot be written", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertEqual((self.folder / "page").read_text(), "mine")


class Figures(ReportTest):
    """What single figures show."""

    def test_published_tables(self):
        with open(ROOT / "configs/experiments/published.csv", encoding="utf-8") as file:
            published = list(csv.DictReader(line for line in file if not line.startswith("#")))

        def become(report, number):
            whole = subprocess.run([RAYPOOL, "config", "8w8c" if number else "32w1c", "--set=chip.traverser=static",
                                    "--json"], capture_output=True, text=True, check=True).stdout  # fmt: skip
            report["configuration"] = json.loads(whole)
            report["scene"]["name"], report["size"] = "conference", {"width": 512, "height": 512}
            report.update(depth=1, units=1, mrays_per_second_thesis=[10.0, 99.0, 60.0][min(number, 2)])
            if number == 1:
                report["configuration"]["chip"]["policy"] = "fill"

        self.change("shapes", become)
        text = self.section(self.page(self.folder / "sweeps/shapes"), "published")
        row = next(row for row in published if (row["warps"], row["cores"]) == ("32", "1"))
        self.assertIn("Table 5.4", text)
        self.assertIn(f"<td>10.0</td><td>{float(row['mrays_per_s']):.1f}</td>"
                      f"<td>{10 / float(row['mrays_per_s']):.2f}</td>", text)
        self.assertIn(f"<td>60.0</td><td>41.0</td><td>{60 / 40.95:.2f}</td>", text)
        self.assertIn("1 of 2 machines are at least as fast as published", text)
        self.assertIn("32w1c is behind: 10.0 against 13.8 Mrays/s", text)
        self.assertIn(f"Of {len(published)} published machines 2 have been run", text)
        self.assertNotIn("<td>99.0</td>", text)

    def test_cycles_are_all_there(self):
        page = self.page()
        bars = []
        for words in re.findall(r"<desc[^>]*>Percent of the cycles of all warps\. ([^<]+)\.</desc>", page):
            bars += words.split("; ")
        issued = []
        for bar in bars:
            shares = [float(share) for share in re.findall(r" (\d+\.\d)(?:,|$)", bar)]
            self.assertAlmostEqual(sum(shares), 100, delta=1, msg=bar)
            issued.append(re.search(r"issued (\d+\.\d)", bar)[1])
        reports = [report for name in EXPERIMENTS for _, report in self.reports(name) if report["cycles"]]
        known = {f"{100 * cycles['issued'] / cycles['all']:.1f}" for cycles in (r["warp_cycles"] for r in reports)}
        self.assertEqual(set(issued), known)

    def test_ceilings_are_those_of_the_reports(self):
        section = self.section(self.page(), "ceilings")
        for _, report in self.reports("shapes"):
            lowest, reached = report["ceilings"]["lowest"], report["mrays_per_second"] / report["ceilings"]["reached"]
            self.assertRegex(section, rf": [\d.]+ of {self.shown(reached)} Mrays/s that {lowest} allows")

    def shown(self, value):
        from report.figure import number

        return re.escape(number(value))

    def test_area_and_power_come_from_synthesis(self):
        self.synthesis("1w1c", ["1w1c"], 0.2, power=0.1)
        self.synthesis("2w4c", ["2w4c"], 0.7)
        done = self.run_report(self.folder / "sweeps", self.folder / "synth")
        self.assertIn("2 synthesis reports", done.stdout)
        page = (self.folder / "page/index.html").read_text()
        tables, clocks = {}, 0
        heads = re.findall(r'data-head="([^"]+)"', page)
        for row in re.findall(r'<tr id="point-\d+">(.*?)</tr>', page):
            cells = re.findall(r'<td(?: data-v="([^"]*)")?>(?:<a[^>]*>)?([^<]*)', row)
            found = {head: raw or shown for head, (raw, shown) in zip(heads, cells)}
            if "–" not in (found["Mrays/s"], found["Mrays/s osu018"]):
                self.assertAlmostEqual(float(found["Mrays/s osu018"]), 0.3125 * float(found["Mrays/s"]))
                clocks += 1
            tables.setdefault((found["warps"], found["lanes"], found["units"]), set()).add((found["mm2"], found["W"]))
        self.assertGreater(clocks, 1)
        self.assertEqual(tables["1", "1", "2"], {("0.4", "0.2")})
        self.assertEqual(tables["2", "4", "1"], {("0.7", "–")})
        self.assertEqual(tables["1", "4", "1"], {("–", "–")})
        self.assertIn("Pareto front", self.section(page, "area"))
        self.assertIn("Mrays/s at 250 MHz", self.section(page, "power"))

    def test_the_pareto_front_is_what_nothing_beats(self):
        from report.area import front

        places = [((7 * place) % 23 / 3, (11 * place) % 19) for place in range(60)]
        best = [place for place, (x, y) in enumerate(places)
                if not any((a <= x and b >= y) and (a, b) != (x, y) for a, b in places)]
        self.assertEqual({places[place] for place in front(places)}, {places[place] for place in best})

    def test_pictures_are_compared_with_embree(self):
        import matplotlib.image

        text = self.section(self.page(), "pictures")
        text = text.split("<h3>cornell, 64 x 64, depth 2")[1].split("<h3>")[0]
        pictures = [matplotlib.image.imread(path.parent / "image.png") for path, _ in self.reports("question")]
        differ = (pictures[1] != pictures[2]).any(axis=2).sum()
        self.assertGreater(differ, 0)
        self.assertIn(f"{differ} pixel", text)
        self.assertTrue((pictures[0] == pictures[2]).all())
        self.assertEqual(text.count("<img "), 2)
        self.assertIn("Embree's own</b>, and ours, the same in every pixel", text)

    def test_a_trace_is_drawn(self):
        folder = self.traced()
        section = self.section(self.page(folder.parent), "work")
        data = json.loads(re.search(r'<script type="application/json" id="trace-1">(.*?)</script>', section)[1])
        events = json.loads((folder / "trace.json").read_text())["traceEvents"]
        instructions = [event for event in events if "instruction" in event.get("args", {})]
        warps = [track for track in data["tracks"] if not track["port"]]
        self.assertEqual([track["name"] for track in warps],
                         [f"unit {unit} warp {warp}" for unit in range(2) for warp in range(2)])
        self.assertGreater(len(instructions), 100)
        self.assertEqual(sum(len(track["spans"]) for track in warps), len(instructions))
        self.assertIn(f", {len(instructions):,} instructions.</figcaption>", section)
        first = next(event for event in instructions if event["pid"] == 1 and event["tid"] == 0)
        issued, granted, retired, alu, text, wanted, threads = warps[0]["spans"][0]
        self.assertEqual([issued, granted, retired - issued, wanted, threads],
                         [first["ts"], first["args"]["granted"], first["dur"], first["args"]["wanted"],
                          first["args"]["threads"]])  # fmt: skip
        self.assertEqual(data["texts"][text], f"{first['args']['pc']}: {first['args']['instruction']}")
        self.assertEqual(data["alus"][alu], first["name"])
        self.assertEqual({data["texts"][kernel[2]] for track in warps for kernel in track["kernels"]},
                         {"cast_eye", "cast_secondary", "cast_secondary_direct"} & set(data["texts"]))
        # A broken one is named, and the run stays.
        (folder / "trace.json").write_text('{"traceEvents": []}')
        page = self.page(folder.parent)
        self.assertIn("traced/trace.json is not a trace", page)
        self.assertIn("TRACE=1 leaves one", dict(self.absent(page))["The machine at work"])

    def test_the_question_has_its_answer(self):
        self.synthesis("8w8c", ["8w8c"], 0.6)
        self.synthesis("other", ["8w8c", "--set=alus.flt.count=2", "--set=data_cache.bytes=4096",
                                 "--set=arithmetic.slow_unit=newton1"], 0.3)
        text = self.section(self.page(self.folder / "sweeps/question", self.folder / "synth"), "changes")
        before, after = (report["mrays_per_second"] for _, report in self.reports("question")[:2])
        self.assertIn(f"{100 * (after / before - 1):+.1f}% Mrays/s, -50.0% area", text)
        self.assertRegex(text, r"picture: \d+ pixels? differ")


MEASURE = """<script>
const said = [];
window.addEventListener("error", (event) => said.push("error: " + event.message));
document.addEventListener("securitypolicyviolation", (event) => said.push("asks for " + event.blockedURI));
window.addEventListener("load", () => {
  document.querySelectorAll("details").forEach((each) => { each.open = true; });
  const width = document.documentElement.clientWidth;
  const wide = [];
  for (const element of document.querySelectorAll("body *")) {
    const box = element.getBoundingClientRect();
    const inside = element.closest(".scroll") && !element.classList.contains("scroll");
    if (!inside && box.width > 0 && (box.right > width + 1 || box.left < -1))
      wide.push(element.tagName + "." + element.getAttribute("class") + " " + box.left + ".." + box.right + ": "
        + element.textContent.slice(0, 40));
  }
  const words = [];
  for (const plot of document.querySelectorAll("svg.plot")) {
    const boxes = Array.from(plot.querySelectorAll("text"), (text) => [text, text.getBoundingClientRect()]);
    boxes.forEach(([a, p], place) => boxes.slice(place + 1).forEach(([b, q]) => {
      const across = Math.min(p.right, q.right) - Math.max(p.left, q.left);
      const down = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
      if (across > 1 && down > 0.35 * Math.min(p.height, q.height))
        words.push(a.textContent + " meets " + b.textContent);
    }));
  }
  const filter = document.getElementById("filter");
  const rows = () => Array.from(document.querySelectorAll("#all tbody tr")).filter((row) => !row.hidden);
  const all = rows().length;
  filter.value = "units=2 lanes>2 thesis";
  filter.dispatchEvent(new Event("input"));
  const kept = rows().length;
  filter.value = "";
  filter.dispatchEvent(new Event("input"));
  const heads = Array.from(document.querySelectorAll("#all th"), (head) => head.dataset.head);
  document.querySelectorAll("#all th button")[heads.indexOf("cycles")].click();
  const cycles = rows().map((row) => row.cells[heads.indexOf("cycles")].dataset.v);
  const pre = document.createElement("pre");
  pre.id = "measured";
  pre.textContent = JSON.stringify({ inner: innerWidth, scroll: document.documentElement.scrollWidth, wide, words, said,
    all, kept, cycles, small: Array.from(document.querySelectorAll("svg.plot text"), (text) =>
      text.getBoundingClientRect().height).filter((height) => height < 8).length });
  document.body.append(pre);
});
</script>"""


class Silent(http.server.BaseHTTPRequestHandler):
    """Answers everything with nothing."""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, format, *arguments):
        pass


class NetLog(unittest.TestCase):
    """What of a net log counts."""

    def asked(self, *requests):
        events = [{"type": 2, "phase": 1, "params": {"url": url, **rest}} for url, rest in requests]
        events += [{"type": 2, "phase": 2}, {"type": 5, "params": {"url": "http://resolved.example/"}}]
        types = {"URL_REQUEST_START_JOB": 2, "HOST_RESOLVER_MANAGER_REQUEST": 5}
        return chromium.asked_by_page(json.dumps({"constants": {"logEventTypes": types}, "events": events}))

    def test_requests_of_the_page_count_and_those_of_the_browser_do_not(self):
        own = "not an origin"
        self.assertEqual(
            self.asked(
                ("https://update.example/service", {"initiator": own}),
                ("https://accounts.example/list", {"initiator": "https://accounts.example"}),
                ("https://dictionary.example/en.bdic", {}),
                ("http://tracker.example/pixel.png", {"initiator": "file://"}),
                ("https://frame.example/", {"initiator": "null"}),
                ("file:///tmp/index.html", {"initiator": own}),
                ("data:image/png,", {"initiator": "file://"}),
            ),
            {"http://tracker.example/pixel.png", "https://frame.example/"},
        )

    def test_another_form_of_log_is_refused(self):
        for log in ("{", "[]", '{"events": []}', '{"constants": {"logEventTypes": {}}, "events": []}'):
            with self.subTest(log=log), self.assertRaises(ValueError):
                chromium.asked_by_page(log)


class Browser(ReportTest):
    """In headless Chromium."""

    def setUp(self):
        super().setUp()
        if chromium.program() is None:
            self.skipTest("no headless Chromium is here (scripts/setup.sh report-test installs it)")

    def dump(self, page, width):
        """The document after its scripts have run, what the console said, and the addresses that it asked for."""
        log = self.folder / "net.json"
        command = chromium.command(self.folder / "profile", "--hide-scrollbars", f"--window-size={width},900",
                                   f"--log-net-log={log}", "--enable-logging=stderr", "--virtual-time-budget=10000",
                                   page.as_uri())  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
        return done.stdout, console, chromium.asked_by_page(log.read_text())

    def test_what_a_page_asks_for_is_seen(self):
        """And nothing of what the browser asks for itself."""
        with http.server.HTTPServer(("127.0.0.1", 0), Silent) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            place = f"http://127.0.0.1:{server.server_port}"
            page = self.folder / "asks.html"
            page.write_text(f'<img src="{place}/picture.png"><script>fetch("{place}/data").catch(() => 0)</script>')
            _, _, urls = self.dump(page, 360)
            server.shutdown()
        self.assertEqual(urls, {f"{place}/picture.png", f"{place}/data"})

    def test_it_fits_and_asks_no_network(self):
        text = self.page()
        path = self.folder / "index.html"
        path.write_text(text.replace("<style>", MEASURE + "<style>", 1))
        for width in (360, 1440):
            with self.subTest(width=width):
                document, console, urls = self.dump(path, width)
                self.assertEqual(console, [])
                self.assertEqual(urls, set())
                found = json.loads(html.unescape(re.search(r'<pre id="measured">(.*?)</pre>', document)[1]))
                self.assertEqual(found["inner"], width)
                self.assertLessEqual(found["scroll"], width)
                for name in ("wide", "words", "said"):
                    self.assertEqual(found[name], [], name)
                self.assertEqual(found["small"], 0)
                self.assertEqual((found["all"], found["kept"]), (21, 2))
                known = [float(value) for value in found["cycles"] if value is not None]
                self.assertEqual(known, sorted(known, reverse=True))
                self.assertEqual(found["cycles"][len(known) :], [None] * (21 - len(known)))

    def test_a_trace_moves(self):
        path = self.folder / "traced.html"
        # A browser that shows nothing need not make a frame before it dumps: the test makes each at once.
        press = """<script>window.addEventListener("load", () => {
          window.requestAnimationFrame = (paint) => paint();
          document.querySelector('[data-do="in"]').click();
          const canvas = document.querySelector(".drawing canvas");
          canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: canvas.getBoundingClientRect().left + 400,
            clientY: canvas.getBoundingClientRect().top + 30, bubbles: true }));
          const shown = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
          document.body.dataset.colours = new Set(new Uint32Array(shown.buffer)).size;
        });</script>"""
        path.write_text(self.page(self.traced().parent).replace("</body>", press + "</body>", 1))
        for width in (360, 1440):
            with self.subTest(width=width):
                document, console, urls = self.dump(path, width)
                self.assertEqual(console, [])
                self.assertEqual(urls, set())
                self.assertRegex(document, r"<output>150 cycles from [0-9,]+</output>")
                self.assertRegex(document, r'<p class="under" aria-live="polite">unit 0 warp 0, cycle [0-9,]+: ')
                self.assertGreater(int(re.search(r'data-colours="(\d+)"', document)[1]), 5)


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
