"""Exporting as its users meet it: a drilled bone is written, read by nibabel and by the program itself, and is the same; plans of 3D Slicer.

Run by ctest with the program's path in BURRHOLE_PROGRAM, by an interpreter that has nibabel. Needs no drawing.
"""
import contextlib
import gzip
import json
import math
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import nibabel
import numpy

from program_support import PROGRAM, SOURCE, WithFolder, run

SPACING_MM = 0.2
SCENE = '''title = "Oblique plate"
duration_s = 6.0
[volume]
source = "phantom:plate"
spacing_mm = 0.2
extent_mm = [8, 7, 3]
above_mm = 1.0
thickness_mm = 1.2
[tool]
name = "pin_2mm"
spin_rpm = 1000
erosion_scale = 20
[approach]
{approach}
[hand]
push_N = 20
ramp_s = 0.2
standoff_mm = 0.5
[outcome]
plunge_limit_mm = 100
[contact]
[erosion]
[record]
'''
ENTRY = "entry_mm = [0.5, -0.25, 0]"
PIN_MM = 2.0


def stl_volume(path):
    """Volume [mm^3] inside a binary STL by the divergence theorem, in double; shares no code with the program."""
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    corners = numpy.frombuffer(data, numpy.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")]), count, 84)["corners"].astype(float)
    return float(numpy.einsum("ij,ij->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])) / 6.0)


class Drilled(WithFolder):
    """One run for all tests."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="burrhole-export-")
        cls.addClassCleanup(folder.cleanup)
        cls.run_folder = Path(folder.name)
        (cls.run_folder / "pin_2mm.toml").write_text((SOURCE / "tests" / "data" / "scenes" / "pin_2mm.toml").read_text())
        cls.scene_path = cls.run_folder / "scene.toml"
        cls.scene_path.write_text(SCENE.format(approach=ENTRY))
        done = run("drill", cls.scene_path, "--offscreen", "--out", cls.run_folder / "out", "--json", "--quiet")
        assert done.returncode == 0, done.stderr
        cls.summary = json.loads(done.stdout)
        cls.bone = cls.run_folder / "out" / "bone.vdb"

    def export(self, *arguments, code=0):
        done = run("export", *arguments, "--quiet")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def refused(self, *arguments):
        done = self.export(*arguments, code=2)
        self.assertEqual((done.stdout, len(done.stderr.strip().splitlines())), ("", 1), done.stderr)
        return done.stderr

    def exported(self, name, *options, source=None):
        self.export(source or self.bone, "-o", self.folder / name, "--force", *options)
        return self.folder / name

    def test_a_file_is_replaced_by_force_alone(self):
        there = self.folder / "there.nrrd"
        there.write_bytes(b"a CT")
        self.assertIn("--force", self.refused(self.bone, "-o", there))
        self.assertEqual(there.read_bytes(), b"a CT")
        self.export(self.bone, "-o", there, "--force")
        self.assertTrue(there.read_bytes().startswith(b"NRRD"))

    def hashed(self, bone, *options):
        """The hash of the voxels of a run of no length that starts from a checkpoint."""
        done = run("drill", self.scene_path, "--offscreen", "--out", self.folder / "again", "--json", "--quiet", "--restore", bone,
                   "--set", "duration_s=0.01", "--set", "output.bone=false")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["hash"]["voxels"]


class Stopped(Drilled):
    def test_an_interrupt_leaves_no_part_of_a_file_and_what_was_there(self):
        # 15 million voxels: packing them takes seconds.
        fine = ("--set", "volume.spacing_mm=0.02", "--force")
        for name, before in (("new.nii.gz", None), ("there.nii.gz", b"a CT")):
            with self.subTest(name):
                out = self.folder / name
                if before:
                    out.write_bytes(before)
                process = subprocess.Popen([PROGRAM, "export", str(self.scene_path), "-o", str(out), *fine], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                self.addCleanup(process.kill)
                while process.poll() is None and not list(self.folder.glob("*.tmp")):
                    time.sleep(0.01)
                self.assertIsNone(process.poll(), "it was done before the interrupt")
                process.send_signal(signal.SIGINT)
                printed, errors = process.communicate(timeout=60)
                self.assertEqual((process.returncode, printed), (130, ""), errors)
                self.assertIn("was stopped", errors)
                self.assertEqual([path.name for path in self.folder.iterdir()], [name] if before else [])
                if before:
                    self.assertEqual(out.read_bytes(), before)
                    out.unlink()


    def test_an_interrupt_before_the_file_is_begun_ends_at_once(self):
        """While a surface is computed there is nothing to remove."""
        fine = ("--set", "volume.spacing_mm=0.02", "--force")
        for name in ("new.stl", "new.vdb"):
            with self.subTest(name):
                process = subprocess.Popen([PROGRAM, "export", str(self.scene_path), "-o", str(self.folder / name), *fine], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                self.addCleanup(process.kill)
                while not self.catches(process):
                    self.assertIsNone(process.poll())
                    time.sleep(0.005)
                process.send_signal(signal.SIGINT)
                printed, errors = process.communicate(timeout=60)
                self.assertEqual((process.returncode, printed), (130, ""), errors)
                self.assertIn("stopped: nothing was written", errors)
                self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_second_interrupt_leaves_no_part_of_a_file_either(self):
        fine = ("--set", "volume.spacing_mm=0.02", "--force")
        for name in ("new.vdb", "new.nii.gz"):
            with self.subTest(name):
                process = subprocess.Popen([PROGRAM, "export", str(self.scene_path), "-o", str(self.folder / name), *fine], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                self.addCleanup(process.kill)
                while process.poll() is None and not list(self.folder.glob("*.tmp")):
                    time.sleep(0.001)
                self.assertIsNone(process.poll(), "it was done before the interrupt")
                while process.poll() is None:  # signals that wait for the same handler are one
                    process.send_signal(signal.SIGINT)
                printed, errors = process.communicate(timeout=60)
                self.assertEqual((process.returncode, printed), (130, ""), errors)
                self.assertEqual(list(self.folder.iterdir()), [])

    def test_one_interrupt_ends_the_wait_for_the_reader_of_a_pipe(self):
        """Both waits: for a reader that opens the pipe, and for one that reads what it has opened."""
        for opened in (False, True):
            with self.subTest(opened=opened):
                pipe = self.folder / f"pipe{opened}.stl"  # far larger than what a pipe holds
                os.mkfifo(pipe)
                reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK) if opened else None
                process = subprocess.Popen([PROGRAM, "export", str(self.scene_path), "-o", str(pipe), "--force", "--quiet"], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                self.addCleanup(process.kill)
                self.assertTrue(self.waits(process), "it was done before the interrupt")
                process.send_signal(signal.SIGINT)
                printed, errors = process.communicate(timeout=60)
                if reader is not None:
                    os.close(reader)
                self.assertEqual((process.returncode, printed), (130, ""), errors)
                pipe.unlink()
                self.assertEqual(list(self.folder.iterdir()), [])

    @staticmethod
    def waits(process):
        """Whether the process comes to wait for the other end of a pipe."""
        deadline = time.monotonic() + 60
        while process.poll() is None:
            call = Path(f"/proc/{process.pid}/wchan").read_text()
            if any(word in call for word in ("wait_for_partner", "fifo_open", "pipe_w")):
                return True
            if time.monotonic() > deadline:
                process.kill()
                raise AssertionError(f"it waits in {call or 'an unknown call'} and not for a pipe")
            time.sleep(0.005)
        return False

    @staticmethod
    def catches(process):
        """Whether the process has a handler for Ctrl-C."""
        with contextlib.suppress(FileNotFoundError):
            for line in Path(f"/proc/{process.pid}/status").read_text().splitlines():
                if line.startswith("SigCgt:"):
                    return int(line.split()[1], 16) >> (signal.SIGINT - 1) & 1
        return 0


class Again(Drilled):
    def test_a_band_of_bone_overrides_the_mark_of_exported_density(self):
        for name in ("density.nrrd", "density.nii"):
            with self.subTest(name):
                density = self.exported(name)
                mark = json.loads(run("import", density, "--json", "--quiet").stdout)
                self.assertIsNone(mark["values"])
                self.assertIn("taken for occupancy", " ".join(mark["assumed"]))
                voxels = []
                for band in ("0.4,0.6", "0.8,1.0"):
                    result = run("import", density, "--json", "--quiet", "--bone-hu", band)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    report = json.loads(result.stdout)
                    self.assertIn("taken for those of a scan", " ".join(report["assumed"]))
                    self.assertEqual((report["values"]["min"], report["values"]["max"]), (0, 1))
                    voxels.append(report["bone"]["voxels"])
                self.assertEqual(voxels[0], mark["bone"]["voxels"], "the same surface, at 0.5")
                self.assertLess(voxels[1], voxels[0])


class Volumes(Drilled):
    def test_nibabel_reads_the_affine_the_dims_and_the_hole(self):
        dims = self.summary["volume"]["dims"]
        drilled = nibabel.load(self.exported("drilled.nii.gz"))
        before = nibabel.load(self.exported("before.nii.gz", "--undrilled"))
        self.assertEqual(list(drilled.shape), dims)
        self.assertEqual(drilled.header.get_xyzt_units()[0], "mm")
        self.assertEqual((int(drilled.header["sform_code"]), int(drilled.header["qform_code"])), (1, 1))
        # The plate's LPS frame has its origin at the entry: voxels of 0.2 mm, i to the left, j to the back. RAS turns both.
        linear = numpy.diag([-SPACING_MM, -SPACING_MM, SPACING_MM])
        numpy.testing.assert_allclose(drilled.affine[:3, :3], linear, atol=1e-7)
        numpy.testing.assert_allclose(drilled.get_qform(), drilled.affine, atol=1e-5)
        density, loaded = drilled.get_fdata(), before.get_fdata()
        self.assertTrue(numpy.all(density <= loaded))
        gone = numpy.argwhere((loaded >= 0.5) & (density < 0.5))
        self.assertGreater(len(gone), 100)
        # The hole's middle in RAS: the entry with x and y turned; voxels whose centres are in the hole, of 2 mm, average to within a voxel.
        middle = nibabel.affines.apply_affine(drilled.affine, gone).mean(axis=0)
        numpy.testing.assert_allclose(middle[:2], [-0.5, 0.25], atol=SPACING_MM)
        # Sabotage: the affine taken for LPS puts the hole elsewhere.
        self.assertGreater(numpy.abs(middle[:2] - [0.5, -0.25]).max(), 2 * SPACING_MM)
        # What is missing is what the run says: the surface lies within half a voxel of the voxels' sides, over the wall of the hole.
        wall = math.pi * PIN_MM * 1.2
        self.assertAlmostEqual(len(gone) * SPACING_MM**3, self.summary["drilling"]["removed_mm3"], delta=wall * SPACING_MM / 2)

    def test_labels_and_the_other_fields_are_what_their_names_say(self):
        labels = nibabel.load(self.exported("labels.nii.gz", "--field", "labels"))
        self.assertEqual(labels.get_data_dtype(), numpy.uint8)
        before = nibabel.load(self.exported("before.nii", "--field", "labels", "--undrilled")).get_fdata()
        density = nibabel.load(self.exported("density.nii")).get_fdata()
        remaining = nibabel.load(self.exported("remaining.nii", "--field", "remaining")).get_fdata()
        hardness = nibabel.load(self.exported("hardness.nii", "--field", "hardness")).get_fdata()
        numpy.testing.assert_array_equal(labels.get_fdata() != before, (remaining < 1) & (density < 0.5) & (before > 0))
        self.assertTrue(((hardness > 0) & (hardness <= 1)).any())
        self.assertEqual((remaining.min(), remaining.max()), (0, 1))

    def test_nrrd_and_nifti_hold_the_same_numbers(self):
        nifti = nibabel.load(self.exported("a.nii")).get_fdata(dtype=numpy.float32)
        header, packed = self.exported("a.nrrd").read_bytes().split(b"\n\n", 1)
        fields = dict(line.split(": ", 1) for line in header.decode().splitlines()[1:] if ":=" not in line)
        self.assertEqual((fields["space"], fields["type"], fields["encoding"]), ("left-posterior-superior", "float", "gzip"))
        self.assertEqual(fields["space directions"], "(0.2,0,0) (0,0.2,0) (0,0,0.2)")
        values = numpy.frombuffer(gzip.decompress(packed), "<f4").reshape([int(n) for n in fields["sizes"].split()], order="F")
        numpy.testing.assert_array_equal(values, nifti)

    def test_a_vdb_comes_back_to_the_bit(self):
        drilled = self.exported("drilled.vdb")
        self.assertEqual(self.hashed(drilled), self.summary["hash"]["voxels"])
        self.assertEqual(self.exported("again.nrrd", source=drilled).read_bytes(), self.exported("first.nrrd").read_bytes())
        before = self.exported("before.vdb", "--undrilled")
        self.assertEqual(self.exported("again.nrrd", source=before).read_bytes(), self.exported("first.nrrd", "--undrilled").read_bytes())
        self.assertNotEqual(self.exported("first.nrrd").read_bytes(), self.exported("again.nrrd", source=before).read_bytes())

    def test_density_comes_back_as_occupancy_without_being_told(self):
        for name in ("a.nrrd", "a.nii.gz"):
            first = self.exported(name)
            imported = run("import", first, "--volume", self.folder / "again.vdb", "--json", "--quiet", "--force")
            self.assertEqual(imported.returncode, 0, imported.stderr)
            self.assertIn("occupancy", json.loads(imported.stdout)["assumed"][0])
            again = nibabel.load(self.exported("again.nii", source=self.folder / "again.vdb"))
            numpy.testing.assert_array_equal(again.get_fdata(), nibabel.load(self.exported("first.nii")).get_fdata())
            numpy.testing.assert_allclose(again.affine, nibabel.load(self.exported("first.nii")).affine, atol=1e-6)

    def test_a_scene_with_a_checkpoint_and_a_file_of_changes_alone(self):
        first = self.exported("first.nrrd").read_bytes()
        self.assertEqual(self.exported("a.nrrd", "--restore", self.bone, source=self.scene_path).read_bytes(), first)
        folder = self.exported("folder.nrrd", "--restore", self.bone.parent, source=self.scene_path)
        self.assertEqual(folder.read_bytes(), first, "the folder of a run stands for its bone")
        self.assertEqual(self.exported("b.nrrd", source=self.scene_path).read_bytes(), self.exported("c.nrrd", "--undrilled").read_bytes())
        done = run("drill", self.scene_path, "--offscreen", "--out", self.folder / "small", "--quiet", "--set", "output.whole_bone=false")
        self.assertEqual(done.returncode, 0, done.stderr)
        changes = self.folder / "small" / "bone.vdb"
        self.assertIn(f"export the scene, with --restore {changes}", self.refused(changes, "-o", self.folder / "d.nrrd"))
        self.assertEqual(self.exported("d.nrrd", "--restore", changes, source=self.scene_path).read_bytes(), first)


class Meshes(Drilled):
    def test_the_hole_is_missing_from_the_volume_of_the_mesh(self):
        whole, drilled = stl_volume(self.exported("before.stl", "--undrilled")), stl_volume(self.exported("drilled.stl"))
        wall = math.pi * PIN_MM * 1.2
        # The run counts what lies inside the surface; the mesh rounds both rims of the hole off, a triangle of less than two by two voxels.
        tolerance = wall * SPACING_MM / 2 + 2 * math.pi * PIN_MM * (2 * SPACING_MM) ** 2 / 2
        self.assertAlmostEqual(whole - drilled, self.summary["drilling"]["removed_mm3"], delta=tolerance)
        self.assertGreater(self.summary["drilling"]["removed_mm3"], 1.5 * tolerance)

    def test_the_program_reads_its_own_meshes(self):
        for name in ("a.stl", "a.ply", "a.obj"):
            path = self.exported(name)
            self.assertIn(b"SPACE=LPS", path.read_bytes()[:200])
            again = run("import", path, "--unit", "mm", "--spacing-mm", "0.2", "--volume", self.folder / "again.vdb", "--json", "--quiet", "--force")
            self.assertEqual(again.returncode, 0, again.stderr)
            bone = json.loads(again.stdout)["bone"]
            # The last centres lie up to a voxel inside the plate: 8 x 7 mm, from the entry's height down to 1.2 mm.
            for got, meant in zip(bone["from_mm"] + bone["to_mm"], (-4, -3.5, -1.2, 4, 3.5, 0)):
                self.assertAlmostEqual(got, meant, delta=1.01 * SPACING_MM)
            # The header holds the unit; a given one counts, and a mesh without that header has none.
            plain = run("import", path, "--spacing-mm", "0.2", "--json", "--quiet")
            self.assertEqual(plain.returncode, 0, plain.stderr)
            self.assertEqual(json.loads(plain.stdout)["bone"]["from_mm"], bone["from_mm"])
            other = self.folder / ("other" + path.suffix)
            other.write_bytes(path.read_bytes().replace(b"burrhole, bone", b"anything, bone"))
            unknown = run("import", other, "--spacing-mm", "0.2", "--quiet")
            self.assertEqual(unknown.returncode, 2)
            self.assertIn("--unit", unknown.stderr)


class Folders(Drilled):
    def test_a_missing_folder_is_made(self):
        self.exported("one/two/a.stl")


class Plans(Drilled):
    def plan(self, name, *options):
        return self.exported(name, *options, source=self.scene_path)

    def test_the_planned_line_runs_from_the_outer_to_the_inner_surface(self):
        markup = json.loads(self.plan("plan.mrk.json").read_text())["markups"][0]
        self.assertEqual((markup["type"], markup["coordinateSystem"], markup["coordinateUnits"]), ("Line", "LPS", "mm"))
        entry, target = (point["position"] for point in markup["controlPoints"])
        numpy.testing.assert_allclose(entry, [0.5, -0.25, 0], atol=1e-6)
        numpy.testing.assert_allclose(target, [0.5, -0.25, -1.2], atol=1e-6)
        self.assertEqual([point["label"] for point in markup["controlPoints"]], ["entry", "target"])

    def test_a_plan_drills_the_hole_of_the_scene_that_it_came_from(self):
        approach = ("drill", "--offscreen", "--json", "--quiet", "--force", "--out", self.folder / "out")
        hashes = []
        for name, ras in (("plan.mrk.json", False), ("plan.fcsv", False), ("plan.mrk.json", True), ("plan.fcsv", True)):
            path = self.plan(name)
            if ras:
                self.turn(path)
            scene = self.scene(SCENE.format(approach=f'markups = "{name}"'))
            done = run(*approach, scene)
            self.assertEqual(done.returncode, 0, done.stderr)
            hashes.append(json.loads(done.stdout)["hash"]["voxels"])
        self.assertEqual(len(set(hashes)), 1)
        # Sabotage: a file that says RAS and holds LPS drills elsewhere.
        path = self.plan("plan.fcsv")
        path.write_text(path.read_text().replace("= LPS", "= RAS"))
        done = run(*approach, self.scene(SCENE.format(approach='markups = "plan.fcsv"')))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotEqual(json.loads(done.stdout)["hash"]["voxels"], hashes[0])

    @staticmethod
    def turn(path):
        """Writes the same points in RAS, as 3D Slicer would."""
        if path.suffix == ".json":
            content = json.loads(path.read_text())
            content["markups"][0]["coordinateSystem"] = "RAS"
            for point in content["markups"][0]["controlPoints"]:
                point["position"] = [-point["position"][0], -point["position"][1], point["position"][2]]
            path.write_text(json.dumps(content))
            return
        text = path.read_text().replace("= LPS", "= RAS")
        path.write_text(re.sub(r"^(\d),([^,]+),([^,]+),", lambda m: f"{m[1]},{-float(m[2])},{-float(m[3])},", text, flags=re.MULTILINE))

    def test_a_plan_keeps_the_target_that_it_was_given(self):
        (self.folder / "deep.fcsv").write_text("# CoordinateSystem = LPS\n1,0.5,-0.25,2,0,0,0,1,1,1,0,entry,,\n2,0.5,-0.25,-30,0,0,0,1,1,1,0,target,,\n")
        scene = self.scene(SCENE.format(approach='markups = "deep.fcsv"'))
        points = json.loads(self.exported("plan.mrk.json", source=scene).read_text())["markups"][0]["controlPoints"]
        numpy.testing.assert_allclose(points[0]["position"], [0.5, -0.25, 0], atol=1e-6)
        numpy.testing.assert_allclose(points[1]["position"], [0.5, -0.25, -30], atol=1e-9)

    def test_a_bad_plan_is_named_with_its_line(self):
        (self.folder / "plan.fcsv").write_text("# CoordinateSystem = LPS\n1,0.5,left,2\n")
        done = run("check", self.scene(SCENE.format(approach='markups = "plan.fcsv"')))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r'scene.toml:14:1: approach.markups = "plan.fcsv" cannot be read: .*plan.fcsv:2:7: y is not a number')


class Refusals(Drilled):
    def test_each_names_the_mistake_and_leaves_no_file(self):
        out = self.folder / "a"
        for arguments, words in (((self.bone, "-o", f"{out}.png"), "must end in .nrrd, .nii, .nii.gz, .vdb, .stl, .ply or .obj"),
                                 ((self.bone, "-o", f"{out}.stl", "--field", "labels"), "a mesh is the surface"),
                                 ((self.bone, "-o", f"{out}.nrrd", "--field", "densty"), "--field"),
                                 ((self.bone, "-o", f"{out}.mrk.json"), "a planned line is that of a scene"),
                                 ((self.scene_path, "-o", f"{out}.mrk.json", "--crop"), "leave out"),
                                 ((self.bone, "-o", self.bone / "a.nrrd"), "is a file, not a folder"),
                                 ((self.folder / "none.vdb", "-o", f"{out}.nrrd"), "no such file"),
                                 ((self.scene_path, "-o", f"{out}.nrrd", "--restore", self.bone, "--undrilled"), "exclude each other"),
                                 ((self.bone, "-o", f"{out}.nrrd", "--set", "tool.spin_rpm=1"), "--set is for scenes"),
                                 ((self.scene_path, "-o", f"{out}.nrrd", "--unit", "mm"), "are for volumes"),
                                 ((self.bone, "-o", self.bone), "is the file that is read")):
            with self.subTest(words):
                self.assertIn(words, self.refused(*arguments))
        self.assertEqual([path.name for path in self.folder.iterdir()], [])

    def test_an_unreadable_bone_leaves_the_old_file(self):
        broken = self.folder / "broken.vdb"
        broken.write_bytes(self.bone.read_bytes()[:5000])
        out = self.folder / "old.nrrd"
        out.write_text("as before")
        self.refused(broken, "-o", out)
        self.assertEqual(out.read_text(), "as before")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["broken.vdb", "old.nrrd"])


class Page(Drilled):
    def test_the_python_example_runs_as_printed(self):
        page = (SOURCE / "docs" / "export.md").read_text()
        code = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
        for line in re.findall(r"^burrhole export (.*?)(?: +#.*)?$", page, re.MULTILINE):
            if line.startswith("out/bone.vdb"):
                words = line.replace("out/bone.vdb", str(self.bone)).split()
                done = run("export", *words, "--quiet", cwd=self.folder)
                self.assertEqual(done.returncode, 0, done.stderr)
        done = subprocess.run([sys.executable, "-c", code], cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        removed = float(re.search(r"([\d.]+) mm3 removed", done.stdout)[1])
        self.assertAlmostEqual(removed, self.summary["drilling"]["removed_mm3"], delta=math.pi * PIN_MM * 1.2 * SPACING_MM / 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
