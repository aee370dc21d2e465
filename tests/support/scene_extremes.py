"""Every key of a scene with extreme values: of any key, and those at and beyond the ends of its range.

The keys, their ranges, choices and conditions come from `burrhole docs scene`, so a key that is added later is tried too. A trial checks a
small scene with one key changed; a scene that is accepted is drilled for a moment. Whatever the value, the program must end in bounded time and
memory, with an exit code of its own, with a line on each refusal, and with figures that are numbers.
"""
import itertools
import json
import os
import pathlib
import random
import re
import resource
import struct
import subprocess

SECONDS = 60        # [s] of one command, far more than any takes: more is a hang
MEMORY = 4 << 30    # [bytes] of address space: a value that asks for more must be refused in a line
LONGEST = 2600      # [bytes] of the line of a refusal, as in hostile_test.py
HEAD = re.compile(r"^## `(\[+)([\w.]+)\]+`$")
ROW = re.compile(r"^\| `(\w+)` \| (.+?) \| (.+?) \| (.+) \|$")
RANGE = re.compile(r"[\[(](-?[\d.e+-]+|-inf), (-?[\d.e+-]+|inf)[\])]")
# Of "only with A = a, or b with B = c", the first part alone.
ONLY = re.compile(r"\*only with ((?:`\w+` = (?:`[^`]+`(?:, )?)+(?: and )?)+)(?:or `[^`]+` with `\w+` = [^*]+)?\*")
NOT = re.compile(r"\*not with `(\w+)` = ((?:`[^`]+`(?:, )?)+)\*")
EXAMPLE = re.compile(r"\*only with `(?:\[([\w.]+)\] )?(\w+) = ([^`]+)`")
CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]")
LONG_TEXT = '"' + 5000 * "x" + '"'
ANY = ["0", "-1", "1", "-0.0", "1e-9", "-1e-9", "1e9", "-1e9", "5e-324", "1e308", "-1e308", "nan", "-nan", "inf", "-inf", "9223372036854775807",
       "-9223372036854775808", '""', '" "', '"\\u0000"', '"\\n"', '"../../x"', LONG_TEXT, "true", "[]", "{}", "[[]]", "1979-05-27", "[nan, nan, nan]",
       "[1e9, 1e9, 1e9]", "[1e-9, 1e-9, 1e-9]", "[0, 0, 0]", "[inf, 0, 0]", "[" + ", ".join(5000 * ["1"]) + "]"]
BASE = {
    "": {"duration_s": "0.2"},
    "volume": {"source": '"phantom:plate"', "spacing_mm": "0.4", "extent_mm": "[8, 8, 4]", "above_mm": "1", "thickness_mm": "2"},
    "tool": {"name": '"round_burr_3mm"', "spin_rpm": "20000"},
    "approach": {"entry_mm": "[0, 0, 0]"},
    "hand": {"standoff_mm": "0.02"},
    "contact": {}, "erosion": {}, "record": {},
}
SITE = '"parietal_left"'                # of the phantom of a head
HEADS = re.compile("skin|drape|inset")  # what is drawn of a whole head
PLATE_ONLY = ("extent_mm", "thickness_mm", "above_mm", "spacing_mm")  # dropped where the source is another


class Key:
    """@param table "" for the top of the file. @param condition text of the conditions of its table and row."""

    def __init__(self, table, listed, name, value, required, condition):
        self.table, self.listed, self.name, self.value, self.required, self.condition = table, listed, name, value, required, condition

    def __str__(self):
        return f"{self.table}.{self.name}".lstrip(".")

    def choices(self):
        return re.findall(r'`("[^"]*")`', self.value.split(";")[0])

    def filler(self):
        """@returns a value of a key that must be there beside another."""
        return "[0, 0, 1]" if "3 numbers" in self.value else "1"

    def values(self):
        """@returns values at the ends of the range, beyond them, every choice, and those of any key."""
        out = list(self.choices()) + (["false"] if self.value.startswith("true") else [])
        found = RANGE.search(self.value)
        ends = [end for end in found.groups() if "inf" not in end] if found else []
        count = re.match(r"(\d) numbers", self.value)
        for end in ends:
            near = [end] if "whole" in self.value else [end, repr(float(end) * 1.0000001), repr(float(end) * 0.9999999)]
            out += [f"[{', '.join(int(count[1]) * [one])}]" for one in near] if count else near
        return list(dict.fromkeys(out + ANY))


def keys_of(reference):
    """@returns the keys of the reference of scenes, in its order."""
    out, table, listed, condition = [], "", False, ""
    for line in reference.splitlines():
        if head := HEAD.match(line):
            table, listed, condition = head[2], head[1] == "[[", ""
        elif line.startswith("## "):
            table, listed, condition = "", False, ""
        elif row := ROW.match(line):
            out.append(Key(table, listed, row[1], row[2], "**required**" in row[3], condition + row[4]))
        elif line and not line.startswith("|"):
            condition += line
    return out


def write_scan(path):
    """A plate of bone of 1000 HU, 1 mm thick, in a scan of 4 x 4 x 4 mm: small, as it may be resampled to voxels of 0.01 mm."""
    header = "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 16 16 16\nspace directions: (0.25,0,0) (0,0.25,0) (0,0,0.25)\n" \
             "kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: (-2,-2,-2)\n\n"
    path.write_bytes(header.encode() + b"".join(struct.pack("<256h", *(256 * [1000 if 4 <= k < 8 else -1000])) for k in range(16)))


class Scenes:
    """Scenes in a folder, one for each trial."""

    def __init__(self, folder, reference):
        self.folder, self.keys = pathlib.Path(folder), keys_of(reference)
        write_scan(self.folder / "scan.nrrd")

    def key(self, table, name):
        return next((one for one in self.keys if (one.table, one.name) == (table, name)), None)

    def _choose(self, scene, table, name, allowed):
        """Sets a key so that a condition on it holds, with the conditions of that key."""
        if name == "source" and table.startswith("volume"):
            self._set_source(scene, allowed)
            return
        owner = self.key(table, name) or self.key(table.rsplit(".", 1)[0], name)
        if scene.get(owner.table, {}).get(name) in allowed:
            return
        scene.setdefault(owner.table, {})[name] = allowed[0]
        self._satisfy(scene, owner)

    def _set_source(self, scene, allowed):
        volume = scene["volume"]
        if volume["source"] in allowed:
            return
        source = '"scan.nrrd"' if allowed[0] == '"SCAN"' else min(allowed, key=lambda one: "head" in one)
        for name in PLATE_ONLY:
            volume.pop(name, None)
        volume["source"] = source
        if "head" in source:
            scene["approach"] = {"site": SITE}
        if "phantom" in source:
            volume["spacing_mm"] = "0.4"

    def _satisfy(self, scene, key):
        """Sets what the conditions of a key name."""
        for found in ONLY.finditer(key.condition):
            for name, listed in re.findall(r"`(\w+)` = ((?:`[^`]+`(?:, )?)+)", found[1]):
                self._choose(scene, key.table, name, [f'"{one}"' for one in re.findall(r"`([^`]+)`", listed)])
        for name, listed in NOT.findall(key.condition):
            refused = [f'"{one}"' for one in re.findall(r"`([^`]+)`", listed)]
            owner = self.key(key.table, name)
            if name == "source" or owner is None:
                continue
            now = scene.get(owner.table, {}).get(name)
            default = owner.choices()[0] if owner.choices() else None
            if (now or default) in refused:
                scene.setdefault(owner.table, {})[name] = next(one for one in owner.choices() if one not in refused)
        for one in self.keys:
            if one.required and not key.listed and one.table == key.table and one is not key and ONLY.findall(one.condition) == ONLY.findall(key.condition):
                scene.setdefault(one.table, {}).setdefault(one.name, one.filler())
        if key.table == "display" and HEADS.search(key.name):
            self._set_source(scene, ['"phantom:head"'])
        for table, name, value in EXAMPLE.findall(key.condition):
            if (table or key.table, name) != (key.table, key.name):
                scene.setdefault(table or key.table, {})[name] = value

    def write(self, key, value):
        """@returns the path of a scene in which one key has that value."""
        scene = {table: dict(rows) for table, rows in BASE.items()}
        if not key.listed:
            scene.setdefault(key.table, {})
        if "." in key.table:
            scene.setdefault(key.table.split(".")[0], {})
        self._satisfy(scene, key)
        listed = ""
        if key.listed:
            required = {one.name: one.values()[0] for one in self.keys if one.table == key.table}
            listed = f"[[{key.table}]]\n" + "".join(f"{name} = {text}\n" for name, text in (required | {key.name: value}).items())
        else:
            scene[key.table][key.name] = value
            for one in self.keys:  # what a choice requires
                if one.required and one.table == key.table and f"`{key.name}` = `{value}`".replace('"', "") in one.condition:
                    scene[key.table].setdefault(one.name, one.filler())
            if key.name in ("site", "markups"):
                scene["approach"].pop("entry_mm", None)
        top = "".join(f"{name} = {text}\n" for name, text in scene.pop("").items())
        path = self.folder / "scene.toml"
        path.write_text(top + "".join(f"[{table}]\n" + "".join(f"{name} = {text}\n" for name, text in rows.items()) for table, rows in scene.items()) + listed)
        return path


def _limits():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _no_number(word):
    raise ValueError(word)


class Bench:
    """Runs trials. `failures` holds a line for each that was not survived, `accepted` the number of scenes that were drilled."""

    def __init__(self, program, folder):
        self.program, self.folder = str(program), pathlib.Path(folder)
        self.trials = self.accepted = 0
        self.failures, self.slowest = [], (0.0, "")
        reference = subprocess.run([self.program, "docs", "scene"], capture_output=True, text=True, check=True).stdout
        self.scenes = Scenes(folder, reference)

    def all(self):
        """@returns all pairs of key and value."""
        return [(key, value) for key in self.scenes.keys for value in key.values()]

    def some(self, count, seed):
        """@returns some pairs, drawn by seed, of as many keys as there are pairs."""
        draw = random.Random(seed)
        keys = draw.sample(self.scenes.keys, len(self.scenes.keys))
        return [(key, draw.choice(key.values())) for key in itertools.islice(itertools.cycle(keys), count)]

    def run(self, *words):
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        return subprocess.run([self.program, *map(str, words)], capture_output=True, timeout=SECONDS, cwd=self.folder, stdin=subprocess.DEVNULL,
                              env=environment, preexec_fn=_limits)

    def trial(self, key, value):
        """Checks a scene, and drills it if it is accepted."""
        self.trials += 1
        name = f"{key} = {value if len(value) < 60 else value[:50] + '...'}"
        path = self.scenes.write(key, value)
        for command in (("check", path), ("drill", path, "--offscreen", "--no-pictures", "--quiet", "--force", "--out", self.folder / "out")):
            if command[0] == "drill":
                if str(key) == "duration_s":  # an hour is in its range
                    return
                self.accepted += 1
            try:
                done = self.run(*command)
            except subprocess.TimeoutExpired:
                self.failures.append(f"{name}: {command[0]} hangs for more than {SECONDS} s")
                return
            if why := self.judge(done):
                self.failures.append(f"{name}: {command[0]}: {why}")
                return
            if done.returncode != 0:
                if command[0] == "drill" and done.returncode == 2:
                    self.failures.append(f"{name}: check accepts it and drill does not: {done.stderr.decode(errors='replace').strip()[:200]}")
                return
        if why := self.figures():
            self.failures.append(f"{name}: drill: {why}")

    def judge(self, done):
        """@returns what is wrong with the end of a command; nothing if it is as promised."""
        text = (done.stdout + done.stderr).decode(errors="replace")
        if done.returncode not in (0, 2, 3, 4):
            return f"exit {done.returncode}: {text.strip()[-300:]}"
        if "internal error" in text:
            return f"an internal error: {text.strip()[-300:]}"
        if found := CONTROLS.search(text):
            return f"a control character in what is printed: {text[max(0, found.start() - 40):found.end()]!r}"
        lines = done.stderr.decode(errors="replace").splitlines()
        if done.returncode != 0 and not lines:
            return f"exit {done.returncode} without a line"
        if any(len(line.encode()) > LONGEST for line in lines):
            return f"a line of {max(map(len, lines))} characters"
        return None

    def figures(self):
        """@returns what is wrong with the results of a run."""
        try:
            json.loads((self.folder / "out" / "summary.json").read_text(), parse_constant=_no_number)
        except (OSError, ValueError) as error:
            return f"its summary: {error}"
        return None
