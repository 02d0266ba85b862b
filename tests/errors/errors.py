#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every error the program can give, from its sources, and whether somebody has seen it.

    errors.py SOURCES WITNESS [--list]     WITNESS: the program linked with witness.c; --list: all sentences, to read

An error is a call of cf_fail, cf_scene_fail_at or cf_config_fail with its format. All scenes of tests/golden and the
command lines in cases.txt are given to the program; what was never said must stand in elsewhere.txt: those that only
a caller of the library, a failing machine or a test of its own can provoke. A new error without a case fails the test.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
CALL = re.compile(r"\b(cf_fail|cf_scene_fail_at|cf_config_fail)\s*\(")
PIECE = re.compile(r'"((?:[^"\\]|\\.)*)"|([A-Za-z_]\w*)')


def format_at(text, start):
    """The format of the call whose parenthesis opens at `start`: its first literal and those joined to it."""
    depth, i, found = 0, start, []
    while i < len(text):
        c = text[i]
        if c == '"':
            piece = PIECE.match(text, i)
            found.append(piece[1])
            i = piece.end()
            continue
        if found and c == "," or c == ")" and depth == 1:
            break
        if found and (c.isalpha() or c == "_"):  # a macro between two literals
            word = PIECE.match(text, i)
            found.append("\0")
            i = word.end()
            continue
        depth += (c == "(") - (c == ")")
        i += 1
    return "".join(found)


def known(sources):
    """{format: the places it stands at}; \\0 stands for a macro."""
    errors = {}
    for path in sorted(sources.rglob("*.c")):
        text = path.read_text()
        for call in CALL.finditer(text):
            written = format_at(text, call.end() - 1)
            if written.strip("%s") and not written.startswith("const char"):
                line = text.count("\n", 0, call.start()) + 1
                errors.setdefault(written, []).append(f"{path.relative_to(sources)}:{line}")
    return errors


def pattern(written):
    plain = written.replace('\\"', '"').replace("\\\\", "\\")
    return re.compile(".*?".join(re.escape(part) for part in plain.split("\0")))


def provoke(witness, seen):
    environment = {**os.environ, "ERRORS_SEEN": seen, "GOMP_SPINCOUNT": "1000", "OMP_WAIT_POLICY": "passive"}

    def call(words, folder):
        done = subprocess.run([witness, *words], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, timeout=60)
        if done.returncode < 0:
            sys.exit(f"{words}: killed by signal {-done.returncode}")

    golden = HERE.parent / "golden/scene_errors"
    for scene in sorted(golden.glob("*.yaml")):
        more = scene.with_suffix(".set")
        sets = more.read_text().splitlines() if more.exists() else []
        call(["check", scene.name, *[word for line in sets for word in ("--set", line)]], golden)
    with tempfile.TemporaryDirectory(prefix="cattaneo-errors-") as folder:
        for name in ("tracer", "flow", "phase", "gel", "snowfall"):
            text = HERE.parent / f"bits/{name}.yaml"
            if text.exists():
                (pathlib.Path(folder) / f"{name}.yaml").write_text(text.read_text())
        os.symlink(HERE.parent / "bits/flakes", pathlib.Path(folder) / "flakes")
        for line in (HERE / "cases.txt").read_text().splitlines():
            words = shlex.split(line, comments=True)
            if words:
                call(words, folder)


def main():
    sources, witness = pathlib.Path(sys.argv[1]), os.path.abspath(sys.argv[2])
    errors = known(sources)
    if "--list" in sys.argv:
        for written, places in errors.items():
            print(f"{places[0]}: {written!r}")
        return 0
    with tempfile.NamedTemporaryFile(prefix="cattaneo-seen-") as file:
        provoke(witness, file.name)
        said = set(pathlib.Path(file.name).read_text(errors="replace").splitlines())
    elsewhere = {line for line in (HERE / "elsewhere.txt").read_text().splitlines() if line and line[0] != "#"}
    missing = []
    for written, places in errors.items():
        shape = pattern(written)
        if not any(shape.fullmatch(s) for s in said) and written.replace("\0", "@") not in elsewhere:
            missing.append((places[0], written.replace("\0", "@")))
    print(f"{len(errors)} errors, {len(errors) - len(missing)} known, {len(said)} said by the program")
    for place, written in missing:
        print(f"never provoked: {place}: {written}")
    return 1 if missing else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main())
