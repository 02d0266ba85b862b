/* SPDX-License-Identifier: MIT
 *
 * The n-th allocation fails, for every n until the call succeeds: each call answers CF_NO_MEMORY and leaves nothing
 * behind (the sanitizers and valgrind watch the blocks; the pages of fields are counted here).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "diffuse_case.h"
#include "grid/registry.h"
#include "solve_case.h"

/* Mapped address space of this process, in kB; 0 where the system does not tell, or where a tool that watches
 * memory maps its own. */
static long mapped(void) {
  if (test_memory_is_watched()) return 0;
  char line[256];
  long size = 0;
  FILE *f = fopen("/proc/self/status", "r");
  if (f == NULL) return 0;
  while (fgets(line, sizeof line, f) != NULL)
    if (sscanf(line, "VmSize: %ld", &size) == 1) break;
  fclose(f);
  return size;
}

/* Runs `attempt` with ever later failures; it returns what the call returned and undoes a success itself. */
static void walk(cf_status (*attempt)(void *), void *context, const char *what, const int least) {
  long before = 0;
  for (int n = 1; n < 2000; ++n) {
    cf_mem_fail_at(n);
    const cf_status s = attempt(context);
    cf_mem_fail_at(0);
    if (n == 1) before = mapped(); /* the first failure may have grown the C library's own arena */
    if (s == CF_OK) {
      print_message("%s: %d allocations\n", what, n - 1);
      assert_true(n - 1 >= least);
      BELOW(mapped() - before, 4096); /* 40 leaked fields of 192^2 cells would be 12 MB and more */
      return;
    }
    assert_int_equal(s, CF_NO_MEMORY);
    assert_true(strlen(cf_status_sentence()) > 10);
  }
  fail_msg("%s never succeeded", what);
}

typedef struct solver_case {
  cf_grid g;
  cf_walls walls;
  cf_cell alpha;
  cf_face beta;
} solver_case;

static void solver_begin(solver_case *c, const char *walls) {
  OK(cf_grid_init(&c->g, 2, (int[2]){192, 192}, 1, NULL));
  c->walls = case_walls(2, walls);
  OK(cf_cell_create(&c->alpha, &c->g.box));
  OK(cf_face_create(&c->beta, &c->g.box));
  case_fill_alpha(&c->g.box, 1, c->alpha);
  const solve_case smooth = {.dim = 2, .n = {192, 192, 1}, .beta = BETA_SMOOTH};
  case_fill_beta(&smooth, &c->g.box, 30, c->beta);
}

static void solver_end(solver_case *c) {
  cf_cell_destroy(&c->alpha, &c->g.box);
  cf_face_destroy(&c->beta, &c->g.box);
}

static cf_status create_solver(void *context) {
  solver_case *c = context;
  cf_helmholtz *A = (cf_helmholtz *)context;
  const cf_status s = cf_helmholtz_create(&A, &c->g, &c->walls, 0);
  if (s != CF_OK) assert_null(A);
  cf_helmholtz_destroy(A);
  return s;
}

static void a_solver_is_made_whole_or_not_at_all(void **state) {
  (void)state;
  const char *const walls[] = {"ii", "op"};
  for (int w = 0; w < 2; ++w) {
    solver_case c;
    solver_begin(&c, walls[w]);
    walk(create_solver, &c, "solver", 20);
    solver_end(&c);
  }
}

/* What is asked for in turn; after a failure the same set must work once memory is there again. */
static cf_status set_solver(void *context) {
  solver_case *c = context;
  cf_helmholtz *A;
  cf_status s = cf_helmholtz_create(&A, &c->g, &c->walls, 0);
  const cf_coefficients wanted[] = {{.alpha = 1, .beta = 1e-3},
                                    {.alpha = 1, .beta = 5},
                                    {.beta = 1, .alpha_at = &c->alpha},
                                    {.alpha = 1, .beta_at = &c->beta},
                                    {.alpha_at = &c->alpha, .beta_at = &c->beta},
                                    {.alpha = 1, .beta = 50}};
  for (int i = 0; i < 6 && s == CF_OK; ++i) {
    s = cf_helmholtz_set(A, &wanted[i]);
    if (s == CF_OK) continue;
    cf_mem_fail_at(0);
    cf_cell x, b;
    OK(cf_cell_create(&x, &c->g.box));
    OK(cf_cell_create(&b, &c->g.box));
    b.at[cf_box_at(&c->g.box, 50, 60, 0)] = 1;
    OK(cf_helmholtz_set(A, &wanted[i]));
    cf_solve_report report;
    OK(cf_helmholtz_solve(A, b, &(cf_solve_options){1e-6, 50}, x, &report));
    assert_true(report.converged);
    cf_cell_destroy(&x, &c->g.box);
    cf_cell_destroy(&b, &c->g.box);
  }
  cf_helmholtz_destroy(A);
  return s;
}

static void coefficients_are_taken_or_refused(void **state) {
  (void)state;
  const char *const walls[] = {"ii", "op"};
  for (int w = 0; w < 2; ++w) {
    solver_case c;
    solver_begin(&c, walls[w]);
    walk(set_solver, &c, "coefficients", 40);
    solver_end(&c);
  }
}

static void rise_row(const void *context, int n, const double *x, const double *y, const double *z, double t,
                     double *out) {
  (void)context, (void)z, (void)t;
  for (int i = 0; i < n; ++i) out[i] = 1 + 0.001 * x[i] + 0.002 * y[i];
}

static cf_status rate(void *context, double t, cf_cell W) { return (void)context, (void)t, (void)W, CF_OK; }
static cf_status flux_rate(void *context, double t, cf_face B) {
  return (void)context, (void)t, (void)B, CF_OK;
}
static cf_status hold(void *context, double t, cf_cell f, cf_cell v) {
  return (void)context, (void)t, (void)f, (void)v, CF_OK;
}

static cf_status create_diffusion(void *context) {
  diffuse_case *c = context;
  c->d = (cf_diffuse *)context;
  const cf_status s = cf_diffuse_create(&c->d, &c->g, &c->walls, &c->p, &c->source);
  if (s != CF_OK) assert_null(c->d);
  cf_diffuse_destroy(c->d);
  return s;
}

static void diffusion_is_made_whole_or_not_at_all(void **state) {
  (void)state;
  for (int all = 0; all < 2; ++all) {
    diffuse_case c = diffuse_case_of(2, (int[3]){192, 192, 1}, 1);
    c.p.tau = 0.1;
    for (int side = 0; side < 2; ++side) c.walls.kind[0][side] = CF_WALL_VALUE;
    if (all) {
      c.p.k = c.p.capacity = (cf_fn){.eval = rise_row};
      c.source = (cf_source){.rate = rate, .flux_rate = flux_rate, .hold = hold};
    }
    walk(create_diffusion, &c, all ? "diffusion with everything" : "diffusion", 25);
  }
}

static cf_status grow_registry(void *context) {
  const cf_grid *g = context;
  cf_registry r;
  static double numbers[200];
  cf_status s = cf_registry_init(&r, g);
  for (int i = 0; i < 200 && s == CF_OK; ++i) {
    char name[32];
    snprintf(name, sizeof name, "number %d", i);
    s = cf_registry_add_numbers(&r, name, "", &numbers[i], 1);
  }
  cf_registry_clear(&r);
  return s;
}

static cf_status create_wall_values(void *context) {
  const cf_grid *g = context;
  cf_walls walls = {0};
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) walls.kind[a][side] = side ? CF_WALL_OPEN : CF_WALL_VALUE;
  cf_wall_values v;
  const cf_status s = cf_wall_values_create(&v, g, &walls);
  if (s == CF_OK)
    cf_wall_values_destroy(&v);
  else
    for (int a = 0; a < 3; ++a)
      for (int side = 0; side < 2; ++side) assert_null(v.at[a][side]);
  return s;
}

static void lists_and_walls_are_made_whole_or_not_at_all(void **state) {
  (void)state;
  cf_grid g;
  OK(cf_grid_init(&g, 3, (int[3]){9, 8, 7}, 1, NULL));
  walk(grow_registry, &g, "registry", 3);
  walk(create_wall_values, &g, "wall values", 6);
}

static void a_first_step_fails_cleanly_and_can_be_taken_again(void **state) {
  (void)state;
  diffuse_case c = diffuse_case_of(2, (int[3]){192, 192, 1}, 1);
  c.p.k = c.p.capacity = (cf_fn){.eval = rise_row};
  c.p.tau = 0.1;
  /* variable coefficients take their fields when first seen: in the step */
  long before = mapped();
  int failures = 0;
  for (int n = 1; n < 200; ++n) {
    OK(cf_diffuse_create(&c.d, &c.g, &c.walls, &c.p, NULL));
    OK(cf_cell_create(&c.phi, &c.g.box));
    OK(cf_face_create(&c.q, &c.g.box));
    cf_mem_fail_at(n);
    const cf_status s = cf_diffuse_step(c.d, 0, 0.1, c.phi, c.q, &c.ledger, &c.report);
    cf_mem_fail_at(0);
    if (s != CF_OK) {
      assert_int_equal(s, CF_NO_MEMORY);
      ++failures;
      OK(cf_diffuse_step(c.d, 0, 0.1, c.phi, c.q, &c.ledger, &c.report));
      assert_true(c.report.converged);
    }
    diffuse_end(&c);
    if (n == 1) before = mapped();
    if (s == CF_OK) break;
  }
  print_message("first step: %d allocations\n", failures);
  BELOW(mapped() - before, 4096);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_solver_is_made_whole_or_not_at_all),
      cmocka_unit_test(coefficients_are_taken_or_refused),
      cmocka_unit_test(diffusion_is_made_whole_or_not_at_all),
      cmocka_unit_test(a_first_step_fails_cleanly_and_can_be_taken_again),
      cmocka_unit_test(lists_and_walls_are_made_whole_or_not_at_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
