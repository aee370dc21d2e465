"""check_words.py on small trees made here: each kind of finding must be found with its file and line; correct text must pass."""
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "check_words.py"
SPEC = importlib.util.spec_from_file_location("check_words", SCRIPT)
check_words = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_words)

GOOD_HEADER = """/// core/base/good.h: a correct header.
///   Frame  tool frame.   Units  SI.   Errors  bad_input.
#pragma once

struct Good {
  double radius = 0.0;                   ///< [m] > 0
  Vec3 force{0.0};                       ///< [N]
  std::vector<double> stiffness;         ///< [N/m]
  std::optional<double> time;            ///< [s] absent: never
  double share = 0.5;                    ///< [-] in [0, 1]
  double spacing_mm = 0.25, peak_N = 0;  // the names have the unit
  /// [1/rev] erosion factor, documented above the member.
  double factor = 0.0;
  int delay = 0;                         ///< [ticks]
  int repeats = 4, count = 0;            ///< counts
  std::uint64_t mask = 0;                ///< bits
  bool on = false;
  Pose pose;
};

class Owner {
 public:
  [[nodiscard]] Result<Good> make(double length, const Vec3& at) const;
  double length() const { return length_; }

 private:
  double length_ = 0.0;
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

    def findings(self):
        return check_words.check_tree(self.root)

    def the_finding(self, path, text):
        self.write(path, text)
        (finding,) = self.findings()
        return finding

    # Words.

    def test_a_correct_tree_passes(self):
        self.write("core/base/good.h", GOOD_HEADER)
        self.write("core/base/good.cpp", '// Looks up the nearest name.\nconst char* text = "must be > 0";\n')
        self.write("shaders/a.frag", "// The Pareto front is in front of the eye.\n")
        self.assertEqual(self.findings(), [])

    def test_each_banned_word_of_the_table_is_found(self):
        for words in ["is told", "tells", "foretold", "a look at", "the held pose", "has play", "the way out", "swallows energy",
                      "is owed", "given out", "a pull", "lets lie", "pushes out", "turning round", "the hollow direction", "it grips",
                      "a parcel", "sleeps", "is awake", "lame", "the front", "bearable", "by turns", "mended", "a fault", "feeling the give",
                      "nothing but bone", "so many ticks", "but for this", "lets go"]:
            with self.subTest(words=words):
                self.assertIn("core/base/a.cpp:2: ", self.the_finding("core/base/a.cpp", f"int a;\n// Here {words} of it.\n"))

    def test_words_are_found_in_comments_strings_shaders_and_documents(self):
        for path, text in [("app/view/a.cpp", 'auto a = "the user is told";\n'), ("app/view/a.cpp", "/* the user\nis told */\n"),
                           ("shaders/a.glsl", "float a;   // told\n")]:
            with self.subTest(path=path, text=text):
                self.assertIn('"told"', self.the_finding(path, text))
                (self.root / path).unlink()
        self.write("docs/a.md", "# Title\n\nThe user is told.\n")
        (finding,) = check_words.check_file(self.root, "docs/a.md")
        self.assertTrue(finding.startswith("docs/a.md:3: "), finding)

    def test_identifiers_and_code_are_not_words(self):
        self.write("core/base/a.cpp", 'int told = 0, fault_count = look(front);\nconst char* key = "front";\n// calls `look` and wait_fault()\n')
        self.assertEqual(self.findings(), [])

    def test_a_legitimate_use_is_allowed_only_in_its_context(self):
        self.write("core/base/a.cpp", "// A latched fault of a servo fault flag; a look-up; the cutting front; wakes up the thread.\n")
        self.assertEqual(self.findings(), [])
        self.assertIn('"fault"', self.the_finding("core/base/a.cpp", "// A fault of the file.\n"))

    def test_a_digit_separator_is_not_a_character(self):
        self.assertIn("a.cpp:2: ", self.the_finding("core/base/a.cpp", "int a = 1'000'000;\nint b;  // told\n"))

    # Units.

    def test_a_member_without_a_unit_is_found(self):
        for member in ["double radius = 0.0;  ///< of the ball", "float radius;", "Vec3 force{0.0};  // of the tool",
                       "std::vector<double> lengths;  ///< sorted", "std::optional<double> time;", "double low = 0.0, high = 1.0;",
                       "std::array<double, 4> flanks{1, 1, 1, 1};  ///< of a box", "int delay = 0;  ///< of a reading",
                       "double share = 1.0;  ///< [0.25, 1] of the width", "double limit = std::numeric_limits<double>::infinity();",
                       "double x;  ///< [why]"]:
            with self.subTest(member=member):
                header = f"/// a.h: a.\n///   Frame  tool.\n#pragma once\nstruct A {{\n  {member}\n}};\n"
                finding = self.the_finding("core/base/a.h", header)
                self.assertIn("core/base/a.h:5: ", finding)
                self.assertIn("no unit", finding)

    def test_private_members_locals_and_functions_need_no_unit(self):
        self.write("core/base/a.h", """/// a.h: a.
///   Frame  tool.
#pragma once
class A {
  double hidden = 0.0;
 public:
  double twice(double x) const {
    double y = 2.0 * x;
    return y;
  }
  struct Inner {
    double seen = 0.0;  ///< [m]
  };
 private:
  struct Secret {
    double value = 0.0;
  };
  double last_ = 0.0;
};
inline double half(double x) {
  double y = 0.5 * x;
  return y;
}
""")
        self.assertEqual(self.findings(), [])

    def test_a_public_member_after_private_ones_is_found(self):
        header = "/// a.h: a.\n#pragma once\nclass A {\n  double hidden_ = 0.0;\n\n public:\n  double seen = 0.0;\n};\n"
        self.assertIn("a.h:7: seen", self.the_finding("core/base/a.h", header))

    # Frame and errors.

    def test_a_header_with_vectors_must_name_its_frame(self):
        for declared in ["Vec3 at(double t);", "void move(const Pose& pose);", "Affine map();", "VoxelBox box();"]:
            with self.subTest(declared=declared):
                self.assertIn('no line "Frame"', self.the_finding("core/base/a.h", f"/// a.h: a.\n#pragma once\n{declared}\n"))

    def test_a_frame_named_below_the_head_does_not_count(self):
        header = "/// a.h: a.\n#pragma once\n/// World frame.\nVec3 at(double t);\n"
        self.assertIn("a.h:1: ", self.the_finding("core/base/a.h", header))

    def test_a_header_that_returns_errors_must_name_them(self):
        for declared in ["Result<int> read();", "Status check();"]:
            with self.subTest(declared=declared):
                self.assertIn("names the errors", self.the_finding("core/base/a.h", f"/// a.h: a.\n#pragma once\n{declared}\n"))
        self.write("core/base/a.h", "/// a.h: a.\n#pragma once\n/// @returns bad_input.\nStatus check();\n")
        self.assertEqual(self.findings(), [])

    # Paths and program.

    def test_the_program_exits_3_with_findings_and_0_without(self):
        self.write("core/base/a.cpp", "// told\n")
        done = subprocess.run([sys.executable, SCRIPT, self.root], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 3)
        self.assertIn("core/base/a.cpp:1: ", done.stderr)
        self.write("core/base/a.cpp", "// reported\n")
        done = subprocess.run([sys.executable, SCRIPT, self.root], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_repository_passes(self):
        root = Path(__file__).resolve().parents[2]
        self.assertEqual(check_words.check_tree(root), [])


if __name__ == "__main__":
    unittest.main()
