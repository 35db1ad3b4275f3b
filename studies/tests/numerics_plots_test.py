#!/usr/bin/python3
"""studies/numerics_plots.py draws what numerics.json has, and leaves out what is known of fewer than two modes."""
import json
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "studies"), str(ROOT / "scripts")]
import numerics_plots  # noqa: E402

MODES = [f"{subnormals}-{unit}{fused}" for fused in ("", "-fma") for subnormals in ("ieee", "flush")
         for unit in numerics_plots.UNITS]  # fmt: skip
KGE, CYCLES = numerics_plots.COSTS


def found(quality, gates, cycles):
    """Of the modes that are named, {mode: value}; nothing is known of the others."""
    def cost(mode):
        flt, slw = gates.get(mode, (None, None))
        return {"mode": mode, "cycles_per_ray": cycles.get(mode), "flt_lane_kge": flt, "slw_lane_kge": slw}

    return {"configuration": "4w4c", "cost": [cost(mode) for mode in MODES],
            "quality": [{"scene": scene, "mode": mode, "psnr_same_paths_db": known.get(mode)}
                        for scene, known in (("near", quality), ("far", {MODES[0]: 9})) for mode in MODES]}  # fmt: skip


class Numerics(unittest.TestCase):
    def drawn(self, document):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "numerics.json").write_text(json.dumps(document))
            numerics_plots.main(folder)
            sizes = {path.name: path.stat().st_size for path in folder.glob("*.png")}
        self.assertTrue(all(size > 5000 for size in sizes.values()), sizes)
        return sorted(sizes)

    def test_what_is_not_known_is_left_out(self):
        nothing = found({}, {}, {})
        self.assertEqual(numerics_plots.panels_of(nothing), {})
        self.assertEqual(self.drawn(nothing), ["quality.png"])
        one = found({MODES[0]: 100}, {MODES[0]: (1, 2)}, {})
        self.assertEqual(numerics_plots.panels_of(one), {}, "one mode is no choice")

    def test_the_line_joins_what_no_other_mode_beats(self):
        some = found({MODES[0]: 100, MODES[1]: 90}, {MODES[0]: (1, 2), MODES[1]: (2, 3)}, {})
        self.assertEqual(numerics_plots.panels_of(some), {KGE: [(3, 100, MODES[0]), (5, 90, MODES[1])]})
        self.assertEqual(numerics_plots.front([(3, 100, "a"), (5, 90, "b")]), [(3, 100)])
        self.assertEqual(numerics_plots.front([(5, 100.04, "a"), (3, 100, "b"), (9, 101, "c")]), [(3, 100), (9, 101)])
        self.assertEqual(self.drawn(some), ["pareto.png", "quality.png"])

    def test_modes_at_one_place_are_all_drawn(self):
        alike = {mode: 100 for mode in MODES}
        panel = numerics_plots.panels_of(found(alike, {}, {mode: 30 for mode in MODES}))
        self.assertEqual(panel, {CYCLES: [(30, 100, mode) for mode in MODES]})
        marks = [numerics_plots.mark_of(mode) for mode in MODES]
        looks = {(mark["marker"], mark["color"], mark["markersize"], mark["markerfacecolor"]) for mark in marks}
        self.assertEqual(len(looks), len(MODES), "each differs from the others")


if __name__ == "__main__":
    unittest.main()
