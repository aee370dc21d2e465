"""What a run leaves: bone that stays drilled, what made it, its rows for other programs, and its comparison with another run.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import csv
import io
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from program_support import lines, main, PROGRAM, QUICK, run, SCENES, SOURCE, WithFolder, without_display

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


class Compare(WithFolder):
    def setUp(self):
        super().setUp()
        self.runs = [self.folder / "soft", self.folder / "hard"]
        for out, push in zip(self.runs, (15, 25)):
            self.assertEqual(run("drill", QUICK, "--out", out, "--quiet", "--set", f"hand.push_N={push}").returncode, 0)

    def test_a_table_a_plot_and_differences(self):
        out = self.folder / "compared"
        result = run("compare", *self.runs, "--out", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = {line[2:].split("  ")[0]: line for line in result.stdout.splitlines()[1:]}
        summaries = [json.loads((folder / "summary.json").read_text()) for folder in self.runs]
        peaks = [summary["drilling"]["peak_force_N"] for summary in summaries]
        self.assertTrue(rows["peak_force_N"].startswith("* "))
        self.assertEqual(rows["peak_force_N"].split()[2:], [f"{peaks[0]:.5g}", f"{peaks[1]:.5g}", f"{peaks[1] - peaks[0]:+.4g}"])
        self.assertTrue(rows["thickness_mm"].startswith("  "))
        page, plot = (out / "compare.html").read_text(), (out / "compare.svg").read_text()
        self.assertIn("Depth (mm)", plot)
        for folder in self.runs:
            self.assertIn(folder.name, page)
        self.assertTrue((out / "after_difference.png").exists())
        # The first run's picture once, and of a run that differs its picture and the difference; else a sentence.
        images, same = 0, []
        for picture in self.runs[0].glob("*.png"):
            if picture.read_bytes() == (self.runs[1] / picture.name).read_bytes():
                same.append(picture.stem)
                images += 1
            else:
                images += 3
            self.assertEqual((out / f"{picture.stem}_difference.png").exists(), picture.stem not in same, picture.stem)
        self.assertEqual(page.count("<img "), images)
        self.assertEqual(re.findall(r"<p>(\w+): no difference between ", page), sorted(same))
        self.assertLess(page.index("<h2>Figures</h2>"), page.index("<h2>Curves</h2>"))
        self.assertLess(page.index("<h2>Curves</h2>"), page.index("<h2>Pictures</h2>"))

    def test_pictures_of_another_bone_are_not_compared_and_those_at_another_voxel_size_are(self):
        for key, value, same in (("thickness_mm", "1.6", False), ("spacing_mm", "0.25", True)):
            other, out = self.folder / key, self.folder / f"compared_{key}"
            result = run("drill", QUICK, "--out", other, "--quiet", "--set", f"volume.{key}={value}", "--set", "duration_s=0.3")
            self.assertEqual(result.returncode, 0, result.stderr)
            result = run("compare", self.runs[0], other, "--out", out)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual((out / "before_difference.png").exists(), same, key)
            self.assertEqual(f"{other}: warning: another bone than that of {self.runs[0]}" in result.stderr, not same, result.stderr)
            self.assertEqual("another bone than that of" in (out / "compare.html").read_text(), not same)

    def test_each_override_that_differs_is_a_row_and_none_is_cut(self):
        long = "[" + ", ".join(["0.123456789"] * 3 + ["0.5"] * 20) + "]"
        overrides = [["hand.push_N=15", "duration_s=6", "contact.rate_hz = 500"],
                     ["hand.push_N=25", "duration_s=6", "contact.rate_hz=500", "unset display", "erosion.seed=1", "erosion.seed=2", f"tool.axis={long}"]]
        for folder, changes, factor in zip(self.runs, overrides, (0.02, 0.03)):
            path = folder / "summary.json"
            summary = json.loads(path.read_text())
            summary["provenance"]["overrides"] = changes
            summary["provenance"]["tool_overrides"] = [f"region.pin.erosion_factor={factor}"] + (["region.pin.rake=1"] if factor > 0.02 else [])
            path.write_text(json.dumps(summary))
        # A third run without any: bit, spin and push are those that it had.
        third = self.folder / "third"
        shutil.copytree(self.runs[0], third)
        summary = json.loads((third / "summary.json").read_text())
        summary["provenance"]["overrides"] = summary["provenance"]["tool_overrides"] = []
        summary["tool"].update(name="other_bit", push_N=18.0)
        (third / "summary.json").write_text(json.dumps(summary))
        result = run("compare", *self.runs, third)
        self.assertEqual(result.returncode, 0, result.stderr)
        table = [re.split(r"  +", line.strip()) for line in result.stdout.splitlines()]
        rows = {row[0].removeprefix("* "): row[1:] for row in table}
        self.assertEqual(rows["hand.push_N"], ["15", "25", "18"])
        self.assertEqual(rows["tool.name"], ["pin_2mm", "pin_2mm", "other_bit"])
        self.assertEqual(rows["scene file duration_s"], ["6", "6", "scene's"])
        self.assertEqual(rows["contact.rate_hz"], ["500", "500", "scene's"])
        self.assertEqual(rows["scene file display"], ["scene's", "left out", "scene's"])
        self.assertEqual(rows["erosion.seed"], ["scene's", "2", "scene's"])
        self.assertEqual(rows["tool.axis"], ["scene's", long, "scene's"])
        self.assertEqual(rows["tool file region.pin.erosion_factor"], ["0.02", "0.03", "tool's"])
        self.assertEqual(rows["tool file region.pin.rake"], ["tool's", "1", "tool's"])
        self.assertNotIn("overrides", rows)
        self.assertNotIn("tool.spin_rpm", rows, "no run differs in it")
        # Two runs that share an override: no row.
        pair = run("compare", *self.runs).stdout
        self.assertNotIn("contact.rate_hz", pair)
        self.assertNotIn("tool.name", pair)
        settings = [one["settings"] for one in json.loads(run("compare", *self.runs, "--json").stdout)["runs"]]
        self.assertEqual([one["hand.push_N"] for one in settings], ["15", "25"])

    def test_what_says_who_when_and_how_fast_comes_last_and_the_feed_is_there(self):
        result = run("compare", *self.runs)
        names = [line[2:].split("  ")[0] for line in result.stdout.splitlines()[1:]]
        last = [n for n, name in enumerate(names) if name in ("program", "machine", "date", "wall_s") or name.startswith("hash of ")]
        self.assertGreater(len(last), 6)
        self.assertEqual(last, list(range(len(names) - len(last), len(names))), names)
        row = next(line for line in result.stdout.splitlines() if "feed_mm_per_s" in line).split()
        drilling = [json.loads((folder / "summary.json").read_text())["drilling"] for folder in self.runs]
        self.assertEqual(row[2:4], [f"{one['depth_mm'] / one['breakthrough_s']:.5g}" for one in drilling])
        path = self.runs[0] / "summary.json"
        summary = json.loads(path.read_text())
        summary["drilling"]["breakthrough_s"] = None
        path.write_text(json.dumps(summary))
        row = next(line for line in run("compare", *self.runs).stdout.splitlines() if "feed_mm_per_s" in line).split()
        self.assertEqual(row[2], "-")

    def test_a_run_equals_itself(self):
        result = run("compare", self.runs[0], self.runs[0] / "summary.json", "--json")
        runs = json.loads(result.stdout)["runs"]
        self.assertEqual((runs[0]["facts"], runs[0]["figures"]), (runs[1]["facts"], runs[1]["figures"]))
        out = self.folder / "same"
        run("compare", self.runs[0], self.runs[0], self.runs[0], "--out", out)
        page = (out / "compare.html").read_text()
        self.assertIn("no difference", page)
        self.assertEqual(page.count("<img "), len(list(self.runs[0].glob("*.png"))), "each picture once")

    def test_booleans_are_rows(self):
        result = run("compare", *self.runs)
        rows = {line[2:].split("  ")[0]: line for line in result.stdout.splitlines()[1:]}
        for name in ("axis_open_at_start", "drilled_before"):
            self.assertEqual(rows[name].split()[1:], ["false", "false"], name)
        summary = json.loads((self.runs[1] / "summary.json").read_text())
        summary["drilling"]["axis_open_at_start"] = True
        (self.runs[1] / "summary.json").write_text(json.dumps(summary))
        rows = {line[2:].split("  ")[0]: line for line in run("compare", *self.runs).stdout.splitlines()[1:]}
        self.assertEqual(rows["axis_open_at_start"].split(), ["*", "axis_open_at_start", "false", "true"])

    def test_long_cells_go_on_below_broken_between_words_or_characters(self):
        path = self.runs[1] / "summary.json"
        summary = json.loads(path.read_text())
        for title in ("ä" * 60, "x" + "ä" * 60, "xy" + "骨" * 100, "骨" * 44, "😀" * 45, "nine words " * 9 + "end", "ä" * 44 + " end"):
            path.write_text(json.dumps({**summary, "title": title}))
            result = subprocess.run([PROGRAM, "compare", *self.runs], capture_output=True, timeout=60, env=without_display())
            self.assertEqual(result.returncode, 0, result.stderr)
            lines = result.stdout.decode("utf-8").splitlines()
            first = next(n for n, line in enumerate(lines) if line.startswith("* title"))
            begin = lines[0].index(str(self.runs[1])[:41])
            cells = [lines[first][begin:]]
            for line in lines[first + 1:]:
                if line[:begin].strip():
                    break
                cells.append(line[begin:])
            between = " " if " " in title else ""
            self.assertEqual(between.join(cell.strip() for cell in cells), title)
            self.assertLessEqual(max(len(cell) for cell in cells), 44)

    def test_a_damaged_summary_is_named_and_the_others_are_compared(self):
        third, path = self.folder / "third", self.runs[1] / "summary.json"
        shutil.copytree(self.runs[0], third)
        table = run("compare", self.runs[0], third)
        self.assertEqual(table.returncode, 0, table.stderr)
        whole = path.read_bytes()
        for data in (b"", b"no JSON", whole[: len(whole) // 2], b"[1]", b'{"schema": 1}'):
            with self.subTest(data[:20]):
                path.write_bytes(data)
                result = run("compare", self.runs[0], self.runs[1], third)
                self.assertEqual((result.returncode, result.stdout), (2, table.stdout), result.stderr)
                self.assertEqual(len(lines(result.stderr)), 1, result.stderr)
                self.assertTrue(result.stderr.startswith(f"{path}: is not a summary.json of burrhole drill, or a damaged one"), result.stderr)
                alone = run("compare", self.runs[0], self.runs[1])
                self.assertEqual((alone.returncode, alone.stdout, len(lines(alone.stderr))), (2, "", 1), alone.stderr)
        # A path without results is a mistake of the call: nothing is compared.
        typed = run("compare", self.runs[0], self.folder / "nowhere", third)
        self.assertEqual((typed.returncode, typed.stdout), (2, ""), typed.stderr)

    def test_a_damaged_session_is_named_and_the_rest_is_compared(self):
        session = self.runs[1] / "session.sqlite"
        whole = session.read_bytes()
        table = run("compare", *self.runs).stdout
        for name, data in (("cut", whole[: len(whole) // 2]), ("no session", b"these are notes")):
            with self.subTest(name):
                session.write_bytes(data)
                out = self.folder / "compared"
                result = run("compare", *self.runs, "--out", out)
                self.assertEqual((result.returncode, result.stdout), (2, table), result.stderr)
                reported = [line for line in lines(result.stderr) if line.startswith(str(self.runs[1]))]
                self.assertEqual(len(reported), 1, result.stderr)
                self.assertIn("session cannot be read", reported[0])
                self.assertIn("without curves", reported[0])
                self.assertIn("cannot be read", (out / "compare.html").read_text())
                if shutil.which("gnuplot"):
                    self.assertTrue("Depth (mm)" in (out / "compare.svg").read_text(), "the curves of the other run are there")
                shutil.rmtree(out)

    def test_a_damaged_picture_is_named_and_the_rest_is_compared(self):
        pictures = sorted(self.runs[1].glob("*.png"))
        pictures[0].write_bytes(pictures[0].read_bytes()[:100])
        out = self.folder / "compared"
        result = run("compare", *self.runs, "--out", out)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(pictures[0].name, result.stderr)
        self.assertIn("peak_force_N", result.stdout)
        page = (out / "compare.html").read_text()
        self.assertNotIn(f">{pictures[0].stem}: ", page)
        for picture in pictures[1:]:
            self.assertEqual(page.count(f"<figcaption>{picture.stem}: {self.runs[0]}<"), 1)

    def test_what_is_no_run_is_named(self):
        result = run("compare", self.runs[0], self.folder / "nowhere")
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("nowhere: holds no results", result.stderr)
        self.assertEqual(run("compare", self.runs[0]).returncode, 2)


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
