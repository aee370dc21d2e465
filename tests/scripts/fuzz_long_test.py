"""scripts/fuzz --long: time goes to fuzzers that find new code, none is left out, and inputs are counted without those a slice starts from."""
import argparse
import importlib.util
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
FUZZ = Path(__file__).resolve().parents[2] / "tests" / "fuzz"


def load(name):
    spec = importlib.util.spec_from_file_location(name, FUZZ / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


LONG, COVERAGE = load("long_run"), load("coverage")
LOG = """INFO: seed corpus: files: 3
#4\tINITED cov: 10 ft: 11 corp: 3/9b exec/s: 0 rss: 30Mb
#90\tNEW    cov: 12 ft: 14 corp: 4/12b
#1000\tDONE   cov: 12 ft: 14
stat::number_of_executed_units: 1000
stat::new_units_added:          7
"""
# Stands for a fuzzer: writes that log; one of its name has a fault.
STAND_IN = f"""#!/bin/sh
cat <<'END'
{LOG}END
case "$0" in *broken) exit 77 ;; esac
"""


class LongRun(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_inputs_are_those_beyond_the_start(self):
        self.assertEqual(LONG.read_log(LOG), (996, 7))
        self.assertEqual(LONG.read_log(LOG[:LOG.index("#1000")]), (86, 0))  # ended by a fault: what was seen
        self.assertEqual(LONG.read_log("INFO: seed corpus: files: 3\n#2\tpulse\n"), (0, 0))  # ended while it started

    def test_the_counts_of_all_calls_are_added(self):
        counts = self.folder / "inputs.json"
        for name, inputs in (("b", 5), ("a", 1), ("b", 10)):
            LONG.add_to(counts, name, inputs)
        self.assertEqual(json.loads(counts.read_text()), {"a": 1, "b": 15})
        self.assertEqual([p.name for p in self.folder.iterdir()], ["inputs.json"])

    def test_shares_follow_the_finds_and_none_is_left_out(self):
        fuzzers = [LONG.Fuzzer(name) for name in "abc"]
        given = dict.fromkeys("abc", 0)
        for _ in range(1000):
            chosen = LONG.next_of(fuzzers, set())
            given[chosen.name] += 1
            chosen.after(60.0, 600 if chosen.name == "b" else 0)
        self.assertGreater(given["b"], 900)
        for name in "ac":
            self.assertGreater(given[name], 1000 * LONG.LEAST_SHARE / 2)
        self.assertAlmostEqual(sum(LONG.weights(fuzzers).values()), 1.0)

    def test_one_that_runs_or_is_broken_is_not_chosen(self):
        fuzzers = [LONG.Fuzzer(name) for name in "abc"]
        fuzzers[0].broken = True
        self.assertEqual(LONG.next_of(fuzzers, {"b"}).name, "c")
        self.assertIsNone(LONG.next_of(fuzzers, {"b", "c"}))

    def run_stand_ins(self, *names):
        programs = self.folder / "programs"
        programs.mkdir()
        for name in names:
            (programs / f"fuzz_{name}").write_text(STAND_IN)
            (programs / f"fuzz_{name}").chmod(0o755)
        asked = argparse.Namespace(programs=programs, folder=self.folder, counts=self.folder / "inputs.json", hours=0.0, slice=1, jobs=1)
        run = LONG.LongRun(asked, [LONG.Fuzzer(name) for name in names])
        ran, one = [], LONG.run_slice

        def and_stop(programs, folder, fuzzer, seconds, processes):
            ran.append(fuzzer.name)
            if len(ran) == 5:
                run.stop.set()
            return one(programs, folder, fuzzer, seconds, processes)
        self.addCleanup(setattr, LONG, "run_slice", one)
        LONG.run_slice = and_stop
        return run, ran

    def test_a_fault_ends_its_fuzzer_alone_and_is_reported(self):
        run, ran = self.run_stand_ins("broken", "whole")
        self.assertEqual(run.run(), 1)
        self.assertEqual(sorted(ran), ["broken"] + ["whole"] * 4)
        self.assertEqual(json.loads((self.folder / "inputs.json").read_text()), {"broken": 996, "whole": 4 * 996})
        self.assertTrue((self.folder / "found" / "broken.failed.log").exists())

    def test_without_a_fault_it_succeeds(self):
        run, _ = self.run_stand_ins("one", "two")
        self.assertEqual(run.run(), 0)
        self.assertEqual(sum(json.loads((self.folder / "inputs.json").read_text()).values()), 5 * 996)


class Readers(unittest.TestCase):
    def test_every_fuzzer_has_a_reader_whose_sources_are_there(self):
        self.assertEqual(sorted(COVERAGE.READERS), sorted(file.name.removesuffix("_fuzzer.cpp") for file in FUZZ.glob("*_fuzzer.cpp")))
        for name, patterns in COVERAGE.READERS.items():
            for pattern in patterns:
                self.assertTrue(list(COVERAGE.ROOT.glob(pattern)), f"{name}: {pattern}")
                self.assertFalse(os.path.isabs(pattern))


if __name__ == "__main__":
    unittest.main()
