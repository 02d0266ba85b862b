/* SPDX-License-Identifier: MIT
 *
 * The table of commands.
 */
#include <string.h>

#include "app/command.h"
#include "base/param.h"

#define BIT(option) (1u << CF_OPTION_##option)

const cf_command cf_commands[] = {
    {"run", "SCENE.yaml", 1, 1,
     BIT(OUTPUT) | BIT(SET) | BIT(THREADS) | BIT(UNTIL) | BIT(STEPS) | BIT(WALL_LIMIT) | BIT(PRECISION) |
         BIT(PROGRESS) | BIT(MEM_LIMIT) | BIT(FORCE) | BIT(HELP),
     "run a scene; write its pictures and data into a folder",
     "The folder gets run.yaml (the scene with every default filled in), metrics.csv (a line a step), a file "
     "and "
     "a picture a frame, checkpoints, and log.txt. Its name is printed on stdout. A folder that holds a run "
     "is "
     "left alone unless --force is given.\n"
     "Ctrl-C, or a TERM or HUP signal, ends the run after the present step with a checkpoint, and "
     "--wall-limit "
     "does so in time; `resume` goes on from there as if nothing had been.\n"
     "  " CF_PROGRAM " run cone.yaml -o out/tau2 --set diffusion.tau=2",
     cf_run_command},
    {"resume", "DIR", 1, 1,
     BIT(UNTIL) | BIT(STEPS) | BIT(WALL_LIMIT) | BIT(THREADS) | BIT(PROGRESS) | BIT(MEM_LIMIT) | BIT(HELP),
     "go on with a run that was stopped, from its newest good checkpoint",
     "What was written after the checkpoint is cut and written again, to the same bits. Without a checkpoint "
     "the "
     "run starts again from its run.yaml. A run that is finished is left as it is.\n"
     "  " CF_PROGRAM " resume out/cone",
     cf_resume_command},
    {"check", "SCENE.yaml", 1, 1, BIT(SET) | BIT(HELP),
     "say everything about a scene that can be said before it runs",
     "Grid, memory, frames and steps; for every scalar its front speed, H_c, cone angle, band of waves, and "
     "how "
     "the step compares with tau; and warnings where a choice looks unlucky. Nothing is written.\n"
     "  " CF_PROGRAM " check cone.yaml --set time.dt=0.1",
     cf_check_command},
    {"explain", "[KEY]", 0, 1, BIT(HELP), "explain a key of the scene file, or all of them",
     "Type, unit, default, range, and what the key means.\n"
     "  " CF_PROGRAM " explain diffusion.tau",
     cf_explain_command},
    {"examples", "[NAME]", 0, 1, BIT(FORCE) | BIT(HELP), "list the examples, or copy one to a file to edit",
     "The copy is NAME.yaml in the present folder; a file that is there already is left alone unless --force "
     "is "
     "given.\n"
     "  " CF_PROGRAM " examples cone",
     cf_examples_command},
    {"sweep", "SCENE.yaml...", 1, 64,
     BIT(OUTPUT) | BIT(GRID) | BIT(SET) | BIT(JOBS) | BIT(THREADS) | BIT(UNTIL) | BIT(PRECISION) |
         BIT(PROGRESS) | BIT(COLUMNS) | BIT(FIELD) | BIT(FORCE) | BIT(HELP),
     "run all combinations of some values; make a table and a contact sheet",
     "Every combination of the values after --grid is a run in a folder of its own below DIR, named after "
     "them; "
     "with several scenes, all of that for each scene. table.csv has a line a run: the values, the exit "
     "code, and "
     "the last line of its metrics.csv. sheet.png shows the last frames in one scale, in rows of as many as "
     "the "
     "last grid has values (or --columns).\n"
     "The runs are processes of their own, --jobs at a time, and share the threads. Ctrl-C stops them with "
     "checkpoints. The same command again goes on: runs that are finished are kept, others resumed.\n"
     "  " CF_PROGRAM
     " sweep cone.yaml --grid diffusion.f_t=0,0.25,0.5,1 --grid diffusion.tau=1,4 -o out/cones",
     cf_sweep_command},
    {"sheet", "DIR...", 1, 1000, BIT(OUTPUT) | BIT(COLUMNS) | BIT(FIELD) | BIT(HELP),
     "put the last frames of several runs on one sheet",
     "One scale and one colour bar for all, each with the title of its scene. -o names the picture to write. "
     "The colours end where output.preview.range of all the scenes says; without one they follow from the "
     "values.\n"
     "  " CF_PROGRAM " sheet out/cones/* -o out/cones.png --columns 4",
     cf_sheet_command},
    {"render", "DIR...", 1, 64,
     BIT(OUTPUT) | BIT(STYLE) | BIT(FIELD) | BIT(FRAME) | BIT(SIZE) | BIT(COLUMNS) | BIT(SET) | BIT(THREADS) |
         BIT(HELP),
     "make a picture of a finished or running run",
     "Of its last frame, or of --frame; how it is shown says `render:` in its scene, or --style, and --set "
     "render.KEY=VALUE for every key there (`explain render`). Without -o the picture is "
     "DIR/render_<frame>.png. With several folders -o names one picture of all, in one scale.\n"
     "  " CF_PROGRAM " render out/ink --style smoke --set render.camera.turn=40 -o ink.png",
     cf_render_command},
    {"movie", "DIR", 1, 1,
     BIT(OUTPUT) | BIT(FPS) | BIT(STYLE) | BIT(FIELD) | BIT(SIZE) | BIT(SET) | BIT(THREADS) | BIT(PROGRESS) |
         BIT(HELP),
     "make a film of all frames of a run",
     "Pictures as `render` makes them, in one scale, written as H.264 by the program ffmpeg. Without -o the "
     "film "
     "is DIR/movie.mp4; it appears when it is whole.\n"
     "  " CF_PROGRAM " movie out/ink --fps 30",
     cf_movie_command},
    {"atlas", "RUN...", 1, 256, BIT(OUTPUT) | BIT(RADIUS) | BIT(PIXELS) | BIT(FORCE) | BIT(HELP),
     "make flakes for a snowfall of crystals that were grown in the plane",
     "The last frame of each run of model phase becomes a flake of the atlas DIR/atlas.json: what it weighs "
     "and measures, and beside it three pictures of 16 bits, of its colour and cover, its height, and its "
     "normals. Crystals have no size of their own: --radius gives them one. A scene of model snowfall names "
     "the atlas as snowfall.atlas.\n"
     "  " CF_PROGRAM " atlas out/star out/fern -o atlas --radius '2 mm'",
     cf_atlas_command},
    {"info", "FILE|DIR", 1, 1, BIT(HELP), "what a frame, a checkpoint or the folder of a run contains",
     "Scene, version and times; of every field the least and largest value, the sum and a checksum. Equal "
     "checksums, equal bits. Of a surface (.ply, .obj) also its size and whether it is closed; of a volume "
     "(.vdb) its grids.\n"
     "  " CF_PROGRAM " info out/cone",
     cf_info_command},
    {"bench", "[NAME]", 0, 1, BIT(JSON) | BIT(CELLS) | BIT(SIGMA) | BIT(THREADS) | BIT(HELP),
     "time this program on this machine: solver, table2, or both",
     "solver: linear systems, each solved several times from zero; the median, the residual computed afresh, "
     "and the share of the memory's measured bandwidth that the least possible traffic would take.\n"
     "table2: the cost table of the paper, its stages as this program has them.\n"
     "Other work on the machine shows in the numbers; they are for comparison within one run.\n"
     "  " CF_PROGRAM " bench solver --n 128,256 --sigma 0.25,16,inf --threads 2 --json",
     cf_bench_command},
    {"help", "[COMMAND]", 0, 1, BIT(MANUAL) | BIT(HELP), "what the program or one command does", "",
     cf_help_command},
    {.name = NULL},
};

const cf_command *cf_command_find(const char *name) {
  for (const cf_command *c = cf_commands; c->name != NULL; ++c)
    if (strcmp(c->name, name) == 0) return c;
  return NULL;
}

cf_status cf_command_unknown(const char *name) {
  const char *best = NULL;
  int least = -1;
  for (const cf_command *c = cf_commands; c->name != NULL; ++c) {
    const int distance = cf_param_distance(name, c->name);
    if (distance < 0 || (best != NULL && distance >= least)) continue;
    best = c->name;
    least = distance;
  }
  if (best != NULL) return cf_fail(CF_BAD_USAGE, "there is no command %.64s: did you mean %s?", name, best);
  const char *dot = strrchr(name, '.');
  if (dot != NULL && strcmp(dot, ".yaml") == 0)
    return cf_fail(CF_BAD_USAGE, "there is no command %.256s: did you mean `" CF_PROGRAM " run %.256s`?",
                   name, name);
  return cf_fail(CF_BAD_USAGE, "there is no command %.64s", name);
}
