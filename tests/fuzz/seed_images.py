"""Headers of NIfTI, NRRD and MetaImage files in every form that the readers know, and planes of slices."""
import itertools
import struct

# NIfTI: datatype to bits a voxel; the last two are refused.
NIFTI_TYPES = {2: 8, 4: 16, 8: 32, 16: 32, 64: 64, 256: 8, 512: 16, 768: 32, 1024: 64, 1280: 64, 128: 24, 32: 64}
NRRD_TYPES = ["int8", "uint8", "short", "unsigned short", "int", "unsigned int", "long long int", "uint64_t", "float", "double"]
META_TYPES = ["CHAR", "UCHAR", "SHORT", "USHORT", "INT", "UINT", "LONG", "ULONG", "FLOAT", "DOUBLE", "LONG_LONG", "ULONG_LONG"]


def nifti(version, order, pair=False, datatype=4, dims=(3, 4, 5, 6), maps="sq", units=2, offset=None, slope=1.0):
    """One header. @param order "<" or ">". @param maps which maps are given: s(form), q(form)."""
    real, size, code = ("f", "h", "h") if version == 1 else ("d", "q", "i")
    head = bytearray(348 if version == 1 else 540)

    def put(at, form, *values):
        struct.pack_into(order + form, head, at, *values)

    put(0, "i", len(head))
    at = (70, 40, 76, 108, 112, 123, 252, 256, 280) if version == 1 else (12, 16, 104, 168, 176, 500, 344, 352, 400)
    kind, dim, pixdim, vox, scale, unit, forms, turn, rows = at
    put(kind, "hh", datatype, NIFTI_TYPES[datatype])
    put(dim, f"8{size}", *dims, *[1] * (8 - len(dims)))
    put(pixdim, f"8{real}", -1.0, 0.5, 0.6, 0.7, 1, 1, 1, 1)
    start = len(head) + 4 if offset is None else offset
    put(vox, "f" if version == 1 else "q", float(start) if version == 1 else start)
    put(scale, f"2{real}", slope, -1024.0)
    if version == 1:
        head[unit] = units
    else:
        put(unit, "i", units)
    put(forms, f"2{code}", int("q" in maps), int("s" in maps))
    put(turn, f"6{real}", 0.5, 0.5, 0.5, -10, 20, 30)
    put(rows, f"12{real}", 0.5, 0, 0, -10, 0, 0.6, 0, 20, 0, 0, 0.7, 30)
    if version == 1:
        head[344:348] = b"ni1\0" if pair else b"n+1\0"
    else:
        head[4:12] = b"ni2\0\r\n\x1a\n" if pair else b"n+2\0\r\n\x1a\n"
    return bytes(head)


def nifti_files():
    out = {}
    for version, order in itertools.product((1, 2), "<>"):
        name = f"v{version}_{'little' if order == '<' else 'big'}"
        for datatype in NIFTI_TYPES:
            out[f"{name}_type{datatype}"] = nifti(version, order, datatype=datatype, dims=(3, 4, 5, 6))
        for maps in ("", "s", "q", "sq"):
            out[f"{name}_maps_{maps}"] = nifti(version, order, maps=maps)
        for units in (0, 1, 3):
            out[f"{name}_units{units}"] = nifti(version, order, units=units)
        out[f"{name}_pair"] = nifti(version, order, pair=True, offset=0)
        out[f"{name}_no_offset"] = nifti(version, order, offset=0)
        out[f"{name}_4d"] = nifti(version, order, dims=(4, 4, 5, 6, 2))
        out[f"{name}_no_slope"] = nifti(version, order, slope=0.0)
    return out


def nrrd(version=5, dimension=3, **fields):
    """One header. A field that is None is left out; names are written with blanks for underscores."""
    every = {"type": "short", "dimension": dimension, "space": "left-posterior-superior", "sizes": "3 4 5",
             "space_directions": "(0.5,0,0) (0,0.6,0) (0,0,0.7)", "kinds": "domain domain domain", "endian": "little", "encoding": "raw",
             "space_origin": "(1,-2,3e1)", **fields}
    lines = [f"{name.replace('_', ' ')}: {value}" for name, value in every.items() if value is not None]
    return f"NRRD000{version}\n# comment\n" + "\n".join(lines) + "\nkey:=value\n\n" + "\0" * 8


def nrrd_files():
    plain = {"space": None, "space_directions": None, "space_origin": None}
    out = {f"version{n}": nrrd(version=n) for n in range(1, 7)}
    out |= {f"encoding_{name}": nrrd(encoding=name) for name in ("raw", "gzip", "gz", "ascii", "text", "txt", "bzip2", "hex")}
    out |= {f"type_{n}": nrrd(type=name) for n, name in enumerate(NRRD_TYPES)}
    out |= {f"space_{name}": nrrd(space=name) for name in
            ("RAS", "LAS", "LPS", "right-anterior-superior", "scanner-xyz", "3D-left-handed", "left-posterior-superior-time")}
    out |= {f"units_{name}": nrrd(space_units=f'"{name}" "{name}" "{name}"') for name in ("mm", "m", "cm", "um", "inch", "")}
    out["spacings"] = nrrd(spacings="0.5 0.6 0.7", units='"mm" "cm" "m"', **plain)
    out["plain"] = nrrd(space_dimension=3, **plain)
    out["big"] = nrrd(endian="big", byte_skip=-1)
    out["skips"] = nrrd(line_skip=2, byte_skip=16, data_file="x.raw", measurement_frame="(1,0,0) (0,1,0) (0,0,1)")
    out["old_names"] = nrrd(datafile="x.raw.gz", lineskip=1, byteskip=1, encoding="gz", content="c", axismins="0 0 0",
                            centerings="cell cell cell")
    out["numbered"] = nrrd(data_file="x.%03d.raw 1 5 1 2")
    out["list"] = nrrd(data_file="LIST 2").split("key:=")[0] + "a.raw\nb.raw\n\nc.raw\n"
    out["four"] = nrrd(dimension=4, sizes="1 3 4 5", kinds="vector domain domain domain", space_directions="none (1,0,0) (0,1,0) (0,0,1)")
    return out


def meta(file="LOCAL", **fields):
    every = {"ObjectType": "Image", "NDims": 3, "BinaryData": "True", "BinaryDataByteOrderMSB": "False", "CompressedData": "False",
             "TransformMatrix": "1 0 0 0 0 -1 0 1 0", "Offset": "-1 2.5 3e1", "CenterOfRotation": "0 0 0", "ElementSpacing": "0.5 0.6 0.7",
             "DimSize": "3 4 5", "ElementType": "MET_SHORT", **fields}
    lines = [f"{name} = {value}" for name, value in every.items() if value is not None]
    return "\n".join(lines) + f"\nElementDataFile = {file}\n"


def meta_files():
    out = {f"type_{name}": meta(ElementType=f"MET_{name}") + "\0" * 8 for name in META_TYPES}
    out |= {f"units_{n}": meta(DistanceUnits=name) for n, name in enumerate(("mm", "cm", "um", "m", "?"))}
    out |= {f"modality_{name}": meta(Modality=f"MET_MOD_{name}") for name in ("CT", "MR", "NM", "US")}
    out["big"] = meta(BinaryDataByteOrderMSB=None, ElementByteOrderMSB="1")
    out["text"] = meta(BinaryData="no")
    out["packed"] = meta(CompressedData="t", CompressedDataSize=10, file="x.zraw")
    out["names"] = meta(TransformMatrix=None, Offset=None, ElementSpacing=None, Orientation="1 0 0 0 1 0 0 0 1", Origin="0 0 0",
                        ElementSize="1 1 2", file="x.raw")
    out["names_again"] = meta(TransformMatrix=None, Offset=None, Rotation="1 0 0 0 1 0 0 0 1", Position="0 0 0")
    out["bare"] = meta(TransformMatrix=None, Offset=None, ElementSpacing=None, BinaryDataByteOrderMSB=None)
    out["scaled"] = meta(ElementToIntensityFunctionSlope=0.5, ElementToIntensityFunctionOffset=-1024, ElementNumberOfChannels=1)
    out["colours"] = meta(ElementNumberOfChannels=3)
    out["at_end"] = meta(HeaderSize=-1, file="x.raw")
    out["skipped"] = meta(HeaderSize=348, file="x.raw")
    out["list"] = meta(file="LIST") + "a.raw\nb.raw\nc.raw\n"
    out["list_2d"] = meta(file="LIST 2D") + "a.raw\r\nb.raw\r\n"
    out["numbered"] = meta(file="x%03d.raw 1 5 1")
    out["numbered_once"] = meta(file="x%d.raw 1 5")
    out["flat"] = meta(NDims=2)
    return out


def planes(positions, turn=(1, 0, 0, 0, 1, 0), spacing=(0.5, 0.6), rows=4):
    """Input of slice_stack_fuzzer.cpp: planes at these positions, all of one direction."""
    out = bytes([0, rows, 1]) + struct.pack("<d", 1.5)
    for n, position in enumerate(positions):
        out += struct.pack("<6d", *position, 0, 0, 1) + (struct.pack("<8d", *turn, *spacing) if n == 0 else b"")
    return out


def stack_files():
    orders = {"one": [0], "two": [0, 1], "even": range(8), "back": range(0, -8, -1), "mixed": [3, 0, 4, 1, 2], "gap": [0, 1, 2, 4, 5],
              "twice": [0, 1, 1, 2]}
    out = {name: planes([(0, 0, n) for n in order]) for name, order in orders.items()}
    out["sheared"] = planes([(0, 0.3 * n, n) for n in range(6)])
    out["uneven"] = planes([(0, 0.2 * (n % 2), n) for n in range(6)])
    out["turned"] = planes([(0.7 * n, 0, 0) for n in range(6)], turn=(0, 1, 0, 0, 0, 1))
    out["tilted"] = planes([(0, -0.6 * n, 0.8 * n) for n in range(6)], turn=(1, 0, 0, 0, 0.8, 0.6))
    own = struct.pack("<8d", 1, 0, 0, 0, 1, 0, 0.5, 0.6)
    out["own_turns"] = bytes([0, 4, 0xFF]) + struct.pack("<d", 1) + b"".join(struct.pack("<6d", 0, 0, n, 0, 0, 1) + own for n in range(4))
    out["follows"] = bytes([0xFF, 4, 0]) + struct.pack("<7d", 1, 1, 2, 3, 0, 0.1, 0.5) + bytes(8 * 40)
    out["follows_far"] = bytes([0xFF, 1, 0]) + struct.pack("<7d", 1, 1e6, -1e6, 1e6, 0, 0, 1e-3) + bytes(8 * 298)
    return out


def files():
    """@returns the files of each fuzzer of this module, by name."""
    return {"nifti": nifti_files(), "nrrd": nrrd_files(), "metaimage": meta_files(), "slice_stack": stack_files()}
