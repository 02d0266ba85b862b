/* SPDX-License-Identifier: MIT
 *
 * All stages of a pass in one sweep through memory do what stage by stage does, to the bit: with any mix of walls and
 * periodic axes, where rows are long and short, tiles few and many, pieces whole and cut, whatever the threads.
 */
#include <string.h>

#include "solve/box_part.h"
#include "solve_case.h"

/* A number that any change of a bit of x would change. */
static uint64_t digest(const cf_box *b, const cf_cell x) {
  uint64_t sum = 1469598103934665603u;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j) {
      const unsigned char *row = (const unsigned char *)(x.at + cf_box_at(b, 0, j, k));
      for (size_t v = 0; v < (size_t)b->n[0] * sizeof(cf_real); ++v) sum = (sum ^ row[v]) * 1099511628211u;
    }
  return sum;
}

static uint64_t solved(const solve_case *c, const bool plain) {
  solve_setup s;
  cf_solve_report report;
  case_begin(c, &s);
  assert_non_null(s.A->box);
  s.A->box->wave.plain = plain;
  OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-6, 100}, s.x, &report));
  assert_true(report.converged);
  assert_string_equal(report.method, c->sigma > 2.5 ? "multigrid" : "sor");
  const uint64_t sum = digest(&s.g.box, s.x);
  case_end(&s);
  return sum;
}

static void compare(solve_case c) {
  c.threads = 1;
  c.side = SIDE_MIXED;
  const uint64_t reference = solved(&c, true);
  for (c.threads = 1; c.threads <= 3; ++c.threads)
    if (solved(&c, false) != reference)
      fail_msg("%d x %d x %d, %s, sigma %g, %d threads: other bits than stage by stage", c.n[0], c.n[1],
               c.n[2], c.walls, c.sigma, c.threads);
}

static void any_mix_of_walls_in_3d(void **state) {
  (void)state;
  static const char letters[] = "iop";
  static const int extent[][3] = {{32, 36, 34}, {64, 16, 40}, {20, 90, 20}};
  static const double sigma[] = {1, 20, INFINITY};
  for (int w = 0; w < 27; ++w) {
    const char walls[] = {letters[w / 9], letters[w / 3 % 3], letters[w % 3], 0};
    const int q = (w / 9 + w / 3 + w) % 3;
    compare((solve_case){.dim = 3,
                         .n = {extent[q][0], extent[q][1], extent[q][2]},
                         .walls = walls,
                         .sigma = sigma[(w / 3 + w) % 3]});
  }
}

/* Rows of one piece, of several, and of some whose last one is longer or ends in padding. */
static void any_mix_of_walls_in_2d(void **state) {
  (void)state;
  static const char letters[] = "iop";
  static const int extent[][2] = {{320, 128}, {1024, 48}, {1600, 34}, {2086, 40}};
  static const double sigma[] = {2, 20, INFINITY};
  for (int w = 0; w < 9; ++w)
    for (int q = 0; q < 4; ++q) {
      const char walls[] = {letters[w / 3], letters[w % 3], 0};
      compare((solve_case){
          .dim = 2, .n = {extent[q][0], extent[q][1], 1}, .walls = walls, .sigma = sigma[(w + q) % 3]});
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_mix_of_walls_in_3d),
      cmocka_unit_test(any_mix_of_walls_in_2d),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
