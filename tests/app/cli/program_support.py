"""What the tests of the built program share: running it, scenes in a folder of their own. BURRHOLE_PROGRAM names the program."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
SCENES = SOURCE / "tests" / "data" / "scenes"
QUICK = SCENES / "quick_plate.toml"
# Keys of [display] that a picture of a plate shows, and a value that is not their default.
LOOKS = {"tissue": "plain", "normals": "recomputed", "scale_bar": "false", "background_top": "[0, 0, 0]"}
PLACE = re.compile(r"^(?P<file>[^:]+):(?P<line>\d+):(?P<column>\d+): .+")


def without_display():
    """The environment of a program that must not open a window."""
    return {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


def run(*arguments, **options):
    options.setdefault("env", without_display())
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def lines(text):
    return [line for line in text.splitlines() if line.strip()]


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-program-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def scene(self, text, name="scene.toml"):
        shutil.copy(SCENES / "pin_2mm.toml", self.folder)
        path = self.folder / name
        path.write_text(text)
        return path

    def quick(self, replace=(), append=""):
        text = QUICK.read_text()
        for old, new in replace:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.scene(text + append)


def main():
    """Runs the calling module's tests; exits 77 where this machine cannot draw."""
    with tempfile.TemporaryDirectory() as probe:
        if run("render", QUICK, "--image", os.path.join(probe, "probe.png"), "--size", "16x16").returncode == 4:
            sys.exit(77)
    unittest.main(verbosity=2)
