"""The commands whose writing is attacked: each with a small input, so that a trial takes a second."""
import pathlib
import struct

from faults import Case

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "tests" / "data" / "scenes" / "quick_plate.toml"


def small_scan(folder):
    """A ball of bone in air, as NRRD."""
    n, values = 24, bytearray()
    for k in range(n):
        for j in range(n):
            for i in range(n):
                inside = (i - 12) ** 2 + (j - 12) ** 2 + (k - 12) ** 2 < 64
                values += struct.pack("<h", 1200 if inside else -1000)
    path = pathlib.Path(folder) / "scan.nrrd"
    head = (f"NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: {n} {n} {n}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
            "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
    path.write_bytes(head.encode() + bytes(values))
    return path


def cases(folder):
    scan = small_scan(folder)
    drill = ["drill", SCENE, "--offscreen", "--force", "--quiet", "--set", "duration_s=0.6"]
    out = [
        Case("drill", lambda out: [*drill, "--out", out], cleared=True, draws=True),
        Case("drill --live", lambda out: [*drill, "--live", "--out", out], cleared=True, draws=True),
        Case("drill without pictures", lambda out: [*drill, "--live", "--no-pictures", "--out", out], cleared=True),
        Case("import", lambda out: ["import", scan, "--volume", out / "bone.vdb"]),
        Case("export", lambda out: ["export", scan, "-o", out / "bone.stl", "--force"]),
        Case("render", lambda out: ["render", SCENE, "--image", out / "picture.png"], draws=True),
        Case("tools", lambda out: ["tools", "round_burr_3mm", "--image", out / "bit.png"], draws=True, other_program=True),
    ]
    return out
