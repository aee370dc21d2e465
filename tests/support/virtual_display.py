"""A virtual display with a window manager, and a hand at its keys and mouse: Xvfb, openbox and xdotool."""
import os
import shutil
import subprocess

SCREEN = (1400, 900)
PATIENCE = 60.0  # [s] for a window, a picture or an end: a machine under load, not a speed that is judged


def missing():
    """The name of a program that is not there, or None."""
    return next((program for program in ("Xvfb", "openbox", "xdotool") if shutil.which(program) is None), None)


class Display:
    """A virtual display with a window manager."""

    def __init__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{SCREEN[0]}x{SCREEN[1]}x24", "-nolisten", "tcp", "-noreset"],
                                       pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.name = ":" + number.readline().strip()  # the whole line: a server whose pipe is closed early ends
        self.environment = {**os.environ, "DISPLAY": self.name}
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.manager = subprocess.Popen(["openbox"], env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def close(self):
        for process in (self.manager, self.server):
            process.terminate()
            process.wait()

    def tool(self, *words, check=True):
        return subprocess.run(["xdotool", *map(str, words)], env=self.environment, capture_output=True, text=True, timeout=PATIENCE, check=check)
