"""Ctrl-C at every moment at which files are half written, and what a new file is before and after it has its name: rights, syncs, renames.

Moments are system calls, at which strace delivers a signal. Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from faults import CALL, chosen, is_whole, missing_tool  # noqa: E402
from program_support import lines, PROGRAM, QUICK, run, WithFolder, without_display  # noqa: E402

KINDS = "openat,write,fsync,rename,fchmod,close,unlink"
SEED, MOMENTS = 20, 12
DRILL = ("drill", QUICK, "--no-pictures", "--quiet", "--force")


class Traced(WithFolder):
    def setUp(self):
        super().setUp()
        if why := missing_tool():
            self.skipTest(why)
        self.out = self.folder / "out"
        self.out.mkdir()

    def traced(self, *arguments, options=(), kinds=KINDS):
        """@returns the process, and the lines of its calls as (thread, call, the rest)."""
        log = self.folder / "calls.txt"
        # A signal is delivered at the stop of every call, not at that of a filter (--seccomp-bpf).
        done = subprocess.run(["strace", "-f", "-y", "-s", "0", "-e", f"trace={kinds}", *options, "-o", log, PROGRAM,
                               *map(str, arguments)], capture_output=True, text=True, timeout=300, env=without_display())
        return done, [found.groups() for found in map(CALL.match, log.read_text(errors="replace").splitlines()) if found]

    def moments(self, calls, name):
        """Calls that name a file, in the order in which they are made: (call, its number in its thread, "")."""
        seen, out = {}, []
        for thread, kind, rest in calls:
            seen[thread, kind] = seen.get((thread, kind), 0) + 1
            if f"{self.out}/{name}" in rest and kind != "unlink":
                out.append((kind, seen[thread, kind], ""))
        return out

    def interrupted_at(self, moment, *arguments):
        kind, number, _ = moment
        return self.traced(*arguments, options=("-e", f"inject={kind}:signal=SIGINT:when={number}"))[0]


class Interrupts(Traced):
    def test_an_import_of_a_drilled_bone_leaves_the_old_file_or_the_new_one(self):
        drilled = self.folder / "run"
        done = run(*DRILL, "--set", "duration_s=1", "--out", drilled)
        self.assertEqual(done.returncode, 0, done.stderr)
        command = ("import", drilled / "bone.vdb", "--quiet", "--force", "--volume", self.out / "bone.vdb")
        done, calls = self.traced(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = (self.out / "bone.vdb").read_bytes()
        kept = 0
        for moment in chosen(self.moments(calls, "bone.vdb"), MOMENTS, SEED):
            with self.subTest(moment=moment):
                (self.out / "bone.vdb").write_bytes(b"an old bone")
                done = self.interrupted_at(moment, *command)
                self.assertEqual(done.returncode, 130, done.stderr)
                self.assertEqual(len(lines(done.stderr)), 1, done.stderr)
                self.assertEqual([path.name for path in self.out.iterdir()], ["bone.vdb"])
                left = (self.out / "bone.vdb").read_bytes()
                if left == b"an old bone":
                    kept += 1
                    self.assertIn("was stopped", done.stderr)
                else:
                    self.assertEqual(len(left), len(whole))
                    self.assertTrue(is_whole(self.out / "bone.vdb"))
                    self.assertIn("stopped after it was written", done.stderr)
        self.assertGreater(kept, 0)

    def test_a_drill_that_is_interrupted_while_it_writes_results_writes_all_of_them(self):
        command = (*DRILL, "--set", "duration_s=0.3", "--set", "output.plots=false", "--out", self.out)  # strace would interrupt gnuplot too
        done, calls = self.traced(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        names = sorted(path.name for path in self.out.iterdir())
        self.assertEqual(names, ["bone.vdb", "report.html", "session.sqlite", "summary.json"])
        for name in ("bone.vdb", "summary.json", "report.html"):
            # The first two calls are made before the run: its earlier file is looked at and moved.
            points = [m for m in self.moments(calls, name) if m[0] in ("write", "fsync", "fchmod", "rename")]
            self.assertGreater(len(points), 1, name)
            for moment in chosen(points, 3, SEED):
                with self.subTest(name=name, moment=moment):
                    done = self.interrupted_at(moment, *command)
                    self.assertIn(done.returncode, (0, 130), done.stderr)
                    self.assertEqual(sorted(path.name for path in self.out.iterdir()), names)
                    for path in self.out.iterdir():
                        self.assertTrue(is_whole(path), path.name)

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_an_interrupt_from_the_terminal_while_gnuplot_draws_ends_with_a_whole_report(self):
        """A terminal sends the signal to all processes of the group."""
        tools, scratch, began = self.folder / "tools", self.folder / "scratch", self.folder / "began"
        tools.mkdir()
        scratch.mkdir()
        (tools / "gnuplot").write_text(f'#!/bin/sh\ntouch "{began}"\nsleep 1\nexec {shutil.which("gnuplot")} "$@"\n')
        (tools / "gnuplot").chmod(0o755)
        environment = {**without_display(), "PATH": f"{tools}:{os.environ['PATH']}", "TMPDIR": str(scratch)}
        process = subprocess.Popen([PROGRAM, *map(str, DRILL), "--set", "duration_s=0.3", "--out", self.out], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 120
        while not began.exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertTrue(began.exists())
        os.killpg(process.pid, signal.SIGINT)
        printed, errors = process.communicate(timeout=120)
        self.assertEqual((process.returncode, printed), (0, ""), errors)
        self.assertNotIn("gnuplot", errors)
        self.assertIn("<svg", (self.out / "report.html").read_text())
        self.assertEqual(sorted(path.name for path in self.out.iterdir()), ["bone.vdb", "report.html", "session.sqlite", "summary.json"])
        self.assertEqual(list(scratch.iterdir()), [])


class NewFiles(Traced):
    def rights_while_written(self, old_mode, mask):
        """Exports over a file of those rights, or none. @returns its rights at the end, and each that its temporary file had while it was
        written, in order."""
        path = self.out / "a.nrrd"
        path.unlink(missing_ok=True)
        if old_mode is not None:
            path.write_bytes(b"old")
            path.chmod(old_mode)
        before = os.umask(mask)
        try:
            done, calls = self.traced("export", QUICK, "--quiet", "--force", "-o", path)
        finally:
            os.umask(before)
        self.assertEqual(done.returncode, 0, done.stderr)
        rights = []
        for _, kind, rest in calls:
            if kind == "openat" and ".tmp" in rest and "O_CREAT" in rest:
                rights.append(int(re.search(r"O_CREAT[^,]*, (0\d+)", rest).group(1), 8) & ~mask)
            if kind == "fchmod" and ".tmp" in rest:
                rights.append(int(re.search(r", (0\d*)\)", rest).group(1), 8))
            if kind == "write" and ".tmp" in rest:
                rights.append("write")
        return path.stat().st_mode & 0o777, rights

    def test_a_file_is_never_readable_wider_than_it_will_be(self):
        for old_mode, mask in ((0o640, 0o022), (0o600, 0o000), (0o664, 0o022), (0o444 | 0o200, 0o077), (None, 0o022), (None, 0o077)):
            with self.subTest(old_mode=old_mode, mask=mask):
                final, rights = self.rights_while_written(old_mode, mask)
                self.assertEqual(final, old_mode if old_mode is not None else 0o666 & ~mask)
                modes = [one for one in rights if one != "write"]
                self.assertGreater(len(modes), 0)
                for mode in modes:
                    self.assertEqual(mode & ~final, 0, f"{mode:o} is wider than {final:o}")
                self.assertIn("write", rights)
                self.assertEqual(rights[rights.index("write"):], ["write"] * rights.count("write"), "rights are set before the first byte")

    def order(self, calls, name):
        """The calls that put a file on the disk, in order: of its bytes, of its name, of its folder."""
        out = []
        for _, kind, rest in calls:
            if kind == "fsync" and f"<{self.out}>" in rest:
                out.append("folder")
            elif kind == "fsync" and f"<{self.out}/{name}" in rest:
                out.append("bytes")
            elif kind in ("rename", "write") and f"{self.out}/{name}" in rest and out[-1:] != [kind]:
                out.append(kind)
        return out

    def test_bytes_are_on_the_disk_before_the_name_and_the_folder_after_it(self):
        for name in ("a.nrrd", "a.stl"):
            done, calls = self.traced("export", QUICK, "--quiet", "--force", "-o", self.out / name)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(self.order(calls, name), ["write", "bytes", "rename", "folder"])

    def test_a_folder_that_cannot_be_synced_is_an_error(self):
        done, calls = self.traced("export", QUICK, "--quiet", "--force", "-o", self.out / "a.stl")
        last = sum(kind == "fsync" for _, kind, _ in calls)
        done, calls = self.traced("export", QUICK, "--quiet", "--force", "-o", self.out / "a.stl", options=("-e", f"inject=fsync:error=EIO:when={last}"))
        self.assertTrue(any(kind == "fsync" and f"<{self.out}>" in rest and "INJECTED" in rest for _, kind, rest in calls))
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(lines(done.stderr)), 1)
        self.assertEqual([path.name for path in self.out.iterdir()], ["a.stl"])
        self.assertTrue(is_whole(self.out / "a.stl"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
