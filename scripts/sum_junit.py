#!/usr/bin/env python3
"""Adds up JUnit files as ctest writes them: prints `N passed, M failed[, K skipped]`; exit 1 if any failed or a file is missing.

A missing file means that a preset was not built or not run, and counts as one failure: silence must not look like success.
"""
import argparse
import sys
import xml.etree.ElementTree as ET


def count(path):
    """@returns (passed, failed, skipped) of one file; (0, 1, 0) if it cannot be read."""
    try:
        cases = ET.parse(path).getroot().findall("testcase")
    except (OSError, ET.ParseError) as fault:
        print(f"sum_junit: {path}: {fault}", file=sys.stderr)
        return 0, 1, 0
    failed = sum(1 for case in cases if case.get("status") == "fail" or case.find("failure") is not None)
    skipped = sum(1 for case in cases if case.get("status") in ("notrun", "disabled") or case.find("skipped") is not None)
    return len(cases) - failed - skipped, failed, skipped


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
