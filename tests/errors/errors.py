#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every error the program can give, from its sources, and whether somebody has seen it.

    errors.py SOURCES WITNESS TESTS [--list | --said]     WITNESS: the program linked with witness.c; TESTS: the
        folder of the tests of the floors, linked likewise; --list: all errors, to read; --said: every line of cases.txt
        and what the program answers, to read

An error is a call of cf_fail, cf_scene_fail_at, cf_config_fail or cf_config_fail_at with its format. All scenes of tests/golden and the
command lines in cases.txt are given to the program (a line that begins with ! is one of the shell, with the program as
$CATTANEO), and the tests of
the floors run; what was never said must stand in elsewhere.txt with its reason: what only a failing machine provokes.
A new error without a case fails the test, and so does a line of elsewhere.txt that is no error.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FORMAT_IS = {"cf_fail": 1, "cf_scene_fail_at": 2, "cf_config_fail": 2, "cf_config_fail_at": 2}  # which argument
CALL = re.compile(rf"\b({'|'.join(FORMAT_IS)})\s*\(")
PIECE = re.compile(r'"((?:[^"\\]|\\.)*)"|([A-Za-z_]\w*)')


def format_at(text, start, wanted):
    """The format, argument `wanted`, of the call whose parenthesis opens at `start`; its literals are joined."""
    depth, argument, i, found = 0, 0, start, []
    while i < len(text):
        c = text[i]
        if c == '"' or found and (c.isalpha() or c == "_"):  # a literal, or a macro between two of them
            piece = PIECE.match(text, i)
            if argument == wanted:
                found.append(piece[1] if c == '"' else "\0")
            i = piece.end()
            continue
        depth += (c in "([{") - (c in ")]}")
        argument += c == "," and depth == 1
        if depth == 0 or argument > wanted:
            break
        i += 1
    return "".join(found)


def known(sources):
    """{format: the places it stands at}; \\0 stands for a macro."""
    errors = {}
    for path in sorted(sources.rglob("*.c")):
        text = path.read_text()
        for call in CALL.finditer(text):
            written = format_at(text, call.end() - 1, FORMAT_IS[call[1]])
            if written.strip("%s") and not written.startswith("const char"):
                line = text.count("\n", 0, call.start()) + 1
                errors.setdefault(written, []).append(f"{path.relative_to(sources)}:{line}")
    return errors


def pattern(written):
    plain = written.replace('\\"', '"').replace("\\\\", "\\")
    return re.compile(".*?".join(re.escape(part) for part in plain.split("\0")))


def provoke(witness, tests, seen, tell):
    environment = {**os.environ, "ERRORS_SEEN": seen, "GOMP_SPINCOUNT": "1000", "OMP_WAIT_POLICY": "passive",
                   "CATTANEO": witness}

    def call(words, folder):
        done = subprocess.run(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=600)
        if tell and words[0] == witness:
            print(f"$ cattaneo {' '.join(words[1:])}\n{done.stderr.decode()}[{done.returncode}]")
        if done.returncode < 0 or words[0] == "sh" and done.returncode != 0:
            sys.exit(f"{words}: {done.returncode}\n{done.stderr.decode()}")

    golden = HERE.parent / "golden/scene_errors"
    for scene in sorted(golden.glob("*.yaml")):
        more = scene.with_suffix(".set")
        sets = more.read_text().splitlines() if more.exists() else []
        call([witness, "check", scene.name, *[word for line in sets for word in ("--set", line)]], golden)
    with tempfile.TemporaryDirectory(prefix="cattaneo-errors-") as folder:
        for name in ("tracer", "flow", "phase", "gel", "snowfall"):
            text = HERE.parent / f"bits/{name}.yaml"
            if text.exists():
                (pathlib.Path(folder) / f"{name}.yaml").write_text(text.read_text())
        os.symlink(HERE.parent / "bits/flakes", pathlib.Path(folder) / "flakes")
        for line in (HERE / "cases.txt").read_text().splitlines():
            if line.startswith("!"):
                call(["sh", "-c", line[1:]], folder)
            elif words := shlex.split(line, comments=True):
                call([witness, *words], folder)
    if not tell:
        for program in sorted(tests.glob("unit_*")) + sorted(tests.glob("memory_*")):
            if not program.name.endswith("_single"):
                call([str(program)], tests.parent)


def main():
    sources, witness, tests = pathlib.Path(sys.argv[1]), os.path.abspath(sys.argv[2]), pathlib.Path(sys.argv[3]).resolve()
    errors = known(sources)
    if "--list" in sys.argv:
        for written, places in errors.items():
            print(f"{places[0]}: {written!r}")
        return 0
    with tempfile.NamedTemporaryFile(prefix="cattaneo-seen-") as file:
        provoke(witness, tests, file.name, "--said" in sys.argv)
        if "--said" in sys.argv:
            return 0
        said = set(pathlib.Path(file.name).read_text(errors="replace").splitlines())
    elsewhere = {line for line in (HERE / "elsewhere.txt").read_text().splitlines() if line and line[0] != "#"}
    stale = elsewhere - {written.replace("\0", "@") for written in errors}
    missing = []
    for written, places in errors.items():
        shape = pattern(written)
        if not any(shape.fullmatch(s) for s in said) and written.replace("\0", "@") not in elsewhere:
            missing.append((places[0], written.replace("\0", "@")))
    print(f"{len(errors)} errors, {len(errors) - len(missing)} known, {len(said)} said by the program")
    for place, written in missing:
        print(f"never provoked: {place}: {written}")
    for line in sorted(stale):
        print(f"elsewhere.txt: is no error: {line}")
    return 1 if missing or stale else 0


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    sys.exit(main())
