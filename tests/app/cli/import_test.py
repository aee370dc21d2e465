"""Importing as its users meet it: a CT written by this test becomes a bone model and a burrhole; whatever names a patient stays behind.

Run by ctest with the program's path in BURRHOLE_PROGRAM. The DICOM files are written here, byte by byte, and share nothing with the reader.
"""
import array
import json
import math
import os
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
SECRETS = {  # every field that says who, when or where
    (0x0008, 0x0020): ("DA", "19630509"), (0x0008, 0x0050): ("SH", "SECRETACC"), (0x0008, 0x0080): ("LO", "SECRETHOSPITAL"),
    (0x0008, 0x0090): ("PN", "SECRETREFERRER"), (0x0008, 0x1030): ("LO", "SECRETSTUDY"), (0x0008, 0x103E): ("LO", "SECRETSERIES"),
    (0x0010, 0x0010): ("PN", "SECRETNAME^JANE"), (0x0010, 0x0020): ("LO", "SECRETID42"), (0x0010, 0x0030): ("DA", "19440606"),
    (0x0010, 0x1040): ("LO", "SECRETSTREET"), (0x0020, 0x0010): ("SH", "SECRETSTUDYID")}
MARKS = [b"SECRET", b"19630509", b"19440606", b"1.2.826.0.1.77777"]
SIZE, SLICES, PIXEL_MM, SLICE_MM = 64, 24, 0.5, 0.5


def element(group, number, kind, value):
    data = value.encode() if isinstance(value, str) else value
    if len(data) % 2:
        data += b"\0" if kind == "UI" else b" "
    head = struct.pack("<HH", group, number) + kind.encode()
    return head + (b"\0\0" + struct.pack("<I", len(data)) if kind in ("OB", "OW") else struct.pack("<H", len(data))) + data


def dicom(index, pixels):
    """One CT slice, explicit little endian, stored as HU + 1024."""
    uid = f"1.2.826.0.1.77777.{index + 1}"
    meta = (element(2, 1, "OB", b"\0\1") + element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(2, 3, "UI", uid)
            + element(2, 0x10, "UI", "1.2.840.10008.1.2.1"))
    fields = {(0x0008, 0x0008): ("CS", "ORIGINAL\\PRIMARY\\AXIAL"), (0x0008, 0x0016): ("UI", "1.2.840.10008.5.1.4.1.1.2"),
              (0x0008, 0x0018): ("UI", uid), (0x0008, 0x0060): ("CS", "CT"), (0x0018, 0x0050): ("DS", str(SLICE_MM)),
              (0x0020, 0x000D): ("UI", "1.2.826.0.1.77777.8"), (0x0020, 0x000E): ("UI", "1.2.826.0.1.77777.9"),
              (0x0020, 0x0011): ("IS", "3"), (0x0020, 0x0013): ("IS", str(index + 1)),
              (0x0020, 0x0032): ("DS", f"-15.75\\-15.75\\{index * SLICE_MM}"), (0x0020, 0x0037): ("DS", "1\\0\\0\\0\\1\\0"),
              (0x0028, 0x0002): ("US", struct.pack("<H", 1)), (0x0028, 0x0004): ("CS", "MONOCHROME2"),
              (0x0028, 0x0010): ("US", struct.pack("<H", SIZE)), (0x0028, 0x0011): ("US", struct.pack("<H", SIZE)),
              (0x0028, 0x0030): ("DS", f"{PIXEL_MM}\\{PIXEL_MM}"), (0x0028, 0x0100): ("US", struct.pack("<H", 16)),
              (0x0028, 0x0101): ("US", struct.pack("<H", 16)), (0x0028, 0x0102): ("US", struct.pack("<H", 15)),
              (0x0028, 0x0103): ("US", struct.pack("<H", 0)), (0x0028, 0x1052): ("DS", "-1024"), (0x0028, 0x1053): ("DS", "1"), **SECRETS}
    body = b"".join(element(g, e, *value) for (g, e), value in sorted(fields.items()))
    return b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + body + element(0x7FE0, 0x10, "OW", pixels)


def plate(folder, first=0, last=SLICES):
    """Slices of a plate of 1000 HU, 3 mm thick, z from 4 to 7 mm, in air."""
    folder.mkdir(parents=True, exist_ok=True)
    for index in range(first, last):
        hu = 1000 if 8 <= index < 14 else -1000
        (folder / f"slice{(index * 7) % 97:02}").write_bytes(dicom(index, struct.pack("<H", hu + 1024) * (SIZE * SIZE)))


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


class Import(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-import-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.scan = self.folder / "scan"
        plate(self.scan)

    def scene(self, source, extra=""):
        shutil.copy(SOURCE / "tests" / "data" / "scenes" / "pin_2mm.toml", self.folder)
        path = self.folder / "scene.toml"
        path.write_text(f'''[volume]
source = "{source}"
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
standoff_mm = 0.5
[contact]
cutting_N_per_m = 25e3
[erosion]
[record]
''')
        return path

    def refused(self, *arguments):
        result = run("import", *arguments, "--quiet")
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        self.assertEqual(result.stdout, "")
        return result.stderr

    def test_a_folder_becomes_a_bone_model_and_the_report_is_json(self):
        result = run("import", self.scan, "--volume", self.folder / "bone.vdb", "--json", "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        report = json.loads(result.stdout)
        self.assertEqual(report["dims"], [SIZE, SIZE, SLICES])
        self.assertEqual(report["series"][0]["name"], "3")
        for got, meant in zip(report["spacing_mm"], (PIXEL_MM, PIXEL_MM, SLICE_MM)):
            self.assertAlmostEqual(got, meant, places=9)
        self.assertEqual(report["values"]["unit"], "HU")
        self.assertAlmostEqual(report["bone"]["share"], 6 / SLICES, places=6)
        self.assertAlmostEqual(report["shear_deg"], 0.0, places=9)
        self.assertTrue((self.folder / "bone.vdb").stat().st_size > 0)

    def test_an_interrupt_while_the_bone_is_saved_leaves_no_part_of_a_file_and_what_was_there(self):
        size = 224  # random values of bone: compressing them takes seconds
        scan, out = self.folder / "noise.nrrd", self.folder / "out"
        head = (f"NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: {size} {size} {size}\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)\n"
                "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
        values = array.array("h", (1000 + value for value in random.Random(5).randbytes(size**3)))
        scan.write_bytes(head.encode() + values.tobytes())
        out.mkdir()
        (out / "bone.vdb").write_bytes(b"a bone")
        process = subprocess.Popen([PROGRAM, "import", str(scan), "--bone-hu", "250,400", "--hu-offset", "0", "--volume", str(out / "bone.vdb"), "--quiet", "--force"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        while process.poll() is None and not list(out.glob("*.tmp")):
            time.sleep(0.01)
        self.assertIsNone(process.poll(), "it was done before the interrupt")
        process.send_signal(signal.SIGINT)
        printed, errors = process.communicate(timeout=120)
        self.assertEqual((process.returncode, printed), (130, ""), errors)
        self.assertIn("was stopped", errors)
        self.assertEqual({path.name: path.read_bytes() for path in out.iterdir()}, {"bone.vdb": b"a bone"})

    def test_what_names_a_patient_stays_behind(self):
        out = self.folder / "out"
        texts = []
        for arguments in (("import", self.scan, "--volume", self.folder / "bone.vdb"),
                          ("drill", self.scene(self.scan), "--out", out / "scan"), ("check", self.scene(self.scan)),
                          ("drill", self.scene(self.folder / "bone.vdb"), "--out", out / "vdb")):
            result = run(*arguments)
            self.assertEqual(result.returncode, 0, result.stderr)
            texts.append((result.stdout + result.stderr).encode())
        files = [self.folder / "bone.vdb", *(path for path in out.rglob("*") if path.is_file())]
        self.assertGreater(len(files), 6)
        for mark in MARKS:
            self.assertTrue(any(mark in path.read_bytes() for path in self.scan.iterdir()), mark)  # the search would find it
            for text in texts:
                self.assertNotIn(mark, text)
            for path in files:
                self.assertNotIn(mark, path.read_bytes(), path)

    def test_a_field_is_kept_when_asked_for_by_name(self):
        result = run("import", self.scan, "--json", "--quiet", "--keep", "PatientID")
        self.assertEqual(json.loads(result.stdout)["kept"], {"PatientID": "SECRETID42"})
        self.assertNotIn("SECRETNAME", result.stdout)
        self.assertIn("PatientID", self.refused(self.scan, "--keep", "PatientIdd"))

    def test_a_scan_and_its_bone_model_drill_alike(self):
        self.assertEqual(run("import", self.scan, "--volume", self.folder / "bone.vdb", "--quiet").returncode, 0)
        hashes = []
        for source in (self.scan, self.folder / "bone.vdb"):
            result = run("drill", self.scene(source), "--out", self.folder / "out", "--json", "--quiet", "--force")
            self.assertEqual(result.returncode, 0, result.stderr)
            summary = json.loads(result.stdout)
            hashes.append((summary["hash"]["voxels"], summary["hash"]["forces"]))
            self.assertAlmostEqual(summary["drilling"]["thickness_mm"], 3.0, delta=0.2)  # the edge lies between slices of 0.5 mm
            self.assertIsNotNone(summary["drilling"]["breakthrough_s"])
        self.assertEqual(*hashes)

    def test_refining_a_region_says_the_memory_and_misses_are_told(self):
        result = run("check", self.scene(self.scan, "spacing_mm = 0.25\nregion_mm = [8, 8, 8]"))
        self.assertEqual(result.returncode, 0, result.stderr)
        result = run("import", self.scan, "--spacing-mm", "0.25")
        self.assertIn("takes about", result.stderr)
        self.assertIn("outside the scan", self.refused(self.scan, "--spacing-mm", "0.25", "--region-mm", "5,5,5", "--centre-mm", "0,0,300"))
        self.assertIn("must be given together", self.refused(self.scan, "--region-mm", "5,5,5"))
        result = run("check", self.scene(self.scan, "region_mm = [8, 8, 8]"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("needs spacing_mm", result.stderr)

    def test_refusals_name_file_and_fault_and_leave_nothing(self):
        out = self.folder / "never.vdb"
        (self.folder / "empty").mkdir()
        (self.folder / "notes").mkdir()
        (self.folder / "notes" / "readme.txt").write_text("no scan here")
        gap = self.folder / "gap"
        plate(gap, 0, 10)
        plate(gap, 12)
        short = self.folder / "short"
        plate(short)
        victim = next(short.iterdir())
        victim.write_bytes(victim.read_bytes()[:-1000])
        for source, words in ((self.folder / "empty", "empty"), (self.folder / "notes", "DICOM"), (gap, "step"), (short, "short"),
                              (self.folder / "absent", "no such file"), (self.folder / "notes" / "readme.txt", "supported format")):
            with self.subTest(source.name):
                message = self.refused(source, "--volume", out)
                self.assertIn(str(source), message)
                self.assertIn(words, message)
                self.assertFalse(out.exists())
        self.assertIn("no bone", self.refused(self.scan, "--bone-hu", "2000,2500", "--volume", out))
        self.assertIn("must increase", self.refused(self.scan, "--bone-hu", "400,250", "--volume", out))
        self.assertIn(".vdb", self.refused(self.scan, "--volume", self.folder / "bone.raw"))
        (self.folder / "file").write_text("")
        self.assertIn("is a file, not a folder", self.refused(self.scan, "--volume", self.folder / "file" / "bone.vdb"))
        self.assertEqual([path.name for path in self.folder.glob("*.vdb*")], [])

    def test_a_bone_model_knows_where_its_bone_is_and_what_was_assumed(self):
        for index, path in enumerate(sorted(self.scan.iterdir())):
            data = path.read_bytes()
            path.write_bytes(data.replace(b"MONOCHROME2 ", b"MONOCHROME1 "))
        first = json.loads(run("import", self.scan, "--volume", self.folder / "bone.vdb", "--json", "--quiet").stdout)
        again = json.loads(run("import", self.folder / "bone.vdb", "--json", "--quiet").stdout)
        self.assertTrue(any("MONOCHROME1" in line for line in first["assumed"]), first["assumed"])
        self.assertEqual(again["assumed"], first["assumed"])
        self.assertEqual(again["bone"]["from_mm"], first["bone"]["from_mm"])
        self.assertEqual(again["bone"]["to_mm"], first["bone"]["to_mm"])
        self.assertLess(again["bone"]["from_mm"][2], again["bone"]["to_mm"][2])

    def test_options_that_a_format_has_no_use_for_are_refused(self):
        self.assertEqual(run("import", self.scan, "--volume", self.folder / "bone.vdb", "--quiet").returncode, 0)
        self.assertIn("unit", self.refused(self.scan, "--unit", "cm"))
        self.assertIn("already", self.refused(self.folder / "bone.vdb", "--unit", "mm"))
        self.assertIn("already", self.refused(self.folder / "bone.vdb", "--bone-hu", "1,2"))
        self.assertIn("--volume", self.refused(self.scan, "--volume", ""))
        result = run("check", self.scene(self.folder / "bone.vdb", "spacing_mm = 0.25"))
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"scene.toml:2:\d+: .*bone.vdb: is a bone model already")

    def test_a_scene_that_needs_the_environment_says_so(self):
        scene = self.scene("$BURRHOLE_NOWHERE/scan")
        environment = {key: value for key, value in os.environ.items() if key != "BURRHOLE_NOWHERE"}
        result = run("check", scene, env=environment)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"scene.toml:2:\d+: .*BURRHOLE_NOWHERE")
        self.assertEqual(run("check", scene, env={**environment, "BURRHOLE_NOWHERE": str(self.folder)}).returncode, 0)

    def test_shipped_scenes_without_their_scans_say_how_to_get_them(self):
        environment = {key: value for key, value in os.environ.items() if key != "BURRHOLE_DATA"}
        for scene in ("head_phantom", "cadaver_head", "cadaver_whole"):
            for name, more in (("not set", {}), ("empty", {"BURRHOLE_DATA": str(self.folder)})):
                with self.subTest(scene, data=name):
                    result = run("check", scene, env={**environment, **more})
                    self.assertEqual(result.returncode, 2)
                    self.assertIn("scripts/fetch-data", result.stderr)
        result = run("check", self.scene(self.folder / "absent"), env=environment)
        self.assertNotIn("fetch-data", result.stderr)


HEAD = pathlib.Path(os.environ.get("BURRHOLE_DATA", "/none")) / "head_ct_dicom_phantom_1mm"


@unittest.skipUnless(HEAD.is_dir(), "$BURRHOLE_DATA holds no head")
class RealHead(unittest.TestCase):
    """The head lies on a headrest, which the scan holds too; it ends below and above the site of the shipped scene."""

    def suggested(self, near):
        result = run("import", HEAD, "--suggest", ",".join(map(str, near)), "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)["suggested"]

    def test_points_round_the_site_of_the_shipped_scene_give_it_from_outside(self):
        entry, axis = (54.0, 100.0, 800.0), (-0.758, 0.242, -0.606)
        for near in (entry, (53.9, 100, 800), (54, 104, 797), (55, 100, 801), (60, 100, 800)):
            found = self.suggested(near)
            self.assertLess(math.dist(found["entry_mm"], near), 7.0, near)
            self.assertGreater(sum(a * b for a, b in zip(found["axis"], axis)), math.cos(math.radians(8)), near)
            self.assertTrue(4.0 < found["thickness_mm"] < 6.5, near)  # 5.0 mm at the site

    def test_the_headrest_is_no_place_for_a_hole(self):
        result = run("import", HEAD, "--suggest", "100,125,790", "--quiet")
        self.assertEqual(result.returncode, 2)
        self.assertIn("no part of the skull", result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
