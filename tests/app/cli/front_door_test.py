"""What the built program says about itself: help, references, completion scripts and the manual page. Needs no drawing.

Run by ctest with the program's path in BURRHOLE_PROGRAM.
"""
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.path.abspath(os.environ["BURRHOLE_PROGRAM"])
SOURCE = pathlib.Path(__file__).resolve().parents[3]
TOOLS = sorted(path.stem for path in (SOURCE / "app" / "tools").glob("*.toml"))
SCENES = sorted(path.stem for path in (SOURCE / "app" / "scenes").glob("*.toml"))
SHELLS = ("bash", "zsh", "fish")


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120, **options)


@functools.cache
def printed(*arguments):
    result = run(*arguments)
    assert (result.returncode, result.stderr) == (0, ""), result
    return result.stdout


def listed_commands(*path):
    """Names under the headings below "Options:" of a help page: what a user sees, not what the walk says."""
    below = printed(*path, "--help").split("\nOptions:\n", 1)[1].split("\n\n", 1)[1].split("\nExample")[0]
    groups = re.findall(r"^[A-Z][\w ]+:\n((?:  \w.*\n)+)", below + "\n", re.MULTILINE)
    return [line.split()[0] for group in groups for line in group.splitlines()]


def every_path():
    """Every command and sub-command, by reading help pages."""
    paths, waiting = [], [(name,) for name in listed_commands()]
    while waiting:
        path = waiting.pop(0)
        paths.append(path)
        if " COMMAND\n" in printed(*path, "--help"):
            waiting += [(*path, name) for name in listed_commands(*path)]
    return paths


def options_of(path):
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", printed(*path, "--help"), re.MULTILINE))


class Help(unittest.TestCase):
    def test_the_first_lines_say_what_it_is_and_what_to_type(self):
        head = printed("--help").split("\nUsage:")[0]
        self.assertTrue(head.startswith("burrhole simulates the drilling of craniotomy burrholes"))
        self.assertEqual(len(re.findall(r"^  burrhole \w+", head, re.MULTILINE)), 3)

    def test_commands_stand_in_groups(self):
        text = printed("--help")
        for group in ("Drill and view", "Scenes and tools", "Measure", "Reference and shell"):
            self.assertIn(f"\n{group}:\n", text)
        self.assertNotIn("Subcommands", text, "a command without a group: use add_command()")
        self.assertGreaterEqual(len(listed_commands()), 10)

    def test_every_command_teaches_itself(self):
        for path in every_path():
            with self.subTest(path):
                text = printed(*path, "--help")
                summary, about, *_ = text.split("\n\n")
                self.assertNotIn("\n", summary)
                self.assertGreater(len(about), 20)
                self.assertRegex(text, rf"\n  .*burrhole {' '.join(path)}\b", "an example of the command itself")

    def test_examples_name_options_that_exist(self):
        for path in every_path():
            if " COMMAND\n" in printed(*path, "--help"):
                continue  # its examples are of commands below it
            for line in re.findall(rf"^  .*burrhole {' '.join(path)}\b(.*)$", printed(*path, "--help").split("\nExample")[1], re.MULTILINE):
                used = set(re.findall(r"(?<!\S)--[\w-]+", line))
                self.assertLessEqual(used, options_of(path), line)

    def test_lines_fit_a_wide_terminal(self):
        for path in [(), *every_path()]:
            for line in printed(*path, "--help").splitlines():
                self.assertLessEqual(len(line), 120, line)

    def test_a_wrong_sub_command_is_told_with_the_nearest(self):
        for words, near in ((("drll",), "drill"), (("docs", "scne"), "scene"), (("completion", "bsh"), "bash")):
            result = run(*words)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertEqual(len(result.stderr.splitlines()), 1)
            self.assertIn(f'did you mean "{near}"?', result.stderr)


class References(unittest.TestCase):
    def test_the_program_prints_the_pages_of_the_tree(self):
        for name in ("scene", "tool"):
            page = SOURCE / "docs" / f"{name}.md"
            self.assertEqual(printed("docs", name), page.read_text(), f"run: burrhole docs {name} > docs/{name}.md")

    def test_a_formatless_call_is_a_usage_fault(self):
        self.assertEqual(run("docs").returncode, 2)


class Bits(unittest.TestCase):
    def test_the_table_of_bits_is_what_the_program_predicts(self):
        """Figures as printed, to the two digits of the table."""
        page = (SOURCE / "docs" / "bits.md").read_text()
        table = {row[0]: row[1:] for row in re.findall(r"^\| `(\w+)` \| (.+?) \| (\d+) \| (\S+?)(?: mm3/s)? \| (\S+?)(?: mm3/s)? \|$", page, re.M)}
        self.assertEqual(sorted(table), TOOLS)
        for bit in json.loads(printed("tools", "--json")):
            sheet = printed("tools", bit["name"])
            rates = [re.search(rf"^  {way} +(unknown|[\d.]+ mm3/s)", sheet, re.M).group(1) for way in ("plunging", "sideways")]
            printed_rates = tuple("unknown" if rate == "unknown" else f"{float(rate.split()[0]):.2g}" if float(rate.split()[0]) > 0.0 else "-" for rate in rates)
            with self.subTest(bit=bit["name"]):
                self.assertEqual(table[bit["name"]], (bit["title"], str(bit["haptic_points"]), *printed_rates))


class Completion(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="burrhole-front-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "mine.toml").touch()
        (self.folder / "notes.txt").touch()
        (self.folder / "sub folder").mkdir()

    def complete(self, *words, script=None):
        """What bash offers for the last word, by the completion function itself."""
        script = printed("completion", "bash") if script is None else script
        call = script + '\nCOMP_WORDS=("$@")\nCOMP_CWORD=$(($# - 1))\n_burrhole\n((${#COMPREPLY[@]} == 0)) || printf "%s\\n" "${COMPREPLY[@]}"\n'
        result = subprocess.run(["bash", "--norc", "-u", "-c", call, "bash", "burrhole", *words], capture_output=True, text=True, cwd=self.folder, timeout=30)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout.splitlines()

    def test_commands(self):
        self.assertEqual(sorted(self.complete("")), sorted(listed_commands()))
        self.assertEqual(self.complete("dri"), ["drill"])
        self.assertEqual(self.complete("zzz"), [])
        self.assertEqual(self.complete("docs", ""), ["scene", "tool", "raw", "outcome"])
        self.assertEqual(self.complete("cost", "con"), ["contact"])

    def test_options_are_those_of_each_help_page(self):
        for path in every_path():
            with self.subTest(path):
                self.assertEqual({o for o in self.complete(*path, "-") if o.startswith("--")}, options_of(path))
        self.assertEqual(self.complete("drill", "parietal", "--qui"), ["--quiet"])

    def test_shipped_names_where_they_fit(self):
        self.assertEqual(self.complete("tools", "perf"), [name for name in TOOLS if name.startswith("perf")])
        self.assertLessEqual(set(TOOLS), set(self.complete("tools", "")))
        for command in ("drill", "check", "explain", "render"):
            self.assertLessEqual({*SCENES, "mine.toml", "sub folder"}, set(self.complete(command, "")), command)
        self.assertNotIn("notes.txt", self.complete("drill", ""), "no scene")
        self.assertEqual(self.complete("tools", "parie"), [], "a scene is no tool")

    def test_values_of_options(self):
        self.assertEqual(self.complete("drill", "parietal", "--out", ""), ["sub folder"])
        self.assertEqual(self.complete("drill", "--out", "="), ["sub folder"])
        self.assertEqual(self.complete("drill", "--out", "=", "su"), ["sub folder"])
        self.assertEqual(sorted(self.complete("render", "x", "--restore", "")), ["mine.toml", "notes.txt", "sub folder"])
        self.assertEqual(self.complete("drill", "x", "--set", ""), [])
        # The value is no argument: the scene is still to come. bash splits KEY=VALUE at the sign.
        self.assertIn("parietal", self.complete("drill", "--set", "tool.spin_rpm", "=", "800", "par"))
        self.assertEqual(self.complete("drill", "--set", "tool.spin_rpm", "=", "8"), [])
        self.assertIn("parietal", self.complete("drill", "--out", "here", "par"))

    def test_one_argument_is_enough(self):
        self.assertEqual(self.complete("drill", "parietal", "par"), [])
        self.assertIn("--out", self.complete("drill", "parietal", ""))

    def test_sabotage_a_script_without_a_command_is_found(self):
        script = printed("completion", "bash")
        broken = script.replace("commands='drill ", "commands='", 1)
        self.assertNotEqual(broken, script)
        self.assertNotEqual(sorted(self.complete("", script=broken)), sorted(listed_commands()))

    def test_scripts_are_sound_where_the_shell_is_here(self):
        checks = {"bash": ["bash", "-n"], "zsh": ["zsh", "-n"], "fish": ["fish", "--no-execute"]}
        for shell in SHELLS:
            file = self.folder / shell
            file.write_text(printed("completion", shell))
            if shutil.which(shell):
                result = subprocess.run([*checks[shell], file], capture_output=True, text=True, timeout=30)
                self.assertEqual((result.returncode, result.stderr), (0, ""), shell)
        if shutil.which("shellcheck"):
            result = subprocess.run(["shellcheck", self.folder / "bash"], capture_output=True, text=True, timeout=60)
            self.assertEqual(result.returncode, 0, result.stdout)

    def test_zsh_and_fish_hold_every_command_and_option(self):
        zsh, fish = printed("completion", "zsh"), printed("completion", "fish")
        self.assertTrue(zsh.startswith("#compdef burrhole\n"))
        for path in every_path():
            with self.subTest(path):
                body = re.search(rf"^_burrhole_{'_'.join(path)}\(\) {{\n(.*?)^}}", zsh, re.MULTILINE | re.DOTALL)
                self.assertIsNotNone(body)
                self.assertEqual(set(re.findall(r"'\*(--[\w-]+)\[", body[1])), options_of(path))
                at = [line for line in fish.splitlines() if f"'__burrhole_at {' '.join(path)}'" in line]
                self.assertEqual({f"--{name}" for line in at for name in re.findall(r" -l ([\w-]+)", line)}, options_of(path))
        functions = re.findall(r"^(\w+)\(\) {", zsh, re.MULTILINE)
        self.assertEqual(len(functions), len(set(functions)), "a command's function must not hide another")
        for name in [*TOOLS, *SCENES]:
            self.assertIn(name, zsh)
            self.assertIn(name, fish)
        # Quotes that a text opens it closes: an apostrophe in a description must not end its word.
        for line in fish.splitlines():
            self.assertEqual(len(re.findall(r"(?<!\\)'", line)) % 2, 0, line)


class Manual(unittest.TestCase):
    def setUp(self):
        self.page = printed("man")

    def test_it_has_its_sections_in_order(self):
        sections = re.findall(r"^\.SH (.+)$", self.page, re.MULTILINE)
        self.assertEqual(sections, ["NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "EXIT STATUS", "FILES", "ENVIRONMENT", "EXAMPLES", "SEE ALSO"])
        for needle in ("BURRHOLE_DATA", "\\-\\-set tool.spin_rpm=800"):
            self.assertIn(needle, self.page)
        for code in (0, 1, 2, 3, 4, 130):
            self.assertIn(f"\n.B {code}\n", self.page)

    def test_every_command_and_option_is_in_it(self):
        commands = self.page.split(".SH COMMANDS\n")[1].split("\n.SH ")[0]
        sections = dict(re.findall(r'\.SS "burrhole (.+)"\n((?:(?!\.SS ).*\n?)*)', commands))
        self.assertEqual(sorted(sections), sorted(" ".join(path) for path in every_path()))
        for path in every_path():
            shown = {option.replace("\\-", "-") for option in re.findall(r"\\fB(\\-\\-[^\\]+(?:\\-[^\\]+)*)\\fR", sections[" ".join(path)])}
            self.assertEqual(shown, options_of(path) - {"--help"}, path)

    def test_groff_has_nothing_to_say_against_it(self):
        if not shutil.which("groff"):
            self.skipTest("no groff here")
        result = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8"], input=self.page, capture_output=True, text=True, timeout=60)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        broken = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8"], input=self.page + ".no_such_request\n", capture_output=True, text=True, timeout=60)
        self.assertNotEqual(broken.stderr, "", "sabotage: the check must see a fault")

    def test_lines_start_no_request_by_accident(self):
        known = {".TH", ".SH", ".SS", ".TP", ".PP", ".EX", ".EE", ".B", ".I", ".br", '.\\"'}
        for line in self.page.splitlines():
            if line.startswith((".", "'")):
                self.assertIn(line.split()[0], known, line)

    def test_it_says_the_same_twice(self):
        self.assertEqual(run("man").stdout, self.page)


if __name__ == "__main__":
    unittest.main(verbosity=2)
