"""stability_page: tables are inserted between their marks only; a missing mark or figure is an error."""
import importlib.machinery
import importlib.util
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
LOADER = importlib.machinery.SourceFileLoader("stability_page", str(ROOT / "scripts" / "stability_page"))
PAGE = importlib.util.module_from_spec(importlib.util.spec_from_loader("stability_page", LOADER))
LOADER.exec_module(PAGE)

TEXT = "# Page\n\nBefore.\n<!-- cases: begin, by hand never -->\nold\n<!-- cases: end -->\nAfter.\n"


def rates(limit):
    rows = []
    for subject in ("pressed onto a sphere", "drilling into a sphere", "sliding over a sphere"):
        for rate in (1000, 20):
            for n, scheme in enumerate(PAGE.SCHEMES):
                for name, value in (("stiffness_limit", limit + n), ("force_rms_off", 0.25 * n)):
                    rows.append({"subject": subject, "error_name": name, "model": scheme, "setting": str(rate), "error": str(value)})
    return rows


class Splice(unittest.TestCase):
    def test_a_table_goes_between_its_marks_and_what_is_written_by_hand_stays(self):
        once = PAGE.splice(TEXT, "cases", "| a |\n")
        self.assertEqual(once, TEXT.replace("old\n", "\n| a |\n\n"))
        self.assertEqual(PAGE.splice(once, "cases", "| a |\n"), once)

    def test_a_page_without_its_marks_or_with_two_of_them_is_refused(self):
        for page in (TEXT.replace("<!-- cases: end -->", ""), TEXT + TEXT, TEXT.replace("cases", "rates")):
            with self.assertRaises(PAGE.Failure):
                PAGE.splice(page, "cases", "new")

    def test_the_shipped_page_has_a_place_for_every_table(self):
        page = PAGE.PAGE.read_text()
        for name, *_ in PAGE.MEASURED:
            self.assertIn("here", PAGE.splice(page, name, "here"))


class Tables(unittest.TestCase):
    def test_contact_rates_are_tabled_by_scheme(self):
        text = PAGE.contact_rates(rates(300))
        self.assertIn("| 1000 Hz | 300 | 301 | 302 | 303 | 300 | 301 | 302 | 303 |", text)
        self.assertIn("| 20 Hz | 0.0 | 0.2 | 0.5 | 0.8 |", text)
        self.assertEqual(text.count("|---|---|---|---|---|---|---|---|---|\n"), 2)

    def test_a_figure_that_was_not_measured_is_a_fault(self):
        with self.assertRaises(KeyError):
            PAGE.contact_rates(rates(300)[:-3])
        with self.assertRaises(PAGE.Failure):
            PAGE.one([{"part": "known"}], part="rate")


if __name__ == "__main__":
    unittest.main()
