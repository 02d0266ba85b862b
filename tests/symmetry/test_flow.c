/* SPDX-License-Identifier: MIT
 *
 * What a flow must keep exactly: rest, energy that nobody adds, momentum, mirrors, the bits for any number of threads and
 * across a stop; and what it must refuse.
 */
/* also in single precision */
#include "grid/sweep.h"
#include "scene_run.h"

/* --- rest ------------------------------------------------------------------------------------------------- */

static double speed_after(const char *name, const char *text) {
  scene_run r;
  scene_open(&r, name, text, 2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const double speed = scene_metric(&r, "speed_max");
  scene_close(&r);
  return speed;
}

/* Accelerations are 10 m/s^2 over a second here. */
static void layers_at_rest_stay_at_rest(void **state) {
  (void)state;
  const double nothing = sizeof(cf_real) == sizeof(float) ? 1e-5 : 1e-13;
  BELOW(speed_after("rest",
                    "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 2], cells: [16, 32]}\n"
                    "time: {end: 1, dt: 0.05}\ndiffusion: {k: 0.01, tau: 0.5}\n"
                    "fields: {phi: {initial: 'exp(-y)'}}\nflow: {buoyancy: {phi: -1}}\n"),
        nothing);
  BELOW(speed_after("rest_open",
                    "cattaneo: 1\nmodel: flow\ndomain: {size: [2, 2, 3], cells: [8, 8, 12]}\n"
                    "time: {end: 1, dt: 0.05}\nfields: {phi: {initial: 'sin(z)'}}\n"
                    "flow: {gravity: [0, 0, -9.81], buoyancy: {phi: -1}, viscosity: 0.01,\n"
                    "       walls: [{side: z+, kind: open}, {side: x-, slip: off}]}\n"),
        nothing);
}

/* --- energy, momentum ------------------------------------------------------------------------------------- */

static void energy_never_grows_by_itself(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "energy",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 1, 1], cells: [24, 24, 24]}\n"
             "time: {end: 1, cfl: 0.9}\n"
             "velocity: ['sin(9*y)*cos(7*z+x*5)', 'sin(8*z)*cos(11*x)', 'sin(10*x)*cos(9*y+3)']\n"
             "flow: {walls: [{side: x-, kind: open}]}\n",
             2);
  double before = scene_metric(&r, "kinetic_energy");
  const double first = before;
  while (!cf_sim_finished(r.sim)) {
    OK(cf_sim_step(r.sim, NULL));
    const double now = scene_metric(&r, "kinetic_energy");
    BELOW(now, before * (1 + 1e-6));
    before = now;
  }
  print_message("after %d steps %.1f %% of the energy is left\n", (int)cf_sim_step_count(r.sim),
                100 * before / first);
  scene_close(&r);
}

static void momentum_changes_by_forces_alone(void **state) {
  (void)state;
  scene_run r;
  cf_view u;
  double sum[2] = {0, 0};
  scene_open(&r, "momentum",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 1], cells: [32, 32], walls: periodic}\n"
             "time: {end: 0.5, dt: 0.01}\nvelocity: ['0.5 + sin(2*pi*y)', 'cos(4*pi*x)']\n"
             "flow: {force: ['0.3', '-0.1']}\n",
             2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  for (int c = 0; c < 2; ++c) {
    OK(cf_sim_field(r.sim, "velocity", c, &u));
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) sum[c] += (double)u.at[i * u.stride[0] + j * u.stride[1]] / 1024;
  }
  const double round = sizeof(cf_real) == sizeof(float) ? 2e-5 : 1e-12;
  CLOSE(sum[0], 0.5 + 0.5 * 0.3, round);
  CLOSE(sum[1], -0.5 * 0.1, round);
  scene_close(&r);
}

/* --- bits ------------------------------------------------------------------------------------------------- */

static const char *const plume =
    "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 2, 1], cells: [20, 40, 20]}\n"
    "time: {end: 10, cfl: 0.8}\ndiffusion: {k: 1e-3, tau: 1}\n"
    "fields: {phi: {}, heat: {initial: 'y', diffusion: {k: 1e-2, tau: 0}}}\n"
    "flow:\n  buoyancy: {phi: 0.5, heat: 0.01}\n  confinement: 0.2\n  viscosity: 1e-3\n"
    "  walls: [{side: y+, kind: open}, {side: x-, slip: off}]\n"
    "  inlets: [{wall: x+, shape: sphere, center: [1, 1, 0.4], radius: 0.2, speed: '0.5 + 0.1*sin(20*t)'}]\n"
    "sources:\n  - {field: phi, shape: sphere, center: [0.4, 0.3, 0.5], radius: 0.15, value: 1}\n";

static double same(const scene_run *a, const scene_run *b, const char *name, const int components) {
  double off = 0;
  for (int c = 0; c < components; ++c) {
    cf_view u, v;
    OK(cf_sim_field(a->sim, name, c, &u));
    OK(cf_sim_field(b->sim, name, c, &v));
    for (int k = 0; k < u.shape[2]; ++k)
      for (int j = 0; j < u.shape[1]; ++j)
        for (int i = 0; i < u.shape[0]; ++i) {
          const ptrdiff_t p = i * u.stride[0] + j * u.stride[1] + k * u.stride[2];
          off = fmax(off, fabs((double)u.at[p] - (double)v.at[p]));
        }
  }
  return off;
}

static void all_same(const scene_run *a, const scene_run *b) {
  assert_true(cf_sim_time(a->sim) == cf_sim_time(b->sim));
  assert_true(same(a, b, "phi", 1) == 0);
  assert_true(same(a, b, "heat", 1) == 0);
  assert_true(same(a, b, "pressure", 1) == 0);
  assert_true(same(a, b, "velocity", 3) == 0);
}

static void steps(const scene_run *r, const int count) {
  for (int i = 0; i < count; ++i) OK(cf_sim_step(r->sim, NULL));
}

static void threads_change_no_bit(void **state) {
  (void)state;
  scene_run a, b;
  scene_open(&a, "one", plume, 1);
  scene_open(&b, "three", plume, 3);
  steps(&a, 12);
  steps(&b, 12);
  all_same(&a, &b);
  assert_true(scene_metric(&a, "speed_max") > 0.1);
  scene_close(&a);
  scene_close(&b);
}

static void a_stop_changes_no_bit(void **state) {
  (void)state;
  scene_run a, b;
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder_fresh("flow_stop"));
  scene_open(&a, "unbroken", plume, 2);
  steps(&a, 7);
  OK(cf_sim_save(a.sim, path));
  steps(&a, 6);
  scene_open(&b, "resumed", plume, 2);
  OK(cf_sim_load(b.sim, path));
  steps(&b, 6);
  all_same(&a, &b);
  scene_close(&a);
  scene_close(&b);
}

/* A plume in the middle of a box of an odd number of cells is its own mirror image, to what the solver leaves. */
static void a_plume_is_its_own_mirror_image(void **state) {
  (void)state;
  scene_run r;
  cf_view phi;
  double off = 0;
  scene_open(&r, "mirror",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 1.6], cells: [35, 56]}\n"
             "time: {end: 0.6, dt: 0.01}\ndiffusion: {k: 1e-3, tau: 1}\n"
             "flow: {buoyancy: {phi: 0.5}}\nsolver: {tolerance: 1e-8}\n"
             "sources: [{field: phi, shape: sphere, center: [0.5, 0.3], radius: 0.15, rate: 5}]\n",
             2);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  OK(cf_sim_field(r.sim, "phi", 0, &phi));
  for (int j = 0; j < 56; ++j)
    for (int i = 0; i < 35; ++i)
      off = fmax(off, fabs((double)phi.at[i * phi.stride[0] + j * phi.stride[1]] -
                           (double)phi.at[(34 - i) * phi.stride[0] + j * phi.stride[1]]));
  BELOW(off, sizeof(cf_real) == sizeof(float) ? 1e-3 : 1e-6);
  BELOW(fabs(scene_metric(&r, "error_phi")), sizeof(cf_real) == sizeof(float) ? 1e-5 : 1e-13);
  scene_close(&r);
}

/* --- ledgers ---------------------------------------------------------------------------------------------- */

/* Smoke that leaves through an open top, insulated or open for diffusion, with its flux in either form. */
static void what_leaves_with_the_flow_is_counted(void **state) {
  (void)state;
  static const char *const kinds[] = {"insulated", "open"}, *const forms[] = {"", ", q: {}"};
  for (int kind = 0; kind < 2; ++kind)
    for (int form = 0; form < 2; ++form) {
      char text[1024];
      scene_run r;
      snprintf(text, sizeof text,
               "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 1], cells: [32, 32], walls: {y+: %s}}\n"
               "time: {end: 1.2, dt: 0.01}\ndiffusion: {k: 0.01, tau: 1}\n"
               "fields: {phi: {initial: 'exp(-((x-.5)^2+(y-.7)^2)/.02)'}%s}\n"
               "flow: {buoyancy: {phi: 0.5}, walls: [{side: y+, kind: open}]}\n",
               kinds[kind], forms[form]);
      scene_open(&r, "leaving", text, 2);
      const double first = scene_metric(&r, "sum_phi");
      OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
      BELOW(scene_metric(&r, "sum_phi"), 0.9 * first);
      BELOW(fabs(scene_metric(&r, "error_phi")), sizeof(cf_real) == sizeof(float) ? 1e-5 : 1e-13);
      scene_close(&r);
    }
}

/* --- what cannot be --------------------------------------------------------------------------------------- */

static void refuse(const char *flow, const char *sentence) {
  char text[1024];
  cf_scene *scene = NULL;
  cf_sim *sim = NULL;
  snprintf(text, sizeof text,
           "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 1], cells: [8, 8]}\ntime: {end: 1}\nflow: %s\n",
           flow);
  cf_status s = cf_scene_read(&scene, scene_path("refused", text), 0, NULL);
  if (s == CF_OK) s = cf_sim_create(&sim, scene, 1);
  assert_int_equal(s, CF_BAD_SCENE);
  if (strstr(cf_status_sentence(), sentence) == NULL)
    fail_msg("\"%s\" says nothing of \"%s\"", cf_status_sentence(), sentence);
  cf_scene_destroy(scene);
}

static void impossible_flows_are_refused_with_the_reason(void **state) {
  (void)state;
  refuse("{inlets: [{wall: y-, speed: 1}]}", "nowhere to go");
  refuse("{inlets: [{wall: y-, speed: -1}]}", "nowhere to come from");
  refuse("{inlets: [{wall: y, speed: 1}]}", "is no wall");
  refuse("{inlets: [{wall: z-, speed: 1}]}", "two axes");
  refuse("{inlets: [{wall: y-, speed: 1, shape: box}]}", "needs center");
  refuse("{walls: [{side: y+, kind: open}], inlets: [{wall: y+, speed: 1}]}", "closed wall");
  refuse("{walls: [{side: y+, kind: open, velocity: [1, 0]}]}", "pressure 0");
  refuse("{buoyancy: {smoke: 1}}", "no scalar smoke");
  refuse("{gravity: [0, 0, -9]}", "3 entries");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layers_at_rest_stay_at_rest),
      cmocka_unit_test(energy_never_grows_by_itself),
      cmocka_unit_test(momentum_changes_by_forces_alone),
      cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(a_stop_changes_no_bit),
      cmocka_unit_test(a_plume_is_its_own_mirror_image),
      cmocka_unit_test(what_leaves_with_the_flow_is_counted),
      cmocka_unit_test(impossible_flows_are_refused_with_the_reason),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
