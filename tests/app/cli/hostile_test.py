"""Inputs that another person made to do harm, or that went wrong: each is refused in one line with the right exit code, in bounded time
and memory.

Run by ctest with the program's path in BURRHOLE_PROGRAM. Nothing here draws: without OpenGL the pictures are refused all the same.
"""
import os
import pathlib
import re
import resource
import shutil
import sqlite3
import subprocess
import sys
import unittest

from program_support import lines, PROGRAM, QUICK, SCENES, WithFolder, without_display

MEMORY = 4 << 30     # [bytes] of address space, so that a fill of memory fails
SECONDS = 60         # so that a hang fails; every one of these answers at once
FREE_USER = 61000    # and the thousand above: nobody else's threads count towards their limit
CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]")
OFFSCREEN = ("--offscreen", "--no-pictures", "--quiet")


def limits(memory=MEMORY, threads=None):
    def apply():
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if threads is not None:
            resource.setrlimit(resource.RLIMIT_NPROC, (threads, threads))
            if os.geteuid() == 0:  # the limit does not hold for the administrator
                os.setgid(65534)
                os.setuid(FREE_USER + os.getpid() % 1000)
    return apply


class Hostile(WithFolder):
    def setUp(self):
        super().setUp()
        self.folder.chmod(0o777)
        self.quick().rename(self.folder / "quick.toml")

    def run_limited(self, *words, memory=MEMORY, threads=None, **options):
        try:
            done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, timeout=SECONDS, cwd=self.folder, stdin=subprocess.DEVNULL,
                                  env=without_display(), preexec_fn=limits(memory, threads), **options)
        except subprocess.TimeoutExpired:
            self.fail("hangs: " + " ".join(map(str, words))[:200])
        self.assertGreaterEqual(done.returncode, 0, f"died of signal {-done.returncode}: {' '.join(map(str, words))[:200]}")
        done.stdout, done.stderr = done.stdout.decode(errors="surrogateescape"), done.stderr.decode(errors="surrogateescape")
        return done

    def refused(self, *words, code=2, needles=(), **options):
        """One line of at most 2000 bytes and some, which holds all the needles and nothing that a terminal acts on."""
        done = self.run_limited(*words, **options)
        where = " ".join(map(str, words))[:200] + "\n" + done.stderr[:500]
        self.assertEqual(done.returncode, code, where)
        self.assertEqual(len(lines(done.stderr)), 1, where)
        self.assertLess(len(done.stderr.encode(errors="surrogateescape")), 2600, where)
        self.assertNotIn("internal error", done.stderr)
        self.assert_quiet(done)
        for needle in needles:
            self.assertIn(needle, done.stderr)
        return done

    def assert_quiet(self, done):
        for text in (done.stdout, done.stderr):
            found = CONTROLS.search(text)
            self.assertIsNone(found, found and f"a control character at {found.start()}: {text[max(0, found.start() - 40):found.end() + 40]!r}")

    def write(self, name, text):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def pin(self, name, replace=(), regions=1):
        text = (SCENES / "pin_2mm.toml").read_text()
        head, region = text[:text.index("[[region]]")], text[text.index("[[region]]"):]
        for old, new in replace:
            self.assertIn(old, region)
            region = region.replace(old, new)
        return self.write(name, head + "".join(region.replace("z_mm = 0", f"z_mm = {0.001 * n:g}") + "\n" for n in range(regions)))


class Files(Hostile):
    # (words before the path, name of the file, words after)
    READS = [(("check",), "x.toml", ()), (("drill",), "x.toml", OFFSCREEN), (("explain",), "x.toml", ()), (("tools",), "x.toml", ()),
             (("import",), "x.toml", ()), (("import",), "x.nii", ()), (("import",), "x.nii.gz", ()), (("import",), "x.nrrd", ()),
             (("import",), "x.mha", ()), (("import",), "x.vdb", ("--unit", "mm")), (("import",), "x.stl", ("--unit", "mm")),
             (("import",), "x", ("--unit", "mm")), (("import",), "x.dcm", ()),
             (("replay",), "x.sqlite", ()), (("session",), "x.sqlite", ()), (("export",), "x.vdb", ("-o", "o.nrrd")),
             (("drill", "quick.toml", *OFFSCREEN, "--restore"), "x.vdb", ()), (("drill", "quick.toml", *OFFSCREEN, "--inputs"), "x.toml", ()),
             (("check", "quick.toml", "--unset", "approach", "--set"), "approach.markups=x.mrk.json", ()),
             (("check", "quick.toml", "--unset", "approach", "--set"), "approach.markups=x.fcsv", ()),
             (("check", "quick.toml", "--set-tool"), "mesh.file=x.stl", ("--unset", "tool", "--set", 'tool.name="mesh.toml"'))]

    def names(self):
        return [(before, name, name.rsplit("=", 1)[-1], after) for before, name, after in self.READS]

    def test_a_pipe_is_refused_and_not_waited_for(self):
        self.write("mesh.toml", 'title = "m"\n[mesh]\nfile = "x.stl"\nunit_mm = 1\npitch_mm = 0.4\nerosion_factor = 0.1\n')
        for before, word, file, after in self.names()[:-1]:
            with self.subTest(" ".join((*before, word))):
                if not (self.folder / file).exists():
                    os.mkfifo(self.folder / file)
                self.refused(*before, word, *after, needles=[file])
        done = self.run_limited("tools", "mesh.toml")
        self.assertEqual((done.returncode, len(lines(done.stderr))), (2, 1), done.stderr)

    def test_a_device_without_end_is_refused(self):
        for before, word, file, after in self.names()[:-1]:
            with self.subTest(" ".join((*before, word))):
                if not (self.folder / file).exists():
                    (self.folder / file).symlink_to("/dev/zero")
                self.refused(*before, word, *after, needles=[file])
        done = self.refused("check", "/dev/zero", needles=["is a device"])
        self.assertIn("regular file", done.stderr)

    def test_process_substitution_is_refused_with_the_next_step(self):
        read_end, write_end = os.pipe()
        try:
            self.refused("check", f"/dev/fd/{read_end}", pass_fds=[read_end], needles=["is a pipe", "into a regular file first"])
        finally:
            os.close(read_end)
            os.close(write_end)

    def test_a_sparse_file_of_a_terabyte_is_refused(self):
        for before, word, file, after in self.names():
            if not file.endswith((".toml", ".json", ".fcsv", ".stl")) or "mesh.file" in word or before == ("import",) and file == "x.toml":
                continue
            with self.subTest(" ".join((*before, word))):
                path = self.write(file, "#\n")
                os.truncate(path, 1 << 40)
                self.refused(*before, word, *after, needles=["is larger than"])

    def test_a_folder_without_a_summary_and_results_that_are_pipes_are_refused(self):
        (self.folder / "run").mkdir()
        os.mkfifo(self.folder / "run" / "summary.json")
        self.refused("compare", "run", "run", needles=["is a pipe"])

    def test_pipes_and_devices_in_a_folder_of_a_scan_are_passed_over(self):
        folder = self.folder / "scan"
        folder.mkdir()
        os.mkfifo(folder / "a.dcm")
        os.mkfifo(folder / "b.nii")
        os.mkfifo(folder / "c.toml")
        (folder / "d.dcm").symlink_to("/dev/zero")
        for words in (("import", "scan"), ("render", "scan", "--image", "x.png"), ("check", "quick.toml", "--unset", "volume", "--set", "volume.source=scan")):
            with self.subTest(words[0]):
                self.refused(*words, needles=["scan"])
        self.write("pointer.toml", 'dims = [2, 2, 2]\nspacing_mm = [1, 1, 1]\ntype = "uint8"\ndata = "scan/a.dcm"\n')
        self.refused("import", "pointer.toml", needles=["a.dcm"])

    def test_a_byte_zero_is_refused_with_its_place(self):
        text = (self.folder / "quick.toml").read_bytes()
        self.write("zero.toml", text.replace(b'"Quick', b'"\0uick'))
        self.refused("check", "zero.toml", needles=["zero.toml:1:10: holds a byte 0"])
        self.write("name.toml", text.replace(b'"pin_2mm"', b'"pin_2mm.toml\\u0000x"'))
        self.refused("check", "name.toml", needles=["tool.name", "byte 0"])


class Names(Hostile):
    LONG = "n" * 5000

    def test_a_name_of_5000_characters_is_one_line(self):
        for words in (("check", self.LONG), ("drill", self.LONG + ".toml"), ("tools", self.LONG), ("tools", self.LONG + ".toml"),
                      ("import", self.LONG), ("import", self.LONG + ".nii"), ("import", self.LONG + ".vdb"), ("import", "a/" + self.LONG),
                      ("replay", self.LONG), ("session", self.LONG), ("compare", self.LONG, self.LONG), ("explain", self.LONG),
                      ("export", self.LONG, "-o", "x.nrrd"), ("export", "quick.toml", "-o", self.LONG + ".nrrd"),
                      ("render", "quick.toml", "--image", self.LONG + ".png"), ("scenes", "--copy", self.LONG),
                      ("drill", "quick.toml", *OFFSCREEN, "--out", self.LONG), ("drill", "quick.toml", *OFFSCREEN, "--restore", self.LONG),
                      ("drill", "quick.toml", *OFFSCREEN, "--inputs", self.LONG), ("drill", "quick.toml", *OFFSCREEN, "--out", self.LONG[:300])):
            with self.subTest(" ".join(words)[:60]):
                self.refused(*words)
        for key in ("volume.source", "tool.name", "title"):
            with self.subTest(key):
                self.refused("check", "quick.toml", "--set", f'{key}="{self.LONG}"', needles=[key])
        self.refused(self.LONG, needles=["unknown command"])
        self.refused("check", "quick.toml", "--" + self.LONG)

    def test_empty_names_are_refused(self):
        for words in (("check", ""), ("drill", "quick.toml", *OFFSCREEN, "--out", ""), ("drill", "quick.toml", *OFFSCREEN, "--restore", ""),
                      ("drill", "quick.toml", *OFFSCREEN, "--inputs", ""), ("render", "quick.toml", "--image", ""), ("import", ""),
                      ("replay", ""), ("session", ""), ("tools", ""), ("compare", "", ""), ("export", "", "-o", "x.nrrd"),
                      ("export", "quick.toml", "-o", ""), ("check", "quick.toml", "--set", 'volume.source=""'),
                      ("check", "quick.toml", "--set", 'tool.name=""'), ("drill", "quick.toml", *OFFSCREEN, "--video", "")):
            with self.subTest(" ".join(words)):
                self.refused(*words)
        self.refused("check", "quick.toml", "--set", 'volume.source=""', needles=["--set volume.source", "names no volume"])
        self.assertFalse((self.folder / "out").exists())

    def test_control_characters_of_the_input_are_escaped_in_what_is_printed(self):
        bad = "\x1b[2J\x1b]0;x\x07\r\n\u009b31m\u202e"
        toml = bad.encode("unicode_escape").decode().replace("\\x", "\\u00")
        for words in (("check", bad), ("import", bad + ".nii"), ("tools", bad), (bad,), ("drill", "quick.toml", "--" + bad), ("replay", bad),
                      ("compare", bad, bad), ("check", "quick.toml", "--set", f"title={bad}"), ("check", "quick.toml", "--set", bad + "=1"),
                      ("check", "quick.toml", "--unset", bad), ("drill", "quick.toml", *OFFSCREEN, "--expect", bad), ("scenes", "--copy", bad),
                      ("render", "quick.toml", "--size", bad), ("check", "quick.toml", "--set", f'contact.model="{toml}"')):
            with self.subTest(repr(words)):
                self.assertIn("\\x1b", self.refused(*words).stderr)
        text = (self.folder / "quick.toml").read_text()
        self.write("keys.toml", text + f'"{toml}" = 1\n')
        self.refused("check", "keys.toml", needles=["\\x1b[2J", "\\n"])
        self.write(f"{bad}.toml".replace("/", ""), text)
        done = self.run_limited("check", f"{bad}.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_quiet(done)
        self.pin("title.toml")
        title = (self.folder / "title.toml").read_text().replace('"Pin"', f'"{toml}"')
        self.write("title.toml", title)
        done = self.run_limited("tools", "title.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_quiet(done)

    def test_text_of_other_languages_stays(self):
        done = self.refused("check", "Schädel_頭蓋骨.toml", needles=["Schädel_頭蓋骨.toml"])
        self.assertNotIn("\\", done.stderr)
        self.refused("check", "quick.toml", "--set", f'contact.model="{"頭" * 500}"')  # cut, and still UTF-8
        self.run_limited("check", "quick.toml", "--set", f'contact.model="{"頭" * 500}"').stderr.encode()


class Shapes(Hostile):
    def test_deep_keys_and_values_are_refused_with_line_and_column(self):
        deep = ".".join(["a"] * 50000)
        for name, text, place in (("key", f"\n{deep} = 1\n", ":2:32: "), ("header", f"x = 1\n[{deep}]\n", ":2:33: "), ("rows", f"[[{deep}]]\n", ":1:"),
                                  ("lists", "a = " + "[" * 50000 + "]" * 50000, ":1:37: "), ("tables", "a = " + "{a=" * 50000, ":1:"),
                                  ("inline", "a = {" + deep + " = 1}", ":1:"), ("quoted", '"' + "k" * 50000 + '" = 1', ":1:"),
                                  ("bare", "k" * 50000 + " = 1", ":1:257: ")):
            with self.subTest(name):
                self.write(f"{name}.toml", text)
                for words in (("check", f"{name}.toml"), ("tools", f"{name}.toml"), ("drill", "quick.toml", *OFFSCREEN, "--inputs", f"{name}.toml")):
                    self.refused(*words, needles=[f"{name}.toml{place}"])
        for words in (("--set", f"{deep}=1"), ("--set", "title=" + "[" * 30000), ("--set", "title=" + "{a=" * 20000), ("--unset", deep[:60000]),
                      ("--set-tool", f"{deep[:60000]}=1")):
            with self.subTest(words[1][:30]):
                self.refused("check", "quick.toml", *words)

    def test_deep_json_is_refused(self):
        self.write("deep.mrk.json", "[" * 1_000_000)
        self.refused("check", "quick.toml", "--unset", "approach", "--set", "approach.markups=deep.mrk.json", needles=["nested deeper"])
        (self.folder / "run").mkdir()
        self.write("run/summary.json", '{"a":' * 300_000)
        self.refused("compare", "run", "run", needles=["is not a summary.json"])

    def test_results_of_other_shapes_are_refused_or_compared(self):
        (self.folder / "run").mkdir()
        deep = "[" * 100_000 + "]" * 100_000
        for text in ('{"schema": 1, "drilling": 5}', '{"schema": [], "drilling": [], "hash": 3, "provenance": {"hash": 1, "erosion_factors_per_rev": []}}',
                     '{"schema": 1, "drilling": {}, "title": {"a": []}, "flags": [[1], {}], "approach": 7, "duration_s": "x"}'):
            with self.subTest(text):
                self.write("run/summary.json", text)
                done = self.run_limited("compare", "run", "run")
                self.assertEqual((done.returncode, [line for line in lines(done.stderr) if "no curves" not in line]), (0, []), done.stderr)
        for text in ('{"schema": 1, "drilling": {}, "flags": ' + deep + "}", "[]", ""):
            with self.subTest(text[:60]):
                self.write("run/summary.json", text)
                self.refused("compare", "run", "run", needles=["is not a summary.json"])

    def test_results_with_many_keys_are_refused_before_they_are_parsed(self):
        # Each file is as large as one may be. A parser that searches each key among those before it takes hours for it.
        (self.folder / "run").mkdir()
        members = ",".join(f'"a{n:x}":1' for n in range(340_000))
        listed = ",".join(f'"a{n:x}=1"' for n in range(340_000))
        for text in ('{"schema":1,"drilling":{' + members + "}}", "{" + members + ',"schema":1,"drilling":{}}', '{"schema":1,"drilling":{},"a":[{' + members + "}]}",
                     '{"schema":1,"drilling":{},"provenance":{"overrides":[' + listed + "]}}"):
            with self.subTest(text[:60]):
                self.assertLess(len(text), 4 << 20)
                self.write("run/summary.json", text)
                self.refused("compare", "run", "run", needles=["is not a summary.json"])
        self.write("run/summary.json", '{"schema":1,"drilling":{},"provenance":{"overrides":[' + ",".join(f'"a.b{n}=1"' for n in range(9000)) + "]}}")
        done = self.run_limited("compare", "run", "run")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_names_that_are_not_utf_8_are_printed_and_written(self):
        name = b"\xff\xfe\x80.toml".decode(errors="surrogateescape")
        shutil.copy(self.folder / "quick.toml", self.folder / name)
        for words in (("check", name), ("explain", name, "--json"), ("drill", name, *OFFSCREEN, "--json", "--set", "duration_s=0.05", "--out", "o")):
            with self.subTest(" ".join(words[:1])):
                done = self.run_limited(*words)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assert_quiet(done)
                done.stdout.encode()  # UTF-8
        shutil.copy(self.folder / "pin_2mm.toml", self.folder / ("t" + name))
        self.assertEqual(self.run_limited("tools", "t" + name, "--json").returncode, 0)

    def test_many_errors_of_one_file_are_not_a_flood(self):
        text = (self.folder / "quick.toml").read_text()
        self.write("many.toml", "".join(f"unknown_{n} = 1\n" for n in range(20000)) + text)
        done = self.run_limited("check", "many.toml")
        self.assertEqual(done.returncode, 2)
        self.assertLessEqual(len(lines(done.stderr)), 51)
        self.assertIn("and ", lines(done.stderr)[-1])

    def test_many_regions_and_tiny_bits_are_refused(self):
        self.pin("many.toml", regions=5000)
        self.refused("tools", "many.toml", needles=["region has 5000 elements, at most 128 are read"])
        self.refused("check", "quick.toml", "--set", "tool.name=many.toml", needles=["region has 5000 elements"])
        self.pin("most.toml", regions=128)
        self.assertEqual(self.run_limited("tools", "most.toml").returncode, 0)
        for key in ("diameter_mm", "height_mm"):
            self.pin("tiny.toml", [(f"{key} = 2", f"{key} = 1e-9")])
            self.refused("tools", "tiny.toml", needles=[f"{key} = 1e-09", "must be in [0.01, "])
            self.refused("check", "quick.toml", "--set", "tool.name=tiny.toml", needles=[key])
        self.pin("cone.toml", [('"cylinder"', '"frustum"'), ("diameter_mm = 2", "top_diameter_mm = 1e-9\nbottom_diameter_mm = 0")])
        self.refused("tools", "cone.toml", needles=["top_diameter_mm"])


class Numbers(Hostile):
    def test_numbers_that_are_none_are_refused(self):
        for word in ("nan", "-nan", "inf", "-inf", "1e999", "0x1p3x", "", " ", "1 2", "1,5"):
            with self.subTest(word):
                self.refused("render", "quick.toml", "--depth-mm", word, "--image", "x.png", needles=["--depth-mm"])
                self.refused("drill", "quick.toml", *OFFSCREEN, "--text-scale", word, needles=["--text-scale"])
                self.refused("render", "quick.toml", "--workbench", word, needles=["--workbench"])
                self.refused("import", "quick.toml", "--spacing-mm", word or "x", needles=[])
        for key in ("duration_s", "hand.push_N", "volume.spacing_mm", "erosion.substep_voxels", "tool.spin_rpm"):
            for word in ("nan", "inf", "-inf", "1e400"):
                with self.subTest(f"{key}={word}"):
                    self.refused("check", "quick.toml", "--set", f"{key}={word}", needles=[key])

    def test_a_substep_that_would_not_end_is_refused(self):
        self.refused("drill", "quick.toml", *OFFSCREEN, "--set", "erosion.substep_voxels=1e-9", needles=["substep_voxels = 1e-09 must be in [0.01, 1]"])
        self.assertEqual(self.run_limited("check", "quick.toml", "--set", "erosion.substep_voxels=0.01").returncode, 0)


class Memory(Hostile):
    def test_a_picture_beyond_the_memory_is_refused_before_it_is_drawn(self):
        done = self.refused("render", "quick.toml", "--size", "8192x8192", "--image", "x.png", code=4, needles=["8192 x 8192", "GB of memory"])
        self.assertNotIn("rendering on", done.stderr)
        self.refused("drill", "quick.toml", "--offscreen", "--quiet", "--set", "display.size=[8192, 8192]", "--out", "o", code=4,
                     needles=["8192 x 8192"])
        self.refused("render", "quick.toml", "--size", "4096x4096", "--image", "x.png", "--set", "limits.memory_mb=600",
                     needles=["limits.memory_mb is exceeded"])
        self.assertFalse((self.folder / "x.png").exists())

    def test_memory_that_is_refused_is_one_line(self):
        seen = set()
        for megabytes in (150, 200, 250, 300, 400):
            with self.subTest(megabytes):
                done = self.run_limited("drill", "quick.toml", *OFFSCREEN, "--out", "o", memory=megabytes << 20)
                seen.add(done.returncode)
                if "error while loading shared libraries" in done.stderr or done.returncode == 0:
                    continue
                self.assertEqual(done.returncode, 4, done.stderr)
                self.assertEqual(len(lines(done.stderr)), 1, done.stderr)
                self.assertIn("memory", done.stderr)
        self.assertIn(0, seen, "the largest of them is enough")
        self.assertIn(4, seen, "none of them is refused")

    def test_threads_that_are_refused_are_one_line_or_not_needed(self):
        program = pathlib.Path(PROGRAM)
        if os.geteuid() == 0 and not all(parent.stat().st_mode & 0o001 for parent in program.parents):
            self.skipTest("another user cannot run the program")
        # A library of OpenVDB starts threads before main().
        least = next(n for n in range(1, 40) if subprocess.run([PROGRAM, "--version"], capture_output=True, env=without_display(),
                                                               preexec_fn=limits(threads=n)).returncode == 0)
        refused = 0
        for threads in range(least, least + 8):
            for mode in ((), ("--live",)):
                with self.subTest(threads=threads, mode=mode):
                    done = self.run_limited("drill", "quick.toml", *OFFSCREEN, *mode, "--out", f"o{threads}{len(mode)}", threads=threads)
                    self.assertIn(done.returncode, (0, 4), done.stderr)
                    if done.returncode == 0:
                        continue
                    refused += 1
                    self.assertEqual(len(lines(done.stderr)), 1, done.stderr)
                    self.assertIn("refused a thread", done.stderr)
        self.assertGreater(refused, 0)


class Sessions(Hostile):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        import tempfile
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-hostile-"))
        shutil.copy(SCENES / "pin_2mm.toml", cls.made)
        shutil.copy(QUICK, cls.made)
        subprocess.run([PROGRAM, "drill", cls.made / QUICK.name, *OFFSCREEN, "--set", "duration_s=0.3", "--out", cls.made], check=True,
                       env=without_display(), timeout=SECONDS)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.made, ignore_errors=True)
        super().tearDownClass()

    def session(self, *statements, writable_schema=()):
        path = self.folder / "s.sqlite"
        shutil.copy(self.made / "session.sqlite", path)
        database = sqlite3.connect(path)
        for statement in statements:
            database.execute(statement)
        for statement in writable_schema:
            database.execute("PRAGMA writable_schema = ON")
            database.execute(statement)
        database.commit()
        database.close()
        return path

    SPIN = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"

    def test_what_is_no_table_of_ours_is_refused_at_once(self):
        for statements in ((f"DROP TABLE blocks", f"CREATE VIEW blocks AS {self.SPIN} SELECT 0 AS stream, i AS first_row, 1 AS rows, x'00' AS data FROM n"),
                           (f"CREATE VIEW ticks AS {self.SPIN} SELECT i FROM n",),
                           ("DROP TABLE meta", f"CREATE VIEW meta AS {self.SPIN} SELECT 'seed' AS key, i AS value FROM n"),
                           ("CREATE TABLE more(x)",), ("CREATE INDEX slow ON blocks(first_row)",),
                           ("CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM events; END",),
                           ("CREATE VIRTUAL TABLE v USING fts5(x)",), ("CREATE VIRTUAL TABLE v USING rtree(id, a, b)",),
                           ("DROP TABLE hashes", "CREATE TABLE hashes(kind TEXT PRIMARY KEY, value TEXT AS (hex(zeroblob(100000000))))")):
            with self.subTest(statements[-1][:60]):
                try:
                    path = self.session(*statements)
                except sqlite3.OperationalError:
                    continue  # this SQLite was built without that module
                before = path.read_bytes()
                for command in ("replay", "session"):
                    self.refused(command, path, needles=["is not a session of burrhole"])
                self.assertEqual(path.read_bytes(), before)

    def test_a_view_in_a_session_of_the_first_schema_is_refused_too(self):
        path = self.session("DROP TABLE blocks", f"CREATE VIEW ticks AS {self.SPIN} SELECT i AS first_row, 1 AS rows FROM n", "PRAGMA user_version = 1")
        self.refused("replay", path, needles=["is not a session of burrhole"])

    def test_reading_leaves_the_file_and_its_folder_as_they_were(self):
        path = self.session()
        before, names = path.read_bytes(), sorted(os.listdir(self.folder))
        self.assertEqual(self.run_limited("session", path).returncode, 0)
        self.assertEqual(path.read_bytes(), before)
        self.assertEqual(sorted(os.listdir(self.folder)), names)

    def test_text_of_a_session_prints_as_text(self):
        bad = "\x1b[2J\nhash       voxels   forged"
        path = self.session("DELETE FROM hashes")
        database = sqlite3.connect(path)
        for key in ("program", "created", "cpu", "scene_path"):
            database.execute("UPDATE meta SET value = ? WHERE key = ?", (bad, key))
        database.execute("INSERT INTO hashes VALUES('voxels', ?)", (bad,))
        database.commit()
        database.close()
        done = self.run_limited("session", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_quiet(done)
        self.assertFalse([line for line in lines(done.stdout) if line == "hash       voxels   forged"])

    def test_a_replay_that_compared_nothing_says_so(self):
        path = self.session("DELETE FROM hashes")
        done = self.run_limited("replay", path, "--quiet")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("nothing was compared", done.stderr)
        self.assertIn("--allow-partial", done.stderr)
        done = self.run_limited("replay", path, "--quiet", "--allow-partial")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("nothing was compared", done.stderr)
        self.assertEqual(self.run_limited("replay", self.session(), "--quiet").returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
