#!/usr/bin/env python3
"""Tables how many lines of its reader's own sources each fuzzer reaches, from its seeds, its corpus and what it found.

  coverage.py PROGRAMS FOLDER        PROGRAMS holds fuzz_NAME, built with the coverage of clang; FOLDER holds seeds, corpus and found

Only the lines of the reader are counted: not those of what it is called with, nor of steps that it never takes.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# The sources that are the reader, by fuzzer.
READERS = {
    "command": ["app/cli/program.cpp", "app/cli/command_text.cpp"],
    "dicom": ["volumes/read/dicom_*.cpp", "volumes/read/jpeg_scan.cpp"],
    "markups": ["volumes/read/markups.cpp", "volumes/read/located_json.cpp"],
    "mesh": ["volumes/read/stl_format.cpp", "volumes/read/obj_format.cpp", "volumes/read/ply_format.cpp", "volumes/read/polygon.cpp", "core/tool/surface_mesh.cpp"],
    "metaimage": ["volumes/read/meta_header.cpp"],
    "nifti": ["volumes/read/nifti_header.cpp"],
    "nrrd": ["volumes/read/nrrd_header.cpp"],
    "override": ["core/config/toml_parsed.cpp", "core/config/toml_shape.cpp"],
    "raw_sidecar": ["volumes/read/raw_sidecar.cpp"],
    "scene": ["app/scene/scene.cpp", "app/scene/volume_scene.cpp", "core/config/toml.cpp", "core/config/toml_messages.cpp", "core/config/toml_shape.cpp"],
    "session": ["app/session/session_reader.cpp", "app/session/row_codec.cpp", "app/session/sqlite_file.cpp"],
    "slice_stack": ["volumes/read/slice_stack.cpp"],
    "tool": ["core/tool/tool_spec.cpp", "core/tool/mesh_spec.cpp", "core/tool/outline*.cpp", "core/tool/shape.cpp"],
    "vdb": ["core/voxel/vdb_header.cpp"],
}


def lines_of(program, name, folder, work):
    """@returns (lines reached, lines) of the reader's sources."""
    raw, merged = work / f"{name}.profraw", work / f"{name}.profdata"
    inputs = [str(path) for part in ("seeds", "corpus", "found") if (path := folder / part / name).is_dir()]
    subprocess.run([program, "-runs=0", *inputs], env={"LLVM_PROFILE_FILE": str(raw), "PATH": "/usr/bin"}, check=True, capture_output=True)
    subprocess.run(["llvm-profdata", "merge", "-sparse", raw, "-o", merged], check=True)
    sources = sorted({file for pattern in READERS[name] for file in ROOT.glob(pattern)})
    if not sources:
        raise ValueError(f"{name} has no source: {READERS[name]}")
    report = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={merged}", program], check=True, capture_output=True, text=True)
    # Chosen here: llvm-cov compares names as they were compiled, by a relative path, and takes all where none agrees.
    found = [file["summary"]["lines"] for file in json.loads(report.stdout)["data"][0]["files"]
             if (ROOT / file["filename"]).resolve() in sources]
    if not found:
        raise ValueError(f"{name}: none of {READERS[name]} is in the program")
    return sum(lines["covered"] for lines in found), sum(lines["count"] for lines in found)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: coverage.py PROGRAMS FOLDER")
    programs, folder = Path(sys.argv[1]), Path(sys.argv[2])
    counts = ROOT / "tests" / "fuzz" / "inputs.json"
    inputs = json.loads(counts.read_text()) if counts.exists() else {}
    print("| reader | inputs | lines reached | of |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as work:
        for name in sorted(READERS):
            reached, lines = lines_of(programs / f"fuzz_{name}", name, folder, Path(work))
            print(f"| {name} | {inputs.get(name, 0):,} | {100.0 * reached / lines:.1f} % | {lines} |")
    print(f"| all | {sum(inputs.values()):,} | | |")


if __name__ == "__main__":
    main()
