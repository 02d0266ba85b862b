#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Installs into a folder of its own, moves it, and builds a project of somebody else against it in both ways:
with CMake's find_package and with pkg-config.

    install.py BUILD_FOLDER COMPILER
"""

import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def call(*words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}failed with {done.returncode}")
    return done.stdout


def expect(text, *words):
    for word in words:
        if word not in text:
            sys.exit(f"{word} is not in {text!r}")


def with_cmake(prefix, work, compiler):
    build = work / "outside"
    call("cmake", "-S", HERE / "outside", "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}",
         f"-DCMAKE_C_COMPILER={compiler}")
    call("cmake", "--build", build)
    expect(call(build / "outside_double"), "8 bytes a number, right")
    expect(call(build / "outside_single"), "4 bytes a number, right")


def with_pkg_config(prefix, work, compiler):
    folder = next(prefix.rglob("cattaneo.pc")).parent
    environment = {**os.environ, "PKG_CONFIG_PATH": str(folder)}
    for name, size in (("cattaneo", 8), ("cattaneof", 4)):
        flags = call("pkg-config", "--cflags", "--libs", name, env=environment).split()
        call(compiler, "-std=c17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", HERE / "outside/main.c", *flags, "-lm",
             "-o", work / name)
        library = call("pkg-config", "--variable=libdir", name, env=environment).strip()
        said = call(work / name, env={**os.environ, "LD_LIBRARY_PATH": library})
        expect(said, call("pkg-config", "--modversion", name, env=environment).strip(), f"{size} bytes a number, right")


def programs(prefix):
    expect(call(prefix / "bin/cattaneo", "--version"), "double")
    expect(call(prefix / "bin/cattaneof", "--version"), "single")
    expect(next(prefix.rglob("cattaneo.1")).read_text(), ".TH CATTANEO 1")


def main():
    build, compiler = pathlib.Path(sys.argv[1]), sys.argv[2]
    with tempfile.TemporaryDirectory(prefix="cattaneo-install-") as folder:
        work = pathlib.Path(folder)
        call("cmake", "--install", build, "--prefix", work / "first")
        prefix = (work / "first").rename(work / "moved here")
        programs(prefix)
        with_cmake(prefix, work, compiler)
        prefix = prefix.rename(work / "last")  # pkg-config's flags are words: no blanks
        with_pkg_config(prefix, work, compiler)
    return 0


if __name__ == "__main__":
    sys.exit(main())
