/* SPDX-License-Identifier: MIT
 *
 * The options of the program, each once: the row below gives the parser its name, the help and the manual page
 * their line, and "did you mean" its candidates. A command names those it takes (app/command.h).
 *
 * Numbers are checked here as far as they can be without a scene.
 */
#ifndef CF_APP_OPTIONS_H
#define CF_APP_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"

/* O(UPPER, long name, letter or 0, value or NULL for a flag, meaning) */
/* clang-format off */
#define CF_OPTION_LIST(O)                                                                                     \
  O(OUTPUT, "output", 'o', "DIR", "the folder to write; left out: out/<name of the scene file>")              \
  O(SET, "set", 0, "KEY=VALUE", "goes before what the scene says, for example diffusion.tau=2; may be repeated") \
  O(GRID, "grid", 0, "KEY=A,B,C", "a key and the values it takes in turn; may be repeated, for all combinations")  \
  O(JOBS, "jobs", 'j', "N", "runs at the same time; left out: one a processor; they share the threads")       \
  O(COLUMNS, "columns", 0, "N", "pictures in a row of the sheet")                                             \
  O(FIELD, "field", 0, "NAME", "the field in the pictures; left out: that of the previews")                   \
  O(STYLE, "style", 0, "NAME", "how it is shown: field, ink, smoke, crystal, coral, mesh, gel, particles, cards") \
  O(FRAME, "frame", 0, "N|last|all", "which frame; left out: the last")                                       \
  O(SIZE, "size", 0, "WxH", "width and height of the picture in pixels; left out: render.size of the scene")  \
  O(FPS, "fps", 0, "F", "frames a second; left out: 24")                                                      \
  O(RADIUS, "radius", 0, "LENGTH", "what the radius of a crystal becomes: 1.5 mm, 2e-3 (m); left out: 1.5 mm")  \
  O(PIXELS, "pixels", 0, "N", "sides of the pictures of a flake; left out: 256")                              \
  O(THREADS, "threads", 0, "N", "threads to use; left out: one a processor; the results are the same bits")   \
  O(UNTIL, "until", 0, "T", "stop at this simulated time, in s")                                              \
  O(STEPS, "steps", 0, "N", "stop after so many steps")                                                       \
  O(WALL_LIMIT, "wall-limit", 0, "TIME",                                                                      \
    "stop, with a checkpoint and exit code 130, before so much time of the clock has passed: 90 min, 2h, 3600") \
  O(PRECISION, "precision", 0, "single|double", "the precision of the fields; the sister program runs if need be") \
  O(PROGRESS, "progress", 0, "auto|plain|json|none",                                                          \
    "how progress is shown on stderr: auto is one line that is rewritten on a terminal and plain elsewhere; " \
    "json is one object a line")                                                                              \
  O(MEM_LIMIT, "mem-limit", 0, "SIZE", "refuse a run that may need more memory: 512M, 2G (powers of 1024)")   \
  O(JSON, "json", 0, NULL, "one JSON object a row instead of a table")                                        \
  O(CELLS, "n", 0, "N,...", "extents instead of the default set: 256 is 256x256x256; others like 1024x1024")  \
  O(SIGMA, "sigma", 0, "S,...", "values of sigma = beta/(alpha h^2) instead of the default set; inf is Poisson") \
  O(FORCE, "force", 0, NULL, "overwrite what is there")                                                       \
  O(MANUAL, "manual", 0, NULL, "print the manual page, for man(1)")                                           \
  O(HELP, "help", 'h', NULL, "what the command does and takes")
/* clang-format on */

enum {
#define CF_OPTION_ENUM(upper, name, letter, value, doc) CF_OPTION_##upper,
  CF_OPTION_LIST(CF_OPTION_ENUM)
#undef CF_OPTION_ENUM
      CF_OPTIONS
};

typedef struct cf_option {
  const char *name;
  char letter;
  const char *value, *doc;
} cf_option;
extern const cf_option cf_option_table[CF_OPTIONS];

typedef enum cf_progress_kind {
  CF_PROGRESS_AUTO,
  CF_PROGRESS_PLAIN,
  CF_PROGRESS_JSON,
  CF_PROGRESS_NONE
} cf_progress_kind;

/* What a command was called with. Texts belong to the caller of cf_arguments_read. */
typedef struct cf_arguments {
  int operands;
  char **operand;
  const char *output;
  int sets;
  const char **set;
  int grids;
  const char **grid;
  int jobs, columns; /* 0: not given */
  const char *field, *style, *frame;
  int width, height;          /* of a picture, pixels; 0: not given */
  double fps;                 /* 0: not given */
  double radius;              /* of a flake, m; 0: not given */
  int pixels;                 /* of its pictures; 0: not given */
  const char *cells, *sigmas; /* lists as given, or NULL */
  int threads;                /* 0: not given */
  double until;               /* s; 0: not given */
  int64_t steps;              /* 0: not given */
  double memory;              /* bytes; 0: not given */
  double seconds;             /* of the clock; 0: not given */
  bool other;                 /* the other precision than this program's is asked for */
  bool force, json, manual, help;
  cf_progress_kind progress;
  char **argv; /* of the whole program */
  bool told;   /* the command has said itself why it failed */
} cf_arguments;

/* Reads what follows the name of a command: argv[0] is that name, `allowed` the bits 1 << CF_OPTION_... that
 * it takes. Operands are moved behind the options. CF_BAD_USAGE. */
cf_status cf_arguments_read(cf_arguments *a, int argc, char **argv, unsigned allowed);
void cf_arguments_clear(cf_arguments *a);

/* That the file to write, where -o names one, ends as what is written there does (".png"): a slip of the hand would else
 * write over a scene. CF_BAD_USAGE. */
cf_status cf_arguments_check_file(const cf_arguments *a, const char *ending);

/* "90 min" in s; a plain number is in s. CF_BAD_USAGE. */
cf_status cf_duration_read(const char *text, double *seconds);

/* "1.5 mm" in m; a plain number is in m. CF_BAD_USAGE. */
cf_status cf_length_read(const char *text, double *metres);

/* "512M" in bytes. CF_BAD_USAGE. */
cf_status cf_size_read(const char *text, double *bytes);

#endif
