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

    def test_a_missing_or_broken_report_fails(self):
        self.assertEqual(self.run_on(Path(self.folder.name) / "none.xml").returncode, 1)
        self.assertEqual(self.run_on(self.file("cut.xml", GOOD[:40])).returncode, 1)


if __name__ == "__main__":
    unittest.main()
