"""A game pad that does not exist: the files from which umockdev-run makes the kernel's interface of one, with a recording of its events.

The pad is one that GLFW's database knows. Numbers are those of <linux/input-event-codes.h>.
"""
import pathlib
import shutil
import struct

DEVICE = "/dev/input/event5"
KEYS = {"a": 0x130, "b": 0x131, "x": 0x133, "y": 0x134, "left bumper": 0x136, "right bumper": 0x137, "back": 0x13A, "start": 0x13B, "guide": 0x13C,
        "left stick": 0x13D, "right stick": 0x13E}
AXES = {"left x": (0, -32768, 32767), "left y": (1, -32768, 32767), "left trigger": (2, 0, 255), "right x": (3, -32768, 32767),
        "right y": (4, -32768, 32767), "right trigger": (5, 0, 255), "hat x": (16, -1, 1), "hat y": (17, -1, 1)}
EV_KEY, EV_ABS = 1, 3


def missing():
    return None if shutil.which("umockdev-run") else "umockdev-run"


def bits(numbers, size):
    out = bytearray(size)
    for n in numbers:
        out[n // 8] |= 1 << (n % 8)
    return bytes(out)


def command(folder, events):
    """The words before a program's. @param events (seconds after the pad is opened, name, value) in order of time."""
    folder = pathlib.Path(folder)
    (folder / "pad.umockdev").write_text("P: /devices/virtual/input/input5/event5\nN: input/event5\nE: DEVNAME=/dev/input/event5\n"
                                         "E: SUBSYSTEM=input\nE: ID_INPUT=1\nE: ID_INPUT_JOYSTICK=1\nA: dev=13:69\n")
    name = b"Microsoft X-Box 360 pad\0"
    answers = [("EVIOCGID", 0, struct.pack("<4H", 3, 0x045E, 0x028E, 0x0114)), ("EVIOCGNAME", len(name), name.ljust(256, b"\0")),
               ("EVIOCGBIT(0)", 4, bits([0, EV_KEY, EV_ABS], 4)), (f"EVIOCGBIT({EV_KEY})", 96, bits(KEYS.values(), 96)),
               (f"EVIOCGBIT({EV_ABS})", 8, bits([axis for axis, _, _ in AXES.values()], 8))]
    answers += [(f"EVIOCGABS({axis})", 0, struct.pack("<6i", 0, low, high, 0, 0, 0)) for axis, low, high in AXES.values()]
    (folder / "pad.ioctl").write_text(f"@DEV {DEVICE}\n" + "".join(f"{what} {result} {data.hex().upper()}\n" for what, result, data in answers))
    # No reports (EV_SYN): at each GLFW asks for the state of all axes, of which the answers above know the state at rest alone.
    with (folder / "pad.events").open("w") as out:
        for seconds, what, value in events:
            kind, code = (EV_KEY, KEYS[what]) if what in KEYS else (EV_ABS, AXES[what][0])
            out.write(f"E: {seconds:.6f} {kind:04x} {code:04x} {value}\n")
    return ["umockdev-run", "-d", str(folder / "pad.umockdev"), "-i", f"{DEVICE}={folder / 'pad.ioctl'}", "--evemu-events",
            f"{DEVICE}={folder / 'pad.events'}", "--"]


def unplug(process):
    """Removes the pad of the program that umockdev-run has started."""
    for child in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
        for variable in pathlib.Path(f"/proc/{child}/environ").read_bytes().split(b"\0"):
            if variable.startswith(b"UMOCKDEV_DIR="):
                (pathlib.Path(variable[len(b"UMOCKDEV_DIR="):].decode()) / DEVICE[1:]).unlink()
                return
    raise RuntimeError("no device folder of umockdev-run")
