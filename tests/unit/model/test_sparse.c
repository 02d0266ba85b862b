/* SPDX-License-Identifier: MIT
 *
 * `sparse:`: what follows the scalars gives what the whole box gives, cuts off what it may, keeps the ledger, and is
 * found again after a stop.
 */
#include "scene_run.h"

static double at(const cf_view *v, const int i, const int j, const int k) {
  return (double)v->at[i * v->stride[0] + j * v->stride[1] + k * v->stride[2]];
}

/* The largest difference over the largest value; *empty: cells of b that are exactly 0. */
static double difference(const scene_run *a, const scene_run *b, const char *name, double *empty) {
  cf_view u, v;
  double off = 0, most = 0;
  OK(cf_sim_field(a->sim, name, 0, &u));
  OK(cf_sim_field(b->sim, name, 0, &v));
  *empty = 0;
  for (int k = 0; k < u.shape[2]; ++k)
    for (int j = 0; j < u.shape[1]; ++j)
      for (int i = 0; i < u.shape[0]; ++i) {
        off = fmax(off, fabs(at(&u, i, j, k) - at(&v, i, j, k)));
        most = fmax(most, fabs(at(&u, i, j, k)));
        *empty += at(&v, i, j, k) == 0;
      }
  *empty /= (double)u.shape[0] * u.shape[1] * u.shape[2];
  return off / most;
}

static void compare(const char *name, const char *scene, const double tolerance, const double empty) {
  char text[2048];
  scene_run dense, sparse;
  double zero;
  scene_open(&dense, name, scene, 2);
  snprintf(text, sizeof text, "%ssparse: {follow: on}\n", scene);
  scene_open(&sparse, name, text, 2);
  OK(cf_sim_run(dense.sim, INFINITY, NULL, NULL));
  OK(cf_sim_run(sparse.sim, INFINITY, NULL, NULL));
  const double off = difference(&dense, &sparse, "phi", &zero);
  print_message("%s: off by %.1e, %.0f %% of the box never touched, ledger %.1e\n", name, off, 100 * zero,
                scene_metric(&sparse, "error_phi"));
  BELOW(off, tolerance);
  BELOW(empty, zero);
  BELOW(fabs(scene_metric(&sparse, "error_phi")), 1e-13);
  CLOSE(scene_metric(&sparse, "sum_phi"), scene_metric(&dense, "sum_phi"),
        1e-6 * scene_metric(&dense, "sum_phi"));
  scene_close(&dense);
  scene_close(&sparse);
}

static void a_plume_in_its_own_part_is_that_of_the_whole_box(void **state) {
  (void)state;
  compare("plume",
          "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 2, 1], cells: [32, 64, 32], walls: {y+: open}}\n"
          "time: {end: 0.6, dt: 0.03}\ndiffusion: {k: 1e-4, tau: 1}\nflow: {buoyancy: {phi: 0.1}}\n"
          "sources: [{field: phi, shape: sphere, center: [0.5, 0.2, 0.5], radius: 0.1, rate: 5}]\n"
          "solver: {tolerance: 1e-8}\n",
          1e-6, 0.4);
}

static void explicit_waves_are_too(void **state) {
  (void)state;
  compare("wave",
          "cattaneo: 1\nmodel: tracer\ndomain: {size: [4, 2], cells: [256, 128], walls: open}\n"
          "time: {end: 1, dt: 0.01}\ndiffusion: {k: 0.01, tau: 1, scheme: leapfrog}\nvelocity: ['1', '0.2']\n"
          "fields: {phi: {initial: 'exp(-((x - 1)^2 + (y - 1)^2)/0.005)'}}\n",
          1e-6, 0.5);
}

static void implicit_diffusion_is_too(void **state) {
  (void)state;
  compare("implicit",
          "cattaneo: 1\nmodel: tracer\ndomain: {size: [4, 2], cells: [256, 128]}\n"
          "time: {end: 0.5, dt: 0.05}\ndiffusion: {k: 0.005, tau: 0}\nvelocity: ['0', '0']\n"
          "fields: {phi: {initial: 'exp(-((x - 1)^2 + (y - 1)^2)/0.005)'}}\nsolver: {tolerance: 1e-9}\n",
          1e-6, 0.3);
}

/* Saved in the middle and gone on with, the part must be the same. */
static void a_stop_does_not_change_the_part(void **state) {
  (void)state;
  static const char scene[] =
      "cattaneo: 1\nmodel: tracer\ndomain: {size: [4, 2], cells: [128, 64], walls: open}\n"
      "time: {end: 1, dt: 0.02}\ndiffusion: {k: 0.02, tau: 1, f_t: 0.2}\nvelocity: ['1', '0.2']\n"
      "fields: {phi: {initial: 'exp(-((x - 1)^2 + (y - 1)^2)/0.005)'}}\n"
      "sparse: {follow: on}\nsources: [{at: [1, 1], amount: '1 + t'}]\n";
  scene_run whole, first, second;
  char path[1024];
  double empty;
  snprintf(path, sizeof path, "%s/stop.h5", folder_fresh("sparse_stop"));
  scene_open(&whole, "sparse_whole", scene, 1);
  OK(cf_sim_run(whole.sim, INFINITY, NULL, NULL));
  scene_open(&first, "sparse_whole", scene, 2);
  for (int i = 0; i < 23; ++i) OK(cf_sim_step(first.sim, NULL));
  OK(cf_sim_save(first.sim, path));
  scene_open(&second, "sparse_whole", scene, 2);
  OK(cf_sim_load(second.sim, path));
  OK(cf_sim_run(second.sim, INFINITY, NULL, NULL));
  CLOSE(difference(&whole, &second, "phi", &empty), 0, 0);
  CLOSE(difference(&whole, &second, "div_q", &empty), 0, 0);
  CLOSE(scene_metric(&whole, "error_phi"), scene_metric(&second, "error_phi"), 0);
  scene_close(&whole);
  scene_close(&first);
  scene_close(&second);
}

static void what_needs_the_whole_box_is_refused(void **state) {
  (void)state;
  static const char *const wrong[] = {"fields: {phi: {walls: {x-: {value: 1}}}}\n",
                                      "output: {fields: [phi, q]}\n",
                                      "diffusion: {k: 1, tau: 1, scheme: paper}\n"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    char text[1024];
    cf_scene *scene;
    cf_sim *sim;
    snprintf(text, sizeof text,
             "cattaneo: 1\nmodel: tracer\ndomain: {size: [1, 1], cells: [16, 16]}\ntime: {end: 1}\n"
             "sparse: {follow: on}\n%s",
             wrong[i]);
    OK(cf_scene_read(&scene, scene_path("refused_sparse", text), 0, NULL));
    assert_int_equal(cf_sim_create(&sim, scene, 1), CF_BAD_SCENE);
    if (strstr(cf_status_sentence(), "whole box") == NULL) fail_msg("%s", cf_status_sentence());
    cf_scene_destroy(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_plume_in_its_own_part_is_that_of_the_whole_box),
      cmocka_unit_test(explicit_waves_are_too),
      cmocka_unit_test(implicit_diffusion_is_too),
      cmocka_unit_test(a_stop_does_not_change_the_part),
      cmocka_unit_test(what_needs_the_whole_box_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
