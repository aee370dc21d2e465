"""A tetrahedron as STL, OBJ and PLY of every form that the readers know. The first byte chooses the reader, as in mesh_fuzzer.cpp."""
import struct

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
STL, OBJ, PLY = b"\0", b"\1", b"\2"


def stl_text():
    facets = ["facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % POINTS[n] for n in face) + "endloop\nendfacet\n"
              for face in FACES]
    return ("solid s\n" + "".join(facets) + "endsolid s\n").encode()


def stl_bytes(head=b"solid in name only"):
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *[x for n in face for x in POINTS[n]], 0) for face in FACES)
    return head.ljust(80, b"\0") + struct.pack("<I", len(FACES)) + facets


def obj(face):
    """@param face how a corner is written, of its number from 1."""
    points = "".join("v %g %g %g\n" % p for p in POINTS)
    return ("# o\n" + points + "vt 0 0\nvn 0 0 1\ng a\n" + "".join("f " + " ".join(face(n + 1) for n in f) + "\n" for f in FACES)).encode()


def ply(form, real="float", count="uchar", index="int", extra=False):
    """One file. @param form ascii, binary_little_endian or binary_big_endian."""
    head = f"ply\nformat {form} 1.0\ncomment c\nelement vertex {len(POINTS)}\n" + "".join(f"property {real} {axis}\n" for axis in "xyz")
    head += ("property uchar red\n" if extra else "") + f"element face {len(FACES)}\nproperty list {count} {index} vertex_indices\n"
    head += ("element edge 1\nproperty list uchar short ends\nproperty double w\n" if extra else "") + "end_header\n"
    if form == "ascii":
        body = "".join("%g %g %g%s\n" % (*p, " 7" if extra else "") for p in POINTS) + "".join("3 %d %d %d\n" % f for f in FACES)
        return (head + body + ("2 0 1 0.5\n" if extra else "")).encode()
    order = "<" if "little" in form else ">"
    letter = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
    body = b"".join(struct.pack(order + 3 * letter[real], *p) + (b"\7" if extra else b"") for p in POINTS)
    body += b"".join(struct.pack(order + letter[count] + 3 * letter[index], 3, *f) for f in FACES)
    return head.encode() + body + (struct.pack(order + "Bhhd", 2, 0, 1, 0.5) if extra else b"")


def files():
    out = {"stl_text": STL + stl_text(), "stl_bytes": STL + stl_bytes(), "stl_plain": STL + stl_bytes(b"x")}
    corners = {"plain": "{0}", "texture": "{0}/1", "normal": "{0}//1", "all": "{0}/1/1"}
    for name, form in corners.items():
        out[f"obj_{name}"] = OBJ + obj(form.format)
    out["obj_back"] = OBJ + obj(lambda n: str(n - 5))
    out["obj_concave"] = OBJ + b"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 \\\n4 5\n"
    for form in ("ascii", "binary_little_endian", "binary_big_endian"):
        out[f"ply_{form}"] = PLY + ply(form)
        out[f"ply_{form}_extra"] = PLY + ply(form, extra=True)
        for real, count, index in (("double", "uint", "ushort"), ("short", "int", "char"), ("int", "ushort", "uchar")):
            out[f"ply_{form}_{real}"] = PLY + ply(form, real, count, index)
    return out
