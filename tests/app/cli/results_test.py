"""What a run leaves: bone that stays drilled, what made it, and its rows for other programs.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import csv
import io
import json
import math
import re
import shutil
import subprocess
import sys
import unittest

from program_support import lines, main, QUICK, run, SCENES, SOURCE, WithFolder

sys.path.insert(0, str(SOURCE / "tests" / "support"))
import session_blocks  # noqa: E402
import sqlite3  # noqa: E402

SYSTEM_PYTHON = "/usr/bin/python3"


def snippets():
    """The Python blocks of docs/session.md."""
    return re.findall(r"^```python\n(.*?)^```", (SOURCE / "docs" / "session.md").read_text(), re.MULTILINE | re.DOTALL)


class Drilled(WithFolder):
    """A hole of an earlier run, by bone.vdb as the source and by --restore, with the shipped defaults of a scene."""

    def setUp(self):
        super().setUp()
        self.first = self.folder / "first"
        result = run("drill", QUICK, "--no-pictures", "--out", self.first, "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.summary = json.loads(result.stdout)
        self.assertEqual(self.summary["result"], "drilled-through")

    def again(self, *arguments):
        out = self.folder / "again"
        result = run("drill", QUICK, "--no-pictures", "--out", out, "--json", "--force", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), result.stderr, (out / "report.html").read_text()

    def test_a_finished_hole_is_no_result_of_the_next_run(self):
        for arguments in (("--restore", self.first / "bone.vdb"), ("--set", f"volume.source={self.first / 'bone.vdb'}", "--unset", "volume.spacing_mm",
                                                                 "--unset", "volume.extent_mm", "--unset", "volume.above_mm", "--unset", "volume.thickness_mm")):
            with self.subTest(arguments[0]):
                summary, errors, report = self.again(*arguments)
                drilling = summary["drilling"]
                self.assertTrue(drilling["axis_open_at_start"])
                self.assertEqual(summary["result"], "did-not-cut")
                self.assertIn("no bone was on the axis at the start", summary["reason"])
                for key in ("breakthrough_s", "depth_mm", "hole_diameter_mm", "inner_diameter_mm", "passed_s"):
                    self.assertIsNone(drilling[key], key)
                self.assertIsNone(drilling["cleared_share"])
                self.assertAlmostEqual(drilling["plunge_mm"], drilling["reached_mm"] - drilling["thickness_mm"], places=9)
                self.assertLess(drilling["removed_mass_mm3"], 0.02 * self.summary["drilling"]["removed_mass_mm3"])
                self.assertEqual(errors.count("no bone is on the axis at the start"), 1)
                self.assertIn("no bone is on the axis at the start", report)
                self.assertTrue(summary["provenance"]["drilled_before"])

    def test_bone_that_a_reset_brought_back_counts_as_there_before(self):
        inputs = self.folder / "inputs.toml"
        inputs.write_text('[[input]]\ntime_s = 0.01\nkind = "reset"\n')
        summary, _, _ = self.again("--restore", self.first / "bone.vdb", "--inputs", inputs)
        drilling, fresh = summary["drilling"], self.summary["drilling"]
        self.assertEqual(summary["hash"]["voxels"], self.summary["hash"]["voxels"])
        self.assertEqual(summary["result"], "drilled-through")
        self.assertFalse(drilling["axis_open_at_start"])
        for key in ("removed_mass_mm3", "hole_diameter_mm", "inner_diameter_mm"):
            self.assertAlmostEqual(drilling[key], fresh[key], places=9, msg=key)

    def test_a_reset_that_is_undone_leaves_the_open_axis(self):
        inputs = self.folder / "inputs.toml"
        inputs.write_text('[[input]]\ntime_s = 0.01\nkind = "reset"\n[[input]]\ntime_s = 0.02\nkind = "undo"\n')
        summary, _, _ = self.again("--restore", self.first / "bone.vdb", "--inputs", inputs)
        self.assertTrue(summary["drilling"]["axis_open_at_start"])
        self.assertIsNone(summary["drilling"]["breakthrough_s"])
        self.assertLess(summary["drilling"]["removed_mass_mm3"], 0.02 * self.summary["drilling"]["removed_mass_mm3"])

    def test_a_part_of_a_hole_counts_only_what_the_run_removes(self):
        half = self.folder / "half"
        before = json.loads(run("drill", QUICK, "--no-pictures", "--out", half, "--json", "--quiet", "--set", "duration_s=0.6").stdout)["drilling"]
        self.assertGreater(before["removed_mass_mm3"], 0.1)
        summary, _, _ = self.again("--restore", half / "bone.vdb")
        self.assertFalse(summary["drilling"]["axis_open_at_start"])
        self.assertIsNotNone(summary["drilling"]["breakthrough_s"])
        bone = self.folder / "again" / "bone.vdb"
        whole = self.removed_mass(bone)
        # Conservation: what both runs removed is what is missing in the end. Figures are sums of the same voxels in double precision.
        if whole is not None:
            self.assertAlmostEqual(before["removed_mass_mm3"] + summary["drilling"]["removed_mass_mm3"], whole, delta=1e-3)

    def removed_mass(self, bone):
        if subprocess.run([SYSTEM_PYTHON, "-c", "import pyopenvdb, numpy"], capture_output=True).returncode:
            return None
        result = subprocess.run([SYSTEM_PYTHON, "-c", snippets()[1], bone.parent], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        return float(re.search(r"([\d.]+) mm3 of bone removed", result.stdout)[1])

    def test_bone_vdb_as_a_source_shows_its_hole(self):
        pictures = []
        for name, sets in (("as_loaded", ()), ("drilled", ("--set", f"volume.source={self.first / 'bone.vdb'}", "--unset", "volume.spacing_mm",
                                                           "--unset", "volume.extent_mm", "--unset", "volume.above_mm", "--unset", "volume.thickness_mm")),
                           ("restored", ("--restore", self.first / "bone.vdb"))):
            picture = self.folder / f"{name}.png"
            # A file is taken for a scan of a patient: directions and assumed brain are shown.
            result = run("render", QUICK, "--image", picture, "--size", "160x120", "--no-tool", "--set", "display.orientation_mark=false",
                         "--set", "display.assumed_brain=false", *sets)
            self.assertEqual(result.returncode, 0, result.stderr)
            pictures.append(picture.read_bytes())
        self.assertNotEqual(pictures[0], pictures[1], "the hole is not shown")
        self.assertEqual(pictures[1], pictures[2], "a source and a checkpoint show the same bone")

    def test_import_reports_the_hole_and_keeps_it(self):
        copy = self.folder / "copy.vdb"
        report = json.loads(run("import", self.first / "bone.vdb", "--volume", copy, "--json").stdout)
        removed = self.summary["volume"]["bone_voxels"] - report["bone"]["voxels"]
        self.assertGreater(removed, 0)
        self.assertIn(f"the bone was drilled before it was saved: {removed} of its bone voxels are removed", report["assumed"])
        self.assertEqual(json.loads(run("import", copy, "--json").stdout)["bone"]["voxels"], report["bone"]["voxels"])

    def test_changes_alone_are_no_source_and_the_message_says_what_to_do(self):
        changes = self.folder / "changes"
        run("drill", QUICK, "--no-pictures", "--out", changes, "--set", "output.whole_bone=false", "--set", "duration_s=0.3", "--quiet")
        result = run("import", changes / "bone.vdb")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--restore", result.stderr)


class Replaced(WithFolder):
    def test_a_replay_whose_bone_was_replaced_says_so(self):
        bone, out = self.folder / "source.vdb", self.folder / "out"
        thick = self.folder / "thick"
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", thick, "--quiet", "--set", "duration_s=0.05", "--set", "volume.thickness_mm=1.4").returncode, 0)
        half = self.folder / "half"
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", half, "--quiet", "--set", "duration_s=0.05").returncode, 0)
        shutil.copy(half / "bone.vdb", bone)
        result = run("drill", QUICK, "--no-pictures", "--out", out, "--quiet", "--set", "duration_s=0.3", "--set", f"volume.source={bone}", "--unset",
                     "volume.spacing_mm", "--unset", "volume.extent_mm", "--unset", "volume.above_mm", "--unset", "volume.thickness_mm")
        self.assertEqual(result.returncode, 0, result.stderr)
        same = run("replay", out / "session.sqlite", "--quiet")
        self.assertEqual((same.returncode, same.stderr), (0, ""), same.stdout)
        self.assertRegex(same.stdout, r"(?m)^volume +recorded [0-9a-f]{16} +replayed [0-9a-f]{16} +same$")
        shutil.copy(thick / "bone.vdb", bone)
        other = run("replay", out / "session.sqlite", "--quiet")
        self.assertEqual(other.returncode, 3, other.stderr)
        self.assertRegex(other.stdout, r"(?m)^volume +recorded [0-9a-f]{16} +replayed [0-9a-f]{16} +DIFFERENT$")
        self.assertEqual(len(lines(other.stderr)), 1, other.stderr)
        self.assertIn(f"{bone}: is not the bone of the recorded run", other.stderr)
        # Of a generated bone nothing is read.
        self.assertNotIn("volume ", run("replay", half / "session.sqlite", "--quiet").stdout)


class Provenance(WithFolder):
    def test_a_session_names_no_folder_that_its_replay_does_not_need(self):
        out = self.folder / "run"
        scene = self.folder / "scene.toml"
        shutil.copy(SCENES / "pin_2mm.toml", self.folder)
        shutil.copy(QUICK, scene)
        drill = ("drill", scene, "--no-pictures", "--quiet", "--set", "duration_s=0.1", "--out")
        self.assertEqual(run(*drill, self.folder / "before").returncode, 0)
        plan = self.folder / "plan.mrk.json"
        self.assertEqual(run("export", scene, "-o", plan, "--quiet").returncode, 0)
        scene.write_text(re.sub(r"(?m)^(entry_mm|axis) = .*\n", "", scene.read_text()).replace("[approach]\n", '[approach]\nmarkups = "plan.mrk.json"\n'))
        result = run(*drill, out, "--restore", self.folder / "before" / "bone.vdb")
        self.assertEqual(result.returncode, 0, result.stderr)
        session = out / "session.sqlite"
        self.assertNotIn(str(self.folder).encode(), session.read_bytes())
        self.assertIn(b"plan.mrk.json", session.read_bytes())
        again = run("replay", session, "--quiet")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_results_name_what_made_them_and_no_folder(self):
        out = self.folder / "run"
        scene = self.quick()
        result = run("drill", scene, "--no-pictures", "--out", out, "--json", "--quiet", "--set", "duration_s=0.3", "--set", f"tool.name={self.folder / 'pin_2mm.toml'}",
                     "--set-tool", "region.pin.erosion_factor=0.02", "--set", "tool.erosion_scale=3")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary, report = (out / "summary.json").read_text(), (out / "report.html").read_text()
        made = json.loads(summary)["provenance"]
        self.assertRegex(made["program"], r"^burrhole \d+\.\d+")
        self.assertRegex(made["date"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertTrue(made["machine"])
        self.assertEqual(made["overrides"], ["duration_s=0.3", "tool.name=pin_2mm.toml", "tool.erosion_scale=3", "unset display"])
        self.assertEqual(made["tool_overrides"], ["region.pin.erosion_factor=0.02"])
        self.assertAlmostEqual(made["erosion_factors_per_rev"]["pin"], 0.06, places=12)
        for of in ("scene", "tool", "volume"):
            self.assertRegex(made["hash"][of], r"^[0-9a-f]{16}$")
        for text in (summary, report):
            self.assertNotIn(str(self.folder), text)
            self.assertNotIn("/home/", text)
            self.assertNotIn("/tmp/", text)
        for needle in (made["date"], made["hash"]["volume"], "region.pin.erosion_factor=0.02"):
            self.assertIn(needle, report)

    def test_titles_name_the_tool_in_use(self):
        title = {}
        for tool in ("pin_2mm", "round_burr_2mm"):
            out = self.folder / tool
            result = run("drill", QUICK, "--no-pictures", "--out", out, "--json", "--quiet", "--set", "duration_s=0.05", "--set", f"tool.name={tool}")
            title[tool] = json.loads(result.stdout)["title"]
            self.assertIn(f"<h1>{title[tool]}</h1>", (out / "report.html").read_text())
        self.assertEqual(title["round_burr_2mm"], "Quick plate: Round burr 2 mm")
        self.assertNotEqual(title["pin_2mm"], title["round_burr_2mm"])

    def test_hashes_follow_what_they_are_of(self):
        made = []
        for n, arguments in enumerate(((), ("--set", "hand.seed=7"), ("--set-tool", "region.pin.erosion_factor=0.02"), ("--set", "volume.thickness_mm=1.3"))):
            result = run("drill", QUICK, "--no-pictures", "--out", self.folder / str(n), "--json", "--quiet", "--set", "duration_s=0.05", *arguments)
            made.append(json.loads(result.stdout)["provenance"]["hash"])
        same = [[one[of] == made[0][of] for of in ("scene", "tool", "volume")] for one in made[1:]]
        self.assertEqual(same, [[False, True, True], [True, False, True], [False, True, False]])

    def test_a_changed_tool_is_replayed_from_its_session(self):
        out = self.folder / "run"
        scene = QUICK
        self.assertEqual(run("drill", scene, "--no-pictures", "--out", out, "--quiet", "--set", "duration_s=0.8", "--set-tool", "region[0].erosion_factor=0.02").returncode, 0)
        replayed = run("replay", out / "session.sqlite", "--quiet")
        self.assertEqual(replayed.returncode, 0, replayed.stdout + replayed.stderr)


class Documented(WithFolder):
    def test_every_key_of_summary_json_is_in_its_page_and_no_other(self):
        out = self.folder / "run"
        self.assertEqual(run("drill", QUICK, "--live", "--out", out, "--quiet", "--set", "duration_s=0.3", "--set", "display.size=[64, 48]").returncode, 0)
        summary = json.loads((out / "summary.json").read_text())
        page = (SOURCE / "docs" / "summary.md").read_text()
        rows = {word.split(".")[0].rstrip("[]") for line in page.splitlines() if line.startswith("| `") and line.count("|") >= 4 for word in re.findall(r"`([^`]+)`", line.split("|")[1])}
        self.assertEqual(rows, set(summary), "the top level")
        self.assertEqual(int(re.search(r"\| `schema` \| integer \| (\d+);", page)[1]), summary["schema"])
        named = {word.split(".")[-1] for word in re.findall(r"`([^`]+)`", page)}
        for table in ("provenance", "approach", "volume", "tool", "drilling", "live", "display", "memory", "counters", "hash"):
            self.assertEqual([key for key in summary[table] if key not in named], [], table)
        self.assertEqual([step for step in summary["timing"] if step not in named], [])
        for effect in summary["effects"]:
            self.assertEqual([figure for figure in effect["figures"] or () if figure not in named], [], effect["name"])


class Session(WithFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "run"
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", self.out, "--quiet").returncode, 0)

    def rows(self, stream):
        result = run("session", self.out, "--csv", "--stream", stream)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return list(csv.DictReader(io.StringIO(result.stdout)))

    def test_csv_holds_every_row_as_the_file_does(self):
        rows = self.rows("contact")
        with sqlite3.connect(self.out / "session.sqlite") as database:
            columns = session_blocks.columns(database, "contact")
            ((first, data),) = session_blocks.last_blocks(database, "contact", 1)
            block = session_blocks.decode(data, columns)
        self.assertEqual(len(rows), first + len(block["number"]))
        for n, force in enumerate(block["force_z"]):
            self.assertEqual(float(rows[first + n]["force_z_N"]), force)
            self.assertEqual(float(rows[first + n]["time_s"]), block["hand_tick"][n] / 1000)

    def test_an_overview_and_a_misspelt_stream(self):
        text = run("session", self.out / "session.sqlite").stdout
        for needle in ("stream     contact", "event", "hash       voxels"):
            self.assertIn(needle, text)
        result = run("session", self.out, "--csv", "--stream", "contct")
        self.assertEqual(result.returncode, 2)
        self.assertIn('did you mean "contact"?', result.stderr)

    def test_the_snippets_of_the_docs_read_a_run(self):
        session, bone = snippets()
        summary = json.loads((self.out / "summary.json").read_text())
        result = subprocess.run([sys.executable, "-c", session, self.out], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        forces = [math.hypot(*(float(row[f"force_{axis}_N"]) for axis in "xyz")) for row in self.rows("contact")]
        self.assertEqual(result.stdout, f"{len(forces)} contact steps, largest force {max(forces):.3f} N\n")
        if subprocess.run([SYSTEM_PYTHON, "-c", "import pyopenvdb, numpy"], capture_output=True).returncode:
            self.skipTest("python3-openvdb is not here")
        result = subprocess.run([SYSTEM_PYTHON, "-c", bone, self.out], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        dims = summary["volume"]["dims"]
        self.assertTrue(result.stdout.startswith(f"{dims[0]} x {dims[1]} x {dims[2]} voxels, "), result.stdout)
        removed = float(re.search(r"([\d.]+) mm3", result.stdout)[1])
        self.assertAlmostEqual(removed, summary["drilling"]["removed_mass_mm3"], delta=1e-3)


class Carved(WithFolder):
    def test_a_bone_that_moves_is_carved_and_the_run_can_be_done_again(self):
        result = run("drill", "carved_cucumber", "--no-pictures", "--out", self.folder / "out", "--quiet", "--json", "--expect", "carved")
        self.assertEqual(result.returncode, 0, result.stderr)
        drilling = json.loads(result.stdout)["drilling"]
        self.assertIsNone(drilling["plunge_mm"])
        # Three turns of a groove round a body of 36 mm, 340 mm long: one as wide as the ball of removal, 4.4 mm, and 1 to 1.5 mm deep.
        self.assertTrue(340 * 4.4 * 1.0 * 0.6 < drilling["removed_mass_mm3"] < 340 * 4.4 * 1.5 * 1.4)
        self.assertEqual(run("replay", self.folder / "out" / "session.sqlite").returncode, 0)

    def test_a_bone_that_moves_out_of_reach_is_not_carved(self):
        result = run("drill", "carved_cucumber", "--no-pictures", "--out", self.folder / "out", "--quiet", "--set", "hand.standoff_mm=20",
                     "--expect", "carved")
        self.assertEqual(result.returncode, 3, result.stderr)


if __name__ == "__main__":
    main()
