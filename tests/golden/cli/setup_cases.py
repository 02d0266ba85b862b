#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tools/setup.sh, with stand-ins for dpkg-query, apt-get and id: what it installs, what it says.

    setup_cases.py tools/setup.sh
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SETUP = ""

BUILD = ("gcc g++ make cmake ninja-build pkg-config libfyaml-dev libmuparser-dev libudunits2-dev libhdf5-dev "
         "libpng-dev libembree-dev libopenvdb-dev libboost-dev libcmocka-dev").split()
TEST = "python3 python3-numpy python3-h5py python3-venv".split()


class Setup(unittest.TestCase):
    def call(self, *words, there=(), half=(), root=True, works=True):
        """Runs the script where the packages `there` are installed and `half` are removed but known."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            answers = "".join(f"{p} ii \\n" for p in there) + "".join(f"{p} rc \\n" for p in half)
            stands = {
                "dpkg-query": f"printf '{answers}'; exit {0 if there else 1}",
                "apt-get": f'echo "$@" >>{folder}/asked; case $* in *install*) exit {0 if works else 100};; esac',
                "id": f"echo {0 if root else 1000}",
            }
            for name, text in stands.items():
                (path / name).write_text("#!/bin/sh\n" + text + "\n")
                (path / name).chmod(0o755)
            environment = {**os.environ, "PATH": folder + ":/usr/bin:/bin"}
            done = subprocess.run([SETUP, *words], capture_output=True, text=True, env=environment)
            done.asked = (path / "asked").read_text() if (path / "asked").exists() else ""
            return done

    def test_nothing_missing_says_and_does_nothing(self):
        done = self.call("build", "test", there=BUILD + TEST)
        self.assertEqual((done.returncode, done.stdout, done.stderr, done.asked), (0, "", "", ""))

    def test_what_is_missing_is_installed_and_told_in_one_line(self):
        done = self.call("build", there=[p for p in BUILD if p not in ("cmake", "g++")], half=["g++"])
        self.assertEqual((done.returncode, done.stdout), (0, "set-up: installing with apt-get: g++ cmake\n"))
        self.assertTrue(done.asked.splitlines()[-1].endswith("install --no-install-recommends g++ cmake"))

    def test_a_bare_machine_gets_everything(self):
        done = self.call("build", "test")
        self.assertEqual(done.returncode, 0)
        self.assertTrue(done.asked.splitlines()[-1].endswith(" ".join(BUILD + TEST)))

    def test_without_root_the_line_for_an_administrator_and_code_2(self):
        done = self.call("build", there=BUILD[1:], root=False)
        self.assertEqual((done.returncode, done.asked), (2, ""))
        self.assertIn("apt-get install --no-install-recommends gcc\n", done.stdout + done.stderr)
        self.assertEqual(len((done.stdout + done.stderr).splitlines()), 1)

    def test_an_installation_that_fails_is_a_failure(self):
        done = self.call("build", there=BUILD[1:], works=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("could not install: gcc", done.stderr)

    def test_an_unknown_word_is_refused(self):
        self.assertEqual(self.call("buidl").returncode, 2)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    SETUP = os.path.abspath(sys.argv.pop(1))
    unittest.main()
