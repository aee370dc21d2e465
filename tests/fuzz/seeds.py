#!/usr/bin/env python3
"""Writes what the fuzzers start from beside their kept inputs: valid files of every form that a reader knows, and its words.

  seeds.py FOLDER        FOLDER/NAME/... for each fuzzer NAME, and FOLDER/NAME.dict where its input has words; the folder is made

The generated references in docs give the keys of scenes, tools and raw descriptions, so a new effect's table is among the seeds.
Files, numbers and bytes are the same on every run.
"""
import itertools
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import seed_commands  # noqa: E402
import seed_dicom  # noqa: E402
import seed_images  # noqa: E402
import seed_markups  # noqa: E402
import seed_meshes  # noqa: E402
import seed_sessions  # noqa: E402
import seed_vdb  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
SCENE = '[volume]\nsource = "phantom:plate"\n[tool]\nname = "any"\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n[hand]\n'
TOOL = 'title = "t"\n[shell]\npitch_mm = 0.5\n[[region]]\nz_mm = 0\nerosion_factor = 0.1\nshape = '
RAW = 'dims = [2, 3, 4]\nspacing_mm = [1, 1, 2]\n'
# What each shape of a tool needs.
SHAPES = {
    "cylinder": "diameter_mm = 4\nheight_mm = 3",
    "cone": "diameter_mm = 4\nheight_mm = 3",
    "frustum": "bottom_diameter_mm = 4\ntop_diameter_mm = 3\nheight_mm = 3",
    "sphere": "diameter_mm = 4",
    "ellipsoid": "diameter_mm = 4\nheight_mm = 3",
    "tube": "diameter_mm = 4\nheight_mm = 3\ninner_diameter_mm = 2",
    "box": "height_mm = 3\nwidth_mm = 4\ndepth_mm = 1",
}


def reference(name):
    """@returns tables of docs/NAME.md: header as in the file ("" at the top) to (key, words of its choice, default, lines that the key goes
    with) of each row."""
    tables, header = {}, ""
    for line in (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").splitlines():
        title = re.match(r"## `(\[.*\])`$", line)
        row = re.match(r"\| `([^`]+)` \| (.*?) \| (.*?) \| .* \|$", line)
        if line.startswith("## "):
            header = title.group(1) if title else ""
        if row:
            tables.setdefault(header, []).append((row.group(1), re.findall(r'`("[^"]*")`', row.group(2)),
                                                  row.group(3).strip("`") if row.group(3).startswith("`") else None, conditions(line)))
    return tables


def conditions(row):
    """@returns the lines that a row says its key goes with: of each key the first value named."""
    condition = re.search(r"\*only with (.*)\*", row)
    # SCAN stands for any file; a folder that is there on every machine is one, and is not opened.
    pairs = re.findall(r"`(\w+)` = `([^`]+)`", condition.group(1) if condition else "")
    return "".join(f'{key} = "{value}"\n'.replace("SCAN", "/tmp") for key, value in pairs)


def words_of(tables):
    """@returns every key, table and word of a choice, for the fuzzer's dictionary."""
    out = set(tables) - {""}
    for rows in tables.values():
        for key, choices, *_ in rows:
            out |= {key, *choices}
    return out


def scene_with(header, lines=""):
    """@returns a scene with these lines of a table; they replace the table's own lines with the same keys."""
    tables = {"": "", **dict(zip(*[iter(re.split(r"(?m)^(\[\w+\])\n", SCENE)[1:])] * 2))}
    new = {line.split(" =")[0] for line in lines.splitlines()}
    kept = [line for line in tables.get(header, "").splitlines(keepends=True) if line.split(" =")[0] not in new]
    tables[header] = "".join(kept) + lines
    return "".join((f"{name}\n" if name else "") + content for name, content in tables.items())


def scenes():
    out = {}
    for header, rows in reference("scene").items():
        name = header.strip("[]") or "top"
        out[f"{name}_empty"] = scene_with(header)
        # Which keys a table has may depend on its first one: each key is tried with each word of that. Some are refused.
        first, words, *_ = rows[0]
        for key, choices, default, needed in rows:
            for n, (value, word) in enumerate(itertools.product(choices or [default], [None, *words])):
                other = f"{first} = {word}\n" if word and key != first and f"{first} =" not in needed else ""
                if value is not None:
                    out[f"{name}_{key}_{n}"] = scene_with(header, f"{other}{needed}{key} = {value}\n")
    phantoms = re.search(r"The phantoms are (.*?):", (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")).group(1)
    for phantom in re.findall(r"`(\w+)`", phantoms):
        out[f"phantom_{phantom}"] = scene_with("[volume]", f'source = "phantom:{phantom}"\n')
    out["scan"] = scene_with("[volume]", 'source = "/tmp"\nunit = "mm"\nbone_hu = [250, 400]\nspacing_mm = 0.5\nregion_mm = [9, 9, 9]\n')
    out["hardness"] = scene_with("[volume]", 'source = "/tmp"\n[[volume.hardness]]\nvalue = 0\nhardness = 0\n')
    out["cut"] = scene_with("[display]", 'cut = "plane"\ncut_point_mm = [0, 0, 0]\ncut_normal = [0, -1, 0]\n')
    out["transfer"] = scene_with("[display]", 'shading = "translucent"\n[[display.transfer]]\ndensity = 0\nopacity_per_mm = 0\n')
    out["label_stiffness"] = scene_with("[contact]", "[contact.label_stiffness]\ndiploe = 0.5\n")
    for file in sorted([*ROOT.glob("app/scenes/*.toml"), *ROOT.glob("tests/data/scenes/*.toml")]):
        out[file.stem] = file.read_text(encoding="utf-8")
    return out


def overrides():
    """Assignments as --set takes them, removals as --unset does after a '-'."""
    out = {"removed": "-display\n-erosion\n", "nested": "volume.hardness=[{value = 0, hardness = 0.5}]\n", "text": 'tool.name="ball"\n'}
    for header, rows in reference("scene").items():
        table = header.strip("[]")
        for key, choices, default, _ in rows:
            for n, value in enumerate(choices or [default]):
                if value is not None:
                    out[f"{table}_{key}_{n}"] = f"{table}.{key}={value}\n" if table else f"{key}={value}\n"
    return out


def tools():
    out = {shape: f'{TOOL}"{shape}"\n{size}\n' for shape, size in SHAPES.items()}
    out["mesh"] = 'title = "t"\n[mesh]\nfile = "FILE.stl"\nerosion_factor = 0.1\npitch_mm = 0.5\n'
    for header, rows in reference("tool").items():
        shape = "box" if header == "[[region]]" else "mesh" if header == "[mesh]" else "cylinder"
        for key, _, default, _ in rows:
            if default is not None:
                out[f"{header.strip('[]')}_{key}"] = out[shape] + f"{key} = {default}\n"
    for file in sorted(ROOT.glob("app/tools/*.toml")):
        out[file.stem] = file.read_text(encoding="utf-8")
    return out


def raw_sidecars():
    out = {}
    rows = {key: choices for key, choices, *_ in reference("raw")[""]}
    for pixel in rows["type"]:
        for order in rows["byte_order"]:
            out[f"{pixel}_{order}".replace('"', "")] = f'{RAW}data = "FILE"\ntype = {pixel}\nbyte_order = {order}\n'
    base = f'{RAW}type = "int16"\nbyte_order = "big"\n'
    out["series"] = base + 'files = "FILE.*"\nfolder = "$NAME/x"\norigin_mm = [-1.5, 2, 3e2]\n'
    out["turned"] = base + 'data = "FILE"\ndirection = [0, 1, 0, 0, 0, -1, 1, 0, 0]\nslope = 0.5\nintercept = -1024\noffset_bytes = 512\n'
    out["hounsfield"] = base + 'data = "FILE"\nquantity = "hounsfield"\nassumed = "all"\n'
    for file in sorted(ROOT.glob("app/scenes/volumes/*.toml")):
        out[file.stem] = file.read_text(encoding="utf-8")
    return out


def literals(source):
    """@returns the words in quotes of a reader's source: keys and values of its format."""
    return set(re.findall(r'"([A-Za-z][\w %:-]{0,40})"', (ROOT / source).read_text(encoding="utf-8")))


def dictionary(words):
    """@returns the words in libFuzzer's form; what is no printable ASCII is left out."""
    escaped = [word.replace("\\", "\\\\").replace('"', '\\"') for word in sorted(words) if word.isascii() and word.isprintable()]
    return "".join(f'"{word}"\n' for word in escaped)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: seeds.py FOLDER")
    folder = Path(sys.argv[1])
    seeds = {"scene": scenes(), "override": overrides(), "tool": tools(), "raw_sidecar": raw_sidecars(), "dicom": seed_dicom.files(), "mesh": seed_meshes.files(),
             "markups": seed_markups.files(), "command": seed_commands.files(), "session": seed_sessions.files(), "vdb": seed_vdb.files(), **seed_images.files()}
    words = {"scene": words_of(reference("scene")), "override": words_of(reference("scene")), "tool": words_of(reference("tool")), "raw_sidecar": words_of(reference("raw")),
             "metaimage": literals("volumes/read/meta_header.cpp"), "nrrd": literals("volumes/read/nrrd_header.cpp"),
             "markups": literals("volumes/read/markups.cpp"), "command": seed_commands.options() | seed_commands.names(),
             "vdb": {entry[0].decode() for entry in seed_vdb.ENTRIES},
             "mesh": literals("volumes/read/ply_format.cpp") | literals("volumes/read/stl_format.cpp")}
    for name, files in seeds.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        if name in words:
            (folder / f"{name}.dict").write_text(dictionary(words[name]), encoding="utf-8")
        for file, content in files.items():
            (folder / name / file).write_bytes(content.encode() if isinstance(content, str) else content)


if __name__ == "__main__":
    main()
