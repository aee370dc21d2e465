#!/usr/bin/env python3
"""Adds up JUnit files as ctest writes them: prints `N passed, M failed[, K skipped]`; exit 1 if any failed or a file is missing.

An entry that is a whole doctest program counts its cases, by the line at the end of its output; a program that died counts as one failure.

A missing file means that a preset was not built or not run, and counts as one failure: silence must not look like success.
"""
import argparse
import re
import sys
import xml.etree.ElementTree as ET


DOCTEST_SUM = re.compile(r"^\[doctest\] test cases: *\d+ *\| *(\d+) passed *\| *(\d+) failed", re.M)


def count_entry(entry):
    """@returns (passed, failed, skipped) of one entry of ctest."""
    if entry.get("status") in ("notrun", "disabled") or entry.find("skipped") is not None:
        return 0, 0, 1
    failed = entry.get("status") == "fail" or entry.find("failure") is not None
    summed = DOCTEST_SUM.search(entry.findtext("system-out") or "")
    if not summed:
        return (0, 1, 0) if failed else (1, 0, 0)
    passed, failures = int(summed.group(1)), int(summed.group(2))
    return passed, max(failures, int(failed)), 0


def count(path):
    """@returns (passed, failed, skipped) of one file; (0, 1, 0) if it cannot be read."""
    try:
        cases = ET.parse(path).getroot().findall("testcase")
    except (OSError, ET.ParseError) as fault:
        print(f"sum_junit: {path}: {fault}", file=sys.stderr)
        return 0, 1, 0
    return tuple(sum(column) for column in zip((0, 0, 0), *map(count_entry, cases)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--name", help="printed in front of the counts")
    arguments = parser.parse_args()
    passed, failed, skipped = (sum(column) for column in zip(*map(count, arguments.files)))
    line = f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else "")
    print(f"{arguments.name}: {line}" if arguments.name else line)
    return 1 if failed or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
