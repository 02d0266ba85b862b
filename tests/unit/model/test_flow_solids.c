/* SPDX-License-Identifier: MIT
 *
 * Solid bodies in a flow: nothing passes them, mirrors stay mirrors, layers at rest stay at rest, what moves pushes its
 * own volume, and a viscous fluid sticks to what is sticky.
 */
#include "scene_run.h"

static double at(const cf_view *v, const int i, const int j, const int k) {
  return (double)v->at[i * v->stride[0] + j * v->stride[1] + k * v->stride[2]];
}

static void run_to_the_end(scene_run *r) {
  OK(cf_sim_run(r->sim, INFINITY, NULL, NULL));
  assert_string_equal(cf_sim_warning(r->sim), "");
}

/* --- a ball in a stream ----------------------------------------------------------------------------------- */

static void a_stream_past_a_ball_is_a_mirror_of_itself(void **state) {
  (void)state;
  scene_run r;
  cf_view u;
  double off = 0, through = 0, fastest = 0;
  scene_open(&r, "ball",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [2, 1, 1], cells: [32, 16, 16], walls: {x+: open}}\n"
             "time: {end: 0.25, cfl: 0.8}\nflow: {walls: [{side: x-, velocity: [1, 0, 0]}]}\n"
             "obstacles: [{shape: sphere, center: [0.7, 0.5, 0.5], radius: 0.25}]\n"
             "solver: {tolerance: 1e-6}\n",
             2);
  run_to_the_end(&r);
  OK(cf_sim_field(r.sim, "velocity", 0, &u));
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i <= 32; ++i) {
        off = fmax(off, fabs(at(&u, i, j, k) - at(&u, i, 15 - j, k)));
        off = fmax(off, fabs(at(&u, i, j, k) - at(&u, i, j, 15 - k)));
        fastest = fmax(fastest, at(&u, i, j, k));
        /* Faces of cells whose centre is inside. */
        for (int side = -1; side <= 1; side += 2) {
          const double x = (i + 0.5 * side) / 16 - 0.7, y = (j + 0.5) / 16 - 0.5, z = (k + 0.5) / 16 - 0.5;
          if (x * x + y * y + z * z < 0.0624) through = fmax(through, fabs(at(&u, i, j, k)));
        }
      }
  print_message("mirrors differ by %.1e; %.3f m/s beside the ball; divergence %.1e\n", off, fastest,
                scene_metric(&r, "divergence"));
  BELOW(off, 2e-5);
  CLOSE(through, 0, 0);
  BELOW(1.2, fastest);
  BELOW(scene_metric(&r, "divergence"), 1e-4);
  scene_close(&r);
}

/* --- what moves ------------------------------------------------------------------------------------------- */

/* A piston as high as the channel: the fluid before and behind it goes with it. */
static void a_piston_pushes_exactly_its_volume(void **state) {
  (void)state;
  scene_run r;
  cf_view u;
  scene_open(
      &r, "piston",
      "cattaneo: 1\nmodel: flow\ndomain: {size: [4, 1], cells: [64, 16], walls: {x-: open, x+: open}}\n"
      "time: {end: 1, dt: 0.02}\n"
      "obstacles: [{shape: box, center: [1, 0.5], half: [0.25, 1], motion: ['t^2/2', '0']}]\n",
      1);
  run_to_the_end(&r);
  OK(cf_sim_field(r.sim, "velocity", 0, &u));
  for (int j = 0; j < 16; ++j) {
    CLOSE(at(&u, 63, j, 0), 1, 1e-4);
    CLOSE(at(&u, 2, j, 0), 1, 1e-4);
  }
  scene_close(&r);
}

/* A box that drives through a closed tank full of ink: what it pushes away before it comes together behind it, and where it
 * has been there is ink again. */
static void a_box_stirs_a_closed_tank_without_a_loss(void **state) {
  (void)state;
  scene_run r;
  cf_view phi;
  scene_open(
      &r, "stirred",
      "cattaneo: 1\nmodel: flow\ndomain: {size: [2, 1], cells: [64, 32]}\n"
      "time: {end: 0.6, dt: 0.015}\n"
      "fields: {phi: {initial: 1}}\n"
      "obstacles: [{shape: box, center: [0.5, 0.5], half: [0.2, 0.1], motion: ['t', '0'], rotation: '3*t'}]\n"
      "solver: {tolerance: 1e-5}\n",
      1);
  for (int i = 0; i < 40; ++i) {
    OK(cf_sim_step(r.sim, NULL));
    BELOW(scene_metric(&r, "divergence"), 1e-3);
  }
  BELOW(0.01, scene_metric(&r, "kinetic_energy"));
  BELOW(scene_metric(&r, "speed_max"), 4);
  OK(cf_sim_field(r.sim, "phi", 0, &phi));
  CLOSE(at(&phi, 16, 16, 0), 1, 1e-3); /* where the box began */
  CLOSE(scene_metric(&r, "min_phi"), 1, 0.05);
  CLOSE(scene_metric(&r, "max_phi"), 1, 0.05);
  BELOW(fabs(scene_metric(&r, "error_phi")), 1e-13);
  scene_close(&r);
}

/* --- rest ------------------------------------------------------------------------------------------------- */

static void layers_around_a_body_stay_at_rest(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "rest_solid",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [1, 2], cells: [24, 48]}\n"
             "time: {end: 1, dt: 0.05}\nfields: {phi: {initial: 'y'}}\nadvection: {scheme: ppm}\n"
             "flow: {buoyancy: {phi: 0.5}}\n"
             "obstacles: [{shape: sphere, center: [0.4, 0.9], radius: 0.3}]\n",
             2);
  run_to_the_end(&r);
  BELOW(scene_metric(&r, "speed_max"), 1e-12);
  scene_close(&r);
}

/* --- friction --------------------------------------------------------------------------------------------- */

/* Between two plates half a metre apart, driven by a force: u = f/(2 nu) (1/16 - y^2), y from the middle. The plates are
 * where the faces of cells are, so the profile is met but for the error of the scheme: h^2/8 of its bend. */
static double plates(const char *contact) {
  char text[1024];
  scene_run r;
  cf_view u;
  double worst = 0;
  snprintf(
      text, sizeof text,
      "cattaneo: 1\nmodel: flow\n"
      "domain: {size: [0.25, 1], cells: [8, 32], origin: [0, -0.5], walls: {x-: periodic, x+: periodic}}\n"
      "time: {end: 15, dt: 0.5}\nflow: {viscosity: 0.02, force: ['0.64', '0']}\n"
      "solver: {tolerance: 1e-5}\n"
      "obstacles:\n"
      "  - {shape: box, center: [0, 0.45], half: [1, 0.2], contact: %s}\n"
      "  - {shape: box, center: [0, -0.45], half: [1, 0.2], contact: %s}\n",
      contact, contact);
  scene_open(&r, "plates", text, 1);
  run_to_the_end(&r);
  OK(cf_sim_field(r.sim, "velocity", 0, &u));
  for (int j = 8; j < 24; ++j) {
    const double y = (j + 0.5) / 32 - 0.5;
    worst = fmax(worst, fabs(at(&u, 4, j, 0) - 16 * (1.0 / 16 - y * y)));
  }
  CLOSE(at(&u, 4, 2, 0), 0, 0);
  scene_close(&r);
  return worst;
}

static void a_viscous_fluid_sticks_to_what_is_sticky(void **state) {
  (void)state;
  const double sticky = plates("sticky"), slip = plates("slip");
  print_message("off the parabola by %.1e of 1; where it slips by %.1f\n", sticky, slip);
  BELOW(sticky, 0.005);
  BELOW(5, slip);
}

/* --- points ----------------------------------------------------------------------------------------------- */

static void points_stay_out_of_bodies(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "points_solid",
             "cattaneo: 1\nmodel: flow\ndomain: {size: [2, 1], cells: [64, 32], walls: {x+: open}}\n"
             "time: {end: 1, cfl: 0.8}\nflow: {walls: [{side: x-, velocity: [1, 0]}]}\n"
             "obstacles: [{shape: sphere, center: [0.7, 0.5], radius: 0.2, motion: ['0.1*t', '0.2*t']}]\n"
             "points: [{shape: box, center: [0.2, 0.5], half: [0.2, 0.3], per_cell: 4}]\n",
             1);
  run_to_the_end(&r);
  const cf_particles *p = cf_registry_find(&r.sim->registry, "points")->particles;
  assert_true(p->count > 900);
  for (int64_t i = 0; i < p->count; ++i)
    BELOW(0.2 - 1e-5, hypot((double)p->attribute[0].at[0][i] - 0.8, (double)p->attribute[0].at[1][i] - 0.7));
  scene_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stream_past_a_ball_is_a_mirror_of_itself),
      cmocka_unit_test(a_piston_pushes_exactly_its_volume),
      cmocka_unit_test(a_box_stirs_a_closed_tank_without_a_loss),
      cmocka_unit_test(layers_around_a_body_stay_at_rest),
      cmocka_unit_test(a_viscous_fluid_sticks_to_what_is_sticky),
      cmocka_unit_test(points_stay_out_of_bodies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
