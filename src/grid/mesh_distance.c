/* SPDX-License-Identifier: MIT
 *
 * The signed distance of a closed mesh on a regular lattice of points.
 *
 * Size: points next to a triangle get their exact distance to it; the others take over the nearest triangle of a
 * neighbour where that is nearer than their own, in sweeps along all eight diagonals. (What a sweep hands on is a
 * triangle and not a number, so distances stay those to a real triangle.)
 *
 * Sign: rays along x, y and z through all points. A ray meets a triangle if its foot is inside the triangle's shadow; on
 * an edge of the shadow it counts as moved by an infinitely small step, the same for all triangles, so that it never
 * slips between two of them nor meets both. What lies behind an odd number of triangles is inside; two of the three
 * rays decide.
 */
#include <inttypes.h>
#include <math.h>

#include "base/mem.h"
#include "grid/mesh.h"

#define NONE (-1)

typedef struct lattice {
  const cf_mesh *mesh;
  int n[3];
  double place[3], h;
  float *value;           /* the distance */
  int32_t *nearest;       /* triangle, NONE at first */
  unsigned char *crossed; /* bit a: the ray along axis a has crossed an odd number of triangles */
} lattice;

static ptrdiff_t point_at(const lattice *l, const int i, const int j, const int k) {
  return i + (ptrdiff_t)l->n[0] * (j + (ptrdiff_t)l->n[1] * k);
}

static void corners_of(const cf_mesh *m, const int32_t t, double p[3][3]) {
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 3; ++a) p[c][a] = (double)m->place[m->corner[t][c]][a];
}

/* --- distance --------------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The square of the distance of x from the line between a and b. */
static double line_distance(const double a[3], const double b[3], const double x[3]) {
  double along[3], to[3];
  for (int d = 0; d < 3; ++d) along[d] = b[d] - a[d], to[d] = x[d] - a[d];
  const double length = dot(along, along);
  const double t = length > 0 ? CF_MAX(0, CF_MIN(dot(along, to) / length, 1)) : 0;
  for (int d = 0; d < 3; ++d) to[d] -= t * along[d];
  return dot(to, to);
}

/* The square of the distance of x from the triangle: from its plane where x is above it, else from a side. */
static double triangle_distance(const double p[3][3], const double x[3]) {
  double u[3], v[3], w[3];
  for (int d = 0; d < 3; ++d) u[d] = p[1][d] - p[0][d], v[d] = p[2][d] - p[0][d], w[d] = x[d] - p[0][d];
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double area = uu * vv - uv * uv, s = vv * wu - uv * wv, t = uu * wv - uv * wu;
  if (area > 0 && s >= 0 && t >= 0 && s + t <= area) {
    for (int d = 0; d < 3; ++d) w[d] -= (s * u[d] + t * v[d]) / area;
    return dot(w, w);
  }
  double least = line_distance(p[0], p[1], x);
  least = fmin(least, line_distance(p[1], p[2], x));
  return fmin(least, line_distance(p[2], p[0], x));
}

/* Triangle t for point (i, j, k), if it is nearer than what that has. */
static void offer(const lattice *l, const int32_t t, const int i, const int j, const int k) {
  const ptrdiff_t q = point_at(l, i, j, k);
  if (t == NONE || l->nearest[q] == t) return;
  const double x[3] = {l->place[0] + i * l->h, l->place[1] + j * l->h, l->place[2] + k * l->h};
  double p[3][3];
  corners_of(l->mesh, t, p);
  const float distance = (float)sqrt(triangle_distance((const double(*)[3])p, x));
  if (l->nearest[q] != NONE && distance >= l->value[q]) return;
  l->value[q] = distance;
  l->nearest[q] = t;
}

static void offer_around(const lattice *l, const int32_t t) {
  double p[3][3];
  int low[3], high[3];
  corners_of(l->mesh, t, p);
  for (int a = 0; a < 3; ++a) {
    const double least = fmin(p[0][a], fmin(p[1][a], p[2][a])), most = fmax(p[0][a], fmax(p[1][a], p[2][a]));
    low[a] = CF_MAX(0, (int)floor((least - l->place[a]) / l->h) - 1);
    high[a] = CF_MIN(l->n[a] - 1, (int)ceil((most - l->place[a]) / l->h) + 1);
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) offer(l, t, i, j, k);
}

/* One sweep; bit a of `way`: downwards along axis a. */
static void sweep(const lattice *l, const int way) {
  const int *n = l->n;
  int step[3];
  for (int a = 0; a < 3; ++a) step[a] = way >> a & 1 ? -1 : 1;
  for (int c = 0; c < n[2]; ++c)
    for (int b = 0; b < n[1]; ++b)
      for (int a = 0; a < n[0]; ++a) {
        const int at[3] = {step[0] > 0 ? a : n[0] - 1 - a, step[1] > 0 ? b : n[1] - 1 - b,
                           step[2] > 0 ? c : n[2] - 1 - c};
        for (int back = 1; back < 8; ++back) { /* the seven neighbours that the sweep has passed */
          const int i = at[0] - (back & 1) * step[0], j = at[1] - (back >> 1 & 1) * step[1];
          const int k = at[2] - (back >> 2) * step[2];
          if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) continue;
          offer(l, l->nearest[point_at(l, i, j, k)], at[0], at[1], at[2]);
        }
      }
}

/* --- sign ------------------------------------------------------------------------------------------------- */

/* On which side of the line from a to b the foot is, and twice the area that says so. Both triangles beside an edge
 * work out the same number, with opposite signs; 0 counts as the left of the end that is smaller in u, then v. */
static bool is_left(const double a[2], const double b[2], const double foot[2], double *area) {
  const bool turned = a[0] > b[0] || (a[0] == b[0] && a[1] > b[1]);
  const double *from = turned ? b : a, *to = turned ? a : b;
  const double twice = (to[0] - from[0]) * (foot[1] - from[1]) - (to[1] - from[1]) * (foot[0] - from[0]);
  *area = turned ? -twice : twice;
  return (twice >= 0) != turned;
}

/* Marks where the ray along `axis` with this foot crosses the triangle. */
static void cross_ray(const lattice *l, const double p[3][3], const int axis, const int row[2]) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double foot[2] = {l->place[u] + row[0] * l->h, l->place[v] + row[1] * l->h};
  double area[3], sum = 0, x = 0;
  int left = 0;
  for (int c = 0; c < 3; ++c) {
    const double a[2] = {p[(c + 1) % 3][u], p[(c + 1) % 3][v]}, b[2] = {p[(c + 2) % 3][u], p[(c + 2) % 3][v]};
    left += is_left(a, b, foot, &area[c]);
    sum += area[c];
  }
  if ((left != 0 && left != 3) || sum == 0) return;
  for (int c = 0; c < 3; ++c) x += area[c] / sum * p[c][axis];
  int at[3];
  const double first = ceil((x - l->place[axis]) / l->h);
  at[axis] = (int)CF_MAX(0, CF_MIN(first, l->n[axis] - 1));
  at[u] = row[0];
  at[v] = row[1];
  unsigned char *mark = &l->crossed[point_at(l, at[0], at[1], at[2])];
  *mark = (unsigned char)(*mark ^ 1 << axis);
}

static void cross_triangle(const lattice *l, const int32_t t, const int axis) {
  const int other[2] = {(axis + 1) % 3, (axis + 2) % 3};
  double p[3][3];
  int low[2], high[2], row[2];
  corners_of(l->mesh, t, p);
  for (int d = 0; d < 2; ++d) {
    const int a = other[d];
    const double least = fmin(p[0][a], fmin(p[1][a], p[2][a])), most = fmax(p[0][a], fmax(p[1][a], p[2][a]));
    low[d] = CF_MAX(0, (int)floor((least - l->place[a]) / l->h));
    high[d] = CF_MIN(l->n[a] - 1, (int)ceil((most - l->place[a]) / l->h));
  }
  for (row[1] = low[1]; row[1] <= high[1]; ++row[1])
    for (row[0] = low[0]; row[0] <= high[0]; ++row[0]) cross_ray(l, (const double(*)[3])p, axis, row);
}

/* Marks become: crossed so far. */
static void run_rays(const lattice *l, const int axis) {
  const ptrdiff_t stride[3] = {1, l->n[0], (ptrdiff_t)l->n[0] * l->n[1]};
  for (int k = 0; k < l->n[2]; ++k)
    for (int j = 0; j < l->n[1]; ++j)
      for (int i = 0; i < l->n[0]; ++i) {
        const int at[3] = {i, j, k};
        const ptrdiff_t q = point_at(l, i, j, k);
        if (at[axis] > 0)
          l->crossed[q] = (unsigned char)(l->crossed[q] ^ (l->crossed[q - stride[axis]] & 1 << axis));
      }
}

/* --- all of it -------------------------------------------------------------------------------------------- */

static cf_status lay_out(lattice *l, const int margin) {
  cf_mesh_facts f;
  double points = 1;
  CF_TRY(cf_mesh_look(l->mesh, &f));
  if (l->mesh->triangles == 0) return cf_fail(CF_BAD_ARGUMENT, "the mesh has no triangles");
  for (int a = 0; a < 3; ++a) {
    const double cells = ceil((f.high[a] - f.low[a]) / l->h) + 1;
    if (!isfinite(cells)) return cf_fail(CF_BAD_ARGUMENT, "the mesh has corners that are no places");
    if (cells > 1 << 20)
      return cf_fail(CF_OVER_LIMIT,
                     "the mesh is %.6g m long, too long for its distance every %.6g m: is its size in m?",
                     f.high[a] - f.low[a], l->h);
    l->n[a] = (int)cells + 1 + 2 * margin;
    l->place[a] = (f.low[a] + f.high[a]) / 2 - l->h * (l->n[a] - 1) / 2;
    points *= l->n[a];
  }
  if (points > INT32_MAX)
    return cf_fail(CF_OVER_LIMIT, "the distance of the mesh at %d x %d x %d points: more than 2^31", l->n[0],
                   l->n[1], l->n[2]);
  CF_TRY(CF_NEW(&l->value, points));
  CF_TRY(CF_NEW(&l->nearest, points));
  return CF_NEW(&l->crossed, points);
}

static void fill(lattice *l) {
  const ptrdiff_t points = (ptrdiff_t)l->n[0] * l->n[1] * l->n[2];
  const int32_t triangles = (int32_t)l->mesh->triangles;
  for (ptrdiff_t q = 0; q < points; ++q) l->nearest[q] = NONE;
  for (int32_t t = 0; t < triangles; ++t) offer_around(l, t);
  for (int way = 0; way < 8; ++way) sweep(l, way);
  for (int axis = 0; axis < 3; ++axis) {
    for (int32_t t = 0; t < triangles; ++t) cross_triangle(l, t, axis);
    run_rays(l, axis);
  }
  for (ptrdiff_t q = 0; q < points; ++q) {
    const int c = l->crossed[q];
    if ((c & 1) + (c >> 1 & 1) + (c >> 2 & 1) >= 2) l->value[q] = -l->value[q];
  }
}

cf_status cf_mesh_distance(const cf_mesh *mesh, const double h, const int margin, cf_samples *samples) {
  lattice l = {.mesh = mesh, .h = h};
  *samples = (cf_samples){.h = h};
  if (!(h > 0) || margin < 0)
    return cf_fail(CF_BAD_ARGUMENT, "the distance of a mesh every %g m with a margin of %d points", h,
                   margin);
  const cf_status s = lay_out(&l, margin);
  if (s == CF_OK) fill(&l);
  cf_free(l.nearest);
  cf_free(l.crossed);
  if (s != CF_OK) {
    cf_free(l.value);
    return s;
  }
  for (int a = 0; a < 3; ++a) samples->n[a] = l.n[a], samples->place[a] = l.place[a];
  samples->value = l.value;
  return CF_OK;
}
