/* SPDX-License-Identifier: MIT
 *
 * Reading the command line with getopt_long; see options.h.
 */
#define _GNU_SOURCE
#include "app/options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/param.h"
#include "base/real.h"
#include "base/units.h"
#include "io/folder.h"

const cf_option cf_option_table[CF_OPTIONS] = {
#define CF_OPTION_ROW(upper, name, letter, value, doc) {name, letter, value, doc},
    CF_OPTION_LIST(CF_OPTION_ROW)
#undef CF_OPTION_ROW
};

enum { THREADS_MAX = 1024, COLUMNS_MAX = 64, SIDE_MAX = 16384, PIXELS_MAX = 4096, LONG_ONLY = 256 };

/* --- values ----------------------------------------------------------------------------------------------- */

static cf_status read_whole(const char *name, const char *text, const long long most, long long *value) {
  char *end;
  errno = 0;
  *value = strtoll(text, &end, 10);
  if (end == text || *end != '\0' || errno != 0 || *value < 1 || *value > most)
    return cf_fail(CF_BAD_USAGE, "--%s %s: must be a whole number from 1 to %lld", name, text, most);
  return CF_OK;
}

static cf_status read_time(const char *name, const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  if (end == text || *end != '\0' || !isfinite(*value) || *value <= 0)
    return cf_fail(CF_BAD_USAGE, "--%s %s: must be a number above 0, in s", name, text);
  return CF_OK;
}

cf_status cf_size_read(const char *text, double *bytes) {
  static const char letters[] = "KMGT";
  char *end;
  *bytes = strtod(text, &end);
  bool good = end != text && isfinite(*bytes) && *bytes > 0;
  const char *letter = *end != '\0' ? strchr(letters, *end == 'k' ? 'K' : *end) : NULL;
  if (letter != NULL) {
    *bytes = ldexp(*bytes, 10 * (int)(letter - letters + 1));
    ++end;
    if (*end == 'i') ++end;
  }
  if (*end == 'B') ++end;
  good = good && *end == '\0' && *bytes >= 1 && isfinite(*bytes);
  if (!good)
    return cf_fail(CF_BAD_USAGE,
                   "%s: must be a number of bytes, or of K, M, G or T (powers of 1024), like 2G", text);
  return CF_OK;
}

/* A number above 0 with a unit that becomes `wanted`; a plain number has that unit. */
static bool read_quantity(const char *text, const char *wanted, double *value) {
  char *unit;
  cf_unit_change change = {1, 0};
  *value = strtod(text, &unit);
  bool good = unit != text;
  unit += strspn(unit, " ");
  if (good && *unit != '\0') good = cf_units_change(unit, wanted, &change) == CF_OK;
  *value *= change.scale;
  return good && isfinite(*value) && *value > 0;
}

cf_status cf_duration_read(const char *text, double *seconds) {
  if (read_quantity(text, "s", seconds)) return CF_OK;
  return cf_fail(CF_BAD_USAGE, "%s: must be a time above 0, like 3600, 90 min or 2h", text);
}

cf_status cf_length_read(const char *text, double *metres) {
  if (read_quantity(text, "m", metres)) return CF_OK;
  return cf_fail(CF_BAD_USAGE, "%s: must be a length above 0, like 1.5 mm or 2e-3 (m)", text);
}

static cf_status read_word(const char *name, const char *text, const char *words, int *index) {
  char near[64];
  *index = cf_param_word_index(words, text, strlen(text));
  if (*index >= 0) return CF_OK;
  if (cf_param_word_nearest(words, text, near, sizeof near))
    return cf_fail(CF_BAD_USAGE, "--%s %s: must be one of %s; did you mean %s?", name, text, words, near);
  return cf_fail(CF_BAD_USAGE, "--%s %s: must be one of %s", name, text, words);
}

static cf_status read_set(cf_arguments *a, const char *text) {
  const char *equals = strchr(text, '=');
  if (equals == NULL || equals == text)
    return cf_fail(CF_BAD_USAGE, "--set %s: must be KEY=VALUE, like diffusion.tau=2", text);
  a->set[a->sets++] = text;
  return CF_OK;
}

static cf_status read_grid(cf_arguments *a, const char *text) {
  const char *equals = strchr(text, '=');
  if (equals == NULL || equals == text || equals[1] == '\0')
    return cf_fail(CF_BAD_USAGE, "--grid %s: must be KEY=A,B,C, like diffusion.f_t=0,0.5,1", text);
  a->grid[a->grids++] = text;
  return CF_OK;
}

static cf_status read_size(cf_arguments *a, const char *text) {
  char cross, more;
  if (sscanf(text, "%5d%c%5d%c", &a->width, &cross, &a->height, &more) != 3 || cross != 'x' ||
      a->width < 16 || a->height < 16 || a->width > SIDE_MAX || a->height > SIDE_MAX)
    return cf_fail(CF_BAD_USAGE, "--size %s: must be like 1280x720, sides from 16 to %d", text, SIDE_MAX);
  return CF_OK;
}

static cf_status read_rate(const char *name, const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  if (end == text || *end != '\0' || !(*value > 0 && *value <= 1000))
    return cf_fail(CF_BAD_USAGE, "--%s %s: must be a number above 0 and at most 1000", name, text);
  return CF_OK;
}

/* Keeps the value of one option. */
static cf_status keep(cf_arguments *a, const int option, const char *value) {
  const cf_option *o = &cf_option_table[option];
  long long whole = 0;
  int word = 0;
  switch (option) {
    case CF_OPTION_OUTPUT:
      if (*value == '\0') return cf_fail(CF_BAD_USAGE, "-o: the name of the folder is empty");
      a->output = value;
      break;
    case CF_OPTION_SET:
      return read_set(a, value);
    case CF_OPTION_GRID:
      return read_grid(a, value);
    case CF_OPTION_JOBS:
      CF_TRY(read_whole(o->name, value, THREADS_MAX, &whole));
      a->jobs = (int)whole;
      break;
    case CF_OPTION_COLUMNS:
      CF_TRY(read_whole(o->name, value, COLUMNS_MAX, &whole));
      a->columns = (int)whole;
      break;
    case CF_OPTION_STYLE:
      a->style = value;
      break;
    case CF_OPTION_FRAME:
      a->frame = value;
      break;
    case CF_OPTION_SIZE:
      return read_size(a, value);
    case CF_OPTION_FPS:
      return read_rate(o->name, value, &a->fps);
    case CF_OPTION_RADIUS:
      if (cf_length_read(value, &a->radius) == CF_OK) break;
      return cf_fail(CF_BAD_USAGE, "--radius %s", cf_status_sentence());
    case CF_OPTION_PIXELS:
      CF_TRY(read_whole(o->name, value, PIXELS_MAX, &whole));
      a->pixels = (int)whole;
      break;
    case CF_OPTION_FIELD:
      a->field = value;
      break;
    case CF_OPTION_THREADS:
      CF_TRY(read_whole(o->name, value, THREADS_MAX, &whole));
      a->threads = (int)whole;
      break;
    case CF_OPTION_UNTIL:
      return read_time(o->name, value, &a->until);
    case CF_OPTION_STEPS:
      CF_TRY(read_whole(o->name, value, INT64_MAX, &whole));
      a->steps = whole;
      break;
    case CF_OPTION_PRECISION:
      CF_TRY(read_word(o->name, value, o->value, &word));
      a->other = (word == 0) != (sizeof(cf_real) == sizeof(float));
      break;
    case CF_OPTION_PROGRESS:
      CF_TRY(read_word(o->name, value, o->value, &word));
      a->progress = (cf_progress_kind)word;
      break;
    case CF_OPTION_MEM_LIMIT:
      if (cf_size_read(value, &a->memory) == CF_OK) break;
      return cf_fail(CF_BAD_USAGE, "--mem-limit %s", cf_status_sentence());
    case CF_OPTION_WALL_LIMIT:
      if (cf_duration_read(value, &a->seconds) == CF_OK) break;
      return cf_fail(CF_BAD_USAGE, "--wall-limit %s", cf_status_sentence());
    case CF_OPTION_JSON:
      a->json = true;
      break;
    case CF_OPTION_CELLS:
      a->cells = value;
      break;
    case CF_OPTION_SIGMA:
      a->sigmas = value;
      break;
    case CF_OPTION_FORCE:
      a->force = true;
      break;
    case CF_OPTION_MANUAL:
      a->manual = true;
      break;
    default:
      a->help = true;
  }
  return CF_OK;
}

/* --- the line --------------------------------------------------------------------------------------------- */

/* What getopt_long wants to know about the allowed options. */
typedef struct cf_grammar {
  char letters[2 * CF_OPTIONS + 2];
  struct option list[CF_OPTIONS + 1];
  int option[CF_OPTIONS]; /* of the rows of `list` */
} cf_grammar;

static void grammar_make(cf_grammar *g, const unsigned allowed) {
  int count = 0;
  char *letter = g->letters;
  *g = (cf_grammar){.letters = ""};
  *letter++ = ':'; /* a missing value is told from an unknown option */
  for (int i = 0; i < CF_OPTIONS; ++i) {
    const cf_option *o = &cf_option_table[i];
    if ((allowed >> i & 1) == 0) continue;
    g->list[count++] =
        (struct option){o->name, o->value != NULL ? required_argument : no_argument, NULL, LONG_ONLY + i};
    if (o->letter == 0) continue;
    *letter++ = o->letter;
    if (o->value != NULL) *letter++ = ':';
  }
}

static int option_of(const int code) {
  for (int i = 0; i < CF_OPTIONS; ++i)
    if (code == LONG_ONLY + i || (code < LONG_ONLY && code == cf_option_table[i].letter)) return i;
  return CF_OPTION_HELP;
}

/* An option that is not there, or that stands for several when cut short. */
static cf_status unknown(const char *command, const char *given, const unsigned allowed) {
  char name[64];
  const char *best = NULL;
  int least = -1, starts = 0;
  while (*given == '-') ++given;
  const size_t length = strcspn(given, "=");
  snprintf(name, sizeof name, "%.*s", (int)CF_MIN(length, sizeof name - 1), given);
  for (int i = 0; i < CF_OPTIONS; ++i) {
    if ((allowed >> i & 1) == 0) continue;
    const char *known = cf_option_table[i].name;
    if (length > 0 && strncmp(known, name, length) == 0) ++starts;
    const int distance = cf_param_distance(name, known);
    if (distance < 0 || (best != NULL && distance >= least)) continue;
    best = known;
    least = distance;
  }
  if (starts > 1)
    return cf_fail(CF_BAD_USAGE, "%s: --%s may mean several options: write more of it", command, name);
  if (best != NULL)
    return cf_fail(CF_BAD_USAGE, "%s: there is no option --%s: did you mean --%s?", command, name, best);
  return cf_fail(CF_BAD_USAGE, "%s: there is no option --%s", command, name);
}

/* What went wrong at the place where getopt_long stopped. */
static cf_status misused(const int code, const char *command, char *const *argv, const unsigned allowed) {
  if (code == ':') {
    const cf_option *o = &cf_option_table[option_of(optopt)];
    return cf_fail(CF_BAD_USAGE, "%s: --%s wants a value: %s", command, o->name, o->value);
  }
  if (optopt >= LONG_ONLY)
    return cf_fail(CF_BAD_USAGE, "%s: --%s takes no value", command, cf_option_table[option_of(optopt)].name);
  if (optopt != 0) return cf_fail(CF_BAD_USAGE, "%s: there is no option -%c", command, optopt);
  return unknown(command, argv[optind - 1], allowed);
}

static cf_status read_all(cf_arguments *a, const int argc, char **argv, const unsigned allowed) {
  cf_grammar g;
  grammar_make(&g, allowed);
  opterr = 0;
  optind = 0; /* start afresh */
  for (;;) {
    const int code = getopt_long(argc, argv, g.letters, g.list, NULL);
    if (code == -1) break;
    if (code == '?' || code == ':') return misused(code, argv[0], argv, allowed);
    CF_TRY(keep(a, option_of(code), optarg));
  }
  a->operands = argc - optind;
  a->operand = argv + optind;
  if (a->until > 0 && a->steps > 0)
    return cf_fail(CF_BAD_USAGE, "%s: --until and --steps exclude each other: give one of them", argv[0]);
  return CF_OK;
}

cf_status cf_arguments_read(cf_arguments *a, const int argc, char **argv, const unsigned allowed) {
  *a = (cf_arguments){.operands = 0};
  CF_TRY(CF_NEW(&a->set, 2 * argc));
  a->grid = a->set + argc;
  const cf_status status = read_all(a, argc, argv, allowed);
  if (status != CF_OK) cf_arguments_clear(a);
  return status;
}

void cf_arguments_clear(cf_arguments *a) {
  cf_free(a->set);
  a->set = a->grid = NULL;
}

cf_status cf_arguments_check_file(const cf_arguments *a, const char *ending) {
  const size_t length = a->output != NULL ? strlen(a->output) : 0, end = strlen(ending);
  if (a->output == NULL) return CF_OK;
  if (length > end && strcasecmp(a->output + length - end, ending) == 0) return cf_draft_try(a->output);
  return cf_fail(CF_BAD_USAGE, "-o %.200s: the name must end in %s, as what is written there", a->output,
                 ending);
}
