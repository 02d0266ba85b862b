/* SPDX-License-Identifier: MIT */
#include "render/canvas.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "render/mask.h"

#define SIDE_MAX 32768

cf_status cf_canvas_create(cf_canvas *c, const int width, const int height, const cf_colour ground) {
  *c = (cf_canvas){.rgb = NULL};
  if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "a picture of %d x %d pixels: sides must be 1 to %d", width, height,
                   SIDE_MAX);
  CF_TRY(CF_NEW(&c->rgb, (size_t)width * (size_t)height * 3));
  c->width = width;
  c->height = height;
  cf_canvas_fill(c, 0, 0, width, height, ground);
  return CF_OK;
}

void cf_canvas_destroy(cf_canvas *c) {
  cf_free(c->rgb);
  *c = (cf_canvas){0};
}

static uint8_t *pixel(const cf_canvas *c, const int x, const int y) {
  return c->rgb + 3 * ((size_t)y * (size_t)c->width + (size_t)x);
}

void cf_canvas_set(cf_canvas *c, const int x, const int y, const cf_colour colour) {
  if (x < 0 || y < 0 || x >= c->width || y >= c->height) return;
  uint8_t *p = pixel(c, x, y);
  p[0] = colour.r, p[1] = colour.g, p[2] = colour.b;
}

void cf_canvas_fill(cf_canvas *c, const int x, const int y, const int width, const int height,
                    const cf_colour colour) {
  for (int j = CF_MAX(y, 0); j < CF_MIN(y + height, c->height); ++j)
    for (int i = CF_MAX(x, 0); i < CF_MIN(x + width, c->width); ++i) cf_canvas_set(c, i, j, colour);
}

void cf_canvas_copy(cf_canvas *c, const int x, const int y, const cf_canvas *picture) {
  const int from = CF_MAX(0, -x), to = CF_MIN(picture->width, c->width - x);
  for (int j = CF_MAX(0, -y); j < CF_MIN(picture->height, c->height - y) && from < to; ++j)
    memcpy(pixel(c, x + from, y + j), pixel(picture, from, j), 3 * (size_t)(to - from));
}

/* --- masks -------------------------------------------------------------------------------------------------- */

cf_status cf_mask_create(cf_mask *m, const cf_canvas *c, const double box[4]) {
  const double low[2] = {CF_MAX(box[0], 0), CF_MAX(box[1], 0)};
  const double high[2] = {CF_MIN(box[2], c->width), CF_MIN(box[3], c->height)};
  *m = (cf_mask){.cover = NULL};
  if (!(low[0] < high[0] && low[1] < high[1])) return CF_OK;
  m->x = (int)floor(low[0]);
  m->y = (int)floor(low[1]);
  m->width = (int)ceil(high[0]) - m->x;
  m->height = (int)ceil(high[1]) - m->y;
  return CF_NEW(&m->cover, (size_t)m->width * (size_t)m->height);
}

void cf_mask_destroy(cf_mask *m) {
  cf_free(m->cover);
  *m = (cf_mask){0};
}

/* Distance from p to the stretch from a to b. */
static double distance(const double a[2], const double b[2], const double x, const double y) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
  double s = square > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / square : 0;
  s = CF_MIN(CF_MAX(s, 0), 1);
  return hypot(x - a[0] - s * dx, y - a[1] - s * dy);
}

void cf_mask_stroke(cf_mask *m, const double a[2], const double b[2], const double width) {
  const double half = CF_MAX(width, 1) / 2,
               reach = half + 1; /* under a pixel wide: paler instead of thinner */
  const double strength = CF_MIN(width, 1);
  const int x0 = (int)CF_MAX(CF_MIN(a[0], b[0]) - reach - m->x, 0),
            y0 = (int)CF_MAX(CF_MIN(a[1], b[1]) - reach - m->y, 0);
  const int x1 = (int)CF_MIN(CF_MAX(a[0], b[0]) + reach - m->x, m->width - 1.0);
  const int y1 = (int)CF_MIN(CF_MAX(a[1], b[1]) + reach - m->y, m->height - 1.0);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double far = distance(a, b, m->x + x + 0.5, m->y + y + 0.5);
      const float cover = (float)(strength * CF_MIN(CF_MAX(half + 0.5 - far, 0), 1));
      float *at = &m->cover[(size_t)y * (size_t)m->width + (size_t)x];
      if (cover > *at) *at = cover;
    }
}

static uint8_t mix(const uint8_t from, const uint8_t to, const float s) {
  return (uint8_t)lrintf((float)from + s * ((float)to - (float)from));
}

void cf_mask_blend(const cf_mask *m, cf_canvas *c, const cf_colour colour) {
  for (int y = 0; y < m->height; ++y)
    for (int x = 0; x < m->width; ++x) {
      const float cover = m->cover[(size_t)y * (size_t)m->width + (size_t)x];
      uint8_t *p = pixel(c, m->x + x, m->y + y);
      if (cover <= 0) continue;
      p[0] = mix(p[0], colour.r, cover), p[1] = mix(p[1], colour.g, cover), p[2] = mix(p[2], colour.b, cover);
    }
}

/* --- lines -------------------------------------------------------------------------------------------------- */

/* A stretch of a line, cut into dashes; *along is how far the line has come. */
static void dash(cf_mask *m, const cf_pen *pen, const double a[2], const double b[2], double *along) {
  const double length = hypot(b[0] - a[0], b[1] - a[1]), period = pen->dash + pen->gap;
  /* Round ends add the width to a dash. */
  const double drawn = CF_MAX(pen->dash - pen->width, 0.01);
  for (double s = 0; s < length;) {
    const double phase = fmod(*along, period), rest = phase < drawn ? drawn - phase : period - phase;
    const double end = CF_MIN(s + CF_MAX(rest, 1e-3), length);
    const double from[2] = {a[0] + (b[0] - a[0]) * s / length, a[1] + (b[1] - a[1]) * s / length};
    const double to[2] = {a[0] + (b[0] - a[0]) * end / length, a[1] + (b[1] - a[1]) * end / length};
    if (phase < drawn) cf_mask_stroke(m, from, to, pen->width);
    *along += end - s;
    s = end;
  }
}

/* The part of a stretch inside the box (Liang and Barsky); false if there is none. Far outside points would take a
 * dashed line forever. */
static bool clip(const double box[4], double a[2], double b[2]) {
  double from = 0, to = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double d = b[axis] - a[axis];
    for (int end = 0; end < 2; ++end) {
      const double room = end == 0 ? a[axis] - box[axis] : box[2 + axis] - a[axis], speed = end == 0 ? -d : d;
      if (speed == 0 && room < 0) return false;
      if (speed < 0) from = CF_MAX(from, room / speed);
      if (speed > 0) to = CF_MIN(to, room / speed);
    }
  }
  if (!(from <= to)) return false;
  const double start[2] = {a[0], a[1]}, d[2] = {b[0] - a[0], b[1] - a[1]};
  for (int axis = 0; axis < 2; ++axis)
    a[axis] = start[axis] + from * d[axis], b[axis] = start[axis] + to * d[axis];
  return true;
}

cf_status cf_canvas_stroke(cf_canvas *c, const cf_pen *pen, const int count, const double (*at)[2]) {
  const bool whole = pen->clip[2] == 0 && pen->clip[3] == 0;
  const double box[4] = {whole ? 0 : pen->clip[0], whole ? 0 : pen->clip[1],
                         whole ? c->width : pen->clip[0] + pen->clip[2],
                         whole ? c->height : pen->clip[1] + pen->clip[3]};
  const double around[4] = {box[0] - pen->width, box[1] - pen->width, box[2] + pen->width,
                            box[3] + pen->width};
  cf_mask m;
  double along = 0;
  CF_TRY(cf_mask_create(&m, c, box));
  for (int i = 0; i + 1 < count && m.cover != NULL; ++i) {
    double a[2] = {at[i][0], at[i][1]}, b[2] = {at[i + 1][0], at[i + 1][1]};
    if (!clip(around, a, b)) continue;
    if (pen->dash > 0)
      dash(&m, pen, a, b, &along);
    else
      cf_mask_stroke(&m, a, b, pen->width);
  }
  if (m.cover != NULL) cf_mask_blend(&m, c, pen->colour);
  cf_mask_destroy(&m);
  return CF_OK;
}
