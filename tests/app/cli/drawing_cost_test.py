"""What drawing costs, as users meet it: quality by a budget, what summary.json tells of the driver, `cost render`, and what is refused.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
QUICK = SOURCE / "tests" / "data" / "scenes" / "quick_plate.toml"
KNOBS = ["step_voxels", "bisections", "finish", "supersample", "resolution"]


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=600, **options)


def lines(text):
    return [line for line in text.splitlines() if line.strip()]


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-drawing-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def render(self, *arguments, **options):
        return run("render", QUICK, "--image", self.folder / "x.png", *arguments, **options)

    def refused(self, code, needle, *arguments, **options):
        """One line that says why, the exit code, and no file."""
        result = self.render(*arguments, **options)
        self.assertEqual((result.returncode, len(lines(result.stderr))), (code, 1), result.stderr)
        self.assertIn(needle, result.stderr)
        self.assertEqual([p for p in self.folder.iterdir() if p.suffix != ""], [])
        return result.stderr


class Quality(WithFolder):
    def test_a_budget_chooses_the_quality_and_says_so_in_one_line(self):
        for budget, needle in (("100000", "within the budget of 100000 ms"), ("0.001", "the lowest quality, over the budget of 0.001 ms")):
            result = self.render("--set", "display.quality=auto", "--set", f"display.budget_ms={budget}")
            self.assertEqual(result.returncode, 0, result.stderr)
            told = [line for line in lines(result.stderr) if line.startswith("quality: ")]
            self.assertEqual(len(told), 1, result.stderr)
            self.assertIn(needle, told[0])
            self.assertRegex(told[0], r"^quality: step [\d.]+ voxel, \d+ bisections, .*rays a pixel, resolution [\d.]+: about [\d.e+]+ ms a picture, ")

    def test_a_large_budget_draws_another_picture_than_none_at_all(self):
        pictures = []
        for budget in ("100000", "0.001"):
            self.assertEqual(self.render("--set", "display.quality=auto", "--set", f"display.budget_ms={budget}").returncode, 0)
            pictures.append((self.folder / "x.png").read_bytes())
        self.assertNotEqual(*pictures)

    def test_summary_tells_what_drew_and_with_which_knobs(self):
        fixed = json.loads(run("drill", QUICK, "--out", self.folder / "a", "--json", "--quiet", "--gl", "osmesa", "--set", "duration_s=0.2").stdout)["display"]
        self.assertEqual(fixed["backend"], "osmesa")
        self.assertRegex(fixed["version"], r"^4\.")
        self.assertTrue(fixed["renderer"])
        self.assertEqual(fixed["quality"], dict(zip(KNOBS, [0.5, 5, True, 2, 1.0])))
        self.assertEqual((fixed["budget_ms"], fixed["expected_ms"]), (None, None))
        auto = json.loads(run("drill", QUICK, "--out", self.folder / "b", "--json", "--quiet", "--set", "duration_s=0.2",
                              "--set", "display.quality=auto", "--set", "display.budget_ms=0.001").stdout)["display"]
        self.assertEqual(list(auto["quality"]), KNOBS)
        self.assertLess(auto["quality"]["resolution"], 1.0)
        self.assertAlmostEqual(auto["budget_ms"], 0.001, places=9)
        self.assertGreater(auto["expected_ms"], 0.001)

    def test_knobs_given_are_the_knobs_drawn_with(self):
        pictures = {}
        for name, sets in {"shipped": [], "the same by keys": ["supersample=2", "step_voxels=0.5", "bisections=5", "finish=true", "resolution=1"],
                           "plain": ["finish=false"], "one ray": ["supersample=1"], "half": ["resolution=0.5"], "no bisection": ["bisections=0"]}.items():
            result = self.render(*[a for s in sets for a in ("--set", "display." + s)])
            self.assertEqual(result.returncode, 0, result.stderr)
            pictures[name] = (self.folder / "x.png").read_bytes()
        self.assertEqual(pictures["shipped"], pictures["the same by keys"])
        self.assertEqual(len(set(pictures.values())), len(pictures) - 1)


class Refused(WithFolder):
    def test_faulty_shaders_are_told_by_file_line_and_column(self):
        shaders = self.folder / "shaders"
        shutil.copytree(SOURCE / "shaders", shaders)
        self.assertEqual(self.render("--shader-dir", shaders).returncode, 0)
        (self.folder / "x.png").unlink()
        text = (shaders / "volume.glsl").read_text()
        (shaders / "volume.glsl").write_text(text + "\nfloat nonsense() { return missing; }\n")
        told = self.refused(2, "missing", "--shader-dir", shaders)
        self.assertTrue(told.startswith(f"{shaders / 'volume.glsl'}:{text.count(chr(10)) + 2}:"), told)
        (shaders / "volume.glsl").unlink()
        self.refused(2, "volume.glsl", "--shader-dir", shaders)
        self.refused(2, "/nonexistent", "--shader-dir", "/nonexistent")
        empty = self.folder / "empty"
        empty.mkdir()
        self.refused(2, "holds no shader", "--shader-dir", empty)

    def test_a_driver_that_is_too_old_is_exit_4(self):
        self.refused(4, "4.5", "--gl", "osmesa", env=os.environ | {"MESA_GL_VERSION_OVERRIDE": "3.3"})

    def test_a_picture_that_cannot_be_written_is_exit_2(self):
        (self.folder / "plain").write_text("")
        result = run("render", QUICK, "--image", self.folder / "plain" / "x.png")
        self.assertEqual((result.returncode, len([l for l in lines(result.stderr) if not l.startswith("rendering on ")])), (2, 1), result.stderr)
        self.assertIn(str(self.folder / "plain"), result.stderr)
        self.refused(2, "--size 0x0", "--size", "0x0")

    def test_cost_render_refuses_sizes_and_counts(self):
        for wrong in (["--size", "0x0"], ["--size", "big"], ["--frames", "0"], ["--gl", "glide"]):
            result = run("cost", "render", "--out", self.folder / "never", *wrong)
            self.assertEqual(result.returncode, 2, wrong)
            self.assertIn(wrong[1], result.stderr)
        self.assertFalse((self.folder / "never").exists())


class Cost(WithFolder):
    def test_cost_render_leaves_table_front_page_and_pictures(self):
        result = run("cost", "render", "--out", self.folder, "--size", "64x48", "--frames", "1")
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = list(csv.DictReader((self.folder / "cost.csv").read_text().splitlines()))
        self.assertEqual(list(rows[0]), ["subject", "model", "knob", "setting", "error_name", "error", "unit", "reference", "median_us", "p99_us", "bytes"])
        self.assertEqual({row["subject"] for row in rows}, {"skull patch", "drilled hole"})
        self.assertEqual({row["error_name"] for row in rows}, {"psnr", "ssim", "flip", "time_over_shipped"})
        svg = (self.folder / "render.svg").read_text()
        xml.etree.ElementTree.fromstring(svg)
        self.assertIn("Pareto front of PSNR", svg)
        front = (self.folder / "quality_front.inc").read_text()
        for name in ("kSurfaceFront", "kTranslucentFront"):
            points = re.findall(r"QualityPoint\{\{.*?\}, ([\d.e+]+), ([\d.]+)\}", front[front.index(name):].split("};")[0])
            self.assertGreaterEqual(len(points), 2)
            costs = [float(cost) for cost, _ in points]
            self.assertEqual(costs[0], 1.0)
            self.assertEqual(costs, sorted(costs))
        page = (self.folder / "render.html").read_text()
        self.assertIn("Knob by knob", page)
        self.assertEqual(len(list(self.folder.glob("*.png"))), 8)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as probe:
        if run("render", QUICK, "--image", pathlib.Path(probe) / "probe.png", "--size", "16x16").returncode == 4:
            sys.exit(77)
    unittest.main()
