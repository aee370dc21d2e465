#!/usr/bin/env python3
"""Fails when a function marked BH_REALTIME is run by no test on the memory trap: `file:line: what is wrong`.

The tests name what they run as string literals "header: function" (tests/app/run/realtime_test.cpp). A name that stands for no marked
function is wrong too. Overloads and overrides in one header share a name.

  check_realtime.py [ROOT]        exit 0: all are covered, 3: some are not (one line each)
"""
import re
import sys
from pathlib import Path

TEST = "tests/app/run/realtime_test.cpp"
FOLDERS = ["core", "haptics", "volumes", "app"]
# Not run by any schedule: the lab's own hand, which its studies step.
EXEMPT = ["app/lab/"]
LONGEST = 2000  # characters of a declaration
LISTED = re.compile(r'"((?:core|haptics|volumes|app)/[\w/]+\.h): ([\w()]+)"')


def without_comments(text):
    """@returns the text with comments blanked, every newline kept."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)


def name_before(text, end):
    """@returns the name of the function whose declaration carries the mark at `end`, or None."""
    head = re.sub(r"(\s|\b(noexcept|const|override)\b)+$", "", text[max(0, end - LONGEST):end])
    if not head.endswith(")"):
        return None
    depth = 0
    for at in range(len(head) - 1, -1, -1):
        depth += {")": 1, "(": -1}.get(head[at], 0)
        if depth == 0:
            found = re.search(r"(operator\s*\(\s*\)|\w+)\s*$", head[:at])
            return re.sub(r"\s", "", found.group(1)) if found else None
    return None


def marked_functions(root):
    """@returns {(header, function): line} of every marked function, and faults of marks that stand behind no function."""
    marked, faults = {}, []
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*.h")):
            path = file.relative_to(root).as_posix()
            text = without_comments(file.read_text(encoding="utf-8"))
            for mark in re.finditer(r"^(?!\s*#).*?\bBH_REALTIME\b", text, flags=re.M):
                end = mark.end() - len("BH_REALTIME")
                line = text.count("\n", 0, end) + 1
                name = name_before(text, end)
                if name is None:
                    faults.append(f"{path}:{line}: BH_REALTIME stands behind no function")
                elif not path.startswith(tuple(EXEMPT)):
                    marked.setdefault((path, name), line)
    return marked, faults


def check_tree(root):
    """@returns every fault of the tree."""
    marked, faults = marked_functions(root)
    test = root / TEST
    text = test.read_text(encoding="utf-8") if test.is_file() else ""
    listed = {}
    for found in LISTED.finditer(text):
        listed.setdefault((found.group(1), found.group(2)), text.count("\n", 0, found.start()) + 1)
    for (path, name), line in marked.items():
        if (path, name) not in listed:
            faults.append(f'{path}:{line}: {name} is marked BH_REALTIME; no case of {TEST} says "{path}: {name}"')
    for (path, name), line in listed.items():
        if (path, name) not in marked:
            faults.append(f"{TEST}:{line}: {path} marks no function {name}")
    return faults


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    faults = check_tree(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 3 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
