/* SPDX-License-Identifier: MIT */
#include "stencil/stretch.h"

#include "grid/halo.h"
#include "grid/sweep.h"

/* One term q_e d_e u_a on a row of faces of axis a. */
typedef struct term {
  const cf_real *u, *q;       /* u_a and q_e, at the row */
  ptrdiff_t next, up, beside; /* to the next u_a and q_e along e, from a face back to the cell before it */
  cf_real low_weight, high_weight; /* of the edges below and above, dt/h included */
} term;

CF_KERNEL void term_row(const int n, const term *t, const cf_real *base, cf_real *to) {
  const cf_real *u = t->u, *q = t->q, low_weight = t->low_weight, high_weight = t->high_weight;
  const ptrdiff_t next = t->next, up = t->up, beside = t->beside;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real low = low_weight * (u[i] - u[i - next]) * ((q[i] + q[i - beside]) / 2);
    const cf_real high = high_weight * (u[i + next] - u[i]) * ((q[i + up] + q[i + up - beside]) / 2);
    to[i] = base[i] + (low + high);
  }
}
CF_CLONES static void run_term_row(const int n, const term *t, const cf_real *base, cf_real *to) {
  term_row(n, t, base, to);
}

typedef struct stretch {
  const cf_box *box;
  const cf_walls *walls;
  int component; /* a */
  cf_real w;     /* dt/h */
  cf_face u, from, base, to;
} stretch;

/* Element or row i of n along axis e; i = -1: inside. */
static void weigh(term *t, const stretch *s, const int e, const int i) {
  const int n = s->box->n[e];
  t->low_weight = t->high_weight = s->w / 2;
  if (e == s->component) return;
  const cf_wall low = s->walls->kind[e][0], high = s->walls->kind[e][1];
  if (i == 0 && low != CF_WALL_PERIODIC && low != CF_WALL_INSULATED)
    t->high_weight += t->low_weight, t->low_weight = 0;
  if (i == n - 1 && high != CF_WALL_PERIODIC && high != CF_WALL_INSULATED)
    t->low_weight += t->high_weight, t->high_weight = 0;
}

/* The term of axis e on a row, or on the piece of it that has the weights of index i along e. */
static void add_term(const stretch *s, const int e, const int i, const ptrdiff_t p, const int n) {
  const int a = s->component;
  const ptrdiff_t se = s->box->stride[e], sa = s->box->stride[a];
  term t = {.u = s->u.at[a] + p, .q = s->from.at[e] + p, .next = se, .up = se, .beside = sa};
  if (e == a) t.up = t.beside = 0; /* both edges are the face itself */
  weigh(&t, s, e, i);
  run_term_row(n, &t, (e == 0 ? s->base : s->to).at[a] + p, s->to.at[a] + p);
}

static void stretch_line(const stretch *s, const int j, const int k) {
  const int n = cf_box_extent(s->box, 0, s->component);
  const ptrdiff_t p = cf_box_at(s->box, 0, j, k);
  add_term(s, 0, 0, p, 1);
  if (n > 2) add_term(s, 0, -1, p + 1, n - 2);
  if (n > 1) add_term(s, 0, n - 1, p + n - 1, 1);
  add_term(s, 1, j, p, n);
  if (s->box->dim == 3) add_term(s, 2, k, p, n);
}

/* q.n = 0 on insulated walls. */
static void close_component(const cf_box *b, const cf_walls *walls, const int a, cf_real *q) {
  int low[3] = {0, 0, 0}, high[3] = {b->n[0], b->n[1], b->n[2]};
  for (int side = 0; side < 2; ++side) {
    if (walls->kind[a][side] != CF_WALL_INSULATED) continue;
    low[a] = side == 0 ? 0 : b->n[a];
    high[a] = low[a] + 1;
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; ++i) q[cf_box_at(b, i, j, k)] = 0;
  }
}

void cf_stretch_close(const cf_grid *g, const cf_walls *walls, const cf_face q) {
  for (int a = 0; a < g->box.dim; ++a) close_component(&g->box, walls, a, q.at[a]);
}

void cf_stretch(const cf_grid *g, const cf_walls *walls, const cf_face u, const double dt, const cf_face from,
                const cf_face base, const cf_face to) {
  const cf_box *b = &g->box;
  cf_halo halo = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = walls->kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  for (int a = 0; a < b->dim; ++a) cf_halo_fill(b, &halo, 1, a, from.at[a]);
  for (int a = 0; a < b->dim; ++a) {
    const stretch s = {b, walls, a, (cf_real)(dt / g->h), u, from, base, to};
    const int ny = cf_box_extent(b, 1, a), nz = cf_box_extent(b, 2, a);
#pragma omp parallel for schedule(static) num_threads(cf_sweep_threads(b, g->threads))
    for (int r = 0; r < ny * nz; ++r) stretch_line(&s, r % ny, r / ny);
  }
  cf_stretch_close(g, walls, to);
}
