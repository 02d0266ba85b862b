/* SPDX-License-Identifier: MIT
 *
 * Model gel as a whole: what turns takes its saturation along, what is dropped comes to rest and is pressed as much as
 * its weight says, momenta are kept while water moves, and obstacles are met whatever says where they are.
 */
#include <math.h>

#include "model/gel_part.h"
#include "scene_run.h"

static cf_gel *gel_of(const scene_run *r) { return r->sim->state; }

/* S of every particle, by its id. */
static void saturations(const scene_run *r, double *S) {
  const cf_gel *g = gel_of(r);
  OK(cf_gel_show(gel_of(r)));
  for (int64_t i = 0; i < g->set->count; ++i)
    S[g->set->id[i]] = (double)g->set->attribute[g->saturation].at[0][i];
}

/* --- turning ----------------------------------------------------------------------------------------------- */

enum { SPINNING_MOST = 8192 };
static double still[SPINNING_MOST], spun[SPINNING_MOST], begun[SPINNING_MOST];

/* Saturations at the end of a run of a disc with a wet spot off its middle. Returns how many. */
static int64_t spin_disc(const int cells, const double spin, double *S) {
  char text[1024];
  scene_run r;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: gel\ndomain: {size: [1, 1], cells: [%d, %d]}\ntime: {end: 0.3, dt: %.17g}\n"
      "diffusion: {k: 0.02, tau: 0.3, f_t: 0}\n"
      "gel:\n  bodies:\n    - {shape: ball, center: [0.503, 0.497], radius: 0.3, young: 800, swelling: 0,\n"
      "       saturation: \"0.2 + 0.6*exp(-((x-0.62)^2 + (y-0.5)^2)/0.01)\", spin: %g}\n",
      cells, cells, 0.015 / cells, spin);
  scene_open(&r, "spin", text, 1);
  if (begun[0] == 0) saturations(&r, begun);
  const double angular = scene_metric(&r, "angular_z"), kinetic = scene_metric(&r, "kinetic");
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  saturations(&r, S);
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  CLOSE(scene_metric(&r, "angular_z"), angular, 1e-11 * (1 + fabs(angular)));
  BELOW(fabs(scene_metric(&r, "momentum_x")), 1e-11 * (1 + kinetic));
  const int64_t count = gel_of(&r)->set->count;
  assert_in_range(count, 500, SPINNING_MOST);
  scene_close(&r);
  return count;
}

static double rms(const int64_t n, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum / (double)n);
}

/* The front of Cattaneo's law in a disc that has turned by more than a radian is where it is in one at rest, the better the
 * finer the cells. */
static void saturation_of_a_spinning_gel_is_that_of_one_at_rest(void **state) {
  (void)state;
  double off[2];
  for (int v = 0; v < 2; ++v) {
    begun[0] = 0;
    const int64_t n = spin_disc(24 << v, 0, still);
    assert_int_equal(spin_disc(24 << v, 4, spun), n);
    off[v] = rms(n, spun, still) / rms(n, still, begun);
    print_message("%d cells: off by %.4f of the change\n", 24 << v, off[v]);
  }
  BELOW(off[1], 0.02);
  BELOW(off[1], 0.6 * off[0]);
}

/* --- falling ----------------------------------------------------------------------------------------------- */

/* Drops a block of height 1/2 and waits; how much of its volume is gone then. */
static double pressed_by_weight(const int cells) {
  char text[1024];
  scene_run r;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: gel\ndomain: {size: [1, 1], cells: [%d, %d]}\ntime: {end: 4}\n"
           "diffusion: {k: 0.01, tau: 0.2, f_t: 0.1}\n"
           "gel:\n  bodies:\n    - {shape: box, center: [0.5, 0.35], half: [0.1875, 0.25], young: 400, "
           "poisson: 0.3,\n"
           "       swelling: 0, saturation: \"y\", solid_density: 10, porosity: 0.7}\n"
           "  gravity: [0, -10]\n  damping: 4\n",
           cells, cells);
  scene_open(&r, "drop", text, 1);
  const double whole = scene_metric(&r, "volume");
  double fastest = 0, lowest = 1;
  while (!cf_sim_finished(r.sim)) {
    OK(cf_sim_step(r.sim, NULL));
    fastest = fmax(fastest, scene_metric(&r, "kinetic"));
  }
  const double pressed = 1 - scene_metric(&r, "volume") / whole;
  BELOW(scene_metric(&r, "kinetic"), 1e-6 * fastest);
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  const cf_gel *g = gel_of(&r);
  for (int64_t i = 0; i < g->set->count; ++i)
    lowest = fmin(lowest, (double)g->set->attribute[g->at.position].at[1][i]);
  BELOW(fabs(lowest), 1.0 / cells);
  scene_close(&r);
  return pressed;
}

/* On a floor without friction it bears sigma = rho g (H - y), and its volume falls by (1 + nu)(1 - 2 nu)/E rho g H/2 in the
 * plane. A floor pushes about a cell behind its surface, so errors are of first order; what they extrapolate to is
 * not. Water moves meanwhile, and none is lost. */
static void dropped_gel_comes_to_rest_pressed_by_its_weight(void **state) {
  (void)state;
  const double nu = 0.3, rho = 3, weight = (1 + nu) * (1 - 2 * nu) / 400 * rho * 10 * 0.5 / 2;
  const double coarse = pressed_by_weight(16) / weight, fine = pressed_by_weight(32) / weight;
  print_message("pressed by %.4f and %.4f of what it should be, extrapolated %.4f\n", coarse, fine,
                2 * fine - coarse);
  CLOSE(fine, 1, 0.2);
  CLOSE(2 * fine - coarse, 1, 0.03);
}

/* --- bodies that differ ------------------------------------------------------------------------------------- */

/* A ball beside a ball, 0.2 apart, of the given k and F_T; S of all particles at the end. */
static int64_t two_balls(const char *first, const char *second, double *S) {
  char text[1024];
  scene_run r;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: gel\ndomain: {size: [1.2, 0.6], cells: [60, 30]}\ntime: {end: 0.3, dt: 0.002}\n"
      "diffusion: {k: 0.01, tau: 0.2, f_t: 0.2}\nsolver: {tolerance: 1e-11}\n"
      "gel:\n  bodies:\n    - {shape: ball, center: [0.3, 0.3], radius: 0.2, saturation: \"y\", swelling: "
      "5%s}\n"
      "    - {shape: ball, center: [0.9, 0.3], radius: 0.2, saturation: \"y\", swelling: 5%s}\n"
      "  water:\n    - {kind: bath, shape: plane, center: [0, 0.3]}\n",
      first, second);
  scene_open(&r, "balls", text, 1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  saturations(&r, S);
  const int64_t count = gel_of(&r)->set->count;
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  assert_in_range(count, 500, SPINNING_MOST);
  scene_close(&r);
  return count;
}

/* Bodies with a k and an F_T of their own are each what they would be alone in a scene with these; the same numbers said
 * twice change nothing. */
static void bodies_apart_have_each_its_own_k(void **state) {
  (void)state;
  const int64_t n = two_balls("", "", still);
  two_balls(", k: 0.01", ", k: 0.01, f_t: 0.2", spun);
  for (int64_t i = 0; i < n; ++i) CLOSE(spun[i], still[i], 0);
  two_balls(", k: 0.04, f_t: 1", ", k: 0.04, f_t: 1", begun);
  two_balls("", ", k: 0.04, f_t: 1", spun);
  double apart = 0;
  for (int64_t i = 0; i < n; ++i) {
    CLOSE(spun[i], i < n / 2 ? still[i] : begun[i], 1e-3); /* the filter comes at other times */
    apart = fmax(apart, fabs(still[i] - begun[i]));
  }
  assert_true(apart > 0.1);
}

/* Two blocks side by side between wet ends, held at S = 1 and S = 0: the flow is that of two resistances one behind the
 * other, whatever their F_T. In between they are one body, and water is kept. */
static double between_blocks(const int cells, const double ratio) {
  char text[1024];
  scene_run r;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: gel\ndomain: {size: [1.5, 0.75], cells: [%d, %d]}\ntime: {end: 25, dt: 0.1}\n"
           "diffusion: {k: 0.05, tau: 0.5}\n"
           "gel:\n  bodies:\n    - {shape: box, center: [0.5, 0.375], half: [0.25, 0.125], swelling: 0, f_t: "
           "0.5}\n"
           "    - {shape: box, center: [1, 0.375], half: [0.25, 0.125], swelling: 0, k: %.17g, f_t: 0}\n"
           "  water:\n    - {kind: held, shape: box, center: [0, 0], half: [0.35, 1]}\n"
           "    - {kind: held, shape: box, center: [1.5, 0], half: [0.35, 1], value: 0}\n",
           cells, cells / 2, 0.05 * ratio);
  scene_open(&r, "blocks", text, 1);
  while (!cf_sim_finished(r.sim)) {
    OK(cf_sim_step(r.sim, NULL));
    BELOW(fabs(scene_metric(&r, "error_water")), 1e-11);
  }
  saturations(&r, still);
  const cf_gel *g = gel_of(&r);
  double sum = 0;
  int count = 0;
  for (int64_t i = 0; i < g->set->count; ++i) {
    const double x = (double)g->set->attribute[g->at.position].at[0][i];
    if (fabs(x - 0.75) > 0.5 * g->lattice.h) continue;
    sum += still[g->set->id[i]];
    ++count;
  }
  scene_close(&r);
  return sum / count;
}

static void blocks_in_contact_conduct_one_behind_the_other(void **state) {
  (void)state;
  const double ratio = 0.2, exact = 1 / (1 + ratio);
  const double coarse = between_blocks(30, ratio), fine = between_blocks(60, ratio);
  print_message("S between: %.4f, %.4f, should be %.4f\n", coarse, fine, exact);
  BELOW(fabs(fine - exact), 0.02);
  BELOW(fabs(fine - exact), 0.7 * fabs(coarse - exact));
}

/* --- obstacles --------------------------------------------------------------------------------------------- */

/* numpy's file of distances from a ball, 64 x 64 of them. */
static void write_ball(const char *path) {
  const char *text = "{'descr': '<f8', 'fortran_order': False, 'shape': (64, 64), }";
  char head[128];
  memset(head, ' ', sizeof head);
  memcpy(head, "\x93NUMPY\x01\x00\x76\x00", 10);
  memcpy(head + 10, text, strlen(text));
  head[127] = '\n';
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fwrite(head, 1, sizeof head, file);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      fwrite(&(double){hypot((i + 0.5) / 64 - 0.5, (j + 0.5) / 64 - 0.3) - 0.2}, sizeof(double), 1, file);
  fclose(file);
}

/* A wet block falls on a ball, a little beside its middle. Where its particles are in the end, by id; the depth of the
 * deepest of them in the ball; how many. */
static int64_t fall_on(const char *obstacle, const char *contact, double (*place)[2], double *depth) {
  char text[2048];
  scene_run r;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: gel\ndomain: {size: [1, 1], cells: [32, 32]}\ntime: {end: 0.6}\n"
      "diffusion: {k: 0.01, tau: 0.2, f_t: 0.1}\nobstacles:\n  - {%s, contact: %s}\n"
      "gel:\n  bodies:\n    - {shape: box, center: [0.52, 0.65], half: [0.2, 0.1], young: 100, swelling: 20, "
      "saturation: \"x\"}\n  gravity: [0, -5]\n  damping: 1\n",
      obstacle, contact);
  scene_open(&r, "fall_on", text, 1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const cf_gel *g = gel_of(&r);
  *depth = 0;
  assert_true(g->set->count < SPINNING_MOST);
  for (int64_t i = 0; i < g->set->count; ++i) {
    double *x = place[g->set->id[i]];
    for (int a = 0; a < 2; ++a) x[a] = (double)g->set->attribute[g->at.position].at[a][i];
    *depth = fmax(*depth, 0.2 - hypot(x[0] - 0.5, x[1] - 0.3));
  }
  BELOW(fabs(scene_metric(&r, "error_water")), 1e-12);
  const int64_t count = g->set->count;
  scene_close(&r);
  return count;
}

static double apart(const int64_t n, double (*a)[2], double (*b)[2]) {
  double sum = 0;
  for (int64_t i = 0; i < n; ++i) sum += pow(a[i][0] - b[i][0], 2) + pow(a[i][1] - b[i][1], 2);
  return sqrt(sum / (double)n);
}

/* Sampled distances are met as the body they are of; a body that sticks ends elsewhere than one that slides. */
static void gel_meets_distances_from_a_file_as_their_ball(void **state) {
  (void)state;
  static double ball[SPINNING_MOST][2], sampled[SPINNING_MOST][2], stuck[SPINNING_MOST][2];
  const double h = 1.0 / 32;
  double depth[3];
  char path[1100], keys[1400];
  snprintf(path, sizeof path, "%s/ball.npy", folder_fresh("gel_npy"));
  write_ball(path);
  snprintf(keys, sizeof keys, "shape: file, file: %s, spacing: 0.015625, origin: [0.0078125, 0.0078125]",
           path);
  const char *exact = "shape: ball, center: [0.5, 0.3], radius: 0.2";
  const int64_t n = fall_on(exact, "separate", ball, &depth[0]);
  assert_int_equal(fall_on(keys, "separate", sampled, &depth[1]), n);
  assert_int_equal(fall_on(exact, "sticky", stuck, &depth[2]), n);
  print_message("file: %.4f h apart, depths %.2f and %.2f h; sticky: %.2f h apart\n",
                apart(n, ball, sampled) / h, depth[0] / h, depth[1] / h, apart(n, ball, stuck) / h);
  BELOW(apart(n, ball, sampled), 0.1 * h);
  for (int i = 0; i < 3; ++i) BELOW(depth[i], h);
  assert_true(apart(n, ball, stuck) > 0.5 * h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(saturation_of_a_spinning_gel_is_that_of_one_at_rest),
      cmocka_unit_test(bodies_apart_have_each_its_own_k),
      cmocka_unit_test(blocks_in_contact_conduct_one_behind_the_other),
      cmocka_unit_test(gel_meets_distances_from_a_file_as_their_ball),
      cmocka_unit_test(dropped_gel_comes_to_rest_pressed_by_its_weight),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
