"""The machine at work: what runs with a trace (make sim TRACE=1) did, reduced for the page's drawing."""
import json
import os

from plots.style import ALUS

from .point import near

# Instructions and transfers of a page, so that it stays one that opens.
MOST_BARS = 100_000


class Broken(Exception):
    """A trace that is left out; its text says why."""


class Trace:
    """`data` is what the drawing gets, as JSON text: trace.js describes how it is laid out."""

    def __init__(self, point, path):
        self.point = point
        try:
            with open(path, encoding="utf-8") as file:
                document = json.load(file)
            about = document["otherData"]
            self.first, self.last = about["from"], about["to"]
            self.units, self.warps = about["units"], about["warps"]
            tracks = self.tracks(document["traceEvents"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise Broken(f"{near(path)} is not a trace of make sim TRACE=1 ({error})") from error
        self.instructions = sum(len(track["spans"]) for track in tracks if not track["port"])
        self.bars = sum(len(track["spans"]) for track in tracks)
        self.data = json.dumps(
            {"from": self.first, "to": self.last, "alus": ALUS, "texts": self.texts, "tracks": tracks},
            separators=(",", ":")).replace("<", "\\u003c")

    def tracks(self, events):
        """Those of a unit's warps, then the ports'."""
        names, spans = {}, {}
        self.texts, places = [], {}

        def text(words):
            if words not in places:
                places[words] = len(self.texts)
                self.texts.append(words)
            return places[words]

        for event in events:
            key = (event["pid"], event.get("tid"))
            if event["ph"] == "M":
                names[key] = event["args"]["name"]
            elif event["ph"] == "X":
                spans.setdefault(key, []).append(event)
        found = []
        for key in sorted((key for key in names if key[1] is not None), key=lambda key: (key[0] == 0, key)):
            name = names[key] if key[0] == 0 or self.units == 1 else f"unit {key[0] - 1} {names[key]}"
            members = spans.get(key, [])
            made = self.port_spans(members, text) if key[0] == 0 else self.warp_spans(members, text)
            found.append({"name": name, "port": key[0] == 0, **made})
        return found

    @staticmethod
    def warp_spans(events, text):
        spans, kernels = [], []
        for event in events:
            begin, end, more = event["ts"], event["ts"] + event["dur"], event.get("args", {})
            if "instruction" in more:
                words = text(f"{more['pc']}: {more['instruction']}")
                spans.append([begin, more["granted"], end, ALUS.index(event["name"]), words, more["wanted"],
                              more["threads"]])
            elif event["name"] not in ("fetch", "executes"):
                kernels.append([begin, end, text(event["name"])])
        return {"spans": spans, "kernels": kernels}

    @staticmethod
    def port_spans(events, text):
        return {"spans": [[event["ts"], event["ts"] + event["dur"], int(event["name"] == "waits"),
                           text(event["args"]["what"]), event["args"]["unit"]] for event in events]}


def collect(points, notes):
    """Traces of these points' folders."""
    found, used = [], 0
    for point in points:
        path = os.path.join(point.folder, "trace.json")
        if not os.path.isfile(path):
            continue
        try:
            trace = Trace(point, path)
        except Broken as broken:
            notes.append(str(broken))
            continue
        if used + trace.bars > MOST_BARS:
            notes.append(f"{near(path)}, as the page has {MOST_BARS:,} instructions and transfers of traces: a shorter "
                         "window (TRACE=FROM:CYCLES) or make report FROM= with fewer folders shows it")
            continue
        used += trace.bars
        found.append(trace)
    return found
