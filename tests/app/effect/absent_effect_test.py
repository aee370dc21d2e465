#!/usr/bin/env python3
"""A scene that does not name an effect executes not one instruction for it: its steady ticks cost the same, instruction for instruction, as
those of the same objects linked with a registry of only the effects that it names. The scene as shipped shows it for the effects that it does
not name, and a copy without any effect, against an empty registry, for all of them. All code counts but the C library's: how memcmp reads
depends on the addresses that it is given. The same programs also agree in bytes allocated and not given back, once set up and after the run, in
allocations, threads, columns of a session, and in what a display receives, on which alone depends which shader programs are linked. Skipped (77)
without valgrind or AVX2.

    absent_effect_test.py STEADY_TICKS STEADY_TICKS_NAMED STEADY_TICKS_NONE SCENE TOOL_FOLDER REGISTRY

The sabotage: with [friction] or [dust] in the scene the counts must rise, a thread that sleeps must count, and a program whose registry lacks an
effect must refuse a scene with it. [sound] in a run that nobody hears costs no instruction either.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
FRICTION = "friction.static_coefficient=0.4"
SOUND = "sound.volume=0.4"
DUST = "dust={}"
COUNTS = ["ready_bytes", "ready_allocations", "ready_threads", "ran_bytes", "ran_allocations", "ran_threads", "columns", "texels", "added", "pictures"]


def run(program, scene, tools, profile, *sets):
    """@returns the finished process of `program` under callgrind, which writes `profile`."""
    command = ["valgrind", "--tool=callgrind", "--instr-atstart=no", f"--callgrind-out-file={profile}", program, scene, tools, *sets]
    return subprocess.run(command, capture_output=True, text=True, timeout=550)


def instructions(profile):
    """@returns the instructions of a callgrind profile, without those of the C library; @throws ValueError where its total disagrees."""
    names, of_object, total = {}, {}, None
    current, called = "", False
    for line in pathlib.Path(profile).read_text(encoding="utf-8").splitlines():
        named = re.match(r"ob=(\(\d+\))(?: (.*))?", line)
        if named:
            if named.group(2):
                names[named.group(1)] = named.group(2)
            current = names[named.group(1)]
        elif line.startswith("cob="):  # the object of a function that is called: it may be named here first
            number, name = re.match(r"cob=(\(\d+\))(?: (.*))?", line).groups()
            names.setdefault(number, name)
        elif line.startswith("calls="):
            called = True  # the next line is the cost of the call, which stands with the function called
        elif line.startswith("totals:"):
            total = int(line.split()[1])
        elif re.match(r"[0-9+*-]", line):
            if not called:
                of_object[current] = of_object.get(current, 0) + int(line.split()[1])
            called = False
    if total != sum(of_object.values()):
        raise ValueError(f"{profile}: sums to {sum(of_object.values())}, not to {total}")
    return sum(cost for name, cost in of_object.items() if "/libc.so" not in name)


def count(program, scene, tools, *sets):
    """@returns (instructions, what the program printed) of a run that must succeed."""
    with tempfile.NamedTemporaryFile() as profile:
        done = run(program, scene, tools, profile.name, *sets)
        if done.returncode == 4:
            sys.exit(SKIPPED)
        if done.returncode != 0:
            sys.exit(f"{program} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
        return instructions(profile.name), done.stdout


def counted(program, lacking, scene, tools):
    """@returns the instructions of a scene; exits if those of the program that lacks effects differ, or its run."""
    cost, drilled = count(program, scene, tools)
    cost_lacking, drilled_lacking = count(lacking, scene, tools)
    print(f"{pathlib.Path(scene).name}: {cost} instructions with all effects in the registry, {cost_lacking} with those that the scene names")
    if drilled != drilled_lacking:
        sys.exit(f"not the same run, memory, threads or columns:\n{drilled}{drilled_lacking}")
    if cost != cost_lacking:
        sys.exit("an effect that the scene does not name costs instructions")
    return cost


def counts(program, scene, tools, *arguments):
    """@returns what a run without callgrind prints as NAME=NUMBER."""
    done = subprocess.run([program, scene, tools, *arguments], capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        sys.exit(f"{program} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)", done.stdout)}


def check_counts(program, with_named, scene, tools):
    """Memory, threads, columns and pictures of the programs agree, and each count sees an effect that the scene names."""
    whole, lacking = (counts(one, scene, tools, "--picture") for one in (program, with_named))
    dusty, waiting = counts(program, scene, tools, "--picture", DUST), counts(program, scene, tools, "--picture", "--thread")
    print(f"with all effects {whole}\nwith those of the scene {lacking}\nwith [dust] {dusty}")
    if sorted(whole) != sorted(COUNTS + ["tissue", "soft"]) or whole != lacking:
        sys.exit("an effect that the scene does not name costs memory, a thread, a column or part of a picture")
    for name in ("ready_bytes", "ready_allocations", "ran_bytes", "ran_allocations", "columns", "added"):
        if dusty[name] <= whole[name]:
            sys.exit(f"{name} does not see [dust]")
    if whole["added"] != 0 or not whole["pictures"] > 0 or not whole["texels"] > 0:
        sys.exit("no picture was drawn, or one with more than bone and tool")
    for name in ("ready_threads", "ran_threads"):
        if waiting[name] != whole[name] + 1:
            sys.exit(f"{name} does not see a thread")


def main():
    program, with_named, with_none, scene, tools, registry = sys.argv[1:]
    if not shutil.which("valgrind"):
        print("skipped: no valgrind")
        return SKIPPED
    effects = re.findall(r"^BH_EFFECT\((\w+)\)$", pathlib.Path(registry).read_text(encoding="utf-8"), re.M)
    text = pathlib.Path(scene).read_text(encoding="utf-8")
    named = [effect for effect in effects if re.search(rf"^\[{effect}\]", text, re.M)]
    if len(effects) < 5 or not named or len(named) == len(effects):
        sys.exit(f"the scene names {named} of {effects}")
    shipped = counted(program, with_named, scene, tools)
    with tempfile.TemporaryDirectory() as folder:
        bare = pathlib.Path(folder) / "bare.toml"
        bare.write_text(re.sub(rf"^\[({'|'.join(named)})\][^\n]*\n(?:(?!\[).*\n)*", "", text, flags=re.M), encoding="utf-8")
        bare_cost = counted(program, with_none, str(bare), tools)
    check_counts(program, with_named, scene, tools)
    rubbing, _ = count(program, scene, tools, FRICTION)
    unheard, _ = count(program, scene, tools, SOUND)
    print(f"{rubbing} with [friction] in the scene")
    if not 1_000 < bare_cost < shipped or shipped < 1_000_000 or rubbing <= shipped:
        sys.exit("the count sees no steady ticks, or not the effect that the scene names")
    if unheard != shipped:
        sys.exit(f"[sound] that nobody hears costs {unheard - shipped} instructions")
    for effect in (effect for effect in effects if effect not in named):
        refused = subprocess.run([with_named, scene, tools, effect + "={}"], capture_output=True, text=True, timeout=60)
        if refused.returncode != 2 or effect not in refused.stdout:
            sys.exit(f"a registry without [{effect}] took a scene with it: {refused.returncode}\n{refused.stdout}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
