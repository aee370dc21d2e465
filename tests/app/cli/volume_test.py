"""A volume in place of a scene: render draws it, import draws an overview and proposes an approach that check accepts.

Run by ctest with the program's path in BURRHOLE_PROGRAM. The volume is a hollow ball of 1000 HU, written here.
"""
import collections
import json
import math
import re
import struct
import unittest

from film_test import pixels_of
from program_support import WithFolder, main, run

EDGE_MM, SIZE = 1.0, (72, 72, 72)
CENTRE, RADIUS_MM, WALL_MM = (10.0, -20.0, 300.0), 30.0, 6.0
ORIGIN = tuple(c - 0.5 * (n - 1) * EDGE_MM for c, n in zip(CENTRE, SIZE))
PLATE = "[tool]\nname = \"round_burr_5mm\"\nspin_rpm = 30000\n[hand]\npush_N = 10\n[contact]\n[erosion]\n"


def ball():
    """HU of the ball; the edge is a ramp of one voxel, as a scan has it."""
    values = []
    for k in range(SIZE[2]):
        for j in range(SIZE[1]):
            for i in range(SIZE[0]):
                r = math.dist((ORIGIN[0] + i * EDGE_MM, ORIGIN[1] + j * EDGE_MM, ORIGIN[2] + k * EDGE_MM), CENTRE)
                inside = min(max(0.5 - max(r - RADIUS_MM, RADIUS_MM - WALL_MM - r) / EDGE_MM, 0.0), 1.0)
                values.append(round(-1000 + inside * 2650))  # half way is the middle of the band of bone, 325 HU
    return struct.pack(f"<{len(values)}h", *values)


BALL = ball()


def with_rest(values):
    """The ball, and a cube of four voxels in a corner, which is no part of it."""
    out = bytearray(values)
    for k in range(4):
        for j in range(4):
            at = 2 * SIZE[0] * (j + SIZE[1] * k)
            out[at:at + 8] = struct.pack("<h", 1650) * 4
    return bytes(out)


def nrrd(path, values=BALL):
    head = ("NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
            "space directions: ({e},0,0) (0,{e},0) (0,0,{e})\nspace origin: ({},{},{})\nencoding: raw\nendian: little\n\n")
    path.write_bytes(head.format(*SIZE, *ORIGIN, e=EDGE_MM).encode() + values)
    return path


class Volume(WithFolder):
    def setUp(self):
        super().setUp()
        self.volume = nrrd(self.folder / "ball.nrrd")

    def draw(self, source, *arguments, size="160x120"):
        image = self.folder / "x.png"
        image.unlink(missing_ok=True)
        result = run("render", source, "--image", image, "--size", size, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return pixels_of(image)

    def refused(self, *arguments):
        result = run(*arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        return result.stderr

    def test_a_volume_is_drawn_as_all_of_its_bone(self):
        rows = self.draw(self.volume, "--set", "volume.bone_hu=[200, 450]")
        bone = [(x, y) for y, row in enumerate(rows) for x, (r, _, b) in enumerate(row) if r > b + 8]  # bone is yellower than the background
        # The box of the ball fills nine tenths of the height, or less where a corner sticks out; the ball is a disc in it.
        tall = max(y for _, y in bone) - min(y for _, y in bone)
        wide = max(x for x, _ in bone) - min(x for x, _ in bone)
        self.assertGreater(tall, 0.4 * 120)
        self.assertLess(tall, 0.95 * 120)
        self.assertLess(abs(tall - wide), 0.08 * 120)
        middle = sum(x for x, _ in bone) / len(bone), sum(y for _, y in bone) / len(bone)
        self.assertLess(math.dist(middle, (80, 60)), 4)
        self.assertGreater(len(bone), 0.9 * math.pi / 4 * tall * wide)

    def test_views_and_methods_differ(self):
        plain = self.draw(self.volume)
        for arguments in (["--method", "slices"], ["--camera", "90,10,200"]):
            self.assertNotEqual(self.draw(self.volume, *arguments), plain, arguments)

    def test_a_section_is_seen_face_on_as_the_ring_of_the_wall(self):
        for view in ([], ["--camera", "0,10,200"], ["--camera", "30,80,200"], ["--camera=-100,0,200"]):
            with self.subTest(view=view):
                rows = self.draw(self.volume, "--cut", *view, size="320x240")
                bone = {(x, y): pixel for y, row in enumerate(rows) for x, pixel in enumerate(row) if pixel[0] > pixel[2] + 8}
                face = collections.Counter(bone.values()).most_common(1)[0][0]  # the section is lit evenly
                on_face = {at for at, pixel in bone.items() if max(abs(a - b) for a, b in zip(pixel, face)) <= 3}
                (left, right), (top, bottom) = ((min(axis), max(axis)) for axis in zip(*bone))
                middle, radius = ((left + right) / 2, (top + bottom) / 2), (right - left + 1) / 2
                self.assertGreater(radius, 40)
                # A section that is seen 10 degrees from its normal is 1.5 % lower than wide; a pixel at each end.
                self.assertLess(abs((bottom - top + 1) / 2 - radius), 0.016 * radius + 1)
                inner = 1 - WALL_MM / RADIUS_MM  # [-] of the radius
                within = lambda low, high: [at for at in bone if low < math.dist(at, middle) / radius < high]
                wall, hollow = within(inner + 0.05, 0.95), within(0, inner - 0.1)
                for share, low, high in ((len(wall), inner + 0.05, 0.95), (len(hollow), 0, inner - 0.1)):  # there is bone everywhere
                    self.assertAlmostEqual(share / (math.pi * radius ** 2), high ** 2 - low ** 2, delta=0.03)
                self.assertGreater(sum(at in on_face for at in wall), 0.98 * len(wall), "the cut wall is a ring")
                self.assertLess(sum(at in on_face for at in hollow), 0.02 * len(hollow), "and in it is the hollow")

    def test_a_folder_with_one_volume_is_that_volume(self):
        folder = self.folder / "scan"
        folder.mkdir()
        nrrd(folder / "ball.nrrd")
        (folder / "readme.txt").write_text("a ball")
        self.assertEqual(self.draw(folder), self.draw(self.volume))
        report = json.loads(run("import", folder, "--json", "--quiet").stdout)
        self.assertEqual(report["format"], "NRRD")
        nrrd(folder / "second.nrrd")
        for command in ("import", "render"):
            error = self.refused(command, folder)
            self.assertIn("2 volumes", error)
            self.assertIn("ball.nrrd, second.nrrd", error)

    def test_a_raw_volume_and_a_mesh_are_volumes_and_scenes_stay_scenes(self):
        (self.folder / "ball.raw").write_bytes(BALL)
        raw = self.folder / "ball.toml"
        raw.write_text(f"data = \"ball.raw\"\ndims = {list(SIZE)}\ntype = \"int16\"\nbyte_order = \"little\"\n"
                       f"spacing_mm = {[EDGE_MM] * 3}\norigin_mm = {list(ORIGIN)}\n")
        self.assertEqual(self.draw(raw), self.draw(self.volume))
        self.draw(self.quick())
        corners = [(0, 0, 0), (20, 0, 0), (0, 20, 0), (0, 0, 20)]
        mesh = self.folder / "solid.obj"
        mesh.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        self.assertIn("unit", self.refused("render", mesh))
        self.draw(mesh, "--unit", "mm")

    def test_what_a_volume_lacks_is_named(self):
        for option in (["--restore", "x.vdb"], ["--no-tool"], ["--depth-mm", "1"], ["--slices-through-tip"], ["--unset", "tool"],
                       ["--set-tool", "region[0].erosion_factor=0.1"], ["--stereo", "anaglyph"], ["--workbench", "300"], ["--overview"]):
            error = self.refused("render", self.volume, *option)
            self.assertIn(f"{option[0]} needs a scene", error)
            self.assertIn(f"leave {option[0]} out", error)
            self.assertEqual(len(error.strip().splitlines()), 1, error)
        self.assertIn("only keys of [volume]", self.refused("render", self.volume, "--set", "tool.spin_rpm=1"))
        self.assertIn("--unit is for a volume", self.refused("render", self.quick(), "--unit", "mm"))

    def test_an_overview_has_slices_and_a_view(self):
        image = self.folder / "sheet.png"
        result = run("import", self.volume, "--overview", image)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("rendering on ", result.stderr)
        width, height = struct.unpack(">II", image.read_bytes()[16:24])
        self.assertEqual((width, height), (1200, 1200))
        result = run("import", self.volume, "--overview", self.folder / "new", "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual((self.folder / "new" / "overview.png").read_bytes(), image.read_bytes())
        self.assertIn("--overview", self.refused("import", self.volume, "--overview", self.volume))

    def test_a_proposed_approach_is_square_to_the_bone_and_accepted_by_check(self):
        way = (0.6, -0.48, 0.64)
        near = [c + (RADIUS_MM + 7.0) * w for c, w in zip(CENTRE, way)]
        result = run("import", self.volume, "--suggest", ",".join(f"{x:.2f}" for x in near), "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("[approach]", result.stdout)
        scene = self.scene(f"[volume]\nsource = \"{self.volume}\"\n" + PLATE + result.stdout)
        checked = run("check", scene)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertIn("ok; 6.", checked.stdout)
        found = json.loads(run("import", self.volume, "--suggest", ",".join(map(str, near)), "--json", "--quiet").stdout)["suggested"]
        self.assertLess(math.dist(found["entry_mm"], [c + RADIUS_MM * w for c, w in zip(CENTRE, way)]), 0.7)
        self.assertGreater(-sum(a * w for a, w in zip(found["axis"], way)), math.cos(math.radians(2)))
        self.assertAlmostEqual(found["thickness_mm"], WALL_MM, delta=0.2)

    def test_a_proposed_approach_says_how_far_it_is_and_warns_at_the_end_of_the_volume(self):
        near = (CENTRE[0] + RADIUS_MM + 7.0, CENTRE[1], CENTRE[2])
        result = run("import", self.volume, "--suggest", ",".join(map(str, near)), "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"the entry is 7\.\d mm from the point that was given")
        end = 0.5 * (SIZE[0] - 1) * EDGE_MM - RADIUS_MM
        pattern = r"the volume ends (\d+\.\d) mm from the hole"
        for text in (result.stdout, result.stderr):
            self.assertAlmostEqual(float(re.search(pattern, text)[1]), end, delta=0.7)
        found = json.loads(run("import", self.volume, "--suggest", ",".join(map(str, near)), "--json", "--quiet").stdout)["suggested"]
        self.assertAlmostEqual(found["moved_mm"], math.dist(found["entry_mm"], near), places=6)
        self.assertAlmostEqual(found["volume_edge_mm"], end, delta=0.7)
        way = (0.6, -0.48, 0.64)
        inside = run("import", self.volume, "--suggest", ",".join(str(c + RADIUS_MM * w) for c, w in zip(CENTRE, way)), "--quiet")
        self.assertEqual((inside.returncode, inside.stderr), (0, ""))
        self.assertNotIn("the volume ends", inside.stdout)

    def test_a_table_that_is_pasted_beside_that_of_the_scene_names_what_to_replace(self):
        proposed = run("import", self.volume, "--suggest", ",".join(str(c + RADIUS_MM * w) for c, w in zip(CENTRE, (0.6, -0.48, 0.64))), "--quiet").stdout
        self.assertIn("replaces the scene's own [approach]", proposed)
        scene = self.scene(f"[volume]\nsource = \"{self.volume}\"\n[approach]\nentry_mm = [0, 0, 0]\n" + PLATE + proposed)
        message = self.refused("check", scene)
        self.assertRegex(message, r"scene\.toml:\d+:\d+: the file has the table \[approach\] twice: replace the scene's own \[approach\]")
        self.assertEqual(len(message.strip().splitlines()), 1, message)

    def test_files_are_replaced_only_by_force(self):
        bone, sheet = self.folder / "bone.vdb", self.folder / "sheet.png"
        for file, option in ((bone, "--volume"), (sheet, "--overview")):
            file.write_bytes(b"mine")
            message = self.refused("import", self.volume, option, file, "--quiet")
            self.assertIn(f"{file}: is there already: choose another name, or --force", message)
            self.assertEqual(file.read_bytes(), b"mine")
            result = run("import", self.volume, option, file, "--quiet", "--force")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertNotEqual(file.read_bytes(), b"mine")
        (self.folder / "sheets").mkdir()
        (self.folder / "sheets" / "overview.png").write_bytes(b"mine")
        self.assertIn("is there already", self.refused("import", self.volume, "--overview", self.folder / "sheets"))

    def test_the_memory_of_the_bone_is_predicted(self):
        for options in ([], ["--spacing-mm", "0.5"], ["--spacing-mm", "0.5", "--region-mm", "20,20,20", "--centre-mm", "10,-20,328"]):
            result = run("import", self.volume, "--json", *options)
            predicted = float(re.search(r"takes about (\d+\.\d) MB", result.stderr)[1])
            self.assertAlmostEqual(predicted, json.loads(result.stdout)["bone"]["bytes"] / 1e6, delta=0.2 * predicted, msg=str(options))

    def test_a_head_rest_is_not_in_the_box_of_the_largest_part(self):
        both = nrrd(self.folder / "both.nrrd", with_rest(BALL))
        alone, found = (json.loads(run("import", path, "--json", "--quiet").stdout)["bone"] for path in (self.volume, both))
        self.assertEqual(alone["largest_part"], {"share": 1.0, "from_mm": alone["from_mm"], "to_mm": alone["to_mm"]})
        self.assertEqual([found["largest_part"][key] for key in ("from_mm", "to_mm")], [alone["from_mm"], alone["to_mm"]])
        self.assertEqual(found["from_mm"], list(ORIGIN))
        self.assertAlmostEqual(found["largest_part"]["share"], alone["voxels"] / (alone["voxels"] + 4 ** 3), places=9)
        self.assertIn("its largest connected part spans", run("import", both, "--quiet").stdout)
        self.assertNotIn("largest connected part", run("import", self.volume, "--quiet").stdout)
        sheets = []
        for path in (self.volume, both):
            image = self.folder / f"{path.stem}.png"
            self.assertEqual(run("import", path, "--overview", image, "--quiet").returncode, 0)
            sheets.append([row[:560] for row in pixels_of(image)[:560]])
        self.assertEqual(*sheets, "the axial slice goes through the middle of the ball, framed by its box")

    def test_a_point_far_from_bone_is_refused_with_where_the_bone_is(self):
        error = self.refused("import", self.volume, "--suggest", "10,-20,500", "--quiet")
        self.assertIn("171 mm away: 170 mm inferior", error)  # the middle of the nearest voxel
        self.assertRegex(error, r"bone spans x -19\.5 to 39\.5")
        self.assertIn("--suggest", self.refused("import", self.volume, "--suggest", "1,2"))

    def test_the_report_has_the_three_edges_of_a_voxel(self):
        report = json.loads(run("import", self.volume, "--json", "--quiet").stdout)
        self.assertEqual(report["schema"], 2)
        for name in (report["spacing_mm"], report["bone"]["spacing_mm"]):
            self.assertEqual([round(x, 9) for x in name], [EDGE_MM] * 3)


if __name__ == "__main__":
    main()
