/* SPDX-License-Identifier: MIT */
#include "render/medium.h"

#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "grid/sweep.h"

enum { BRICK = 8, ORDERS = 3, FINE_CELLS = 4 * 1000 * 1000, LIGHT_CELLS = 2 * 1000 * 1000 };

/* What an order of scattering keeps of the depth, of the light and of the direction of the one before. */
#define KEPT_DEPTH 0.4f
#define KEPT_LIGHT 0.45f
#define KEPT_WAY   0.5f

static size_t cells_of(const int n[3]) { return (size_t)n[0] * (size_t)n[1] * (size_t)n[2]; }
static size_t place_of(const int n[3], const int i, const int j, const int k) {
  return ((size_t)k * (size_t)n[1] + (size_t)j) * (size_t)n[0] + (size_t)i;
}
static int inside(const int i, const int n) { return CF_MIN(CF_MAX(i, 0), n - 1); }

/* --- the density -------------------------------------------------------------------------------------------- */

/* Twice the cells along an axis: cubics at a quarter and three quarters of the way between cells, held between the two
 * cells they lie between. */
static void refine_axis(const int from[3], const float *in, const int axis, float *out) {
  static const float weight[4] = {-0.0703125f, 0.8671875f, 0.2265625f, -0.0234375f};
  int to[3] = {from[0], from[1], from[2]};
  to[axis] *= 2;
  for (int k = 0; k < to[2]; ++k)
    for (int j = 0; j < to[1]; ++j)
      for (int i = 0; i < to[0]; ++i) {
        int at[3] = {i, j, k};
        const int c = at[axis] / 2, side = at[axis] % 2 == 1 ? 1 : -1;
        float v[4], sum = 0;
        for (int t = 0; t < 4; ++t) {
          at[axis] = inside(c + side * (t - 1), from[axis]);
          v[t] = in[place_of(from, at[0], at[1], at[2])];
          sum += weight[t] * v[t];
        }
        out[place_of(to, i, j, k)] = fminf(fmaxf(sum, fminf(v[1], v[2])), fmaxf(v[1], v[2]));
      }
}

static cf_status refine(cf_medium *m, const int dim) {
  for (int a = 0; a < dim; ++a) {
    float *finer;
    CF_TRY(CF_NEW(&finer, 2 * cells_of(m->n)));
    refine_axis(m->n, m->density, a, finer);
    cf_free(m->density);
    m->density = finer;
    m->n[a] *= 2;
  }
  m->h *= 0.5f;
  return CF_OK;
}

static float most_of(const cf_medium *m, const int b[3]) {
  float most = 0;
  int low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = CF_MAX(BRICK * b[a] - 1, 0);
    high[a] = CF_MIN(BRICK * (b[a] + 1) + 1, m->n[a]);
  }
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) most = fmaxf(most, m->density[place_of(m->n, i, j, k)]);
  return most;
}

static cf_status make_bricks(cf_medium *m) {
  for (int a = 0; a < 3; ++a) m->bricks[a] = (m->n[a] + BRICK - 1) / BRICK;
  CF_TRY(CF_NEW(&m->most, cells_of(m->bricks)));
  for (int k = 0; k < m->bricks[2]; ++k)
    for (int j = 0; j < m->bricks[1]; ++j)
      for (int i = 0; i < m->bricks[0]; ++i)
        m->most[place_of(m->bricks, i, j, k)] = most_of(m, (int[]){i, j, k});
  return CF_OK;
}

static cf_status take_field(cf_medium *m, const cf_grid *g, const cf_real *f, const double zero,
                            const double scale) {
  CF_TRY(CF_NEW(&m->density, cells_of(m->n)));
  for (int k = 0; k < m->n[2]; ++k)
    for (int j = 0; j < m->n[1]; ++j)
      for (int i = 0; i < m->n[0]; ++i) {
        const double d = ((double)f[cf_box_at(&g->box, i, j, k)] - zero) * scale;
        m->density[place_of(m->n, i, j, k)] = d > 0 && isfinite(d) ? (float)d : 0;
      }
  return CF_OK;
}

cf_status cf_medium_create(cf_medium *m, const cf_grid *g, const cf_real *f, const double zero,
                           const double scale, const bool fine) {
  *m = (cf_medium){.h = (float)g->h};
  for (int a = 0; a < 3; ++a) m->n[a] = g->box.n[a], m->low[a] = (float)g->origin[a];
  cf_status s = take_field(m, g, f, zero, scale);
  if (s == CF_OK && fine && cells_of(m->n) <= FINE_CELLS && g->box.dim == 3) s = refine(m, 3);
  if (s == CF_OK) s = make_bricks(m);
  if (s != CF_OK) cf_medium_destroy(m);
  return s;
}

void cf_medium_destroy(cf_medium *m) {
  for (int l = 0; l < m->lights; ++l) cf_free(m->depth[l]);
  cf_free(m->density);
  cf_free(m->most);
  cf_free(m->sent);
  *m = (cf_medium){.density = NULL};
}

/* A value between the centres of cells; beyond the outermost centres it stays. */
static inline float between(const int n[3], const float *f, const float x[3]) {
  size_t low[3], high[3];
  float s[3];
  const size_t stride[3] = {1, (size_t)n[0], (size_t)n[0] * (size_t)n[1]};
  for (int a = 0; a < 3; ++a) {
    const float at = fminf(fmaxf(x[a] - 0.5f, 0), (float)(n[a] - 1));
    const int i = (int)at;
    s[a] = at - (float)i;
    low[a] = (size_t)i * stride[a];
    high[a] = (size_t)CF_MIN(i + 1, n[a] - 1) * stride[a];
  }
  float v[4];
  for (int c = 0; c < 4; ++c) {
    const float *row = f + (c & 1 ? high[1] : low[1]) + (c & 2 ? high[2] : low[2]);
    v[c] = row[low[0]] + s[0] * (row[high[0]] - row[low[0]]);
  }
  const float below = v[0] + s[1] * (v[1] - v[0]), above = v[2] + s[1] * (v[3] - v[2]);
  return below + s[2] * (above - below);
}

static bool to_cells(const cf_medium *m, const cf_vec at, float x[3]) {
  x[0] = (at.x - m->low[0]) / m->h, x[1] = (at.y - m->low[1]) / m->h, x[2] = (at.z - m->low[2]) / m->h;
  bool in = true;
  for (int a = 0; a < 3; ++a) in = in && x[a] >= 0 && x[a] <= (float)m->n[a];
  return in;
}

/* --- light inside ------------------------------------------------------------------------------------------------ */

typedef struct sweep {
  const cf_medium *m;
  float *depth;
  int axis, other[2], first, step; /* layers run along `axis` from `first` by `step` */
  float toward[3];                 /* to the light, from layer to layer 1 along the axis, in coarse cells */
  float way;                       /* from layer to layer, m */
} sweep;

/* The depth that the layer before has at the place (u, v) of its two axes; 0 beyond the sides. */
static float upstream(const sweep *w, const int layer, const float u, const float v) {
  const int i = (int)floorf(u), j = (int)floorf(v);
  const float s = u - (float)i, t = v - (float)j;
  float sum = 0;
  for (int c = 0; c < 4; ++c) {
    const int a = i + (c & 1), b = j + (c >> 1);
    if (a < 0 || b < 0 || a >= w->m->m[w->other[0]] || b >= w->m->m[w->other[1]]) continue;
    int at[3];
    at[w->axis] = layer, at[w->other[0]] = a, at[w->other[1]] = b;
    const float weight = (c & 1 ? s : 1 - s) * (c >> 1 ? t : 1 - t);
    sum += weight * w->depth[place_of(w->m->m, at[0], at[1], at[2])];
  }
  return sum;
}

static void sweep_cell(const sweep *w, const int at[3], const bool first) {
  const float part = first ? 0.25f : 0.5f, wide = (float)w->m->coarse;
  float x[3];
  for (int a = 0; a < 3; ++a) x[a] = ((float)at[a] + 0.5f + part * w->toward[a]) * wide;
  bool in = true;
  for (int a = 0; a < 3; ++a) in = in && x[a] >= 0 && x[a] <= (float)w->m->n[a];
  float depth = in ? between(w->m->n, w->m->density, x) * w->way * (first ? 0.5f : 1) : 0;
  if (!first)
    depth += upstream(w, at[w->axis] - w->step, (float)at[w->other[0]] + w->toward[w->other[0]],
                      (float)at[w->other[1]] + w->toward[w->other[1]]);
  w->depth[place_of(w->m->m, at[0], at[1], at[2])] = depth;
}

static void sweep_layers(const sweep *w, const int threads) {
  const int *m = w->m->m;
  for (int l = 0, layer = w->first; l < m[w->axis]; ++l, layer += w->step) {
    CF_PRAGMA(omp parallel for schedule(static) num_threads(threads))
    for (int j = 0; j < m[w->other[1]]; ++j)
      for (int i = 0; i < m[w->other[0]]; ++i) {
        int at[3];
        at[w->axis] = layer, at[w->other[0]] = i, at[w->other[1]] = j;
        sweep_cell(w, at, l == 0);
      }
  }
}

static cf_status illuminate(cf_medium *m, const cf_light *light, const int threads) {
  const float toward[3] = {light->toward.x, light->toward.y, light->toward.z};
  sweep w = {.m = m};
  for (int a = 1; a < 3; ++a)
    if (fabsf(toward[a]) > fabsf(toward[w.axis])) w.axis = a;
  w.other[0] = (w.axis + 1) % 3, w.other[1] = (w.axis + 2) % 3;
  const float steep = fabsf(toward[w.axis]);
  for (int a = 0; a < 3; ++a) w.toward[a] = toward[a] / steep;
  w.step = toward[w.axis] > 0 ? -1 : 1;
  w.first = toward[w.axis] > 0 ? m->m[w.axis] - 1 : 0;
  w.way = m->h * (float)m->coarse / steep;
  CF_TRY(CF_NEW(&m->depth[m->lights], cells_of(m->m)));
  w.depth = m->depth[m->lights];
  ++m->lights;
  sweep_layers(&w, threads);
  return CF_OK;
}

/* Henyey and Greenstein's function, 1 if g = 0. */
static float way_of(const float g, const float cosine) {
  const float base = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (base * sqrtf(base));
}

/* What one light sends on after this depth, per unit of what is scattered: all orders. */
static cf_vec sent_on(const float depth, const cf_vec sigma, const float g, const float cosine) {
  float kept = depth, left = 1, forward = g;
  cf_vec sum = {0, 0, 0};
  for (int order = 0; order < ORDERS; ++order) {
    sum = cf_vec_along(sum, left * way_of(forward, cosine), cf_vec_fade(cf_vec_scale(kept, sigma)));
    kept *= KEPT_DEPTH, left *= KEPT_LIGHT, forward *= KEPT_WAY;
  }
  return sum;
}

static cf_status send(cf_medium *m, const cf_light *light, const cf_vec sky, const cf_vec eye,
                      const int threads) {
  const cf_vec sigma = cf_vec_add(m->absorb, m->scatter);
  const float wide = m->h * (float)m->coarse;
  CF_TRY(CF_NEW(&m->sent, cells_of(m->m)));
  CF_PRAGMA(omp parallel for schedule(static) num_threads(threads))
  for (int k = 0; k < m->m[2]; ++k)
    for (int j = 0; j < m->m[1]; ++j)
      for (int i = 0; i < m->m[0]; ++i) {
        const size_t p = place_of(m->m, i, j, k);
        const cf_vec at = {m->low[0] + ((float)i + 0.5f) * wide, m->low[1] + ((float)j + 0.5f) * wide,
                           m->low[2] + ((float)k + 0.5f) * wide};
        const cf_vec along = cf_vec_unit(cf_vec_sub(at, eye));
        cf_vec sum = cf_vec_times(sky, sent_on(m->depth[0][p], sigma, 0, 0));
        for (int l = 1; l < m->lights; ++l) {
          const float cosine = cf_vec_dot(light[l - 1].toward, along);
          const cf_vec sent = sent_on(m->depth[l][p], sigma, m->forward, cosine);
          /* A white surface of the light's colour sends a quarter of that each way from all around. */
          sum = cf_vec_along(sum, 0.25f, cf_vec_times(light[l - 1].colour, sent));
        }
        m->sent[p] = sum;
      }
  return CF_OK;
}

cf_status cf_medium_illuminate(cf_medium *m, const int lights, const cf_light *light, const cf_vec sky,
                               const cf_vec eye, const int threads) {
  const cf_light above = {.toward = {0, 0, 1}};
  for (m->coarse = 1; cells_of(m->n) / (size_t)(m->coarse * m->coarse * m->coarse) > LIGHT_CELLS;)
    ++m->coarse;
  for (int a = 0; a < 3; ++a) m->m[a] = (m->n[a] + m->coarse - 1) / m->coarse;
  CF_TRY(illuminate(m, &above, threads));
  for (int l = 0; l < CF_MIN(lights, CF_LIGHTS); ++l) CF_TRY(illuminate(m, &light[l], threads));
  return send(m, light, sky, eye, threads);
}

cf_vec cf_medium_shade(const cf_medium *m, const int l, const cf_vec at) {
  float x[3];
  if (l + 1 >= m->lights || !to_cells(m, at, x)) return (cf_vec){1, 1, 1};
  const float wide = (float)m->coarse, y[3] = {x[0] / wide, x[1] / wide, x[2] / wide};
  return cf_vec_fade(cf_vec_scale(between(m->m, m->depth[l + 1], y), cf_vec_add(m->absorb, m->scatter)));
}

/* --- marching ----------------------------------------------------------------------------------------------------- */

/* Where the ray is in a box, in its own units; false: nowhere. */
static bool cross(const float from[3], const float along[3], const float low[3], const float high[3],
                  float *t0, float *t1) {
  for (int a = 0; a < 3; ++a) {
    if (along[a] == 0) {
      if (from[a] < low[a] || from[a] > high[a]) return false;
      continue;
    }
    const float one = (low[a] - from[a]) / along[a], two = (high[a] - from[a]) / along[a];
    *t0 = fmaxf(*t0, fminf(one, two));
    *t1 = fminf(*t1, fmaxf(one, two));
  }
  return *t0 < *t1;
}

/* A ray in units of cells. */
typedef struct walk {
  float from[3], along[3], t0, ds; /* t in cells */
  int steps;
} walk;

/* The step after this one that is not in the same, empty, brick. */
static int past_brick(const cf_medium *m, const walk *w, const int step, const float offset, const int b[3]) {
  float low[3], high[3], t0 = -INFINITY, t1 = INFINITY;
  for (int a = 0; a < 3; ++a) low[a] = (float)(BRICK * b[a]), high[a] = low[a] + BRICK;
  for (int a = 0; a < 3; ++a)
    if (b[a] == m->bricks[a] - 1) high[a] = fmaxf(high[a], (float)m->n[a] + 1);
  if (!cross(w->from, w->along, low, high, &t0, &t1)) return step + 1;
  return CF_MAX(step + 1, (int)fminf(ceilf((t1 - w->t0) / w->ds - offset), 1e9f));
}

static cf_vec sent_at(const cf_medium *m, const float x[3]) {
  const float wide = (float)m->coarse;
  cf_vec v[8];
  float s[3];
  int low[3];
  for (int a = 0; a < 3; ++a) {
    const float at = fminf(fmaxf(x[a] / wide - 0.5f, 0), (float)(m->m[a] - 1));
    low[a] = (int)at;
    s[a] = at - (float)low[a];
  }
  for (int c = 0; c < 8; ++c)
    v[c] =
        m->sent[place_of(m->m, CF_MIN(low[0] + (c & 1), m->m[0] - 1),
                         CF_MIN(low[1] + (c >> 1 & 1), m->m[1] - 1), CF_MIN(low[2] + (c >> 2), m->m[2] - 1))];
  for (int a = 0, left = 4; a < 3; ++a, left /= 2)
    for (int c = 0; c < left; ++c) v[c] = cf_vec_mix(v[2 * c], v[2 * c + 1], s[a]);
  return v[0];
}

static void scatter_step(const cf_medium *m, const float x[3], const float way, cf_vec *light,
                         cf_vec *through) {
  const cf_vec sigma = cf_vec_add(m->absorb, m->scatter);
  const bool grey = sigma.x == sigma.y && sigma.y == sigma.z;
  const float kept = expf(-way * sigma.x);
  const cf_vec fade = grey ? (cf_vec){kept, kept, kept} : cf_vec_fade(cf_vec_scale(way, sigma));
  /* The source over the step, as if uniform: scatter/sigma (1 - fade). */
  const cf_vec sent = {sigma.x > 0 ? (1 - fade.x) * m->scatter.x / sigma.x : 0,
                       sigma.y > 0 ? (1 - fade.y) * m->scatter.y / sigma.y : 0,
                       sigma.z > 0 ? (1 - fade.z) * m->scatter.z / sigma.z : 0};
  *light = cf_vec_add(*light, cf_vec_times(*through, cf_vec_times(sent, sent_at(m, x))));
  *through = cf_vec_times(*through, fade);
}

static bool start(const cf_medium *m, const cf_ray *r, const float near, const float far, walk *w) {
  const float from[3] = {r->from.x, r->from.y, r->from.z}, along[3] = {r->along.x, r->along.y, r->along.z};
  const float low[3] = {0, 0, 0}, high[3] = {(float)m->n[0], (float)m->n[1], (float)m->n[2]};
  float t1 = far / m->h;
  w->t0 = near / m->h;
  for (int a = 0; a < 3; ++a) w->from[a] = (from[a] - m->low[a]) / m->h, w->along[a] = along[a];
  if (!cross(w->from, w->along, low, high, &w->t0, &t1)) return false;
  w->steps = CF_MAX((int)ceilf(t1 - w->t0), 1);
  w->ds = (t1 - w->t0) / (float)w->steps;
  return true;
}

void cf_medium_march(const cf_medium *m, const cf_ray *r, const float near, const float far,
                     const float offset, cf_vec *light, cf_vec *through) {
  const bool scatters = m->sent != NULL;
  float depth = 0;
  walk w;
  if (!start(m, r, near, far, &w)) return;
  for (int i = 0; i < w.steps;) {
    const float t = w.t0 + ((float)i + offset) * w.ds;
    const float x[3] = {w.from[0] + t * w.along[0], w.from[1] + t * w.along[1], w.from[2] + t * w.along[2]};
    const int b[3] = {inside((int)x[0] / BRICK, m->bricks[0]), inside((int)x[1] / BRICK, m->bricks[1]),
                      inside((int)x[2] / BRICK, m->bricks[2])};
    if (m->most[place_of(m->bricks, b[0], b[1], b[2])] <= 0) {
      i = past_brick(m, &w, i, offset, b);
      continue;
    }
    ++i;
    const float d = between(m->n, m->density, x);
    if (d <= 0) continue;
    depth += d * w.ds * m->h;
    if (!scatters) continue;
    scatter_step(m, x, d * w.ds * m->h, light, through);
    if (cf_vec_luminance(*through) < 1e-3f) break;
  }
  if (!scatters) *through = cf_vec_times(*through, cf_vec_fade(cf_vec_scale(depth, m->absorb)));
}
