"""The program without a command, as a person meets it: scenes, files, a place on a scan; and the size of letters.

Run and skipped as window_test.py.
"""
import json
import shutil
import signal
import sys
import time
import unittest

from window_support import PATIENCE, TESTS, WindowTest, missing, panel_of, run, size_of, write_shell


class Chooser(WindowTest):
    def open_files(self):
        """Chooses the line that opens files; the folder is that of the test."""
        self.display.environment.pop("BURRHOLE_DATA", None)
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press(*["Down"] * 3, "Return")  # below the three scenes that need no scan
        time.sleep(0.5)

    def test_a_scan_is_opened_a_place_is_chosen_and_its_scene_drills_again(self):
        (self.folder / "a torn.mha").write_text("ObjectType = Image\nNDims = 3\n")
        write_shell(self.folder / "shell.mha")
        self.open_files()
        self.press("Return")  # a line says that it is torn; another file can be chosen
        time.sleep(1.0)
        self.assertIsNone(self.process.poll(), self.log.read_text())
        self.press("Down", "Return")
        time.sleep(5.0)
        self.press("4", "Left", "shift+Up")
        self.display.tool("mousemove", "--window", self.window, 380, 240)
        self.display.tool("click", "1")
        time.sleep(1.0)
        self.press("Return")
        self.interrupt_when_ready()
        scene = next((self.folder / "out").glob("shell-*/scene.toml"))
        self.assertTrue((scene.parent / "summary.json").exists())
        again = run("drill", scene, "--offscreen", "--quiet", "--out", self.folder / "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        summary = json.loads((self.folder / "again" / "summary.json").read_text())
        # The shell is 6 mm thick along every radius, and the bit stands square to it.
        self.assertAlmostEqual(summary["drilling"]["thickness_mm"], 6.0, delta=0.25)
        self.assertIsNotNone(summary["drilling"]["breakthrough_s"])

    def test_a_scene_file_is_opened(self):
        shutil.copy(TESTS.parent / "app" / "scenes" / "parietal.toml", self.folder / "mine.toml")
        self.open_files()
        self.press("Return")
        self.interrupt_when_ready()
        self.assertEqual(len(list((self.folder / "out").glob("mine-*/summary.json"))), 1)

    def test_letters_grow_and_shrink_while_the_window_is_open(self):
        self.start()
        before = self.picture()
        self.press(*["ctrl+plus"] * 3)
        time.sleep(0.5)
        large = self.picture()
        self.press("ctrl+0")
        time.sleep(7.0)  # the line that names a screenshot has gone
        self.assertEqual(size_of(large), size_of(before))
        self.assertGreater(panel_of(large), panel_of(before) * 1.2)  # 1.42, less a scroll bar
        self.assertEqual(panel_of(self.picture()), panel_of(before))
        summary = self.end()
        self.assertEqual(summary["end"], "done")

    def test_a_chooser_is_closed_by_a_key_and_by_a_signal(self):
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 0, self.log.read_text())
        self.start_program()
        self.find_window()
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(PATIENCE), 130, self.log.read_text())
        self.start_program()
        self.find_window()
        self.display.server.kill()
        self.display.server.wait()
        self.assertNotEqual(self.process.wait(PATIENCE), -signal.SIGKILL, self.log.read_text())
        self.assertIn("the display was lost", self.log.read_text())

    def test_without_a_command_a_person_chooses(self):
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press("Return")  # the first scene
        self.interrupt_when_ready()
        results = list((self.folder / "out").iterdir())
        self.assertEqual(len(results), 1)
        self.assertTrue((results[0] / "summary.json").exists())
        self.start_program()
        self.find_window()
        time.sleep(1.0)
        self.press(*["Down"] * 10, "Return")  # the last line: the session
        self.wait_until(lambda: "window: ready" in self.log.read_text(), "the session")
        self.find_window()
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 0, self.log.read_text())


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is missing")
        sys.exit(77)
    unittest.main(verbosity=2)
