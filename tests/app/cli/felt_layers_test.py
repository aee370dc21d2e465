"""Layers are felt: the stiffness at the grip in the tables against that in diploe, on a phantom and on a CT, as scripts/felt_layers measures it.

Run by ctest with the program's path in BURRHOLE_PROGRAM. The CT is that of $BURRHOLE_DATA, where it is there.
"""
import importlib.machinery
import importlib.util
import os
import pathlib
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "felt_layers"
LOADER = importlib.machinery.SourceFileLoader("felt_layers", str(SCRIPT))
felt_layers = importlib.util.module_from_spec(importlib.util.spec_from_loader("felt_layers", LOADER))
LOADER.exec_module(felt_layers)
DATA = pathlib.Path(os.environ.get("BURRHOLE_DATA", "/nowhere"))
BAR = 1.15  # tables against diploe


def ratios(scene, *settings):
    """@returns outer table to diploe and inner table to diploe, of medians in the middle thirds, and the summary."""
    _, layers, summary = felt_layers.measured(scene, settings)
    outer, diploe, inner = (layers[name][2] for name in felt_layers.LAYERS)
    return outer / diploe, inner / diploe, summary


class Felt(unittest.TestCase):
    def judge(self, scene, *settings):
        outer, inner, summary = ratios(scene, *settings)
        self.assertGreater(outer, BAR)
        self.assertGreater(inner, BAR)
        self.assertIsNotNone(summary["drilling"]["breakthrough_s"])
        self.assertLess(summary["drilling"]["plunge_mm"], 0.5)  # a hand that took diploe for the exit, or the reverse, would plunge

    def test_the_tables_of_the_phantom_are_felt(self):
        self.judge("parietal", "contact.felt_hardness=0.6")

    def test_without_the_key_they_are_not(self):
        outer, inner, _ = ratios("parietal")
        # The thrust is held back by 20e6 N/m times the hardness in series with 5000 N/m: 0.3 % at a hardness of 0.1; the damper of 10 N s/m adds
        # 0.002 N at the feed of 0.2 mm/s.
        self.assertAlmostEqual(outer, 1.0, delta=0.01)
        self.assertAlmostEqual(inner, 1.0, delta=0.01)

    @unittest.skipUnless((DATA / "head_ct_raw_big_endian").is_dir(), "$BURRHOLE_DATA holds no cadaver's head")
    def test_the_tables_of_the_shipped_scene_on_a_cadaver_are_felt(self):
        self.judge("cadaver_head")

    @unittest.skipUnless((DATA / "head_ct_raw_big_endian").is_dir(), "$BURRHOLE_DATA holds no cadaver's head")
    def test_they_are_not_without_the_key_or_by_the_density_of_the_scan_alone(self):
        for setting in ("contact.felt_hardness=0", "contact.label_stiffness.diploe=1"):
            with self.subTest(setting):
                outer, inner, _ = ratios("cadaver_head", setting)
                self.assertFalse(outer > BAR and inner > BAR, (outer, inner))


if __name__ == "__main__":
    unittest.main(verbosity=2)
