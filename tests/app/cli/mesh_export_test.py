"""The mesh that `burrhole render --export` and an input `export` write, read by VTK: it is closed and has the volume of the bone, as loaded and drilled.

Run by ctest with the program's path in BURRHOLE_PROGRAM, by an interpreter that has python3-vtk9; exit 77 (skipped) without it. Needs no drawing.
"""
import math
import sys
import tempfile
import unittest
from pathlib import Path

from program_support import SOURCE, run

try:
    from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkMassProperties, vtkPolyDataConnectivityFilter
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
except ImportError:
    sys.exit(77)

BLOCK_MM = (6.0, 5.0, 4.0)
SCENE = '''title = "Block"
duration_s = 3.0
[volume]
source = "phantom:block"
spacing_mm = 0.2
extent_mm = [8, 8, 8]
above_mm = 1.5
block_mm = [6.0, 5.0, 4.0]
[tool]
name = "pin_2mm"
spin_rpm = 1000
erosion_scale = 20
[approach]
entry_mm = [0.0, 0.0, 0.0]
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
READERS = {".stl": vtkSTLReader, ".ply": vtkPLYReader, ".obj": vtkOBJReader}


class Read:
    """A mesh as VTK has it, vertices at equal places merged."""

    def __init__(self, path):
        reader = READERS[path.suffix]()
        reader.SetFileName(str(path))
        clean = vtkCleanPolyData()
        clean.SetInputConnection(reader.GetOutputPort())
        clean.PointMergingOn()
        clean.ToleranceIsAbsoluteOn()
        clean.SetAbsoluteTolerance(0.0)
        clean.Update()
        self.mesh = clean.GetOutput()
        self.triangles = self.mesh.GetNumberOfPolys()
        mass = vtkMassProperties()
        mass.SetInputData(self.mesh)
        mass.Update()
        self.volume = mass.GetVolume()

    def edges(self, kind):
        found = vtkFeatureEdges()
        found.SetInputData(self.mesh)
        for name in ("BoundaryEdges", "FeatureEdges", "NonManifoldEdges", "ManifoldEdges"):
            getattr(found, name + ("On" if name == kind else "Off"))()
        found.Update()
        return found.GetOutput().GetNumberOfCells()

    def parts(self):
        found = vtkPolyDataConnectivityFilter()
        found.SetInputData(self.mesh)
        found.SetExtractionModeToAllRegions()
        found.Update()
        return found.GetNumberOfExtractedRegions()


class MeshExportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder_owner = tempfile.TemporaryDirectory(prefix="burrhole-mesh-")
        cls.folder = Path(cls.folder_owner.name)
        cls.scene = cls.folder / "block.toml"
        cls.scene.write_text(SCENE, encoding="utf-8")
        (cls.folder / "pin_2mm.toml").write_text((SOURCE / "tests" / "data" / "scenes" / "pin_2mm.toml").read_text(encoding="utf-8"), encoding="utf-8")
        done = run("drill", cls.scene, "--out", cls.folder / "out", "--no-pictures", "--quiet")
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder_owner.cleanup()

    def export(self, name, *options):
        done = run("render", self.scene, "--export", self.folder / name, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("ball pivoting", done.stdout)
        return Read(self.folder / name)

    def test_vtk_finds_each_file_closed_and_of_the_volume_of_the_bone(self):
        for ending in READERS:
            with self.subTest(ending=ending):
                read = self.export("loaded" + ending)
                self.assertGreater(read.triangles, 6000)  # two per voxel of area: 7400 on a block of 30 x 25 x 20
                self.assertEqual(read.edges("BoundaryEdges"), 0)
                self.assertEqual(read.edges("NonManifoldEdges"), 0)
                self.assertEqual(read.parts(), 1)
                # The level of 0.5 rounds each edge of the block by 0.4 voxel^2 of its cross-section (docs/mesh.md), and corners more.
                edges = 4 * sum(BLOCK_MM)
                least = math.prod(BLOCK_MM) - 2 * 0.4 * 0.2**2 * edges
                self.assertLess(read.volume, math.prod(BLOCK_MM) * 1.001)
                self.assertGreater(read.volume, least)

    def test_a_drilled_bone_is_closed_and_smaller(self):
        loaded, drilled = self.export("whole.stl"), self.export("drilled.stl", "--restore", self.folder / "out" / "bone.vdb")
        self.assertEqual(drilled.edges("BoundaryEdges"), 0)
        removed = loaded.volume - drilled.volume
        self.assertGreater(removed, 1.0)  # mm^3: a pin of 2 mm takes 3.1 per mm of depth
        self.assertLess(removed, 3.5 * BLOCK_MM[2])

    def test_inputs_write_the_bone_of_moments_of_a_run_closed(self):
        inputs = self.folder / "inputs.toml"
        moments = (0.1, 1.2, 2.2)  # above the bone, and in it
        inputs.write_text("".join(f'[[input]]\ntime_s = {t}\nkind = "export"\nformat = "ply"\n' for t in moments), encoding="utf-8")
        whole = self.export("whole.stl").volume
        for options in ([], ["--live"]):
            with self.subTest(options=options):
                out = self.folder / "exported"
                done = run("drill", self.scene, "--offscreen", "--no-pictures", "--inputs", inputs, "--out", out, "--force", *options)
                self.assertEqual(done.returncode, 0, done.stderr)
                names = sorted(path.name for path in out.glob("bone_at_*"))
                self.assertEqual(len(names), len(moments))
                meshes = [Read(out / name) for name in names]
                self.assertEqual([mesh.edges("BoundaryEdges") for mesh in meshes], [0, 0, 0])
                volumes = [mesh.volume for mesh in meshes]
                if options:  # a live run may miss the tick, and export later
                    self.assertEqual(volumes, sorted(volumes, reverse=True))
                    self.assertLess(volumes[2], whole - 0.5)
                    continue
                self.assertEqual(names, [f"bone_at_{t:.3f}s.ply" for t in moments])
                self.assertAlmostEqual(volumes[0], whole, delta=1e-3)
                self.assertGreater(volumes[0], volumes[1] + 0.5)
                self.assertGreater(volumes[1], volumes[2] + 0.5)

    def test_an_open_mesh_is_found_open(self):
        path = self.folder / "open.stl"
        done = run("render", self.scene, "--export", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        data = bytearray(path.read_bytes())
        data[80:84] = (int.from_bytes(data[80:84], "little") - 1).to_bytes(4, "little")  # without the last triangle
        path.write_bytes(data[:-50])
        self.assertEqual(Read(path).edges("BoundaryEdges"), 3)

    def test_another_ending_is_refused_before_anything_is_read(self):
        done = run("render", self.scene, "--export", self.folder / "bone.nrrd")
        self.assertEqual(done.returncode, 2)
        self.assertIn("must end in .stl, .ply or .obj", done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
