"""What is no error and yet not as its user means it is a warning: bone that is no skull, a cutter that meets no bone; and errors of a scan's
keys are at their lines.

Run by ctest with the program's path in BURRHOLE_PROGRAM. Needs no drawing but for one picture; the scans are in $BURRHOLE_DATA.
"""
import json
import os
import pathlib
import re
import unittest

from program_support import lines, QUICK, run, SOURCE, WithFolder

PELVIS = pathlib.Path(os.environ.get("BURRHOLE_DATA", "/none")) / "nifti" / "example_ct.nii.gz"
HEAD = PELVIS.parents[1] / "head_ct_dicom_phantom_1mm"


class NoSpin(WithFolder):
    def test_check_warns_of_a_bit_that_does_not_spin_where_bone_would_be_cut(self):
        warning = "tool.spin_rpm = 0: the bit does not spin, so nothing is cut; set tool.spin_rpm above 0"
        for arguments, warns in ((["--set", "tool.spin_rpm=0"], True), ([], False), (["--set", "tool.spin_rpm=0", "--unset", "erosion"], False)):
            result = run("check", QUICK, *arguments)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(warning in result.stderr, warns, result.stderr)


class Quiet(WithFolder):
    def test_drill_prints_the_same_warnings_with_quiet_and_nothing_else(self):
        """Walls with a roughness of a voxel are a warning of the plan, a plate that is not drilled through is one of the run."""
        rough = ("--set", "erosion.subvoxel=false", "--set", "duration_s=0.05", "--offscreen", "--no-pictures", "--force", "--out", self.folder / "out")
        loud, quiet = run("drill", QUICK, *rough), run("drill", QUICK, *rough, "--quiet")
        for result in (loud, quiet):
            self.assertEqual(result.returncode, 0, result.stderr)
        warned = [line for line in lines(loud.stderr) if ": warning: " in line]
        self.assertTrue([line for line in warned if "roughness of a voxel" in line], loud.stderr)
        self.assertEqual(lines(quiet.stderr), warned)
        self.assertGreater(len(lines(loud.stderr)), len(warned))
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual([line.split(": warning: ", 1)[1] for line in warned], summary["warnings"])


@unittest.skipUnless(PELVIS.is_file() and HEAD.is_dir(), "$BURRHOLE_DATA holds no head, or no pelvis")
class NoSkull(WithFolder):
    """Dura and brain are drawn under the bone of a scan: that is said where the bone does not close round the site."""

    ASSUMED = "layers under the bone are assumed: dura and brain are drawn though the scan does not show them"

    def pelvis(self, region, *more):
        """A scene of the shipped head, on the wing of an ilium."""
        text = (SOURCE / "app" / "scenes" / "head_phantom.toml").read_text()
        text = re.sub(r'(?m)^source = .*$', f'source = "{PELVIS}"', text)
        text = re.sub(r'(?m)^region_mm = .*$', region, text)
        text = re.sub(r'(?m)^entry_mm = .*$', "entry_mm = [-113.0, -161.0, 211.0]", text)
        text = re.sub(r'(?m)^axis = .*$', self.axis(), text)
        return self.scene(text)

    @staticmethod
    def axis():
        result = run("import", PELVIS, "--suggest", "-113,-161,211", "--json", "--quiet")
        return "axis = " + str(json.loads(result.stdout)["suggested"]["axis"])

    def test_a_pelvis_is_no_skull_with_a_region_and_without(self):
        for region in ("region_mm = [46.0, 46.0, 46.0]", ""):
            with self.subTest(region):
                scene = self.pelvis(region)
                result = run("check", scene, "--set", "volume.spacing_mm=1.0")
                self.assertEqual(result.returncode, 0, result.stderr)
                said = [line for line in lines(result.stderr) if self.ASSUMED in line]
                self.assertEqual(len(said), 1, result.stderr)
                self.assertRegex(said[0], r"of the directions from 15 mm below it \d+ % meet bone, nine tenths of them within \d+ mm; in a skull at least 80 %")
                self.assertIn("--set display.assumed_brain=false draws none", said[0])
                quiet = run("check", scene, "--set", "volume.spacing_mm=1.0", "--set", "display.assumed_brain=false")
                self.assertEqual(quiet.returncode, 0, quiet.stderr)
                self.assertNotIn("assumed: dura", quiet.stderr)

    def test_summary_and_report_say_so_too(self):
        out = self.folder / "out"
        result = run("drill", self.pelvis("region_mm = [46.0, 46.0, 46.0]"), "--offscreen", "--out", out, "--quiet", "--set", "volume.spacing_mm=1.0",
                     "--set", "duration_s=0.05", "--set", "display.size=[64, 48]")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(len([line for line in summary["warnings"] if self.ASSUMED in line]), 1, summary["warnings"])
        self.assertLess(summary["volume"]["enclosed_share"], 0.8)
        self.assertIn(self.ASSUMED, (out / "report.html").read_text())

    def test_the_shipped_heads_are_skulls(self):
        for name in ("head_phantom", "cadaver_head", "head", "parietal"):
            with self.subTest(name):
                result = run("check", name, "--set", "volume.spacing_mm=0.5")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertNotIn("assumed: dura", result.stderr)

    def test_a_region_outside_the_scan_is_an_error_at_its_key(self):
        scene = self.pelvis("region_mm = [46.0, 46.0, 46.0]")
        text = re.sub(r'(?m)^entry_mm = .*$', "entry_mm = [900.0, 0.0, 0.0]", scene.read_text())
        scene.write_text(text)
        line = next(n for n, one in enumerate(text.splitlines(), 1) if one.startswith("region_mm"))
        result = run("check", scene)
        self.assertEqual(result.returncode, 2, result.stderr)
        message = next(one for one in lines(result.stderr) if "lies outside the scan" in one)
        self.assertTrue(message.startswith(f"{scene}:{line}:"), message)
        self.assertIn("entry_mm of [approach]", message)
        # A band without bone is that of its key, and too many voxels that of the spacing.
        for key, value in (("bone_hu", "[9000, 9100]"), ("spacing_mm", "0.01")):
            text = re.sub(r'(?m)^entry_mm = .*$', "entry_mm = [-113.0, -161.0, 211.0]", scene.read_text())
            text = re.sub(rf'(?m)^{key} = .*\n', "", text).replace("[volume]\n", f"[volume]\n{key} = {value}\n")
            if key == "spacing_mm":
                text = re.sub(r'(?m)^region_mm = .*\n', "", text)
            other = self.scene(text, "other.toml")
            line = next(n for n, one in enumerate(text.splitlines(), 1) if one.startswith(key))
            result = run("check", other)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertTrue(lines(result.stderr)[0].startswith(f"{other}:{line}:"), result.stderr)


class BuriedCutter(WithFolder):
    """A cutting region inside a passive one of the same bit never meets bone."""

    BODY = """title = "Pin in a sleeve"
[shell]
pitch_mm = 0.2
[[region]]
name = "pin"
shape = "cylinder"
z_mm = {z}
height_mm = 2
diameter_mm = 1
erosion_factor = 0.2
[[region]]
name = "sleeve"
shape = "cylinder"
z_mm = 0
height_mm = 8
diameter_mm = 2
erosion_factor = 0
"""

    def tool(self, z):
        path = self.folder / "sleeve.toml"
        path.write_text(self.BODY.format(z=z).replace("z_mm = 0\n", "z_mm = 0.0\n"))
        return path

    def test_check_drill_and_tools_warn_with_region_and_share(self):
        hidden = self.tool(3)
        needle = 'the cutting region "pin" lies inside the passive region "sleeve", 100 % of its surface'
        for words in (("check", QUICK, "--set", f"tool.name={hidden}"), ("tools", hidden), ("tools", hidden, "--json"),
                      ("drill", QUICK, "--no-pictures", "--out", self.folder / "out", "--set", f"tool.name={hidden}", "--set", "duration_s=0.05")):
            with self.subTest(words[0]):
                result = run(*words)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(len([line for line in lines(result.stderr) if needle in line]), 1, result.stderr)
                if "--json" in words:
                    self.assertEqual([one["covered_share"] for one in json.loads(result.stdout)["regions"]], [1.0, None])
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertTrue(any(needle in line for line in summary["warnings"]), summary["warnings"])

    def test_a_cutter_that_stands_out_is_none(self):
        text = self.BODY.format(z=0).replace('name = "sleeve"\nshape = "cylinder"\nz_mm = 0', 'name = "sleeve"\nshape = "cylinder"\nz_mm = 1')
        path = self.folder / "out.toml"
        path.write_text(text)
        result = run("tools", path)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for name in ("perforator_14_11", "round_burr_5mm", "craniotome_2_3mm"):
            self.assertEqual(run("tools", name).stderr, "", name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
