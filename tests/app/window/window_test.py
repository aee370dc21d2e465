"""The window as a person meets it: under a virtual display with a window manager, driven by synthetic keys and mouse alone.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 where Xvfb, openbox or xdotool is missing. Pictures of the window go to the
folder BURRHOLE_PICTURES, if it is set.
"""
import contextlib
import json
import os
import random
import signal
import sqlite3
import sys
import time
import unittest

from window_support import PATIENCE, QUICK, WindowTest, missing, run, size_of
import session_blocks
import virtual_pad


class Window(WindowTest):
    def test_a_person_drills_through_with_keys_alone_and_the_session_replays(self):
        self.start()
        before = self.picture()
        self.press("F1")
        self.picture()
        self.press("F1", "x")
        self.hold("w", 8.0)
        self.picture()
        self.hold("s", 1.5)
        self.press("x", "2")  # another tool, out of the bone
        time.sleep(1.0)
        self.press("F2", "F9")
        time.sleep(1.0)
        after = self.picture()
        self.assertNotEqual(before.read_bytes(), after.read_bytes())
        summary = self.end()
        self.assertEqual(summary["end"], "done")
        self.assertIsNotNone(summary["drilling"]["breakthrough_s"], summary)
        self.assertGreater(summary["drilling"]["removed_mm3"], 1.0)
        self.assertTrue((self.out / "after.png").exists())
        (surface,) = self.out.glob("bone_at_*s.stl")
        data = surface.read_bytes()
        self.assertEqual(len(data), 84 + 50 * int.from_bytes(data[80:84], "little"))
        self.assertIn("pictures a second while the drill ran", self.log.read_text())
        self.assert_replays()

    def test_an_undo_brings_the_bone_back(self):
        self.start()
        self.press("x")
        self.hold("w", 5.0)
        self.hold("s", 1.5)
        self.press("x")
        time.sleep(1.0)
        self.press("z")
        time.sleep(1.0)
        self.picture()
        summary = self.end()
        self.assertEqual(summary["drilling"]["removed_mm3"], 0.0)
        self.assertIsNone(summary["drilling"]["breakthrough_s"])
        with contextlib.closing(sqlite3.connect(self.out / "session.sqlite")) as database:
            through = database.execute("SELECT count(*) FROM events WHERE kind = 'breakthrough'").fetchone()[0]
        self.assertEqual(any("was drilled through" in line for line in summary["warnings"]), through > 0)  # an undo hides nothing
        self.assert_replays()

    @unittest.skipIf(virtual_pad.missing(), "umockdev-run is missing")
    def test_a_game_pad_drills_and_is_unplugged(self):
        spins = [(4.0, "right trigger", 255), (4.5, "left trigger", 255)]
        back = [(11.0, "left trigger", 0), (11.1, "right bumper", 1), (12.5, "right bumper", 0), (12.6, "right trigger", 0)]
        # Undo, fine control, the next view; then the drill is on and stays on.
        last = [(13.5, "b", 1), (13.6, "b", 0), (13.7, "left bumper", 1), (13.8, "left bumper", 0), (13.9, "y", 1), (14.0, "y", 0),
                (14.5, "right trigger", 255)]
        self.start(before=virtual_pad.command(self.folder, spins + back + last))
        time.sleep(16.0)
        self.picture()
        virtual_pad.unplug(self.process)
        time.sleep(2.0)
        self.picture()
        summary = self.end()
        self.assertEqual(summary["drilling"]["removed_mm3"], 0.0)  # undone by the pad
        with contextlib.closing(sqlite3.connect(self.out / "session.sqlite")) as database:
            columns = session_blocks.columns(database, "servo")
            spin = [value for _, data in reversed(session_blocks.last_blocks(database, "servo", 4))
                    for value in session_blocks.decode(data, columns)["spin_command"]]
            kinds = [kind for (kind,) in database.execute("SELECT kind FROM events")]
        self.assertIn("undo", kinds)
        self.assertGreater(max(spin), 0.9)
        self.assertEqual(spin[-1], 0.0)  # off, although its trigger was never released
        self.assert_replays()

    def test_mouse_wheel_and_drags(self):
        self.start()
        self.display.tool("mousemove", "--window", self.window, 300, 300)
        self.display.tool("mousedown", 3)
        for n in range(20):
            self.display.tool("mousemove", "--window", self.window, 300 + 6 * n, 300 + 2 * n)
        self.display.tool("mouseup", 3)
        self.picture()
        self.press("x")
        self.display.tool("click", "--repeat", "40", "--delay", "60", "4")
        time.sleep(1.5)
        self.picture()
        summary = self.end()
        self.assertGreater(summary["drilling"]["removed_mm3"], 0.0)
        self.assert_replays()

    def test_a_window_of_any_size_minimised_and_closed_while_drilling(self):
        self.start()
        self.display.tool("windowsize", "--sync", self.window, 700, 500)
        time.sleep(0.5)
        self.assertEqual(size_of(self.picture()), (700, 500))
        self.display.tool("windowsize", "--sync", self.window, 1200, 420)
        self.press("x")
        self.display.tool("keydown", "w")
        self.display.tool("windowminimize", "--sync", self.window)
        time.sleep(1.0)
        self.display.tool("windowmap", "--sync", self.window)
        self.display.tool("windowfocus", "--sync", self.window)
        self.press("x")
        self.hold("w", 2.0)
        self.close()
        self.assertEqual(json.loads((self.out / "summary.json").read_text())["end"], "done")
        self.assertTrue((self.out / "report.html").exists())
        self.assert_replays()

    def test_ctrl_c_ends_the_run_with_its_results(self):
        self.start()
        self.press("x")
        self.hold("w", 1.5)
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(PATIENCE), 130, self.log.read_text())
        self.assertTrue((self.out / "summary.json").exists())
        self.assert_replays()

    def test_a_lost_display_ends_the_run_with_its_results(self):
        self.start()
        self.press("x")
        self.hold("w", 1.5)
        self.display.server.kill()
        self.display.server.wait()
        self.assertEqual(self.process.wait(PATIENCE), 4, self.log.read_text())
        self.assertIn("the display was lost", self.log.read_text())
        self.assertTrue((self.out / "report.html").exists(), list(self.out.iterdir()))
        self.assert_replays()

    def test_a_run_that_never_began_writes_nothing(self):
        self.out.write_text("a file")
        wrong = run("drill", QUICK, "--window", "--out", self.out, env=self.display.environment)
        self.assertEqual(wrong.returncode, 2, wrong.stderr)
        self.assertIn("is a file", wrong.stderr)
        self.out.unlink()
        self.start_program("drill", "parietal", "--window", "--out", self.out)
        self.find_window()
        self.process.send_signal(signal.SIGINT)  # while it loads, or just after
        self.assertEqual(self.process.wait(PATIENCE), 130, self.log.read_text())
        self.assertEqual(self.out.exists(), "nothing was written" not in self.log.read_text())

    def test_a_folder_belongs_to_one_run(self):
        self.start()
        second = run("drill", QUICK, "--offscreen", "--out", self.out)
        self.assertEqual(second.returncode, 2, second.stderr)
        self.assertIn(f"in use by process {self.process.pid} ", second.stderr)
        self.end()
        self.assert_replays()

    def test_a_monkey_ends_nothing(self):
        self.start()
        dice = random.Random(7)
        keys = ["w", "s", "a", "d", "q", "e", "x", "z", "p", "f", "v", "r", "h", "1", "2", "3", "F1", "F2", "Left", "Right", "Up", "Down", "plus",
                "minus", "Home", "Tab"]
        for _ in range(150):
            what = dice.random()
            if what < 0.5:
                self.display.tool(dice.choice(["key", "keydown", "keyup"]), dice.choice(keys))
            elif what < 0.7:
                self.display.tool("mousemove", "--window", self.window, dice.randrange(400), dice.randrange(300))
            elif what < 0.9:
                self.display.tool(dice.choice(["click", "mousedown", "mouseup"]), dice.randrange(1, 6))
            else:
                self.display.tool("windowsize", self.window, dice.randrange(480, 1300), dice.randrange(320, 860))
            self.assertIsNone(self.process.poll(), self.log.read_text())
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(PATIENCE), 130, self.log.read_text())
        self.assert_replays()

    def test_a_demonstration_by_the_scene_s_own_hand(self):
        self.start("--demo")
        self.picture()
        self.wait_until(lambda: (self.out / "report.html").exists(), "the report")
        self.close()
        self.assertIsNotNone(json.loads((self.out / "summary.json").read_text())["drilling"]["breakthrough_s"])
        self.assert_replays()

    def test_a_mesh_is_drilled_live_and_cut_open(self):
        self.start("--set", "display.method=mesh")
        before = self.picture()
        self.press("x")
        self.hold("w", 5.0)
        self.hold("s", 1.5)
        self.press("x")
        time.sleep(1.0)
        drilled = self.picture()
        self.assertNotEqual(before.read_bytes(), drilled.read_bytes())
        self.press("k")
        time.sleep(1.0)
        self.assertNotEqual(drilled.read_bytes(), self.picture().read_bytes())
        self.press("l")
        time.sleep(1.0)
        self.picture()
        summary = self.end()
        self.assertGreater(summary["drilling"]["removed_mm3"], 0.5)
        self.assert_replays()

    def test_a_demonstration_is_taken_over(self):
        self.start("--demo")
        time.sleep(3.0)
        self.press("k", "l")
        self.press("t")
        self.hold("w", 2.0)
        self.picture()
        self.press("x")
        self.hold("s", 1.0)
        summary = self.end()
        self.assertEqual(summary["end"], "done")
        self.assertIn("until a user took the drill over", (self.out / "report.html").read_text())
        with contextlib.closing(sqlite3.connect(self.out / "session.sqlite")) as database:
            self.assertIn(("the user takes the drill over",), database.execute("SELECT text FROM events WHERE kind = 'mark'").fetchall())
        self.assert_replays()

    def test_a_demonstration_is_ended_by_closing_the_window(self):
        self.start("--demo")
        started = time.monotonic()
        self.close()
        self.assertEqual(json.loads((self.out / "summary.json").read_text())["end"], "stopped")
        self.assertLess(json.loads((self.out / "summary.json").read_text())["duration_s"], time.monotonic() - started + 1.0)

    def test_a_session_is_watched_on_its_time_line(self):
        drilled = run("drill", QUICK, "--offscreen", "--out", self.out)
        self.assertEqual(drilled.returncode, 0, drilled.stderr)
        session = (self.out / "session.sqlite").read_bytes()
        self.start_program("replay", self.out / "session.sqlite", "--view")
        self.wait_until(lambda: "window: ready" in self.log.read_text(), "the first state")
        self.find_window()
        self.press("space", "Home")
        time.sleep(1.0)
        start = self.picture()
        self.press(*["Right"] * 3)
        time.sleep(3.0)
        later = self.picture()
        self.assertNotEqual(start.read_bytes(), later.read_bytes())
        self.press("shift+Left", "shift+Left", "Home")  # each begins again
        time.sleep(1.0)
        self.press(*["Up"] * 4, "space")
        self.wait_until(lambda: "bit for bit" in self.log.read_text(), "the end of the session")
        self.press("F1")
        self.picture()
        self.display.tool("mousemove", "--window", self.window, 300, 740)
        self.display.tool("click", 1)  # on the line
        time.sleep(1.0)
        self.press("F1", "Escape")
        self.assertEqual(self.process.wait(PATIENCE), 0, self.log.read_text())
        self.assertNotIn("DIFFER", self.log.read_text())
        self.assertEqual(session, (self.out / "session.sqlite").read_bytes())

    def watch(self, *arguments):
        self.start_program("replay", self.out / "session.sqlite", "--view", *arguments)
        self.wait_until(lambda: "window: ready" in self.log.read_text(), "the first state")
        self.find_window()

    def quiet_picture(self):
        """A picture without the lines that tell of earlier ones."""
        time.sleep(7.0)
        return self.picture().read_bytes()

    def test_a_jump_back_over_inputs_shows_what_was_there_before(self):
        inputs = self.folder / "inputs.toml"
        rows = [(0.69, "export", ""), (0.8, "spin", "value = 0.0"), (1.0, "undo", ""), (1.1, "tool", 'name = "round_burr_4mm"'), (1.2, "spin", "value = 1.0")]
        inputs.write_text("".join(f'[[input]]\ntime_s = {at}\nkind = "{kind}"\n{key}\n' for at, kind, key in rows))
        drilled = run("drill", QUICK, "--offscreen", "--inputs", inputs, "--out", self.out)
        self.assertEqual(drilled.returncode, 0, drilled.stderr)
        self.watch()
        self.press("space", "Home", *["shift+Right"] * 70)  # 0.7 s: bone is cut, before the undo
        self.press("F9")
        exported = self.out / "bone_at_0.700s.stl"
        self.wait_until(exported.exists, "the bone of that moment")
        # A replay cuts bone when a step needs it: the step of bone that ends at 0.7 s is still to come.
        self.assertEqual(exported.read_bytes(), (self.out / "bone_at_0.690s.stl").read_bytes())
        before = self.quiet_picture()
        self.press("Right")  # over undo and change of the tool
        between = self.quiet_picture()
        self.press("Left")
        self.assertEqual(self.quiet_picture(), before)
        self.assertNotEqual(before, between)
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 0, self.log.read_text())

    def test_a_session_that_differs_is_exit_code_3(self):
        drilled = run("drill", QUICK, "--offscreen", "--out", self.out)
        self.assertEqual(drilled.returncode, 0, drilled.stderr)
        with contextlib.closing(sqlite3.connect(self.out / "session.sqlite")) as database:
            database.execute("UPDATE hashes SET value = '0000000000000001' WHERE kind = 'voxels'")
            database.commit()
        self.watch()
        self.press(*["Up"] * 4)
        self.wait_until(lambda: "DIFFER" in self.log.read_text(), "the end of the session")
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 3, self.log.read_text())

    def test_the_session_of_a_killed_run_is_watched_to_its_end_once(self):
        self.start()
        self.press("x")
        self.hold("w", 3.0)
        self.process.kill()
        self.process.wait()
        self.watch()
        self.press(*["Up"] * 4)
        self.wait_until(lambda: "cut short" in self.log.read_text(), "the end of the session")
        time.sleep(3.0)
        self.assertEqual(self.log.read_text().count("cut short"), 1)
        self.picture()
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 3, self.log.read_text())
        self.assertIn("nothing was compared: the recorded run was cut short", self.log.read_text())
        self.watch("--allow-partial")
        self.press("Escape")
        self.assertEqual(self.process.wait(PATIENCE), 0, self.log.read_text())
        self.assertIn("nothing was compared", self.log.read_text())

    def test_a_renderer_that_cannot_be_made_is_one_line(self):
        empty = self.folder / "shaders"
        empty.mkdir()
        result = run("drill", QUICK, "--window", "--shader-dir", empty, "--out", self.out, env=self.display.environment)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertFalse(self.out.exists())

    def test_what_cannot_be_shown_is_one_line(self):
        plain = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        none = run("drill", QUICK, "--window", "--out", self.out, env=plain)
        self.assertEqual(none.returncode, 4)
        self.assertIn("there is no display", none.stderr)
        gone = run("drill", QUICK, "--out", self.out, env={**plain, "DISPLAY": ":4242"})
        self.assertEqual(gone.returncode, 4)
        self.assertIn("--offscreen", gone.stderr)
        both = run("drill", QUICK, "--window", "--offscreen", "--out", self.out, env=plain)
        self.assertEqual(both.returncode, 2)
        self.assertFalse(self.out.exists())
        hidden = run("replay", "none.sqlite", "--view", env=plain)
        self.assertEqual(hidden.returncode, 4)
        self.assertIn("there is no display", hidden.stderr)
        nothing = run("replay", self.folder / "none.sqlite", "--view", env=self.display.environment)
        self.assertEqual(nothing.returncode, 2)
        self.assertIn("none.sqlite", nothing.stderr)
        helped = run(env=plain)
        self.assertEqual(helped.returncode, 4)
        self.assertIn("there is no display", helped.stderr)
        self.assertIn("--help", helped.stderr)
        offscreen = run("drill", QUICK, "--offscreen", "--out", self.out, env={**plain, "DISPLAY": ":4242"})
        self.assertEqual(offscreen.returncode, 0, offscreen.stderr)


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is missing")
        sys.exit(77)
    unittest.main(verbosity=2)
