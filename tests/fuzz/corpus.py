#!/usr/bin/env python3
"""Packs the kept inputs of one fuzzer into an archive, and unpacks it: one file a reader in the repository. The same inputs give the same bytes.

  corpus.py pack FOLDER ARCHIVE
  corpus.py unpack ARCHIVE FOLDER        adds to the folder, which is made
"""
import io
import sys
import tarfile
from pathlib import Path


def pack(folder, archive):
    """Writes the files of a folder, in order of their names, without times and owners."""
    with tarfile.open(archive, "w", format=tarfile.USTAR_FORMAT) as out:
        for file in sorted(Path(folder).iterdir(), key=lambda file: file.name):
            content = file.read_bytes()
            entry = tarfile.TarInfo(file.name)
            entry.size = len(content)
            out.addfile(entry, io.BytesIO(content))


def unpack(archive, folder):
    """Writes the inputs of an archive into a folder. A member that is no plain file with a plain name is an error."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    with tarfile.open(archive) as packed:
        for entry in packed:
            if not entry.isfile() or Path(entry.name).name != entry.name:
                raise ValueError(f"{archive}: {entry.name} is no input")
            (Path(folder) / entry.name).write_bytes(packed.extractfile(entry).read())


def main():
    actions = {"pack": pack, "unpack": unpack}
    if len(sys.argv) != 4 or sys.argv[1] not in actions:
        sys.exit("usage: corpus.py pack FOLDER ARCHIVE | unpack ARCHIVE FOLDER")
    actions[sys.argv[1]](sys.argv[2], sys.argv[3])


if __name__ == "__main__":
    main()
