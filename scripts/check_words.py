#!/usr/bin/env python3
"""Checks the vocabulary of code and documents and the units, frames and errors in headers: `file:line: what is wrong`.

  words    comments and string literals of *.h and *.cpp, comments of shaders, docs/*.md and README.md contain
           no word of BANNED, except where ALLOWED names a legitimate use; nor do the names of test cases, CONTRIBUTING.md and CHANGELOG.md
  units    every public floating-point member of a struct or class in a header has a unit in brackets in its comment ([m], [N/m], [-]) or
           in its name (radius_mm); integers likewise, except counts, flags and identifiers (COUNT_NAME)
  frame    a header that declares vectors, poses or affine maps has a line "Frame" in the comment that precedes #pragma once
  errors   a header that declares Result or Status names the error codes, or has a line "Errors"

  check_words.py [ROOT]        exit 0: nothing found, 3: findings, one line each
"""
import re
import sys
from pathlib import Path

# Pattern (word boundaries are added, case is ignored) and what to write.
BANNED = [
    (r"tell|tells|telling|told|foretold", "report, print, notify, return; predicted"),
    (r"look|looks|looked|looking", "query, probe, sample, find, view, appearance"),
    (r"held (pose|tool)", "proxy pose, constrained tool"),
    (r"play", "clearance"),
    (r"ways? out", "penetration depth, minimum translation distance"),
    (r"swallow(s|ed|ing)?|owed|owes|g(ive|iven|ives|ave) out", "dissipated energy, generated energy, passivity deficit"),
    (r"pull(s|ed|ing)?", "attractive force"),
    (r"lets? lie|push(es|ed|ing)? out", "depenetration limit"),
    (r"turning round|passing through nothing", "force reversal"),
    (r"hollow direction", "conforming contact normal"),
    (r"grips|gripped|gripping", "flank friction, lateral stiffness while cutting; grip is the handle of a device"),
    (r"parcels?|desks?", "batch, update, hand-off"),
    (r"sleeps?|asleep|awake|wakes?|waking", "inactive, skipped until"),
    (r"lame", "invalid, degraded"),
    (r"fronts?", "Pareto front, cutting front"),
    (r"bearable", "maximum stable stiffness"),
    (r"by turns", "interleaved, paired runs"),
    (r"mend(s|ed|ing)?", "fix"),
    (r"faults?", "failure, error (fault: only a latched device or servo fault)"),
    (r"feel(s|ing)? the give", "breakthrough detection"),
    (r"nothing but|so many|but for|lets? go|letting go", "a plain statement"),
]

# A use of a banned word is legitimate where the text around it matches one of these; (path prefix, pattern of the text, ignoring case).
ALLOWED = [
    ("", r"look(s|ed|ing)?[- ]up"),
    ("", r"(pareto|cutting|wave) fronts?|in front\b|front (to|and) back|back to front|front (face|panel|view)"),
    ("", r"@param front|nohead front|\$front"),
    ("", r"(page|segmentation) faults?"),
    ("", r"(device|servo|latched|latches a|limiter) faults?|faults? (is|are) latched|fault (bits?|flags?)"),
    ("", r"pull request"),
    ("", r"play button|play ?back"),
    ("", r"(thread|servo|loop|clock|absolute) (sleeps?|wakes?)|wakes? (up|the thread)|wake[- ]up"),
    ("core/mesh/", r"fronts?"),  # of ball pivoting, the only one there: docs/glossary.md
    ("tests/core/mesh/", r"fronts?"),
    ("docs/mesh.md", r"fronts?"),
    ("docs/glossary.md", r"pivoting front|front edges?"),
    ("haptics/servo/", r"faults?|wakes?|sleeps?|lateness"),
    ("tests/haptics/servo/", r"latched fault|servo fault"),
    ("docs/glossary.md", r"\| fault \||faults?: every|latched fault"),
]

CODE_FOLDERS = ["core", "haptics", "volumes", "app"]
SHADER_SUFFIXES = {".glsl", ".frag", ".vert"}

# What a unit in brackets is made of.
UNIT_WORDS = set("""m mm um km cm N mN J mJ W s ms us ns h min kg g rad deg Hz kHz rev rpm K C Pa MPa GPa V A HU dB bit bits byte bytes B MB
voxel voxels edge edges quantum quanta node nodes pixel pixels px texel texels tick ticks sample samples cell cells step steps slices ratio index point
points digits turn turns level levels share""".split())
TAG = re.compile(r"\[([^\[\]]+)\]")
UNIT_IN_NAME = re.compile(r"_(mm3?|um|m|N|hz|khz|us|ms|ns|s|rpm|deg|rad|db|percent|share|voxels?|mb|bytes|px|pixels|ticks|hu|j|kg)_?$",
                          re.I)

REAL = r"(?:double|float|Vec3f?|Meridian|Wrench|glm::[df]?vec[234]|glm::[df]?mat[34]|Mat3)"
INTEGER = r"(?:int|long|short|Vec[23]i|(?:std::)?(?:int(?:8|16|32|64)_t|ptrdiff_t))"
OF_TYPE = (r"^(?:static )?(?:const )?(?:inline )?(?:constexpr )?(?:std::(?:vector|optional|array|span|atomic)<\s*(?:const )?)*"
           r"{}\b(?:,[^>]*)?>*\s*[*&]?\s*")
REAL_MEMBER = re.compile(OF_TYPE.format(REAL) + r"(\w+)[^()]*?(?:\{.*\})?[^()]*;|^" + REAL + r"\s+(\w+)\s*=.*;")
INTEGER_MEMBER = re.compile(OF_TYPE.format(INTEGER) + r"(\w+)\s*(?:=|\{|;|,|\[).*;|^" + INTEGER + r"\s+(\w+)\s*=.*;")
# Counts, flags and identifiers carry no unit: unsigned types, plural nouns, and these.
COUNT_NAME = re.compile(
    r"(?:[a-rt-z]s|ss|count|number|size|seed|id|epoch|version|generation|bits?|flags?|mask|code|hash|index|first|last|order|label|kind|"
    r"r|g|b|a|axis|part|word|row|slab|stride|offset|begin|end|parent|max|min|limit|capacity|depth|repeats?|supersample|at|of|total)_?$")

FRAMED = re.compile(r"\b(Vec3f?|Vec3i|Pose|Affine|Wrench|Meridian|VoxelBox)\b")
FALLIBLE = re.compile(r"\b(Result<|Status\b)")
ERRORS = re.compile(r"\b(Errors?\b|bad_input|out_of_range|unavailable|check_failed|ErrorCode)")


def split_code(text):
    """@returns (code, comments, strings): `code` is the text with comments and literals blanked; the others are lists of (line, text).

    Adjacent literals on one line are separate entries. Raw strings are strings.
    """
    code, comments, strings = [], [], []
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
    at = 0
    for found in pattern.finditer(text):
        token = found.group(0)
        line = text.count("\n", 0, found.start()) + 1
        if token.startswith("'") and found.start() > 0 and text[found.start() - 1].isdigit():
            continue  # a digit separator
        code.append(text[at:found.start()])
        code.append(re.sub(r"[^\n]", " ", token))
        at = found.end()
        kept = comments if token.startswith(("//", "/*")) else strings if not token.startswith("'") else None
        if kept is not None:
            kept += [(line + n, part) for n, part in enumerate(token.split("\n"))]
    code.append(text[at:])
    return "".join(code), comments, strings


def word_findings(path, lines):
    """@returns findings of banned words in `lines`, a list of (line number, text)."""
    findings = []
    for number, text in lines:
        for words, instead in BANNED:
            for found in re.finditer(rf"(?<![\w`]){words.join(['(?:', ')'])}(?![\w`(])", text, re.I):
                around = text[max(0, found.start() - 24):found.end() + 24]
                if any(path.startswith(prefix) and re.search(pattern, around, re.I) for prefix, pattern in ALLOWED):
                    continue
                findings.append((number, f'"{found.group(0)}": write {instead}'))
    return findings


def has_unit(comment):
    """@returns whether a comment contains a unit in brackets: [m], [N/m], [1/rev], [-], [%]."""
    for found in TAG.finditer(comment):
        tag = found.group(1).strip()
        words = re.findall(r"[A-Za-z-]{2,}|[A-Za-z]", tag.replace("^-", "^"))
        if tag in ("-", "%") or "unit" in tag or (words and "," not in tag and all(word in UNIT_WORDS for word in words)):
            return True
    return False


def public_members(code):
    """Yields (line number, declaration) of each line at the level of the public part of a struct or class."""
    scopes = []  # per open brace: "public", "private" or None outside of a class body
    pending = None
    for number, line in enumerate(code.split("\n"), start=1):
        text = line.strip()
        access = re.match(r"(public|private|protected)\s*:", text)
        if access and scopes and scopes[-1] is not None:
            scopes[-1] = "public" if access.group(1) == "public" else "private"
            continue
        opened = re.match(r"(?:template\s*<.*>\s*)?(struct|class|union)\b[^;()]*$", text)
        if opened:
            pending = "private" if opened.group(1) == "class" else "public"
        elif scopes and scopes[-1] == "public" and all(s in ("public", None) for s in scopes) and text.endswith(";"):
            yield number, text
        for char in text:
            if char == "{":
                scopes.append(pending if opened or pending else None)
                pending = None
            elif char == "}" and scopes:
                scopes.pop()
            elif char == ";":
                pending = None


def unit_findings(text, code):
    """@returns findings of public numeric members without a unit."""
    lines = text.split("\n")
    findings = []
    for number, declaration in public_members(code):
        if "(" in re.sub(r"\{.*?\}|=.*", "", declaration) or declaration.startswith(("static", "using", "friend", "return", "typedef")):
            continue
        real, integer = REAL_MEMBER.match(declaration), INTEGER_MEMBER.match(declaration)
        found = real or integer
        if not found:
            continue
        name = next(group for group in found.groups() if group)
        if UNIT_IN_NAME.search(name) or (not real and COUNT_NAME.search(name)):
            continue
        comment = lines[number - 1].partition("//")[2]
        above = number - 2
        while above >= 0 and lines[above].strip().startswith("//"):
            comment += " " + lines[above]
            above -= 1
        if not has_unit(comment):
            findings.append((number, f"{name}: no unit in brackets ([m], [N/m], [-]) in its comment"))
    return findings


def header_findings(text, code):
    """@returns findings of a header as a whole: frame and errors."""
    top = text.partition("#pragma once")[0]
    comments = " ".join(line for line in text.split("\n") if "//" in line)
    findings = []
    if FRAMED.search(code) and not re.search(r"\bframes?\b", top, re.I):
        findings.append((1, 'declares vectors, poses or boxes: no line "Frame" before #pragma once'))
    if FALLIBLE.search(code) and not ERRORS.search(comments):
        findings.append((1, "declares Result or Status: no comment names the errors"))
    return findings


def check_file(root, path):
    """@returns findings of one file as 'file:line: text', in order of lines."""
    text = (root / path).read_text(encoding="utf-8")
    suffix = Path(path).suffix
    if suffix in {".h", ".cpp"} | SHADER_SUFFIXES:
        code, comments, strings = split_code(text)
        findings = word_findings(path, comments + [entry for entry in strings if " " in entry[1]])
        if suffix == ".h":
            findings += unit_findings(text, code) + header_findings(text, code)
    else:
        findings = word_findings(path, list(enumerate(text.split("\n"), start=1)))
    return [f"{path}:{number}: {what}" for number, what in sorted(findings)]


TEST_NAME = re.compile(r'(?:TEST_CASE|SUBCASE)\(\s*("(?:\\.|[^"\\])*"(?:\s*"(?:\\.|[^"\\])*")*)')


def test_name_findings(root, path):
    """@returns findings of banned words in the names of a file's test cases."""
    text = (root / path).read_text(encoding="utf-8")
    names = [(text.count("\n", 0, found.start()) + 1, re.sub(r'"\s+"', "", found.group(1))) for found in TEST_NAME.finditer(text)]
    return [f"{path}:{number}: {what}" for number, what in word_findings(path, names)]


def files_of(root):
    """@returns paths of all files to check, from the root."""
    files = []
    for folder in CODE_FOLDERS:
        files += [file for file in (root / folder).rglob("*") if file.suffix in {".h", ".cpp"}]
    files += [file for file in (root / "shaders").rglob("*") if file.suffix in SHADER_SUFFIXES]
    files += list((root / "docs").glob("*.md")) + [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
    return sorted(file.relative_to(root).as_posix() for file in files if file.is_file())


def check_tree(root):
    """@returns every finding of the converted part of the tree, in order of path and line."""
    tests = sorted(file.relative_to(root).as_posix() for file in (root / "tests").rglob("*.cpp"))
    return ([finding for path in files_of(root) for finding in check_file(root, path)] +
            [finding for path in tests for finding in test_name_findings(root, path)])


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    findings = check_tree(root)
    for finding in findings:
        print(finding, file=sys.stderr)
    return 3 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
