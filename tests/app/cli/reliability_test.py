"""Faults of the machine, a seeded part of them; scripts/reliability runs them all. tests/support/faults.py says what must hold after each."""
import os
import pathlib
import random
import sys
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from faults import Bench, chosen, missing_tool  # noqa: E402
from fault_cases import cases  # noqa: E402
from program_support import PROGRAM, WithFolder, without_display  # noqa: E402

SEED = 20
CALLS, KILLS, RACES = 12, 12, 4  # of each case


class Reliability(WithFolder):
    def setUp(self):
        super().setUp()
        self.bench = Bench(PROGRAM, self.folder, without_display())

    def check(self):
        self.assertGreater(self.bench.trials, 0)
        self.assertEqual(self.bench.failures, [])

    @unittest.skipIf(missing_tool(), missing_tool() or "")
    def test_a_failed_system_call_is_reported_and_damages_no_file(self):
        for case in cases(self.folder):
            self.bench.begin(case)
            points = self.bench.points(case)
            self.assertTrue(any(kind in ("write", "pwrite64") for kind, _, _ in points), case.name)
            for point in chosen(points, CALLS, SEED):
                self.bench.fail_call(case, point)
        self.check()

    def test_a_killed_run_leaves_whole_files(self):
        draw = random.Random(SEED)
        for case in cases(self.folder):
            self.bench.begin(case)
            for _ in range(KILLS):
                self.bench.kill(case, draw.uniform(0.0, case.seconds))
        self.check()

    def test_two_at_once_leave_the_files_of_one(self):
        draw = random.Random(SEED)
        for case in cases(self.folder):
            self.bench.begin(case)
            for _ in range(RACES):
                self.bench.race(case, draw.uniform(0.0, case.seconds))
        self.check()

    def test_a_truncated_file_and_a_stale_summary_are_noticed(self):
        """The checks themselves."""
        case = next(c for c in cases(self.folder) if c.name == "drill")
        self.bench.begin(case)
        self.bench.reset()
        picture = self.bench.out / "after.png"
        picture.write_bytes(picture.read_bytes()[:-1])
        self.assertIn("after.png", self.bench._left(case))
        self.bench.reset()
        (self.bench.out / "after.png.123.tmp").write_bytes(b"")
        self.assertIn("leaves", self.bench._left(case))
        self.bench.reset()
        other = (self.bench.out / "session.sqlite").read_bytes()
        (self.bench.out / "session.sqlite").write_bytes(other[:100] + bytes(other[100:]).replace(b"\0\1", b"\0\1", 1))
        self.assertIsNone(self.bench._left(case))


if __name__ == "__main__":
    os.environ.setdefault("BURRHOLE_PROGRAM", str(PROGRAM))
    unittest.main(verbosity=2)
