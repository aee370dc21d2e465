#!/usr/bin/env python3
"""Holds the arrows between the folders as data and fails on an #include that is a new one: `file:line: what is wrong`.

A box is a folder (or one file); it may include itself and the boxes it SEES, nothing else. A library of the field may be included only in
the places that WRAPPED names. Tests may include every box, as they mirror the tree, and every library. A rule that names nothing is an
error too.

  check_includes.py [ROOT]        exit 0: every include follows an arrow, 3: some do not (one line each)
"""
import re
import sys
from pathlib import Path

# Who sees whom. Longest path wins: app/lab/oracle is a box inside the box app/lab.
BASE = ["core/base"]
CONFIG = BASE + ["core/config"]
VALUES = CONFIG + ["core/voxel", "core/tool"]
ACTING = VALUES + ["core/contact", "core/drill"]
CORE = ACTING + ["core/blood", "core/debris", "core/heat", "core/measure", "core/mesh", "core/sheet", "core/sound", "core/zone"]
INPUT = CORE + ["haptics", "volumes"]
VIEW = ["app/view"]
STAGE = INPUT + VIEW + ["app/stage"]
EFFECT = STAGE + ["app/effect"]
SCENE = EFFECT + ["app/scene"]
RUN = SCENE + ["app/session", "app/run"]
JOB = RUN + ["app/report", "app/job"]
SEES = {
    "core/base": [],
    "core/blood": BASE,
    "core/config": BASE,
    "core/voxel": BASE,
    "core/tool": CONFIG,
    "core/contact": VALUES,
    "core/debris": BASE,
    "core/drill": VALUES,
    "core/heat": BASE,
    "core/measure": ACTING,
    "core/mesh": VALUES + ["core/contact"],
    "core/sheet": BASE,
    "core/sound": BASE,
    "core/zone": BASE,
    "haptics": CORE,
    "volumes": CORE,
    "app/view": CORE,
    "app/session": CORE + ["haptics"],
    "app/stage": INPUT + VIEW,
    "app/effect": STAGE,
    "app/scene": EFFECT,
    "app/run": SCENE + ["app/session"],
    "app/report": CORE,
    "app/job": RUN + ["app/report"],
    "app/render": CORE + VIEW,
    "app/lab/oracle": CORE + ["haptics", "volumes"],
    "app/lab": JOB + ["app/render", "app/lab/oracle"],
    "app/bench": JOB + ["app/render"],
    "app/window": JOB + ["app/render"],
    "app/audio": BASE + ["core/sound"],
    "app/cli": JOB + ["app/render", "app/lab", "app/window", "app/audio"],
}

# At most six files instantiate an OpenVDB grid: each costs seconds to compile and nearly half a minute under a sanitizer.
MAX_OPENVDB_FILES = 6

# Library header, or our own that exposes one (pattern on the path as included), its name, and the only places that may include it.
WRAPPED = [
    (r"(openvdb|nanovdb)/", "OpenVDB", ["core/voxel/", "volumes/", "app/bench/vdb_baselines.cpp", "app/lab/vdb_mesher.cpp"]),
    (r"(glad|GL|EGL|GLES\d?)/", "OpenGL", ["app/render/"]),
    (r"toml\+\+/|toml\.hpp$", "toml++", ["core/config/toml_parsed.h"]),
    (r"core/config/toml_parsed\.h$", "toml++", ["core/config/toml"]),
    (r"sqlite3(ext)?\.h$", "SQLite", ["app/session/sqlite_file.h"]),
    (r"app/session/sqlite_file\.h$", "SQLite", ["app/session/s"]),
    (r"png\.h$", "libpng", ["app/render/"]),
    (r"GLFW/", "GLFW", ["app/render/", "app/window/"]),
    (r"imgui", "Dear ImGui", ["app/window/"]),
    (r"AL/", "OpenAL", ["app/audio/"]),
    (r"CLI/", "CLI11", ["app/cli/", "app/bench/main.cpp", "app/render/embed_shaders_main.cpp"]),
    (r"itk[A-Z]", "ITK", ["tests/"]),
    (r"gdcm", "GDCM", ["volumes/read/gdcm_codecs.cpp"]),
    (r"zlib\.h$", "zlib", ["app/session/row_codec.cpp", "volumes/read/", "volumes/write/packed_file.cpp"]),
    # Reading: located_json.cpp, which knows where each value stands. Elsewhere JSON is written.
    (r"nlohmann/", "nlohmann JSON", ["app/", "volumes/import_bone.cpp", "volumes/read/located_json.cpp", "volumes/write/planned_line.cpp"]),
    (r"hwy/", "Highway", ["core/"]),
    # vdb_grids.cpp: OpenVDB must be initialised once, from whichever thread comes first. parallel.cpp: loops on all cores.
    (
        r"(thread|mutex|shared_mutex|condition_variable|future)$",
        "threading",
        ["app/", "haptics/", "core/base/parallel.cpp", "core/voxel/vdb_grids.cpp"],
    ),
]

# Precompiled headers hide a missing include: a build without them fails. Namespace, and the folder of its headers.
NAMED_LIBRARIES = {"fmt": "fmt/", "glm": "glm/", "CLI": "CLI/"}

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


class Reach:
    """Headers that a file includes, by way of our own headers or directly."""

    def __init__(self, root):
        self.root, self.known = root, {}

    def of(self, path):
        """@returns every name included from file `path` on."""
        if path in self.known:
            return self.known[path]
        self.known[path] = names = set()
        file = self.root / path
        if not file.is_file():
            return names
        for found in map(INCLUDE.match, file.read_text(encoding="utf-8").splitlines()):
            if found:
                names.add(found.group(2))
                if found.group(2).split("/")[0] in CODE_FOLDERS:
                    names |= self.of(found.group(2))
        return names

    def faults(self, path):
        """@returns the first line of file `path` that names a library of which no header is included, for each."""
        lines, faults = (self.root / path).read_text(encoding="utf-8").splitlines(), []
        for space, folder in NAMED_LIBRARIES.items():
            used = re.compile(rf"(?<![\w:]){space}::")
            line = next((n for n, text in enumerate(lines, start=1) if used.search(text.split("//")[0])), None)
            if line and not any(name.startswith(folder) for name in self.of(path)):
                faults.append(f"{path}:{line}: names {space}:: and includes no header of {folder}")
        return faults


def check_tree(root):
    """@returns every fault of the tree, in order of path and line."""
    faults, openvdb_files, reach = [], [], Reach(root)
    for folder in CODE_FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SUFFIXES or not file.is_file():
                continue
            path = file.relative_to(root).as_posix()
            found, openvdb = check_file(root, path)
            faults += found + reach.faults(path)
            if openvdb:
                openvdb_files.append(path)
    if len(openvdb_files) > MAX_OPENVDB_FILES:
        faults.append(f"{openvdb_files[-1]}:1: {len(openvdb_files)} files include OpenVDB, at most {MAX_OPENVDB_FILES} may: "
                      + ", ".join(openvdb_files))
    return faults


def dead_rules(root):
    """@returns the boxes and wrappers above that name nothing in the tree."""
    included = {found.group(2) for folder in CODE_FOLDERS + ["tests"] for file in (root / folder).rglob("*") if file.suffix in SUFFIXES
                for found in map(INCLUDE.match, file.read_text(encoding="utf-8").splitlines()) if found}
    faults = [f"box {box} is no folder" for box in SEES if not (root / box).is_dir()]
    for pattern, library, places in WRAPPED:
        if not any(re.match(pattern, header) for header in included):
            faults.append(f"no file includes {library} ({pattern})")
        faults += [f"{library} may be included in {place}, where nothing is" for place in places
                   if not (root / place).exists() and not list(root.glob(place + "*"))]
    return [f"scripts/check_includes.py:1: {fault}" for fault in faults]


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    faults = check_tree(root) + dead_rules(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 3 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
