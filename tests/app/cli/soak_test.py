"""scripts/soak in its short form, and that its checks notice what they are for. Times are not judged here: the clock of the live run is not.

Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "soak"
LOADER = importlib.machinery.SourceFileLoader("soak", str(SCRIPT))
SOAK = importlib.util.module_from_spec(importlib.util.spec_from_loader("soak", LOADER))
LOADER.exec_module(SOAK)


class Short(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def soak(self, part, share):
        done = subprocess.run([sys.executable, SCRIPT, self.folder, "--share", str(share), "--only", part], capture_output=True, text=True, env=os.environ)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        figures = json.loads((self.folder / "soak.json").read_text())
        self.assertEqual(done.returncode, 3 if figures["failed"] else 0)
        self.assertIn(part, (self.folder / "soak.md").read_text())
        return figures

    def test_lockstep_replays_to_the_same_and_its_memory_is_flat(self):
        figures = self.soak("lockstep", 0.04)
        self.assertEqual(figures["failed"], [])
        self.assertEqual(figures["lockstep"]["ticks"], 400_000)

    def test_pieces_give_the_same_by_both_kinds_of_checkpoint(self):
        figures = self.soak("pieces", 0.03)
        self.assertEqual(figures["failed"], [])
        self.assertEqual(len(figures["pieces"]["hashes"]), SOAK.PIECES)

    def test_a_live_run_replays_to_the_same(self):
        figures = self.soak("live", 0.002)
        judged = [line for line in figures["failed"] if not line.startswith(("live: rows are missing", "live: memory is not flat"))]
        self.assertEqual(judged, [])

    def test_the_clock_is_measured(self):
        figures = self.soak("clock", 0.01)
        self.assertLessEqual(set(figures["failed"]), {"clock: it drifts"})
        self.assertGreater(figures["clock"]["clock"]["simulated_s"], 2.0)


class Checks(unittest.TestCase):
    def test_memory_that_grows_after_the_start_is_noticed(self):
        grows = [(t, 100e6 * (1 + 0.03 * t / 100)) for t in range(101)]
        self.assertGreater(SOAK.flatness(grows)["variation"], SOAK.FLAT)
        warms_up = [(t, 100e6 * min(1, 0.5 + t / 30)) for t in range(101)]
        self.assertLessEqual(SOAK.flatness(warms_up)["variation"], SOAK.FLAT)

    def test_a_clock_that_falls_behind_is_measured_and_missed_ticks_are_known(self):
        rows = [(10.0 + 1.001 * n, 1000 * n) for n in range(1, 3600)]
        clock = SOAK.drift(rows, 60, 1000)
        self.assertAlmostEqual(clock["behind_s"], 3.598, 6)
        self.assertEqual(clock["missed_s"], 0.06)

    def test_inputs_are_ten_times_as_many_as_a_person_gives_and_all_kinds(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "i.toml"
            SOAK.write_inputs(path, 60.0, SOAK.CYCLE)
            text = path.read_text()
        self.assertEqual(text.count("time_s"), 297)
        for kind in ("spin", "switches", "tool", "undo", "reset", "checkpoint", "restore", "pause", "mark"):
            self.assertIn(f'"{kind}"', text)

    def test_a_replay_that_differs_is_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            soak = SOAK.Soak(pathlib.Path(folder), 1.0)
            soak.replay("none")
            self.assertEqual(len(soak.failed), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
