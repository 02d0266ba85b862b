/* SPDX-License-Identifier: MIT
 *
 * Scenes with obstacles: what is in them, closed and held faces, ledgers, what moves, threads and stops.
 */
#include <math.h>

#include "base/mem.h"
#include "io/checkpoint.h"
#include "io/npy.h"
#include "model/obstacles.h"
#include "scene_run.h"

#define HEAD "cattaneo: 1\nmodel: tracer\n"

/* phi, and q where it is on faces: the same in both runs. */
static void same_state(const scene_run *a, const scene_run *b) {
  cf_view x, y;
  OK(cf_sim_field(a->sim, "phi", 0, &x));
  OK(cf_sim_field(b->sim, "phi", 0, &y));
  for (int j = 0; j < x.shape[1]; ++j)
    for (int i = 0; i < x.shape[0]; ++i)
      assert_true(x.at[i * x.stride[0] + j * x.stride[1]] == y.at[i * y.stride[0] + j * y.stride[1]]);
}

static const char *const schemes[] = {"paper", "sdirk2", "leapfrog", "default"};

/* Two plates and a disc that is held, in the plane; every scheme, with and without Fourier's share. */
static void nothing_passes_walls_and_what_held_cells_give_is_counted(void **state) {
  (void)state;
  for (int s = 0; s < 8; ++s) {
    char text[1024];
    scene_run r;
    snprintf(text, sizeof text,
             HEAD
             "domain: {size: [1, 1], cells: [48, 48], walls: {y+: open}}\n"
             "time: {end: 0.3, dt: 0.01}\n"
             "diffusion: {k: \"0.2 + 0.1*x\", tau: 0.2, f_t: %s, scheme: %s}\n"
             "fields: {phi: {initial: \"x < 0.3 ? 1 : 0\"}}\n"
             "sources: [{shape: everywhere, rate: 0.1}]\n"
             "obstacles:\n"
             "  - {shape: box, center: [0.5, 0.5], half: [0.03, 2]}\n"
             "  - {shape: sphere, center: [0.8, 0.4], radius: 0.1, kind: held, value: \"2 + sin(20*t)\"}\n",
             s % 2 == 0 ? "0" : "0.3", schemes[s / 2]);
    scene_open(&r, "obstacles_ledger", text, 1);
    OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
    BELOW(fabs(scene_metric(&r, "error_phi")), 1e-13);
    /* on the left nothing but the source has come in, and what left through the open wall */
    BELOW(scene_at(&r, 0.2, 0.1), 1.1);
    assert_true(scene_at(&r, 0.7, 0.3) > 0.2);
    assert_true(scene_metric(&r, "min_phi") > -0.2);
    scene_close(&r);
  }
}

/* Between two held cylinders phi = ln(r/b)/ln(a/b); with the staircase of cells the error falls with h. */
static double between_cylinders(const int cells) {
  char text[1024];
  double worst = 0;
  scene_run r;
  snprintf(text, sizeof text,
           HEAD
           "domain: {size: [1, 1], cells: [%d, %d], origin: [-0.5, -0.5]}\n"
           "time: {end: 2, dt: 0.1}\ndiffusion: {k: 1, tau: 0.01}\n"
           "solver: {tolerance: 1e-10}\nobstacles:\n"
           "  - {shape: sphere, center: [0, 0], radius: 0.45, outside: true, kind: held, value: 0}\n"
           "  - {shape: sphere, center: [0, 0], radius: 0.15, kind: held, value: 1}\n",
           cells, cells);
  scene_open(&r, "obstacles_cylinders", text, 1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  for (int i = 0; i < 16; ++i) {
    const double angle = i * acos(-1) / 8, at = 0.3;
    const double exact = log(at / 0.45) / log(0.15 / 0.45);
    worst = fmax(worst, fabs(scene_at(&r, at * cos(angle), at * sin(angle)) - exact));
  }
  scene_close(&r);
  return worst;
}

static void between_two_held_cylinders_is_the_logarithm(void **state) {
  (void)state;
  const double coarse = between_cylinders(32), fine = between_cylinders(128);
  print_message("steady state between cylinders: off by %.2e, %.2e\n", coarse, fine);
  BELOW(fine, 0.01);
  assert_true(coarse / fine > 2.5);
}

/* A pulse on a line comes back from a wall with its sign, and from what is held at 0 with the other. */
static double echo(const char *kind) {
  char text[1024];
  scene_run r;
  snprintf(text, sizeof text,
           HEAD
           "domain: {size: [1, 0.04], cells: [200, 8]}\ntime: {end: 0.6, dt: 0.0025}\n"
           "diffusion: {k: 100, tau: 100, scheme: leapfrog}\n"
           "fields: {phi: {initial: \"exp(-((x - 0.4)/0.05)^2)\"}}\n"
           "obstacles: [{shape: plane, center: [0.7, 0], normal: [-1, 0], %s}]\n",
           kind);
  scene_open(&r, "obstacles_echo", text, 1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  const double phi = scene_at(&r, 0.4, 0.02); /* half of the pulse went there and back in 2 x 0.3 */
  scene_close(&r);
  return phi;
}

static void a_wave_comes_back_from_a_wall_with_its_sign(void **state) {
  (void)state;
  const double wall = echo("kind: wall"), held = echo("kind: held, value: 0");
  /* the other half comes back from x = 0 at 0.2: not yet at 0.4 with its top */
  print_message("echo of a wall %.4f, of what is held %.4f\n", wall, held);
  assert_true(wall > 0.4 && wall < 0.6);
  assert_true(held < -0.4 && held > -0.6);
}

/* Mirrored obstacles, a mirrored field. */
static void what_is_symmetric_stays_so_and_a_wind_goes_around(void **state) {
  (void)state;
  scene_run r;
  scene_open(&r, "obstacles_symmetric",
             HEAD
             "domain: {size: [2, 1], cells: [64, 32], walls: {x-: {value: 1}, x+: {value: 1}}}\n"
             "time: {end: 0.5}\ndiffusion: {k: 0.01, tau: 0.1, f_t: 0.1}\nvelocity: [1, 0]\n"
             "fields: {phi: {initial: 1}}\n"
             "obstacles: [{shape: sphere, center: [0.8, 0.5], radius: 0.2}]\n",
             1);
  OK(cf_sim_run(r.sim, INFINITY, NULL, NULL));
  cf_view v, u;
  OK(cf_sim_field(r.sim, "phi", 0, &v));
  OK(cf_sim_field(r.sim, "velocity", 0, &u));
  double most = 0, lopsided = 0, constant = 0;
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 64; ++i) {
      const double phi = (double)v.at[i * v.stride[0] + j * v.stride[1]];
      const double mirror = (double)v.at[i * v.stride[0] + (31 - j) * v.stride[1]];
      lopsided = fmax(lopsided, fabs(phi - mirror));
      if (phi != 0) constant = fmax(constant, fabs(phi - 1));
      most = fmax(most, fabs((double)u.at[i * u.stride[0] + j * u.stride[1]]));
    }
  print_message("fastest %.2f, lopsided by %.1e, constant to %.1e\n", most, lopsided, constant);
  assert_true(most > 1.6 && most < 2.4); /* twice the wind beside a disc, a bit more in a channel */
  BELOW(lopsided, 1e-9);
  BELOW(constant, 1e-8);
  BELOW(fabs(scene_metric(&r, "error_phi")), 1e-12);
  scene_close(&r);
}

static const char *const moving = HEAD
    "domain: {size: [1, 1], cells: [40, 40], walls: {x-: periodic, x+: periodic}}\n"
    "time: {end: 0.3}\ndiffusion: {k: 0.01, tau: 0.1, f_t: 0.1}\n"
    "fields: {phi: {initial: \"0.5 + 0.5*tanh((y - 0.5)/0.1)\"}}\nvelocity: [0.3, 0]\nobstacles:\n"
    "  - {shape: box, center: [0.3, 0.5], half: [0.15, 0.05], motion: [\"0.5*t\", \"0\"], rotation: 3*t}\n"
    "  - {shape: sphere, center: [0.7, 0.2], radius: 0.1, kind: held, value: \"0.5 + 0.5*sin(10*t)\",\n"
    "     path: [{time: 0, place: [0.7, 0.2]}, {time: 0.2, place: [0.6, 0.3]}]}\n";

/* The ledger with covered and uncovered cells; bits over threads; a stop. */
static void obstacles_that_move_keep_ledger_bits_and_stops(void **state) {
  (void)state;
  scene_run whole, again;
  bool landed;
  scene_open(&whole, "obstacles_move_1", moving, 1);
  OK(cf_sim_run(whole.sim, INFINITY, NULL, NULL));
  BELOW(fabs(scene_metric(&whole, "error_phi")), 1e-13);
  assert_true(scene_metric(&whole, "min_phi") >= 0 && scene_metric(&whole, "max_phi") <= 1);
  scene_open(&again, "obstacles_move_2", moving, 2);
  for (int i = 0; i < 30; ++i) OK(cf_sim_step(again.sim, &landed));
  char path[1024];
  snprintf(path, sizeof path, "%s/state.h5", folder_fresh("obstacles_state"));
  OK(cf_sim_save(again.sim, path));
  scene_close(&again);
  scene_open(&again, "obstacles_move_3", moving, 1);
  OK(cf_sim_load(again.sim, path));
  OK(cf_sim_run(again.sim, INFINITY, NULL, NULL));
  same_state(&whole, &again);
  scene_close(&again);
  scene_close(&whole);
}

/* Iterations of implicit steps around plates and around a ball stay few. */
static void solves_around_plates_and_a_ball_take_few_iterations(void **state) {
  (void)state;
  static const char *const bodies[] = {
      "domain: {size: [2, 1], cells: [256, 128], walls: {x-: {value: 1}}}\nobstacles:\n"
      "  - {shape: box, center: [0.4, 0.36], half: [0.02, 0.38]}\n"
      "  - {shape: box, center: [0.8, 0.62], half: [0.02, 0.40], turn: 8}\n"
      "  - {shape: box, center: [1.2, 0.38], half: [0.02, 0.40], turn: 8}\n",
      "domain: {size: [1, 1, 1], cells: [32, 32, 32], walls: {x-: {value: 1}}}\nobstacles:\n"
      "  - {shape: sphere, center: [0.5, 0.5, 0.5], radius: 0.3}\n"};
  for (int b = 0; b < 2; ++b) {
    char text[1024];
    scene_run r;
    snprintf(text, sizeof text,
             HEAD "time: {end: 1, dt: 0.05}\ndiffusion: {k: 1, tau: 0.1, scheme: paper}\n%s", bodies[b]);
    scene_open(&r, "obstacles_iterations", text, 1);
    int most = 0;
    for (int i = 0; i < 4; ++i) {
      OK(cf_sim_step(r.sim, NULL));
      most = (int)fmax(most, scene_metric(&r, "iterations"));
    }
    print_message("%s: at most %d iterations\n", b == 0 ? "plates" : "ball", most);
    assert_true(most > 0 && most <= 10);
    scene_close(&r);
  }
}

/* Distances from numpy's file are the body; files that are none are told. */
static void distances_come_from_a_file(void **state) {
  (void)state;
  const char *folder = folder_fresh("obstacles_npy");
  char path[1100];
  scene_run r;
  static double values[16 * 16];
  unsigned char head[128];
  int axes, n[3];
  float *read;
  const char *text = "{'descr': '<f8', 'fortran_order': False, 'shape': (16, 16), }";
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i)
      values[16 * j + i] = hypot((i + 0.5) / 16 - 0.5, (j + 0.5) / 16 - 0.5) - 0.25;
  memset(head, ' ', sizeof head);
  memcpy(head, "\x93NUMPY\x01\x00\x76\x00", 10);
  memcpy(head + 10, text, strlen(text));
  head[127] = '\n';
  snprintf(path, sizeof path, "%s/d.npy", folder);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fwrite(head, 1, sizeof head, file);
  fwrite(values, sizeof *values, 256, file);
  fclose(file);
  OK(cf_npy_read(path, &axes, n, &read));
  assert_true(axes == 2 && n[0] == 16 && n[1] == 16 && n[2] == 1 &&
              fabs((double)read[17] - values[17]) < 1e-6);
  cf_free(read);
  char scene[1600];
  snprintf(scene, sizeof scene,
           HEAD
           "domain: {size: [1, 1], cells: [32, 32]}\ntime: {end: 1}\nobstacles: [{shape: file, file: %s, "
           "spacing: 0.0625, origin: [0.03125, 0.03125]}]\n",
           path);
  scene_open(&r, "obstacles_file", scene, 1);
  const cf_obstacles *o = r.sim->model->obstacles(r.sim->state);
  assert_true(o->solid > 180 && o->solid < 215); /* pi/16 of 1024 cells: 201 */
  scene_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nothing_passes_walls_and_what_held_cells_give_is_counted),
      cmocka_unit_test(between_two_held_cylinders_is_the_logarithm),
      cmocka_unit_test(a_wave_comes_back_from_a_wall_with_its_sign),
      cmocka_unit_test(what_is_symmetric_stays_so_and_a_wind_goes_around),
      cmocka_unit_test(obstacles_that_move_keep_ledger_bits_and_stops),
      cmocka_unit_test(solves_around_plates_and_a_ball_take_few_iterations),
      cmocka_unit_test(distances_come_from_a_file),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
