#!/usr/bin/env python3
"""Holds the arrows between the folders as data and fails on an #include that is a new one: `file:line: what is wrong`.

A box is a folder (or one file); it may include itself and the boxes it SEES, nothing else. A library of the field may be included only in
the places that WRAPPED names. Tests may include every box, as they mirror the tree, and every library.

  check_includes.py [ROOT]        exit 0: every include follows an arrow, 3: some do not (one line each)
"""
import re
import sys
from pathlib import Path

# Who sees whom. Longest path wins, so app/engine/view.h is a box inside the box app/engine.
BASE = ["core/base"]
VALUES = BASE + ["core/voxel", "core/tool"]
CORE = VALUES + ["core/contact", "core/drill", "core/mesh"]
ENGINE = ["app/engine", "app/engine/view.h"]
SEES = {
    "core/base": [],
    "core/voxel": BASE,
    "core/tool": BASE,
    "core/contact": VALUES,
    "core/drill": VALUES,
    "core/mesh": VALUES + ["core/contact", "core/drill"],
    "haptics": CORE,
    "volumes": CORE,
    "app/engine/view.h": CORE,
    "app/engine": CORE + ["haptics", "volumes", "app/engine/view.h"],
    "app/render": CORE + ["app/engine/view.h"],
    "app/report": CORE,
    "app/bench": CORE + ["haptics", "volumes", "app/render", "app/report"] + ENGINE,
    "app/lab": CORE + ["haptics", "volumes", "app/render", "app/report"] + ENGINE,
    "app/cli": CORE + ["haptics", "volumes", "app/render", "app/report", "app/lab"] + ENGINE,
    "app/window": CORE + ["haptics", "volumes", "app/render", "app/report", "app/lab"] + ENGINE,
}

# At most six files instantiate an OpenVDB grid: each costs seconds to compile and nearly half a minute under a sanitizer.
MAX_OPENVDB_FILES = 6

# Library header, or our own that exposes one (pattern on the path as included), its name, and the only places that may include it.
WRAPPED = [
    (r"(openvdb|nanovdb)/", "OpenVDB", ["core/voxel/", "volumes/", "app/bench/vdb_baselines.cpp"]),
    (r"(glad|GL|EGL|GLES\d?)/", "OpenGL", ["app/render/"]),
    (r"toml\+\+/|toml\.hpp$", "toml++", ["core/base/toml_parsed.h"]),
    (r"core/base/toml_parsed\.h$", "toml++", ["core/base/toml"]),
    (r"sqlite3(ext)?\.h$", "SQLite", ["app/engine/session.cpp"]),
    (r"png\.h$", "libpng", ["app/render/"]),
    (r"libusb", "libusb", ["haptics/device/"]),
    (r"hidapi", "hidapi", ["haptics/device/"]),
    (r"GLFW/", "GLFW", ["app/render/", "app/window/"]),
    (r"CLI/", "CLI11", ["app/cli/"]),
    (r"itk[A-Z]", "ITK", ["tests/"]),
    (r"gdcm", "GDCM", ["volumes/read/gdcm_codecs.cpp"]),
    (r"zlib\.h$", "zlib", ["volumes/read/"]),
    (r"hwy/", "Highway", ["core/"]),
    # vdb_grids.cpp: OpenVDB must be initialised once, from whichever thread comes first.
    (r"(thread|mutex|shared_mutex|condition_variable|future)$", "threading", ["app/", "haptics/", "core/voxel/vdb_grids.cpp"]),
]

CODE_FOLDERS = ["core", "haptics", "volumes", "app"]
SUFFIXES = {".h", ".cpp"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def box_of(path):
    """@returns the box that a path from the root lies in, the longest that fits, or None."""
    fitting = [box for box in SEES if path == box or path.startswith(box + "/")]
    return max(fitting, key=len, default=None)


def fault_of_own(path, included):
    """@returns what is wrong with file `path` including our own header `included`, or None."""
    source, target = box_of(path), box_of(included)
    if source is None:
        return "lies in no box; scripts/check_includes.py says which there are"
    if target is None:
        return f"includes {included}, which lies in no box"
    if target == source or target in SEES[source]:
        return None
    return f"includes {included}: {source} may not see {target}"


def fault_of_library(path, included):
    """@returns what is wrong with file `path` including a header that exposes a library, or None."""
    for pattern, library, places in WRAPPED:
        if re.match(pattern, included) and not path.startswith(tuple(places)):
            return f"includes {included}: {library} stays in {', '.join(places)}"
    return None


def check_file(root, path):
    """@returns (faults as 'file:line: text', whether it includes OpenVDB) of one file."""
    faults, openvdb = [], False
    for number, line in enumerate((root / path).read_text(encoding="utf-8").splitlines(), start=1):
        found = INCLUDE.match(line)
        if not found:
            continue
        quoted, included = found.group(1) == '"', found.group(2)
        openvdb = openvdb or included.startswith("openvdb/")
        if included.split("/")[0] in CODE_FOLDERS and "/" in included:
            fault = fault_of_own(path, included) or fault_of_library(path, included)
        elif quoted and (root / path).parent.joinpath(included).exists():
            fault = f"includes {included}: name our headers by their path from the root"
        else:
            fault = fault_of_library(path, included)
        if fault:
            faults.append(f"{path}:{number}: {fault}")
    return faults, openvdb


def check_tree(root):
    """@returns every fault of the tree, in order of path and line."""
    faults, openvdb_files = [], []
    for folder in CODE_FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SUFFIXES or not file.is_file():
                continue
            path = file.relative_to(root).as_posix()
            found, openvdb = check_file(root, path)
            faults += found
            if openvdb:
                openvdb_files.append(path)
    if len(openvdb_files) > MAX_OPENVDB_FILES:
        faults.append(f"{openvdb_files[-1]}:1: {len(openvdb_files)} files include OpenVDB, at most {MAX_OPENVDB_FILES} may: "
                      + ", ".join(openvdb_files))
    return faults


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    faults = check_tree(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 3 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
