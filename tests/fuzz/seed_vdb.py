"""Headers of .vdb files in the versions that are read: with and without offsets, metadata and grids."""
import itertools
import struct


def text(value):
    return struct.pack("<I", len(value)) + value


def metadata(entries):
    return struct.pack("<I", len(entries)) + b"".join(text(key) + text(kind) + text(value) for key, kind, value in entries)


ENTRIES = [(b"class", b"string", b"fog volume"), (b"burrhole_dims", b"vec3i", struct.pack("<3i", 4, 5, 6)), (b"file_bbox_min", b"vec3i", b"\0" * 12),
           (b"burrhole_bone_from_index", b"mat4d", b"\0" * 128), (b"is_saved_as_half_float", b"bool", b"\0")]


def file(version, offsets, entries, grids):
    out = struct.pack("<qI", 0x56444220, version) + struct.pack("<II", 10, 0) + bytes([offsets])
    if version < 222:
        out += b"\1"
    out += b"01234567-89ab-cdef-0123-456789abcdef" + metadata(ENTRIES[:1]) + struct.pack("<i", grids)
    for n in range(grids):
        out += text(b"density\x1e%d" % n) + text(b"Tree_float_5_4_3_HalfFloat") + text(b"")
        body = (struct.pack("<I", 6) if version >= 222 else b"") + metadata(ENTRIES[:entries]) + text(b"UniformScaleMap") + b"\0" * 64
        start = len(out) + 24
        out += struct.pack("<qqq", start, start, start + len(body)) + body
    return out


def files():
    out = {}
    for version, offsets, entries, grids in itertools.product((220, 222, 224), (0, 1), (0, 1, 5), (0, 1, 3)):
        out[f"{version}_{offsets}_{entries}_{grids}"] = file(version, offsets, entries, grids)
    return out | {"newer": file(225, 1, 1, 1), "cut": file(224, 1, 5, 2)[:150], "none": b"", "text": b"no grid at all"}
