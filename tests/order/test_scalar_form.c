/* SPDX-License-Identifier: MIT
 *
 * The flux kept as its divergence gives the same phi as the flux on faces: for every scheme that has both forms,
 * with k and C that vary, on every kind of wall but radiating ones, with sources and held cells. The ledger closes
 * in both.
 */
#include <string.h>

#include "blob.h"

static void bumpy(const void *context, const int n, const double *x, const double *y, const double *z,
                  const double t, double *out) {
  const double *c = context;
  for (int i = 0; i < n; ++i)
    out[i] = c[0] * (1 + c[1] * sin(7 * x[i] + 1) * cos(5 * y[i] - 2) * cos(3 * z[i])) + c[2] * sin(4 * t);
}

static const double K[] = {0.03, 0.8, 0}, CAPACITY[] = {1.5, 0.5, 0}, WALL[] = {0.4, 0.5, 0.3};

static cf_status rate(void *context, const double t, const cf_cell W) {
  const blob *b = context;
  FOR_CELLS(b, i, j, k) W.at[cf_box_at(&b->g.box, i, j, k)] = (cf_real)(i < 4 && j > 2 ? cos(9 * t) : 0);
  return CF_OK;
}

static cf_status hold(void *context, const double t, const cf_cell fraction, const cf_cell value) {
  const blob *b = context;
  FOR_CELLS(b, i, j, k) {
    const ptrdiff_t p = cf_box_at(&b->g.box, i, j, k);
    fraction.at[p] = (cf_real)(i >= 6 && i < 8 && j < 3 ? 0.25 + 0.75 * (i == 6) : 0);
    value.at[p] = (cf_real)(0.5 + t);
  }
  return CF_OK;
}

typedef struct variant {
  int dim;
  cf_diffuse_scheme scheme;
  double f_t, tau;
  bool walls, sources;
} variant;

static void make(blob *b, const variant *v, const bool scalar) {
  *b = (blob){.scalar = scalar};
  b->p = (cf_diffuse_params){.k = {.eval = bumpy, .context = K},
                             .capacity = {.eval = bumpy, .context = CAPACITY},
                             .tau = v->tau,
                             .f_t = v->f_t,
                             .scheme = v->scheme,
                             .solver = {1e-14, 300}};
  if (v->walls) {
    b->walls.kind[0][0] = CF_WALL_VALUE;
    b->walls.value[0][0] = (cf_fn){.eval = bumpy, .context = WALL, .in_time = true};
    b->walls.kind[0][1] = CF_WALL_OPEN;
    b->walls.kind[1][0] = b->walls.kind[1][1] = CF_WALL_PERIODIC;
  }
  if (v->sources) b->source = (cf_source){.rate = rate, .hold = hold, .context = b};
  blob_open(b, v->dim, (int[]){12, 10, 6}, 0.1, NULL);
  uint64_t seed = 5;
  FOR_CELLS(b, i, j, k) * blob_at(b, i, j, k) = (cf_real)test_random(&seed);
  blob_start(b);
}

/* The largest difference of the two forms after some steps. */
static double difference(const variant *v) {
  blob on_faces, scalar;
  double most = 0;
  make(&on_faces, v, false);
  make(&scalar, v, true);
  blob_run(&on_faces, 0.8, 8);
  blob_run(&scalar, 0.8, 8);
  const blob *b = &on_faces;
  FOR_CELLS(b, i, j, k)
  most = fmax(most, fabs((double)*blob_at(&on_faces, i, j, k) - (double)*blob_at(&scalar, i, j, k)));
  /* The paper's phi is the solver's: its ledger follows the tolerance. */
  const double round_off = v->scheme == CF_DIFFUSE_PAPER ? 1e-12 : 1e-13;
  CLOSE(blob_error(&scalar), 0, round_off);
  CLOSE(blob_error(&on_faces), 0, round_off);
  blob_close(&on_faces);
  blob_close(&scalar);
  return most;
}

static void both_forms_give_the_same_field(void **state) {
  (void)state;
  const cf_diffuse_scheme schemes[] = {CF_DIFFUSE_PAPER, CF_DIFFUSE_SDIRK2, CF_DIFFUSE_LEAPFROG};
  const double f_t[] = {0, 0.3, 1}, tau[] = {0, 1e-3, 0.5, (double)INFINITY};
  for (int s = 0; s < 3; ++s)
    for (int f = 0; f < 3; ++f)
      for (int t = 0; t < 4; ++t)
        for (int c = 0; c < 3; ++c) {
          const variant v = {c == 2 ? 3 : 2, schemes[s], f_t[f], tau[t], c > 0, c == 1};
          BELOW(difference(&v), 1e-13);
        }
}

static void what_needs_faces_is_refused(void **state) {
  (void)state;
  blob b = {.scalar = true, .p = {.k = {.value = 1}, .tau = 1, .scheme = CF_DIFFUSE_SDIRK2}};
  b.walls.kind[0][0] = CF_WALL_RADIATE;
  blob_open(&b, 2, (int[]){4, 4}, 1, NULL);
  assert_int_equal(cf_diffuse_step_scalar(b.d, 0, 1, b.phi, b.s, &b.ledger, &b.report), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "radiates"));
  blob_close(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(both_forms_give_the_same_field),
                                     cmocka_unit_test(what_needs_faces_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
