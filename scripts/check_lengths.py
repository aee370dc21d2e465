#!/usr/bin/env python3
"""Fails on a file of more than 500 lines and a function of more than 80: `file:line: what is wrong`.

C++ functions are found by their braces, which are counted outside comments, literals and preprocessor lines; a test case is a function, a
lambda part of the one it stands in. A function's lines run from its first line, return type or attribute included, to its closing brace.

  check_lengths.py [ROOT]        exit 0: nothing is too long, 3: something is (one line each)
"""
import ast
import re
import sys
from pathlib import Path

MAX_FILE_LINES = 500
MAX_FUNCTION_LINES = 80
FOLDERS = ["app", "core", "haptics", "volumes", "tests", "scripts"]
CPP = {".h", ".cpp"}

# What may be longer: path, or path:function, and why. An entry that nothing needs is an error itself.
EXCEPTIONS = {
}

LITERAL = re.compile(
    r"""//[^\n]*|/\*.*?\*/                               # comments
      | R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)"     # raw strings
      | "(?:\\.|[^"\\\n])*" | (?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'   # strings, characters; 1'000 is a number
      | ^[ \t]*\#(?:\\\n|[^\n])*                         # preprocessor lines""",
    re.DOTALL | re.MULTILINE | re.VERBOSE)
NAMESPACE = re.compile(r"^\s*(inline\s+)?(namespace|extern)\b")
TYPE = re.compile(r"^\s*(template\s*<.*>\s*)?(typedef\s+)?(class|struct|union|enum)\b(?![^{]*\))", re.DOTALL)


def blanked(text):
    """@returns the text with comments, literals and preprocessor lines replaced by blanks, lines kept."""
    return LITERAL.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def name_of(head):
    """@returns what a function is called: the word before the first parenthesis."""
    words = re.findall(r"([\w:~]+|operator\S*)\s*\(", head)
    return next((word for word in words if word not in ("noexcept", "alignas", "decltype", "requires")), "?")


def cpp_functions(text):
    """@returns (name, first line, lines) of each function of a C++ file; none is inside another."""
    code, functions, outer = blanked(text), [], []  # outer: open scopes that are no function
    head, at = 0, 0                                 # where the text before a brace begins
    while at < len(code):
        mark = code[at]
        if mark == ";" or (mark == ":" and code[head:at].strip() in ("public", "private", "protected")):
            head = at + 1
        elif mark == "}":
            if outer:
                outer.pop()
            head = at + 1
        elif mark == "{":
            before = code[head:at]
            if NAMESPACE.match(before) or TYPE.match(before):
                outer.append(at)
                head = at + 1
            else:
                at = closing_brace(code, at)
                after = re.compile(r"\s*([,{]?)").match(code, at + 1)
                # A member that a constructor initialises in braces, or a value of its own: the body or the end comes later.
                if after.group(1) == "" and "(" in before:
                    start = head + len(before) - len(before.lstrip())
                    line = code.count("\n", 0, start) + 1
                    functions.append((name_of(before), line, code.count("\n", 0, at) + 2 - line))
                if after.group(1) == "":
                    head = at + 1
        at += 1
    return functions


def closing_brace(code, at):
    """@returns where the brace that opens at `at` closes; the last character if it does not."""
    depth = 0
    for found in re.compile(r"[{}]").finditer(code, at):
        depth += 1 if found.group() == "{" else -1
        if depth == 0:
            return found.start()
    return len(code) - 1


def python_functions(text):
    """@returns (name, first line, lines) of each function of a Python file."""
    return [(node.name, node.lineno, node.end_lineno - node.lineno + 1) for node in ast.walk(ast.parse(text))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def check_text(path, text, used=None):
    """@returns the errors of one file. @param used exceptions that were needed are added to it."""
    used = set() if used is None else used
    faults = []
    lines = text.count("\n")
    if lines > MAX_FILE_LINES:
        faults.append((path, f"{path}:1: {lines} lines, at most {MAX_FILE_LINES}"))
    for name, line, count in cpp_functions(text) if Path(path).suffix in CPP else python_functions(text):
        if count > MAX_FUNCTION_LINES:
            faults.append((f"{path}:{name}", f"{path}:{line}: {name} has {count} lines, at most {MAX_FUNCTION_LINES}"))
    used.update(key for key, _ in faults if key in EXCEPTIONS)
    return [fault for key, fault in faults if key not in EXCEPTIONS]


def is_python(file):
    if file.suffix == ".py":
        return True
    if file.suffix:
        return False
    with file.open("rb") as opened:
        return b"python" in opened.readline()


def check_tree(root):
    """@returns the errors of the tree, in order of path and line."""
    faults, used = [], set()
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.is_file() and (file.suffix in CPP or is_python(file)):
                faults += check_text(file.relative_to(root).as_posix(), file.read_text(encoding="utf-8"), used)
    return faults + [f"scripts/check_lengths.py:1: the exception {key} is not needed" for key in EXCEPTIONS if key not in used]


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    faults = check_tree(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 3 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
