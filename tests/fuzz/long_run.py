#!/usr/bin/env python3
"""Runs the fuzzers in turn, in slices of time, until it is stopped: who found new code in its last slices gets more of them.

  long_run.py PROGRAMS FOLDER COUNTS [--hours H] [--slice S] [--jobs N]

PROGRAMS holds fuzz_NAME; FOLDER holds seeds/NAME, corpus/NAME and found/NAME, into which what reached new code goes. COUNTS is a small JSON
file, fuzzer to number of inputs that were run, of all calls together: the inputs that a slice starts from are not counted. SIGINT or
SIGTERM, or the end of the hours, ends the slices and writes the last counts. Exit 1 if a fuzzer found a fault; it gets no more slices.
"""
import argparse
import concurrent.futures
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

LEAST_SHARE = 0.02  # of the time, to each fuzzer that finds nothing new
FORGET = 0.5        # of what was known of a fuzzer's finds, at each slice


class Fuzzer:
    """One fuzzer: its time, and how many inputs with new code it finds in a second."""

    def __init__(self, name):
        self.name, self.seconds, self.finds, self.broken = name, 0.0, 1.0, False

    def after(self, seconds, new):
        self.seconds += seconds
        self.finds = FORGET * self.finds + (1.0 - FORGET) * new / max(seconds, 1.0)


def weights(fuzzers):
    """@returns the share of the time that each should have, by name; they sum up to 1."""
    total = sum(f.finds for f in fuzzers) or 1.0
    rest = 1.0 - LEAST_SHARE * len(fuzzers)
    return {f.name: LEAST_SHARE + rest * f.finds / total for f in fuzzers}


def next_of(fuzzers, running):
    """@returns the fuzzer that is furthest behind its share, of those that do not run; None if there is none."""
    share = weights(fuzzers)
    waiting = [f for f in fuzzers if f.name not in running and not f.broken]
    return min(waiting, key=lambda f: (f.seconds / share[f.name], f.name), default=None)


def read_log(text):
    """@returns (inputs that were run beyond those it started from, new ones kept) of libFuzzer's log; the first is a lower bound if it failed."""
    run = [int(n) for n in re.findall(r"^stat::number_of_executed_units: *(\d+)", text, re.MULTILINE)]
    seen = [int(n) for n in re.findall(r"^#(\d+)", text, re.MULTILINE)]
    loaded = re.search(r"^#(\d+)\s+INITED", text, re.MULTILINE)
    if loaded is None:
        return 0, 0
    total = run[-1] if run else max(seen)
    new = re.findall(r"^stat::new_units_added: *(\d+)", text, re.MULTILINE)
    return total - int(loaded.group(1)), int(new[-1]) if new else 0


def add_to(counts, name, inputs):
    """Adds to the file, which another call may not write at the same time."""
    known = json.loads(counts.read_text()) if counts.exists() else {}
    known[name] = known.get(name, 0) + inputs
    part = counts.with_suffix(".part")
    part.write_text(json.dumps(dict(sorted(known.items())), indent=1) + "\n")
    part.replace(counts)


def run_slice(programs, folder, fuzzer, seconds, processes):
    """@returns whether it ended without a fault, and its log."""
    found, words = folder / "found" / fuzzer.name, folder / "seeds" / f"{fuzzer.name}.dict"
    found.mkdir(parents=True, exist_ok=True)
    command = [programs / f"fuzz_{fuzzer.name}", f"-max_total_time={seconds}", "-timeout=25", "-rss_limit_mb=1024", "-max_len=65536", "-reload=0", "-print_final_stats=1",
               f"-artifact_prefix={folder}/found/{fuzzer.name}-", *([f"-dict={words}"] if words.exists() else []), found,
               folder / "corpus" / fuzzer.name, folder / "seeds" / fuzzer.name]
    log = folder / "found" / f"{fuzzer.name}.log"
    with open(log, "w", encoding="utf-8") as out:
        process = subprocess.Popen(list(map(str, command)), stdout=out, stderr=subprocess.STDOUT, start_new_session=True)
        processes[fuzzer.name] = process
        code = process.wait()
        del processes[fuzzer.name]
    return code == 0, log.read_text(encoding="utf-8", errors="replace")


class LongRun:
    def __init__(self, asked, fuzzers):
        self.asked, self.fuzzers = asked, fuzzers
        self.stop, self.lock, self.processes = threading.Event(), threading.Lock(), {}
        self.running = set()
        self.end = time.monotonic() + 3600 * asked.hours if asked.hours else float("inf")

    def end_all(self, *_):
        """Of SIGINT and SIGTERM: libFuzzer ends with its figures at SIGINT."""
        self.stop.set()
        for process in list(self.processes.values()):
            process.send_signal(signal.SIGINT)

    def work(self):
        while not self.stop.is_set():
            seconds = min(self.asked.slice, int(self.end - time.monotonic())) if self.end < float("inf") else self.asked.slice
            with self.lock:
                fuzzer = next_of(self.fuzzers, self.running) if seconds >= 1 else None
                if fuzzer is None:
                    return
                self.running.add(fuzzer.name)
            began = time.monotonic()
            whole, log = run_slice(self.asked.programs, self.asked.folder, fuzzer, seconds, self.processes)
            inputs, new = read_log(log)
            with self.lock:
                self.running.discard(fuzzer.name)
                fuzzer.after(time.monotonic() - began, new)
                add_to(self.asked.counts, fuzzer.name, inputs)
                if not whole and not self.stop.is_set():
                    fuzzer.broken = True
                    kept = self.asked.folder / "found" / f"{fuzzer.name}.failed.log"
                    kept.write_text(log)
                    print(f"fuzz: {fuzzer.name} FAILED; all of it in {kept}", file=sys.stderr, flush=True)

    def run(self):
        signal.signal(signal.SIGINT, self.end_all)
        signal.signal(signal.SIGTERM, self.end_all)
        with concurrent.futures.ThreadPoolExecutor(self.asked.jobs) as pool:
            for worker in [pool.submit(self.work) for _ in range(self.asked.jobs)]:
                worker.result()
        total = sum(json.loads(self.asked.counts.read_text()).values()) if self.asked.counts.exists() else 0
        for fuzzer in self.fuzzers:
            print(f"fuzz: {fuzzer.name}: {fuzzer.seconds:.0f} s{', FAILED' if fuzzer.broken else ''}")
        print(f"fuzz: {total} inputs in all calls")
        return 1 if any(f.broken for f in self.fuzzers) else 0


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("programs", type=Path)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("counts", type=Path)
    arguments.add_argument("--hours", type=float, default=0.0)
    arguments.add_argument("--slice", type=int, default=120, help="seconds")
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--only", default="", help="names of fuzzers, separated by commas; all unless given")
    asked = arguments.parse_args()
    names = sorted(p.name.removeprefix("fuzz_") for p in asked.programs.glob("fuzz_*") if os.access(p, os.X_OK) and p.is_file())
    fuzzers = [Fuzzer(n) for n in names if not asked.only or n in asked.only.split(",")]
    sys.exit(LongRun(asked, fuzzers).run())


if __name__ == "__main__":
    main()
