/* SPDX-License-Identifier: MIT
 *
 * Three floats: a place or direction (m), or a colour (linear light: red, green, blue). By value.
 */
#ifndef CF_RENDER_VEC_H
#define CF_RENDER_VEC_H

#include <math.h>

typedef struct cf_vec {
  float x, y, z;
} cf_vec;

static inline cf_vec cf_vec_of(const double *v) { return (cf_vec){(float)v[0], (float)v[1], (float)v[2]}; }
static inline cf_vec cf_vec_add(const cf_vec a, const cf_vec b) {
  return (cf_vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline cf_vec cf_vec_sub(const cf_vec a, const cf_vec b) {
  return (cf_vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline cf_vec cf_vec_scale(const float s, const cf_vec a) {
  return (cf_vec){s * a.x, s * a.y, s * a.z};
}
static inline cf_vec cf_vec_times(const cf_vec a, const cf_vec b) {
  return (cf_vec){a.x * b.x, a.y * b.y, a.z * b.z};
}
/* a + s b */
static inline cf_vec cf_vec_along(const cf_vec a, const float s, const cf_vec b) {
  return (cf_vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline cf_vec cf_vec_mix(const cf_vec a, const cf_vec b, const float s) {
  return cf_vec_along(cf_vec_scale(1 - s, a), s, b);
}
static inline float cf_vec_dot(const cf_vec a, const cf_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline cf_vec cf_vec_cross(const cf_vec a, const cf_vec b) {
  return (cf_vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline float cf_vec_length(const cf_vec a) { return sqrtf(cf_vec_dot(a, a)); }
/* 0 stays 0. */
static inline cf_vec cf_vec_unit(const cf_vec a) {
  const float length = cf_vec_length(a);
  return length > 0 ? cf_vec_scale(1 / length, a) : a;
}
/* What is left of light after the optical depth d of each colour. */
static inline cf_vec cf_vec_fade(const cf_vec d) { return (cf_vec){expf(-d.x), expf(-d.y), expf(-d.z)}; }
/* How bright a colour looks (the Y of sRGB's primaries). */
static inline float cf_vec_luminance(const cf_vec c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/* Two directions that make a right-handed frame with the unit vector n (Frisvad's, in the form of Duff et al. 2017). */
static inline void cf_vec_frame(const cf_vec n, cf_vec *s, cf_vec *t) {
  const float sign = copysignf(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  *s = (cf_vec){1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *t = (cf_vec){b, sign + n.y * n.y * a, -n.y};
}

/* 0 below a, 1 above b, smooth between. */
static inline float cf_smooth_step(const float a, const float b, const float x) {
  const float s = fminf(fmaxf((x - a) / (b - a), 0), 1);
  return s * s * (3 - 2 * s);
}

#endif
