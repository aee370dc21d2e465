"""Faults of the machine, one at a time, and what a program leaves after them: failed system calls by strace, kills, a second process.

A case is a command with the folder that it writes into. Before each trial the folder holds the files of an earlier, whole run. After the trial
each of them must be the old one, a whole new one, or gone where the run clears results before it starts; nothing else may be there.
"""
import collections
import contextlib
import hashlib
import json
import os
import pathlib
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import time

PATIENCE = 120  # [s] longer than any command takes here, under strace: more is a hang
ERRORS = {
    "write": ["ENOSPC", "EIO", "EINTR"],
    "pwrite64": ["ENOSPC", "EIO", "EINTR"],
    "writev": ["ENOSPC", "EIO"],
    "fsync": ["EIO", "ENOSPC"],
    "fdatasync": ["EIO"],
    "rename": ["EIO", "ENOSPC"],
    "openat": ["EIO", "EMFILE", "ENOSPC", "EINTR"],
    "ftruncate": ["EIO"],
    "close": ["EIO"],
}
OUTSIDE = {"mmap": ["ENOMEM"], "clone3": ["EAGAIN"]}  # calls that concern no file of the folder
# A run draws these where its hand gets that far: a live one that misses most of its ticks in a time that is not long does not.
PERHAPS = ("during.png", "breakthrough.png")
# The number counts the calls of each thread, so the message about one that failed may fail too.
MESSAGE = re.compile(r"write\(2, .*INJECTED")
CALL = re.compile(r"^(\d+) +(\w+)\((.*)$")


class Case:
    """@param command of a folder and of a number from 0 to 2: the arguments of the program, of three runs whose files differ by their marks.
    @param cleared: a run removes the files of an earlier one before it starts. @param draws: Mesa's software driver waits for ever for a
    thread that it did not get, so none is refused. @param other_program: gnuplot draws, which gives up at an interrupted call."""

    def __init__(self, name, command, cleared=False, draws=False, other_program=False):
        self.name, self.command, self.cleared, self.draws, self.other_program = name, command, cleared, draws, other_program


def mark_of(path):
    """@returns what says whose a file is: the title of the run, the size of a picture or of a bone, the number of triangles, or its hash."""
    data = path.read_bytes()
    if path.suffix == ".json":
        return json.loads(data)["title"]
    if path.suffix == ".html":
        return re.search(rb"<title>(.*?)</title>", data, re.DOTALL).group(1)
    if path.suffix == ".sqlite":
        with tempfile.TemporaryDirectory() as copy:
            shutil.copy(path, copy)
            with contextlib.closing(sqlite3.connect(os.path.join(copy, path.name))) as session:
                return re.search(r"title = .*", session.execute("SELECT value FROM meta WHERE key = 'scene'").fetchone()[0]).group(0)
    if path.suffix == ".vdb":
        at = data.index(b"burrhole_dims")
        return data[at:at + 64].partition(b"vec3i")[2][:16]
    # A drawing of a bit always has the same size, and the bone of a moment the same number of triangles in nearly all runs.
    if path.name == "bit.png" or path.name.startswith("bone_at_"):
        return hashlib.sha256(data).hexdigest()
    if path.suffix == ".stl":
        return data[80:84]
    return data[16:24]


def is_whole(path):
    """Whether a file is complete by its own format; of a picture, a sound or a page, by its end."""
    data = path.read_bytes()
    kind = path.suffix
    if kind == ".json":
        try:
            return isinstance(json.loads(data), dict)
        except ValueError:
            return False
    if kind == ".sqlite":
        return is_whole_session(path)
    if kind in (".sqlite-wal", ".sqlite-shm"):
        return True  # parts of a session, which is checked with them
    if kind == ".wav":
        return len(data) >= 44 and int.from_bytes(data[4:8], "little") + 8 == len(data)
    if kind == ".stl":
        return len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")
    if kind == ".vdb":
        return is_whole_vdb(path)
    ends = {".png": b"IEND\xaeB`\x82", ".html": b"</html>\n", ".svg": b"</svg>\n"}
    return data.endswith(ends[kind])


def is_whole_session(path):
    """Whether SQLite finds a session whole, with its log; in a copy, since SQLite makes files beside what it opens."""
    with tempfile.TemporaryDirectory() as copy:
        for part in path.parent.glob(path.name + "*"):
            shutil.copy(part, copy)
        try:
            with contextlib.closing(sqlite3.connect(os.path.join(copy, path.name))) as session:
                return session.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
        except sqlite3.DatabaseError:
            return False


def is_whole_vdb(path):
    """Whether OpenVDB reads all grids of a file; in a process of its own, which may be Debian's interpreter."""
    script = "import sys, pyopenvdb as vdb\ngrids, _ = vdb.readAll(sys.argv[1])\nassert len(grids) > 0 and all(g.activeVoxelCount() >= 0 for g in grids)"
    return subprocess.run(["/usr/bin/python3", "-c", script, str(path)], capture_output=True).returncode == 0


class Bench:
    """Trials of one program in a folder of their own."""

    def __init__(self, program, folder, environment):
        self.program, self.folder, self.environment = str(program), pathlib.Path(folder), environment
        self.out = self.folder / "out"
        self.old = self.folder / "old"
        self.trials = 0
        self.not_reached = 0  # injected calls that the trial's run did not make: threads do not make the same calls in each run
        self.failures = []
        self.raced = None  # the case whose marks are known

    def begin(self, case):
        """Runs the case once: its files are those of an earlier run from now on."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.rmtree(self.old, ignore_errors=True)
        self.out.mkdir()
        began = time.monotonic()
        done = self._run(case)
        if done.returncode != 0:
            raise RuntimeError(f"{case.name}: exit {done.returncode}: {done.stderr}")
        self.seconds = time.monotonic() - began
        shutil.copytree(self.out, self.old)
        for path in self.old.iterdir():
            if not is_whole(path):
                raise RuntimeError(f"{case.name}: {path.name} is not whole")

    def reset(self):
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.old, self.out)
        self.times = {p.name: p.stat().st_mtime_ns for p in self.out.iterdir()}  # those of the earlier run: copies keep them

    def _run(self, case, around=(), who=0):
        command = [*around, self.program, *map(str, case.command(self.out, who))]
        return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, env=self.environment)

    # ---- failed system calls ----

    def points(self, case):
        """System calls that touch the folder, and those of OUTSIDE: (call, its number in its thread, errno)."""
        self.reset()
        log = self.folder / "calls.txt"
        kinds = ",".join([*ERRORS, *OUTSIDE])
        self._run(case, ["strace", "-f", "-y", "-s", "0", "--seccomp-bpf", "-e", f"trace={kinds}", "-o", str(log)])
        seen = collections.Counter()
        out = []
        for line in log.read_text(errors="replace").splitlines():
            call = CALL.match(line)
            if not call:
                continue
            thread, kind, rest = call.groups()
            seen[thread, kind] += 1
            if kind == "clone3" and case.draws:
                continue
            if kind in OUTSIDE or str(self.out) in rest:
                for error in (ERRORS | OUTSIDE)[kind]:
                    out.append((kind, seen[thread, kind], error))
        return sorted(set(out))

    def fail_call(self, case, point):
        kind, number, error = point
        self.reset()
        label = f"{case.name}: {kind} number {number} fails with {error}"
        log = self.folder / "injected.txt"
        try:
            done = self._run(case, ["strace", "-f", "-q", "-s", "0", "-o", str(log), "--seccomp-bpf", "-e", f"trace={kind}", "-e",
                                    f"inject={kind}:error={error}:when={number}"])
        except subprocess.TimeoutExpired:
            return self._note(label, f"hangs for more than {PATIENCE} s")
        problem = self._left(case)
        injected = log.read_text(errors="replace")
        # oneTBB and LLVM end the process where they get no thread of their own; no file is damaged by that.
        ended = done.returncode < 0 or done.returncode > 128
        if ended and not (kind == "clone3" and done.returncode in (-signal.SIGABRT, 128 + signal.SIGABRT)):
            problem = problem or f"ends by signal: exit {done.returncode}"
        elif done.returncode == 0 and (missing := self._not_written()):
            problem = problem or f"exit 0 without {', '.join(missing)}: {done.stderr.strip()[-300:]}"
        elif error == "EINTR" and done.returncode != 0 and not case.other_program:
            problem = problem or f"an interrupted call ends the run: exit {done.returncode}: {done.stderr.strip()[-300:]}"
        elif "internal error" in done.stderr:
            problem = problem or f"calls itself broken: {done.stderr.strip()[-300:]}"
        elif done.returncode != 0 and not done.stderr.strip() and not MESSAGE.search(injected):
            problem = problem or f"exit {done.returncode} without a word"
        if problem is None and "INJECTED" not in injected:
            self.not_reached += 1
            return True
        return self._note(label, problem)

    def _not_written(self):
        """After exit 0 every file must be a new one."""
        now = {p.name: p.stat().st_mtime_ns for p in self.out.iterdir()}
        return sorted(name for name, time_ns in self.times.items()
                      if now.get(name, time_ns) == time_ns and (name in now or name not in PERHAPS))

    # ---- kills ----

    def kill(self, case, after):
        """SIGKILL after a time [s]."""
        self.reset()
        label = f"{case.name}: killed after {after * 1e3:.0f} ms"
        process = subprocess.Popen([self.program, *map(str, case.command(self.out, 0))], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   env=self.environment)
        time.sleep(after)
        process.send_signal(signal.SIGKILL)
        process.wait()
        problem = self._left(case, killed=True)
        # A killed process cannot remove its temporary files: the next one that writes the same does.
        if problem is None:
            again = self._run(case)
            problem = self._left(case) if again.returncode == 0 else f"the next run ends with exit {again.returncode}: {again.stderr.strip()[-300:]}"
        return self._note(label, problem)

    # ---- two processes ----

    def learn_marks(self, case):
        """Runs the case three times, each alone: what marks its files. The marks of a file must differ."""
        self.marks = []
        for who in range(3):
            shutil.rmtree(self.out)
            self.out.mkdir()
            done = self._run(case, who=who)
            if done.returncode != 0:
                raise RuntimeError(f"{case.name}, run {who}: exit {done.returncode}: {done.stderr}")
            marks = {p.name: mark_of(p) for p in self.out.iterdir()}
            if "before.png" in marks:  # all pictures of a run have one size
                marks |= {name: marks["before.png"] for name in PERHAPS}
            self.marks.append(marks)
        for name in self.marks[0]:
            if len({mark.get(name) for mark in self.marks}) != 3:
                raise RuntimeError(f"{case.name}: {name} does not show whose it is: {[mark.get(name) for mark in self.marks]}")
        self.raced = case

    def mixture(self, owners):
        """@returns what is wrong with the files unless all of them are of one run, of those numbered."""
        now = {p.name: mark_of(p) for p in self.out.iterdir() if p.name in self.marks[0]}
        whose = {name: [n for n, known in enumerate(self.marks) if known[name] == mark] for name, mark in now.items()}
        if any(now == {name: mark for name, mark in self.marks[n].items() if name in now or name not in PERHAPS} for n in owners):
            return None
        return f"the files are not those of one run of {owners}: {whose}"

    def race(self, case, offset):
        """Two runs that differ into one folder, the second `offset` [s] after the first. One at least succeeds, and all files are of one that does."""
        if self.raced is not case:
            self.learn_marks(case)
        self.reset()
        label = f"{case.name}: a second one after {offset * 1e3:.0f} ms"
        commands = [[self.program, *map(str, case.command(self.out, who))] for who in (1, 2)]
        first = subprocess.Popen(commands[0], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=self.environment)
        time.sleep(offset)
        second = subprocess.Popen(commands[1], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=self.environment)
        errors = [p.communicate(timeout=PATIENCE)[1] for p in (first, second)]
        codes = (first.returncode, second.returncode)
        problem = self._left(case)
        if 0 not in codes:
            problem = problem or f"neither succeeds: exit {codes}: {errors}"
        if any(code not in (0, 2) for code in codes):
            problem = problem or f"exit {codes}: {errors}"
        return self._note(label, problem or self.mixture([n for n, code in zip((1, 2), codes) if code == 0]))

    # ---- what is left ----

    def _left(self, case, killed=False):
        """@returns what is wrong with the files of the folder, or nothing."""
        known = {p.name for p in self.old.iterdir()}
        for path in sorted(self.out.iterdir()):
            if path.name not in known:
                if killed or (case.cleared and self._is_earlier(path)):
                    continue
                if case.cleared and path.name in PERHAPS:
                    if problem := self._beside_older(path):
                        return problem
                    continue
                return f"leaves {path.name}"
            old = (self.old / path.name).read_bytes()
            if path.read_bytes() != old and not is_whole(path):
                return f"{path.name} is neither the old one nor whole"
        missing = known - {p.name for p in self.out.iterdir()}
        if missing and not case.cleared:
            return f"lost {', '.join(sorted(missing))}"
        if case.cleared:
            return self._stale(case)
        return None

    def _is_earlier(self, path):
        """Whether a file is one of the earlier run that was moved aside, whole; or the folder for them, which could not be removed."""
        if path.name in (".burrhole-earlier", ".burrhole-dropped"):
            return all(p.read_bytes() == (self.old / p.name).read_bytes() for p in path.iterdir())
        name = path.name.replace(".earlier.", ".")
        return name != path.name and (self.old / name).exists() and path.read_bytes() == (self.old / name).read_bytes()

    def _beside_older(self, path):
        """@returns what is wrong with a picture that the earlier run did not draw: it is part of a new run, whose summary lies beside it."""
        if not is_whole(path):
            return f"{path.name} is not whole"
        summary = self.out / "summary.json"
        if not summary.exists() or summary.read_bytes() == (self.old / "summary.json").read_bytes():
            return f"leaves {path.name} without the results of its run"
        return None

    def _stale(self, case):
        """A summary says which session it belongs to: results of an earlier run beside a newer session would pass for its own."""
        summary, session = self.out / "summary.json", self.out / "session.sqlite"
        if not summary.exists() or not session.exists():
            return None
        if summary.read_bytes() == (self.old / "summary.json").read_bytes() and session.read_bytes() != (self.old / "session.sqlite").read_bytes():
            return "the summary of the earlier run lies beside another session"
        return None

    def _note(self, label, problem):
        self.trials += 1
        if problem:
            self.failures.append(f"{label}: {problem}")
        return problem is None


def chosen(points, count, seed):
    """At most `count` of the points, at least one of each call and error, by seed."""
    points = list(points)
    random.Random(seed).shuffle(points)
    first = {}
    for point in points:
        first.setdefault((point[0], point[2]), point)
    rest = [p for p in points if p not in set(first.values())]
    return list(first.values()) + rest[: max(0, count - len(first))]


def thinned(points, mappings, seed):
    """All points but those of mmap, of which at most so many are drawn: nearly all of them are made by the loader of libraries."""
    maps = [p for p in points if p[0] == "mmap"]
    random.Random(seed).shuffle(maps)
    return [p for p in points if p[0] != "mmap"] + sorted(maps[:mappings])


def missing_tool():
    """@returns why faults cannot be injected here, or nothing."""
    if shutil.which("strace") is None:
        return "strace is not installed"
    probe = subprocess.run(["strace", "-f", "-q", "-o", "/dev/null", "--seccomp-bpf", "-e", "trace=write", "true"], capture_output=True, text=True)
    return None if probe.returncode == 0 else "this machine allows no tracing"
