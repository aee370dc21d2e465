"""A film of a run: its frames, a video by a stand-in for ffmpeg, and what is refused.

Run by ctest with the program's path in BURRHOLE_PROGRAM; exits 77 when it cannot draw here.
"""
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import time
import zlib

from program_support import PROGRAM, QUICK, WithFolder, lines, main, run

SIZE = (64, 48)
DURATION = 1.2  # [s]
# Stands for ffmpeg: keeps its arguments and all bytes that it reads, and writes the file that is its last argument.
STAND_IN = """#!/bin/sh
echo "$@" > "$FILM_LOG"
for last; do :; done
cat > "${{last#file:}}"
{}
"""


def pixels_of(path):
    """RGB rows of a PNG with 8 bits a channel, by its own filters."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        part = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, _, colour = struct.unpack(">IIBB", part[:10])
            channels = {2: 3, 6: 4}[colour]
        if kind == b"IDAT":
            packed += part
        at += 12 + size
    raw, stride = zlib.decompress(packed), width * channels
    rows, before = [], bytearray(stride)
    for y in range(height):
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = line[x - channels] if x >= channels else 0
            up, corner = before[x], before[x - channels] if x >= channels else 0
            nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
            line[x] = (line[x] + (0, left, up, (left + up) // 2, nearest)[raw[y * (stride + 1)]]) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, channels)])
        before = line
    return rows


class Film(WithFolder):
    def drill(self, *arguments, **options):
        return run("drill", QUICK, "--json", "--set", f"duration_s={DURATION}", "--set", f"display.size=[{SIZE[0]}, {SIZE[1]}]",
                   "--out", self.folder / "out", *arguments, **options)

    def with_stand_in(self, ending=""):
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "ffmpeg").write_text(STAND_IN.format(ending))
        (tools / "ffmpeg").chmod(0o755)
        return {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "FILM_LOG": str(self.folder / "arguments")}

    def test_a_folder_gets_all_frames_and_the_run_is_the_same_as_without(self):
        plain = self.drill()
        self.assertEqual(plain.returncode, 0, plain.stderr)
        film = self.folder / "film"
        film.mkdir()
        (film / "frame_999999.png").write_text("of an earlier film")
        (film / "notes.txt").write_text("of a user")
        (film / "frame_of_reference.png").write_text("of a user")
        there = {path.name: path.read_bytes() for path in film.iterdir()}
        refused = self.drill("--video", film, "--video-fps", 20)
        self.assertEqual((refused.returncode, len([l for l in lines(refused.stderr) if "holds 1 frame of a film, frame_999999.png for example" in l])),
                         (2, 1), refused.stderr)
        self.assertIn("give another folder by --video, or --force to replace them", refused.stderr)
        self.assertEqual({path.name: path.read_bytes() for path in film.iterdir()}, there)
        filmed = self.drill("--video", film, "--video-fps", 20, "--force")
        self.assertEqual(filmed.returncode, 0, filmed.stderr)
        count = round(DURATION * 20)
        self.assertEqual(sorted(p.name for p in film.iterdir()), [f"frame_{n:06}.png" for n in range(count)] + ["frame_of_reference.png", "notes.txt"])
        self.assertIn(f"film: {count} frames, 20 a second, in {film}", filmed.stderr)
        first, second = json.loads(plain.stdout), json.loads(filmed.stdout)
        self.assertEqual(first["hash"], second["hash"])
        self.assertEqual(first["drilling"], second["drilling"])
        self.assertNotEqual((film / "frame_000000.png").read_bytes(), (film / f"frame_{count - 1:06}.png").read_bytes())

    def test_a_frame_shows_bone_and_tool_as_a_picture_of_that_moment_does(self):
        film, out = self.folder / "film", self.folder / "out"
        # A hand that moves by 0.1 um until the only frame: a pixel at an outline may flip.
        still = ["--set", "tool.spin_rpm=0", "--set", "hand.feed_mm_per_s=0.001", "--set", "hand.tremor_mm=0", "--set", "duration_s=0.1"]
        self.assertEqual(self.drill("--video", film, "--video-fps", 10, *still).returncode, 0)

        def differing(picture):
            return sum(a != b for of, row in zip(pixels_of(film / "frame_000000.png"), pixels_of(out / picture)) for a, b in zip(of, row))
        without_tool = differing("after.png")
        self.assertGreater(without_tool, 4)
        self.assertLess(differing("before.png"), without_tool / 4)

    def test_a_video_is_given_the_pixels_of_the_frames(self):
        film, video = self.folder / "film", self.folder / "film.mp4"
        self.assertEqual(self.drill("--video", film, "--video-fps", 10).returncode, 0)
        result = self.drill("--video", video, "--video-fps", 10, env=self.with_stand_in())
        self.assertEqual(result.returncode, 0, result.stderr)
        words = (self.folder / "arguments").read_text()
        self.assertIn(f"-s {SIZE[0]}x{SIZE[1]} -r 10 -i pipe:0", words)
        self.assertRegex(words, rf"-f mp4 file:{re.escape(str(video))}\.\d+-[0-9a-f]{{16}}\.tmp")
        raw, count = video.read_bytes(), round(DURATION * 10)
        self.assertEqual(len(raw), count * SIZE[0] * SIZE[1] * 4)
        for n in (0, count - 1):
            rgba = raw[n * SIZE[0] * SIZE[1] * 4:(n + 1) * SIZE[0] * SIZE[1] * 4]
            rows = [[tuple(rgba[4 * (y * SIZE[0] + x):][:3]) for x in range(SIZE[0])] for y in range(SIZE[1])]
            self.assertEqual(rows, pixels_of(film / f"frame_{n:06}.png"))
        self.assertEqual(list(self.folder.glob("film.mp4.*")), [])

    def test_an_ffmpeg_that_fails_is_reported_and_leaves_no_video(self):
        result = self.drill("--video", self.folder / "film.webm", env=self.with_stand_in("exit 3"))
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("ffmpeg failed (exit 3)", lines(result.stderr)[-1])
        (self.folder / "tools" / "ffmpeg").write_text("#!/bin/sh\nexit 1\n")  # it reads no frame
        result = self.drill("--video", self.folder / "film.mkv", env={**os.environ, "PATH": f"{self.folder}/tools:{os.environ['PATH']}"})
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("ffmpeg failed", lines(result.stderr)[-1])
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith("film")], [])

    def test_ctrl_c_ends_the_run_and_completes_the_video(self):
        video = self.folder / "film.mp4"
        process = subprocess.Popen([PROGRAM, "drill", str(QUICK), "--out", str(self.folder / "out"), "--video", str(video), "--video-fps",
                                    "100", "--set", "display.size=[640, 480]"],
                                   env=self.with_stand_in(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   start_new_session=True)
        while sum(part.stat().st_size for part in self.folder.glob("film.mp4.*.tmp")) < 3 * 640 * 480 * 4:
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: all of the group in the foreground
        message = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 130, message)
        self.assertGreater(video.stat().st_size, 2 * 640 * 480 * 4)
        self.assertEqual(video.stat().st_size % (640 * 480 * 4), 0)
        self.assertTrue((self.folder / "out" / "summary.json").exists())

    def test_a_run_without_a_frame_says_so_and_deletes_nothing(self):
        film = self.folder / "film"
        film.mkdir()
        (film / "frame_000000.png").write_text("of an earlier film")
        video = self.folder / "film.mp4"
        video.write_text("an earlier film")
        for target in (film, video):
            result = self.drill("--video", target, "--video-fps", 1, "--set", "duration_s=0.5", "--force", env=self.with_stand_in())
            shutil.rmtree(self.folder / "tools")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("the run ended before the first frame of its film", result.stderr)
        self.assertEqual([path.read_text() for path in (film / "frame_000000.png", video)], ["of an earlier film", "an earlier film"])

    def test_a_session_is_filmed_as_its_run_was_and_a_live_one_too(self):
        film, again, live = self.folder / "film", self.folder / "again", self.folder / "live"
        self.assertEqual(self.drill("--video", film, "--video-fps", 10).returncode, 0)
        session = self.folder / "out" / "session.sqlite"
        replayed = run("replay", session, "--video", again, "--video-fps", 10)
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        count = round(DURATION * 10)
        self.assertEqual(sorted(path.name for path in again.iterdir()), [f"frame_{n:06}.png" for n in range(count)])
        self.assertIn(f"film: {count} frames, 10 a second, in {again}", replayed.stderr)
        for n in range(count):
            name = f"frame_{n:06}.png"
            drawn, redrawn = pixels_of(film / name), pixels_of(again / name)
            differing = sum(a != b for of, row in zip(drawn, redrawn) for a, b in zip(of, row))
            # A replay may be a step of the bone behind at the end of a tick: a pixel at an outline may flip.
            self.assertLess(differing, 0.02 * SIZE[0] * SIZE[1], name)
        self.assertNotEqual(pixels_of(again / "frame_000000.png"), pixels_of(again / f"frame_{count - 1:06}.png"))
        refused = run("replay", session, "--video", again, "--video-fps", 10)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn(f"holds {count} frames of a film", refused.stderr)
        forced = run("replay", session, "--video", again, "--video-fps", 5, "--force")
        self.assertEqual(forced.returncode, 0, forced.stderr)
        self.assertEqual(len(list(again.iterdir())), round(DURATION * 5))
        done = run("drill", QUICK, "--live", "--out", live, "--quiet", "--set", "duration_s=0.5", "--set", f"display.size=[{SIZE[0]}, {SIZE[1]}]")
        self.assertEqual(done.returncode, 0, done.stderr)
        video = self.folder / "live.mp4"
        result = run("replay", live / "session.sqlite", "--video", video, "--video-fps", 10, env=self.with_stand_in())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreaterEqual(video.stat().st_size, 4 * SIZE[0] * SIZE[1] * 4)

    def test_a_session_without_pictures_is_not_filmed(self):
        out = self.folder / "out"
        self.assertEqual(run("drill", QUICK, "--no-pictures", "--out", out, "--quiet", "--set", "duration_s=0.1").returncode, 0)
        result = run("replay", out / "session.sqlite", "--video", self.folder / "film")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("the recorded scene has no table [display]", result.stderr)
        self.assertFalse((self.folder / "film").exists())

    def test_what_cannot_be_filmed_is_refused_before_anything_is_written(self):
        bare = self.quick(append="")
        bare.write_text(bare.read_text().split("[display]")[0])
        film = self.folder / "film"
        for code, needle, arguments in (
                (2, "--video is not valid with --live", ["--live", "--video", film]),
                (2, "--video-fps 24 does not divide the servo rate, 1000 Hz", ["--video", film, "--video-fps", "24"]),
                (2, "a film is a folder, or a file .mp4, .mkv or .webm", ["--video", self.folder / "film.avi"]),
                (2, "--video-fps requires --video", ["--video-fps", "10"]),
                (2, "there is no such folder", ["--video", self.folder / "none" / "film.mp4"])):
            result = self.drill(*arguments, env=self.with_stand_in() if "none" in str(arguments) else None)
            self.assertEqual((result.returncode, len([l for l in lines(result.stderr) if needle in l])), (code, 1), result.stderr)
            self.assertFalse((self.folder / "out").exists())
            self.assertFalse(film.exists())
        result = self.drill("--video", self.folder / "film.mp4", env={**os.environ, "PATH": "/nonexistent"})
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("a video needs the program ffmpeg", result.stderr)
        result = run("drill", bare, "--out", self.folder / "out", "--video", film)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("--video needs the table [display]", result.stderr)


if __name__ == "__main__":
    main()
