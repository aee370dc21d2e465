"""A bone that is larger than [limits] memory_mb allows is kept in a temporary file: the same run in less memory.

Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import json
import math
import os
import re
import struct

from program_support import main, run, WithFolder

RADIUS_MM, THICKNESS_MM, EDGE, PITCH_MM = 60.0, 6.0, 92, 1.5


def write_shell(path):
    """Writes a scan of a hollow sphere of bone, 1000 HU in air of -1000, as NRRD."""
    half = 0.5 * PITCH_MM * (EDGE - 1)
    squares = [(PITCH_MM * n - half) ** 2 for n in range(EDGE)]
    low, high = (RADIUS_MM - THICKNESS_MM) ** 2, RADIUS_MM ** 2
    rows = [[1000 if low <= x + y + z <= high else -1000 for x in squares] for z in squares for y in squares]
    header = (f"NRRD0004\ntype: int16\ndimension: 3\nsizes: {EDGE} {EDGE} {EDGE}\nspace: left-posterior-superior\n"
              f"space directions: ({PITCH_MM},0,0) (0,{PITCH_MM},0) (0,0,{PITCH_MM})\nspace origin: ({-half},{-half},{-half})\n"
              "encoding: raw\nendian: little\n\n")
    path.write_bytes(header.encode() + b"".join(struct.pack(f"<{EDGE}h", *row) for row in rows))


SCENE = """title = "Hollow sphere"
duration_s = 1.5
[volume]
source = "shell.nrrd"
spacing_mm = 0.3
[tool]
name = "round_burr_4mm"
spin_rpm = 3000.0
[approach]
entry_mm = [0.0, 0.0, 60.0]
axis = [0.0, 0.0, -1.0]
[hand]
kind = "script"
push_N = 10.0
[contact]
[erosion]
"""


class PagedBone(WithFolder):
    def drill(self, name, *arguments):
        out = self.folder / name
        done = run("drill", self.folder / "scene.toml", "--out", out, "--force", *arguments)
        return done, json.loads((out / "summary.json").read_text()) if done.returncode == 0 else None

    def predicted(self, *arguments):
        """@returns the predicted memory [MB] with the bone in memory and in a file, from the line of a run with a limit between the two."""
        explained = run("explain", self.folder / "scene.toml", "--set", "limits.memory_mb=200", *arguments)
        self.assertEqual(explained.returncode, 0, explained.stderr)
        found = re.search(r"in memory the run may need (\d+) MB, more than memory_mb = 200, so it may need (\d+) MB", explained.stdout)
        self.assertTrue(found, explained.stdout)
        return int(found.group(1)), int(found.group(2))

    def setUp(self):
        super().setUp()
        write_shell(self.folder / "shell.nrrd")
        (self.folder / "scene.toml").write_text(SCENE)

    def test_a_limit_below_the_memory_of_the_bone_gives_the_same_run_in_less_memory(self):
        inputs = self.folder / "inputs.toml"
        inputs.write_text('[[input]]\ntime_s = 0.8\nkind = "checkpoint"\nname = "a"\n[[input]]\ntime_s = 1.1\nkind = "restore"\nname = "a"\n')
        # The prediction of undo history and checkpoints is within a tenth.
        for arguments, margin in (([], 1.0), (["--inputs", inputs], 1.1)):
            with self.subTest(arguments=arguments):
                done, plain = self.drill("plain", *arguments)
                self.assertEqual(done.returncode, 0, done.stderr)
                refused, _ = self.drill("none", *arguments, "--set", "limits.memory_mb=60")
                self.assertEqual(refused.returncode, 2)
                self.assertFalse((self.folder / "none").exists())
                self.assertIn("limits.memory_mb is exceeded", refused.stderr)
                in_memory, paged = self.predicted(*arguments)
                # The shell has 4 pi 60^2 6 mm^3 of bone, 10 million voxels with three floats each; the file leaves an index in memory.
                self.assertLess(paged, in_memory - 100)
                limit = math.ceil(margin * paged + 1)
                self.assertGreater(plain["memory"]["peak_bytes"], limit * 1e6, "the bone in memory does not keep this limit")
                done, summary = self.drill("paged", *arguments, "--set", f"limits.memory_mb={limit}")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertLessEqual(summary["memory"]["peak_bytes"], limit * 1e6)
                self.assertEqual(summary["hash"], plain["hash"])
                self.assertEqual(summary["drilling"], plain["drilling"])
                notes = [line for line in done.stderr.splitlines() if "temporary file" in line]
                self.assertEqual(len(notes), 1, done.stderr)
                self.assertRegex(notes[0], rf"in memory the run may need {in_memory} MB, more than memory_mb = {limit}, so it may need {paged} MB")
                self.assertIn("bone.vdb will hold the changes alone", notes[0])
                self.assertLess((self.folder / "paged" / "bone.vdb").stat().st_size * 10, (self.folder / "plain" / "bone.vdb").stat().st_size)
                restored, after = self.drill("restored", "--restore", self.folder / "paged" / "bone.vdb", "--set", "duration_s=0.1")
                self.assertEqual(restored.returncode, 0, restored.stderr)
                self.assertEqual(after["hash"]["voxels"], plain["hash"]["voxels"])

    def test_no_room_for_the_file_is_one_line_with_the_folder_and_no_output(self):
        _, paged = self.predicted()
        os.environ["TMPDIR"] = str(self.folder / "not_there")
        try:
            refused, _ = self.drill("none", "--set", f"limits.memory_mb={paged + 1}")
        finally:
            del os.environ["TMPDIR"]
        self.assertEqual(refused.returncode, 4)
        self.assertRegex(refused.stderr, r"temporary file of the bone in .*not_there cannot be made: .*; it needs about \d+\.\d MB; TMPDIR")
        self.assertFalse((self.folder / "none").exists())

    def test_a_bone_model_is_moved_into_the_file_where_reading_it_keeps_the_limit(self):
        made = run("import", self.folder / "shell.nrrd", "--volume", self.folder / "shell.vdb", "--spacing-mm", "0.3")
        self.assertEqual(made.returncode, 0, made.stderr)
        (self.folder / "scene.toml").write_text(SCENE.replace('shell.nrrd"\nspacing_mm = 0.3', 'shell.vdb"'))
        done, plain = self.drill("plain")
        self.assertEqual(done.returncode, 0, done.stderr)
        refused, _ = self.drill("none", "--set", "limits.memory_mb=60")
        in_memory, paged = (int(n) for n in re.search(r"may need (\d+) MB: .*; (\d+) MB with", refused.stderr).groups())
        done, summary = self.drill("paged", "--set", f"limits.memory_mb={0.5 * (in_memory + paged)}")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("temporary file", done.stderr)
        self.assertEqual(summary["hash"], plain["hash"])


if __name__ == "__main__":
    main()
