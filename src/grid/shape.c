/* SPDX-License-Identifier: MIT */
#include "grid/shape.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* Points are taken in pieces of this many, so that buffers fit the stack. */
#define PIECE 32

typedef struct points {
  int n;
  double at[3][PIECE];
} points;

void cf_samples_destroy(cf_samples *s) {
  cf_free(s->value);
  *s = (cf_samples){0};
}

/* --- making ------------------------------------------------------------------------------------------- */

static void copy(const double from[3], double to[3]) { memcpy(to, from, 3 * sizeof *to); }

cf_shape cf_shape_sphere(const double center[3], const double radius) {
  cf_shape s = {.kind = CF_SHAPE_SPHERE, .radius = radius};
  copy(center, s.a);
  return s;
}

cf_shape cf_shape_box(const int dim, const double center[3], const double half[3]) {
  cf_shape s = {.kind = CF_SHAPE_BOX};
  for (int a = 0; a < 3; ++a) {
    s.a[a] = a < dim ? center[a] : 0;
    s.b[a] = a < dim ? half[a] : INFINITY;
  }
  return s;
}

cf_shape cf_shape_capsule(const double a[3], const double b[3], const double radius) {
  cf_shape s = {.kind = CF_SHAPE_CAPSULE, .radius = radius};
  copy(a, s.a);
  copy(b, s.b);
  return s;
}

static double length_of(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

cf_shape cf_shape_plane(const double point[3], const double outward[3]) {
  cf_shape s = {.kind = CF_SHAPE_PLANE};
  const double length = length_of(outward);
  copy(point, s.a);
  for (int a = 0; a < 3; ++a) s.b[a] = outward[a] / length;
  return s;
}

cf_shape cf_shape_function(const cf_fn *fn) { return (cf_shape){.kind = CF_SHAPE_FUNCTION, .fn = *fn}; }

cf_shape cf_shape_sampled(const cf_samples *samples) {
  return (cf_shape){.kind = CF_SHAPE_SAMPLED, .samples = samples};
}

cf_shape cf_shape_union(const cf_shape *part, const int parts) {
  return (cf_shape){.kind = CF_SHAPE_UNION, .part = part, .parts = parts};
}

cf_shape cf_shape_intersection(const cf_shape *part, const int parts) {
  return (cf_shape){.kind = CF_SHAPE_INTERSECTION, .part = part, .parts = parts};
}

cf_shape cf_shape_complement(const cf_shape *of) {
  return (cf_shape){.kind = CF_SHAPE_COMPLEMENT, .part = of, .parts = 1};
}

/* --- distances ---------------------------------------------------------------------------------------- */

static double box_distance(const cf_shape *s, const double p[3]) {
  double outside = 0, inside = -INFINITY;
  for (int a = 0; a < 3; ++a) {
    const double d = fabs(p[a] - s->a[a]) - s->b[a];
    inside = CF_MAX(inside, d);
    if (d > 0) outside += d * d;
  }
  return inside > 0 ? sqrt(outside) : inside;
}

static double capsule_distance(const cf_shape *s, const double p[3]) {
  double along = 0, length2 = 0;
  for (int a = 0; a < 3; ++a) {
    along += (p[a] - s->a[a]) * (s->b[a] - s->a[a]);
    length2 += (s->b[a] - s->a[a]) * (s->b[a] - s->a[a]);
  }
  const double t = length2 > 0 ? CF_MIN(CF_MAX(along / length2, 0), 1) : 0;
  double away[3];
  for (int a = 0; a < 3; ++a) away[a] = p[a] - s->a[a] - t * (s->b[a] - s->a[a]);
  return length_of(away) - s->radius;
}

/* Linear between samples; a place beyond them is moved to the nearest one, and that distance added. */
static double sampled_distance(const cf_samples *s, const double p[3]) {
  int i[3];
  double w[3], beyond[3];
  for (int a = 0; a < 3; ++a) {
    const double u = (p[a] - s->place[a]) / s->h, in = CF_MIN(CF_MAX(u, 0), s->n[a] - 1);
    i[a] = CF_MAX(CF_MIN((int)in, s->n[a] - 2), 0);
    w[a] = s->n[a] > 1 ? in - i[a] : 0;
    beyond[a] = s->n[a] > 1 ? (u - in) * s->h : 0;
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    ptrdiff_t at = 0, step = 1;
    for (int a = 0; a < 3; ++a) {
      const int up = c >> a & 1;
      weight *= up ? w[a] : 1 - w[a];
      at += step * CF_MIN(i[a] + up, s->n[a] - 1);
      step *= s->n[a];
    }
    if (weight != 0) sum += weight * (double)s->value[at];
  }
  return sum + length_of(beyond);
}

static double simple_distance(const cf_shape *s, const double p[3]) {
  const double away[3] = {p[0] - s->a[0], p[1] - s->a[1], p[2] - s->a[2]};
  switch (s->kind) {
    case CF_SHAPE_SPHERE:
      return length_of(away) - s->radius;
    case CF_SHAPE_BOX:
      return box_distance(s, p);
    case CF_SHAPE_CAPSULE:
      return capsule_distance(s, p);
    case CF_SHAPE_PLANE:
      return away[0] * s->b[0] + away[1] * s->b[1] + away[2] * s->b[2];
    default:
      return sampled_distance(s->samples, p);
  }
}

static void piece_distance(const cf_shape *s, const double t, const points *p, double *out) {
  switch (s->kind) {
    case CF_SHAPE_FUNCTION:
      cf_fn_row(&s->fn, p->n, p->at[0], p->at[1], p->at[2], t, out);
      return;
    case CF_SHAPE_UNION:
    case CF_SHAPE_INTERSECTION:
    case CF_SHAPE_COMPLEMENT: {
      const double sign = s->kind == CF_SHAPE_UNION ? 1 : -1;
      const double part_sign = s->kind == CF_SHAPE_INTERSECTION ? -1 : 1;
      double one[PIECE];
      for (int i = 0; i < p->n; ++i) out[i] = INFINITY;
      for (int v = 0; v < s->parts; ++v) {
        piece_distance(&s->part[v], t, p, one);
        for (int i = 0; i < p->n; ++i) out[i] = CF_MIN(out[i], part_sign * one[i]);
      }
      for (int i = 0; i < p->n; ++i) out[i] *= sign;
      return;
    }
    default:
      for (int i = 0; i < p->n; ++i) {
        const double place[3] = {p->at[0][i], p->at[1][i], p->at[2][i]};
        out[i] = simple_distance(s, place);
      }
  }
}

/* A place in space as one in the shape that was not moved: the turn undone. */
static void bring_back(const cf_pose *pose, double place[3]) {
  double v[3];
  for (int a = 0; a < 3; ++a) v[a] = place[a] - pose->pivot[a] - pose->shift[a];
  for (int a = 0; a < 3; ++a)
    place[a] = pose->pivot[a] + pose->turn[0][a] * v[0] + pose->turn[1][a] * v[1] + pose->turn[2][a] * v[2];
}

void cf_shape_distance_row(const cf_shape *s, const cf_pose *pose, const double t, const int n,
                           const double *x, const double *y, const double *z, double *out) {
  for (int from = 0; from < n; from += PIECE) {
    points p = {.n = CF_MIN(PIECE, n - from)};
    for (int i = 0; i < p.n; ++i) {
      double place[3] = {x[from + i], y[from + i], z[from + i]};
      if (pose != NULL) bring_back(pose, place);
      for (int a = 0; a < 3; ++a) p.at[a][i] = place[a];
    }
    piece_distance(s, t, &p, out + from);
  }
}

double cf_shape_distance(const cf_shape *s, const cf_pose *pose, const double t, const double place[3]) {
  double d;
  cf_shape_distance_row(s, pose, t, 1, &place[0], &place[1], &place[2], &d);
  return d;
}

void cf_shape_normal(const cf_shape *s, const cf_pose *pose, const double t, const double place[3],
                     const double step, double normal[3]) {
  for (int a = 0; a < 3; ++a) {
    double low[3], high[3];
    copy(place, low);
    copy(place, high);
    low[a] -= step;
    high[a] += step;
    normal[a] = cf_shape_distance(s, pose, t, high) - cf_shape_distance(s, pose, t, low);
  }
  const double length = length_of(normal);
  for (int a = 0; a < 3; ++a) normal[a] = length > 0 ? normal[a] / length : 0;
}

/* --- rigid motions ------------------------------------------------------------------------------------ */

cf_pose cf_pose_at_rest(void) { return (cf_pose){.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; }

/* Rotation by `angle` about the unit vector n (Rodrigues). */
static void turn_about(const double n[3], const double angle, double turn[3][3]) {
  const double c = cos(angle), s = sin(angle);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) turn[a][b] = (a == b ? c : 0) + (1 - c) * n[a] * n[b];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, d = (a + 2) % 3;
    turn[a][b] -= s * n[d];
    turn[b][a] += s * n[d];
  }
}

cf_pose cf_motion_at(const cf_motion *m, const double t, const double dt) {
  cf_pose p = cf_pose_at_rest();
  double n[3] = {0, 0, 1};
  const double length = length_of(m->axis);
  for (int a = 0; a < 3 && length > 0; ++a) n[a] = m->axis[a] / length;
  const double before = t - 0.5 * dt, after = t + 0.5 * dt;
  const double rate = (cf_fn_at(&m->angle, 0, 0, 0, after) - cf_fn_at(&m->angle, 0, 0, 0, before)) / dt;
  copy(m->pivot, p.pivot);
  for (int a = 0; a < 3; ++a) {
    const cf_fn *f = &m->shift[a];
    p.shift[a] = cf_fn_at(f, 0, 0, 0, t);
    p.velocity[a] = (cf_fn_at(f, 0, 0, 0, after) - cf_fn_at(f, 0, 0, 0, before)) / dt;
    p.spin[a] = rate * n[a];
  }
  turn_about(n, cf_fn_at(&m->angle, 0, 0, 0, t), p.turn);
  return p;
}

void cf_pose_velocity(const cf_pose *p, const double place[3], double u[3]) {
  double v[3];
  for (int a = 0; a < 3; ++a) v[a] = place[a] - p->pivot[a] - p->shift[a];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, d = (a + 2) % 3;
    u[a] = p->velocity[a] + p->spin[b] * v[d] - p->spin[d] * v[b];
  }
}

/* --- on a grid ---------------------------------------------------------------------------------------- */

cf_status cf_shape_sample(const cf_shape *s, const cf_pose *pose, const double t, const cf_grid *g,
                          const cf_cell distance) {
  const cf_box *b = &g->box;
  const int halo = b->halo, n = b->n[0] + 2 * halo, deep = b->dim == 3 ? halo : 0;
  double *x, *y, *z, *out;
  CF_TRY(CF_NEW(&x, 4 * n));
  y = x + n, z = y + n, out = z + n;
  for (int i = 0; i < n; ++i) x[i] = cf_grid_place(g, 0, i - halo, 0);
  for (int k = -deep; k < b->n[2] + deep; ++k)
    for (int j = -halo; j < b->n[1] + halo; ++j) {
      for (int i = 0; i < n; ++i) {
        y[i] = cf_grid_place(g, 1, j, 0);
        z[i] = b->dim == 3 ? cf_grid_place(g, 2, k, 0) : 0;
      }
      cf_shape_distance_row(s, pose, t, n, x, y, z, out);
      cf_real *row = distance.at + cf_box_at(b, -halo, j, k);
      for (int i = 0; i < n; ++i) row[i] = (cf_real)out[i];
    }
  cf_free(x);
  return CF_OK;
}

/* A box around the shape where it was given; infinite where there is none. */
static void bounds(const cf_shape *s, double low[3], double high[3]) {
  for (int a = 0; a < 3; ++a) low[a] = -INFINITY, high[a] = INFINITY;
  switch (s->kind) {
    case CF_SHAPE_SPHERE:
    case CF_SHAPE_BOX:
    case CF_SHAPE_CAPSULE:
      for (int a = 0; a < 3; ++a) {
        const double r = s->kind == CF_SHAPE_BOX ? s->b[a] : s->radius;
        const double other = s->kind == CF_SHAPE_CAPSULE ? s->b[a] : s->a[a];
        low[a] = CF_MIN(s->a[a], other) - r;
        high[a] = CF_MAX(s->a[a], other) + r;
      }
      return;
    case CF_SHAPE_SAMPLED: /* a body that reaches the border of its samples goes on there */
      for (int a = 0; a < 3; ++a) {
        if (s->samples->n[a] < 2) continue;
        low[a] = s->samples->place[a];
        high[a] = low[a] + (s->samples->n[a] - 1) * s->samples->h;
      }
      return;
    case CF_SHAPE_UNION:
    case CF_SHAPE_INTERSECTION: {
      const bool joined = s->kind == CF_SHAPE_UNION;
      for (int a = 0; a < 3 && joined; ++a) low[a] = INFINITY, high[a] = -INFINITY;
      for (int v = 0; v < s->parts; ++v) {
        double l[3], h[3];
        bounds(&s->part[v], l, h);
        for (int a = 0; a < 3; ++a) {
          low[a] = joined ? CF_MIN(low[a], l[a]) : CF_MAX(low[a], l[a]);
          high[a] = joined ? CF_MAX(high[a], h[a]) : CF_MIN(high[a], h[a]);
        }
      }
      return;
    }
    default:
      return;
  }
}

/* The box around a box that is turned and moved. */
static void move_bounds(const cf_pose *pose, double low[3], double high[3]) {
  double l[3], h[3];
  for (int a = 0; a < 3; ++a) {
    l[a] = h[a] = pose->pivot[a] + pose->shift[a];
    for (int b = 0; b < 3; ++b) {
      if (pose->turn[a][b] == 0) continue;
      const double u = pose->turn[a][b] * (low[b] - pose->pivot[b]);
      const double v = pose->turn[a][b] * (high[b] - pose->pivot[b]);
      l[a] += CF_MIN(u, v);
      h[a] += CF_MAX(u, v);
    }
  }
  copy(l, low);
  copy(h, high);
}

void cf_shape_cells(const cf_shape *s, const cf_pose *pose, const cf_grid *g, const int margin, int low[3],
                    int high[3]) {
  double l[3], h[3];
  bounds(s, l, h);
  if (pose != NULL) move_bounds(pose, l, h);
  for (int a = 0; a < 3; ++a) {
    low[a] = 0;
    high[a] = g->box.n[a];
    if (a >= g->box.dim) continue;
    const double first = floor((l[a] - g->origin[a]) / g->h - 0.5) - margin;
    const double last = ceil((h[a] - g->origin[a]) / g->h + 0.5) + margin;
    if (first > 0) low[a] = first < high[a] ? (int)first : high[a];
    if (last < high[a]) high[a] = last > low[a] ? (int)last : low[a];
  }
}
