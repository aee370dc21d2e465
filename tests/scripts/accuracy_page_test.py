"""accuracy_page: tables of drilled holes are inserted between their marks only; a missing mark or file is an error."""
import importlib.machinery
import importlib.util
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
LOADER = importlib.machinery.SourceFileLoader("accuracy_page", str(ROOT / "scripts" / "accuracy_page"))
PAGE = importlib.util.module_from_spec(importlib.util.spec_from_loader("accuracy_page", LOADER))
LOADER.exec_module(PAGE)


class Filled(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = Path(self.scratch.name)
        for name, file, *_ in PAGE.MEASURED:
            (self.folder / file).parent.mkdir()
            (self.folder / file).write_text(f"| table of {name} |\n")

    def test_the_shipped_page_has_a_place_for_every_table_and_the_rest_stays(self):
        page = PAGE.PAGE.read_text()
        once = PAGE.filled(page, self.folder)
        for name, *_ in PAGE.MEASURED:
            self.assertIn(f"| table of {name} |", once)
        self.assertEqual(PAGE.filled(once, self.folder), once)
        begin = f"<!-- {PAGE.MEASURED[0][0]}: begin"
        self.assertEqual(once.split(begin)[0], page.split(begin)[0])
        self.assertEqual(once.split("<!-- drilling convergence: end -->")[1], page.split("<!-- drilling convergence: end -->")[1])

    def test_a_page_without_a_mark_is_refused(self):
        with self.assertRaises(PAGE.STABILITY.Failure):
            PAGE.filled(PAGE.PAGE.read_text().replace("<!-- drilling cost: end -->", ""), self.folder)

    def test_a_missing_table_is_an_error(self):
        (self.folder / PAGE.MEASURED[1][1]).unlink()
        with self.assertRaises(OSError):
            PAGE.filled(PAGE.PAGE.read_text(), self.folder)


if __name__ == "__main__":
    unittest.main()
