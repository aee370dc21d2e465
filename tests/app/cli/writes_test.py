"""What cannot be written is an error, and harms no file that is there: every command that writes, under a limit of the size of files and
onto a full device; two writers of one file; standard output and error that are closed, full, or read no further.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import unittest

from program_support import lines, main, PROGRAM, QUICK, run, SCENES, WithFolder, without_display

SHORT = ("--set", "duration_s=0.1", "--quiet", "--force")
STAND_IN = "#!/bin/sh\nfor last; do :; done\ncat > \"${last#file:}\"\n"  # in place of ffmpeg: what it is given, into its output


def limited(size):
    """Makes a write beyond `size` bytes fail, as a full disk does. The signal has its default action, which ends a program."""
    def apply():
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
    return apply


class Writes(WithFolder):
    """Each command that writes files, by the files it is asked for."""

    def setUp(self):
        super().setUp()
        self.inputs = self.folder / "inputs"
        self.inputs.mkdir()
        self.out = self.folder / "out"
        self.run_folder = self.folder / "run"
        sound = ("--set", "sound={sample_rate_hz=44100}")
        result = run("drill", QUICK, "--out", self.run_folder, *SHORT, *sound)
        self.assertEqual(result.returncode, 0, result.stderr)
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "ffmpeg").write_text(STAND_IN)
        (tools / "ffmpeg").chmod(0o755)
        self.env = {**without_display(), "PATH": f"{tools}:{os.environ['PATH']}"}

    def single(self):
        """Commands that write one file: name of the file, arguments without it."""
        bone, session, render = self.run_folder / "bone.vdb", self.run_folder / "session.sqlite", ("render", QUICK, "--size", "64x48")
        out = {"import.vdb": ("import", bone, "--quiet", "--force", "--volume"), "overview.png": ("import", bone, "--quiet", "--force", "--overview"),
               "sound.wav": ("replay", session, "--quiet", "--wav"), "picture.png": (*render, "--image"),
               "slices.png": (*render, "--slices-through-tip", "--image"),
               "video.mp4": ("drill", QUICK, "--out", self.folder / "filmed", "--video-fps", "50", *SHORT, "--video")}
        for name in ("a.nrrd", "a.nii", "a.nii.gz", "a.vdb", "a.stl", "a.ply", "a.obj"):
            out[name] = ("export", bone, "--quiet", "--force", "-o")
        for name in ("plan.mrk.json", "plan.fcsv"):
            out[name] = ("export", QUICK, "--quiet", "--force", "-o")
        if shutil.which("gnuplot"):
            out["sheet.png"] = ("tools", "round_burr_2mm", "--image")
        return out

    def test_under_a_limit_the_old_file_stays_and_nothing_is_left_beside_it(self):
        dice = random.Random(7)
        for name, arguments in self.single().items():
            target = self.out / name
            self.out.mkdir(exist_ok=True)
            whole = run(*arguments, target, env=self.env)
            self.assertEqual(whole.returncode, 0, (name, whole.stderr))
            size, old = target.stat().st_size, target.read_bytes()
            # Within the program's own temporary files (plots, the recorded run) a small limit may fail first, which is an error too.
            for limit in (0, dice.randrange(1, size), size - 1):
                with self.subTest(name, limit=limit, size=size):
                    before = {path.name for path in self.out.iterdir()}
                    result = run(*arguments, target, env=self.env, preexec_fn=limited(limit))
                    self.assertNotIn(result.returncode, (0, 1), result.stderr)
                    self.assertGreater(result.returncode, 0, "ended by a signal")
                    self.assertTrue(result.stderr.strip())
                    self.assertTrue(target.read_bytes() == old)
                    self.assertEqual({path.name for path in self.out.iterdir()}, before)

    def test_a_full_device_is_an_error_that_names_it(self):
        self.out.mkdir()
        for name, arguments in self.single().items():
            if name == "video.mp4":
                continue  # ffmpeg writes files
            with self.subTest(name):
                target = self.out / name
                target.symlink_to("/dev/full")
                result = run(*arguments, target, env=self.env)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(f"{target}: cannot be written: No space left on device: free space there", result.stderr)
                self.assertTrue(target.is_symlink())

    def test_a_drill_that_cannot_write_leaves_no_result_that_seems_whole(self):
        largest, began = max(path.stat().st_size for path in self.run_folder.iterdir()), 0
        for limit in (0, 1000, 20000, 60000, largest * 9 // 10):
            with self.subTest(limit=limit):
                out = self.folder / f"limited-{limit}"
                shutil.copytree(self.run_folder, out)
                old = {path.name: path.read_bytes() for path in out.iterdir()}
                result = run("drill", QUICK, "--out", out, *SHORT, "--set", "sound={sample_rate_hz=44100}", preexec_fn=limited(limit))
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("name a", result.stderr, "a next step: name a place, or another place")
                self.assertEqual([path.name for path in out.rglob("*.tmp")], [])
                new = {path.name: path.read_bytes() for path in out.iterdir()}
                if new == old:  # it did not begin
                    continue
                began += 1
                # What is there is of this run, and whole. These files differ from run to run, by times and by an identifier.
                for name in ("summary.json", "report.html", "bone.vdb"):
                    self.assertTrue(name not in new or new[name] != old[name], name)
                if "summary.json" in new:
                    summary = json.loads(new["summary.json"])
                    ended = any(line.startswith("an error ended the run at") for line in summary["warnings"])
                    self.assertEqual(summary["end"], "stopped" if ended else "duration")
                if "bone.vdb" in new:
                    self.assertEqual(run("import", out / "bone.vdb", "--json").returncode, 0)
                else:
                    self.assertTrue(new["bone.earlier.vdb"] == old["bone.vdb"])
        self.assertGreater(began, 0, "no run began under a limit")

    def test_folders_of_reports(self):
        commands = {"compare": ("compare", self.run_folder, self.run_folder), "scenes": ("scenes", "--copy", "parietal"),
                    "stability": ("stability", "--case", "rest", "--model", "surface")}
        for name, arguments in commands.items():
            with self.subTest(name):
                out = self.folder / name
                self.assertIn(run(*arguments, "--out", out).returncode, (0, 3))
                old = {path.name: path.read_bytes() for path in out.iterdir()}
                force = ("--force",) if name == "scenes" else ()
                result = run(*arguments, "--out", out, *force, preexec_fn=limited(50))
                self.assertIn(result.returncode, (2, 4), result.stderr)
                self.assertEqual({path.name: path.read_bytes() for path in out.iterdir()}, old)

    def test_two_imports_into_one_file_leave_the_whole_of_one(self):
        # Large enough for the writes of two processes to meet.
        sources = []
        for thickness in ("1.2", "2"):
            out = self.folder / f"thick-{thickness}"
            result = run("drill", QUICK, "--no-pictures", "--out", out, *SHORT, "--set", f"volume.thickness_mm={thickness}", "--set",
                         "volume.spacing_mm=0.07")
            self.assertEqual(result.returncode, 0, result.stderr)
            sources.append(out / "bone.vdb")
        expected = [json.loads(run("import", source, "--json").stdout)["bone"]["voxels"] for source in sources]
        self.assertNotEqual(*expected)
        self.out.mkdir()
        target, dice = self.out / "both.vdb", random.Random(3)
        for _ in range(12):
            processes = []
            for source in sources:
                delay = f"sleep {dice.random() * 0.05:.4f}; exec \"$@\""
                processes.append(subprocess.Popen(["sh", "-c", delay, "sh", PROGRAM, "import", str(source), "--volume", str(target), "--quiet", "--force"],
                                                  env=without_display(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True))
            for process in processes:
                message = process.communicate(timeout=60)[1]
                self.assertEqual(process.returncode, 0, message)
            self.assertIn(json.loads(run("import", target, "--json").stdout)["bone"]["voxels"], expected)
            self.assertEqual([path.name for path in self.out.iterdir()], ["both.vdb"])


class StandardStreams(WithFolder):
    def setUp(self):
        super().setUp()
        self.run_folder = self.folder / "run"
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", self.run_folder, *SHORT).returncode, 0)

    def printing(self):
        """Commands that print, each of them."""
        bone, session = self.run_folder / "bone.vdb", self.run_folder / "session.sqlite"
        return [("--help",), ("--version",), ("drill", "--help"), ("tools",), ("tools", "--json"), ("tools", "round_burr_2mm"), ("scenes",),
                ("scenes", "--json"), ("scenes", "--copy", "parietal", "--out", self.folder / "copy", "--force"), ("check", QUICK),
                ("explain", QUICK), ("explain", QUICK, "--json"), ("devices",), ("devices", "--json"), ("docs", "scene"),
                ("docs", "outcome"), ("completion", "bash"), ("completion", "zsh"), ("completion", "fish"), ("man",),
                ("import", bone, "--json"), ("import", bone), ("session", session), ("session", session, "--csv"),
                ("compare", self.run_folder, self.run_folder), ("compare", self.run_folder, self.run_folder, "--json"),
                ("export", bone, "-o", self.folder / "a.nii", "--force", "--quiet"), ("replay", session, "--quiet"),
                ("drill", QUICK, "--no-pictures", "--out", self.folder / "json", "--json", *SHORT)]

    def test_the_list_names_every_command(self):
        commands = {line.split()[0] for line in run("--help").stdout.splitlines() if line.startswith("  ") and line.split()[0].isalpha()
                    and not line.startswith("   ")} - {"burrhole"}
        self.assertIn("tools", commands)
        # These print when they have measured for minutes, or print only to stderr.
        self.assertEqual(commands - {command[0] for command in self.printing()}, {"cost", "stability", "render"})

    def test_a_full_standard_output_is_an_error(self):
        for arguments in self.printing():
            with self.subTest(arguments), open("/dev/full", "w") as full:
                result = subprocess.run([PROGRAM, *map(str, arguments)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60,
                                        env=without_display())
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertEqual(lines(result.stderr)[-1], "standard output: cannot be written: No space left on device: free space there, "
                                                           "or name another place")

    def test_a_closed_standard_output_is_an_error_of_those_that_print(self):
        shell = 'exec "$@" >&-'
        result = subprocess.run(["sh", "-c", shell, "sh", PROGRAM, "tools"], stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual((result.returncode, lines(result.stderr)), (2, ["standard output: cannot be written: Bad file descriptor"]))
        out = self.folder / "out"
        result = subprocess.run(["sh", "-c", shell, "sh", PROGRAM, "drill", str(QUICK), "--no-pictures", "--out", str(out), *SHORT],
                                stderr=subprocess.PIPE, text=True, timeout=60, env=without_display())
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_reader_that_goes_ends_the_program_quietly(self):
        # More than a pipe holds, so that the program writes when nobody reads any more.
        run("drill", QUICK, "--no-pictures", "--out", self.folder / "long", "--quiet")
        for ignored in (False, True):  # by who starts the program
            with self.subTest(ignored=ignored):
                process = subprocess.Popen([PROGRAM, "session", str(self.folder / "long"), "--csv"], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, restore_signals=not ignored)
                process.stdout.read(100)
                process.stdout.close()
                message = process.stderr.read()
                process.stderr.close()
                self.assertEqual(message, b"")
                self.assertEqual(process.wait(timeout=60), 128 + signal.SIGPIPE)

    def test_a_reader_of_standard_error_that_goes_costs_no_result(self):
        out = self.folder / "out"
        process = subprocess.Popen([PROGRAM, "drill", str(QUICK), "--out", str(out), "--set", "duration_s=0.3"], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, env=without_display())
        process.stderr.close()
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertLessEqual({"summary.json", "report.html", "bone.vdb", "session.sqlite", "after.png"}, {path.name for path in out.iterdir()})

    def test_programs_that_it_starts_end_at_a_broken_pipe(self):
        tools = self.folder / "tools"
        tools.mkdir()
        note = f"#!/bin/sh\ngrep SigIgn /proc/self/status > {self.folder}/ignored-${{0##*/}}\n"
        (tools / "gnuplot").write_text(note + "exit 1\n")
        (tools / "ffmpeg").write_text(note + STAND_IN)
        for tool in tools.iterdir():
            tool.chmod(0o755)
        env = {**without_display(), "PATH": f"{tools}:{os.environ['PATH']}"}
        run("tools", "round_burr_2mm", "--image", self.folder / "sheet.png", env=env)
        run("drill", QUICK, "--out", self.folder / "filmed", "--video-fps", "50", *SHORT, "--video", self.folder / "video.mp4", env=env)
        for name in ("gnuplot", "ffmpeg"):
            mask = int((self.folder / f"ignored-{name}").read_text().split()[1], 16)
            self.assertEqual(mask >> (signal.SIGPIPE - 1) & 1, 0, name)

    def test_no_standard_error_changes_nothing(self):
        expected = None
        for n, shell in enumerate(('exec "$@" 2>/dev/null', 'exec "$@" 2>&-', 'exec "$@" 2>/dev/full', 'exec "$@" <&- >&- 2>&-')):
            with self.subTest(shell):
                out = self.folder / f"out{n}"
                # Not --quiet: warnings and progress have nowhere to go.
                result = subprocess.run(["sh", "-c", shell, "sh", PROGRAM, "drill", str(QUICK), "--out", str(out), "--set", "duration_s=0.3"],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60, env=without_display())
                self.assertEqual(result.returncode, 0)
                hashes = json.loads((out / "summary.json").read_text())["hash"]
                files = {path.name: path.read_bytes()[:16] for path in out.iterdir()}
                expected = expected or (hashes, files.keys())
                self.assertEqual((hashes, files.keys()), expected)
                for name, start in files.items():
                    kind = name.rsplit(".", 1)[1]
                    self.assertTrue(start.startswith({"json": b"{", "html": b"<!DOCTYPE html>", "png": b"\x89PNG", "sqlite": b"SQLite format 3",
                                                      "vdb": b" BDV"}[kind]), (name, start))


if __name__ == "__main__":
    main()
