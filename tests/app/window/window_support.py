"""A window of the program under a virtual display, and what tests read from its pictures."""
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib

TESTS = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(TESTS / "app" / "cli"), str(TESTS / "support")]
from program_support import PROGRAM, QUICK, WithFolder, run  # noqa: E402
from virtual_display import PATIENCE, Display, missing  # noqa: E402,F401


def size_of(picture):
    return struct.unpack(">II", picture.read_bytes()[16:24])


def panel_of(picture):
    """Width in pixels of the panel: pixels of the first row that have the ground of the dark theme (app/window/gui.h)."""
    width, _ = size_of(picture)
    png = picture.read_bytes()
    data = b"".join(chunk for kind, chunk in chunks_of(png) if kind == b"IDAT")
    row = zlib.decompressobj().decompress(data, 1 + 4 * width)
    bytes_per_pixel = {2: 3, 6: 4}[png[25]]
    pixels = unfilter_first(row[0], row[1:1 + bytes_per_pixel * width], bytes_per_pixel)
    return sum(pixel[:3] == bytes.fromhex("1A1D21") for pixel in pixels)


def chunks_of(png):
    at = 8
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        yield kind, png[at + 8:at + 8 + length]
        at += 12 + length


def unfilter_first(kind, row, step):
    """The pixels of the first row of a PNG: above it all is zero, so that `up` is none, and `average` and `paeth` see the left alone."""
    out = bytearray()
    for n, value in enumerate(row):
        left = out[n - step] if n >= step else 0
        out.append((value + {0: 0, 1: left, 2: 0, 3: left // 2, 4: left}[kind]) % 256)
    return [bytes(out[n:n + step]) for n in range(0, len(out), step)]


def write_shell(path):
    """A spherical shell of bone, radii 24 and 30 mm, in soft tissue and air, 1 mm voxels, in HU. The middle of the band, 325 HU, is at 24 and 30 mm."""
    size, values = 70, bytearray()
    for k in range(size):
        for j in range(size):
            for i in range(size):
                r = ((i - 34.5) ** 2 + (j - 34.5) ** 2 + (k - 34.5) ** 2) ** 0.5
                share = min(max(0.5 - max(r - 30.0, 24.0 - r), 0.0), 1.0)  # of bone: a ramp over a voxel
                values += struct.pack("<h", round(610 * share + (1.0 - share) * (-1000 if r > 33.0 else 40)))
    header = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
              f"Offset = 0 0 0\nElementSpacing = 1 1 1\nDimSize = {size} {size} {size}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n")
    path.write_bytes(header.encode() + bytes(values))


class WindowTest(WithFolder):
    def setUp(self):
        super().setUp()
        self.display = Display()
        self.addCleanup(self.display.close)
        self.out = self.folder / "out"
        self.process = None

    def tearDown(self):
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        pictures = os.environ.get("BURRHOLE_PICTURES")
        if pictures and self.out.exists():
            pathlib.Path(pictures).mkdir(parents=True, exist_ok=True)
            for picture in self.out.glob("screenshot-*.png"):
                shutil.copy(picture, pathlib.Path(pictures) / f"{self._testMethodName}-{picture.name}")

    def start(self, *arguments, scene=QUICK, before=()):
        self.start_program("drill", scene, "--window", "--out", self.out, *arguments, before=before)
        self.wait_until(lambda: " by window" in self.log.read_text(), "the window's renderer")
        self.find_window()
        self.wait_until(lambda: "window: ready" in self.log.read_text(), "the first tick")

    def start_program(self, *words, before=()):
        self.log = self.folder / "log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen([*before, PROGRAM, *map(str, words)], env=self.display.environment, cwd=self.folder, stdout=subprocess.DEVNULL,
                                            stderr=log)

    def find_window(self):
        self.window = self.display.tool("search", "--sync", "--onlyvisible", "--name", "burrhole").stdout.split()[0]
        self.display.tool("windowfocus", "--sync", self.window)

    def wait_until(self, ready, what):
        end = time.monotonic() + PATIENCE
        while not ready():
            if self.process.poll() is not None:
                self.fail(f"the program ended ({self.process.returncode}) before {what}: {self.log.read_text()}")
            self.assertLess(time.monotonic(), end, f"{what} did not come")
            time.sleep(0.05)

    def interrupt_when_ready(self):
        """Ctrl-C once the run has begun."""
        self.wait_until(lambda: "window: ready" in self.log.read_text(), "the first tick")
        self.find_window()
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(PATIENCE), 130, self.log.read_text())

    def press(self, *keys):
        for key in keys:
            self.display.tool("key", key)

    def hold(self, key, seconds):
        self.display.tool("keydown", key)
        time.sleep(seconds)
        self.display.tool("keyup", key)

    def picture(self):
        before = len(list(self.out.glob("screenshot-*.png")))
        self.press("F12")
        self.wait_until(lambda: len(list(self.out.glob("screenshot-*.png"))) > before, "a screenshot")
        return self.out / f"screenshot-{before + 1}.png"

    def close(self):
        """Closes the window as its manager does; the manager may not be ready for its key yet."""
        end = time.monotonic() + PATIENCE
        while self.process.poll() is None and time.monotonic() < end:
            self.display.tool("key", "alt+F4", check=False)
            try:
                self.process.wait(2.0)
            except subprocess.TimeoutExpired:
                pass
        self.assertEqual(self.process.poll(), 0, self.log.read_text())

    def end(self):
        self.press("Escape")
        time.sleep(0.3)
        self.press("Return")
        self.wait_until(lambda: (self.out / "report.html").exists(), "the report")
        time.sleep(0.5)
        self.close()
        return json.loads((self.out / "summary.json").read_text())

    def assert_replays(self):
        replayed = run("replay", self.out / "session.sqlite")
        self.assertEqual(replayed.returncode, 0, replayed.stdout + replayed.stderr)
