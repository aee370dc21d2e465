"""Sessions: whole files of both schemas, and edits of the fuzzer's own valid session (session_fuzzer.cpp says how they are coded)."""
import itertools
import re
import sqlite3
import struct
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import session_blocks  # noqa: E402

TABLES = 11  # of the fuzzer's list, the schema's own table included


def schema_2():
    """@returns the statements that make the tables, from the header that has them."""
    text = (ROOT / "app" / "session" / "session_format.h").read_text(encoding="utf-8")
    return "".join(re.findall(r'"((?:CREATE TABLE| PRIMARY| data BLOB| parks)[^"]*)"', text))


def content(script, pages=512):
    """@returns the bytes of a database that the function made."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "s.sqlite"
        database = sqlite3.connect(path, isolation_level=None)
        database.execute(f"PRAGMA page_size = {pages}")
        script(database)
        database.close()
        return path.read_bytes()


def whole(database):
    columns = [("time", True), ("force", False)]
    database.executescript("PRAGMA application_id = 0x62757272; PRAGMA user_version = 2;" + schema_2())
    database.execute("INSERT INTO meta VALUES ('seed', '1'), ('physics_version', '2'), ('scene', 'a = 1')")
    database.execute("INSERT INTO streams VALUES (0, 'servo')")
    database.executemany("INSERT INTO columns VALUES (0, ?, ?, 's', ?)", [(n, name, "exact" if exact else "coarse") for n, (name, exact) in enumerate(columns)])
    for first in (0, 3):
        rows = {"time": [0.1, 0.25, float("nan")], "force": [1.0, -0.0, 1e30]}
        database.execute("INSERT INTO blocks VALUES (0, ?, 3, ?)", (first, session_blocks.encode(rows, columns)))
    database.execute("INSERT INTO inputs VALUES (1, 4, 'undo', 0.0, '', x'')")
    database.execute("INSERT INTO parks VALUES (1, 0, 4)")
    database.execute("INSERT INTO events VALUES (1, 0.5, 4, 'breakthrough', '', x'01')")
    database.execute("INSERT INTO stills VALUES (1, 0, 'after', '00', x'00', 1)")
    database.execute("INSERT INTO ends VALUES ('servo', 6), ('inputs', 1)")


def first_schema(database):
    database.executescript("PRAGMA application_id = 0x62757272; PRAGMA user_version = 1; CREATE TABLE meta(key, value); CREATE TABLE hashes(kind, value);"
                           "CREATE TABLE events(id INTEGER PRIMARY KEY, time_s, tick, kind, text, data);")
    for ending in ("", "_bone"):
        database.executescript(f"CREATE TABLE ticks{ending}(first_row INTEGER PRIMARY KEY, rows, data); CREATE TABLE columns{ending}(position, name, unit);")
        database.execute(f"INSERT INTO columns{ending} VALUES (0, 'time', 's'), (1, 'force', 'N')")
        database.execute(f"INSERT INTO ticks{ending} VALUES (0, 2, ?)", (struct.pack("<4d", 1, 2, 3, 4),))


def values():
    """@returns values of each type, as the fuzzer takes them."""
    yield from (bytes([0, n]) for n in (0, 1, 255))
    yield from (b"\x01" + struct.pack("<q", n) for n in (-1, 1 << 40, (1 << 63) - 1))
    yield from (b"\x02" + struct.pack("<d", n) for n in (0.5, float("inf"), 1e300))
    yield from (kind + bytes([len(text)]) + text for kind in (b"\x03", b"\x04") for text in (b"", b"servo", b"a\nb\x1b", b"x" * 200))
    yield b"\x05"


def files():
    out = {"schema_2": b"\0" + content(whole), "schema_1": b"\0" + content(first_schema), "none": b"\0", "text": b"\0no database",
           "large_pages": b"\0" + content(whole, 4096), "valid": b"\1\0", "cut": b"\1\0\0\1\0\2"}
    for table, row, column, (n, value) in itertools.product(range(TABLES), (0, 1), range(3), enumerate(values())):
        if (n + table + column) % 3 == 0:
            out[f"update_{table}_{row}_{column}_{n}"] = bytes([1, 1, 3, table, row, 2, column]) + value
    for table in range(TABLES):
        out[f"delete_{table}"] = bytes([1, 1, 3, table, 0, 0])
        out[f"insert_{table}"] = bytes([1, 1, 3, table, 0, 1]) + b"".join(itertools.islice(itertools.cycle(values()), 6))
    for n in range(11):
        out[f"schema_edit_{n}"] = bytes([1, 1, 0, n])
    for rows, payload in ((25, b""), (1, struct.pack("<II", 4, 25)), (2, b"x" * 300)):
        out[f"block_{rows}"] = bytes([1, 1, 1, 0]) + struct.pack("<BI", 1, 4) + struct.pack("<H", len(payload)) + payload
    for at in (16, 18, 20, 24, 28, 52, 56, 60, 100, 512, 1024):
        out[f"page_{at}"] = bytes([1, 0, 1]) + struct.pack("<H", at) + b"\xff"
    return out
