/* SPDX-License-Identifier: MIT */
#include "render/film.h"

#include <math.h>

#include "base/mem.h"
#include "base/real.h"
#include "base/rng.h"

#define GREY 0.18

cf_status cf_film_create(cf_film *f, const int width, const int height) {
  const size_t pixels = (size_t)width * (size_t)height;
  *f = (cf_film){.width = width, .height = height};
  CF_TRY(CF_NEW(&f->light, pixels));
  cf_status s = CF_NEW(&f->distance, pixels);
  if (s == CF_OK) s = CF_NEW(&f->share, pixels);
  if (s != CF_OK) cf_film_destroy(f);
  return s;
}

void cf_film_destroy(cf_film *f) {
  cf_free(f->light);
  cf_free(f->distance);
  cf_free(f->share);
  *f = (cf_film){.light = NULL};
}

/* --- the tone curve ------------------------------------------------------------------------------------------- */

typedef struct curve {
  double g, m, scale; /* y = scale x^g/(x^g + m); m < 0: y = x/white */
  double white;
} curve;

static curve curve_of(const cf_develop *how) {
  const double g = how->contrast > 0 ? how->contrast : 1, w = how->white > 0 ? how->white : 1;
  const double grey = pow(GREY, g), white = pow(w, g), rest = GREY - grey / white;
  if (rest <= 1e-9) return (curve){.m = -1, .white = w};
  const double m = grey * (1 - GREY) / rest;
  return (curve){.g = g, .m = m, .scale = (white + m) / white, .white = w};
}

static double tone(const curve *c, const double x) {
  if (!(x > 0)) return 0;
  if (c->m < 0) return x / c->white;
  const double power = c->g == 1 ? x : pow(x, c->g);
  return c->scale * power / (power + c->m);
}

double cf_film_tone(const cf_develop *how, const double x) {
  const curve c = curve_of(how);
  return tone(&c, x);
}

/* --- glow ------------------------------------------------------------------------------------------------------- */

/* A running mean over 2 r + 1 pixels, along lines that lie `step` apart. */
static void blur_line(const int n, const int r, const cf_vec *in, cf_vec *out, const ptrdiff_t step) {
  double sum[3] = {0, 0, 0};
  for (int i = -r; i < n; ++i) {
    if (i + r < n) {
      const cf_vec v = in[(i + r) * step];
      sum[0] += (double)v.x, sum[1] += (double)v.y, sum[2] += (double)v.z;
    }
    if (i - r - 1 >= 0) {
      const cf_vec v = in[(i - r - 1) * step];
      sum[0] -= (double)v.x, sum[1] -= (double)v.y, sum[2] -= (double)v.z;
    }
    if (i >= 0)
      out[i * step] = (cf_vec){(float)(sum[0] / (2 * r + 1)), (float)(sum[1] / (2 * r + 1)),
                               (float)(sum[2] / (2 * r + 1))};
  }
}

static void blur_rows(const cf_film *f, const int r, const cf_vec *in, cf_vec *out) {
  for (int y = 0; y < f->height; ++y) {
    const ptrdiff_t row = (ptrdiff_t)y * f->width;
    blur_line(f->width, r, in + row, out + row, 1);
  }
}

static void blur_columns(const cf_film *f, const int r, const cf_vec *in, cf_vec *out) {
  for (int x = 0; x < f->width; ++x) blur_line(f->height, r, in + x, out + x, f->width);
}

/* Two running means each way, near enough to a bell. */
static cf_status add_glow(cf_film *f, const cf_develop *how) {
  const size_t pixels = (size_t)f->width * (size_t)f->height;
  const float part = (float)CF_MIN(how->glow, 0.9);
  const int r = CF_MAX(f->height / 90, 1);
  cf_vec *a, *b;
  CF_TRY(CF_NEW(&a, pixels));
  const cf_status s = CF_NEW(&b, pixels);
  if (s != CF_OK) {
    cf_free(a);
    return s;
  }
  blur_rows(f, r, f->light, a);
  blur_columns(f, r, a, b);
  blur_rows(f, 3 * r, b, a);
  blur_columns(f, 3 * r, a, b);
  for (size_t p = 0; p < pixels; ++p) f->light[p] = cf_vec_mix(f->light[p], b[p], part);
  cf_free(b);
  cf_free(a);
  return CF_OK;
}

/* --- sRGB --------------------------------------------------------------------------------------------------------- */

float cf_colour_linear(const float s) {
  return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

float cf_colour_encoded(const float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

cf_vec cf_colour_light(const cf_colour c) {
  return (cf_vec){cf_colour_linear((float)c.r / 255), cf_colour_linear((float)c.g / 255),
                  cf_colour_linear((float)c.b / 255)};
}

/* --- developing ------------------------------------------------------------------------------------------------- */

/* A colour beyond white is drawn towards the grey of its brightness until it fits. */
static void pale(double c[3]) {
  const double y = CF_MIN(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2], 1);
  const double most = CF_MAX(c[0], CF_MAX(c[1], c[2]));
  if (most <= 1) return;
  const double s = most > y ? (1 - y) / (most - y) : 0;
  for (int k = 0; k < 3; ++k) c[k] = y + s * (c[k] - y);
}

static double corner(const cf_film *f, const cf_develop *how, const int x, const int y) {
  const double u = 2 * (x + 0.5) / f->width - 1, v = 2 * (y + 0.5) / f->height - 1, r = 0.5 * (u * u + v * v);
  return 1 - how->vignette * r * r;
}

static uint8_t level(const double v, const double noise) {
  const double step = 255 * (double)cf_colour_encoded((float)CF_MIN(CF_MAX(v, 0), 1));
  return (uint8_t)CF_MIN(CF_MAX(floor(step + 0.5 + noise), 0), 255);
}

static void develop_row(const cf_film *f, const cf_develop *how, const curve *c, const int y, uint8_t *rgb) {
  const double gain = exp2(how->exposure);
  for (int x = 0; x < f->width; ++x) {
    const size_t p = (size_t)y * (size_t)f->width + (size_t)x;
    const cf_vec v = f->light[p];
    const double times = gain * corner(f, how, x, y);
    double out[3] = {tone(c, times * (double)v.x), tone(c, times * (double)v.y),
                     tone(c, times * (double)v.z)};
    pale(out);
    for (int k = 0; k < 3; ++k) {
      const double noise = how->plain ? 0 : cf_random(7, (uint64_t)k, 0, p) - 0.5;
      rgb[3 * x + k] = level(out[k], noise);
    }
  }
}

cf_status cf_film_develop(cf_film *f, const cf_develop *how, cf_canvas *c) {
  const curve tones = curve_of(how);
  if (how->glow > 0) CF_TRY(add_glow(f, how));
  CF_TRY(cf_canvas_create(c, f->width, f->height, (cf_colour){0, 0, 0}));
  for (int y = 0; y < f->height; ++y)
    develop_row(f, how, &tones, y, c->rgb + 3 * (size_t)y * (size_t)f->width);
  return CF_OK;
}
