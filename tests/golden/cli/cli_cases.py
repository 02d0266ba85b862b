#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The command line from outside: exit codes, sentences, and that nothing half-written stays.

    cli_cases.py PROGRAM [NAME...]     PROGRAM: the double-precision program; its sister stands beside it
"""

import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = ""

SCENE = """\
cattaneo: 1
title: Ring
model: tracer
domain: {size: [1, 1], cells: [16, 16], walls: periodic}
time: {end: 1, dt: 1/20, frames: 5}
diffusion: {k: 0.01, tau: 0.5}
fields:
  phi: {initial: "exp(-50*((x-0.5)^2 + (y-0.5)^2))"}
"""


class Case(unittest.TestCase):
    """Each test runs in an empty folder of its own."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="cattaneo-cli-")
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def scene(self, text=SCENE, name="ring.yaml"):
        (self.folder / name).write_text(text)
        return name

    def call(self, *arguments, program=None, environment=None):
        return subprocess.run([program or PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=120, env=environment)

    def there(self):
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))

    def refuses(self, *arguments, says, code=2):
        """The call fails with `code` and one clear sentence, says nothing on stdout and writes nothing."""
        before = self.there()
        done = self.call(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.endswith("\n"), done.stderr)
        self.assertIn(says, done.stderr)
        self.assertEqual(self.there(), before)
        return done.stderr


class Help(Case):
    def test_no_command_prints_help_and_fails(self):
        done = self.call()
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("usage: cattaneo COMMAND", done.stderr)

    def test_help_goes_to_stdout(self):
        for words in (["--help"], ["-h"], ["help"]):
            done = self.call(*words)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for command in ("run", "resume", "check", "explain", "examples", "info"):
                self.assertIn(f"\n  {command} ", done.stdout)
            self.assertIn("130", done.stdout)

    def test_every_command_has_a_page_that_names_its_options(self):
        options = {
            "run": "output set threads until steps wall-limit precision progress mem-limit force",
            "resume": "until steps wall-limit threads progress mem-limit",
            "check": "set",
            "explain": "",
            "examples": "force",
            "info": "",
            "render": "output set columns field style frame size threads",
            "movie": "output set field style size fps threads progress",
            "atlas": "output radius pixels force",
        }
        for command, names in options.items():
            page = self.call("help", command)
            self.assertEqual((page.returncode, page.stderr), (0, ""))
            self.assertEqual(self.call(command, "--help").stdout, page.stdout)
            found = set(re.findall(r"^  (?:-., )?--([a-z-]+)", page.stdout, re.M))
            self.assertEqual(found, set(names.split()) | {"help"})

    def test_help_fits_into_eighty_columns(self):
        pages = [self.call("help", c).stdout for c in ("run", "resume", "check", "explain", "examples", "info")]
        for line in "".join(pages + [self.call("help").stdout]).splitlines():
            self.assertLessEqual(len(line), 80, line)

    def test_every_command_that_help_lists_has_a_page(self):
        listed = re.findall(r"^  ([a-z]+) ", self.call("help").stdout, re.M)
        self.assertGreater(len(listed), 6)
        for command in listed:
            page = self.call("help", command)
            self.assertEqual(page.returncode, 0)
            self.assertTrue(page.stdout.startswith(f"usage: cattaneo {command} "), page.stdout)

    def test_version_names_program_commit_and_precision(self):
        pattern = r"cattaneo \d+\.\d+\.\d+ \((unknown|[0-9a-f]{8,}\+?); (gcc|clang) .*, double\)\n"
        self.assertRegex(self.call("--version").stdout, pattern)
        sister = self.call("--version", program=PROGRAM + "f").stdout
        self.assertRegex(sister, r"cattaneof .*, single\)\n")

    def test_manual_page_has_every_option_of_run(self):
        page = self.call("help", "--manual").stdout.replace("\\-", "-")
        for word in (".TH CATTANEO 1", "--mem-limit SIZE", "--precision single|double", ".SH EXIT STATUS"):
            self.assertIn(word, page)


class Usage(Case):
    def test_unknown_command_suggests(self):
        self.refuses("rnu", "x.yaml", says="there is no command rnu: did you mean run?")
        self.refuses("chekc", says="did you mean check?")
        self.refuses("zzzzzz", says="there is no command zzzzzz\n")
        self.refuses("", says="there is no command")

    def test_a_scene_in_place_of_a_command_suggests_run(self):
        self.refuses("ink.yaml", says="did you mean `cattaneo run ink.yaml`?")

    def test_unknown_option_suggests(self):
        self.refuses("run", "x.yaml", "--treads", "2", says="there is no option --treads: did you mean --threads?")
        self.refuses("run", "x.yaml", "--qqqq", says="there is no option --qqqq\n")
        self.refuses("run", "x.yaml", "-q", says="there is no option -q")
        self.refuses("--versoin", says="there is no option --versoin")

    def test_an_option_of_another_command_is_unknown(self):
        self.refuses("resume", "d", "--force", says="there is no option --force")
        self.refuses("check", "x.yaml", "-o", "d", says="there is no option -o")

    def test_an_option_cut_short_must_be_clear(self):
        self.refuses("run", "x.yaml", "--s", "1", says="--s may mean several options")

    def test_missing_values_and_needless_ones(self):
        self.refuses("run", "x.yaml", "--threads", says="--threads wants a value: N")
        self.refuses("run", "x.yaml", "-o", says="--output wants a value: DIR")
        self.refuses("run", "x.yaml", "--force=3", says="--force takes no value")

    def test_operands_are_counted(self):
        self.refuses("run", says="run: SCENE.yaml is missing")
        self.refuses("resume", says="resume: DIR is missing")
        self.refuses("check", says="check: SCENE.yaml is missing")
        self.refuses("info", says="info: FILE|DIR is missing")
        self.refuses("run", "a.yaml", "b.yaml", says="b.yaml is one operand too many")

    def test_numbers_are_checked(self):
        for bad in ("0", "-1", "1.5", "two", "", "1e3", "99999999999999999999", "2x"):
            self.refuses("run", "x.yaml", "--threads", bad, says="must be a whole number from 1 to 1024")
            self.refuses("run", "x.yaml", "--steps", bad, says="must be a whole number from 1 to")
        for bad in ("0", "-1", "nan", "inf", "soon", "", "1s", "1e999"):
            self.refuses("run", "x.yaml", "--until", bad, says="must be a number above 0")
        for bad in ("0", "-1", "lots", "2X", "2GG", "", "nan", "1e999", "G"):
            self.refuses("run", "x.yaml", "--mem-limit", bad, says="must be a number of bytes")

        for bad in ("0", "-1", "soon", "", "2 kg", "nan", "1e999 s", "min"):
            self.refuses("run", "x.yaml", "--wall-limit", bad, says="must be a time above 0")

    def test_words_are_checked(self):
        self.refuses("run", "x.yaml", "--precision", "singel", says="did you mean single?")
        self.refuses("run", "x.yaml", "--progress", "yes", says="must be one of auto|plain|json|none")

    def test_until_and_steps_exclude_each_other(self):
        self.refuses("run", "x.yaml", "--until", "1", "--steps", "3", says="exclude each other")

    def test_set_wants_key_and_value(self):
        for bad in ("diffusion.tau", "=3", ""):
            self.refuses("run", self.scene(), "--set", bad, says="must be KEY=VALUE")

    def test_very_long_words_are_refused_in_good_order(self):
        word = "x" * 100000
        self.refuses(word, says="there is no command xxxx")
        self.refuses("run", "x.yaml", "--" + word, says="there is no option --xxxx")
        self.refuses("run", "x.yaml", "--threads", word, says="--threads xxxx")
        self.refuses("explain", word, says="x")
        self.refuses("examples", word, says="there is no example xxxx")

    def test_a_usage_error_says_where_to_look(self):
        said = self.refuses("run", "x.yaml", "--treads", "2", says="did you mean")
        self.assertTrue(said.endswith("try: cattaneo help run\n"))


class Scenes(Case):
    def test_a_scene_error_has_place_caret_and_code_2(self):
        name = self.scene(SCENE.replace("k: 0.01", "k: 1e-3 m/s"))
        said = self.refuses("run", name, says="ring.yaml:6:")
        self.assertIn("error: diffusion.k has unit m/s, expected m^2/s", said)
        self.assertIn("^", said)
        self.assertIn("try: cattaneo explain diffusion.k", said)
        self.refuses("check", name, says="ring.yaml:6:")

    def test_a_scene_that_is_not_there_is_named(self):
        self.refuses("run", "none.yaml", says="none.yaml")
        self.refuses("check", "none.yaml", says="none.yaml")
        self.refuses("run", ".", says=".")

    def test_what_is_no_file_is_never_waited_for(self):
        """A pipe that nobody writes to, a device without an end, a folder, by a name that a scene or a user gives."""
        here = str(self.folder)
        phase = self.scene("cattaneo: 1\nmodel: phase\ndomain: {size: [1, 1], cells: [16, 16]}\ntime: {end: 1}\n", "p.yaml")
        snow = self.scene("cattaneo: 1\nmodel: snowfall\ndomain: {size: [1, 1, 1], cells: [8, 8, 8]}\ntime: {end: 1}\n", "s.yaml")
        os.mkfifo(self.folder / "pipe")
        (self.folder / "run").mkdir()
        os.mkfifo(self.folder / "run/run.yaml")
        for ending in ("npy", "ply", "png"):
            for what in ("pipe", "zero", "folder"):
                to = {"pipe": f"{here}/pipe", "zero": "/dev/zero", "folder": here}[what]
                name = f"{what}.{ending}"
                (self.folder / name).symlink_to(to)
                words = ((phase, f"phase.maps.mask.file={name}") if ending == "png"
                         else (self.scene(), f"obstacles=[{{shape: file, file: {name}}}]"))
                self.refuses("check", words[0], "--set", words[1], says=f"{name}: is not a file")
        said = self.refuses("check", snow, "--set", "snowfall.atlas=pipe", says="pipe: is not a file")
        self.assertIn("cattaneo atlas", said)
        self.refuses("check", "pipe", says="this is not a file")
        self.refuses("info", "pipe.ply", says="is not a file", code=1)
        for name in ("pipe.h5", "pipe.vtkhdf"):
            (self.folder / name).symlink_to("pipe")
            self.refuses("info", name, says="is not a file", code=1)
        self.assertIn("this is not a file", self.call("resume", "run").stderr)

    def test_an_override_follows_the_same_path(self):
        self.refuses("run", self.scene(), "--set", "diffusion.tau=-1", says="diffusion.tau")
        self.refuses("run", self.scene(), "--set", "diffusion.tua=1", says="did you mean")

    def test_check_writes_nothing_and_answers_on_stdout(self):
        name = self.scene()
        done = self.call("check", name)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for word in ("16 x 16", "20 steps", "F_T = 0", "front speed", "dt/tau"):
            self.assertIn(word, done.stdout)
        self.assertEqual(self.there(), [name])

    def test_check_warns_of_unlucky_choices(self):
        name = self.scene()

        def warned(*values):
            words = [word for value in values for word in ("--set", value)]
            done = self.call("check", name, *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout.partition("\nwarnings\n")[2]

        self.assertEqual(warned(), "")
        self.assertIn("between frames", warned("time.dt=0.5"))
        self.assertIn("cells a step", warned("velocity=[20, 0]"))
        self.assertIn("get smeared", warned("diffusion.k=10", "diffusion.scheme=sdirk2"))
        self.assertIn("scheme paper", warned("diffusion.k=1", "diffusion.scheme=paper"))
        self.assertIn("Fourier's law", warned("diffusion.tau=1e-4"))
        self.assertIn("cells long", warned("diffusion.k=1e-6"))
        self.assertIn("this machine has", warned("domain.cells=[300000, 300000]"))

    def test_check_tells_the_regime(self):
        name = self.scene()

        def page(*values):
            return self.call("check", name, *[word for value in values for word in ("--set", value)]).stdout

        fast = page("diffusion.k=0.02", "diffusion.tau=0.5", "velocity=[0.4, 0]")
        self.assertRegex(fast, r"front speed +0\.2 m/s")
        self.assertRegex(fast, r"H_c +2: super-critical.*half-angle 30 degrees, seen over 0\.3 m")
        self.assertRegex(page("diffusion.k=0.02", "velocity=[0.1, 0]"), r"H_c +0\.5: sub-critical.*0\.1 m/s")
        self.assertIn("1: critical", page("diffusion.k=0.02", "velocity=[0.2, 0]"))
        self.assertIn("felt everywhere at once", page("diffusion.tau=0"))
        self.assertIn("fastest at", page("diffusion.f_t=0.3"))


class Pages(Case):
    def test_explain_knows_keys(self):
        done = self.call("explain", "diffusion.tau")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("Relaxation time", done.stdout)
        self.assertIn("domain.cells", self.call("explain").stdout)

    def test_explain_suggests(self):
        self.refuses("explain", "diffusion.tua", says="diffusion.tau")

    def test_examples_are_listed_and_copied_but_never_over_a_file(self):
        listing = self.call("examples")
        self.assertEqual((listing.returncode, listing.stderr), (0, ""))
        names = [line.split()[0] for line in listing.stdout.splitlines()]
        self.assertIn("cone", names)
        self.assertEqual(self.call("examples", "cone").stdout, "cone.yaml\n")
        first = (self.folder / "cone.yaml").read_text()
        (self.folder / "cone.yaml").write_text("mine")
        self.refuses("examples", "cone", says="cone.yaml is there already")
        self.assertEqual((self.folder / "cone.yaml").read_text(), "mine")
        self.assertEqual(self.call("examples", "cone", "--force").returncode, 0)
        self.assertEqual((self.folder / "cone.yaml").read_text(), first)

    def test_every_example_passes_check(self):
        for line in self.call("examples").stdout.splitlines():
            name = line.split()[0]
            self.call("examples", name)
            done = self.call("check", name + ".yaml")
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_examples_suggest(self):
        self.refuses("examples", "cnoe", says="did you mean cone?")

    def test_info_refuses_what_is_not_ours(self):
        self.refuses("info", "nowhere", says="nowhere", code=1)
        (self.folder / "empty").mkdir()
        self.refuses("info", "empty", says="empty: is not the folder of a run", code=1)
        self.refuses("info", self.scene(), says="ring.yaml", code=1)

    def test_a_full_disk_is_a_failure(self):
        if not pathlib.Path("/dev/full").exists():
            self.skipTest("there is no /dev/full")
        for words in (["help"], ["explain"], ["--version"], ["examples"], ["check", self.scene()]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([PROGRAM, *words], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("could not be written", done.stderr)


class Pictures(Case):
    def run_ring(self):
        self.call("run", self.scene(), "-o", "ring", "--progress", "none")

    def size(self, path):
        """Width and height as a PNG file says them."""
        head = (self.folder / path).read_bytes()[:24]
        self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
        return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")

    def test_render_names_the_picture_on_stdout_and_makes_only_that(self):
        self.run_ring()
        before = self.there()
        done = self.call("render", "ring")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "ring/render_000005.png\n", ""))
        self.assertEqual(sorted(set(self.there()) - set(before)), ["ring/render_000005.png"])
        wide, high = self.size("ring/render_000005.png")
        self.assertEqual(wide, 1280)
        self.assertLess(abs(high - wide), 60, "a square plane")

    def test_render_sets_how_it_is_shown_and_nothing_that_was_computed(self):
        self.run_ring()
        self.refuses("render", "ring", "--set", "domain.cells=[8, 8]", says="render and title alone")
        self.refuses("movie", "ring", "--set", "time.end=1", says="render and title alone")
        self.refuses("render", "ring", "--set", "render.stile=paper", says="did you mean")
        self.assertEqual(self.call("render", "ring", "--set", "title=Ring", "--set", "render.zoom=2").returncode, 2)
        self.assertEqual(self.call("render", "ring", "--set", "title=Ring").returncode, 0)

    def test_render_takes_frame_size_and_name(self):
        self.run_ring()
        done = self.call("render", "ring", "--frame", "2", "--size", "320x200", "-o", "two.png")
        self.assertEqual((done.returncode, done.stdout), (0, "two.png\n"), done.stderr)
        self.assertEqual(self.size("two.png"), (320, 200))

    def test_pictures_are_the_same_bytes_for_any_number_of_threads(self):
        self.run_ring()
        for threads in ("1", "3"):
            self.call("render", "ring", "--size", "300x200", "--threads", threads, "-o", f"{threads}.png")
        self.assertEqual((self.folder / "1.png").read_bytes(), (self.folder / "3.png").read_bytes())

    def test_render_refuses_what_it_cannot_show(self):
        self.run_ring()
        self.refuses("render", "nowhere", says="nowhere", code=1)
        self.refuses("render", "ring", "--frame", "9", says="the first is 0 and the last 5")
        self.refuses("render", "ring", "--style", "inc", says="did you mean ink?")
        self.refuses("render", "ring", "--field", "ph", says="phi")
        self.refuses("render", "ring", "--size", "9x", says="--size")
        before = (self.folder / "ring/run.yaml").read_bytes()
        for words in (("render", "ring"), ("sheet", "ring", "ring"), ("movie", "ring")):
            self.refuses(*words, "-o", "ring/run.yaml", says="the name must end in .")
        self.assertEqual((self.folder / "ring/run.yaml").read_bytes(), before)

    def test_a_movie_is_whole_or_not_there(self):
        self.run_ring()
        self.refuses("movie", "ring", "--fps", "0", says="--fps")
        nothing = {**os.environ, "PATH": str(self.folder)}
        done = self.call("movie", "ring", environment=nothing)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("ffmpeg", done.stderr)
        self.assertFalse((self.folder / "ring/movie.mp4").exists())
        if shutil.which("ffmpeg"):
            done = self.call("movie", "ring", "--size", "160x120", "--progress", "none")
            self.assertEqual((done.returncode, done.stdout), (0, "ring/movie.mp4\n"), done.stderr)
            self.assertIn(b"ftyp", (self.folder / "ring/movie.mp4").read_bytes()[:12])

    def test_where_nothing_can_be_written_is_told_before_the_work(self):
        self.run_ring()
        for name in ("folder.png", "folder.mp4"):
            (self.folder / name).mkdir()
        for words in (("render", "ring", "-o", "{}.png"), ("movie", "ring", "-o", "{}.mp4"),
                      ("sheet", "ring", "ring", "-o", "{}.png")):
            for place, says in (("folder", "it is a folder"), ("nowhere/x", "No such file or directory")):
                said = self.refuses(*[word.format(place) for word in words], says=says, code=1)
                self.assertEqual(len(said.splitlines()), 1, said)  # no frame was drawn

    def test_an_ffmpeg_that_does_not_start_is_not_called_missing(self):
        self.run_ring()
        (self.folder / "ffmpeg").write_text("no program")
        done = self.call("movie", "ring", environment={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "ffmpeg.* cannot be started: .*Permission denied")

    def test_an_atlas_is_made_of_crystals(self):
        self.run_ring()
        self.refuses("atlas", "ring", says="-o DIR is missing")
        self.refuses("atlas", "ring", "-o", "atlas", says="is no run of model phase")
        self.refuses("atlas", "ring", "-o", "atlas", "--radius", "2 s", says="must be a length above 0")


class Runs(Case):
    def test_run_names_its_folder_on_stdout_and_only_that(self):
        done = self.call("run", self.scene())
        self.assertEqual((done.returncode, done.stdout), (0, "out/ring\n"), done.stderr)
        self.assertIn("done: step 20", done.stderr)
        self.assertTrue((self.folder / "out/ring/run.yaml").exists())
        self.assertEqual(self.call("info", "out/ring").returncode, 0)

    def test_a_run_is_never_overwritten_unforced(self):
        name = self.scene()
        self.assertEqual(self.call("run", name, "-o", "d", "--progress", "none").returncode, 0)
        kept = {str(p): p.read_bytes() for p in (self.folder / "d").iterdir() if p.name != ".lock"}
        self.refuses("run", name, "-o", "d", says="--force")
        for p, bytes_then in kept.items():
            self.assertTrue(pathlib.Path(p).read_bytes() == bytes_then, p)
        self.assertEqual(self.call("run", name, "-o", "d", "--force").returncode, 0)

    def test_progress_none_shows_no_progress(self):
        done = self.call("run", self.scene(), "--progress", "none")
        self.assertEqual((done.returncode, done.stdout), (0, "out/ring\n"))
        self.assertEqual(done.stderr, "")

    def test_progress_json_is_one_object_a_line(self):
        done = self.call("run", self.scene(), "--progress", "json", "-o", 'a "b"')
        events = [json.loads(line) for line in done.stderr.splitlines()]
        steps = [e for e in events if e["event"] == "progress"]
        self.assertEqual(steps[-1]["step"], 20)
        self.assertTrue(steps[-1]["finished"])
        self.assertEqual({"time", "end", "dt", "seconds", "left", "frame", "frames", "iterations"} - set(steps[0]), set())
        self.assertEqual(events[-1]["event"], "done")

    def test_progress_json_tells_failures_too(self):
        done = self.call("run", "none.yaml", "--progress", "json")
        self.assertEqual(done.returncode, 2)
        self.assertEqual([json.loads(line)["event"] for line in done.stderr.splitlines()], ["failed"])

    def test_steps_pause_and_resume_gives_the_bytes_of_one_run(self):
        name = self.scene()
        done = self.call("run", name, "-o", "in two", "--steps", "7")
        self.assertEqual(done.returncode, 0)
        self.assertIn("go on with: cattaneo resume 'in two'", done.stderr)
        done = self.call("resume", "in two")
        self.assertEqual((done.returncode, done.stdout), (0, "in two\n"), done.stderr)
        self.assertEqual(self.call("run", name, "-o", "one").returncode, 0)
        for p in sorted((self.folder / "one").iterdir()):
            if p.name not in ("log.txt", ".lock"):
                self.assertTrue(p.read_bytes() == (self.folder / "in two" / p.name).read_bytes(), p.name)

    def test_a_time_that_is_past_is_told_and_one_beyond_the_end_is_the_end(self):
        self.call("run", self.scene(), "-o", "d", "--steps", "7", "--progress", "none")
        done = self.call("resume", "d", "--until", "0.01")
        self.assertEqual((done.returncode, done.stdout), (0, "d\n"), done.stderr)
        self.assertIn("nothing to compute: t = 0.35 s is not before the 0.01 s", done.stderr)
        self.assertNotIn("steps/s", done.stderr)
        done = self.call("resume", "d", "--until", "100")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("of 100 s", done.stderr)
        self.assertIn("t = 1 of 1 s", done.stderr)

    def test_what_is_to_be_typed_can_be_pasted(self):
        name, folder = self.scene(), "it's my run"
        for words in (("--steps", "3"), (), ("--force", "--wall-limit", "1 ms")):
            done = self.call("run", name, "-o", folder, "--progress", "none" if "--force" in words else "plain", *words)
            self.assertIn("cattaneo resume 'it'\\''s my run'", done.stderr)

    def test_resume_of_a_finished_run_says_so(self):
        self.call("run", self.scene(), "-o", "d")
        done = self.call("resume", "d")
        self.assertEqual((done.returncode, done.stdout), (0, "d\n"))
        self.assertIn("finished already", done.stderr)

    def test_resume_refuses_what_is_no_run(self):
        self.refuses("resume", "nowhere", says="nowhere", code=1)
        (self.folder / "empty").mkdir()
        self.refuses("resume", "empty", says="run.yaml", code=1)

    def test_the_other_precision_runs_the_sister_and_resumes_with_it(self):
        done = self.call("run", self.scene(), "-o", "d", "--precision", "single", "--steps", "7")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("single", (self.folder / "d/run.yaml").read_text().split("cattaneo: 1")[0])
        done = self.call("resume", "d")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.call("run", self.scene(), "-o", "e", "--precision", "double", program=PROGRAM + "f")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("double", (self.folder / "e/run.yaml").read_text().split("cattaneo: 1")[0])

    def test_a_missing_sister_is_named(self):
        lonely = self.folder / "cattaneo"
        lonely.write_bytes(pathlib.Path(PROGRAM).read_bytes())
        lonely.chmod(0o755)
        done = self.call("run", self.scene(), "--precision", "single", program=str(lonely))
        self.assertEqual(done.returncode, 1)
        self.assertIn("cattaneof", done.stderr)

    def test_a_program_of_another_name_starts_itself_again(self):
        """Where nobody says how threads wait, a run starts its own file once more, not what is called cattaneo."""
        mine, other = self.folder / "mine", self.folder / "cattaneo"
        mine.write_bytes(pathlib.Path(PROGRAM).read_bytes())
        other.write_text("#!/bin/sh\nexit 77\n")
        mine.chmod(0o755)
        other.chmod(0o755)
        quiet = {k: v for k, v in os.environ.items() if k not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
        done = self.call("run", self.scene(), "-o", "d", "--steps", "3", program=str(mine), environment=quiet)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.call("resume", "d", program=str(mine), environment=quiet)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_memory_limit_is_code_5_and_leaves_nothing(self):
        self.refuses("run", self.scene(), "--mem-limit", "1M", says="limit", code=5)

    def test_an_output_folder_that_cannot_be_is_code_1(self):
        (self.folder / "file").write_text("")
        self.refuses("run", self.scene(), "-o", "file/d", says="file", code=1)

    def test_threads_do_not_change_the_bytes(self):
        name = self.scene()
        for threads in ("1", "2", "3"):
            self.assertEqual(self.call("run", name, "-o", threads, "--threads", threads).returncode, 0)
        one = (self.folder / "1/metrics.csv").read_bytes()
        self.assertEqual((self.folder / "2/metrics.csv").read_bytes(), one)
        self.assertEqual((self.folder / "3/metrics.csv").read_bytes(), one)

    def test_a_stop_writes_a_checkpoint_and_is_code_130(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            name = self.scene(SCENE.replace("end: 1,", "end: 100000,").replace("frames: 5", "frames: 0"))
            folder = self.folder / number.name
            run = subprocess.Popen([PROGRAM, "run", name, "-o", number.name], cwd=self.folder, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            metrics = folder / "metrics.csv"
            for _ in range(600):
                if metrics.exists() and len(metrics.read_bytes().splitlines()) > 5:
                    break
                time.sleep(0.05)
            run.send_signal(number)
            out, said = run.communicate(timeout=60)
            self.assertEqual(run.returncode, 130, said)
            self.assertEqual(out, "")
            self.assertEqual(said.count("go on with: cattaneo resume"), 1, said)
            self.assertTrue(list(folder.glob("checkpoint_*.h5")))
            again = self.call("resume", number.name, "--until", "1e-9")
            self.assertEqual(again.returncode, 0, again.stderr)

    def test_a_wall_limit_ends_a_run_in_time_with_a_checkpoint(self):
        for frames in ("frames: 0", "frames: 0.1"):
            name = self.scene(SCENE.replace("end: 1,", "end: 100000,").replace("frames: 5", frames))
            began = time.monotonic()
            done = self.call("run", name, "-o", "d", "--wall-limit", "1 s", "--progress", "none", "--force")
            self.assertEqual((done.returncode, done.stdout), (130, ""), done.stderr)
            self.assertLess(time.monotonic() - began, 60)  # it ends at all; how soon, a busy machine decides
            self.assertRegex(done.stderr, r"^the time limit is reached: stopped at step \d+ .*cattaneo resume d\n$")
            self.assertTrue(list((self.folder / "d").glob("checkpoint_*.h5")))
            self.assertEqual(self.call("resume", "d", "--wall-limit", "1 ms").returncode, 130)

    def test_what_is_said_into_closed_streams_is_in_no_file(self):
        def close():
            for stream in (0, 1, 2):
                os.close(stream)

        name = self.scene()
        self.assertEqual(self.call("run", name, "-o", "open").returncode, 0)
        run = subprocess.Popen([PROGRAM, "run", name, "-o", "closed", "--progress", "plain"], cwd=self.folder,
                               preexec_fn=close)
        self.assertEqual(run.wait(timeout=60), 1)  # the name of the folder could not be told
        for p in (self.folder / "open").iterdir():
            if p.name not in ("log.txt", ".lock"):
                self.assertTrue(p.read_bytes() == (self.folder / "closed" / p.name).read_bytes(), p.name)

    def test_a_limit_on_the_size_of_files_is_told_like_a_full_disk(self):
        done = subprocess.run([PROGRAM, "run", self.scene(), "-o", "d", "--progress", "none"], cwd=self.folder,
                              capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=60,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"^cattaneo: d/fields_000000.vtkhdf: .*: File too large")

    def test_a_closed_pipe_does_not_end_a_run(self):
        run = subprocess.Popen([PROGRAM, "run", self.scene(), "-o", "d", "--progress", "plain"], cwd=self.folder,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        run.stderr.close()
        self.assertEqual(run.wait(timeout=60), 0)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
