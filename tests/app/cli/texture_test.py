"""Textures of a mesh of bone as the program's users meet them: by name and by file, what is refused, what it costs in memory.

Run by ctest with the program's path in BURRHOLE_PROGRAM. Skipped (77) without OpenGL.
"""
import json
import struct
import zlib

from program_support import lines, main, QUICK, run, WithFolder

MESH = ("--set", "display.method=mesh")


def png(width, height, pixel=lambda x, y: (200, 40, 40), claimed=None):
    """The bytes of an RGB image; `claimed` is the size that its header has in place of its own."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(width)) for y in range(height))
    header = struct.pack(">IIBBBBB", *(claimed or (width, height)), 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def noise(x, y):
    n = (x * 73856093 ^ y * 19349663) * 83492791 & 0xffffffff
    return n >> 24, n >> 16 & 255, n >> 8 & 255


class Textures(WithFolder):
    def draw(self, *arguments, scene=QUICK):
        image = self.folder / "picture.png"
        done = run("render", scene, "--image", image, "--size", "64x48", "--no-tool", *MESH, *arguments, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return image.read_bytes()

    def refuse(self, needle, *arguments, commands=("check", "render", "drill"), name="exterior_texture"):
        places = {"check": (), "render": ("--image", self.folder / "none.png"), "drill": ("--offscreen", "--quiet", "--out", self.folder / "none")}
        for command in commands:
            with self.subTest(command=command, arguments=arguments):
                done = run(command, QUICK, *MESH, *arguments, *places[command], cwd=self.folder)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(len(lines(done.stderr)), 1, done.stderr)
                self.assertIn(needle, done.stderr)
                self.assertIn(name, done.stderr)
                self.assertFalse((self.folder / "none").exists())
                self.assertFalse((self.folder / "none.png").exists())

    def test_each_texture_by_name_or_file_is_another_picture(self):
        (self.folder / "flat.png").write_bytes(png(16, 16, noise))
        (self.folder / "column.png").write_bytes(png(4, 16, noise))
        ways = {"voxels": (), "bone": ("--set", "display.exterior_texture=bone"),
                "apple": ("--set", "display.exterior_texture=apple"), "file": ("--set", "display.exterior_texture=flat.png"),
                "larger": ("--set", "display.exterior_texture=flat.png", "--set", "display.exterior_mm=60"),
                "axis": ("--set", "display.exterior_texture=flat.png", "--set", "display.texture_axis=x"),
                "section": ("--cut",), "section inside": ("--cut", "--set", "display.interior_texture=apple"),
                "section of a file": ("--cut", "--set", "display.interior_texture=column.png")}
        drawn = {name: self.draw(*arguments) for name, arguments in ways.items()}
        self.assertEqual(len(set(drawn.values())), len(drawn))
        # Whole bone has no inside to be seen, and another colour leaves textures out.
        self.assertEqual(self.draw("--set", "display.interior_texture=apple"), drawn["voxels"])
        self.assertEqual(self.draw("--set", "display.exterior_texture=bone", "--set", "display.colour=voxel"), drawn["voxels"])

    def test_one_colour_is_that_of_both_keys(self):
        # The section of a skull has several colours, unlike the plate.
        patch = ("--cut", "--set", "volume.spacing_mm=0.5")
        plain = self.draw(*patch, "--set", "display.colour=plain", scene="parietal")
        self.assertNotEqual(plain, self.draw(*patch, scene="parietal"))
        self.assertEqual(plain, self.draw(*patch, "--set", "display.label_colours=false", scene="parietal"))

    def test_a_drilled_hole_has_the_inside_also_after_a_checkpoint(self):
        out = self.folder / "run"
        inside = ("--set", "display.interior_texture=apple")
        done = run("drill", QUICK, "--out", out, *MESH, *inside, "--set", "duration_s=1.5", "--no-pictures")
        self.assertEqual(done.returncode, 0, done.stderr)
        restored = ("--restore", out / "bone.vdb")
        self.assertNotEqual(self.draw(*restored), self.draw())
        self.assertNotEqual(self.draw(*restored, *inside), self.draw(*restored))

    def test_what_is_no_texture_is_one_line_before_anything_is_made(self):
        (self.folder / "text.png").write_text("no image")
        (self.folder / "huge.png").write_bytes(png(1, 1, claimed=(16384, 16384)))
        (self.folder / "flat.png").write_bytes(png(16, 16))
        (self.folder / "scan.nrrd").write_text("NRRD0004\n")
        self.refuse("is not there", "--set", "display.exterior_texture=none.png")
        self.refuse("did you mean", "--set", "display.exterior_texture=appel")
        self.refuse("is not a PNG image: convert it to PNG", "--set", "display.exterior_texture=text.png")
        self.refuse("16384 x 16384 pixels, more than the 4096", "--set", "display.exterior_texture=huge.png")
        self.refuse("a column of at least two square slices", "--set", "display.interior_texture=flat.png", name="interior_texture")
        self.refuse("is not a PNG image", "--set", "display.interior_texture=./scan.nrrd", name="interior_texture")

    def test_a_cut_or_false_file_is_refused_before_the_run_starts(self):
        whole = png(64, 64, noise)
        for name, data in (("cut", whole[: len(whole) // 2]), ("head", whole[:33]), ("sum", whole[:60] + b"xxxx" + whole[64:]),
                           ("size", png(64, 64, noise, claimed=(64, 65)))):
            (self.folder / "bad.png").write_bytes(data)
            with self.subTest(name):
                self.refuse("save the image again", "--set", "display.exterior_texture=bad.png", commands=("render", "drill"), name="bad.png")

    def test_memory_of_a_mesh_is_predicted_and_limits_render(self):
        def predicted(*sets):
            plan = json.loads(run("explain", QUICK, "--json", *[a for s in sets for a in ("--set", s)]).stdout)
            return next(e["bytes"] for e in plan["effects"] if e["name"] == "display")
        plain, textured = predicted("display.method=mesh"), predicted("display.method=mesh", "display.interior_texture=bone")
        volume = 4 * 96 ** 3
        self.assertGreater(textured - plain, 2 * volume)
        for sets in (["display.method=mesh"], ["display.method=mesh", "display.exterior_texture=bone", "display.interior_texture=bone"]):
            with self.subTest(sets=sets):
                out = self.folder / "run"
                done = run("drill", QUICK, "--force", "--out", out, *[a for s in sets for a in ("--set", s)])
                self.assertEqual(done.returncode, 0, done.stderr)
                memory = json.loads((out / "summary.json").read_text())["memory"]
                self.assertLess(abs(memory["predicted_bytes"] / memory["peak_bytes"] - 1.0), 0.15, memory)
        rays = memory["predicted_bytes"] - textured + predicted()
        limit = ("--set", f"limits.memory_mb={(rays + (memory['predicted_bytes'] - textured + plain)) / 2 * 1e-6}")
        image = self.folder / "none.png"
        self.assertGreater(plain, predicted() + 2_000_000)
        drawn = run("render", QUICK, *limit, "--image", image)
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        image.unlink()
        refused = run("render", QUICK, *limit, "--method", "mesh", "--image", image)
        self.assertEqual((refused.returncode, len(lines(refused.stderr))), (2, 1), refused.stderr)
        self.assertIn("limits.memory_mb is exceeded: the picture may need", refused.stderr)
        self.assertFalse(image.exists())


if __name__ == "__main__":
    main()
