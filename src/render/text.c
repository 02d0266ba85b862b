/* SPDX-License-Identifier: MIT
 *
 * Setting a line of text: which glyph stands where (raised, lowered, accented), and its strokes into a mask.
 *
 * At small sizes every letter begins on a whole pixel, and the heights that matter (foot, baseline, x, capital) fall on
 * pixel centres, so that bars are sharp.
 */
#include "render/text.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/real.h"
#include "render/alphabet.h"
#include "render/mask.h"

#define EM             14.0 /* units from the foot of a p to the top of an l, and a little */
#define SMALL          26.0 /* pixels: above this nothing is aligned to pixels */
#define WEIGHT         1.18 /* stroke width in units */
#define SCRIPT_SIZE    0.72 /* of raised and lowered letters */
#define RAISED         4.4  /* units */
#define LOWERED        (-2.2)
#define SCRIPT_LETTERS 3 /* H_max is lowered, the_maximum is a name */

/* --- reading ------------------------------------------------------------------------------------------------- */

typedef struct reader {
  const char *at;
  const char *end; /* of a raised or lowered stretch; NULL outside */
  int level;       /* 1 raised, -1 lowered */
  uint32_t before[2];
} reader;

/* One character of UTF-8; what is none counts as a sign we do not have. */
static uint32_t decode(const char **at) {
  const unsigned char *s = (const unsigned char *)*at;
  const int more = s[0] < 0x80 ? 0 : s[0] >= 0xf0 ? 3 : s[0] >= 0xe0 ? 2 : s[0] >= 0xc0 ? 1 : -1;
  uint32_t code = more == 3 ? s[0] & 7u : more == 2 ? s[0] & 15u : more == 1 ? s[0] & 31u : s[0];
  ++*at;
  if (more < 0) return 0xfffd;
  for (int i = 1; i <= more; ++i) {
    if ((s[i] & 0xc0) != 0x80) return 0xfffd;
    code = code << 6 | (s[i] & 63u);
  }
  *at += more;
  return code;
}

static bool is_letter(const uint32_t c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= 0x370 && c < 0x400);
}

static bool is_digit(const uint32_t c) { return c >= '0' && c <= '9'; }

/* Whether a raised or lowered stretch begins behind the mark at r->at; then r stands at its first character. */
static bool begin_script(reader *r, const char mark) {
  const char *from = r->at + 1, *to = from;
  const bool braces = *from == '{';
  const bool single =
      is_letter(r->before[0]) && !is_letter(r->before[1]) && !is_digit(r->before[1]) && r->before[1] != '_';
  if (mark == '_' && !single) return false;
  if (braces) {
    to = strchr(++from, '}');
    if (to == NULL) return false;
  } else if (mark == '^') {
    if (*to == '-' || *to == '+') ++to;
    const char *digits = to;
    while (is_digit((unsigned char)*to)) ++to;
    if (to == digits) return false;
  } else {
    while (is_letter((unsigned char)*to) || is_digit((unsigned char)*to)) ++to;
    if (to == from || to - from > SCRIPT_LETTERS || *to == '_') return false;
  }
  r->at = from;
  r->end = to;
  r->level = mark == '^' ? 1 : -1;
  return true;
}

/* Unicode's own raised and lowered digits. */
static uint32_t plain_digit(const uint32_t code, int *level) {
  static const uint32_t raised[][2] = {{0xb9, '1'},   {0xb2, '2'},      {0xb3, '3'},
                                       {0x2070, '0'}, {0x207b, 0x2212}, {0x207a, '+'}};
  for (size_t i = 0; i < sizeof raised / sizeof raised[0]; ++i)
    if (raised[i][0] == code) {
      *level = 1;
      return raised[i][1];
    }
  if (code < 0x2074 || code > 0x2089 || (code > 0x2079 && code < 0x2080)) return code;
  *level = code < 0x2080 ? 1 : -1;
  return '0' + (code & 15);
}

static bool read_next(reader *r, uint32_t *code, int *level) {
  if (r->end != NULL && r->at >= r->end) {
    if (*r->at == '}') ++r->at;
    r->end = NULL;
    r->level = 0;
  }
  if (*r->at == '\0') return false;
  if (r->end == NULL && (*r->at == '^' || *r->at == '_')) begin_script(r, *r->at);
  if (r->end != NULL && r->at >= r->end) return read_next(r, code, level); /* empty braces */
  *level = r->level;
  *code = plain_digit(decode(&r->at), level);
  if (*code == '-' && *level != 0) *code = 0x2212;
  r->before[1] = r->before[0];
  r->before[0] = *code;
  return true;
}

/* --- placing ------------------------------------------------------------------------------------------------- */

typedef struct setting {
  double scale; /* pixels a unit */
  bool aligned;
  double x, y; /* of the baseline's start */
  bool upward;
  cf_mask *mask;
  double width; /* of a stroke, pixels */
  double apart; /* more room between letters, units */
} setting;

typedef struct placed {
  double along;       /* pixels from the start of the text */
  double scale, rise; /* pixels a unit, pixels above the baseline */
  const setting *set;
} placed;

/* Heights that matter go to whole pixels, those between are stretched. */
static double aligned_height(const double y, const double scale) {
  static const double marks[] = {-3, 0, 7, 10};
  int i = 0;
  while (i < 2 && y > marks[i + 1]) ++i;
  const double low = round(scale * marks[i]), high = round(scale * marks[i + 1]);
  return low + (high - low) * (y - marks[i]) / (marks[i + 1] - marks[i]);
}

/* A point of a glyph on the canvas. */
static void locate(const placed *p, const double x, const double y, double at[2]) {
  const setting *s = p->set;
  const double along = p->along + p->scale * x;
  const double above =
      p->rise + (s->aligned && p->scale == s->scale ? aligned_height(y, p->scale) : p->scale * y);
  at[0] = s->upward ? s->x - above - 0.5 : s->x + along + 0.5;
  at[1] = s->upward ? s->y - along - 0.5 : s->y - above - 0.5;
}

/* --- drawing ------------------------------------------------------------------------------------------------- */

typedef struct pen_at {
  const placed *place;
  double shift; /* of the glyph's x, units */
  double x, y;  /* where the pen is */
  bool down;    /* it has touched the paper since the last M */
} pen_at;

static void line_to(pen_at *p, const double x, const double y) {
  double a[2], b[2];
  locate(p->place, p->x + p->shift, p->y, a);
  locate(p->place, x + p->shift, y, b);
  if (p->down) cf_mask_stroke(p->place->set->mask, a, b, p->place->set->width);
  p->x = x, p->y = y, p->down = true;
}

static void cubic_to(pen_at *p, const double c[6]) {
  const double x = p->x, y = p->y;
  const int pieces = 10;
  for (int i = 1; i <= pieces; ++i) {
    const double s = (double)i / pieces, r = 1 - s;
    const double w0 = r * r * r, w1 = 3 * r * r * s, w2 = 3 * r * s * s, w3 = s * s * s;
    line_to(p, w0 * x + w1 * c[0] + w2 * c[2] + w3 * c[4], w0 * y + w1 * c[1] + w2 * c[3] + w3 * c[5]);
  }
}

static void arc_to(pen_at *p, const double c[6]) {
  const int pieces = 28;
  for (int i = 0; i <= pieces; ++i) {
    const double angle = (c[4] + (c[5] - c[4]) * i / pieces) * 3.14159265358979323846 / 180;
    line_to(p, c[0] + c[2] * cos(angle), c[1] + c[3] * sin(angle));
  }
}

static void dot_at(pen_at *p, const double x, const double y) {
  double at[2];
  locate(p->place, x + p->shift, y, at);
  cf_mask_stroke(p->place->set->mask, at, at, 1.45 * p->place->set->width);
  p->down = false;
}

/* Paths are ours: plain decimal numbers, whatever the locale. */
static double read_number(const char **at) {
  const double sign = **at == '-' ? -1 : 1;
  double value = 0, unit = 1;
  if (**at == '-') ++*at;
  for (; is_digit((unsigned char)**at); ++*at) value = 10 * value + (**at - '0');
  if (**at == '.')
    for (++*at; is_digit((unsigned char)**at); ++*at) value += (unit /= 10) * (**at - '0');
  return sign * value;
}

static int read_numbers(const char **at, const int most, double *values) {
  int count = 0;
  while (count < most) {
    while (**at == ' ') ++*at;
    if (!is_digit((unsigned char)**at) && **at != '-' && **at != '.') break;
    values[count++] = read_number(at);
  }
  return count;
}

static void draw_path(const placed *place, const double shift, const char *path) {
  pen_at pen = {.place = place, .shift = shift};
  double v[6];
  for (char word = ' '; *path != '\0';) {
    if (*path == ' ') {
      ++path;
      continue;
    }
    if (*path >= 'A' && *path <= 'Z') word = *path++;
    const int wanted = word == 'C' || word == 'A' ? 6 : word == 'O' ? 4 : 2;
    if (word == 'M' || word == 'O') pen.down = false;
    if (word == 'M') word = 'L';
    if (read_numbers(&path, wanted, v) != wanted) return;
    if (word == 'L') line_to(&pen, v[0], v[1]);
    if (word == 'C') cubic_to(&pen, v);
    if (word == 'A') arc_to(&pen, v);
    if (word == 'O') arc_to(&pen, (double[6]){v[0], v[1], v[2], v[3], 0, 360});
    if (word == 'D') dot_at(&pen, v[0], v[1]);
  }
}

/* Accents are drawn for small letters; they stand higher on capitals. */
static void draw_accent(const placed *p, const cf_glyph *g, const uint32_t code, const uint32_t accent) {
  placed above = *p;
  if (code < 'a' && accent != 0x327) above.rise += 3 * p->scale;
  draw_path(&above, g->left + g->width / 2, cf_alphabet_find(accent)->path);
}

/* Sets the text from the start of the setting; returns the pixels it advances. Draws if there is a mask. */
static double set_text(const setting *s, const char *text) {
  reader r = {.at = text};
  double along = 0;
  uint32_t code, accent;
  int level;
  while (read_next(&r, &code, &level)) {
    const uint32_t letter = cf_alphabet_split(code, &accent);
    const cf_glyph *g = cf_alphabet_find(letter);
    placed p = {.along = along, .scale = s->scale * (level != 0 ? SCRIPT_SIZE : 1), .set = s};
    p.rise = level > 0 ? RAISED * s->scale : level < 0 ? LOWERED * s->scale : 0;
    if (s->aligned) p.rise = round(p.rise);
    if (s->mask != NULL) {
      const double left = s->aligned ? round(g->left * p.scale) / p.scale : (double)g->left;
      draw_path(&p, left, g->path);
      if (accent != 0) draw_accent(&p, g, letter, accent);
    }
    along += p.scale * ((double)(g->left + g->width + g->right) + s->apart);
    if (s->aligned && level == 0) along = round(along);
  }
  return along;
}

static setting setting_of(const double size) {
  return (setting){.scale = size / EM, .aligned = size < SMALL};
}

double cf_text_width(const double size, const char *text) {
  const setting s = setting_of(size);
  return set_text(&s, text);
}

double cf_text_height(const double size) {
  const double height = 10 * size / EM;
  return size < SMALL ? round(height) : height;
}

/* White around dark letters, near black around light ones. */
static cf_colour rim_of(const cf_colour c) {
  const bool light = 2 * c.r + 5 * c.g + c.b > 8 * 140;
  return light ? (cf_colour){16, 16, 24} : (cf_colour){255, 255, 255};
}

static cf_status draw_once(cf_canvas *c, const setting *place, const double length, const cf_colour colour,
                           const char *text) {
  const double above = 16 * place->scale, below = 8 * place->scale;
  const double flat[4] = {place->x - below, place->y - above, place->x + length + below, place->y + below};
  const double tall[4] = {place->x - above, place->y - length - below, place->x + below, place->y + below};
  setting s = *place;
  cf_mask mask;
  CF_TRY(cf_mask_create(&mask, c, s.upward ? tall : flat));
  if (mask.cover != NULL) {
    s.mask = &mask;
    set_text(&s, text);
    cf_mask_blend(&mask, c, colour);
  }
  cf_mask_destroy(&mask);
  return CF_OK;
}

cf_status cf_text_draw(cf_canvas *c, const cf_lettering *l, const double x, const double y,
                       const char *text) {
  setting s = setting_of(l->size);
  const double weight = l->weight > 0 ? l->weight : 1;
  s.apart = CF_MAX(weight - 1, 0); /* heavy letters want room */
  const double length = set_text(&s, text), back = l->align * length;
  s.upward = l->upward != 0;
  s.x = s.upward ? x : x - back;
  s.y = s.upward ? y + back : y;
  if (s.aligned) s.x = round(s.x), s.y = round(s.y);
  const double width = CF_MAX(weight * WEIGHT * s.scale, 1.05);
  if (l->outline != 0) {
    s.width = width + 0.28 * l->size;
    CF_TRY(draw_once(c, &s, length, rim_of(l->colour), text));
  }
  s.width = width;
  return draw_once(c, &s, length, l->colour, text);
}
