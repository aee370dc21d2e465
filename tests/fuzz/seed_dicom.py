"""Small DICOM files in every transfer syntax that the reader knows. Shares no code with the reader or with tests/support/dicom_writer."""
import struct
import zlib

ROOT = "1.2.840.10008.1.2"
LONG = {"OB", "OW", "SQ", "UN", "UT"}
UNDEFINED = 0xFFFFFFFF


def element(tag, vr, value, order="<", explicit=True, length=None):
    """One element. @param length is written instead of the value's own."""
    value += b"" if len(value) % 2 == 0 else b"\0" if vr in ("UI", "OB") else b" "
    length = len(value) if length is None else length
    head = struct.pack(order + "HH", tag >> 16, tag & 0xFFFF)
    if not explicit:
        return head + struct.pack(order + "I", length) + value
    if vr in LONG:
        return head + vr.encode() + b"\0\0" + struct.pack(order + "I", length) + value
    return head + vr.encode() + struct.pack(order + "H", length) + value


def item(content, order="<", undefined=False):
    head = struct.pack(order + "HHI", 0xFFFE, 0xE000, UNDEFINED if undefined else len(content))
    return head + content + (struct.pack(order + "HHI", 0xFFFE, 0xE00D, 0) if undefined else b"")


def end_of_items(order="<"):
    return struct.pack(order + "HHI", 0xFFFE, 0xE0DD, 0)


class Slice:
    """A CT slice of 4 x 3 pixels, element by element, written in order of tags."""

    def __init__(self, bits=16, signed=1, columns=4, rows=3):
        self.bits, self.pixels = bits, columns * rows
        self.parts = {}
        self.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL").text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2")
        self.text(0x00080018, "UI", "1.2.3.4").text(0x00080060, "CS", "CT").text(0x00081030, "LO", "study")
        self.text(0x00180050, "DS", "1.5").text(0x0020000E, "UI", "1.2.3").text(0x00200011, "IS", "1")
        self.text(0x00200032, "DS", "-10\\20.5\\3e1").text(0x00200037, "DS", "1\\0\\0\\0\\1\\0")
        self.words(0x00280002, 1).text(0x00280004, "CS", "MONOCHROME2").words(0x00280010, rows).words(0x00280011, columns)
        self.text(0x00280030, "DS", "0.5\\0.75").words(0x00280100, bits).words(0x00280101, bits).words(0x00280102, bits - 1)
        self.words(0x00280103, signed).text(0x00281052, "DS", "-1024").text(0x00281053, "DS", "1")

    def text(self, tag, vr, value):
        self.parts[tag] = lambda order, explicit: element(tag, vr, value.encode(), order, explicit)
        return self

    def words(self, tag, *values):
        self.parts[tag] = lambda order, explicit: element(tag, "US", struct.pack(f"{order}{len(values)}H", *values), order, explicit)
        return self

    def items(self, tag, slices, undefined=False):
        def write(order, explicit):
            content = b"".join(item(one.body(order, explicit), order, undefined) for one in slices)
            return element(tag, "SQ", content + (end_of_items(order) if undefined else b""), order, explicit,
                           UNDEFINED if undefined else None)
        self.parts[tag] = write
        return self

    def plain(self, vr="OW", frames=1):
        letter = {8: "B", 16: "H", 32: "I"}[self.bits]
        values = [n * 7 % 200 for n in range(self.pixels * frames)]

        def write(order, explicit):
            return element(0x7FE00010, vr, struct.pack(f"{order}{len(values)}{letter}", *values), order, explicit)
        self.parts[0x7FE00010] = write
        return self

    def pieces(self, *fragments):
        content = b"".join(item(f + b"\0" * (len(f) % 2)) for f in (b"", *fragments)) + end_of_items()
        self.parts[0x7FE00010] = lambda order, explicit: element(0x7FE00010, "OB", content, order, explicit, UNDEFINED)
        return self

    def body(self, order="<", explicit=True):
        return b"".join(self.parts[tag](order, explicit) for tag in sorted(self.parts))

    def only(self, *tags):
        self.parts = {tag: self.parts[tag] for tag in tags}
        return self


def file(data, syntax=".1"):
    """A whole file. @param syntax the end of the transfer syntax's UID."""
    body = data.body(">" if syntax == ".2" else "<", syntax != "")
    if syntax == ".1.99":
        packer = zlib.compressobj(9, zlib.DEFLATED, -15)
        body = packer.compress(body) + packer.flush()
    meta = element(0x00020002, "UI", b"1.2.840.10008.5.1.4.1.1.2") + element(0x00020010, "UI", (ROOT + syntax).encode())
    return bytes(128) + b"DICM" + element(0x00020000, "UL", struct.pack("<I", len(meta))) + meta + body


def rle(planes):
    """One RLE frame of byte planes, each written as one literal run and one repeated byte."""
    segments = [bytes([len(plane) - 3]) + plane[:-2] + bytes([0xFF]) + plane[-1:] for plane in planes]
    segments = [segment + b"\0" * (len(segment) % 2) for segment in segments]
    starts = [64 + sum(len(s) for s in segments[:n]) for n in range(len(segments))]
    return struct.pack("<16I", len(segments), *starts, *[0] * (15 - len(segments))) + b"".join(segments)


def jpeg(frame=0xC0, precision=8, restart=0):
    """A JPEG stream of 4 x 3 pixels that are all the same. @param frame marker: 0xc0 baseline, 0xc1 extended, 0xc3 lossless."""
    def segment(marker, content):
        return bytes([0xFF, marker]) + struct.pack(">H", len(content) + 2) + content
    tables = segment(0xDB, bytes([0]) + bytes([1] * 64)) if frame != 0xC3 else b""
    huffman = b"".join(segment(0xC4, bytes([kind << 4]) + bytes([0, 1, 1, *[0] * 13]) + bytes([0, 1])) for kind in (0, 1))
    interval = segment(0xDD, struct.pack(">H", restart)) if restart else b""
    header = segment(frame, struct.pack(">BHHB", precision, 3, 4, 1) + bytes([1, 0x11, 0]))
    scan = segment(0xDA, bytes([1, 1, 0, 1 if frame == 0xC3 else 0, 0 if frame == 0xC3 else 63, 0]))
    # Code 00 is "no difference" and "end of the block". A restart marker follows each row.
    bits = b"\0\xff\xd0\0\xff\xd1\0" if frame == 0xC3 and restart == 4 else bytes(3)
    return b"\xff\xd8" + tables + header + huffman + interval + scan + bits + b"\xff\xd9"


def frames(count, undefined):
    """An enhanced file of several frames, each with its own place."""
    def group(tag, one):
        return Slice().only().items(tag, [one], undefined)
    own = []
    for n in range(count):
        place = Slice().text(0x00200032, "DS", f"0\\0\\{n}").only(0x00200032)
        own.append(group(0x00209113, place))
    shared = Slice().only()
    shared.items(0x00209116, [Slice().only(0x00200037)], undefined).items(0x00289110, [Slice().only(0x00180050, 0x00280030)], undefined)
    shared.items(0x00289145, [Slice().text(0x00281054, "LO", "HU").only(0x00281052, 0x00281053, 0x00281054)], undefined)
    whole = Slice().text(0x00280008, "IS", str(count)).plain(frames=count)
    for tag in (0x00200032, 0x00200037, 0x00280030, 0x00281052, 0x00281053):
        del whole.parts[tag]
    return whole.items(0x52009229, [shared], undefined).items(0x52009230, own, undefined)


def files():
    out = {}
    for name, syntax in (("implicit", ""), ("explicit", ".1"), ("big", ".2"), ("deflated", ".1.99")):
        for bits in (8, 16, 32):
            out[f"{name}_{bits}"] = file(Slice(bits).plain(), syntax)
        out[f"{name}_frames"] = file(frames(3, False), syntax)
        out[f"{name}_frames_open"] = file(frames(2, True), syntax)
    for bits in (8, 16, 32):
        data = bytes(n * 7 % 200 for n in range(12))
        out[f"rle_{bits}"] = file(Slice(bits).pieces(rle([data] * (bits // 8))), ".5")
    for syntax, frame, precision in ((".4.50", 0xC0, 8), (".4.51", 0xC1, 12), (".4.57", 0xC3, 16), (".4.70", 0xC3, 16)):
        def pixels():
            return Slice(8) if precision == 8 else Slice(16).words(0x00280101, precision).words(0x00280102, precision - 1)
        stream = jpeg(frame, precision)
        out[f"jpeg{syntax}"] = file(pixels().pieces(stream), syntax)
        out[f"jpeg{syntax}_restart"] = file(pixels().pieces(jpeg(frame, precision, 4)), syntax)
        out[f"jpeg{syntax}_split"] = file(pixels().pieces(stream[:40], stream[40:]), syntax)
    out["jpeg_ls"] = file(Slice().pieces(b"\xff\xd8\xff\xf7\0\x0b\x10\0\3\0\4\1\1\x11\0\xff\xda\0\x08\1\1\0\0\0\0\0\xff\xd9"), ".4.80")
    out["jpeg_2000"] = file(Slice().pieces(b"\xff\x4f\xff\x51\0\x29" + bytes(39) + b"\xff\xd9"), ".4.90")
    out["no_preamble"] = Slice().plain().body("<", True)
    out["no_preamble_implicit"] = Slice().plain().body("<", False)
    out["padded"] = file(Slice(signed=1).words(0x00280120, 0xF830).words(0x00280121, 0xF000).plain())
    out["twelve_bits"] = file(Slice(signed=0).words(0x00280101, 12).words(0x00280102, 11).plain())
    out["big_odd"] = file(Slice(8, columns=3, rows=3).plain(), ".2")
    out["white_low"] = file(Slice().text(0x00280004, "CS", "MONOCHROME1").text(0x00282110, "CS", "01").plain())
    out["colour"] = file(Slice().words(0x00280002, 3).text(0x00280004, "CS", "RGB").plain())
    out["localizer"] = file(Slice().text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER").plain())
    out["capture"] = file(Slice().text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7").plain())
    out["directory"] = file(Slice().text(0x00080016, "UI", "1.2.840.10008.1.3.10"))
    out["no_rescale"] = file(Slice().text(0x00281054, "LO", "US").plain())
    return out
