/* SPDX-License-Identifier: MIT
 *
 * The explicit schemes' promises: bits, bounds, walls, failures. How accurate they are is in tests/order/test_wave.c.
 */
#include <string.h>

#include "base/mem.h"
#include "blob.h"

static cf_status rate(void *context, const double t, const cf_cell W) {
  const blob *b = context;
  FOR_CELLS(b, i, j, k) W.at[cf_box_at(&b->g.box, i, j, k)] = (cf_real)(i == 3 ? 1 + t : 0);
  return CF_OK;
}

static cf_status flux_rate(void *context, const double t, const cf_face B) {
  const blob *b = context;
  for (int a = 0; a < b->g.box.dim; ++a)
    for (int k = 0; k < cf_box_extent(&b->g.box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(&b->g.box, 1, a); ++j)
        for (int i = 0; i < cf_box_extent(&b->g.box, 0, a); ++i)
          B.at[a][cf_box_at(&b->g.box, i, j, k)] = (cf_real)(cos(t) * (a + 1) + 0.1 * i);
  return CF_OK;
}

static cf_status hold(void *context, const double t, const cf_cell fraction, const cf_cell value) {
  const blob *b = context;
  (void)t;
  FOR_CELLS(b, i, j, k) {
    fraction.at[cf_box_at(&b->g.box, i, j, k)] = (cf_real)(i == 5 && j == 2);
    value.at[cf_box_at(&b->g.box, i, j, k)] = 2;
  }
  return CF_OK;
}

/* Everything at once: walls of all kinds, all sources. */
static void open_all(blob *b, const cf_diffuse_scheme scheme, const int dim, const int threads) {
  uint64_t seed = 7;
  *b = (blob){.p = {.k = {.value = 0.5}, .tau = 0.3, .scheme = scheme, .front_filter = true}};
  b->walls.kind[0][0] = CF_WALL_RADIATE;
  b->walls.kind[0][1] = CF_WALL_OPEN;
  b->walls.kind[1][0] = b->walls.kind[1][1] = CF_WALL_PERIODIC;
  b->source = (cf_source){.rate = rate, .flux_rate = flux_rate, .hold = hold, .context = b};
  blob_open(b, dim, dim == 2 ? (int[]){130, 70} : (int[]){30, 20, 18}, 0.1, NULL);
  b->g.threads = threads;
  FOR_CELLS(b, i, j, k) * blob_at(b, i, j, k) = (cf_real)test_random(&seed);
  blob_start(b);
  blob_run(b, 0.4, 7);
}

static void same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  for (int s = CF_DIFFUSE_LEAPFROG; s <= CF_DIFFUSE_WAVE; ++s)
    for (int dim = 2; dim <= 3; ++dim) {
      blob one, four;
      open_all(&one, (cf_diffuse_scheme)s, dim, 1);
      open_all(&four, (cf_diffuse_scheme)s, dim, 4);
      FOR_CELLS(&one, i, j, k)
      assert_memory_equal(blob_at(&one, i, j, k), blob_at(&four, i, j, k), sizeof(cf_real));
      assert_memory_equal(&one.ledger, &four.ledger, sizeof one.ledger);
      CLOSE(blob_error(&one), 0, sizeof(cf_real) == 8 ? 1e-13 : 1e-5);
      assert_true(*blob_at(&one, 5, 2, 0) == 2); /* held, filter or not */
      blob_close(&one);
      blob_close(&four);
    }
}

/* The two halves of a mirrored start stay mirrored, bit for bit. */
static void mirrored_starts_stay_mirrored(void **state) {
  (void)state;
  for (int s = CF_DIFFUSE_LEAPFROG; s <= CF_DIFFUSE_WAVE; ++s) {
    const int n = 24;
    uint64_t seed = 19;
    blob b = {.p = {.k = {.value = 1}, .tau = 1, .scheme = (cf_diffuse_scheme)s, .front_filter = true}};
    blob_open(&b, 2, (int[]){n, n}, 0.125, NULL);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n / 2; ++i)
        *blob_at(&b, i, j, 0) = *blob_at(&b, n - 1 - i, j, 0) = (cf_real)test_random(&seed);
    blob_start(&b);
    blob_run(&b, 1, 20);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n / 2; ++i) assert_true(*blob_at(&b, i, j, 0) == *blob_at(&b, n - 1 - i, j, 0));
    blob_close(&b);
  }
}

/* --- positivity ------------------------------------------------------------------------------------------- */

/* A release at rest in a quarter of the plane, c = .4, tau = 1, t = .3: exact Cattaneo falls to -.196. */
static void release(blob *b, const bool positive, const double f_t) {
  const double w = 0.06, h = w / 6;
  *b = (blob){.p = {.k = {.value = 0.16},
                    .tau = 1,
                    .f_t = f_t,
                    .scheme = CF_DIFFUSE_LEAPFROG,
                    .front_filter = true,
                    .positive = positive}};
  blob_open(b, 2, (int[]){40, 40}, h, NULL);
  FOR_CELLS(b, i, j, k)
  *blob_at(b, i, j, k) = (cf_real)exp(-((i + 0.5) * (i + 0.5) + (j + 0.5) * (j + 0.5)) * h * h / (2 * w * w));
  blob_start(b);
}

static double least(const blob *b) {
  double low = INFINITY;
  FOR_CELLS(b, i, j, k) low = fmin(low, (double)*blob_at(b, i, j, k));
  return low;
}

static void positivity_keeps_zero_and_the_sum(void **state) {
  (void)state;
  for (int f = 0; f < 2; ++f) {
    blob free_one, limited;
    release(&free_one, false, f * 0.02);
    release(&limited, true, f * 0.02);
    double low = 0;
    blob_run(&free_one, 0.3, 15);
    for (int i = 0; i < 60; ++i) {
      blob_step(&limited, 0.02);
      low = fmin(low, least(&limited));
    }
    BELOW(least(&free_one), -0.1);
    assert_true(low >= 0);
    CLOSE(blob_error(&limited), 0, sizeof(cf_real) == 8 ? 1e-13 : 1e-5);
    blob_close(&free_one);
    blob_close(&limited);
  }
}

/* Along one axis the exact solution stays positive, and the limits hardly bind. */
static void positivity_changes_little_in_one_dimension(void **state) {
  (void)state;
  double wrong = 0, sum = 0;
  blob one[2];
  for (int p = 0; p < 2; ++p) {
    one[p] = (blob){.p = {.k = {.value = 1}, .tau = 1, .scheme = CF_DIFFUSE_LEAPFROG, .positive = p == 1}};
    blob_open(&one[p], 2, (int[]){200, 1}, 0.01, NULL);
    for (int i = 0; i < 200; ++i) one[p].phi.at[i] = (cf_real)exp(-(i - 99.5) * (i - 99.5) / (2 * 8 * 8));
    blob_start(&one[p]);
    blob_run(&one[p], 0.5, 50);
  }
  for (int i = 0; i < 200; ++i) {
    wrong += fabs((double)one[0].phi.at[i] - (double)one[1].phi.at[i]);
    sum += (double)one[0].phi.at[i];
  }
  print_message("positivity in 1D changes %.2g of the field\n", wrong / sum);
  BELOW(wrong / sum, 0.01);
  for (int p = 0; p < 2; ++p) blob_close(&one[p]);
}

/* --- failures --------------------------------------------------------------------------------------------- */

static void refused(const cf_diffuse_params *p, const char *word) {
  cf_grid g;
  cf_diffuse *d;
  const cf_walls walls = {0};
  OK(cf_grid_init(&g, 2, (int[]){4, 4}, 1, NULL));
  assert_int_equal(cf_diffuse_create(&d, &g, &walls, p, NULL), CF_BAD_ARGUMENT);
  assert_null(d);
  if (strstr(cf_status_sentence(), word) == NULL) fail_msg("%s: no %s in it", cf_status_sentence(), word);
}

static void what_a_scheme_cannot_do_is_refused(void **state) {
  (void)state;
  const cf_diffuse_params good = {.k = {.value = 1},
                                  .capacity = {.value = 1},
                                  .tau = 1,
                                  .scheme = CF_DIFFUSE_WAVE,
                                  .solver = {1e-6, 100}};
  cf_diffuse_params p = good;
  p.f_t = 0.1;
  refused(&p, "f_t = 0");
  p = good;
  p.tau = 0;
  refused(&p, "tau > 0");
  p = good;
  p.positive = true;
  refused(&p, "leapfrog");
}

static void too_many_substeps_are_refused_with_their_number(void **state) {
  (void)state;
  blob b = {.p = {.k = {.value = 1}, .tau = 0, .scheme = CF_DIFFUSE_LEAPFROG}};
  blob_open(&b, 2, (int[]){4, 4}, 1e-4, NULL);
  assert_int_equal(cf_diffuse_step(b.d, 0, 1, b.phi, b.q, &b.ledger, &b.report), CF_OVER_LIMIT);
  assert_non_null(strstr(cf_status_sentence(), "sdirk2"));
  blob_close(&b);
}

static void every_failed_allocation_is_a_status(void **state) {
  (void)state;
  cf_grid g;
  const cf_walls walls = walls_of(CF_WALL_RADIATE);
  OK(cf_grid_init(&g, 2, (int[]){6, 5}, 1, NULL));
  for (int s = CF_DIFFUSE_PAPER; s <= CF_DIFFUSE_WAVE; ++s) {
    const cf_diffuse_params p = {.k = {.value = 1},
                                 .capacity = {.value = 2},
                                 .tau = 1,
                                 .scheme = (cf_diffuse_scheme)s,
                                 .solver = {1e-6, 100},
                                 .front_filter = true};
    cf_diffuse *d = NULL;
    cf_status status = CF_NO_MEMORY;
    int n = 0;
    while (status == CF_NO_MEMORY) {
      cf_mem_fail_at(++n);
      status = cf_diffuse_create(&d, &g, &walls, &p,
                                 &(cf_source){.rate = rate, .flux_rate = flux_rate, .hold = hold});
      cf_mem_fail_at(0);
      if (status != CF_OK) assert_null(d);
    }
    OK(status);
    assert_true(n > 10);
    cf_diffuse_destroy(d);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_bits_for_any_number_of_threads),
      cmocka_unit_test(mirrored_starts_stay_mirrored),
      cmocka_unit_test(positivity_keeps_zero_and_the_sum),
      cmocka_unit_test(positivity_changes_little_in_one_dimension),
      cmocka_unit_test(what_a_scheme_cannot_do_is_refused),
      cmocka_unit_test(too_many_substeps_are_refused_with_their_number),
      cmocka_unit_test(every_failed_allocation_is_a_status),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
/* also in single precision */
