/* SPDX-License-Identifier: MIT
 *
 * A map is a curve in OKLab (Bjorn Ottosson, 2020): the lightness goes evenly from one end to the other (to the middle
 * and back for signed maps), hue and chroma pass smoothly through a few knots. Where a knot asks for more chroma than
 * sRGB has at that lightness, the chroma is reduced, hue and lightness stay.
 */
#include "render/colormap.h"

#include <math.h>
#include <string.h>

#include "base/real.h"

#define KNOTS_MAX 7

typedef struct knot {
  double hue, chroma; /* degrees; 0 is grey */
} knot;

typedef struct curve {
  double from, to; /* lightness at the ends; of a signed map: at the ends and in the middle */
  int count;       /* of knots, at equal steps */
  knot knots[KNOTS_MAX];
} curve;

static const curve curves[] = {
    [CF_COLORMAP_ember] =
        {0.14,
         0.97,
         7,
         {{285, 0.05}, {305, 0.12}, {350, 0.155}, {388, 0.175}, {412, 0.155}, {442, 0.14}, {462, 0.07}}},
    [CF_COLORMAP_ice] = {0.13,
                         0.98,
                         6,
                         {{278, 0.05}, {266, 0.12}, {252, 0.135}, {234, 0.115}, {212, 0.075}, {200, 0.015}}},
    [CF_COLORMAP_ink] = {0.985,
                         0.16,
                         6,
                         {{220, 0.004}, {232, 0.05}, {246, 0.095}, {262, 0.13}, {272, 0.105}, {285, 0.035}}},
    [CF_COLORMAP_moss] = {0.21,
                          0.95,
                          6,
                          {{292, 0.11}, {262, 0.10}, {215, 0.08}, {168, 0.11}, {130, 0.18}, {106, 0.16}}},
    [CF_COLORMAP_balance] =
        {0.36,
         0.97,
         7,
         {{264, 0.11}, {258, 0.14}, {245, 0.075}, {0, 0}, {45, 0.075}, {32, 0.155}, {22, 0.125}}},
    [CF_COLORMAP_dusk] =
        {0.93,
         0.15,
         7,
         {{205, 0.055}, {232, 0.12}, {262, 0.13}, {0, 0}, {35, 0.12}, {58, 0.14}, {88, 0.075}}},
    [CF_COLORMAP_grey] = {0.0, 1.0, 2, {{0, 0}, {0, 0}}},
};

static const struct {
  const char *name;
  bool is_signed;
} list[] = {
#define CF_COLORMAP_ROW(name, signed_) {#name, signed_},
    CF_COLORMAP_LIST(CF_COLORMAP_ROW)
#undef CF_COLORMAP_ROW
};

#define CF_COLORMAP_WORD(name, signed_) " " #name
static const char names[] = CF_COLORMAP_LIST(CF_COLORMAP_WORD);

cf_status cf_colormap_find(const char *name, cf_colormap *map) {
  for (int m = 0; m < CF_COLORMAP_COUNT; ++m) {
    if (strcmp(name, list[m].name) != 0) continue;
    *map = (cf_colormap)m;
    return CF_OK;
  }
  return cf_fail(CF_BAD_ARGUMENT, "there is no colour map \"%s\"; there are:%s", name, names);
}

const char *cf_colormap_name(const cf_colormap map) { return list[map].name; }

bool cf_colormap_is_signed(const cf_colormap map) { return list[map].is_signed; }

/* --- OKLab ---------------------------------------------------------------------------------------------------- */

static double to_linear(const double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static double from_linear(const double v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

void cf_colour_oklab(const cf_colour c, double lab[3]) {
  const double r = to_linear(c.r / 255.0), g = to_linear(c.g / 255.0), b = to_linear(c.b / 255.0);
  const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
  lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
  lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

/* Linear light; outside of 0..1 the screen has no such colour. */
static void oklab_to_linear(const double lightness, const double a, const double b, double rgb[3]) {
  const double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
  const double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
  const double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  rgb[0] = 4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3;
  rgb[1] = -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3;
  rgb[2] = -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3;
}

static bool is_on_screen(const double rgb[3]) {
  const double slack = 1e-4;
  for (int i = 0; i < 3; ++i)
    if (rgb[i] < -slack || rgb[i] > 1 + slack) return false;
  return true;
}

static cf_colour screen_colour(const double lightness, const double hue, const double chroma) {
  const double angle = hue * 3.14159265358979323846 / 180, a = cos(angle), b = sin(angle);
  double rgb[3], low = 0, high = chroma;
  oklab_to_linear(lightness, chroma * a, chroma * b, rgb);
  if (!is_on_screen(rgb)) {
    for (int i = 0; i < 24; ++i) {
      const double middle = (low + high) / 2;
      oklab_to_linear(lightness, middle * a, middle * b, rgb);
      *(is_on_screen(rgb) ? &low : &high) = middle;
    }
    oklab_to_linear(lightness, low * a, low * b, rgb);
  }
  uint8_t byte[3];
  for (int i = 0; i < 3; ++i) byte[i] = (uint8_t)lrint(255 * from_linear(CF_MIN(CF_MAX(rgb[i], 0), 1)));
  return (cf_colour){byte[0], byte[1], byte[2]};
}

/* --- curves --------------------------------------------------------------------------------------------------- */

/* The cubic through v[1] and v[2] with slopes from the neighbours. */
static double cubic(const double v[4], const double s) {
  const double slope1 = (v[2] - v[0]) / 2, slope2 = (v[3] - v[1]) / 2, rise = v[2] - v[1];
  return v[1] + s * (slope1 + s * (3 * rise - 2 * slope1 - slope2 + s * (slope1 + slope2 - 2 * rise)));
}

/* The knots as points of the plane (a, b): hues may turn freely and grey has none. */
static void place(const curve *c, const double s, double ab[2]) {
  const int last = c->count - 1, i = CF_MIN((int)(s * last), CF_MAX(last - 1, 0));
  double a[4], b[4];
  for (int n = 0; n < 4; ++n) {
    const int k = CF_MIN(CF_MAX(i - 1 + n, 0), last);
    const double angle = c->knots[k].hue * 3.14159265358979323846 / 180;
    a[n] = c->knots[k].chroma * cos(angle);
    b[n] = c->knots[k].chroma * sin(angle);
  }
  ab[0] = cubic(a, s * last - i);
  ab[1] = cubic(b, s * last - i);
}

cf_colour cf_colormap_at(const cf_colormap map, const double s) {
  const curve *c = &curves[map];
  const double at = s > 0 ? CF_MIN(s, 1) : 0; /* NaN is 0 */
  const double part = list[map].is_signed ? 1 - fabs(2 * at - 1) : at;
  double ab[2];
  place(c, at, ab);
  return screen_colour(c->from + (c->to - c->from) * part, atan2(ab[1], ab[0]) * 180 / 3.14159265358979323846,
                       hypot(ab[0], ab[1]));
}

void cf_colormap_fill(const cf_colormap map, const int count, cf_colour *colours) {
  for (int i = 0; i < count; ++i) colours[i] = cf_colormap_at(map, count > 1 ? i / (count - 1.0) : 0);
}
