#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tools/floors.py finds every kind of wrong arrow, and no others.

    floors_cases.py tools/floors.py
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

FLOORS = ""

GOOD = {
    "base/status.h": "",
    "grid/grid.h": '#include "base/status.h"\n',
    "stencil/limit.h": '#include "grid/grid.h"\n',
    "solve/pcg.h": '#include "stencil/limit.h"\n',
    "physics/diffuse.h": '#include "solve/pcg.h"\n',
    "physics/diffuse_stage.c": '#include "physics/diffuse.h"\n',
    "physics/advect.h": "#include <math.h>\n",
    "io/scene.h": '#include "grid/grid.h"\n',
    "render/canvas.h": '#include "base/status.h"\n#include "render/canvas.h"\n',
    "model/scene_check.c": '#include "io/scene.h"\n#include "physics/advect.h"\n#include "physics/diffuse.h"\n',
    "session/run.c": '#include "render/canvas.h"\n#include "io/scene.h"\n',
    "app/main.c": '#include "session/run.h"\n#include "cattaneo.h"\n',
    "session/run.h": "",
}

# what is added, and where and why it is wrong
BAD = [
    ("grid/a.h", '\n#include "solve/pcg.h"\n', "grid/a.h:2", "solve (3) is above grid (1)"),
    ("base/a.c", '#include "grid/grid.h"\n', "base/a.c:1", "above base"),
    ("model/a.c", '  #  include "session/run.h"\n', "model/a.c:1", "above model"),
    ("physics/project.c", '#include "physics/advect.h"\n', "physics/project.c:1", "meet only in model"),
    ("physics/a.c", '#include "io/scene.h"\n', "physics/a.c:1", "physics does not see io"),
    ("model/tracer.h", '#include "io/scene.h"\n', "model/tracer.h:1", "only .c files of model"),
    ("model/tracer.c", '#include "io/frame.h"\n', "model/tracer.c:1", "model does not see io"),
    ("model/scene.c", '#include "render/canvas.h"\n', "model/scene.c:1", "model does not see render"),
    ("io/a.c", '#include "model/a.h"\n', "io/a.c:1", "io sees only base, grid"),
    ("render/a.c", '#include "io/scene.h"\n', "render/a.c:1", "render sees only base, grid"),
    ("solve/a.c", '#include "pcg.h"\n', "solve/a.c:1", "no floor"),
    ("solve/a.c", '#include "solve/none.h"\n', "solve/a.c:1", "there is no such file"),
    ("tools/a.c", "", "tools/a.c:1", "tools is no floor"),
]


class Floors(unittest.TestCase):
    def call(self, extra, *options):
        with tempfile.TemporaryDirectory() as folder:
            src = pathlib.Path(folder)
            for name, text in {**GOOD, **extra}.items():
                (src / name).parent.mkdir(exist_ok=True)
                (src / name).write_text(text)
            return subprocess.run([sys.executable, FLOORS, "--src", folder, *options], capture_output=True, text=True)

    def test_arrows_that_point_down_pass(self):
        done = self.call({})
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def test_every_wrong_arrow_is_found_at_its_place(self):
        for name, text, place, reason in BAD:
            done = self.call({name: text})
            self.assertEqual(done.returncode, 1, name)
            self.assertEqual(len(done.stdout.splitlines()), 1, done.stdout)
            self.assertIn(place, done.stdout)
            self.assertIn(reason, done.stdout)

    def test_the_drawing_counts_lines(self):
        done = self.call({}, "--draw")
        self.assertEqual(done.returncode, 0)
        lines = sum(text.count("\n") for text in GOOD.values())
        self.assertIn(f"\n{lines} lines", done.stdout)
        self.assertEqual(len({len(line) for line in done.stdout.splitlines()[:-1]}), 1)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    FLOORS = sys.argv.pop(1)
    unittest.main()
