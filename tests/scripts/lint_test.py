"""lint: clang gets no flag of GCC alone, a changed header is checked by the .cpp beside it, and findings come once."""
import importlib.machinery
import importlib.util
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
LOADER = importlib.machinery.SourceFileLoader("lint", str(ROOT / "scripts" / "lint"))
LINT = importlib.util.module_from_spec(importlib.util.spec_from_loader("lint", LOADER))
LOADER.exec_module(LINT)


class Database(unittest.TestCase):
    def test_flags_of_gcc_alone_and_its_precompiled_header_are_dropped(self):
        words = "c++ -O2 -fpch-preprocess -Winvalid-pch -include /b/CMakeFiles/x.dir/cmake_pch.hxx -include other.h -Wno-restrict -c a.cpp"
        self.assertEqual(LINT.without_gcc(words.split()), "c++ -O2 -include other.h -c a.cpp".split())

    def test_generated_files_are_left_out_and_a_file_of_two_targets_comes_once(self):
        command = {"directory": "/r/build/dev", "command": "c++ -DTEXT='a b' -c x"}
        files = ["/r/core/b.cpp", "/r/core/a.cpp", "/r/build/dev/gl.c", "/elsewhere/c.cpp", "/r/core/b.cpp"]
        entries = LINT.clang_database([dict(command, file=file) for file in files], Path("/r"))
        self.assertEqual([entry["file"] for entry in entries], ["/r/core/a.cpp", "/r/core/b.cpp"])
        self.assertIn("-DTEXT=a b", entries[0]["arguments"])


class Choice(unittest.TestCase):
    def test_a_header_is_checked_by_the_source_beside_it_and_by_none_if_there_is_none(self):
        units = ["core/a.cpp", "core/b.cpp", "tests/core/a_test.cpp"]
        self.assertEqual(LINT.sources_of(["core/a.h", "core/alone.h", "tests/core/a_test.cpp"], units), ["core/a.cpp", "tests/core/a_test.cpp"])

    def test_the_lines_of_a_difference_are_the_new_ones(self):
        difference = ["--- a/x.h", "+++ b/x.h", "@@ -1,0 +2,3 @@ context", "+a", "@@ -9 +12 @@", "-b", "+c", "@@ -20,2 +23,0 @@",
                      "--- /dev/null", "+++ b/new.cpp", "@@ -0,0 +1,2 @@"]
        self.assertEqual(LINT.lines_of(difference), {"x.h": [[2, 4], [12, 12]], "new.cpp": [[1, 2]]})

    def test_a_limit_takes_the_program_before_its_tests_and_counts_the_rest(self):
        files = ["tests/a.cpp", "core/b.cpp", "app/c.cpp"]
        self.assertEqual(LINT.limited(files, 2), (["app/c.cpp", "core/b.cpp"], 1))
        self.assertEqual(LINT.limited(files, None), (["app/c.cpp", "core/b.cpp", "tests/a.cpp"], 0))


class Findings(unittest.TestCase):
    def test_each_finding_keeps_its_notes_and_a_kernel_of_highway_may_be_in_camel_case(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "kernel.cpp").write_text("namespace HWY_NAMESPACE {}\n")
            Path(folder, "plain.cpp").write_text("\n")
            first = "plain.cpp:1:2: error: bad [check]\n  code\nplain.cpp:1:2: note: why\n"
            named = ": error: invalid case style for function 'DoIt' [readability-identifier-naming]\n  code\n"
            output = first + "/usr/include/x.h:1:2: error: theirs [check]\n" + "kernel.cpp:3:1" + named + "plain.cpp:3:1" + named
            self.assertEqual(LINT.findings(output, Path(folder)), [first, "plain.cpp:3:1" + named])


@unittest.skipUnless(shutil.which("clang-tidy"), "clang-tidy is not installed")
class Names(unittest.TestCase):
    def findings(self, code):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "names.cpp")
            file.write_text(code)
            done = subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", str(file), "--", "-std=c++20"],
                                  capture_output=True, text=True, check=False)
            return [line.split("'")[1] for line in done.stdout.splitlines() if "invalid case style" in line]

    def test_names_in_the_style_pass(self):
        self.assertEqual(self.findings(
            "#define BH_TWICE(x) (2 * (x))\n"
            "enum class ErrorCode { bad_input };\n"
            "enum : unsigned { kHandLost = 1u };\n"
            "inline constexpr int kMaxShellPoints = 3;\n"
            "struct Push { double push_N = 0.0, damping_N_s_per_m = 0.0; };\n"
            "template <class Config, int kCount> class PointShell {\n public:\n  using value_type = int;\n"
            "  int bur_radius() const { return shell_; }\n private:\n  int shell_ = kCount;\n};\n"), [])

    def test_other_names_are_found(self):
        self.assertEqual(self.findings(
            "#define TWICE(x) (2 * (x))\n"
            "enum class error_code { BadInput };\n"
            "constexpr int max_points = 3;\n"
            "struct push { int Force = 0; };\n"
            "class Shell {\n  int shell = 0;\n public:\n  int Radius() const { return shell; }\n};\n"),
            ["TWICE", "error_code", "BadInput", "max_points", "push", "Force", "shell", "Radius"])


if __name__ == "__main__":
    unittest.main()
