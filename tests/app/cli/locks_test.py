"""The folders of studies, comparisons and films belong to one process, as that of a run does: a second one is refused and changes nothing.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import contextlib
import fcntl
import os
import signal
import subprocess
import time

from program_support import main, PROGRAM, QUICK, run, WithFolder, without_display

PATIENCE = 120  # [s]
LOCK = ".burrhole-run"
STUDY = ("stability", "--case", "rest", "--threads", "1")
SHORT = ("--offscreen", "--quiet", "--set", "duration_s=0.3", "--set", "display.size=[64, 48]")


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != LOCK}


@contextlib.contextmanager
def held(folder):
    """Another process has the folder: this one, by the same lock."""
    folder.mkdir(exist_ok=True)
    with open(folder / LOCK, "w", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        file.write(f"process {os.getpid()} since 2026-01-01 00:00:00 UTC\n")
        file.flush()
        yield
    (folder / LOCK).unlink(missing_ok=True)


class Locks(WithFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def assert_refused(self, done, option="--out"):
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, rf"the output folder is in use by process {os.getpid()} since 2026.*: give another one by {option}")
        self.assertEqual(done.stdout, "")

    def refuse_and_go_on(self, *command, option="--out", also=()):
        """The command is refused while the folder is held, then writes into it."""
        with held(self.out):
            (self.out / "cost.csv").write_text("of the other")
            before = contents(self.out)
            self.assert_refused(run(*command, option, self.out, *also), option)
            self.assertEqual(contents(self.out), before)
        done = run(*command, option, self.out, *also)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        self.assertGreater(len(contents(self.out)), 1)
        self.assertFalse((self.out / LOCK).exists())

    def test_a_stability_study(self):
        self.refuse_and_go_on(*STUDY)

    def test_the_map_of_stability(self):
        with held(self.out):
            self.assert_refused(run("stability", "--map", "--out", self.out))

    def test_each_study_of_cost(self):
        for study in ("contact", "surface", "drilling", "mesh", "multirate", "render"):
            with self.subTest(study), held(self.out):
                before = contents(self.out)
                self.assert_refused(run("cost", study, "--fresh", "--out", self.out))
                self.assertEqual(contents(self.out), before)

    def test_a_comparison(self):
        for name, push in (("a", 10), ("b", 20)):
            self.assertEqual(run("drill", QUICK, *SHORT, "--set", f"hand.push_N={push}", "--out", self.folder / name).returncode, 0)
        self.refuse_and_go_on("compare", self.folder / "a", self.folder / "b")

    def test_the_frames_of_a_film(self):
        film = self.folder / "out"
        self.refuse_and_go_on("drill", QUICK, *SHORT, "--out", self.folder / "results", option="--video", also=("--video-fps", 10))
        self.assertTrue((film / "frame_000000.png").exists())
        # In the folder of its own run a film needs no other lock.
        both = self.folder / "both"
        done = run("drill", QUICK, *SHORT, "--out", both, "--video", both, "--video-fps", 10)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((both / "frame_000000.png").exists() and (both / "summary.json").exists())

    def test_a_second_study_is_refused_while_the_first_runs_and_the_first_is_whole(self):
        first = subprocess.Popen([PROGRAM, *STUDY, "--out", str(self.out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=without_display())
        self.addCleanup(first.kill)
        end = time.monotonic() + PATIENCE
        while not ((self.out / LOCK).exists() and (self.out / LOCK).read_text()):
            self.assertLess(time.monotonic(), end)
            self.assertIsNone(first.poll())
            time.sleep(0.001)
        first.send_signal(signal.SIGSTOP)  # however fast it is, it cannot end before the second
        second = run(*STUDY, "--out", self.out)
        first.send_signal(signal.SIGCONT)
        _, errors = first.communicate(timeout=PATIENCE)
        self.assertEqual(second.returncode, 2, second.stderr)
        self.assertIn(f"in use by process {first.pid} since", second.stderr)
        self.assertEqual(first.returncode, 0, errors)
        self.assertEqual(sorted(contents(self.out)), ["stability.csv", "stability.html", "stability.md"])


if __name__ == "__main__":
    main()
