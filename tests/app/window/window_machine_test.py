"""What desktop and machine do to a window: another scale, no quad-buffered stereo, names that are not UTF-8.

Run and skipped as window_test.py. BURRHOLE_SCALE_CHANGE names the library of tests/support/scale_change.c.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from window_support import PATIENCE, PROGRAM, QUICK, WindowTest, missing, panel_of, run, size_of, write_shell


class Machine(WindowTest):
    def copy_scene(self, name):
        """A copy of the quick scene, with that name of bytes."""
        shutil.copy(pathlib.Path(QUICK).parent / "pin_2mm.toml", self.folder)
        shutil.copy(QUICK, os.path.join(os.fsencode(self.folder), name))

    def only_run(self):
        """The folder of the only run, as bytes."""
        out = os.path.join(os.fsencode(self.folder), b"out")
        (name,) = os.listdir(out)
        return os.path.join(out, name)

    def test_letters_follow_the_scale_of_the_desktop_while_the_window_is_open(self):
        scale = self.folder / "scale"
        self.display.environment |= {"LD_PRELOAD": os.environ["BURRHOLE_SCALE_CHANGE"], "BURRHOLE_SCALE_FILE": str(scale)}
        self.start()
        before = self.picture()
        time.sleep(7.0)  # the line that names a screenshot has gone
        scale.write_text("1.5")
        time.sleep(1.0)
        large = self.picture()
        self.assertEqual(size_of(large), size_of(before))  # the window keeps its pixels; its letters follow
        self.assertGreater(panel_of(large), panel_of(before) * 1.35)  # 1.5, less a scroll bar
        self.press("ctrl+plus")  # what the person adds is a factor of it
        time.sleep(0.5)
        self.assertGreater(panel_of(self.picture()), panel_of(large) * 1.05)
        self.press("ctrl+0")
        scale.write_text("1.0")
        time.sleep(7.0)
        self.assertEqual(panel_of(self.picture()), panel_of(before))
        self.assertEqual(self.end()["end"], "done")

    def test_a_driver_without_quad_buffered_stereo_is_one_line(self):
        refused = run("drill", QUICK, "--window", "--stereo", "quad", "--out", self.out, env=self.display.environment)
        self.assertEqual(refused.returncode, 4, refused.stderr)
        self.assertEqual(len(refused.stderr.splitlines()), 1, refused.stderr)
        for part in ("quad-buffered stereo", "side-by-side", "anaglyph"):
            self.assertIn(part, refused.stderr)
        self.assertFalse(self.out.exists())

    def test_a_scene_whose_name_is_not_utf_8_is_opened_drilled_and_watched(self):
        self.copy_scene(b"a \xff scene.toml")
        self.display.environment.pop("BURRHOLE_DATA", None)
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press(*["Down"] * 3, "Return")  # opens files
        time.sleep(1.0)
        self.press("Return")
        self.interrupt_when_ready()
        out = self.only_run()
        self.assertIn(b"a \xff scene-", out)
        for name in (b"report.html", b"summary.json"):
            pathlib.Path(os.fsdecode(os.path.join(out, name))).read_bytes().decode("utf-8")
        self.assertIn("a \\xff scene", pathlib.Path(os.fsdecode(os.path.join(out, b"report.html"))).read_text())
        again = subprocess.run([PROGRAM, "replay", os.path.join(out, b"session.sqlite")], capture_output=True, timeout=PATIENCE, check=False)
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_a_scan_whose_name_is_not_utf_8_is_opened_and_its_scene_drills_again(self):
        write_shell(self.folder / "shell.mha")
        os.rename(self.folder / "shell.mha", os.path.join(os.fsencode(self.folder), b"\xfe shell.mha"))
        self.display.environment.pop("BURRHOLE_DATA", None)
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press(*["Down"] * 3, "Return")
        time.sleep(0.5)
        self.press("Return")
        time.sleep(5.0)
        self.press("4", "Return")
        self.interrupt_when_ready()
        out = self.only_run()
        scene = os.path.join(out, b"scene.toml")
        self.assertIn("\\xfe shell", pathlib.Path(os.fsdecode(scene)).read_text(encoding="utf-8"))
        again = subprocess.run([PROGRAM, "drill", scene, "--offscreen", "--quiet", "--out", str(self.folder / "again")], capture_output=True,
                               timeout=PATIENCE, check=False)
        self.assertEqual(again.returncode, 0, again.stderr)


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is missing")
        sys.exit(77)
    unittest.main(verbosity=2)
