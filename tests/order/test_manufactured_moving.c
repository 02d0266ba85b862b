/* SPDX-License-Identifier: MIT
 *
 * Manufactured solution B (mms_B.csv): phi and q chosen freely in a cellular flow, variable k, periodic box; W and B are
 * what the equations then ask for. Advection (Strang) with diffusion must be of second order, for the objective and the
 * material rate. Derivatives of the chosen fields are taken by differences of them, exact to 1e-9; the table checks them.
 */
#include <math.h>

#include "grid/grid.h"
#include "physics/advect.h"
#include "physics/diffuse.h"
#include "reference.h"
#include "testing.h"

#define TP  6.283185307179586
#define TAU 0.4
#define F_T 0.3
#define EPS 2e-4

typedef double (*place_fn)(int which, double x, double y, double t);
static double phi_of(int w, double x, double y, double t) {
  (void)w;
  return 1 + 0.3 * cos(t) * sin(TP * x) * cos(TP * y);
}
static double k_of(int w, double x, double y, double t) {
  (void)w, (void)t;
  return 0.05 * (1 + 0.4 * sin(TP * x) * sin(TP * y));
}
static double q_of(int w, double x, double y, double t) {
  return w == 0 ? 0.1 * sin(t) * cos(TP * x) * sin(TP * y) : 0.2 * cos(2 * t) * sin(TP * x) * cos(TP * y);
}
static double u_of(int w, double x, double y, double t) {
  (void)t;
  return w == 0 ? sin(TP * x) * cos(TP * y) : -cos(TP * x) * sin(TP * y);
}
/* d f/d(axis 0, 1 or 2: time), fourth order. */
static double d(place_fn f, int w, int axis, double x, double y, double t) {
  const double e[3] = {axis == 0 ? EPS : 0, axis == 1 ? EPS : 0, axis == 2 ? EPS : 0};
  const double one = f(w, x + e[0], y + e[1], t + e[2]) - f(w, x - e[0], y - e[1], t - e[2]);
  const double two =
      f(w, x + 2 * e[0], y + 2 * e[1], t + 2 * e[2]) - f(w, x - 2 * e[0], y - 2 * e[1], t - 2 * e[2]);
  return (8 * one - two) / (12 * EPS);
}
static double fourier(int w, double x, double y, double t) {
  return -F_T * k_of(0, x, y, t) * d(phi_of, 0, w, x, y, t);
}
static double W_of(double x, double y, double t) {
  double sum = d(phi_of, 0, 2, x, y, t);
  for (int a = 0; a < 2; ++a)
    sum += u_of(a, x, y, t) * d(phi_of, 0, a, x, y, t) + d(q_of, a, a, x, y, t) + d(fourier, a, a, x, y, t);
  return sum;
}
static double B_of(int objective, int j, double x, double y, double t) {
  double b = d(q_of, j, 2, x, y, t) +
             (q_of(j, x, y, t) + (1 - F_T) * k_of(0, x, y, t) * d(phi_of, 0, j, x, y, t)) / TAU;
  for (int a = 0; a < 2; ++a) {
    b += u_of(a, x, y, t) * d(q_of, j, a, x, y, t);
    if (objective) b -= q_of(a, x, y, t) * d(u_of, j, a, x, y, t);
  }
  return b;
}

static void sources_are_those_of_the_table(void **state) {
  (void)state;
  table t = table_read("mms_B.csv");
  int compared = 0;
  for (int r = 0; r < t.rows; ++r) {
    if (table_at(&t, r, "d") != 2) continue;
    const double x = table_at(&t, r, "x"), y = table_at(&t, r, "y"), time = table_at(&t, r, "t");
    const int objective = table_at(&t, r, "objective") == 1;
    CLOSE(phi_of(0, x, y, time), table_at(&t, r, "phi"), 1e-12);
    CLOSE(W_of(x, y, time), table_at(&t, r, "W"), 1e-6);
    CLOSE(B_of(objective, 0, x, y, time), table_at(&t, r, "Bx"), 1e-6);
    CLOSE(B_of(objective, 1, x, y, time), table_at(&t, r, "By"), 1e-6);
    ++compared;
  }
  assert_int_equal(compared, 24);
  table_free(&t);
}

typedef struct setting {
  cf_grid g;
  int objective;
} setting;

#define EACH(s, i, j, extra)                          \
  for (int j = 0; j < (s)->g.box.n[1] + (extra); ++j) \
    for (int i = 0; i < (s)->g.box.n[0] + (extra); ++i)

static cf_status rate(void *context, const double t, const cf_cell W) {
  const setting *s = context;
  EACH(s, i, j, 0)
  W.at[cf_box_at(&s->g.box, i, j, 0)] = (cf_real)W_of((i + .5) * s->g.h, (j + .5) * s->g.h, t);
  return CF_OK;
}
static cf_status flux_rate(void *context, const double t, const cf_face B) {
  const setting *s = context;
  for (int a = 0; a < 2; ++a) EACH(s, i, j, 1)
  B.at[a][cf_box_at(&s->g.box, i, j, 0)] =
      (cf_real)B_of(s->objective, a, (i + (a == 0 ? 0 : .5)) * s->g.h, (j + (a == 1 ? 0 : .5)) * s->g.h, t);
  return CF_OK;
}
static void k_row(const void *c, int n, const double *x, const double *y, const double *z, double t,
                  double *out) {
  (void)c, (void)z;
  for (int i = 0; i < n; ++i) out[i] = k_of(0, x[i], y[i], t);
}
static void fill(const setting *s, const place_fn f, const double t, const cf_face out) {
  for (int a = 0; a < 2; ++a) EACH(s, i, j, 1)
  out.at[a][cf_box_at(&s->g.box, i, j, 0)] =
      (cf_real)f(a, (i + (a == 0 ? 0 : .5)) * s->g.h, (j + (a == 1 ? 0 : .5)) * s->g.h, t);
}

static double error_of(const int n, const int objective) {
  const int cells[2] = {n, n}, steps = n;
  const double end = 0.5, dt = end / steps;
  setting s = {.objective = objective};
  OK(cf_grid_init(&s.g, 2, cells, 1.0 / n, NULL));
  cf_walls walls = {0};
  for (int a = 0; a < 3; ++a) walls.kind[a][0] = walls.kind[a][1] = CF_WALL_PERIODIC;
  const cf_diffuse_params p = {.k = {.eval = k_row},
                               .capacity = {.value = 1},
                               .tau = TAU,
                               .f_t = F_T,
                               .scheme = CF_DIFFUSE_SDIRK2,
                               .solver = {1e-10, 100}};
  const cf_source source = {.rate = rate, .flux_rate = flux_rate, .context = &s};
  cf_cell phi;
  cf_face q, u;
  cf_diffuse *df;
  cf_advect *av;
  OK(cf_cell_create(&phi, &s.g.box));
  OK(cf_face_create(&q, &s.g.box));
  OK(cf_face_create(&u, &s.g.box));
  OK(cf_diffuse_create(&df, &s.g, &walls, &p, &source));
  OK(cf_advect_create(&av, &s.g, CF_ADVECT_WENO5));
  EACH(&s, i, j, 0) phi.at[cf_box_at(&s.g.box, i, j, 0)] = (cf_real)phi_of(0, (i + .5) / n, (j + .5) / n, 0);
  fill(&s, q_of, 0, q);
  fill(&s, u_of, 0, u);
  OK(cf_advect_set_velocity(av, u, &walls));
  cf_ledger ledger = {0};
  cf_solve_report report;
  for (int m = 0; m < steps; ++m)
    for (int part = 0; part < 3; ++part) {
      const double t = m * dt;
      if (part == 1) {
        OK(cf_diffuse_step(df, t, dt, phi, q, &ledger, &report));
        continue;
      }
      OK(cf_advect_begin(av, t + part * dt / 4, dt / 2));
      OK(cf_advect_cell(av, &walls, phi, NULL));
      OK(cf_advect_face(av, &walls, objective ? CF_RATE_OBJECTIVE : CF_RATE_MATERIAL, q));
    }
  double sum = 0;
  EACH(&s, i, j, 0) {
    const double e =
        (double)phi.at[cf_box_at(&s.g.box, i, j, 0)] - phi_of(0, (i + .5) / n, (j + .5) / n, end);
    sum += e * e / ((double)n * n);
  }
  cf_diffuse_destroy(df);
  cf_advect_destroy(av);
  cf_cell_destroy(&phi, &s.g.box);
  cf_face_destroy(&q, &s.g.box);
  cf_face_destroy(&u, &s.g.box);
  return sqrt(sum);
}

static void moving_fields_converge_with_second_order(void **state) {
  (void)state;
  for (int objective = 0; objective < 2; ++objective) {
    const double coarse = error_of(32, objective), fine = error_of(64, objective);
    printf("%s: %.3g, %.3g: order %.2f\n", objective ? "objective" : "material", coarse, fine,
           log2(coarse / fine));
    assert_true(log2(coarse / fine) >= 1.8);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sources_are_those_of_the_table),
                                     cmocka_unit_test(moving_fields_converge_with_second_order)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
