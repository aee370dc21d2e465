"""Layers of a scan and labels of the user as their users meet them: from the scan or the file to the rows of a run.

Run by ctest with the program's path in BURRHOLE_PROGRAM. The scans of $BURRHOLE_DATA are used where they are there; label volumes are written here.
"""
import contextlib
import json
import os
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import tempfile
import unittest

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
DATA = pathlib.Path(os.environ.get("BURRHOLE_DATA", "/nowhere"))
SIZE = (40, 40, 24)  # voxels of 0.5 mm: a plate of 1000 HU from z = 4 to 7 mm in air


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=500)


def nrrd(path, value, fields="", size=SIZE, edge=0.5):
    header = (f"NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: {size[0]} {size[1]} {size[2]}\n"
              f"space directions: ({edge},0,0) (0,{edge},0) (0,0,{edge})\nendian: little\nencoding: raw\n"
              f"space origin: ({-edge * size[0] / 2},{-edge * size[1] / 2},0)\n{fields}\n")
    voxels = [value(i, j, k) for k in range(size[2]) for j in range(size[1]) for i in range(size[0])]
    path.write_bytes(header.encode() + struct.pack(f"<{len(voxels)}h", *voxels))
    return path


class Labels(unittest.TestCase):
    FIELDS = ("Segment0_LabelValue:=1\nSegment0_Name:=Outer table\nSegment0_Color:=1 0 0\n"
              "Segment1_LabelValue:=5\nSegment1_Name:=Sagittal suture\nSegment1_Color:=0 0.5 1\n")

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-labels-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.scan = nrrd(self.folder / "scan.nrrd", lambda i, j, k: 1000 if 8 <= k < 14 else -1000)
        # The upper half of the plate, and the lower one.
        self.labels = nrrd(self.folder / "plate.seg.nrrd", lambda i, j, k: 1 if k >= 11 else 5 if k >= 7 else 0, self.FIELDS)

    def scene(self, extra):
        shutil.copy(SOURCE / "tests" / "data" / "scenes" / "pin_2mm.toml", self.folder)
        path = self.folder / "scene.toml"
        path.write_text(f"""[volume]
source = "scan.nrrd"
{extra}
[tool]
name = "pin_2mm"
spin_rpm = 1000
erosion_scale = 20
[approach]
entry_mm = [0, 0, 6.75]
[hand]
push_N = 20
ramp_s = 0.2
[contact]
[erosion]
""")
        return path

    def test_labels_have_rows_with_their_names_and_their_volumes_sum_to_what_was_removed(self):
        result = run("drill", self.scene('labels = "plate.seg.nrrd"'), "--out", self.folder / "out", "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        rows = {row["name"]: row for row in summary["layers"]}
        self.assertEqual(list(rows), ["outer table", "Sagittal suture"])
        for row in rows.values():
            self.assertAlmostEqual(row["thickness_mm"], 1.5, delta=0.51)  # the border and both faces lie within a voxel of 0.5 mm
            self.assertGreater(row["time_s"], 0.0)
            self.assertGreater(row["mean_force_N"], 1.0)
            self.assertGreaterEqual(row["peak_force_N"], row["mean_force_N"])
        self.assertAlmostEqual(sum(row["removed_mass_mm3"] for row in rows.values()), summary["drilling"]["removed_mass_mm3"], places=4)
        page = (self.folder / "out" / "report.html").read_text()
        self.assertIn("Layers of bone", page)
        self.assertIn("Sagittal suture", page)

    def test_a_saved_bone_keeps_names_and_drills_alike(self):
        bone = self.folder / "bone.vdb"
        self.assertEqual(run("import", self.scan, "--labels", self.labels, "--volume", bone, "--quiet").returncode, 0)
        hashes = []
        for extra in ('labels = "plate.seg.nrrd"', None):
            scene = self.scene(extra or "")
            more = () if extra else ("--set", f"volume.source={bone}")
            result = run("drill", scene, "--out", self.folder / "out", "--json", "--quiet", "--force", *more)
            self.assertEqual(result.returncode, 0, result.stderr)
            summary = json.loads(result.stdout)
            hashes.append((summary["hash"]["voxels"], summary["hash"]["forces"], [row["name"] for row in summary["layers"]]))
        self.assertEqual(*hashes)

    def test_a_replay_has_the_same_bits(self):
        out = self.folder / "out"
        scene = self.scene('labels = "plate.seg.nrrd"')
        scene.write_text(scene.read_text() + "[record]\n")
        result = run("drill", scene, "--out", out, "--json", "--quiet", "--set", "contact.felt_hardness=0.5", "--set", "contact.label_stiffness={outer_table=0.3}")
        self.assertEqual(result.returncode, 0, result.stderr)
        hashes = json.loads(result.stdout)["hash"]
        again = run("replay", out, "--quiet")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        for name in ("voxels", "forces"):
            self.assertIn(f"replayed {hashes[name]}  same", again.stdout)
        # Sabotage: the label volume is another one now.
        nrrd(self.labels, lambda i, j, k: 1 if k >= 13 else 5 if k >= 7 else 0, self.FIELDS)
        self.assertEqual(run("replay", out, "--quiet").returncode, 3)

    def test_another_grid_and_bad_keys_are_refused_at_their_place_in_one_line(self):
        nrrd(self.folder / "small.nrrd", lambda i, j, k: 1, size=(40, 40, 20))
        nrrd(self.folder / "coarse.nrrd", lambda i, j, k: 1, edge=0.6)
        (self.folder / "table.txt").write_text('1 2 3 4 1 1 1 "a"\n2 400 3 4 1 1 1 "b"\n')
        for extra, words in (('labels = "small.nrrd"', "40 x 40 x 20 voxels, the scan 40 x 40 x 24"),
                             ('labels = "coarse.nrrd"', "0.6 x 0.6 x 0.6 mm"),
                             ('labels = "absent.nrrd"', "is not there"),
                             ('label_table = "table.txt"', "needs labels"),
                             ('labels = "plate.seg.nrrd"\nlabel_table = "table.txt"', "table.txt:2"),
                             ('layers = "segments"', "segment"),
                             ('air_hu = -300', "air_hu"),
                             ('layers = "segment"\nsmoothing_mm = 0', "smoothing_mm"),
                             ('layers = "segment"\nleast_dip = 2', "least_dip"),
                             ('layers = "segment"\nblur_mm = 9', "blur_mm")):
            with self.subTest(extra):
                scene = self.scene(extra)
                result = run("drill", scene, "--out", self.folder / "never", "--quiet")
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(words, result.stderr)
                if "table.txt" in extra:  # at the table's own key, not at that of the label volume
                    line = next(n for n, one in enumerate(scene.read_text().splitlines(), 1) if one.startswith("label_table"))
                    self.assertIn(f"{scene}:{line}:1: ", result.stderr)
                self.assertRegex(result.stderr, r"scene\.toml:\d+:\d+: ")
                self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
                self.assertFalse((self.folder / "never").exists())


@unittest.skipUnless((DATA / "head_ct_raw_big_endian").is_dir() and (DATA / "head_ct_dicom_phantom_1mm").is_dir(), "$BURRHOLE_DATA holds no heads")
class Heads(unittest.TestCase):
    def layers(self, source):
        result = run("import", source, "--segment", "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)["layers"]

    def test_the_cadaver_has_tables_and_the_uniform_phantom_one_layer(self):
        cadaver = self.layers(SOURCE / "app" / "scenes" / "volumes" / "cthead.toml")
        self.assertEqual(cadaver["layers"], 3)
        # Published medians are 2.4 and 1.7 mm of many skulls, with an error of a clinical CT of 0.6 mm in a table; twice that, as this is one skull.
        self.assertAlmostEqual(cadaver["outer_table_mm"]["median"], 2.4, delta=1.2)
        self.assertGreater(cadaver["layered_share"], 0.3)
        self.assertGreater(cadaver["litres"]["inside_skull"], 1.0)
        phantom = self.layers(DATA / "head_ct_dicom_phantom_1mm")
        self.assertEqual(phantom["layers"], 1)
        self.assertLess(phantom["layered_share"], 0.01)

    def test_a_segmented_head_that_is_felt_is_drilled_replayed_and_predicted(self):
        """The labels reach the hand by the factor of diploe that a segmented scan has by default, so forces depend on them."""
        with tempfile.TemporaryDirectory(prefix="burrhole-layers-") as folder:
            first = run("drill", "cadaver_head", "--no-pictures", "--force", "--json", "--quiet", "--out", folder)
            self.assertEqual(first.returncode, 0, first.stderr)
            drilled = json.loads(first.stdout)
            again = run("replay", folder, "--quiet")
            self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
            for name in ("voxels", "forces"):
                self.assertRegex(again.stdout, rf"{name} +recorded {drilled['hash'][name]}  replayed {drilled['hash'][name]}  same")
            # Sabotage: the same session without the layers.
            with contextlib.closing(sqlite3.connect(pathlib.Path(folder) / "session.sqlite")) as session, session:
                changed = session.execute("UPDATE meta SET value = replace(value, 'segment', 'none') WHERE key = 'scene' AND value LIKE '%segment%'")
                self.assertEqual(changed.rowcount, 1)
            self.assertEqual(run("replay", folder, "--quiet").returncode, 3)
        self.assertEqual([row["name"] for row in drilled["layers"]][:3], ["outer table", "diploe", "inner table"])
        self.assertIsNotNone(drilled["drilling"]["breakthrough_s"])
        # As of other scenes (commands_test.py): the labels, and what finds them, are in the prediction.
        self.assertLess(abs(drilled["memory"]["predicted_bytes"] / drilled["memory"]["peak_bytes"] - 1.0), 0.15, drilled["memory"])


if __name__ == "__main__":
    unittest.main()
