"""Keys of a scene with extreme values: a seeded part of what scripts/reliability tries, and that its checks notice what they are for.

Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import pathlib
import subprocess
import sys
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from program_support import PROGRAM, WithFolder  # noqa: E402
from scene_extremes import Bench, keys_of  # noqa: E402

TRIALS, SEED = 60, 20
REFERENCE = """## Top of the file
| key | value | default | what it is |
|---|---|---|---|
| `servo_hz` | whole number in [100, 20000] Hz | `1000` | rate of the servo |

## `[volume]`
The bone; required.

| key | value | default | what it is |
|---|---|---|---|
| `source` | text | **required** | where it is |
"""
# Programs that print that reference, and do something else with a scene.
WRONG = {
    "dies of a signal": "kill -SEGV $$",
    "calls it an internal error": "echo 'internal error: no'; exit 2",
    "has an exit code of its own making": "echo 'scene.toml: no' >&2; exit 7",
    "refuses without a line": "exit 2",
    "prints a control character": "printf 'scene.toml: \\033[31mno\\n' >&2; exit 2",
    "prints the whole value": "head -c 5000 /dev/zero | tr '\\0' x >&2; exit 2",
    "writes a figure that is no number": "mkdir -p out; echo '{\"depth_mm\": NaN}' > out/summary.json",
    "writes no results": "exit 0",
    "accepts it and does not drill it": "[ $1 = check ] || { echo 'scene.toml: no' >&2; exit 2; }",
}


class Extremes(WithFolder):
    def test_a_seeded_part_is_survived(self):
        bench = Bench(PROGRAM, self.folder)
        for key, value in bench.some(TRIALS, SEED):
            bench.trial(key, value)
        self.assertEqual(bench.failures, [])
        self.assertEqual(bench.trials, TRIALS)
        self.assertGreater(bench.accepted, 0)

    def test_the_keys_are_those_of_the_reference_with_their_ranges_and_choices(self):
        reference = subprocess.run([PROGRAM, "docs", "scene"], capture_output=True, text=True, check=True).stdout
        keys = keys_of(reference)
        self.assertEqual(len(keys), sum(line.startswith("| `") for line in reference.splitlines()))
        by_name = {str(key): key for key in keys}
        self.assertIn("20000", by_name["servo_hz"].values())
        self.assertIn('"plane"', by_name["display.cut"].values())
        self.assertIn("[500, 500, 500]", by_name["volume.extent_mm"].values())
        self.assertTrue(by_name["display.transfer.density"].listed)


class Checks(WithFolder):
    def bench(self, body):
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\nif [ $1 = docs ]; then cat <<'END'\n{REFERENCE}END\nexit 0; fi\n{body}\n")
        program.chmod(0o755)
        return Bench(program, self.folder)

    def test_each_kind_of_failure_is_noticed(self):
        for what, body in WRONG.items():
            with self.subTest(what):
                bench = self.bench(body)
                bench.trial(bench.scenes.keys[0], "-1")
                self.assertEqual(len(bench.failures), 1, bench.failures)

    def test_a_refusal_in_a_line_and_a_run_with_results_are_none(self):
        for body in ("echo 'scene.toml:1:1: servo_hz = -1 must be in [100, 20000]' >&2; exit 2", "mkdir -p out; echo '{\"depth_mm\": null}' > out/summary.json"):
            bench = self.bench(body)
            bench.trial(bench.scenes.keys[0], "-1")
            self.assertEqual(bench.failures, [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
