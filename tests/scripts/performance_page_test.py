"""performance_page: the shipped page is current, tables hold what the file holds, and a changed number or a broken file is found."""
import importlib.machinery
import importlib.util
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "performance_page"
LOADER = importlib.machinery.SourceFileLoader("performance_page", str(SCRIPT))
PAGE = importlib.util.module_from_spec(importlib.util.spec_from_loader("performance_page", LOADER))
LOADER.exec_module(PAGE)

SHIPPED = ROOT / "docs" / "performance.md"
TEXT = "# Page\nBefore.\n<!-- bench:run -->\n<!-- end -->\n## Contact\n<!-- bench:contact -->\nold\n<!-- end -->\nAfter.\n"
MACHINE = {"cpu": "Model 7", "cores": 4, "simd": "avx2", "compiler": "g++ 12.2.0", "build_type": "Release", "revision": "abc123",
           "date": "2026-02-03"}


def a_row(**changes):
    return {"area": "contact", "name": "ball", "value": 18.61, "unit": "ns/point", "baseline": 660.4, "ratio": 35.49, "ship": 15.0, "aim": 30.0,
            "lower_is_better": False, **changes}


def a_bench(*rows):
    return {"machine": dict(MACHINE), "quick": False, "rows": list(rows)}


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bench, self.page = Path(folder.name) / "bench.json", Path(folder.name) / "page.md"
        self.page.write_text(TEXT)
        self.write(a_bench(a_row()))

    def write(self, bench):
        self.bench.write_text(bench if isinstance(bench, str) else json.dumps(bench))

    def run_script(self, *arguments):
        """@returns (exit status, lines of stderr)."""
        done = subprocess.run([sys.executable, SCRIPT, "--bench", self.bench, "--page", self.page, *arguments], capture_output=True, text=True)
        self.assertEqual(done.stdout, "")
        return done.returncode, done.stderr.splitlines()

    def refused(self, *words):
        """One line with the words, exit 2 with and without --check, and the page as before."""
        before = self.page.read_text() if self.page.exists() else None
        for arguments in ([], ["--check"]):
            status, errors = self.run_script(*arguments)
            self.assertEqual((status, len(errors)), (2, 1), errors)
            for word in words:
                self.assertIn(word, errors[0])
        self.assertEqual(self.page.read_text() if self.page.exists() else None, before)

    def test_the_page_is_written_then_current_and_text_by_hand_stays(self):
        self.assertEqual(self.run_script("--check")[0], 1)
        self.assertEqual(self.page.read_text(), TEXT, "--check has written")
        self.assertEqual(self.run_script(), (0, []))
        self.assertEqual(self.run_script("--check"), (0, []))
        page = self.page.read_text()
        self.assertIn("| ball | 18.6 | 660 | ns/point | 35.5 | 15 | 30 | met |\n", page)
        self.assertIn("Model 7, 4 cores (avx2), g++ 12.2.0, Release, revision abc123, 2026-02-03.", page)
        self.assertEqual(re.sub(r"(-->\n).*?(<!-- end)", r"\1\2", page, flags=re.S), re.sub(r"(-->\n).*?(<!-- end)", r"\1\2", TEXT, flags=re.S))

    def test_a_number_changed_by_hand_is_found_with_its_line(self):
        self.run_script()
        right = self.page.read_text()
        self.page.write_text(right.replace("| 35.5 |", "| 36.5 |"))
        status, errors = self.run_script("--check")
        self.assertEqual((status, len(errors)), (1, 1), errors)
        line = 1 + right[:right.index("| ball |")].count("\n")
        self.assertTrue(errors[0].startswith(f"{self.page}:{line}: "), errors)

    def test_a_file_of_another_run_is_found(self):
        self.run_script()
        self.write(a_bench(a_row(value=17.2)))
        self.assertEqual(self.run_script("--check")[0], 1)

    def test_a_missing_file_is_one_line_and_exit_2(self):
        self.bench.unlink()
        self.refused(str(self.bench), "No such file")
        self.write(a_bench(a_row()))
        self.page.unlink()
        self.refused(str(self.page), "No such file")

    def test_a_broken_file_is_one_line_and_exit_2(self):
        self.write("[1, 2")
        self.refused(str(self.bench), "not JSON")
        self.bench.write_bytes(b"\xff\xfe")
        self.refused("not UTF-8")
        for bench in ([a_row()], {"rows": [a_row()]}, {"machine": MACHINE}, "3"):
            self.write(bench)
            self.refused('must be an object with "machine" and "rows"')
        self.write(a_bench())
        self.refused("has no rows")
        self.write(a_bench(a_row()) | {"quick": True})
        self.refused("--quick")
        self.write(a_bench(a_row()) | {"machine": {key: value for key, value in MACHINE.items() if key != "cores"}})
        self.refused('"cores" is missing')
        self.write(a_bench(a_row(), a_row()))
        self.refused("two rows", "ball")

    def test_a_row_that_is_broken_is_named_by_its_key(self):
        for key, value in [("area", 3), ("name", ""), ("unit", None), ("name", "two\nlines"), ("value", "1"), ("baseline", 0), ("ratio", float("nan")),
                           ("ratio", float("inf")), ("value", True), ("ship", -1), ("aim", "30"), ("lower_is_better", 0)]:
            with self.subTest(key=key, value=value):
                self.write(a_bench(a_row(name="first"), a_row(**{key: value})))
                self.refused(f'rows[1]: "{key}" must be')
        for key in a_row():
            with self.subTest(lacks=key):
                self.write(a_bench({name: value for name, value in a_row().items() if name != key}))
                self.refused(f'rows[0]: "{key}" must be')
        self.write(a_bench(7))
        self.refused("rows[0]")

    def test_an_area_and_its_marks_belong_together(self):
        self.write(a_bench(a_row(), a_row(area="servo")))
        self.refused("<!-- bench:servo -->")
        self.write(a_bench(a_row(area="servo")))
        self.page.write_text(TEXT + "<!-- bench:servo -->\n<!-- end -->\n")
        self.refused('"contact"')
        self.write(a_bench(a_row()))
        self.page.write_text(TEXT + TEXT)
        self.refused("once")


class Cells(unittest.TestCase):
    def bars(self, **changes):
        return PAGE.cells(a_row(**changes))[-1]

    def test_bars_are_judged_on_the_unrounded_ratio(self):
        self.assertEqual(self.bars(ratio=30.0), "met")
        self.assertEqual(self.bars(ratio=29.999), "aim missed")
        self.assertEqual(self.bars(ratio=14.999), "**missed**")
        self.assertEqual(self.bars(ship=None, aim=None), "-")
        self.assertEqual(self.bars(aim=None), "met")

    def test_lower_is_better_is_marked_and_turns_the_bars(self):
        cost = dict(lower_is_better=True, ship=1.5, aim=1.1)
        self.assertEqual(self.bars(ratio=1.1, **cost), "met")
        self.assertEqual(self.bars(ratio=1.101, **cost), "aim missed")
        self.assertEqual(self.bars(ratio=1.501, **cost), "**missed**")
        self.assertEqual(PAGE.cells(a_row(ratio=1.3, **cost))[4], "1.3 ↓")
        self.assertEqual(PAGE.cells(a_row(ratio=1.3, **cost | {"aim": 1.015}))[6], "1.015", "a bar is not rounded to a neighbour")

    def test_an_absolute_row_has_no_baseline_and_its_mark_is_at_its_value(self):
        self.assertEqual(PAGE.cells(a_row(value=2.5, baseline=1.0, ratio=2.5, unit="s", lower_is_better=True, ship=10.0, aim=5.0)),
                         ("ball", "2.5 ↓", "-", "s", "-", "10", "5", "met"))

    def test_a_bar_in_a_name_does_not_split_the_table(self):
        self.assertEqual(PAGE.cells(a_row(name="a|b"))[0], "a\\|b")

    def test_figures_keep_three_digits_and_shares_their_difference_from_one(self):
        for value, text in [(18.61, "18.6"), (660.4, "660"), (55312.0, "55,300"), (1406.0, "1,410"), (0.006667, "0.00667"), (2.0, "2"), (120.0, "120"),
                            (0.9999, "0.9999"), (0.99973, "0.99973"), (0.9999999, "1"), (1.0, "1"), (999.7, "1000"), (0.5, "0.5"), (0.25, "0.25")]:
            self.assertEqual(PAGE.figure(value), text)


class Shipped(unittest.TestCase):
    def test_the_shipped_page_is_what_the_shipped_file_gives(self):
        done = subprocess.run([sys.executable, SCRIPT, "--check"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_any_figure_of_the_shipped_page_that_changes_is_found(self):
        page, bench = SHIPPED.read_text(), PAGE.read_bench(ROOT / "docs" / "bench.json")
        tables = [range(marks.start(3), marks.end(3)) for marks in PAGE.MARKS.finditer(page)]
        found = [at for table in tables for at in table if page[at].isdigit()]
        self.assertGreater(len(found), 500)
        for at in found[::37]:
            changed = page[:at] + str((int(page[at]) + 1) % 10) + page[at + 1:]
            self.assertNotEqual(changed, PAGE.filled(changed, bench))


if __name__ == "__main__":
    unittest.main()
