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
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
SCENES = SOURCE / "tests" / "data" / "scenes"
QUICK = SCENES / "quick_plate.toml"
# Keys of [display] that a picture of a plate shows, and a value that is not their default.
LOOKS = {"tissue": "plain", "normals": "recomputed", "scale_bar": "false", "background_top": "[0, 0, 0]"}
PLACE = re.compile(r"^(?P<file>[^:]+):(?P<line>\d+):(?P<column>\d+): .+")


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def lines(text):
    return [line for line in text.splitlines() if line.strip()]


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-program-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def scene(self, text, name="scene.toml"):
        shutil.copy(SCENES / "pin_2mm.toml", self.folder)
        path = self.folder / name
        path.write_text(text)
        return path

    def quick(self, replace=(), append=""):
        text = QUICK.read_text()
        for old, new in replace:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.scene(text + append)


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
                names = [name for (name,) in database.execute("SELECT name FROM columns ORDER BY position")]
                blocks = database.execute("SELECT data FROM ticks ORDER BY first_row DESC LIMIT 2").fetchall()
        except sqlite3.OperationalError:
            return 0.0
        rows = (dict(zip(names, row)) for (data,) in blocks for row in struct.iter_unpack(f"<{len(names)}d", data))
        return max((math.hypot(row["sent_x"], row["sent_y"], row["sent_z"]) for row in rows), default=0.0)

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
        self.assertGreaterEqual(json.loads(second.stdout)["drilling"]["removed_mm3"], first["drilling"]["removed_mm3"])
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
        self.assertEqual([e["name"] for e in summary["effects"]], ["volume", "hand", "contact"])
        self.assertIsNone(summary["hash"]["image"])
        self.assertEqual(summary["timing"]["erosion"]["count"], 0)
        self.assertEqual(summary["timing"]["frame"]["count"], 0)
        self.assertEqual(summary["drilling"]["removed_mass_mm3"], 0)
        self.assertEqual(sorted(p.name for p in out.iterdir()), ["bone.vdb", "report.html", "summary.json"])

    def test_quiet_says_nothing_and_stdout_stays_empty_without_json(self):
        result = run("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.1", "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_a_picture_of_an_earlier_run_does_not_stay(self):
        for name in ("breakthrough.png", "notes.png"):
            (self.folder / name).write_text("of another day")
        self.assertEqual(run("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.1", "--quiet").returncode, 0)
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
            ([("name = \"pin_2mm\"", "name = \"pin_3mm\"")], "is no tool"),
            ([("[contact]", "[contact]\nmodel = \"mesh\"")], "is not in this version"),
            ([("[contact]", "[contact]\ntool = \"device\"")], "unknown key \"tool\" in [contact]"),
            ([("size = [160, 120]", "method = \"mesh\"")], "is not in this version"),
            ([("[contact]", "[heat]\n[contact]")], "is an effect that is not in this version"),
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
        tool.write_text(tool.read_text().replace("height_mm = 2", "height_mm = 60"))
        found = self.refused(scene, 2, "too large for this bone's voxels", "each edge must be in [5, 256]")
        self.assertRegex(found[0], PLACE)

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
        self.refused(self.quick([("entry_mm = [0, 0, 0]", "entry_mm = [40, 0, 0]")]), 2, "meets no bone")

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
        for arguments in ([], ["dril"], ["drill"], ["drill", QUICK, "--no-such-option"], ["render", QUICK, "--size", "big", "--image", self.folder / "x.png"]):
            result = run(*arguments)
            self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
        self.assertFalse((self.folder / "x.png").exists())


class OtherCommands(WithFolder):
    def test_devices_are_listed_with_where_each_figure_comes_from(self):
        told = run("devices")
        self.assertEqual((told.returncode, told.stderr), (0, ""))
        self.assertIn("falcon", told.stdout)
        listed = json.loads(run("devices", "--json").stdout)
        falcon = next(device for device in listed["devices"] if device["name"] == "falcon")
        self.assertIn("CHAI3D", json.dumps(falcon))
        self.assertEqual({hand["name"] for hand in listed["hands"]}, {"none", "nominal", "light", "firm", "arm"})

    def test_explain_tells_what_runs_and_what_does_not(self):
        plan = json.loads(run("explain", QUICK, "--json").stdout)
        self.assertEqual([e["name"] for e in plan["effects"]], ["volume", "hand", "contact", "erosion", "display", "record"])
        self.assertIn("heat", plan["not_built"])
        self.assertIn("spindle", plan["not_built"])
        self.assertTrue(all(e["time_us"] is None for e in plan["effects"]))
        measured = run("explain", QUICK, "--json", "--measure", cwd=self.folder)
        costs = {e["name"]: e["time_us"] for e in json.loads(measured.stdout)["effects"]}
        self.assertGreater(costs["contact"], 0)
        self.assertEqual(list(self.folder.iterdir()), [], "measuring writes nothing")
        self.assertIn("under a voxel", " ".join(json.loads(run("explain", QUICK, "--json", "--set", "contact.cutting_N_per_m=1e7").stdout)["warnings"]))

    def test_explain_has_a_row_for_a_spindle_and_bytes_by_the_model(self):
        scene = self.quick(append="[spindle]\n")
        measured = json.loads(run("explain", scene, "--json", "--measure", "--set", "duration_s=0.6").stdout)
        self.assertEqual([e["name"] for e in measured["effects"]], ["volume", "hand", "contact", "erosion", "spindle", "display", "record"])
        rows = {e["name"]: e for e in measured["effects"]}
        self.assertGreater(rows["spindle"]["time_us"], 0)
        self.assertGreater(rows["spindle"]["bytes"], 0)
        self.assertIn("1000 rpm free", rows["spindle"]["detail"])
        self.assertRegex(run("explain", scene).stdout, r"(?m)^spindle +simulation +100 Hz")
        self.assertEqual([e["name"] for e in json.loads(run("explain", QUICK, "--json").stdout)["effects"]].count("spindle"), 0)

        def contact_bytes(*sets):
            plan = json.loads(run("explain", QUICK, "--json", *[a for s in sets for a in ("--set", s)]).stdout)
            return next(e["bytes"] for e in plan["effects"] if e["name"] == "contact")
        voxmap, words = contact_bytes("contact.model=voxmap"), contact_bytes("contact.model=gradient-plane")
        records8, records16 = contact_bytes("contact.record_bits=\"8\""), contact_bytes()
        # A voxel's words are 4 bytes, its records 4 or 8 and one of hardness: 4 : 5 : 9 over the density that all copies hold.
        self.assertEqual((records8 - voxmap) * 4, (words - voxmap) * 5)
        self.assertEqual((records16 - voxmap) * 4, (words - voxmap) * 9)
        self.assertIn("rough", " ".join(json.loads(run("explain", QUICK, "--json", "--set", "erosion.subvoxel=false").stdout)["warnings"]))

    def test_render_draws_the_size_asked_for(self):
        image = self.folder / "sub" / "picture.png"
        image.parent.mkdir()
        result = run("render", QUICK, "--image", image, "--size", "64x48", "--cut")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(struct.unpack(">II", image.read_bytes()[16:24]), (64, 48))

    def test_two_eyes_are_one_picture_twice_as_large(self):
        sizes = {"off": (64, 48), "side-by-side": (128, 48), "top-bottom": (64, 96), "anaglyph": (64, 48)}
        for mode, size in sizes.items():
            image = self.folder / f"{mode}.png"
            result = run("render", QUICK, "--image", image, "--size", "64x48", "--set", f"display.stereo={mode}")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(struct.unpack(">II", image.read_bytes()[16:24]), size)
        self.assertNotEqual((self.folder / "off.png").read_bytes(), (self.folder / "anaglyph.png").read_bytes())
        result = run("check", QUICK, "--set", "display.stereo=quad-buffered")
        self.assertEqual(result.returncode, 2)
        self.assertIn("not in this version", result.stderr)

    def test_slices_through_the_tip_need_no_opengl(self):
        image = self.folder / "slices.png"
        arguments = ("render", QUICK, "--image", image, "--size", "240x180", "--slices-through-tip", "--depth-mm", "1")
        result = run(*arguments, env={**os.environ, "GALLIUM_DRIVER": "no such driver"})
        self.assertEqual(result.returncode, 0, result.stderr)
        width, height = struct.unpack(">II", image.read_bytes()[16:24])
        self.assertGreater(width, 3 * 80)
        self.assertGreater(height, 80)
        self.assertNotEqual(run("render", QUICK, "--depth-mm", "500").returncode, 0)

    def test_bone_is_drawn_as_the_scene_has_it(self):
        ways = {"surface": [], "slices": ["--method", "slices"], "slices by key": ["--set", "display.method=slices"],
                "uncorrected": ["--set", "display.method=slices", "--set", "display.opacity_correction=false", "--set", "display.slices_per_voxel=0.5"],
                "translucent": ["--set", "display.shading=translucent"],
                **{f"{key} = {value}": ["--set", f"display.{key}={value}"] for key, value in LOOKS.items()},
                "cut at a plane": ["--set", "display.cut=plane", "--set", "display.cut_point_mm=[0, 0, 0]", "--set", "display.cut_normal=[0, -1, 0]"],
                "slices of one colour": ["--method", "slices", "--set", "display.label_colours=false"],
                "tool deeper": ["--depth-mm", "1"],
                "denser": ["--set", "display.shading=translucent", "--set", "display.transfer=[{density=0.2, opacity_per_mm=0}, {density=1, opacity_per_mm=2}]"]}
        drawn = {}
        for name, arguments in ways.items():
            image = self.folder / "x.png"
            result = run("render", QUICK, "--image", image, "--size", "64x48", *arguments)
            self.assertEqual(result.returncode, 0, result.stderr)
            drawn[name] = image.read_bytes()
        self.assertEqual(drawn["slices"], drawn["slices by key"])
        self.assertEqual(len(set(drawn.values())), len(drawn) - 1)
        for wrong, needle in ((["display.method=mesh"], "not in this version"), (["display.slices_per_voxel=2"], "slices_per_voxel"),
                              (["display.shading=translucent", "display.transfer=[{density=1, opacity_per_mm=1}, {density=0.5, opacity_per_mm=1}]"], "larger")):
            result = run("check", QUICK, *[a for s in wrong for a in ("--set", s)])
            self.assertEqual(result.returncode, 2, wrong)
            self.assertIn(needle, result.stderr)

    def test_render_refuses_what_makes_no_picture(self):
        for wrong in (["--size", "64"], ["--size", "0x0"], ["--size", "9999x9999"], ["--camera", "1,2"], ["--camera", "0,95,30"], ["--camera", "0,40,0"]):
            with self.subTest(wrong=wrong):
                result = run("render", QUICK, "--image", self.folder / "x.png", *wrong)
                self.assertEqual((result.returncode, len(lines(result.stderr))), (2, 1), result.stderr)
                self.assertIn(wrong[1], result.stderr)
        self.assertEqual(run("render", QUICK, "--image", self.folder / "x.jpg").returncode, 2)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_opengl_comes_from_where_it_is_asked_of(self):
        images = {}
        for backend in ("osmesa", "egl"):
            image = self.folder / f"{backend}.png"
            result = run("render", QUICK, "--image", image, "--size", "64x48", "--gl", backend)
            if result.returncode == 4:  # not here: it says why, in one line
                self.assertEqual(len(lines(result.stderr)), 1, result.stderr)
                continue
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"picture by {backend}: 4.", result.stderr)
            images[backend] = image.read_bytes()
            if "llvmpipe" not in result.stderr:
                images.pop(backend)
        self.assertLessEqual(len(set(images.values())), 1, "software draws other bytes through another back end")

    def test_opengl_that_cannot_be_had_is_one_line_and_exit_code_4(self):
        bare = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        for backend, variable in (("window", {}), ("osmesa", {"GALLIUM_DRIVER": "swrast"})):
            with self.subTest(backend=backend):
                result = run("render", QUICK, "--image", self.folder / "x.png", "--gl", backend, env=bare | variable)
                self.assertEqual((result.returncode, len(lines(result.stderr))), (4, 1), result.stderr)
                self.assertTrue(result.stderr.startswith(backend + ": "), result.stderr)
        self.assertEqual(run("render", QUICK, "--gl", "glide").returncode, 2)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_tools_lists_and_tells(self):
        listed = run("tools").stdout
        for name in ("perforator_14_11", "round_burr_4mm", "acosta_liu_round"):
            self.assertIn(name, listed)
        self.assertEqual({t["name"]: t["haptic_points"] for t in json.loads(run("tools", "--json").stdout)}["acosta_liu_perforator"], 316)
        self.assertIn("inner drill", run("tools", "perforator_14_11").stdout)
        wrong = run("tools", "perforator_14_12")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("perforator_14_11", wrong.stderr)

    def test_a_tool_is_told_in_full_and_as_json(self):
        told = run("tools", "trephine_12mm").stdout
        self.assertIn("plunging", told)
        self.assertIn("20 N, 1000 rpm", told)
        tool = json.loads(run("tools", "trephine_12mm", "--json").stdout)  # one object and nothing else
        self.assertEqual([region["cuts"] for region in tool["regions"]], [True, False, False, False])
        plunge = tool["foretold"]["plunge"]
        # v = (F / K) e s / ln 2 = 0.2 mm * 0.1 * 16.67 / 0.693, over a ring of 12 and 10 mm to the lattice's own few per cent
        self.assertAlmostEqual(plunge["feed_mm_per_s"], 0.2 * 0.1 * 1000 / 60 / math.log(2), delta=1e-4)
        self.assertAlmostEqual(plunge["area_mm2"], math.pi * (36 - 25), delta=1.0)
        self.assertAlmostEqual(plunge["rate_mm3_per_s"], plunge["feed_mm_per_s"] * plunge["area_mm2"], delta=1e-6)
        self.assertEqual(json.loads(run("tools", "craniotome_2_3mm", "--json").stdout)["foretold"]["plunge"]["feed_mm_per_s"], 0)

    def test_a_tool_is_drawn(self):
        if shutil.which("gnuplot") is None:
            self.skipTest("no gnuplot: nothing can be drawn")
        picture = self.folder / "new" / "bit.png"
        result = run("tools", "round_burr_4mm", "--image", picture)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        data = picture.read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", data[16:24]), (1540, 780))
        self.assertFalse([p for p in picture.parent.iterdir() if p != picture])
        for arguments, needle in [(("round_burr_4mm", "--image", "/proc/no_such_place/x.png"), "/proc/no_such_place"),
                                  (("round_burr_4mm", "--image", self.folder / "x.jpg"), ".png"), (("--image", self.folder / "x.png"), "name")]:
            with self.subTest(arguments=arguments):
                result = run("tools", *arguments)
                self.assertEqual((result.returncode, len(lines(result.stderr)), result.stdout), (2, 1, ""), result.stderr)
                self.assertIn(needle, result.stderr)

    def changed_session(self, change):
        """A session whose hand_z in the middle of its last block, where bone is felt, went through `change` (8 bytes to 8 bytes)."""
        run("drill", QUICK, "--out", self.folder, "--set", "duration_s=0.8", "--quiet")
        session = self.folder / "session.sqlite"
        with sqlite3.connect(session) as connection:
            first, data = connection.execute("select first_row, data from ticks order by first_row desc limit 1").fetchone()
            hand_z_of_row = 8 * 2
            row = 8 * connection.execute("select count(*) from columns").fetchone()[0]
            at = len(data) // row // 2 * row + hand_z_of_row
            changed = bytearray(data)
            changed[at:at + 8] = change(data[at:at + 8])
            connection.execute("update ticks set data = ? where first_row = ?", (bytes(changed), first))
        return session

    def test_a_tampered_session_does_not_replay(self):
        for name, change in (("a millimetre", lambda z: struct.pack("<d", struct.unpack("<d", z)[0] + 1e-3)),
                             ("one bit", lambda z: struct.pack("<Q", struct.unpack("<Q", z)[0] ^ 1 << 20))):  # under a picometre
            with self.subTest(name):
                result = run("replay", self.changed_session(change), "--quiet")
                self.assertEqual(result.returncode, 3, result.stdout + result.stderr)
                self.assertIn("DIFFERENT", result.stdout)
        untouched = run("replay", self.changed_session(lambda z: z), "--quiet")
        self.assertEqual(untouched.returncode, 0, untouched.stdout + untouched.stderr)

    def test_a_session_is_all_that_a_replay_needs(self):
        self.assertEqual(run("drill", self.quick(), "--out", self.folder / "out", "--set", "duration_s=0.4", "--quiet").returncode, 0)
        (self.folder / "scene.toml").unlink()
        (self.folder / "pin_2mm.toml").unlink()
        result = run("replay", self.folder / "out" / "session.sqlite", "--quiet")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(result.stdout.count(" same"), 3, result.stdout)

    def test_hard_cases_are_tabled_and_sabotage_is_caught(self):
        out = self.folder / "stability"
        result = run("stability", "--case", "rest", "--model", "surface", "--out", out, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        told = json.loads(result.stdout)
        self.assertFalse(told["failed"])
        self.assertEqual({row["case"] for row in told["rows"]}, {"rest"})
        self.assertEqual(lines((out / "stability.csv").read_text())[0], "case,model,measure,value,bound,pass")
        self.assertEqual(len(lines((out / "stability.csv").read_text())), 1 + len(told["rows"]))
        self.assertIn("rest", (out / "stability.html").read_text())
        self.assertEqual(run("stability", "--case", "rest", "--sabotage", "--out", out).returncode, 0)
        refused = run("stability", "--case", "rst", "--out", out)
        self.assertEqual((refused.returncode, len(lines(refused.stderr))), (2, 1))

    def test_every_command_has_help(self):
        for command in ("drill", "render", "check", "explain", "tools", "replay", "cost", "stability"):
            result = run(command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage", result.stdout)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as probe:
        if run("render", QUICK, "--image", os.path.join(probe, "probe.png"), "--size", "16x16").returncode == 4:
            sys.exit(77)
    unittest.main(verbosity=2)
