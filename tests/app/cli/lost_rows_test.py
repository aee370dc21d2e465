"""A live run whose log could not keep up lost rows of its session: the run says so, and its session is not replayed as if it were whole.

A write of the session takes longer than the log can hold rows for: strace delays it, of the thread that writes alone. Run by ctest with the
program's path in BURRHOLE_PROGRAM.
"""
import contextlib
import json
import os
import pathlib
import signal
import sqlite3
import subprocess
import sys
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from faults import missing_tool  # noqa: E402
from program_support import lines, PROGRAM, QUICK, run, WithFolder, without_display  # noqa: E402

DELAYED = 150  # number of the write that takes long: those that create a session are fewer, those of ten seconds more
SLOW = 8       # [s] in which a servo of 8000 Hz makes far more rows than the log holds, even if it misses most of its ticks
LOSES = ("--live", "--offscreen", "--no-pictures", "--quiet", "--set", "servo_hz=8000", "--set", "tool.erosion_scale=0.001", "--set", "duration_s=10")
WARNING = "rows of the session were not recorded"


class LostRows(WithFolder):
    def setUp(self):
        super().setUp()
        if why := missing_tool():
            self.skipTest(why)
        self.out = self.folder / "out"

    def start(self):
        inject = f"inject=pwrite64:delay_enter={SLOW}s:when={DELAYED}"
        command = ["strace", "-e", "trace=pwrite64", "-e", inject, "-o", self.folder / "calls.txt", PROGRAM, "drill", QUICK, *LOSES, "--out", self.out]
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=without_display(),
                                   start_new_session=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        return process

    def events(self):
        with contextlib.closing(sqlite3.connect(f"file:{self.out / 'session.sqlite'}?mode=ro", uri=True)) as session:
            return [kind for kind, in session.execute("SELECT kind FROM events")]

    def assert_not_replayed(self):
        for more in ((), ("--allow-partial",)):
            done = run("replay", self.out, "--quiet", *more)
            self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
            self.assertEqual(len(lines(done.stdout + done.stderr)), 1, done.stdout + done.stderr)
            self.assertIn("rows of the recorded run were lost", done.stderr)

    def test_the_run_says_it_everywhere_and_its_session_is_not_replayed(self):
        process = self.start()
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(errors.count(WARNING), 1, errors)
        summary = json.loads((self.out / "summary.json").read_text())
        lost = summary["live"]["rows_not_recorded"]
        self.assertGreater(lost, 0, "the delayed write was not late enough")
        self.assertEqual(sum(line.startswith(f"live: {lost} {WARNING}") for line in summary["warnings"]), 1, summary["warnings"])
        self.assertIn(WARNING, (self.out / "report.html").read_text())
        self.assertEqual(self.events().count("unrecorded"), 1)
        self.assert_not_replayed()

    def test_a_run_that_is_killed_after_it_lost_rows_has_that_in_its_session(self):
        process = self.start()
        latest = time.monotonic() + 60
        seen = False
        while not seen and process.poll() is None and time.monotonic() < latest:
            time.sleep(0.2)
            with contextlib.suppress(sqlite3.Error):
                seen = "unrecorded" in self.events()
        self.assertTrue(seen, "no row was lost")
        for pid in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(pid), signal.SIGKILL)
        process.wait(60)
        self.assert_not_replayed()


if __name__ == "__main__":
    unittest.main(verbosity=2)
