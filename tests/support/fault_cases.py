"""The commands whose writing is attacked: each with a small input, so that a trial takes a second."""
import pathlib
import struct

from faults import Case

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "tests" / "data" / "scenes" / "quick_plate.toml"


TOOLS = ("round_burr_3mm", "round_burr_4mm", "round_burr_5mm")


def small_scan(folder, n):
    """A ball of bone in air, of n voxels an edge, as NRRD."""
    values = bytearray()
    for k in range(n):
        for j in range(n):
            for i in range(n):
                inside = (i - n // 2) ** 2 + (j - n // 2) ** 2 + (k - n // 2) ** 2 < (n // 3) ** 2
                values += struct.pack("<h", 1200 if inside else -1000)
    path = pathlib.Path(folder) / f"scan_{n}.nrrd"
    head = (f"NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: {n} {n} {n}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
            "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
    path.write_bytes(head.encode() + bytes(values))
    return path


def cases(folder):
    """Each case has three runs, numbered `who`, of which no two write equal files."""
    scans = [small_scan(folder, n) for n in (24, 28, 32)]
    inputs = pathlib.Path(folder) / "inputs.toml"
    inputs.write_text('[[input]]\ntime_s = 0.55\nkind = "export"\n')

    def drill(out, who, *more):
        mine = (f'title="Run {who}"', f"hand.seed={who + 1}", f"volume.extent_mm=[8, 8, {3 + 0.4 * who}]", f"display.size=[{160 + 16 * who}, 120]", "duration_s=0.6")
        return ["drill", SCENE, "--offscreen", "--force", "--quiet", *(word for key in mine for word in ("--set", key)), *more, "--out", out]

    return [
        Case("drill", lambda out, who: drill(out, who, "--inputs", inputs), cleared=True, draws=True),
        Case("drill --live", lambda out, who: drill(out, who, "--live"), cleared=True, draws=True),
        Case("drill without pictures", lambda out, who: drill(out, who, "--live", "--no-pictures"), cleared=True),
        Case("import", lambda out, who: ["import", scans[who], "--volume", out / "bone.vdb", "--force"]),
        Case("export", lambda out, who: ["export", scans[who], "-o", out / "bone.stl", "--force"]),
        Case("render", lambda out, who: ["render", SCENE, "--size", f"{160 + 16 * who}x120", "--image", out / "picture.png"], draws=True),
        Case("tools", lambda out, who: ["tools", TOOLS[who], "--image", out / "bit.png"], draws=True, other_program=True),
    ]
