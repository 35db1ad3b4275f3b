#!/usr/bin/env python3
"""Opens a trace in chrome://tracing and says what it read: scripts/open_trace.py TRACE.json

This viewer (Catapult) is the program that the Trace Event format comes from; the sources of Go have it whole. It runs
in headless Chromium, from disk. Exit code 1 if it warns, if a span does not lie within the one that it is drawn in, or
lies over its neighbour, or if what it shows on any track is not what the file has."""
import collections
import html
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import chromium

VIEWER = pathlib.Path("/usr/share/go-1.19/src/cmd/trace/static")  # golang-1.19-src
PAGE = """<!DOCTYPE html>
<meta charset="utf-8">
<script src="webcomponents.min.js"></script>
<link rel="import" href="trace_viewer_full.html">
<script>
function read(text) {
  const model = new tr.Model();
  const options = new tr.importer.ImportOptions();
  options.shiftWorldToZero = options.pruneEmptyContainers = false;
  new tr.importer.Import(model, options).importTraces([text]);
  const tracks = model.getAllThreads().map((thread) => {
    const spans = thread.sliceGroup.slices;
    const numbers = new Map(spans.map((span, number) => [span, number]));
    return { process: thread.parent.pid, thread: thread.tid, names: [thread.parent.name, thread.name],
      spans: spans.map((span) => [span.title, span.start, span.duration, span.args]),
      within: spans.map((span) => numbers.get(span.parentSlice) ?? -1) };
  });
  return { warnings: model.importWarnings.map((warning) => warning.message), tracks };
}
document.addEventListener("HTMLImportsLoaded", () => {
  const found = document.createElement("pre");
  found.id = "found";
  found.textContent = JSON.stringify(TRACES.map((name) => {
    try {
      const file = new XMLHttpRequest();
      file.open("GET", name, false);
      file.send();
      return read(file.responseText);
    } catch (error) {
      return { warnings: [String(error)], tracks: [] };
    }
  }));
  document.body.appendChild(found);
});
</script>
"""


def missing():
    """What has to be installed first, in a sentence, or None."""
    if chromium.program() is None or not (VIEWER / "trace_viewer_full.html").exists():
        return "no trace viewer is here (scripts/setup.sh report-test installs it)"
    return None


def shown(texts):
    """What the viewer makes of each trace's text: its warnings, and its tracks with their spans."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in ("trace_viewer_full.html", "webcomponents.min.js"):
            (folder / file).symlink_to(VIEWER / file)
        traces = [f"{number}.json" for number in range(len(texts))]
        for trace, text in zip(traces, texts):
            (folder / trace).write_text(text)
        page = folder / "index.html"
        page.write_text(PAGE.replace("TRACES", json.dumps(traces)))
        command = chromium.command(folder / "profile", "--allow-file-access-from-files",
                                   "--virtual-time-budget=60000", page.as_uri())  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.DOTALL)
    if found is None:
        raise RuntimeError(f"the viewer said nothing:\n{done.stderr}")
    return json.loads(html.unescape(found[1]))


def written(text):
    """Names and spans of each track, as a trace's text has them."""
    tracks = collections.defaultdict(lambda: ([None, None], []))
    processes = {}
    for event in json.loads(text)["traceEvents"]:
        if event["ph"] == "M" and event["name"] == "process_name":
            processes[event["pid"]] = event["args"]["name"]
            continue
        names, spans = tracks[event["pid"], event["tid"]]
        if event["ph"] == "M":
            names[:] = [processes[event["pid"]], event["args"]["name"]]
        else:
            spans.append([event["name"], event["ts"], event["dur"], event.get("args", {})])
    return tracks


def in_cycles(milliseconds):
    """A microsecond of the file is a cycle; null where the viewer has no number."""
    return None if milliseconds is None else round(1000 * milliseconds)


def faults_of_track(place, track):
    """What is wrong with where a track's spans lie."""
    ends = collections.defaultdict(int)  # of the last span in each one, and at the top (-1)
    lasts = {}  # first cycle and end of each one
    for i, (title, start, duration, _) in enumerate(track["spans"]):
        if start is None or duration is None or start < 0 or duration <= 0:
            yield f"{place}: span '{title}' starts at {start} ms and takes {duration} ms"
            continue
        first, end, parent = in_cycles(start), in_cycles(start + duration), track["within"][i]
        if first < ends[parent]:
            yield f"{place}: span '{title}' starts in cycle {first}, where the one before it lasts until {ends[parent]}"
        around = lasts.get(parent, (first, end))
        if not around[0] <= first <= end <= around[1]:
            yield f"{place}: span '{title}' from {first} to {end} is not within '{track['spans'][parent][0]}'"
        lasts[i] = first, end
        ends[parent] = end


def check(text, found):
    """What the viewer shows of a trace's text, in words, and what is wrong with it."""
    faults = [f"the viewer warns: {warning}" for warning in found["warnings"]]
    tracks = found["tracks"]
    for track in tracks:
        faults += faults_of_track(" ".join(map(str, track["names"])), track)
    try:
        wanted = written(text)
    except (ValueError, KeyError) as error:
        wanted = {}
        faults.append(f"an event lacks what it needs: {error}")
    by_place = {(track["process"], track["thread"]): track for track in tracks}
    if wanted and set(wanted) != set(by_place):
        faults.append(f"the file has tracks {sorted(wanted)}, and the viewer shows {sorted(by_place)}")
    for place, (names, spans) in wanted.items():
        track = by_place.get(place, {"names": names, "spans": []})
        if track["names"] != names:
            faults.append(f"track {place} is called {names} in the file, and {track['names']} in the viewer")
        drawn = [[title, in_cycles(start), in_cycles(length), args] for title, start, length, args in track["spans"]]
        if sorted(map(json.dumps, spans)) != sorted(map(json.dumps, drawn)):
            faults.append(f"track {place} has {len(spans)} spans in the file; {len(drawn)} are shown, or others")
    count = sum(len(track["spans"]) for track in tracks)
    processes = len({track["process"] for track in tracks})
    return f"{count} spans on {len(tracks)} tracks of {processes} processes", faults


def main(paths):
    if len(paths) != 1:
        sys.exit("usage: scripts/open_trace.py TRACE.json")
    if missing():
        sys.exit(f"open_trace.py: {missing()}")
    try:
        text = pathlib.Path(paths[0]).read_text()
    except OSError as error:
        sys.exit(f"open_trace.py: {paths[0]} cannot be read: {error.strerror}")
    what, faults = check(text, shown([text])[0])
    for fault in faults[:10]:
        print(f"{paths[0]}: {fault}", file=sys.stderr)
    print(f"{paths[0]}: chrome://tracing shows {what}, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
