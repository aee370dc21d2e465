"""check_lengths.py on small texts: what is too long must be found, with its line; braces in comments, literals and initialisers are no
functions."""
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "check_lengths.py"
SPEC = importlib.util.spec_from_file_location("check_lengths", SCRIPT)
check_lengths = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_lengths)


def found(*lines):
    return check_lengths.cpp_functions("\n".join(lines) + "\n")


class Functions(unittest.TestCase):
    def test_functions_in_namespaces_and_classes_are_found_with_their_lines(self):
        self.assertEqual(
            found("namespace a {", "namespace {", "int f(int x) {", "  if (x > 0) {", "    return 1;", "  }", "  return 2;", "}", "}",
                  "class B {", " public:", "  void g() const noexcept {", "    h();", "  }", "};",
                  "template <class T>", "struct C {", "  T t() { return {}; }", "};", "}"),
            [("f", 3, 6), ("g", 12, 3), ("t", 18, 1)])

    def test_a_lambda_is_part_of_its_function(self):
        self.assertEqual(found("void f() {", "  const auto g = [](int x) {", "    return x;", "  };", "}"), [("f", 1, 5)])

    def test_members_initialised_in_braces_are_not_the_body(self):
        self.assertEqual(found("A::A(int x)", "    : a_{x},", "      b_(x) {", "  go();", "}", "int g() { return 1; }"),
                         [("A::A", 1, 5), ("g", 6, 1)])

    def test_tables_of_values_are_no_functions(self):
        self.assertEqual(found("constexpr Row kRows[] = {", "    {1, 2},", "};", "int f() {", "}"), [("f", 4, 2)])
        self.assertEqual(found("enum class E { a, b };", "int f() {", "}"), [("f", 2, 2)])

    def test_braces_in_comments_literals_and_directives_do_not_count(self):
        self.assertEqual(
            found("#define X(a) if (a) {", "int f() {  // }", "  g('}', \"}\\\"}\", R\"(})\"); /* } */", "  return 1'000;", "}",
                  "int h() {", "}"),
            [("f", 2, 4), ("h", 6, 2)])

    def test_a_test_case_is_a_function(self):
        self.assertEqual(found('TEST_CASE("a { b") {', "  CHECK(true);", "}"), [("TEST_CASE", 1, 3)])


class Limits(unittest.TestCase):
    def cpp(self, lines):
        return "int f() {\n" + "  g();\n" * (lines - 2) + "}\n"

    def test_a_function_may_have_eighty_lines_and_no_more(self):
        self.assertEqual(check_lengths.check_text("core/a.cpp", self.cpp(80)), [])
        self.assertEqual(check_lengths.check_text("core/a.cpp", "\n" + self.cpp(81)), ["core/a.cpp:2: f has 81 lines, at most 80"])

    def test_a_file_may_have_five_hundred_lines_and_no_more(self):
        self.assertEqual(check_lengths.check_text("core/a.h", "int a;\n" * 500), [])
        self.assertEqual(check_lengths.check_text("core/a.h", "int a;\n" * 501), ["core/a.h:1: 501 lines, at most 500"])

    def test_python_is_held_to_the_same(self):
        text = "def f():\n" + "    g()\n" * 80
        self.assertEqual(check_lengths.check_text("scripts/a.py", text), ["scripts/a.py:1: f has 81 lines, at most 80"])

    def test_an_exception_holds_for_its_function_alone_and_must_be_needed(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(check_lengths.EXCEPTIONS, {"core/a.cpp:f": "a reason"}, clear=True):
            root = Path(folder)
            (root / "core").mkdir()
            (root / "core" / "a.cpp").write_text(self.cpp(81))
            self.assertEqual(check_lengths.check_tree(root), [])
            (root / "core" / "b.cpp").write_text(self.cpp(81))
            self.assertEqual(check_lengths.check_tree(root), ["core/b.cpp:1: f has 81 lines, at most 80"])
            (root / "core" / "b.cpp").unlink()
            (root / "core" / "a.cpp").write_text(self.cpp(80))
            self.assertEqual(check_lengths.check_tree(root), ["scripts/check_lengths.py:1: the exception core/a.cpp:f is not needed"])


class ThisTree(unittest.TestCase):
    def test_nothing_here_is_too_long(self):
        done = subprocess.run([sys.executable, SCRIPT], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_functions_are_found_in_every_folder(self):
        root = SCRIPT.parents[1]
        for folder in ["app", "core", "haptics", "volumes", "tests"]:
            count = sum(len(check_lengths.cpp_functions(file.read_text(encoding="utf-8"))) for file in (root / folder).rglob("*.cpp"))
            self.assertGreater(count, 50, folder)


if __name__ == "__main__":
    unittest.main()
