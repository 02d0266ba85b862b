#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Whatever goes wrong once, nothing that was written before is lost: killed processes, failing disks, full disks,
damaged checkpoints, too little address space.

    faults.py PROGRAM SHIM [--stages | --all] [NAME...]     SHIM: the library made from shim.c

A small run makes some 500 calls that change files. One of them goes wrong; afterwards every file that has its name is
whole, `resume` goes on from a checkpoint no older than the one that was there, and ends with the same bytes as a run
that nothing happened to. Which one: a few (a minute); with --stages each kind of call at the beginning, in the middle
and at the end of each kind of file (minutes); with --all each of them (hours).
"""

import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = SHIM = ""
FEW, STAGES, ALL = range(3)
LEVEL = FEW

SCENE = """\
cattaneo: 1
title: Whatever goes wrong
model: tracer
domain: {size: [1, 0.75], cells: [16, 12]}
time: {end: 0.4, dt: 0.02, frames: 5}
diffusion: {k: 0.02, tau: 0.3}
fields:
  phi: {initial: 'exp(-((x-.4)^2+(y-.3)^2)/.01)'}
sources:
  - {field: phi, shape: sphere, center: [.7, .4], radius: .1, rate: '5*sin(20*t)'}
output: {fields: [phi, q], formats: [vtkhdf, npy, png], checkpoint: {every: 5 steps}}
"""

# What a resumed run must have in the same bytes: all but its log, which says that it was resumed.
COMPARED = re.compile(r"run\.yaml|metrics\.csv|fields.*|preview.*")


class Case(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="cattaneo-faults-")
        self.folder = pathlib.Path(self.temporary.name).resolve()
        (self.folder / "scene.yaml").write_text(SCENE)

    def tearDown(self):
        self.temporary.cleanup()

    def call(self, *arguments, environment=None, limit=None):
        basic = {**os.environ, "GOMP_SPINCOUNT": "1000"}  # said already: the program need not start itself again
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=120, env={**basic, **(environment or {})},
                              preexec_fn=limit)

    def run_scene(self, name, *more, **settings):
        return self.call("run", "scene.yaml", "-o", name, "--threads", "1", "--progress", "none", *more, **settings)

    def whole(self):
        """The files of a run that nothing happened to, and the text of its log."""
        done = self.run_scene("whole")
        self.assertEqual(done.returncode, 0, done.stderr)
        return {p.name: p.read_bytes() for p in (self.folder / "whole").iterdir() if COMPARED.fullmatch(p.name)}

    def compare(self, whole, name, why):
        for file, wanted in whole.items():
            path = self.folder / name / file
            self.assertTrue(path.exists(), f"{why}: {file} is missing")
            self.assertTrue(path.read_bytes() == wanted, f"{why}: {file} differs")

    def every_file_is_whole(self, name, why):
        """What has its name is complete: the program reads it."""
        for path in sorted((self.folder / name).iterdir()):
            if path.suffix in (".h5", ".vtkhdf"):
                done = self.call("info", str(path))
                self.assertEqual(done.returncode, 0, f"{why}: {done.stderr}")

    def checkpoints(self, name):
        return sorted(int(p.stem[-6:]) for p in (self.folder / name).glob("checkpoint_*.h5"))

    def go_on(self, whole, name, why, least=None):
        """Resumes (or starts again, where there is no run yet), from a checkpoint not older than `least`."""
        if (self.folder / name / "run.yaml").exists():
            done = self.call("resume", name, "--threads", "1")
        else:
            done = self.run_scene(name)
        self.assertEqual(done.returncode, 0, f"{why}: {done.stderr}")
        if least is not None:
            self.assertGreaterEqual(int(re.search(r"resumed from .*\(step (\d+)", done.stderr)[1]), least, why)
        self.compare(whole, name, why)


class Disk(Case):
    def fault(self, name, kind, at, *arguments):
        shim = {"LD_PRELOAD": SHIM, "FAULT_FOLDER": str(self.folder / name), "FAULT_KIND": kind, "FAULT_AT": str(at),
                "FAULT_TRACE": str(self.folder / "trace"), "ASAN_OPTIONS": "verify_asan_link_order=0"}
        return self.call(*arguments, environment=shim)

    def trace(self, words, start):
        """The calls of a run that nothing happens to, as `call file`, without the numbers in names."""
        self.fresh("d", start)
        self.assertEqual(self.fault("d", "none", 0, *words).returncode, 0)
        calls = [re.sub(r"\d+", "#", line) for line in (self.folder / "trace").read_text().splitlines()]
        self.assertGreater(len(calls), 80)
        return calls

    @staticmethod
    def stages(calls, kind):
        """The places of each kind of call, by where they are among their like that follow one another."""
        places, first = {}, 0
        for at, call in enumerate(calls):
            if at > 0 and calls[at - 1] != call:
                first = at
            last = at + 1 == len(calls) or calls[at + 1] != call
            if kind in ("short", "full") and not call.startswith(("write", "pwrite", "fwrite", "fflush")):
                continue  # as "error"
            places.setdefault((call, "first" if at == first else "last" if last else "middle"), []).append(at + 1)
        return places

    def chosen(self, calls, step, kind):
        """Calls, counted from 1."""
        rng = random.Random(kind)
        if LEVEL == STAGES:
            return sorted(rng.choice(places) for places in self.stages(calls, kind).values())
        return range(1, len(calls) + 1) if LEVEL == ALL else range(1 + rng.randrange(step), len(calls) + 1, step)

    def fresh(self, name, start):
        shutil.rmtree(self.folder / name, ignore_errors=True)
        if start:
            shutil.copytree(self.folder / start, self.folder / name)

    def judge(self, done, kind, why):
        """A call that went wrong is either of no importance or told in one sentence with the file and the reason."""
        if kind == "kill":
            self.assertEqual(done.returncode, -signal.SIGKILL, f"{why}: {done.stderr}")
            return
        self.assertIn(done.returncode, (0, 1), f"{why}: {done.stderr}")
        if done.returncode == 1:
            said = done.stderr.splitlines()
            self.assertEqual(len([line for line in said if line.startswith("cattaneo")]), 1, f"{why}: {done.stderr}")
            self.assertRegex(done.stderr, r"(No space left|Input/output error)", why)

    def walk(self, kind, words, step, start=None, least=None):
        whole, calls = self.whole(), self.trace(words, start)
        for at in self.chosen(calls, step, kind):
            why = f"{kind} at call {at} of {' '.join(words)}, {calls[at - 1]}"
            self.fresh("d", start)
            done = self.fault("d", kind, at, *words)
            self.judge(done, kind, why)
            if done.returncode == 0:
                self.compare(whole, "d", why)
                continue
            self.every_file_is_whole("d", why) if at % 5 == 0 else None
            self.go_on(whole, "d", why, least)

    RUN = ("run", "scene.yaml", "-o", "d", "--threads", "1", "--progress", "none")
    RESUME = ("resume", "d", "--threads", "1", "--progress", "none")

    def half(self):
        """A folder whose run got half-way, with checkpoints at steps 5, 10 and 12."""
        done = self.run_scene("half", "--steps", "12")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_run_that_is_killed_in_the_middle_of_a_call_goes_on(self):
        self.walk("kill", self.RUN, 83)

    def test_a_call_that_fails_is_told_and_the_run_goes_on_later(self):
        self.walk("error", self.RUN, 89)

    def test_a_write_that_does_half_is_told_or_finished(self):
        self.walk("short", self.RUN, 97)

    def test_a_disk_that_is_full_from_then_on_is_told(self):
        self.walk("full", self.RUN, 101)

    def test_a_resume_that_is_killed_goes_on_from_no_earlier(self):
        self.half()
        self.walk("kill", self.RESUME, 71, start="half", least=12)

    def test_a_resume_whose_calls_fail_goes_on_from_no_earlier(self):
        self.half()
        self.walk("error", self.RESUME, 73, start="half", least=12)

    def test_a_small_disk_that_fills_up(self):
        """A real one: a memory file system of 1 MB, most of it taken."""
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "none", str(disk)], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("mounting is not allowed here")
        try:
            whole = self.whole()
            taken = disk / "taken"
            taken.write_bytes(b"x" * 760_000)
            done = self.run_scene("disk/d")
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("No space left on device", done.stderr)
            self.assertIn("resume", done.stderr)
            self.every_file_is_whole("disk/d", "full disk")
            taken.unlink()
            self.go_on(whole, "disk/d", "after room was made")
            shutil.rmtree(disk / "d")
            taken.write_bytes(b"x" * 1_040_000)
            done = self.run_scene("disk/d")
            self.assertEqual(done.returncode, 5, done.stderr)
            self.assertRegex(done.stderr, r"a checkpoint takes .* MB and a frame .* MB, and .* MB are free")
        finally:
            subprocess.run(["umount", str(disk)], check=True)

    def test_kills_at_random_moments(self):
        whole = self.whole()
        rng = random.Random(1)
        for turn in range((3, 20, 60)[LEVEL]):
            self.fresh("d", None)
            run = subprocess.Popen([PROGRAM, *self.RUN], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
            time.sleep(0.1 * rng.random())
            run.kill()
            run.wait()
            (self.folder / "d").mkdir(exist_ok=True)
            self.go_on(whole, "d", f"turn {turn}")


class Checkpoints(Case):
    """Two checkpoints are kept, of steps 5 and 10; the newer one is damaged in every way."""

    def setUp(self):
        super().setUp()
        self.compared = self.whole()
        done = self.run_scene("kept", "--steps", "10")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.checkpoints("kept"), [5, 10])
        self.good = (self.folder / "kept/checkpoint_000010.h5").read_bytes()

    def resumes_from_the_older(self, data, why):
        shutil.rmtree(self.folder / "d", ignore_errors=True)
        shutil.copytree(self.folder / "kept", self.folder / "d")
        (self.folder / "d/checkpoint_000010.h5").write_bytes(data)
        done = self.call("resume", "d", "--threads", "1")
        self.assertEqual(done.returncode, 0, f"{why}: {done.stderr}")
        self.assertRegex(done.stderr, r"passed over: d/checkpoint_000010\.h5: ", why)
        self.assertIn("resumed from d/checkpoint_000005.h5 (step 5", done.stderr, why)
        self.compare(self.compared, "d", why)

    def test_flipped_bits_anywhere(self):
        rng = random.Random(2)
        for turn in range((6, 40, 400)[LEVEL]):
            data = bytearray(self.good)
            at = rng.randrange(len(data)) if turn % 3 else rng.randrange(min(len(data), 4096))
            data[at] ^= 1 << rng.randrange(8)
            self.resumes_from_the_older(bytes(data), f"a bit of byte {at}")

    def test_cut_short_anywhere(self):
        rng = random.Random(3)
        sizes = [0, 1, 511, 512, len(self.good) - 1] + [rng.randrange(len(self.good)) for _ in range((2, 15, 60)[LEVEL])]
        for size in sizes:
            self.resumes_from_the_older(self.good[:size], f"{size} bytes left")

    def test_grown_or_something_else(self):
        self.resumes_from_the_older(self.good + b"\0", "a byte too many")
        self.resumes_from_the_older(b"\0" * len(self.good), "zeros")
        self.resumes_from_the_older(b"not a checkpoint\n", "text")
        self.resumes_from_the_older(self.good.replace(b"cattaneo checkpoint ", b"cattaneo checkpoint 9", 1), "version")

    def test_with_no_good_one_nothing_is_changed_and_a_sentence_says_what_to_do(self):
        for path in (self.folder / "kept").glob("checkpoint_*.h5"):
            path.write_bytes(self.good[:1000])
        before = {p.name: p.read_bytes() for p in (self.folder / "kept").iterdir() if p.name not in ("log.txt", ".lock")}
        done = self.call("resume", "kept")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("none of its checkpoints can be gone on from", done.stderr)
        self.assertIn("cattaneo run --force", done.stderr)
        for name, data in before.items():
            self.assertTrue((self.folder / "kept" / name).read_bytes() == data, name)

    def test_of_another_scene(self):
        text = (self.folder / "kept/run.yaml").read_text()
        (self.folder / "kept/run.yaml").write_text(text.replace("dt: 0.02", "dt: 0.01"))
        done = self.call("resume", "kept")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("belongs to another scene", done.stderr)
        self.assertIn("run.yaml", done.stderr)
        (self.folder / "kept/run.yaml").write_text(text)
        self.assertEqual(self.call("resume", "kept").returncode, 0)
        self.compare(self.compared, "kept", "with run.yaml as it was")

    def test_of_the_other_precision(self):
        text = (self.folder / "kept/run.yaml").read_text()
        (self.folder / "kept/run.yaml").write_text(text.replace(", double\n", ", single\n"))
        done = self.call("resume", "kept")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"double precision.*--precision double")

    def test_metrics_with_a_half_line_or_gone(self):
        metrics = self.folder / "kept/metrics.csv"
        data = metrics.read_bytes()
        for change in (data[:-7], data + b"11,0.2", data[: len(data) // 2], b""):
            shutil.rmtree(self.folder / "d", ignore_errors=True)
            shutil.copytree(self.folder / "kept", self.folder / "d")
            (self.folder / "d/metrics.csv").write_bytes(change)
            done = self.call("resume", "d", "--threads", "1")
            if len(change) < len(data):
                self.assertIn(done.returncode, (0, 1), done.stderr)
            else:
                self.assertEqual(done.returncode, 0, done.stderr)
                self.compare(self.compared, "d", "a half line")


class Memory(Case):
    """The n-th allocation of a command fails: it says so with exit code 5, and what was there before is whole."""

    def deny(self, at, *words):
        witness = str(pathlib.Path(PROGRAM).parents[1] / "tests/cattaneo_witness")
        environment = {**os.environ, "GOMP_SPINCOUNT": "1000", "ALLOCATION_FAILS": str(at)}
        return subprocess.run([witness, *words], cwd=self.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=120, env=environment)

    def walk(self, words, prepare=lambda: None, after=lambda why: None):
        """Ever later allocations, until the command does not need as many."""
        at, failed = 1, 0
        while True:
            prepare()
            why = f"allocation {at} of {' '.join(words)}"
            done = self.deny(at, *words)
            if done.returncode == 0:
                self.assertGreater(failed, 0, why)
                return
            failed += 1
            self.assertEqual(done.returncode, 5, f"{why}: {done.stderr}")
            self.assertRegex(done.stderr, r"memory", why)
            after(why)
            at += (at + 1, at // 5 + 1, 1)[LEVEL]

    def test_run(self):
        whole = self.whole()
        self.walk(Disk.RUN, lambda: shutil.rmtree(self.folder / "d", ignore_errors=True),
                  lambda why: self.go_on(whole, "d", why))

    def test_resume(self):
        whole = self.whole()
        self.assertEqual(self.run_scene("half", "--steps", "12").returncode, 0)

        def half_way():
            shutil.rmtree(self.folder / "d", ignore_errors=True)
            shutil.copytree(self.folder / "half", self.folder / "d")

        self.walk(Disk.RESUME, half_way, lambda why: self.go_on(whole, "d", why, least=12))

    def test_commands_that_write_nothing(self):
        self.assertEqual(self.run_scene("d", "--steps", "2").returncode, 0)
        for words in (("check", "scene.yaml"), ("info", "d"), ("explain", "diffusion.k")):
            self.walk(words)

    def test_pictures(self):
        self.whole()
        self.walk(("render", "whole", "--size", "64x48", "-o", "x.png", "--threads", "1"))

    def test_sweep(self):
        words = ("sweep", "scene.yaml", "-o", "s", "--grid", "diffusion.tau=0.3,0.6", "--threads", "1", "-j", "1")
        for at in (3, 50, 200, 260):
            done = self.deny(at, *words, "--set", "time.end=0.04")
            self.assertIn(done.returncode, (0, 1, 5), f"allocation {at}: {done.stderr}")
            self.assertIn("memory" if done.returncode else "", done.stderr)
        done = self.call(*words, "--set", "time.end=0.04")
        self.assertEqual(done.returncode, 0, done.stderr)


class Limits(Case):
    """Address space in steps from what the program itself takes to what the run takes."""

    def under(self, size, *more):
        words = ("--force", "--set", "domain.cells=[400, 300]", "--set", "time.end=0.04", *more)
        return self.run_scene("d", *words, limit=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))

    def itself(self):
        """The least with which the program gets as far as saying its version, in steps of 1 MB."""
        low, high = 1, 4096
        while high - low > 1:
            size = (low + high) // 2
            done = self.call("--version", limit=lambda: resource.setrlimit(resource.RLIMIT_AS, (size << 20, size << 20)))
            low, high = (low, size) if done.returncode == 0 else (size, high)
        return high

    def test_any_address_space_ends_in_good_order(self):
        if "SANITIZED" in os.environ:
            self.skipTest("sanitizers take terabytes of it")
        least, codes = self.itself(), set()
        for more in range(1, 260, (37, 13, 2)[LEVEL]):
            for words in ((), ("--mem-limit", "1G"), ("--mem-limit", "1G", "--threads", "5")):
                done = self.under((least + more) << 20, *words)
                self.assertIn(done.returncode, (0, 5), f"{least} + {more} MB, {words}: {done.stderr}")
                if done.returncode == 5:
                    self.assertRegex(done.stderr, r"cattaneo: .*(memory|address space|limit)")
                codes.add(done.returncode)
        self.assertEqual(codes, {0, 5})

    def test_memory_is_refused_with_the_numbers(self):
        done = self.run_scene("d", "--set", "domain.cells=[400000, 300000]")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertRegex(done.stderr, r"the scene needs up to [0-9.e+]+ GB and there are [0-9.]+ GB for it")
        self.assertFalse((self.folder / "d").exists())


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    PROGRAM, SHIM = os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
    for level, option in ((STAGES, "--stages"), (ALL, "--all")):
        if option in sys.argv:
            sys.argv.remove(option)
            LEVEL = level
    result = unittest.main(exit=False).result
    sys.exit(0 if result.wasSuccessful() else 1)
