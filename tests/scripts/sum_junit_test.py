"""sum_junit.py: counts add up over files, and a missing report is a failure, never a silent success."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "sum_junit.py"
GOOD = """<testsuite tests="3"><testcase name="a" status="run"/><testcase name="b" status="run"/>
<testcase name="c" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase></testsuite>"""
BAD = """<testsuite tests="2"><testcase name="a" status="run"/><testcase name="b" status="fail"><failure message=""/></testcase></testsuite>"""


class Sum(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, name, text):
        path = Path(self.folder.name) / name
        path.write_text(text, encoding="utf-8")
        return path

    def run_on(self, *paths):
        return subprocess.run([sys.executable, SCRIPT, *paths], capture_output=True, text=True, check=False)

    def test_passes_and_skips_are_counted_apart(self):
        run = self.run_on(self.file("good.xml", GOOD))
        self.assertEqual((run.returncode, run.stdout), (0, "2 passed, 0 failed, 1 skipped\n"))

    def test_one_failure_in_one_file_fails_the_sum(self):
        run = self.run_on(self.file("good.xml", GOOD), self.file("bad.xml", BAD))
        self.assertEqual((run.returncode, run.stdout), (1, "3 passed, 1 failed, 1 skipped\n"))

    def test_a_whole_program_counts_its_cases(self):
        entry = ('<testsuite><testcase name="p" status="{}">{}<system-out>[doctest] doctest version is "2.4.9"\n'
                 "[doctest] test cases:  48 |  {} passed | {} failed | 3 skipped\n</system-out></testcase></testsuite>")
        run = self.run_on(self.file("good.xml", entry.format("run", "", 48, 0)))
        self.assertEqual((run.returncode, run.stdout), (0, "48 passed, 0 failed\n"))
        run = self.run_on(self.file("bad.xml", entry.format("fail", '<failure message=""/>', 46, 2)))
        self.assertEqual((run.returncode, run.stdout), (1, "46 passed, 2 failed\n"))

    def test_a_program_that_died_is_a_failure_whatever_it_printed(self):
        died = '<testsuite><testcase name="p" status="fail"><failure message=""/><system-out>{}</system-out></testcase></testsuite>'
        for text, expected in (("Segmentation fault", "0 passed, 1 failed\n"),
                               ("[doctest] test cases: 2 | 2 passed | 0 failed |", "2 passed, 1 failed\n")):
            run = self.run_on(self.file("died.xml", died.format(text)))
            self.assertEqual((run.returncode, run.stdout), (1, expected))

    def test_a_missing_or_broken_report_fails(self):
        self.assertEqual(self.run_on(Path(self.folder.name) / "none.xml").returncode, 1)
        self.assertEqual(self.run_on(self.file("cut.xml", GOOD[:40])).returncode, 1)


if __name__ == "__main__":
    unittest.main()
