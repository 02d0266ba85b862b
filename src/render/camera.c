/* SPDX-License-Identifier: MIT */
#include "render/camera.h"

#include "base/real.h"

#define RADIAN (acos(-1.0) / 180)

cf_status cf_lens_grind(cf_lens *l, const cf_camera *c, const int width, const int height) {
  const cf_vec up = c->up[0] == 0 && c->up[1] == 0 && c->up[2] == 0 ? (cf_vec){0, 0, 1} : cf_vec_of(c->up);
  const double away[3] = {c->aim[0] - c->eye[0], c->aim[1] - c->eye[1], c->aim[2] - c->eye[2]};
  const double distance = sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
  if (!(distance > 0) || !isfinite(distance))
    return cf_fail(CF_BAD_ARGUMENT, "camera: it stands where it looks at, (%g, %g, %g)", c->eye[0], c->eye[1],
                   c->eye[2]);
  if (c->angle == 0 ? !(c->span > 0) : !(c->angle > 0 && c->angle < 170))
    return cf_fail(CF_BAD_ARGUMENT, "camera: an angle of view of %g degrees: must be between 0 and 170",
                   c->angle);
  if (!(c->focus >= 0) || !(c->aperture >= 0))
    return cf_fail(CF_BAD_ARGUMENT, "camera: focus %g m, aperture %g m: must be >= 0", c->focus, c->aperture);
  *l = (cf_lens){.width = width, .height = height, .parallel = c->angle == 0};
  l->eye = cf_vec_of(c->eye);
  l->forward = cf_vec_unit(cf_vec_of(away));
  l->right = cf_vec_cross(l->forward, up);
  if (!(cf_vec_length(l->right) > 1e-4f * cf_vec_length(up)))
    return cf_fail(CF_BAD_ARGUMENT, "camera: it looks along its `up`, so that the picture has no upper edge");
  l->right = cf_vec_unit(l->right);
  l->up = cf_vec_cross(l->right, l->forward);
  l->pixel = (float)(l->parallel ? c->span / height : 2 * tan(0.5 * c->angle * RADIAN) / height);
  l->focus = (float)(c->focus > 0 ? c->focus : distance);
  l->radius = (float)(0.5 * c->aperture);
  return CF_OK;
}

cf_ray cf_lens_ray(const cf_lens *l, const float x, const float y, const float disc[2]) {
  const float right = (x - 0.5f * (float)l->width) * l->pixel, up = (0.5f * (float)l->height - y) * l->pixel;
  const cf_vec off = cf_vec_along(cf_vec_scale(right, l->right), up, l->up);
  const cf_vec lens = cf_vec_along(cf_vec_scale(l->radius * disc[0], l->right), l->radius * disc[1], l->up);
  cf_ray r = {.from = cf_vec_add(l->eye, lens)};
  if (l->parallel) r.from = cf_vec_add(r.from, off);
  /* Through the point of the sharp plane that the pixel belongs to. */
  const cf_vec sharp = cf_vec_scale(l->focus, l->parallel ? l->forward : cf_vec_add(l->forward, off));
  r.along = cf_vec_unit(cf_vec_sub(sharp, lens));
  return r;
}

float cf_lens_project(const cf_lens *l, const cf_vec at, float *x, float *y) {
  const cf_vec off = cf_vec_sub(at, l->eye);
  const float distance = cf_vec_dot(off, l->forward);
  if (distance <= 0) return distance;
  const float scale = cf_lens_scale(l, distance);
  *x = 0.5f * (float)l->width + scale * cf_vec_dot(off, l->right);
  *y = 0.5f * (float)l->height - scale * cf_vec_dot(off, l->up);
  return distance;
}

float cf_lens_scale(const cf_lens *l, const float distance) {
  return 1 / (l->parallel ? l->pixel : l->pixel * distance);
}

float cf_lens_blur(const cf_lens *l, const float distance) {
  return l->radius * fabsf(distance - l->focus) / l->focus * cf_lens_scale(l, l->parallel ? 1 : distance);
}

/* Whether all corners of the box are beyond a plane near the eye that no ray crosses, n (p - eye) < -radius with
 * n ~ axis - t forward. `least` is the smallest tangent, along `axis`, of the pixels. A ray starts on the lens, where
 * n (p - eye) >= -radius, and passes the sharp plane where n (p - eye) >= radius if t is small enough. Tried are the steepest
 * plane, and those along the sides of the box: ground reaches behind the camera. */
static bool misses(const cf_lens *l, const cf_vec axis, const float least, const cf_vec corner[8]) {
  const cf_vec side[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const float shift = l->radius / l->focus;
  if (shift > 0.9f) return false;
  const float steepest = least - shift * (1 + fabsf(least)) / (1 - shift);
  for (int k = -1; k < 3; ++k) {
    float t = steepest;
    if (k >= 0) t = fminf(t, -cf_vec_dot(side[k], l->forward) / cf_vec_dot(side[k], axis));
    if (!isfinite(t)) continue;
    const cf_vec n = cf_vec_unit(cf_vec_along(axis, -t, l->forward));
    bool beyond = true;
    for (int c = 0; c < 8 && beyond; ++c) beyond = cf_vec_dot(n, cf_vec_sub(corner[c], l->eye)) < -l->radius;
    if (beyond) return true;
  }
  return false;
}

bool cf_lens_reaches(const cf_lens *l, const float pixels[4], const cf_vec low, const cf_vec high) {
  const float x[2] = {(pixels[0] - 0.5f * (float)l->width) * l->pixel,
                      (pixels[2] - 0.5f * (float)l->width) * l->pixel};
  const float y[2] = {(0.5f * (float)l->height - pixels[3]) * l->pixel,
                      (0.5f * (float)l->height - pixels[1]) * l->pixel};
  const cf_vec left = cf_vec_scale(-1, l->right), down = cf_vec_scale(-1, l->up);
  cf_vec corner[8];
  for (int c = 0; c < 8; ++c)
    corner[c] = (cf_vec){c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
  return l->parallel || !(misses(l, l->right, x[0], corner) || misses(l, left, -x[1], corner) ||
                          misses(l, l->up, y[0], corner) || misses(l, down, -y[1], corner));
}

/* Steps back until every corner of the box is inside the picture, and looks at the middle of what they cover. */
cf_camera cf_camera_around(const double low[3], const double high[3], const double turn, const double rise,
                           const double angle, const double aspect) {
  const double a = turn * RADIAN, b = rise * RADIAN;
  const double forward[3] = {-sin(a) * cos(b), cos(a) * cos(b), -sin(b)}, right[3] = {cos(a), sin(a), 0};
  const double up[3] = {sin(a) * sin(b), -cos(a) * sin(b), cos(b)};
  const double half = tan(0.5 * angle * RADIAN);
  double middle[3], back = 0;
  for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (low[k] + high[k]);
  for (int corner = 0; corner < 8; ++corner) {
    double off[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const double d = (corner >> k & 1 ? high[k] : low[k]) - middle[k];
      off[0] += d * right[k], off[1] += d * up[k], off[2] += d * forward[k];
    }
    const double wide = fabs(off[0]) / (half * aspect), tall = fabs(off[1]) / half;
    back = CF_MAX(back, CF_MAX(wide, tall) - off[2]);
  }
  back *= 1.06;
  cf_camera c = {.angle = angle};
  for (int k = 0; k < 3; ++k) c.aim[k] = middle[k], c.eye[k] = middle[k] - back * forward[k];
  if (rise > 89 || rise < -89)
    for (int k = 0; k < 3; ++k) c.up[k] = up[k];
  return c;
}
