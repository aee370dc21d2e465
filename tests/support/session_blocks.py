"""Blocks of rows in a session file of schema 2, read and written from the description in app/session/row_codec.h alone."""
import struct
import zlib


def columns(database, stream):
    """@returns (name, whether it is exact) of each column of a stream, in order."""
    rows = database.execute("SELECT c.name, c.keep FROM columns c JOIN streams s ON c.stream = s.position WHERE s.name = ? ORDER BY c.position",
                            (stream,)).fetchall()
    return [(name, keep == "exact") for name, keep in rows]


def last_blocks(database, stream, count):
    """@returns (first_row, data) of the last blocks of a stream, the newest first."""
    return database.execute("SELECT b.first_row, b.data FROM blocks b JOIN streams s ON b.stream = s.position WHERE s.name = ?"
                            " ORDER BY b.first_row DESC LIMIT ?", (stream, count)).fetchall()


def unshuffled(data, count, size):
    """@returns `count` words of `size` bytes that were written byte by byte."""
    return [int.from_bytes(data[n::count], "little") for n in range(count)] if len(data) == count * size else None


def decode(data, columns):
    """@returns the values of each column by name; a coarse one has the value of its last kept row."""
    version, every = struct.unpack("<BI", data[:5])
    payload = zlib.decompress(data[5:])
    again, rows = struct.unpack("<II", payload[:8])
    assert (version, again) == (1, every)
    at, out = 8, {}
    for name, exact in columns:
        values, before = [], 0
        if exact:
            method = payload[at]
            for word in unshuffled(payload[at + 1:at + 1 + 8 * rows], rows, 8):
                before = before ^ word if method == 0 else before + (word >> 1 ^ -(word & 1))
                values.append(struct.unpack("<d", struct.pack("<Q", before))[0] if method == 0 else float(before))
            at += 1 + 8 * rows
        else:
            kept = (rows - 1) // every + 1
            for n, word in enumerate(unshuffled(payload[at:at + 4 * kept], kept, 4)):
                before ^= word
                values += [struct.unpack("<f", struct.pack("<I", before))[0]] * min(every, rows - n * every)
            at += 4 * kept
        out[name] = values
    assert at == len(payload)
    return out


def encode(block, columns):
    """@returns a block with these values, by method 0 and with every row of coarse columns."""
    rows = len(next(iter(block.values())))
    payload = struct.pack("<II", 1, rows)
    for name, exact in columns:
        size, code = (8, "<d") if exact else (4, "<f")
        words, before = [], 0
        for value in block[name]:
            bits = int.from_bytes(struct.pack(code, value), "little")
            words.append((bits ^ before).to_bytes(size, "little"))
            before = bits
        payload += (b"\0" if exact else b"") + b"".join(bytes(word[n] for word in words) for n in range(size))
    return struct.pack("<BI", 1, 1) + zlib.compress(payload, 1)
