"""Command lines: those of the examples in the manual, each option alone, and mistakes. Words end with a zero byte."""
import re
import shlex
from pathlib import Path

COMMANDS = Path(__file__).resolve().parents[2] / "app" / "cli"


def sources():
    return "".join(file.read_text(encoding="utf-8") for file in sorted(COMMANDS.glob("*.cpp")))


def options():
    """@returns every option, and value of a choice, that the sources of the commands name."""
    return set(re.findall(r'"(--[a-z][a-z-]*)"', sources())) | {"-h", "-o", "--"}


def names():
    return set(re.findall(r'add_command\(\s*\w+, "([a-z]+)"', sources()))


def line(*words):
    return "\0".join(words)


def files():
    out = {}
    for n, example in enumerate(sorted(set(re.findall(r'"burrhole ([^"\\]+)"', sources())))):
        try:
            out[f"example_{n}"] = line(*shlex.split(example.split("|")[0]))
        except ValueError:
            continue  # a sentence with one quote
    for name in sorted(names()):
        out[f"help_{name}"] = line(name, "--help")
        for n, option in enumerate(sorted(options())):
            out[f"{name}_{n}"] = line(name, option)
            out[f"{name}_{n}_value"] = line(name, "scene.toml", f"{option}=1")
    out |= {"none": "", "version": "--version", "help": "--help", "unknown": line("dril", "parietal"), "scene": "parietal", "extra": line("check", "a", "b"),
            "control": line("drill", "\x1b[31m\n"), "long": line("drill", "x" * 5000), "empty": line("drill", "", "--out", ""), "nan": line("drill", "a", "--workbench", "nan"),
            "study": line("cost", "contact", "--out", "x"), "deep": line("cost", "cost", "cost"), "bytes": "drill\0\u00e9\u202e\0--set\0a=b"}
    return out
