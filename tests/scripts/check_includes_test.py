"""check_includes.py on small trees made here: an include against an arrow must be found, with its file and line; a lawful one must not."""
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "check_includes.py"
SPEC = importlib.util.spec_from_file_location("check_includes", SCRIPT)
check_includes = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_includes)


class Tree(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)

    def write(self, path, *lines):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def faults(self):
        return check_includes.check_tree(self.root)

    def test_lawful_includes_pass(self):
        self.write("core/contact/a.cpp", "#include <vector>", '#include "core/contact/a.h"', '#include "core/base/result.h"')
        self.write("app/render/r.cpp", "#include <glad/gl.h>", '#include "app/view/view.h"')
        self.write("app/cli/drill.cpp", '#include "app/run/run.h"', "#include <CLI/CLI.hpp>")
        self.assertEqual(self.faults(), [])

    def test_a_library_that_is_named_without_a_header_is_found_with_file_and_line(self):
        self.write("core/base/a.h", "#include <fmt/format.h>")
        self.write("core/base/by_header.cpp", '#include "core/base/a.h"', "void f() { fmt::print(1); }")
        self.write("core/base/comment.cpp", "// glm::dot is not called")
        self.assertEqual(self.faults(), [])
        self.write("core/base/b.cpp", "#include <vector>", "void f() { fmt::print(1); }")
        (fault,) = self.faults()
        self.assertTrue(fault.startswith("core/base/b.cpp:2: "), fault)
        self.assertIn("fmt/", fault)

    def test_an_include_against_an_arrow_is_found_with_file_and_line(self):
        self.write("core/base/a.h", "#pragma once", "", '#include "core/voxel/bone_model.h"')
        (fault,) = self.faults()
        self.assertTrue(fault.startswith("core/base/a.h:3: "), fault)
        self.assertIn("core/voxel", fault)

    def test_each_forbidden_arrow_of_the_design_is_found(self):
        for path, included in [
            ("core/voxel/a.cpp", "core/tool/tool.h"),
            ("core/drill/a.cpp", "core/measure/approach.h"),
            ("core/contact/a.cpp", "core/mesh/ball_mesh.h"),
            ("core/contact/a.cpp", "haptics/servo/step.h"),
            ("haptics/a.cpp", "volumes/phantom/p.h"),
            ("volumes/a.cpp", "app/scene/scene.h"),
            ("app/run/a.cpp", "app/render/r.h"),
            ("app/render/a.cpp", "app/scene/scene.h"),
            ("app/view/view.h", "app/scene/scene.h"),
            ("app/scene/a.cpp", "app/run/simulation.h"),
            ("app/stage/a.cpp", "app/job/summary.h"),
            ("app/lab/oracle/a.cpp", "app/lab/frontier.h"),
            ("core/contact/a.cpp", "core/measure/approach.h"),
            ("app/report/a.cpp", "app/session/session.h"),
            ("app/lab/a.cpp", "app/cli/c.h"),
        ]:
            with self.subTest(path=path, included=included):
                self.write(path, f'#include "{included}"')
                self.assertEqual(len(self.faults()), 1)
                self.write(path, "")

    def test_a_library_outside_its_wrapper_is_found(self):
        for path, included in [
            ("app/run/a.cpp", "GL/gl.h"),
            ("app/cli/a.cpp", "sqlite3.h"),
            ("core/tool/a.cpp", "toml++/toml.h"),
            ("app/report/a.cpp", "png.h"),
            ("core/drill/a.cpp", "openvdb/openvdb.h"),
            ("core/drill/a.cpp", "thread"),
        ]:
            with self.subTest(path=path, included=included):
                self.write(path, f"#include <{included}>")
                self.assertEqual(len(self.faults()), 1)
                self.write(path, "")

    def test_a_seventh_file_with_openvdb_is_found(self):
        for number in range(6):
            self.write(f"volumes/read/v{number}.cpp", "#include <openvdb/openvdb.h>")
        self.assertEqual(self.faults(), [])
        self.write("volumes/read/v6.cpp", "#include <openvdb/openvdb.h>")
        self.assertEqual(len(self.faults()), 1)

    def test_a_header_named_from_its_own_folder_is_found(self):
        self.write("core/base/b.h", "#pragma once")
        self.write("core/base/b.cpp", '#include "b.h"')
        self.assertEqual(len(self.faults()), 1)

    def test_a_file_in_no_box_is_found(self):
        self.write("core/utils/a.cpp", '#include "core/base/result.h"')
        self.assertEqual(len(self.faults()), 1)

    def test_a_rule_that_names_nothing_is_found(self):
        root = SCRIPT.parents[1]
        self.assertEqual(check_includes.dead_rules(root), [])
        with mock.patch.dict(check_includes.SEES, {"core/gone": []}):
            self.assertEqual(len(check_includes.dead_rules(root)), 1)
        for rule in [("gone/", "Gone", ["core/base/"]), ("zlib", "zlib", ["core/gone/"])]:
            with mock.patch.object(check_includes, "WRAPPED", [rule]):
                self.assertEqual(len(check_includes.dead_rules(root)), 1)

    def test_the_program_exits_3_and_prints_the_fault(self):
        self.write("core/base/a.h", '#include "app/view/view.h"')
        run = subprocess.run([sys.executable, SCRIPT, self.root], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 3)
        self.assertIn("core/base/a.h:1:", run.stderr)


if __name__ == "__main__":
    unittest.main()
