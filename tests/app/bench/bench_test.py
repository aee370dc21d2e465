"""burrhole_bench, run short: bench.json has the promised machine, rows and keys, results agree, and a result that differs is found.

  bench_test.py PROGRAM        exit 77 where there is no OpenGL
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

KEYS = ["area", "name", "value", "unit", "baseline", "ratio", "ship", "aim", "lower_is_better"]
MACHINE = ["cpu", "cores", "simd", "compiler", "build_type", "revision", "date"]
PROGRAM = sys.argv.pop(1)


def content(out):
    """@returns the whole of a folder's bench.json, or None."""
    file = Path(out) / "bench.json"
    return json.loads(file.read_text()) if file.exists() else None


def run(*arguments, out):
    """@returns (exit status, lines of stderr, rows or None) of one short run."""
    done = subprocess.run([PROGRAM, *arguments, "--out", out], capture_output=True, text=True)
    written = content(out)
    return done.returncode, done.stderr.splitlines(), written and written["rows"]


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = folder.name

    def test_every_row_has_the_keys_and_no_result_differs(self):
        status, errors, rows = run("--quick", out=self.out)
        self.assertEqual(status, 0, errors)
        self.assertEqual({row["area"] for row in rows}, MEASURED)
        self.assertEqual(len({(row["area"], row["name"]) for row in rows}), len(rows), "two rows have one name")
        for row in rows:
            with self.subTest(row=row["name"]):
                self.assertEqual(list(row), KEYS)
                for key in ["value", "baseline", "ratio"]:
                    self.assertTrue(math.isfinite(row[key]) and row[key] > 0.0, row)
                for key in ["ship", "aim"]:
                    self.assertTrue(row[key] is None or row[key] > 0.0, row)
                self.assertIsInstance(row["lower_is_better"], bool)
                over = row["value"] / row["baseline"]
                # Six digits: the three numbers are rounded apart, if at all. An absolute row has baseline 1 and ratio = value.
                expected = over if row["lower_is_better"] or row["baseline"] == 1.0 else 1.0 / over
                self.assertAlmostEqual(row["ratio"] / expected, 1.0, places=6)

    def test_one_flipped_bit_in_any_result_is_named_and_its_row_left_out(self):
        status, errors, rows = run("--quick", "--sabotage", out=self.out)
        self.assertEqual(status, 3, errors)
        compared = [row for row in rows if row["baseline"] != 1.0]
        self.assertEqual(compared, [], "a row was kept although what it compares was broken")
        for area in MEASURED:
            self.assertTrue(any(line.startswith(f"bench: {area}: ") and "differ" in line for line in errors), (area, errors))

    def test_an_area_may_be_asked_for_alone(self):
        status, _, rows = run("--quick", "erosion", out=self.out)
        self.assertEqual((status, {row["area"] for row in rows}), (0, {"erosion"}))

    def test_the_file_names_the_machine_and_the_build(self):
        # An area that is left out without data, or imports four slices: the shortest run.
        status, errors, _ = run("--quick", "import", "--revision", "v1-2-gabc", "--simd", "sse4", out=self.out)
        self.assertEqual(status, 0, errors)
        written = content(self.out)
        self.assertEqual(list(written), ["machine", "quick", "rows"])
        self.assertIs(written["quick"], True)
        machine = written["machine"]
        self.assertEqual(list(machine), MACHINE)
        self.assertEqual((machine["revision"], machine["simd"], machine["cores"]), ("v1-2-gabc", "sse4", len(os.sched_getaffinity(0))))
        named = [line.split(": ", 1)[1].rstrip("\n") for line in open("/proc/cpuinfo") if line.startswith("model name")]
        self.assertEqual(machine["cpu"], named[0] if named else "unknown")
        self.assertRegex(machine["compiler"], r"^(g\+\+|clang) \d+\.")
        self.assertRegex(machine["date"], r"^20\d\d-[01]\d-[0-3]\d$")
        self.assertTrue(machine["build_type"])

    def test_frames_of_a_back_end_have_a_table_of_their_own(self):
        if "render" not in AREAS:
            self.skipTest("no renderer")
        for gl in ("egl", "osmesa"):
            status, errors, rows = run("render", "--gl", gl, "--size", "64x48", "--quick", out=self.out)
            if status == 4:
                continue  # not here, and said so
            self.assertEqual(status, 0, errors)
            self.assertEqual([row["unit"] for row in rows], 6 * ["frames/s"])  # three methods, each still and after changes
            table = (Path(self.out) / "render_frames.csv").read_text().splitlines()
            self.assertEqual(table[0], "driver,method,voxels_along_edge,width,height,eyes,median_ms,p99_ms,frames_per_s,changed_median_ms,"
                                       "changed_p99_ms,paper_hz")
            self.assertEqual(len(table), 4)
            self.assertTrue(all(gl + ": 4." in line for line in table[1:]), table)
        for wrong in (["--gl", "glide"], ["--gl", "egl", "--size", "9x9"], ["contact", "--gl", "egl"]):
            status, errors, _ = run("render", *wrong, out=self.out)
            self.assertEqual((status, len(errors)), (2, 1), errors)

    def test_an_unknown_area_is_one_line_and_exit_2(self):
        status, errors, rows = run("kontact", out=self.out)
        self.assertEqual((status, len(errors), rows), (2, 1, None))
        self.assertIn("kontact", errors[0])
        self.assertIn("contact", errors[0].replace("kontact", ""))


def areas_of_this_build():
    """The program names them when it refuses one."""
    return set(subprocess.run([PROGRAM, "?"], capture_output=True, text=True).stderr.strip().split("has ")[-1].split(", "))


AREAS = areas_of_this_build()
# Without real slices an import is not measured, and the program says so.
MEASURED = AREAS if os.environ.get("BURRHOLE_DATA") else AREAS - {"import"}
if MEASURED != AREAS:
    print("skipped: bench, area import: needs real scans, and BURRHOLE_DATA is not set", flush=True)
if "render" in AREAS:
    with tempfile.TemporaryDirectory() as probe:
        if run("--quick", "render", out=probe)[0] == 4:
            print("skipped: bench: needs OpenGL 4.5")
            sys.exit(77)
unittest.main()
