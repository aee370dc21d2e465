"""burrhole compare: the results of runs side by side, as a table, curves and pictures.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import json
import re
import shutil
import subprocess

from program_support import lines, main, PROGRAM, QUICK, run, WithFolder, without_display


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


if __name__ == "__main__":
    main()
