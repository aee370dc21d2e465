"""Timed inputs of a run, from a file: what an undo leaves of the figures, and the example of docs/inputs.md.

Run by ctest with the program's path in BURRHOLE_PROGRAM. Needs no drawing.
"""
import json
import re
import unittest

from program_support import run, SOURCE, WithFolder


class Undone(WithFolder):
    """What an undo takes back is no figure of the hole that is left."""

    def drilled(self, inputs):
        path = self.folder / "inputs.toml"
        path.write_text(inputs)
        result = run("drill", "parietal", "--no-pictures", "--offscreen", "--inputs", path, "--out", self.folder / "out", "--force", "--json", "--quiet",
                     "--set", "duration_s=5.0")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_the_depth_after_an_undo_is_that_in_the_bone_that_is_back(self):
        stop = '[[input]]\ntime_s = 4.0\nkind = "spin"\nvalue = 0.0\n'
        before, after = self.drilled(stop), self.drilled(stop + '[[input]]\ntime_s = 4.5\nkind = "undo"\n')
        self.assertGreater(before["drilling"]["reached_mm"], 0.5)
        self.assertLess(after["drilling"]["reached_mm"], 0.1 * before["drilling"]["reached_mm"])
        self.assertIn(f"{after['drilling']['reached_mm']:.2f} mm deep", after["outcome"])


class Example(WithFolder):
    def test_the_example_of_inputs_drills_through(self):
        """It changes the tool after an undo: the hand's rules of breakthrough are those of the tool in hand."""
        inputs = self.folder / "inputs.toml"
        inputs.write_text(re.search(r"```toml\n(.*?)```", (SOURCE / "docs" / "inputs.md").read_text(), re.S)[1])
        result = run("drill", "parietal", "--no-pictures", "--offscreen", "--inputs", inputs, "--out", self.folder / "run", "--unset", "record", "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["result"], "drilled-through")


if __name__ == "__main__":
    unittest.main(verbosity=2)
