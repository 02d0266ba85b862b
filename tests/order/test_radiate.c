/* SPDX-License-Identifier: MIT
 *
 * Radiating walls: a pulse that runs into one leaves. What is left of it is compared with what a box too large for
 * the pulse to reach its walls holds at the same place; an insulated wall keeps .5 of the pulse of tau = 100 and .3
 * of that of tau = 1. Without waves a radiating wall holds its value. The ledger closes.
 */
#include <string.h>

#include "blob.h"

/* A Gaussian in the middle of n cells of an axis of length 1 (more cells of the same size: a longer box). */
static void open_pulse(blob *b, const cf_wall kind, const int n, const int cells,
                       const cf_diffuse_scheme scheme, const double tau) {
  const double h = 1.0 / n;
  *b = (blob){.p = {.k = {.value = tau}, .tau = tau, .scheme = scheme}};
  b->walls.kind[0][0] = b->walls.kind[0][1] = kind;
  blob_open(b, 2, (int[]){cells, 1}, h, (double[]){-cells * h / 2, 0});
  for (int i = 0; i < cells; ++i) {
    const double x = (i + 0.5 - cells / 2.0) * h;
    b->phi.at[i] = (cf_real)exp(-x * x / (2 * 0.05 * 0.05));
  }
  blob_start(b);
}

/* The largest |phi - phi of the large box|, of a pulse of height 1, after the pulses have met the walls. */
static double echo(const cf_wall kind, const cf_diffuse_scheme scheme, const double tau,
                   const double courant) {
  const int n = 128, far = 5 * n;
  blob b, large;
  open_pulse(&b, kind, n, n, scheme, tau);
  open_pulse(&large, CF_WALL_INSULATED, n, far, scheme, tau);
  const double end = 0.85;
  blob_run(&b, end, (int)(n * end / courant));
  blob_run(&large, end, (int)(n * end / courant));
  double most = 0;
  for (int i = 0; i < n; ++i)
    most = fmax(most, fabs((double)b.phi.at[i] - (double)large.phi.at[i + (far - n) / 2]));
  CLOSE(blob_error(&b), 0, 1e-13);
  blob_close(&b);
  blob_close(&large);
  return most;
}

static void a_pulse_leaves(void **state) {
  (void)state;
  const char *const names[] = {"sdirk2", "leapfrog", "wave"};
  print_message("what a pulse leaves behind      tau = 100   tau = 1\n");
  print_message("  sdirk2, insulated walls      %9.4f %9.4f\n",
                echo(CF_WALL_INSULATED, CF_DIFFUSE_SDIRK2, 100, 1),
                echo(CF_WALL_INSULATED, CF_DIFFUSE_SDIRK2, 1, 1));
  print_message("  sdirk2, open walls           %9.4f %9.4f\n", echo(CF_WALL_OPEN, CF_DIFFUSE_SDIRK2, 100, 1),
                echo(CF_WALL_OPEN, CF_DIFFUSE_SDIRK2, 1, 1));
  for (int s = 0; s < 3; ++s) {
    const cf_diffuse_scheme scheme = (cf_diffuse_scheme)(CF_DIFFUSE_SDIRK2 + s);
    const double waves = echo(CF_WALL_RADIATE, scheme, 100, 1), damped = echo(CF_WALL_RADIATE, scheme, 1, 1);
    print_message("  %-8s radiating walls     %9.4f %9.4f\n", names[s], waves, damped);
    BELOW(waves, 5e-3);
    BELOW(damped, 1.5e-2);
  }
}

static void tilted(const void *context, const int n, const double *x, const double *y, const double *z,
                   const double t, double *out) {
  (void)context, (void)z;
  for (int i = 0; i < n; ++i) out[i] = 1 + 0.5 * sin(3 * x[i] + 4 * y[i]) + 0.2 * sin(5 * t);
}

static void varied(const void *context, const int n, const double *x, const double *y, const double *z,
                   const double t, double *out) {
  (void)context, (void)t;
  for (int i = 0; i < n; ++i) out[i] = 1.2 + sin(5 * x[i] - 3 * y[i]) * cos(2 * z[i]);
}

/* All walls of one kind around a box with a random start; values from `tilted`. */
static void open_box(blob *b, const cf_wall kind, const cf_diffuse_params *p, const int dim) {
  uint64_t seed = 11;
  *b = (blob){.p = *p};
  for (int a = 0; a < dim; ++a)
    for (int side = 0; side < 2; ++side) {
      b->walls.kind[a][side] = kind;
      b->walls.value[a][side] = (cf_fn){.eval = tilted, .in_time = true};
    }
  blob_open(b, dim, (int[]){14, 9, 6}, 0.1, NULL);
  FOR_CELLS(b, i, j, k) * blob_at(b, i, j, k) = (cf_real)test_random(&seed);
  blob_start(b);
}

static double largest_difference(const blob *a, const blob *b) {
  double most = 0;
  FOR_CELLS(a, i, j, k)
  most = fmax(most, fabs((double)*blob_at(a, i, j, k) - (double)*blob_at(b, i, j, k)));
  return most;
}

static void without_waves_the_wall_is_held(void **state) {
  (void)state;
  const double tau[] = {0, 1e-13, 0.3}, f_t[] = {0, 0, 1};
  for (int c = 0; c < 3; ++c) {
    blob radiating, held;
    const cf_diffuse_params p = {.k = {.eval = varied},
                                 .tau = tau[c],
                                 .f_t = f_t[c],
                                 .scheme = CF_DIFFUSE_SDIRK2,
                                 .solver = {1e-13, 300}};
    open_box(&radiating, CF_WALL_RADIATE, &p, 2);
    open_box(&held, CF_WALL_VALUE, &p, 2);
    blob_run(&radiating, 0.1, 5);
    blob_run(&held, 0.1, 5);
    BELOW(largest_difference(&radiating, &held), c == 1 ? 1e-4 : 1e-11);
    blob_close(&radiating);
    blob_close(&held);
  }
}

static void the_ledger_closes(void **state) {
  (void)state;
  const cf_diffuse_scheme schemes[] = {CF_DIFFUSE_SDIRK2, CF_DIFFUSE_LEAPFROG, CF_DIFFUSE_WAVE};
  for (int s = 0; s < 3; ++s)
    for (int c = 0; c < 4; ++c) {
      blob b;
      const bool wave = schemes[s] == CF_DIFFUSE_WAVE;
      cf_diffuse_params p = {.k = {.value = 0.5}, .tau = 0.5, .scheme = schemes[s], .solver = {1e-4, 300}};
      if (c % 2 && !wave) p.k = p.capacity = (cf_fn){.eval = varied};
      if (c / 2 && !wave) p.f_t = 0.2;
      open_box(&b, CF_WALL_RADIATE, &p, 3);
      blob_run(&b, 0.5, 12);
      CLOSE(blob_error(&b), 0, 1e-13);
      assert_true(b.ledger.entered + b.ledger.left > 0.01);
      blob_close(&b);
    }
}

/* The medium at phi_inf everywhere stays so. */
static void nothing_happens_at_the_value_of_the_wall(void **state) {
  (void)state;
  for (int s = 0; s < 3; ++s) {
    blob b = {.p = {.k = {.value = 2}, .tau = 0.1, .scheme = (cf_diffuse_scheme)(CF_DIFFUSE_SDIRK2 + s)}};
    for (int a = 0; a < 2; ++a)
      for (int side = 0; side < 2; ++side) {
        b.walls.kind[a][side] = CF_WALL_RADIATE;
        b.walls.value[a][side] = cf_fn_constant(3);
      }
    blob_open(&b, 2, (int[]){8, 5}, 0.2, NULL);
    FOR_CELLS(&b, i, j, k) * blob_at(&b, i, j, k) = 3;
    blob_start(&b);
    blob_run(&b, 1, 10);
    FOR_CELLS(&b, i, j, k) CLOSE(*blob_at(&b, i, j, k), 3, 1e-9);
    blob_close(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pulse_leaves), cmocka_unit_test(without_waves_the_wall_is_held),
      cmocka_unit_test(the_ledger_closes), cmocka_unit_test(nothing_happens_at_the_value_of_the_wall)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
