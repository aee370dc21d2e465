"""An output folder belongs to one run: a second run is refused, results of an earlier run never lie beside those of a new one, and a run
that does not start leaves the folder as it was.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import contextlib
import csv
import io
import json
import math
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
import unittest

from program_support import lines, main, PLACE, PROGRAM, QUICK, run, SOURCE, WithFolder, without_display

sys.path.insert(0, str(SOURCE / "tests" / "support"))
import session_blocks  # noqa: E402

SHORT = ("--set", "duration_s=0.1", "--quiet", "--force")  # another run than the one before
# A bit that does not spin is pressed on for as long as the run lasts.
STOPPED = 1 << 7  # of the faults of the servo: a stop was requested
ENDLESS = ("--set", "duration_s=3000", "--set", "tool.spin_rpm=0")


def contents(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class WithRuns(WithFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def start(self, *arguments, out=None, **options):
        """Starts a run without pictures, and waits until it drills."""
        out = out or self.out
        before = self.session_of(out)
        process = subprocess.Popen([PROGRAM, "drill", str(QUICK), "--no-pictures", "--out", str(out), "--force", *ENDLESS, *map(str, arguments)],
                                   env=without_display(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **options)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60
        while (self.session_of(out) == before or self.rows(out) == 0) and time.monotonic() < deadline:
            if process.poll() is not None:
                self.fail(f"ended with exit {process.returncode}: {process.stderr.read()}")
            time.sleep(0.02)
        return process

    @staticmethod
    def session_of(out):
        """The inode of the session; None: there is none. That of an earlier run is kept until the new one is there."""
        try:
            status = (out / "session.sqlite").stat()
        except FileNotFoundError:
            return None
        return status.st_ino

    @staticmethod
    def rows(out, stream="contact"):
        """Rows of the session on the disk so far."""
        try:
            with contextlib.closing(sqlite3.connect(f"file:{out}/session.sqlite?mode=ro", uri=True)) as database:
                return sum(first + count for first, count in database.execute(
                    "SELECT max(first_row), rows FROM blocks JOIN streams ON blocks.stream = streams.position WHERE name = ?", (stream,)) if first is not None)
        except sqlite3.OperationalError:
            return 0

    def earlier(self, *arguments):
        """Fills the folder with the results of a run. @returns its contents."""
        result = run("drill", QUICK, "--out", self.out, *SHORT, "--set", "sound={sample_rate_hz=44100}", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        (self.out / "notes.txt").write_text("of a person")
        return contents(self.out)


class OneRun(WithRuns):
    def test_a_second_run_is_refused_with_process_and_start_of_the_first(self):
        first = self.start()
        before = {name: data for name, data in contents(self.out).items() if not name.startswith("session.sqlite")}
        for arguments in (("drill", QUICK, "--no-pictures", "--out", self.out, *SHORT), ("drill", QUICK, "--live", "--out", self.out, *SHORT)):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertRegex(lines(result.stderr)[-1], rf"the output folder is in use by process {first.pid} since "
                                                       r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d UTC: give another one by --out$")
        self.assertEqual({name: data for name, data in contents(self.out).items() if not name.startswith("session.sqlite")}, before)
        first.send_signal(signal.SIGINT)
        self.assertEqual(first.wait(timeout=60), 130)
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", self.out, *SHORT).returncode, 0)

    def test_a_killed_run_locks_nothing_and_leaves_no_result_that_seems_whole(self):
        old = self.earlier()
        process = self.start("--set", "sound={sample_rate_hz=44100}")
        process.kill()
        process.wait(timeout=60)
        left = contents(self.out)
        for name in ("summary.json", "report.html", "bone.vdb", "sound.wav", "before.png", "after.png", "cutaway.png"):
            self.assertNotIn(name, set(left))
        self.assertTrue(left["bone.earlier.vdb"] == old["bone.vdb"], "the only copy of a bone is kept")
        self.assertEqual(left["notes.txt"], b"of a person")
        self.assertEqual(run("session", self.out).returncode, 0, "what was recorded can be read")
        result = run("drill", QUICK, "--no-pictures", "--out", self.out, *SHORT)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(set(contents(self.out)), {"bone.vdb", "report.html", "session.sqlite", "summary.json", "notes.txt"})

    def test_a_run_that_does_not_start_leaves_the_folder_as_it_was(self):
        old = self.earlier()
        foreign = self.folder / "foreign.sqlite"
        foreign.write_text("no session")
        limit = "ulimit -f 0; exec \"$@\""
        for what, needle, arguments in (
                ("a file of another program in place of the session", "is no burrhole session", ("--set", "record.path=notes.txt")),
                ("a checkpoint that is not there", "", ("--restore", self.folder / "none.vdb")),
                ("a full disk", "cannot be written", None)):
            with self.subTest(what):
                command = [PROGRAM, "drill", str(QUICK), "--no-pictures", "--out", str(self.out), *SHORT, *map(str, arguments or ())]
                if arguments is None:
                    command = ["sh", "-c", limit, "sh", *command]
                result = subprocess.run(command, env=without_display(), capture_output=True, text=True, timeout=60)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(needle, result.stderr)
                now = contents(self.out)
                self.assertEqual([name for name in old.keys() | now.keys() if old.get(name) != now.get(name)], [])

    def test_the_checkpoint_of_a_run_may_be_in_its_folder(self):
        self.earlier()
        result = run("drill", QUICK, "--no-pictures", "--out", self.out, "--restore", self.out / "bone.vdb", *SHORT)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("bone.earlier.vdb", contents(self.out))
        self.assertEqual(run("replay", self.out / "session.sqlite", "--quiet").returncode, 0)
        # A run that writes no bone leaves the checkpoint under its name.
        again = ("drill", QUICK, "--no-pictures", "--out", self.out, "--restore", self.out / "bone.vdb", "--set", "output.bone=false", *SHORT)
        for _ in range(2):
            self.assertEqual(run(*again).returncode, 0)
            self.assertIn("bone.vdb", contents(self.out))

    def test_a_session_under_another_name_replaces_only_itself(self):
        named = ("--set", "record.path=records/mine.sqlite")
        self.earlier(*named)
        self.assertIn("records/mine.sqlite", contents(self.out))
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", self.out, *SHORT, *named).returncode, 0)
        self.assertEqual(set(contents(self.out)), {"bone.vdb", "report.html", "records/mine.sqlite", "summary.json", "notes.txt"})

    def test_files_that_burrhole_did_not_write_are_replaced_only_by_force(self):
        drill = ("drill", QUICK, "--no-pictures", "--out", self.out, *SHORT[:-1])
        for name in ("report.html", "bone.vdb", "before.png"):
            with self.subTest(name):
                self.out.mkdir()
                (self.out / name).write_text("of a person")
                result = run(*drill)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertEqual(lines(result.stderr), [f"{self.out / name}: is no result of burrhole drill: give another folder by --out, or "
                                                        "--force to replace it"])
                self.assertEqual(contents(self.out), {name: b"of a person"})
                self.assertEqual(run(*drill, "--force").returncode, 0)
                self.assertNotEqual(contents(self.out).get(name), b"of a person")
                shutil.rmtree(self.out)

    def test_an_input_is_not_replaced_by_the_bone_of_an_earlier_run(self):
        old = self.earlier()
        (self.out / "bone.vdb").rename(self.out / "bone.earlier.vdb")
        restore = ("drill", QUICK, "--no-pictures", "--out", self.out, "--restore", self.out / "bone.earlier.vdb", *SHORT)
        self.assertEqual(run(*restore).returncode, 0)
        before = contents(self.out)
        result = run(*restore)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(f"{self.out / 'bone.earlier.vdb'}: is an input of this run", result.stderr)
        self.assertEqual([name for name in before.keys() | contents(self.out).keys() if before.get(name) != contents(self.out).get(name)], [])
        self.assertTrue(before["bone.earlier.vdb"] == old["bone.vdb"])


class AnotherRun(WithRuns):
    """Results of the same scene with other settings are those of another run."""

    PLAIN = ("--no-pictures", "--set", "duration_s=0.1", "--quiet")

    def drill(self, *arguments, scene=None):
        return run("drill", scene or self.path, "--out", self.out, *arguments)

    def setUp(self):
        super().setUp()
        self.path = self.quick()
        first = self.drill(*self.PLAIN)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.before = contents(self.out)

    def refused(self, *needles, arguments=PLAIN):
        result = self.drill(*arguments)
        self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        for needle in ("holds results of this scene", *needles, "give another folder by --out, or --force to replace them"):
            self.assertIn(needle, result.stderr)
        self.assertEqual(contents(self.out), self.before)

    def test_the_same_run_is_repeated(self):
        for mode in ((), ("--live",)):
            again = self.drill(*self.PLAIN, *mode)
            self.assertEqual(again.returncode, 0, again.stderr)

    def test_other_overrides_are_refused_and_named(self):
        more = ("--set", "hand.push_N=12")
        self.refused("with other overrides of the scene: the scene's own values there, hand.push_N=12 now", arguments=(*self.PLAIN, *more))
        self.refused("duration_s=0.1 there, duration_s=0.2 now", arguments=("--no-pictures", "--set", "duration_s=0.2", "--quiet"))
        self.refused("the tool's own values there, region.pin.erosion_factor=0.02 now", arguments=(*self.PLAIN, "--set-tool", "region.pin.erosion_factor=0.02"))
        self.assertEqual(self.drill(*self.PLAIN, *more, "--force").returncode, 0)
        back = self.drill(*self.PLAIN)
        self.assertEqual(back.returncode, 2, "now they are the results with the override")
        self.assertIn("hand.push_N=12 there, the scene's own values now", back.stderr)

    def test_an_edited_scene_or_tool_is_refused(self):
        text = self.path.read_text()
        edited = re.sub(r"(?m)^push_N = .*$", "push_N = 11.0", text)
        self.assertNotEqual(edited, text)
        self.path.write_text(edited)
        self.refused("from before its file was edited")
        self.path.write_text(text)
        self.assertEqual(self.drill(*self.PLAIN).returncode, 0)
        self.before = contents(self.out)
        tool = self.folder / "pin_2mm.toml"
        tool.write_text(tool.read_text() + "\n# sharper\n")
        self.refused("with another tool, or from before its file was edited")

    def test_another_bone_under_the_same_name_is_refused(self):
        bone = self.folder / "bone.vdb"
        source = ("--no-pictures", "--quiet", "--set", "duration_s=0.1", "--set", f"volume.source={bone}", "--unset", "volume.spacing_mm",
                  "--unset", "volume.extent_mm", "--unset", "volume.above_mm", "--unset", "volume.thickness_mm")
        thick = self.folder / "thick"
        self.assertEqual(run("drill", self.path, "--out", thick, *self.PLAIN, "--set", "volume.thickness_mm=1.4").returncode, 0)
        bone.write_bytes((self.out / "bone.vdb").read_bytes())
        first = self.drill(*source, "--force")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(self.drill(*source).returncode, 0)
        self.before = contents(self.out)
        bone.write_bytes((thick / "bone.vdb").read_bytes())
        self.refused("with another bone: the volume was replaced since, or is read differently", arguments=source)


class Names(WithRuns):
    def test_a_session_stays_below_the_folder_and_takes_no_name_of_a_result(self):
        for path, needle in (("report.html", "another result"), ("summary.json", "another result"), ("bone.vdb", "another result"),
                             ("./bone.vdb", "another result"), ("bone.vdb/session", "another result"), ("sound.wav", "another result"),
                             ("after.png", "another result"), (".burrhole-run", "another result"), ("bone.earlier.vdb", "another result"),
                             ("scene.toml", "another result"), ("/tmp/session", "leaves the output folder"), ("../session", "leaves the output folder"),
                             ("a/../../session", "leaves the output folder"), ("", "names no file"), (".", "names no file"), ("a/", "names no file"),
                             ("session.sqlite-wal", "ends as a file that SQLite keeps"), ("a/mine-shm", "ends as a file that SQLite keeps"),
                             ("x-journal", "ends as a file that SQLite keeps")):
            with self.subTest(path):
                scene = self.quick([("[record]\n", f"[record]\npath = {json.dumps(path)}\n")])
                line = scene.read_text().splitlines().index(f"path = {json.dumps(path)}") + 1
                for command in (("check", scene), ("drill", scene, "--no-pictures", "--out", self.out, "--quiet")):
                    result = run(*command)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    (message,) = lines(result.stderr)
                    self.assertEqual((PLACE.match(message)["file"], int(PLACE.match(message)["line"])), (str(scene), line))
                    self.assertIn(f"record.path = {json.dumps(path)} {needle if needle != 'another result' else 'is the name of another result'}", message)
                self.assertFalse(self.out.exists())


class Interrupted(WithRuns):
    def test_a_closed_terminal_ends_a_run_like_a_signal_to_terminate(self):
        process = self.start()
        for _ in range(2):
            process.send_signal(signal.SIGHUP)
        self.assertEqual(process.wait(timeout=60), 130, process.stderr.read())
        self.assertEqual(json.loads((self.out / "summary.json").read_text())["end"], "stopped")
        self.assertEqual(run("replay", self.out / "session.sqlite", "--quiet").returncode, 0)

    def test_the_peak_force_is_that_on_the_hand(self):
        """A stop takes the force off the hand, which goes on pressing: contact's forces of that time reach nobody."""
        process = self.start("--live")
        deadline = time.monotonic() + 60
        while self.rows(self.out) < 2000 and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 130, process.stderr.read())
        streams = {name: self.stream(name) for name in ("servo", "contact")}
        faded = next(int(row["hand_tick"]) for row in streams["servo"] if int(float(row["faults"])) & STOPPED)
        forces = [(int(row["hand_tick"]), math.hypot(*(float(row[f"force_{axis}_N"]) for axis in "xyz"))) for row in streams["contact"]]
        felt = max(force for tick, force in forces if tick <= faded)
        self.assertGreater(max(force for tick, force in forces), 1.5 * felt, "the hand did not press on")
        self.check_peak(streams["servo"])

    def check_peak(self, servo):
        """The peak in summary and report is the largest force sent to the hand. Rows hold forces as floats."""
        sent = max(math.hypot(*(float(row[f"sent_{axis}_N"]) for axis in "xyz")) for row in servo)
        peak = json.loads((self.out / "summary.json").read_text())["drilling"]["peak_force_N"]
        self.assertAlmostEqual(peak, sent, delta=1e-5 * sent)
        self.assertIn(f"{peak:.2f}", (self.out / "report.html").read_text())
        return peak

    def test_the_peak_force_under_a_slew_limit_is_that_on_the_hand(self):
        """The force on the hand rises slowly, while the hand presses on: contact's force is larger."""
        for live in ([], ["--live"]):
            result = run("drill", QUICK, "--no-pictures", "--offscreen", "--set", "tool.spin_rpm=0", "--set", "duration_s=2",
                         "--set", "servo.slew_N_per_s=10", "--out", self.out, "--force", "--quiet", *live)
            self.assertEqual(result.returncode, 0, result.stderr)
            peak = self.check_peak(self.stream("servo"))
            contact = max(math.hypot(*(float(row[f"force_{axis}_N"]) for axis in "xyz")) for row in self.stream("contact"))
            self.assertGreater(contact, 1.2 * peak)

    def stream(self, name):
        result = run("session", self.out, "--csv", "--stream", name)
        self.assertEqual(result.returncode, 0, result.stderr)
        return list(csv.DictReader(io.StringIO(result.stdout)))

    def test_nohup_keeps_a_run(self):
        process = self.start(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        process.send_signal(signal.SIGHUP)
        rows, deadline = self.rows(self.out), time.monotonic() + 60
        while self.rows(self.out) < rows + 2000 and time.monotonic() < deadline:
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 130)


if __name__ == "__main__":
    main()
