/* SPDX-License-Identifier: MIT
 *
 * The same problem told in another way gives the same numbers: turned (axes permuted), mirrored, shifted around a
 * periodic box, one cell thick in 3D, or cut at a plane of symmetry. To 1e-12, with the solver at 1e-13.
 */
#include "diffuse_case.h"

/* Everything that can break a symmetry at once: k and C vary, walls differ, a flux is there from the start. */
static double bump(const double x[3]) {
  return exp(-9 * (pow(x[0] - 0.3, 2) + pow(x[1] - 0.5, 2) + pow(x[2] - 0.4, 2))) + 0.2 * x[0];
}
static double k_of(const double x[3]) { return 0.2 + 0.1 * sin(5 * x[0]) * cos(4 * x[1] + x[2]); }
static double c_of(const double x[3]) { return 1 + 0.5 * cos(3 * x[0] + 2 * x[1] - x[2]); }
static double q_of(const double x[3], const int a) {
  return 0.1 * sin(3 * x[0] + a) * sin(4 * x[1]) * cos(x[2]);
}

/* How the axes of the problem lie in the grid: its axis a is grid axis at[a], mirrored where flip[a]. */
typedef struct placing {
  int at[3], flip[3];
  const double *size;
} placing;

static void told(const placing *p, const double grid[3], double x[3]) {
  for (int a = 0; a < 3; ++a) x[a] = p->flip[a] ? p->size[a] - grid[p->at[a]] : grid[p->at[a]];
}

static void k_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                  double *out) {
  (void)t;
  for (int i = 0; i < n; ++i) {
    double p[3];
    told(context, (const double[3]){x[i], y[i], z[i]}, p);
    out[i] = k_of(p);
  }
}

static void c_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                  double *out) {
  (void)t;
  for (int i = 0; i < n; ++i) {
    double p[3];
    told(context, (const double[3]){x[i], y[i], z[i]}, p);
    out[i] = c_of(p);
  }
}

static void begin(diffuse_case *c, const placing *p, const int n[3], const double h, const cf_walls *walls,
                  const int scheme) {
  int turned[3];
  for (int a = 0; a < 3; ++a) turned[p->at[a]] = n[a];
  *c = diffuse_case_of(3, turned, h);
  c->p.k = (cf_fn){.eval = k_row, .context = p};
  c->p.capacity = (cf_fn){.eval = c_row, .context = p};
  c->p.tau = 0.2;
  c->p.scheme = (cf_diffuse_scheme)scheme;
  c->p.f_t = 0.1;
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      c->walls.kind[p->at[a]][side] = walls->kind[a][p->flip[a] ? 1 - side : side];
      c->walls.value[p->at[a]][side] = walls->value[a][p->flip[a] ? 1 - side : side];
    }
  diffuse_begin(c);
  for (int a = -1; a < 3; ++a) /* a: axis of the problem */
    for (int k = 0; k < cf_box_extent(&c->g.box, 2, a < 0 ? -1 : p->at[a]); ++k)
      for (int j = 0; j < cf_box_extent(&c->g.box, 1, a < 0 ? -1 : p->at[a]); ++j)
        for (int i = 0; i < cf_box_extent(&c->g.box, 0, a < 0 ? -1 : p->at[a]); ++i) {
          const int g = a < 0 ? -1 : p->at[a], index[3] = {i, j, k};
          double grid[3], x[3];
          for (int b = 0; b < 3; ++b) grid[b] = cf_grid_place(&c->g, b, index[b], g == b);
          told(p, grid, x);
          if (a < 0)
            c->phi.at[cf_box_at(&c->g.box, i, j, k)] = (cf_real)bump(x);
          else if (index[g] > 0 && index[g] < c->g.box.n[g])
            c->q.at[g][cf_box_at(&c->g.box, i, j, k)] = (cf_real)(p->flip[a] ? -q_of(x, a) : q_of(x, a));
        }
  c->ledger.first = cf_diffuse_content(c->d, c->phi);
}

static void turned_and_mirrored_boxes_agree(void **state) {
  (void)state;
  const int n[3] = {14, 11, 9};
  const double h = 0.08, size[3] = {14 * h, 11 * h, 9 * h};
  cf_walls walls = {0};
  walls.kind[0][0] = CF_WALL_VALUE, walls.value[0][0] = cf_fn_constant(0.7);
  walls.kind[1][1] = CF_WALL_OPEN;
  walls.kind[2][0] = walls.kind[2][1] = CF_WALL_PERIODIC;
  const placing straight = {{0, 1, 2}, {0, 0, 0}, size};
  const placing others[] = {{{1, 2, 0}, {0, 0, 0}, size}, {{2, 0, 1}, {0, 0, 0}, size},
                            {{1, 0, 2}, {0, 0, 0}, size}, {{0, 1, 2}, {1, 0, 0}, size},
                            {{0, 1, 2}, {0, 1, 1}, size}, {{2, 1, 0}, {1, 1, 1}, size}};
  for (int scheme = CF_DIFFUSE_PAPER; scheme <= CF_DIFFUSE_SDIRK2; ++scheme) {
    diffuse_case first;
    begin(&first, &straight, n, h, &walls, scheme);
    diffuse_run(&first, 0.03, 6);
    for (int o = 0; o < 6; ++o) {
      diffuse_case c;
      begin(&c, &others[o], n, h, &walls, scheme);
      diffuse_run(&c, 0.03, 6);
      int at[3], in[3];
      for (at[2] = 0; at[2] < n[2]; ++at[2])
        for (at[1] = 0; at[1] < n[1]; ++at[1])
          for (at[0] = 0; at[0] < n[0]; ++at[0]) {
            for (int a = 0; a < 3; ++a) in[others[o].at[a]] = others[o].flip[a] ? n[a] - 1 - at[a] : at[a];
            CLOSE(cell_at(&c, in[0], in[1], in[2]), cell_at(&first, at[0], at[1], at[2]), 1e-12);
          }
      CLOSE(c.ledger.entered - c.ledger.left, first.ledger.entered - first.ledger.left, 1e-12);
      diffuse_end(&c);
    }
    diffuse_end(&first);
  }
}

static double flat(const void *context, double x, double y, double z) {
  (void)context, (void)z;
  return exp(-20 * ((x - 0.4) * (x - 0.4) + (y - 0.3) * (y - 0.3)));
}

/* A plane is a box one cell thick, whichever axis is thin. */
static void a_plane_is_a_box_one_cell_thick(void **state) {
  (void)state;
  for (int thin_walls = 0; thin_walls < 2; ++thin_walls)
    for (int thin = 0; thin < 3; ++thin) {
      const int u = thin == 0 ? 1 : 0, v = thin == 2 ? 1 : 2;
      int n[3] = {1, 1, 1};
      n[u] = 21, n[v] = 18;
      diffuse_case plane = diffuse_case_of(2, (int[3]){21, 18, 1}, 0.05), box = diffuse_case_of(3, n, 0.05);
      plane.p.tau = box.p.tau = 0.3;
      plane.walls.kind[0][0] = box.walls.kind[u][0] = CF_WALL_OPEN;
      for (int side = 0; side < 2; ++side) {
        plane.walls.kind[1][side] = box.walls.kind[v][side] = CF_WALL_PERIODIC;
        box.walls.kind[thin][side] = thin_walls ? CF_WALL_PERIODIC : CF_WALL_INSULATED;
      }
      diffuse_begin(&plane), diffuse_begin(&box);
      diffuse_fill(&plane, flat, NULL);
      for (int j = 0; j < 18; ++j)
        for (int i = 0; i < 21; ++i) {
          int at[3] = {0, 0, 0};
          at[u] = i, at[v] = j;
          box.phi.at[cf_box_at(&box.g.box, at[0], at[1], at[2])] =
              plane.phi.at[cf_box_at(&plane.g.box, i, j, 0)];
        }
      diffuse_run(&plane, 0.02, 10), diffuse_run(&box, 0.02, 10);
      for (int j = 0; j < 18; ++j)
        for (int i = 0; i < 21; ++i) {
          int at[3] = {0, 0, 0};
          at[u] = i, at[v] = j;
          CLOSE(cell_at(&box, at[0], at[1], at[2]), cell_at(&plane, i, j, 0), 1e-12);
        }
      diffuse_end(&plane), diffuse_end(&box);
    }
}

static double two_waves(const void *context, double x, double y, double z) {
  const double *shift = context, pi = acos(-1);
  (void)z;
  return 1 + sin(2 * pi * (x - shift[0])) * cos(4 * pi * (y - shift[1])) + exp(sin(2 * pi * (x - shift[0])));
}

static void a_periodic_box_has_no_beginning(void **state) {
  (void)state;
  const int n = 30, move[2] = {7, 19};
  diffuse_case c[2];
  for (int m = 0; m < 2; ++m) {
    c[m] = diffuse_case_of(2, (int[3]){n, n, 1}, 1.0 / n);
    c[m].p.tau = 0.3;
    c[m].p.k = cf_fn_constant(0.05);
    for (int a = 0; a < 2; ++a) c[m].walls.kind[a][0] = c[m].walls.kind[a][1] = CF_WALL_PERIODIC;
    diffuse_begin(&c[m]);
    const double shift[2] = {m * move[0] / 30.0, m * move[1] / 30.0};
    diffuse_fill(&c[m], two_waves, shift);
    diffuse_run(&c[m], 0.05, 10);
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      CLOSE(cell_at(&c[1], (i + move[0]) % n, (j + move[1]) % n, 0), cell_at(&c[0], i, j, 0), 1e-12);
  diffuse_end(&c[0]), diffuse_end(&c[1]);
}

static double even(const void *context, double x, double y, double z) {
  (void)context, (void)z;
  return exp(-7 * (x * x + (y - 0.3) * (y - 0.3)));
}

/* Half of an even problem, with an insulated wall in the middle. */
static void an_insulated_wall_is_a_mirror(void **state) {
  (void)state;
  diffuse_case whole = diffuse_case_of(2, (int[3]){32, 14, 1}, 0.05),
               half = diffuse_case_of(2, (int[3]){16, 14, 1}, 0.05);
  whole.g.origin[0] = -0.8;
  whole.p.tau = half.p.tau = 0.2;
  whole.walls.kind[0][0] = whole.walls.kind[0][1] = half.walls.kind[0][1] = CF_WALL_OPEN;
  diffuse_begin(&whole), diffuse_begin(&half);
  diffuse_fill(&whole, even, NULL), diffuse_fill(&half, even, NULL);
  diffuse_run(&whole, 0.03, 12), diffuse_run(&half, 0.03, 12);
  for (int j = 0; j < 14; ++j)
    for (int i = 0; i < 16; ++i) {
      CLOSE(cell_at(&whole, 16 + i, j, 0), cell_at(&half, i, j, 0), 1e-12);
      CLOSE(cell_at(&whole, 15 - i, j, 0), cell_at(&half, i, j, 0), 1e-12);
    }
  diffuse_end(&whole), diffuse_end(&half);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(turned_and_mirrored_boxes_agree),
      cmocka_unit_test(a_plane_is_a_box_one_cell_thick),
      cmocka_unit_test(a_periodic_box_has_no_beginning),
      cmocka_unit_test(an_insulated_wall_is_a_mirror),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
