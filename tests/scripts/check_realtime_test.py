"""check_realtime.py on small trees made here: a marked function that no case lists must be found, and a listed one that is not marked."""
import importlib.util
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("check_realtime", ROOT / "scripts" / "check_realtime.py")
check_realtime = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_realtime)

HEADER = """#define BH_REALTIME
struct Step {
  double operator()(bool on) noexcept BH_REALTIME;
  /// Not BH_REALTIME: create().
  void run(const Pose& a,
           Result& out) const noexcept BH_REALTIME override;
  void set(const Goal& goal) noexcept BH_REALTIME { goal_ = goal; }
};
"""


class Tree(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def faults(self, *listed):
        self.write(check_realtime.TEST, "covers(" + ", ".join(f'"{name}"' for name in listed) + ");\n")
        return check_realtime.check_tree(self.root)

    def test_all_listed_pass(self):
        self.write("core/a.h", HEADER)
        self.assertEqual(self.faults("core/a.h: operator()", "core/a.h: run", "core/a.h: set"), [])

    def test_each_that_is_not_listed_is_found_with_its_line(self):
        self.write("haptics/a.h", HEADER)
        first, second, third = self.faults()
        self.assertTrue(first.startswith("haptics/a.h:3: operator() "), first)
        self.assertTrue(second.startswith("haptics/a.h:6: run "), second)
        self.assertTrue(third.startswith("haptics/a.h:7: set "), third)

    def test_a_listed_function_that_is_not_marked_is_found(self):
        self.write("core/a.h", "void run() noexcept;\n")
        (fault,) = self.faults("core/a.h: run")
        self.assertIn("marks no function run", fault)

    def test_a_mark_behind_no_function_is_found(self):
        self.write("core/a.h", "int value BH_REALTIME;\n")
        (fault,) = self.faults()
        self.assertTrue(fault.startswith("core/a.h:1: "), fault)

    def test_the_lab_is_exempt(self):
        self.write("app/lab/a.h", HEADER)
        self.assertEqual(self.faults(), [])

    def test_this_tree_passes(self):
        self.assertEqual(check_realtime.check_tree(ROOT), [])


if __name__ == "__main__":
    unittest.main()
