"""The built program as its users meet it: exit codes, one-line faults, files, stdout that is JSON and nothing else.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import contextlib
import json
import math
import os
import pathlib
import re
import resource
import signal
import sqlite3
import struct
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import session_blocks  # noqa: E402
from program_support import lines, main, PLACE, PROGRAM, QUICK, run, SOURCE, WithFolder


class Drill(WithFolder):
    def test_a_drill_leaves_every_file_and_twice_the_same_hashes(self):
        summaries = []
        for turn in ("a", "b"):
            out = self.folder / turn
            result = run("drill", QUICK, "--out", out, "--json", "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr, "")
            on_stdout = json.loads(result.stdout)  # one object and nothing else
            self.assertEqual(on_stdout, json.loads((out / "summary.json").read_text()))
            summaries.append(on_stdout)
            for name in ("before", "during", "breakthrough", "after", "cutaway"):
                head = (out / f"{name}.png").read_bytes()[:24]
                self.assertEqual(struct.unpack(">II", head[16:24]), (160, 120))
            for name in ("session.sqlite", "bone.vdb", "report.html"):
                self.assertGreater((out / name).stat().st_size, 0, name)
            self.assertFalse([p for p in out.iterdir() if p.suffix == ".tmp"])
        self.assertEqual(summaries[0]["hash"], summaries[1]["hash"])
        self.assertGreater(summaries[0]["drilling"]["removed_mm3"], 1.0)
        replayed = run("replay", self.folder / "a" / "session.sqlite", "--quiet")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertEqual(replayed.stdout.count(" same"), 3, replayed.stdout)

    def test_a_live_run_is_on_the_clock_and_its_record_replays_to_the_same_bits(self):
        out = self.folder / "live"
        began = time.monotonic()
        result = run("drill", QUICK, "--live", "--out", out, "--json", "--quiet", "--set", "duration_s=2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreaterEqual(time.monotonic() - began, 2.0)
        told = json.loads(result.stdout)
        self.assertEqual(told["live"]["rows_not_recorded"], 0)
        self.assertEqual(told["live"]["servo_ticks_missed"], told["timing"]["missed"])
        self.assertGreater(told["timing"]["servo_late"]["count"], 0)
        replayed = run("replay", out / "session.sqlite", "--quiet")
        self.assertEqual((replayed.returncode, replayed.stdout.count(" same")), (0, 3), replayed.stdout + replayed.stderr)

    def test_a_live_run_ends_in_order_on_a_signal_and_leaves_the_device_without_force(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            out = self.folder / number.name
            # A bit that stands still on a plate is pressed on for as long as the run lasts.
            program = subprocess.Popen([PROGRAM, "drill", QUICK, "--live", "--out", out, "--quiet", "--set", "duration_s=60", "--set", "tool.spin_rpm=0",
                                        "--set", "device.name=generic"], stderr=subprocess.PIPE)
            self.wait_until_pressed(out / "session.sqlite")
            program.send_signal(number)
            self.assertEqual(program.wait(timeout=60), 130, program.stderr.read())
            program.stderr.close()
            told = json.loads((out / "summary.json").read_text())
            self.assertEqual(told["end"], "stopped")
            self.assertGreater(self.sent(out / "session.sqlite"), 0.5, "the hand was not pushed on when the signal came")
            self.assertEqual(told["live"]["force_left_N"], 0)

    @staticmethod
    def sent(session):
        """[N] The largest force of the last two seconds on the disk, which is written once a second; 0: there is none yet. A run that is
        stopped ends on none, as the force fades."""
        try:
            with contextlib.closing(sqlite3.connect(f"file:{session}?mode=ro", uri=True)) as database:
                columns = session_blocks.columns(database, "servo")
                blocks = session_blocks.last_blocks(database, "servo", 2)
        except sqlite3.OperationalError:
            return 0.0
        decoded = (session_blocks.decode(data, columns) for _, data in blocks)
        return max((math.hypot(*force) for block in decoded for force in zip(block["sent_x"], block["sent_y"], block["sent_z"])), default=0.0)

    def wait_until_pressed(self, session):
        deadline = time.monotonic() + 60
        while self.sent(session) < 0.5 and time.monotonic() < deadline:
            time.sleep(0.2)

    @unittest.skipIf(os.geteuid() != 0, "real-time priority is taken away from an unprivileged user, which only root can become")
    def test_without_real_time_priority_a_live_run_warns_or_refuses(self):
        def unprivileged():
            resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)

        try:
            if run("--help", preexec_fn=unprivileged).returncode != 0:
                self.skipTest("another user cannot run the program where it lies")
        except (PermissionError, subprocess.SubprocessError):
            self.skipTest("another user cannot run the program where it lies")
        for more, code in (([], 0), (["--require-realtime"], 4)):
            folder = self.folder / f"user{code}"
            folder.mkdir()
            self.folder.chmod(0o755)
            os.chown(folder, 65534, 65534)
            result = run("drill", QUICK, "--live", "--out", folder, "--quiet", "--set", "duration_s=0.3", *more, preexec_fn=unprivileged)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertIn("real-time priority was refused", result.stderr)
            self.assertEqual(bool(list(folder.iterdir())), code == 0)

    def test_one_core_gives_the_same_hashes(self):
        everywhere = run("drill", QUICK, "--out", self.folder / "all", "--json", "--quiet")
        one = run("drill", QUICK, "--out", self.folder / "one", "--json", "--quiet",
                  preexec_fn=lambda: os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}))
        self.assertEqual(json.loads(everywhere.stdout)["hash"], json.loads(one.stdout)["hash"])

    def test_every_simd_level_gives_the_same_hashes(self):
        short = ("--set", "duration_s=0.5", "--json", "--quiet")
        names = re.search(r"must be one of: (\w+(?:, \w+)*)", run("explain", QUICK, "--simd", "mmx").stderr).group(1).split(", ")
        self.assertGreaterEqual(set(names), {"auto", "sse4"})
        drilled = {}
        for level in names:
            result = run("drill", QUICK, "--out", self.folder / level, "--simd", level, *short)
            if result.returncode == 2 and f"this machine has no {level}; it has: " in result.stderr:
                continue
            self.assertEqual(result.returncode, 0, result.stderr)
            drilled[level] = json.loads(result.stdout)
        self.assertGreaterEqual(len(drilled), 2, "auto and the weakest at least")
        for level, told in drilled.items():
            self.assertEqual(told["hash"], drilled["auto"]["hash"], level)
            replayed = run("replay", self.folder / "auto" / "session.sqlite", "--simd", level, "--quiet")
            self.assertEqual((replayed.returncode, replayed.stdout.count(" same")), (0, 3), replayed.stdout + replayed.stderr)
        self.assertGreater(drilled["auto"]["drilling"]["removed_mass_mm3"], 0.1)

    def test_another_seed_is_another_run(self):
        hashes = [json.loads(run("drill", QUICK, "--out", self.folder / str(seed), "--json", "--quiet", "--set", f"hand.seed={seed}").stdout)["hash"]
                  for seed in (1, 2)]
        self.assertNotEqual(hashes[0]["forces"], hashes[1]["forces"])

    def test_a_checkpoint_goes_on_where_the_bone_was_left(self):
        first = json.loads(run("drill", QUICK, "--out", self.folder / "a", "--set", "duration_s=0.6", "--json", "--quiet").stdout)
        second = run("drill", QUICK, "--out", self.folder / "b", "--restore", self.folder / "a" / "bone.vdb", "--set", "duration_s=0.05", "--json", "--quiet")
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertGreater(first["drilling"]["removed_mm3"], 0.1)
        self.assertLess(json.loads(second.stdout)["drilling"]["removed_mm3"], 0.1, "what the first run removed is not of the second")
        self.assertEqual(json.loads(second.stdout)["hash"]["voxels"], first["hash"]["voxels"])
        replayed = run("replay", self.folder / "b" / "session.sqlite", "--quiet")
        self.assertEqual(replayed.returncode, 0, replayed.stdout + replayed.stderr)

    def test_an_interrupt_ends_cleanly_with_what_was_done(self):
        out = self.folder / "out"
        process = subprocess.Popen([PROGRAM, "drill", str(QUICK), "--out", str(out), "--set", "duration_s=3000", "--set", "tool.spin_rpm=0"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 60
        while not (out / "before.png").exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, errors)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["end"], "stopped")
        self.assertTrue((out / "report.html").exists())
        replayed = run("replay", out / "session.sqlite", "--quiet")
        self.assertEqual(replayed.returncode, 0, replayed.stdout + replayed.stderr)

    def test_what_a_scene_does_not_name_does_not_exist(self):
        scene = self.scene(QUICK.read_text().replace("[display]\nsize = [160, 120]\n", "").replace("[record]\n", "").replace("[erosion]\n", ""))
        out = self.folder / "out"
        summary = json.loads(run("drill", scene, "--out", out, "--set", "duration_s=0.3", "--json", "--quiet").stdout)
        # Contact reads bone on a clock of its own, from copies: so bone is published.
        self.assertEqual([e["name"] for e in summary["effects"]], ["volume", "publish", "hand", "contact"])
        self.assertIsNone(summary["hash"]["image"])
        self.assertEqual({"erosion", "frame"} & set(summary["timing"]), set())
        self.assertEqual(summary["drilling"]["removed_mass_mm3"], 0)
        self.assertEqual(sorted(p.name for p in out.iterdir()), ["bone.vdb", "report.html", "summary.json"])

    def test_quiet_says_nothing_and_stdout_stays_empty_without_json(self):
        result = run("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.1", "--set", "tool.spin_rpm=0", "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_a_warning_is_printed_even_so_where_bone_is_not_drilled_through(self):
        result = run("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.1", "--quiet")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"^\S+: warning: hand: the time ended -?\d+\.\d\d mm deep in \d+\.\d\d mm of bone, which is not drilled through: raise duration_s\n$")

    def test_a_picture_of_an_earlier_run_does_not_stay(self):
        again = ("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.1", "--quiet")
        self.assertEqual(run(*again).returncode, 0)
        for name in ("breakthrough.png", "notes.png"):
            (self.folder / name).write_text("of another day")
        self.assertEqual(run(*again).returncode, 0)
        self.assertFalse((self.folder / "breakthrough.png").exists())
        self.assertTrue((self.folder / "notes.png").exists(), "only pictures of a run are ours to remove")


class BadInput(WithFolder):
    def refused(self, scene, code, *needles, sets=()):
        out = self.folder / "never"
        for command in ("check", "drill"):
            extra = ["--out", out] if command == "drill" else []
            result = run(command, scene, *extra, *[a for s in sets for a in ("--set", s)])
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(result.stdout, "")
            for needle in needles:
                self.assertTrue(any(needle in line for line in lines(result.stderr)), f"{needle!r} not in {result.stderr!r}")
            self.assertFalse(out.exists(), "nothing may be written")
        return lines(result.stderr)

    def test_faults_have_a_place_and_a_remedy(self):
        cases = [
            ([("spacing_mm = 0.2", "spacng_mm = 0.2")], "unknown key \"spacng_mm\" in [volume]; did you mean \"spacing_mm\"?"),
            ([("spacing_mm = 0.2", "spacing = 0.2")], "write \"spacing_mm\""),
            ([("spacing_mm = 0.2", "spacing_mm = -1")], "must be"),
            ([("push_N = 20", "push_N = nan")], "must be a finite number"),
            ([("push_N = 20", "push_N = \"hard\"")], "push_N"),
            ([("[erosion]", "[erosoin]")], "did you mean [erosion]?"),
            ([("[erosion]", "[contact.label_stiffness]\ndiploo = 0.5\n[erosion]")], "did you mean \"diploe\"?"),
            ([("[erosion]", "[contact.label_stiffness]\ndiploe = 2\n[erosion]")], "must be in [0.01, 1]"),
            ([("name = \"pin_2mm\"", "name = \"pin_3mm\"")], "not found in "),
            ([("[hand]", "[hand]\nkind = \"replay\"")], "is not in this version"),
            ([("[contact]", "[contact]\nbit = \"device\"")], "unknown key \"bit\" in [contact]"),
            ([("size = [160, 120]", "method = \"mesh\"\nbisections = 3")], "display.bisections is read only with shading = surface and quality = fixed: remove the key"),
            ([("[contact]", "[contact]\nrate_hz = 333")], "must divide servo_hz"),
            ([("title = \"Quick plate\"", "title = \"Quick plate")], "scene.toml:1:"),
        ]
        for replace, needle in cases:
            with self.subTest(needle=needle, replace=replace):
                for line in self.refused(self.quick(replace), 2, needle):
                    self.assertRegex(line, PLACE)

    def test_a_tool_larger_than_the_window_is_refused_with_the_numbers(self):
        scene = self.quick()
        tool = self.folder / "pin_2mm.toml"
        tool.write_text(tool.read_text().replace("height_mm = 2", "height_mm = 200"))
        found = self.refused(scene, 2, "too large for this bone's voxels", "each edge must be in [5, 512]")
        self.assertRegex(found[0], PLACE)

    def test_a_long_bit_fits_fine_voxels(self):
        text = (SOURCE / "app" / "scenes" / "parietal.toml").read_text()
        scene = self.scene(text + "\n")
        done = run("check", scene, "--set", "volume.spacing_mm=0.1")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_device_is_not_there_and_that_is_exit_code_4(self):
        found = self.refused(self.quick([("push_N = 20", "kind = \"device\"")]), 4, "needs a force device")
        self.assertEqual(len(found), 1)
        self.assertRegex(found[0], PLACE)

    def test_a_fault_of_the_input_outweighs_a_device_that_is_not_there(self):
        self.assertEqual(len(self.refused(self.quick([("push_N = 20", "kind = \"device\"\npush_N = -1")]), 2, "needs a force device", "push_N = -1")), 2)

    def test_the_shipped_scene_is_sound(self):
        result = run("check", "parietal")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"parietal.toml: ok; 7.04 mm of bone along the axis, 0.0 degrees off its normal\n$")

    def test_check_prints_every_fault(self):
        scene = self.quick([("spacing_mm = 0.2", "spacing = 0.2"), ("push_N = 20", "push_N = -1"), ("[record]", "[recrod]")])
        self.assertEqual(len(self.refused(scene, 2)), 3)

    def test_a_simd_level_that_is_none_is_one_line(self):
        for arguments in (["drill", QUICK, "--out", self.folder / "never"], ["explain", QUICK], ["replay", self.folder / "none.sqlite"],
                          ["cost", "contact"]):
            result = run(*arguments, "--simd", "mmx")
            self.assertEqual((result.returncode, result.stdout, len(lines(result.stderr))), (2, "", 1), result.stderr)
            self.assertIn("mmx", result.stderr)
            self.assertIn("sse4", result.stderr, "what may be written instead")
        self.assertFalse((self.folder / "never").exists())

    def test_missing_files(self):
        result = run("drill", self.folder / "none.toml", "--out", self.folder / "never")
        self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1))
        result = run("drill", QUICK, "--restore", self.folder / "none.vdb", "--out", self.folder / "never")
        self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        self.assertFalse((self.folder / "never").exists())
        self.assertEqual(run("replay", self.folder / "none.sqlite").returncode, 2)

    def test_an_axis_that_misses_bone(self):
        self.refused(self.quick([("entry_mm = [0, 0, 0]", "entry_mm = [40, 0, 0]")]), 2, "mm right; bone begins at entry_mm = [")

    def check_refuses(self, scene, *needles, sets=()):
        result = run("check", scene, *[a for s in sets for a in ("--set", s)])
        self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
        for line in lines(result.stderr):
            self.assertRegex(line, r"^(--set \S+|\S+:\d+:\d+): ")
        for needle in needles:
            self.assertIn(needle, result.stderr)

    def test_an_approach_from_inside_the_skull_is_an_error_with_the_start_of_the_opposite_one(self):
        self.check_refuses("parietal", "leaves it: it meets dura or brain before the entry; start at entry_mm = [", "axis = [0.000, 0.000, -1.000]",
                           sets=["approach.entry_mm=[0,0,-7]", "approach.axis=[0,0,1]"])

    def test_ras_given_for_lps_is_named(self):
        # A slab of bone that lies left and behind of the origin, as one side of a head does.
        size, low, high = 40, 10, 20
        layer = {True: struct.pack("<h", 1000) * size * size, False: struct.pack("<h", -1000) * size * size}
        (self.folder / "slab.bin").write_bytes(b"".join(layer[low <= k < high] for k in range(size)))
        (self.folder / "slab.toml").write_text(f"data = \"slab.bin\"\ntype = \"int16\"\nbyte_order = \"little\"\ndims = [{size}, {size}, {size}]\n"
                                               "spacing_mm = [1, 1, 1]\norigin_mm = [30, 20, 0]\nquantity = \"hounsfield\"\n")
        scene = self.quick([("source = \"phantom:plate\"\nspacing_mm = 0.2\nextent_mm = [8, 8, 3]\nabove_mm = 1.0\nthickness_mm = 1.2",
                             "source = \"slab.toml\"\nspacing_mm = 0.5\nregion_mm = [20, 20, 30]")])
        good = ["approach.entry_mm=[50, 40, 19.5]", "approach.axis=[0.3, 0.1, -0.9]"]
        result = run("check", scene, *[a for s in good for a in ("--set", s)])
        self.assertEqual(result.returncode, 0, result.stderr)
        for entry, axis, what in (("[-50, -40, 19.5]", "[-0.3, -0.1, -0.9]", "entry_mm and axis seem to be RAS"),
                                  ("[-50, -40, 19.5]", "[0, 0, -1]", "entry_mm seems to be RAS")):
            self.check_refuses(scene, what + ", and a scene is LPS: negate x and y; entry_mm = [50, 40, 19.5], axis = [",
                               sets=[f"approach.entry_mm={entry}", f"approach.axis={axis}"])
        # What is wrong for another reason is not taken for RAS.
        other = run("check", scene, "--set", "approach.entry_mm=[500, 40, 19.5]")
        self.assertEqual(other.returncode, 2)
        self.assertNotIn("RAS", other.stderr)

    def test_expectations_are_read_before_the_run_and_judged_after_it(self):
        out = self.folder / "never"
        result = run("drill", QUICK, "--out", out, "--expect", "through, plunge<0.5")
        self.assertEqual((result.returncode, result.stdout, len(lines(result.stderr))), (2, "", 1), result.stderr)
        self.assertIn("needs the unit mm", result.stderr)
        self.assertIn("allowed: through, faulted, carved", run("drill", QUICK, "--out", out, "--expect", "thru").stderr)
        self.assertFalse(out.exists())
        for terms, code, needle in (("through, plunge<99mm, peak-force>1N", 0, None), ("through, plunge<0.001mm", 3, "expected plunge<0.001mm: plunge is "),
                                    ("stopped-short", 3, "expected stopped-short: the result is drilled-through: ")):
            result = run("drill", QUICK, "--out", self.folder / "out", "--quiet", "--expect", terms)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(len(lines(result.stderr)), 1 if needle else 0, result.stderr)
            if needle:
                self.assertIn(needle, result.stderr)

    def test_result_is_the_same_in_summary_report_and_on_the_last_line(self):
        for sets, name in ((["duration_s=0.3"], "did-not-cut"), (["duration_s=0.8"], "stopped-short"), ([], "drilled-through")):
            out = self.folder / name
            result = run("drill", QUICK, "--out", out, *[a for s in sets for a in ("--set", s)])
            self.assertEqual(result.returncode, 0, result.stderr)
            summary = json.loads((out / "summary.json").read_text())
            self.assertEqual(summary["result"], name, summary["reason"])
            last = f"result: {name}: {summary['reason']}" + ("; flags: " + ", ".join(summary["flags"]) if summary["flags"] else "")
            self.assertEqual(lines(result.stderr)[-1], last)
            self.assertIn(f"Result: {name} (", (out / "report.html").read_text())
            self.assertEqual(bool(summary["warnings"]), name != "drilled-through")

    def test_an_output_that_cannot_be_written(self):
        blocker = self.folder / "file"
        blocker.write_text("a file where a folder is asked for")
        result = run("drill", QUICK, "--out", blocker / "out", "--quiet")
        self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        self.assertIn(str(blocker), result.stderr)
        result = run("drill", QUICK, "--out", "/proc/no_such_place", "--quiet")  # not even root may
        self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        self.assertIn("/proc/no_such_place", result.stderr)

    def test_faulty_tools_are_named_with_their_place(self):
        cases = [("diameter_mm = 2", "diameter_mm = -2", "diameter_mm"), ("diameter_mm = 2", "diameter = 2", "diameter_mm"),
                 ("erosion_factor = 0.05", "erosion_factor = nan", "erosion_factor"), ("shape = \"cylinder\"", "shape = \"cilinder\"", "cylinder")]
        for old, new, needle in cases:
            with self.subTest(new=new):
                scene = self.quick()
                tool = self.folder / "pin_2mm.toml"
                tool.write_text(tool.read_text().replace(old, new))
                for line in self.refused(scene, 2, needle):
                    self.assertTrue(line.startswith(str(tool)), line)
                    self.assertRegex(line, PLACE)

    def test_usage(self):
        alone = run()  # a window in which to choose needs a display
        self.assertEqual((alone.returncode, len(lines(alone.stderr))), (4, 1), alone.stderr)
        for arguments in (["dril"], ["drill"], ["drill", QUICK, "--no-such-option"], ["render", QUICK, "--size", "big", "--image", self.folder / "x.png"]):
            result = run(*arguments)
            self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        self.assertFalse((self.folder / "x.png").exists())


if __name__ == "__main__":
    main()
