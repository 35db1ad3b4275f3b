#!/usr/bin/env python3
"""A trace in chrome://tracing, which this project did not write: scripts/tests/open_trace_test.py RAYPOOL [TEST]...

It shows every span of the file, and notices each of the ways in which a trace can be broken."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import open_trace  # noqa: E402

RAYPOOL = ""


def span(document):
    """An instruction in the midst of a warp's track: what is broken below."""
    spans = [event for event in document["traceEvents"] if "instruction" in event.get("args", {})]
    return spans[len(spans) // 2]


BROKEN = {
    "an unknown kind of event": (lambda document: span(document).update(ph="Q"), "Unrecognized event phase: Q"),
    "an end without a begin": (lambda document: span(document).update(ph="E"), "E phase event without a matching B"),
    "no name": (lambda document: span(document).pop("name"), "TypeError"),
    "no length": (lambda document: span(document).pop("dur"), "lacks what it needs: 'dur'"),
    "a negative length": (lambda document: span(document).update(dur=-3), "takes -0.003 ms"),
    "a start in words": (lambda document: span(document).update(ts="soon"), "starts at None ms"),
    "a span over its neighbour": (
        lambda document: span(document).update(dur=span(document)["dur"] + 2),
        "where the one before it lasts until"),
    "a track without a name": (
        lambda document: document["traceEvents"].pop(1),
        "is called [None, None] in the file"),
}  # fmt: skip


class OpenTrace(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if open_trace.missing():
            raise unittest.SkipTest(open_trace.missing())
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([RAYPOOL, "sim", "cornell", "--detail=0.01", "--size=8x8", "--depth=2", "--engine=model",
                            "--units=2", "--config=best_2w2c", "--trace=:", "--quiet", f"--out={folder}"],
                           check=True)  # fmt: skip
            cls.text = (pathlib.Path(folder) / "trace.json").read_text()

    def test_the_viewer_shows_what_the_file_has(self):
        what, faults = open_trace.check(self.text, open_trace.shown([self.text])[0])
        self.assertEqual(faults, [])
        spans = self.text.count('"ph":"X"')
        self.assertGreater(spans, 1000)
        self.assertEqual(what, f"{spans} spans on 11 tracks of 3 processes")

    def test_a_broken_trace_is_noticed(self):
        texts = []
        for spoil, _ in BROKEN.values():
            document = json.loads(self.text)
            spoil(document)
            texts.append(json.dumps(document))
        texts.append(self.text[: len(self.text) // 2])
        wanted = {**{name: said for name, (_, said) in BROKEN.items()}, "half a file": "SyntaxError"}
        for (name, said), text, found in zip(wanted.items(), texts, open_trace.shown(texts)):
            with self.subTest(name):
                _, faults = open_trace.check(text, found)
                self.assertTrue(any(said in fault for fault in faults), faults[:5])


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
