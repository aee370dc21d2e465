"""Faults of the machine, a seeded part of them; scripts/reliability runs them all. tests/support/faults.py says what must hold after each."""
import json
import pathlib
import random
import sys
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from faults import Bench, chosen, missing_tool, PERHAPS  # noqa: E402
from fault_cases import cases, SCENE  # noqa: E402
from program_support import main, PROGRAM, run, WithFolder, without_display  # noqa: E402

SEED = 20
CALLS, KILLS, RACES = 12, 6, 2  # of each case


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
        # Of live runs the number of a call in its thread differs from run to run.
        self.assertGreater(self.bench.trials, 2 * self.bench.not_reached)

    def test_a_killed_run_leaves_whole_files(self):
        draw = random.Random(SEED)
        for case in cases(self.folder):
            self.bench.begin(case)
            for _ in range(KILLS):
                self.bench.kill(case, draw.uniform(0.0, self.bench.seconds))
        self.check()

    def test_two_at_once_leave_the_files_of_one(self):
        draw = random.Random(SEED)
        for case in cases(self.folder):
            self.bench.begin(case)
            for _ in range(RACES):
                self.bench.race(case, draw.uniform(0.0, self.bench.seconds))
        self.check()

    def test_what_the_checks_notice(self):
        case = next(c for c in cases(self.folder) if c.name == "drill")
        self.bench.begin(case)
        for name in sorted(p.name for p in self.bench.old.iterdir()):
            self.bench.reset()
            damaged = self.bench.out / name
            damaged.write_bytes(damaged.read_bytes()[: damaged.stat().st_size // 2])
            self.assertIn(name, self.bench._left(case) or "", name)
        self.bench.reset()
        self.assertEqual(self.bench._not_written(), sorted(p.name for p in self.bench.old.iterdir()))
        (self.bench.out / "after.png.123.tmp").write_bytes(b"")
        self.assertIn("leaves", self.bench._left(case))
        self.bench.reset()
        # Of an earlier run that did not get as far as half the depth.
        for name in PERHAPS:
            (self.bench.old / name).unlink(missing_ok=True)
        self.bench.reset()
        during = self.bench.out / "during.png"
        during.write_bytes((self.bench.old / "before.png").read_bytes())
        self.assertIn("leaves during.png without", self.bench._left(case) or "", "older results are beside it")
        summary = self.bench.out / "summary.json"
        summary.write_text(json.dumps({**json.loads(summary.read_text()), "created": "later"}))
        (self.bench.out / "session.sqlite").unlink()
        self.assertIsNone(self.bench._left(case), "those of its run are beside it")
        during.write_bytes(during.read_bytes()[:100])
        self.assertIn("during.png is not whole", self.bench._left(case) or "")
        summary.unlink()
        during.write_bytes((self.bench.old / "before.png").read_bytes())
        self.assertIn("leaves during.png without", self.bench._left(case) or "", "no results are beside it")
        self.bench.reset()
        if not missing_tool():
            before = self.bench.trials
            self.bench.fail_call(case, ("write", 60000, "EIO"))
            self.assertEqual((self.bench.trials - before, self.bench.not_reached), (0, 1), "a call that was never made was not survived")
            self.bench.fail_call(case, ("write", 1, "EIO"))
            self.assertEqual((self.bench.trials - before, self.bench.not_reached), (1, 1))
            self.bench.reset()
        other = self.folder / "other"
        self.assertEqual(run("drill", SCENE, "--offscreen", "--quiet", "--set", "duration_s=0.3", "--out", other).returncode, 0)
        (self.bench.out / "session.sqlite").write_bytes((other / "session.sqlite").read_bytes())
        self.assertIn("another session", self.bench._left(case))

    def test_a_mixture_of_two_runs_is_noticed(self):
        for case in cases(self.folder):
            self.bench.begin(case)
            self.bench.learn_marks(case)  # out has the files of run 2
            self.assertIsNone(self.bench.mixture([1, 2]), case.name)
            self.assertIsNotNone(self.bench.mixture([1]), case.name)
            if len(self.bench.marks[0]) == 1:
                continue
            for name in sorted(p.name for p in self.bench.old.iterdir()):
                self.assertEqual(self.bench._run(case, who=2).returncode, 0)
                (self.bench.out / name).write_bytes((self.bench.old / name).read_bytes())
                self.assertIn(name, self.bench.mixture([1, 2]) or "", name)


if __name__ == "__main__":
    main()
