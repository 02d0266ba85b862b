/* SPDX-License-Identifier: MIT
 *
 * Marching cubes (Lorensen, Cline 1987) with the table of isosurface_table.h, on the lattice of cell centres. A vertex
 * sits where the field, linear along an edge of the lattice, has the level. For caps the lattice has one more layer
 * all around with the mirror images of the values inside, so that the level lies on the wall itself.
 *
 * Planes of the lattice are worked on side by side, twice: first vertices and triangles are counted, and sums over the
 * planes before say where those of a plane go; then they are made. Vertices of a plane come in the order edges along
 * x and y, then edges to the next plane; so both passes, and the planes beside, know each vertex' number without talking
 * to each other.
 *
 * Vertices are kept off the lattice points by a thousandth of h: triangles would have no area there, and no normal.
 *
 * Normals are the field's gradient, between the central differences at the ends of the edge. In a groove of one cell those
 * see the wall beyond it and may even point inwards; the difference along the edge itself cannot.
 */
#include "grid/isosurface.h"

#include <inttypes.h>
#include <math.h>
#include <omp.h>

#include "base/mem.h"
#include "grid/isosurface_table.h"

#define END   1e-3 /* as near to a lattice point as a vertex comes, in h */
#define STEEP 0.75 /* a normal goes along its edge for at least this part of the edge's difference */

typedef struct lattice {
  const cf_grid *g;
  const cf_real *f;
  double level, sign;       /* sign (f - level) > 0 inside */
  int low[3], high[3], pad; /* cells, and layers around them */
  int n[3];                 /* points */
} lattice;

/* Positive inside. In the layers around the cells what is inside has its mirror image. */
static double value_at(const lattice *l, const int i, const int j, const int k) {
  const int at[3] = {i, j, k};
  int cell[3];
  bool beyond = false;
  for (int a = 0; a < 3; ++a) {
    const int wanted = l->low[a] + at[a] - l->pad;
    cell[a] = CF_MAX(l->low[a], CF_MIN(wanted, l->high[a] - 1));
    beyond = beyond || cell[a] != wanted;
  }
  const double v = l->sign * ((double)l->f[cf_box_at(&l->g->box, cell[0], cell[1], cell[2])] - l->level);
  return beyond && v > 0 ? -v : v;
}

/* --- planes ----------------------------------------------------------------------------------------------- */

/* What a thread needs of two neighbouring planes. */
typedef struct planes {
  double *value[2];
  int32_t *flat[2]; /* number of the vertex on the edge along x, then y, of each point */
  int32_t *up;      /* on the edge to the next plane */
} planes;

typedef struct tally {
  int64_t flat, up, triangles;
} tally;

static size_t plane_size(const lattice *l) { return (size_t)l->n[0] * (size_t)l->n[1]; }

/* The row's inner points without asking where they are. */
static void load_row(const lattice *l, const int j, const int k, double *value) {
  const int last = l->n[0] - 1, y = l->low[1] + j - l->pad, z = l->low[2] + k - l->pad;
  value[0] = value_at(l, 0, j, k);
  value[last] = value_at(l, last, j, k);
  if (y < l->low[1] || y >= l->high[1] || z < l->low[2] || z >= l->high[2]) {
    for (int i = 1; i < last; ++i) value[i] = value_at(l, i, j, k);
  } else {
    const cf_real *f = l->f + cf_box_at(&l->g->box, l->low[0] - l->pad, y, z);
    for (int i = 1; i < last; ++i) value[i] = l->sign * ((double)f[i] - l->level);
  }
}

static void load(const lattice *l, const int k, double *value) {
  for (int j = 0; j < l->n[1]; ++j) load_row(l, j, k, value + (size_t)j * (size_t)l->n[0]);
}

/* Numbers the vertices on edges within a plane from `next` on; returns how many there are. */
static int64_t number_flat(const lattice *l, const double *value, int64_t next, int32_t *flat) {
  const int64_t first = next;
  for (int j = 0; j < l->n[1]; ++j)
    for (int i = 0; i < l->n[0]; ++i) {
      const size_t p = (size_t)j * (size_t)l->n[0] + (size_t)i;
      const bool inside = value[p] > 0;
      const bool x = i + 1 < l->n[0] && (value[p + 1] > 0) != inside;
      const bool y = j + 1 < l->n[1] && (value[p + (size_t)l->n[0]] > 0) != inside;
      if (x) flat[2 * p] = (int32_t)next++;
      if (y) flat[2 * p + 1] = (int32_t)next++;
    }
  return next - first;
}

static int64_t number_up(const lattice *l, const planes *s, int64_t next) {
  const int64_t first = next;
  for (size_t p = 0; p < plane_size(l); ++p)
    if ((s->value[0][p] > 0) != (s->value[1][p] > 0)) s->up[p] = (int32_t)next++;
  return next - first;
}

static size_t corner_offset(const lattice *l, const int c) {
  return (size_t)(c & 1) + (size_t)(c >> 1 & 1) * (size_t)l->n[0];
}

/* Which corners of the cube at p are inside. */
static int corners_inside(const lattice *l, const planes *s, const size_t p) {
  int inside = 0;
  for (int c = 0; c < 8; ++c) inside |= (s->value[c >> 2][p + corner_offset(l, c)] > 0) << c;
  return inside;
}

/* The number of the vertex on an edge of the cube at p. */
static int32_t vertex_on(const lattice *l, const planes *s, const size_t p, const int edge) {
  int c[2];
  cf_cube_corners(edge, c);
  const size_t q = p + corner_offset(l, c[0]);
  const int axis = edge / 4;
  return axis == 2 ? s->up[q] : s->flat[c[0] >> 2][2 * q + (size_t)axis];
}

/* Counts, or (corner not NULL) makes, the triangles between two planes. */
static int64_t triangulate(const lattice *l, const planes *s, const cf_cube table[256],
                           int32_t (*corner)[3]) {
  int64_t made = 0;
  for (int j = 0; j + 1 < l->n[1]; ++j)
    for (int i = 0; i + 1 < l->n[0]; ++i) {
      const size_t p = (size_t)j * (size_t)l->n[0] + (size_t)i;
      const cf_cube *cube = &table[corners_inside(l, s, p)];
      for (int t = 0; t < cube->triangles; ++t, ++made)
        for (int c = 0; corner != NULL && c < 3; ++c)
          corner[made][c] = vertex_on(l, s, p, cube->edge[3 * t + c]);
    }
  return made;
}

/* --- vertices --------------------------------------------------------------------------------------------- */

static void gradient(const lattice *l, const int at[3], double slope[3]) {
  for (int a = 0; a < 3; ++a) {
    int low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
    low[a] = CF_MAX(at[a] - 1, 0);
    high[a] = CF_MIN(at[a] + 1, l->n[a] - 1);
    slope[a] = (value_at(l, high[0], high[1], high[2]) - value_at(l, low[0], low[1], low[2])) /
               CF_MAX(high[a] - low[a], 1);
  }
}

static void make_vertex(const lattice *l, cf_mesh *mesh, const int32_t v, const int at[3], const int axis) {
  int to[3] = {at[0], at[1], at[2]};
  double from_slope[3], to_slope[3], normal[3], length = 0;
  to[axis] += 1;
  const double a = value_at(l, at[0], at[1], at[2]), b = value_at(l, to[0], to[1], to[2]);
  const double t = CF_MAX(END, CF_MIN(a / (a - b), 1 - END));
  gradient(l, at, from_slope);
  gradient(l, to, to_slope);
  for (int d = 0; d < 3; ++d) {
    const double place = l->low[d] + at[d] - l->pad + 0.5 + (d == axis ? t : 0);
    mesh->place[v][d] = (cf_real)(l->g->origin[d] + place * l->g->h);
    normal[d] = -((1 - t) * from_slope[d] + t * to_slope[d]);
    if (d == axis)
      normal[d] = a > b ? CF_MAX(normal[d], STEEP * (a - b)) : CF_MIN(normal[d], STEEP * (a - b));
    length += normal[d] * normal[d];
  }
  for (int d = 0; d < 3; ++d) mesh->normal[v][d] = (cf_real)(length > 0 ? normal[d] / sqrt(length) : 0);
}

static void make_vertices(const lattice *l, const planes *s, const int k, cf_mesh *mesh) {
  for (int j = 0; j < l->n[1]; ++j)
    for (int i = 0; i < l->n[0]; ++i) {
      const size_t p = (size_t)j * (size_t)l->n[0] + (size_t)i;
      const int at[3] = {i, j, k};
      const bool inside = s->value[0][p] > 0;
      if (i + 1 < l->n[0] && (s->value[0][p + 1] > 0) != inside)
        make_vertex(l, mesh, s->flat[0][2 * p], at, 0);
      if (j + 1 < l->n[1] && (s->value[0][p + (size_t)l->n[0]] > 0) != inside)
        make_vertex(l, mesh, s->flat[0][2 * p + 1], at, 1);
      if (k + 1 < l->n[2] && (s->value[1][p] > 0) != inside) make_vertex(l, mesh, s->up[p], at, 2);
    }
}

/* --- two passes ------------------------------------------------------------------------------------------- */

typedef struct job {
  lattice l;
  const cf_cube *table;
  planes *scratch; /* one a thread */
  tally *plane;    /* of each plane: how many, then how many before it */
  int threads;
} job;

static void count_plane(const job *w, const planes *s, const int k) {
  const lattice *l = &w->l;
  tally *t = &w->plane[k];
  load(l, k, s->value[0]);
  t->flat = number_flat(l, s->value[0], 0, s->flat[0]);
  if (k + 1 == l->n[2]) return;
  load(l, k + 1, s->value[1]);
  t->up = number_up(l, s, 0);
  t->triangles = triangulate(l, s, w->table, NULL);
}

static void make_plane(const job *w, const planes *s, const int k, cf_mesh *mesh) {
  const lattice *l = &w->l;
  const tally *t = &w->plane[k];
  load(l, k, s->value[0]);
  number_flat(l, s->value[0], t->flat, s->flat[0]);
  if (k + 1 < l->n[2]) {
    load(l, k + 1, s->value[1]);
    number_up(l, s, t->up);
    number_flat(l, s->value[1], t[1].flat, s->flat[1]);
    triangulate(l, s, w->table, mesh->corner + t->triangles);
  }
  make_vertices(l, s, k, mesh);
}

/* Counts become the numbers of the first ones. */
static cf_status sum_planes(const job *w, int64_t *vertices, int64_t *triangles) {
  *vertices = *triangles = 0;
  for (int k = 0; k < w->l.n[2]; ++k) {
    const tally t = w->plane[k];
    w->plane[k] = (tally){*vertices, *vertices + t.flat, *triangles};
    *vertices += t.flat + t.up;
    *triangles += t.triangles;
  }
  if (*vertices <= INT32_MAX && *triangles <= INT32_MAX) return CF_OK;
  return cf_fail(CF_OVER_LIMIT,
                 "a surface of %" PRId64 " vertices and %" PRId64 " triangles: at most %d each", *vertices,
                 *triangles, INT32_MAX);
}

static cf_status march(const job *w, cf_mesh *mesh) {
  int64_t vertices, triangles;
#pragma omp parallel num_threads(w->threads)
  {
    const planes *s = &w->scratch[omp_get_thread_num()];
#pragma omp for schedule(static)
    for (int k = 0; k < w->l.n[2]; ++k) count_plane(w, s, k);
  }
  CF_TRY(sum_planes(w, &vertices, &triangles));
  CF_TRY(cf_mesh_resize(mesh, vertices, triangles, true));
#pragma omp parallel num_threads(w->threads)
  {
    const planes *s = &w->scratch[omp_get_thread_num()];
#pragma omp for schedule(static)
    for (int k = 0; k < w->l.n[2]; ++k) make_plane(w, s, k, mesh);
  }
  return CF_OK;
}

static cf_status check(const cf_grid *g, const cf_isosurface *rule, lattice *l) {
  bool all = true;
  if (g->box.dim != 3)
    return cf_fail(CF_BAD_ARGUMENT, "a surface of a field in 2D: there are surfaces in 3D only");
  for (int a = 0; a < 3; ++a) all = all && rule->low[a] == 0 && rule->high[a] == 0;
  for (int a = 0; a < 3; ++a) {
    l->low[a] = all ? 0 : rule->low[a];
    l->high[a] = all ? g->box.n[a] : rule->high[a];
    if (l->low[a] < 0 || l->high[a] > g->box.n[a] || l->low[a] >= l->high[a])
      return cf_fail(CF_BAD_ARGUMENT, "a surface within cells %d to %d along axis %d, of %d", l->low[a],
                     l->high[a], a, g->box.n[a]);
    l->n[a] = l->high[a] - l->low[a] + 2 * l->pad;
  }
  return CF_OK;
}

static void free_scratch(job *w) {
  for (int t = 0; w->scratch != NULL && t < w->threads; ++t)
    for (int b = 0; b < 2; ++b) {
      cf_free(w->scratch[t].value[b]);
      cf_free(w->scratch[t].flat[b]);
    }
  for (int t = 0; w->scratch != NULL && t < w->threads; ++t) cf_free(w->scratch[t].up);
  cf_free(w->scratch);
  cf_free(w->plane);
}

static cf_status make_scratch(job *w) {
  const size_t size = plane_size(&w->l);
  CF_TRY(CF_NEW(&w->plane, w->l.n[2]));
  CF_TRY(CF_NEW(&w->scratch, w->threads));
  for (int t = 0; t < w->threads; ++t) {
    CF_TRY(CF_NEW(&w->scratch[t].up, size));
    for (int b = 0; b < 2; ++b) {
      CF_TRY(CF_NEW(&w->scratch[t].value[b], size));
      CF_TRY(CF_NEW(&w->scratch[t].flat[b], 2 * size));
    }
  }
  return CF_OK;
}

cf_status cf_isosurface_make(cf_mesh *mesh, const cf_grid *g, const cf_cell f, const cf_isosurface *rule) {
  cf_cube table[256];
  job w = {
      .l = {.g = g, .f = f.at, .level = rule->level, .sign = rule->below ? -1 : 1, .pad = rule->caps ? 1 : 0},
      .table = table,
      .threads = CF_MAX(1, g->threads)};
  CF_TRY(cf_mesh_resize(mesh, 0, 0, true));
  CF_TRY(check(g, rule, &w.l));
  cf_cube_table(table);
  cf_status s = make_scratch(&w);
  if (s == CF_OK) s = march(&w, mesh);
  free_scratch(&w);
  return s;
}
