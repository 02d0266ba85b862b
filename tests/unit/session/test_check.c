/* SPDX-License-Identifier: MIT
 *
 * The page of `check`: the numbers on it are those of the theory, and no failure of memory leaves anything behind.
 */
#define _GNU_SOURCE
#include "testing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "model/scene.h"
#include "session/check.h"
#include "solve/helmholtz.h"

static const char ring[] =
    "cattaneo: 1\n"
    "model: tracer\n"
    "domain: {size: [1, 2], cells: [32, 64], walls: {x-: open, x+: open}}\n"
    "time: {end: 1, dt: 0.01, frames: 4}\n"
    "diffusion: {k: 0.02, tau: 0.5}\n"
    "velocity: [\"0.4*x\", \"0\"]\n";

static const char crystal[] =
    "cattaneo: 1\n"
    "model: phase\n"
    "domain: {size: [2, 1], cells: [64, 32]}\n"
    "time: {end: 0.01}\n"
    "diffusion: {k: 1, tau: 1e-4}\n"
    "phase: {width: 0.016, tau_eta: 3e-4, tau_1: 3e-4}\n";

/* A text with overrides, by way of a file. */
static cf_scene *scene_of_text(const char *yaml, const int overrides, const char *const *set) {
  char path[] = "/tmp/cattaneo-check-XXXXXX";
  const int file = mkstemp(path);
  assert_true(file >= 0 && write(file, yaml, strlen(yaml)) == (ssize_t)strlen(yaml));
  close(file);
  cf_scene *scene = NULL;
  OK(cf_scene_read(&scene, path, overrides, set));
  unlink(path);
  return scene;
}

static cf_scene *scene_of(const int overrides, const char *const *set) {
  return scene_of_text(ring, overrides, set);
}

/* The page, until the next one. */
static const char *page_of_text(const char *yaml, const int overrides, const char *const *set) {
  static char kept[8192];
  cf_scene *scene = scene_of_text(yaml, overrides, set);
  char *text = NULL;
  OK(cf_check_text(scene, &text));
  assert_true(strlen(text) < sizeof kept);
  strcpy(kept, text);
  cf_free(text);
  cf_scene_destroy(scene);
  return kept;
}

static const char *page(const int overrides, const char *const *set) {
  return page_of_text(ring, overrides, set);
}

#define PAGE(...) \
  page((int)(sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *)), (const char *[]){__VA_ARGS__})

static void has(const char *text, const char *part) {
  if (strstr(text, part) == NULL) fail_msg("\"%s\" is not in\n%s", part, text);
}

static void check_counts_steps_and_frames(void **state) {
  (void)state;
  const char *text = PAGE("time.dt=0.03");
  has(text, "32 x 64 = 2.05e+03 cells of 0.03125 m");
  has(text, "about 36 steps"); /* 9 in each quarter of a second */
  has(text, "0 to 4, one every 0.25 s");
  has(text, "x- open, x+ open, y- insulated, y+ insulated");
}

static void check_takes_the_largest_velocity(void **state) {
  (void)state;
  const char *text = PAGE("time.end=2");
  has(text, "up to 0.39"); /* at the last of the points, half a cell from the wall */
  has(text, "1.969: super-critical, a cone of half-angle 30.5 degrees, seen over 0.292 m");
}

static void check_takes_the_largest_diffusivity(void **state) {
  (void)state;
  const char *text = PAGE("diffusion.k=0.02*(1 + 3*(y > 1))", "diffusion.capacity=4");
  has(text, "k = 0.02 to 0.08 m^2/s, tau = 0.5 s, F_T = 0, C = 4");
  has(text, "front speed   0.2 m/s");
}

static void check_tells_the_band_of_waves(void **state) {
  (void)state;
  const char *text = PAGE("diffusion.k=0.5", "diffusion.f_t=0.75", "velocity=[0, 0]");
  /* sqrt(tau k) = 1/2: K_lo, K_hi = 4/3, 4; K* = 4/sqrt(3); blur 1/K*. */
  has(text, "1.57 to 4.71 m long, fastest at 2.72 m; Fourier's share blurs over 0.433 m");
}

/* What the solver says of (1 - beta lap) x = b on the grid of `ring`. */
static int levels_of_solver(const double beta) {
  cf_grid g;
  cf_cell b, x;
  cf_helmholtz *A;
  cf_solve_report report;
  const cf_walls walls = {.kind = {{CF_WALL_OPEN, CF_WALL_OPEN}}};
  OK(cf_grid_init(&g, 2, (int[]){32, 64}, 1.0 / 32, NULL));
  OK(cf_cell_create(&b, &g.box));
  OK(cf_cell_create(&x, &g.box));
  b.at[cf_box_at(&g.box, 5, 7, 0)] = 1;
  OK(cf_helmholtz_create(&A, &g, &walls, 0));
  OK(cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = beta}));
  OK(cf_helmholtz_solve(A, b, &(cf_solve_options){1e-6, 100}, x, &report));
  cf_helmholtz_destroy(A);
  cf_cell_destroy(&x, &g.box);
  cf_cell_destroy(&b, &g.box);
  return report.levels;
}

static void check_counts_levels_as_the_solver_does(void **state) {
  (void)state;
  static const double dt[] = {1e-4, 0.004, 0.03, 0.25, 30};
  for (size_t i = 0; i < sizeof dt / sizeof dt[0]; ++i) {
    char set[64];
    double sigma = 0;
    int levels = 0;
    snprintf(set, sizeof set, "time={end: 100, dt: %g}", dt[i]);
    const char *text = PAGE("diffusion.tau=0", "diffusion.k=1", "velocity=[0, 0]", set);
    const char *place = strstr(text, "sigma = ");
    assert_non_null(place);
    assert_int_equal(sscanf(place, "sigma = %lf, %d level", &sigma, &levels), 2);
    const double stage = (1 - sqrt(0.5)) * dt[i];
    CLOSE(sigma, stage * 32 * 32, 0.01 * sigma);
    assert_int_equal(levels, levels_of_solver(stage));
  }
  const char *text =
      PAGE("diffusion.tau=0", "diffusion.k=1", "time.dt=0.25", "velocity=[0, 0]", "solver.levels=3");
  has(text, "3 levels of multigrid");
}

static void check_knows_scalars_apart(void **state) {
  (void)state;
  const char *text = PAGE("fields={ink: {}, salt: {diffusion: {k: 0}}, q_ink: {}}");
  const char *ink = strstr(text, "\nink\n"), *salt = strstr(text, "\nsalt\n");
  assert_true(ink != NULL && salt != NULL);
  has(ink < salt ? salt : ink, "no diffusion");
  assert_null(strstr(text, "\nq_ink\n"));
}

static void check_finds_what_only_a_grid_can_tell(void **state) {
  (void)state;
  cf_scene *scene = scene_of(1, (const char *[]){"diffusion.k=log(x - 0.5)"});
  char *text = NULL;
  assert_int_equal(cf_check_text(scene, &text), CF_BAD_SCENE);
  assert_null(text);
  cf_scene_destroy(scene);
}

static void check_warns_of_sources_outside_the_box(void **state) {
  (void)state;
  assert_null(strstr(PAGE("sources=[{shape: sphere, center: [1.1, 1], radius: 0.2, rate: 1}]"), "outside"));
  assert_null(strstr(PAGE("sources=[{shape: box, center: [1.1, 1], half: [0.2, 1], rate: 1}]"), "outside"));
  has(PAGE("sources=[{shape: sphere, center: [1.3, 1], radius: 0.2, rate: 1}]"),
      "sources.0 is outside the box");
  has(PAGE(
          "sources=[{rate: 0, shape: everywhere}, {shape: box, center: [0.5, -1], half: [1, 0.5], rate: 1}]"),
      "sources.1 is outside the box");
}

static void check_warns_of_obstacles_nowhere_and_everywhere(void **state) {
  (void)state;
  has(PAGE("obstacles=[{shape: sphere, center: [5, 5], radius: 0.1}]"),
      "no cell has its middle in an obstacle");
  has(PAGE("obstacles=[{shape: sphere, center: [0, 0], radius: 9}]"), "no cell is left to compute");
  assert_null(strstr(PAGE("obstacles=[{shape: sphere, center: [0, 0], radius: 0.5}]"), "no cell"));
}

static void check_has_the_words_of_a_crystal(void **state) {
  (void)state;
  const char *text = page_of_text(crystal, 0, NULL);
  has(text, "front speed   100 m/s");
  has(text, "phase and heat  explicit, 1 substep of three stages a step");
  assert_null(strstr(text, "leapfrog")); /* so T alone would go */
  assert_null(strstr(text, "below 0"));
  has(page_of_text(crystal, 1, (const char *[]){"phase.scheme=implicit"}),
      "phase and heat  implicit, two stages of the phase and two of heat a step: the scene says so");
}

static void check_warns_of_an_interface_thicker_than_the_box(void **state) {
  (void)state;
  assert_null(strstr(page_of_text(crystal, 1, (const char *[]){"phase.width=0.16"}), "does not fit"));
  has(page_of_text(crystal, 1, (const char *[]){"phase.width=0.17"}),
      "the interface, 1.06 m thick, does not fit into the box of 1 m");
}

static void check_survives_any_failed_allocation(void **state) {
  (void)state;
  cf_scene *scene = scene_of(0, NULL);
  cf_status status = CF_NO_MEMORY;
  for (long n = 1; status != CF_OK && n < 10000; ++n) {
    char *text = NULL;
    cf_mem_fail_at(n);
    status = cf_check_text(scene, &text);
    cf_mem_fail_at(0);
    assert_true(status == CF_OK || status == CF_NO_MEMORY);
    assert_true((status == CF_OK) == (text != NULL));
    cf_free(text);
  }
  assert_int_equal(status, CF_OK);
  cf_scene_destroy(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(check_counts_steps_and_frames),
      cmocka_unit_test(check_takes_the_largest_velocity),
      cmocka_unit_test(check_takes_the_largest_diffusivity),
      cmocka_unit_test(check_tells_the_band_of_waves),
      cmocka_unit_test(check_counts_levels_as_the_solver_does),
      cmocka_unit_test(check_knows_scalars_apart),
      cmocka_unit_test(check_finds_what_only_a_grid_can_tell),
      cmocka_unit_test(check_warns_of_sources_outside_the_box),
      cmocka_unit_test(check_warns_of_obstacles_nowhere_and_everywhere),
      cmocka_unit_test(check_has_the_words_of_a_crystal),
      cmocka_unit_test(check_warns_of_an_interface_thicker_than_the_box),
      cmocka_unit_test(check_survives_any_failed_allocation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
