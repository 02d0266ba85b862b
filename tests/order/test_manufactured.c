/* SPDX-License-Identifier: MIT
 *
 * A manufactured solution with a source W, variable k and insulated walls in [0, 1]^d (mms_A.csv):
 *
 *     phi = 1 + g(t) m,   m = prod cos(j_l pi x_l),   k = k0 (1 + 1/2 prod cos(pi x_l)),   g = cos(w t),
 *     q_C = (1 - F) k grad m p(t),   tau p' + p = -g,   W = g' m + ((1 - F) p - F g) div(k grad m).
 *
 * The default scheme converges with second order in h and dt together, phi and q, in 2D and in 3D.
 */
#include "diffuse_case.h"
#include "reference.h"

static const double omega = 1.4 * 3.14159265358979324, pi = 3.14159265358979324;
static const int wave[3] = {1, 2, 1};

typedef struct made {
  int dim;
  double k0, tau, F;
  const cf_grid *g;
} made;

static double g_of(const double t) { return cos(omega * t); }
static double p_of(const made *m, const double t) {
  const double wt = omega * m->tau;
  return -(cos(omega * t) + wt * sin(omega * t)) / (1 + wt * wt);
}

static double k_at(const made *m, const double x[3]) {
  double product = 1;
  for (int a = 0; a < m->dim; ++a) product *= cos(pi * x[a]);
  return m->k0 * (1 + 0.5 * product);
}

/* m, grad m and div(k grad m). */
static double shape(const made *m, const double x[3], double grad[3], double *spread) {
  double value = 1, kk[3], laplace = 0;
  for (int a = 0; a < m->dim; ++a) {
    value *= cos(wave[a] * pi * x[a]);
    grad[a] = -wave[a] * pi * sin(wave[a] * pi * x[a]);
    kk[a] = -0.5 * m->k0 * pi * sin(pi * x[a]);
    for (int b = 0; b < m->dim; ++b)
      if (b != a) grad[a] *= cos(wave[b] * pi * x[b]), kk[a] *= cos(pi * x[b]);
    laplace += wave[a] * wave[a];
  }
  *spread = -k_at(m, x) * value * pi * pi * laplace;
  for (int a = 0; a < m->dim; ++a) *spread += kk[a] * grad[a];
  return value;
}

static void exact(const made *m, const double x[3], const double t, double *phi, double q[3], double *W) {
  double grad[3], spread;
  const double value = shape(m, x, grad, &spread);
  *phi = 1 + g_of(t) * value;
  for (int a = 0; a < m->dim; ++a) q[a] = (1 - m->F) * k_at(m, x) * grad[a] * p_of(m, t);
  *W = -omega * sin(omega * t) * value + ((1 - m->F) * p_of(m, t) - m->F * g_of(t)) * spread;
}

static void k_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                  double *out) {
  (void)t;
  for (int i = 0; i < n; ++i) out[i] = k_at(context, (const double[3]){x[i], y[i], z[i]});
}

static cf_status source(void *context, double t, cf_cell W) {
  const made *m = context;
  const cf_box *b = &m->g->box;
  double phi, q[3], w;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const double x[3] = {cf_grid_place(m->g, 0, i, 0), cf_grid_place(m->g, 1, j, 0),
                             cf_grid_place(m->g, 2, k, 0)};
        exact(m, x, t, &phi, q, &w);
        W.at[cf_box_at(b, i, j, k)] = (cf_real)w;
      }
  return CF_OK;
}

static void formulas_match_the_reference(void **state) {
  (void)state;
  table t = table_read("mms_A.csv");
  for (int row = 0; row < t.rows; ++row) {
    const made m = {(int)table_at(&t, row, "d"), table_at(&t, row, "k0"), table_at(&t, row, "tau"),
                    table_at(&t, row, "F"), NULL};
    const double x[3] = {table_at(&t, row, "x"), table_at(&t, row, "y"), table_at(&t, row, "z")};
    double phi, q[3], W;
    exact(&m, x, table_at(&t, row, "t"), &phi, q, &W);
    CLOSE(k_at(&m, x), table_at(&t, row, "k"), 1e-12);
    CLOSE(phi, table_at(&t, row, "phi"), 1e-12);
    CLOSE(q[0], table_at(&t, row, "qx"), 1e-12);
    CLOSE(q[1], table_at(&t, row, "qy"), 1e-12);
    if (m.dim == 3) CLOSE(q[2], table_at(&t, row, "qz"), 1e-12);
    CLOSE(W, table_at(&t, row, "W"), 1e-11);
  }
  assert_int_equal(t.rows, 24);
  table_free(&t);
}

/* Root mean square errors of phi and of q_C (times sqrt(tau/k0), which makes it a phi). */
static void errors(const int dim, const int n, const cf_diffuse_scheme scheme, double e[2]) {
  made m = {dim, 0.05, 0.4, 0.3, NULL};
  diffuse_case c = diffuse_case_of(dim, (int[3]){n, n, n}, 1.0 / n);
  m.g = &c.g;
  c.p.k = (cf_fn){.eval = k_row, .context = &m};
  c.p.tau = m.tau;
  c.p.f_t = m.F;
  c.p.scheme = scheme;
  c.p.solver.tolerance = 1e-9;
  c.source = (cf_source){.rate = source, .context = &m};
  diffuse_begin(&c);
  double q[3], phi, W;
  for (int pass = 0; pass < 2; ++pass) {
    double sum[2] = {0, 0};
    int faces = 0;
    for (int a = -1; a < dim; ++a)
      for (int k = 0; k < cf_box_extent(&c.g.box, 2, a); ++k)
        for (int j = 0; j < cf_box_extent(&c.g.box, 1, a); ++j)
          for (int i = 0; i < cf_box_extent(&c.g.box, 0, a); ++i) {
            const double x[3] = {cf_grid_place(&c.g, 0, i, a == 0), cf_grid_place(&c.g, 1, j, a == 1),
                                 cf_grid_place(&c.g, 2, k, a == 2)};
            exact(&m, x, c.t, &phi, q, &W);
            cf_real *at =
                a < 0 ? &c.phi.at[cf_box_at(&c.g.box, i, j, k)] : &c.q.at[a][cf_box_at(&c.g.box, i, j, k)];
            const double off = (double)*at - (a < 0 ? phi : q[a]);
            if (pass == 0) *at = (cf_real)(a < 0 ? phi : q[a]);
            sum[a < 0 ? 0 : 1] += off * off;
            faces += a >= 0;
          }
    e[0] = sqrt(sum[0] / (double)cf_box_cells(&c.g.box));
    e[1] = sqrt(sum[1] / faces * m.tau / m.k0);
    if (pass == 0) c.ledger.first = cf_diffuse_content(c.d, c.phi);
    if (pass == 0) diffuse_run(&c, 1.0 / n, 3 * n / 4);
  }
  BELOW(fabs(diffuse_ledger_error(&c)), 1e-13);
  diffuse_end(&c);
}

static void the_default_is_of_second_order(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    double before[2] = {0, 0};
    for (int n = dim == 2 ? 16 : 8; n <= (dim == 2 ? 128 : 32); n *= 2) {
      double e[2];
      errors(dim, n, CF_DIFFUSE_SDIRK2, e);
      if (before[0] > 0) {
        const double order[2] = {order_of(before[0], e[0]), order_of(before[1], e[1])};
        print_message("%dD n = %-4d L2 %.2e, %.2e  orders %.2f (phi), %.2f (q)\n", dim, n, e[0], e[1],
                      order[0], order[1]);
        if (n > 16) BELOW(1.85, order[0]);
        if (n > 16) BELOW(1.85, order[1]);
      }
      before[0] = e[0], before[1] = e[1];
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(formulas_match_the_reference),
      cmocka_unit_test(the_default_is_of_second_order),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
