/* SPDX-License-Identifier: MIT
 *
 * Good scenes: what is read, what is worked out, what is written back, and that a resolved scene read again is the
 * same scene.
 */
#include "model/scene.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "testing.h"

#define HEAD "cattaneo: 1\nmodel: tracer\n"
#define BOX  "domain: {size: [4, 8], cells: [64, 128]}\n"
#define TIME "time: {end: 12.5}\n"

/* The scene of the contract, with most of what a scene may say. */
static const char full[] =
    "time: {end: 12.5, dt: 1/24, frames: 24}\n" HEAD
    "title: \"Cone, H_c = 2 \\\"so\\\"\"\n"
    "let: {H: 2, L: 3 cm, c: 1/H}\n"
    "domain:\n"
    "  size: [4, 8]\n"
    "  cells: [32*H, 128]\n"
    "  origin: [-1, 1 cm]\n"
    "  walls: {x-: open, x+: {value: \"sin(t)*H\"}, y-: radiate}\n"
    "diffusion: {k: 2.5 cm^2/s, tau: 4 min, f_t: 25 %, scheme: paper, front_filter: off}\n"
    "advection: {scheme: linear}\n"
    "fields:\n"
    "  phi: {initial: exp(-x^2), unit: kg/m^3}\n"
    "  salt: {diffusion: {tau: 1, capacity: 1 + y^2}, walls: {x-: insulated}}\n"
    "  q_salt: {initial: [\"0\", x]}\n"
    "velocity: [\"0\", 0.5*c]\n"
    "sources:\n"
    "  - {field: phi, shape: box, center: [2, 2], half: [0.0625, 0.0625], rate: 50}\n"
    "  - {field: salt, at: [2, 2], amount: H*t}\n"
    "  - {field: q_salt, shape: sphere, center: [2, 2], radius: L, rate: [x, t]}\n"
    "  - {field: salt, shape: everywhere, value: 1}\n"
    "solver: {tolerance: 1e-9, max_iterations: 50, on_stall: stop, levels: 3}\n"
    "output:\n"
    "  fields: [salt, q]\n"
    "  formats: [npy]\n"
    "  checkpoint: {every: 100 steps, keep: 7}\n"
    "  preview: {field: salt, map: ice, range: [0, 1], size: [640, 480]}\n";

static const char *path(void) {
  static char name[300];
  snprintf(name, sizeof name, "%s/test_scene_%ld.yaml", CF_BINARY_DIR, (long)getpid());
  return name;
}

static void put(const char *text) {
  FILE *file = fopen(path(), "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
  fclose(file);
}

static cf_scene *read_set(const char *text, const int overrides, const char *const *set) {
  cf_scene *scene;
  put(text);
  OK(cf_scene_read(&scene, path(), overrides, set));
  remove(path());
  return scene;
}

static cf_scene *read_text(const char *text) { return read_set(text, 0, NULL); }

static double at(const cf_function *function, const double x, const double t) {
  return cf_fn_at(&function->fn, x, 0.0, 0.0, t);
}

/* --- reading ---------------------------------------------------------------------------------- */

static void scene_values_are_read(void **state) {
  (void)state;
  cf_scene *s = read_text(full);
  assert_string_equal(s->title, "Cone, H_c = 2 \"so\"");
  assert_int_equal(s->model, CF_SCENE_MODEL_TRACER);
  assert_int_equal(s->dim, 2);
  CLOSE(s->spacing, 0.0625, 0);
  assert_int_equal(s->domain.cells.value[0], 64);
  CLOSE(s->domain.origin.value[1], 0.01, 1e-18);
  CLOSE(s->time.dt, 1.0 / 24, 0);
  assert_int_equal(s->diffusion.scheme, CF_SCENE_SCHEME_PAPER);
  assert_int_equal(s->diffusion.front_filter, CF_SCENE_FILTER_OFF);
  assert_int_equal(s->advection.scheme, CF_SCENE_ADVECTION_LINEAR);
  CLOSE(at(&s->velocity.axis[1], 0, 0), 0.25, 0);
  assert_int_equal(s->solver.on_stall, CF_SCENE_STALL_STOP);
  assert_int_equal(s->output.formats, 1u << CF_SCENE_FORMAT_NPY);
  assert_true(s->output.checkpoint.every.in_steps);
  CLOSE(s->output.checkpoint.every.every, 100, 0);
  assert_int_equal(s->output.preview.size.value[0], 640);
  cf_scene_destroy(s);
}

static void scene_units_are_changed(void **state) {
  (void)state;
  cf_scene *s = read_text(full);
  CLOSE(at(&s->diffusion.k, 0, 0), 2.5e-4, 1e-19);
  CLOSE(s->diffusion.tau, 240, 0);
  CLOSE(s->diffusion.f_t, 0.25, 1e-16);
  CLOSE(s->let.value[1], 0.03, 1e-17);
  CLOSE(s->sources.item[2].radius, 0.03, 1e-17);
  cf_scene_destroy(s);
  s = read_text(HEAD BOX TIME "diffusion: {k: 0.5*(1 + x) cm^2/s}\noutput: {checkpoint: {every: 2 min}}\n");
  CLOSE(at(&s->diffusion.k, 3, 0), 2e-4, 1e-19);
  CLOSE(s->output.checkpoint.every.every, 120, 0);
  assert_false(s->output.checkpoint.every.in_steps);
  cf_scene_destroy(s);
}

static void scene_left_out_has_its_defaults(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME);
  assert_int_equal(s->fields.count, 1);
  assert_string_equal(s->fields.item[0].name, "phi");
  CLOSE(at(&s->fields.item[0].initial.axis[0], 1, 0), 0, 0);
  assert_int_equal(s->velocity.count, 2);
  CLOSE(at(&s->velocity.axis[1], 1, 0), 0, 0);
  assert_true(isnan(s->time.dt));
  CLOSE(s->time.cfl, 0.5, 0);
  assert_int_equal(s->domain.walls.walls.kind[1][1], CF_WALL_INSULATED);
  CLOSE(s->diffusion.tau, 0, 0);
  CLOSE(at(&s->diffusion.capacity, 0, 0), 1, 0);
  assert_int_equal(s->diffusion.flux_rate, CF_SCENE_FLUX_RATE_OBJECTIVE);
  assert_int_equal(s->sources.count, 0);
  assert_int_equal(s->output.formats, 1u << CF_SCENE_FORMAT_VTKHDF | 1u << CF_SCENE_FORMAT_PNG);
  assert_int_equal(s->output.fields.count, 1);
  assert_int_equal(s->output.preview.range.count, 0);
  CLOSE(s->output.checkpoint.every.every, 600, 0);
  cf_scene_destroy(s);
}

static void scene_tells_what_was_given(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX "time: {end: 1, cfl: 0.5}\n");
  assert_true(s->time.given.cfl);
  assert_false(s->time.given.dt || s->given.diffusion);
  assert_true(cf_scene_has(s, "time.cfl") && cf_scene_has(s, "domain.cells.1"));
  assert_false(cf_scene_has(s, "time.dt") || cf_scene_has(s, "domain.cells.2"));
  cf_scene_destroy(s);
}

static void scene_may_be_json(void **state) {
  (void)state;
  cf_scene *s = read_text(
      "{\"cattaneo\": 1, \"model\": \"tracer\", \"time\": {\"end\": 2.5},\n"
      " \"domain\": {\"size\": [1, 1, 1], \"cells\": [8, 8, 8]}}\n");
  assert_int_equal(s->dim, 3);
  CLOSE(s->time.end, 2.5, 0);
  cf_scene_destroy(s);
}

static void scene_title_may_be_any_text(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME "title: \"W\u00E4rme \u71B1 \\\\ \\t 50 % \u2192 \U0001F300\"\n");
  assert_string_equal(s->title, "W\u00E4rme \u71B1 \\ \t 50 % \u2192 \U0001F300");
  cf_scene_destroy(s);
}

static void scene_anchors_stand_for_what_they_name(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD TIME "domain: {size: &n [8, 8], cells: *n}\n");
  assert_int_equal(s->domain.cells.value[1], 8);
  cf_scene_destroy(s);
}

static void scene_folder_is_that_of_the_file(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME);
  assert_string_equal(cf_scene_path(s), path());
  assert_string_equal(cf_scene_folder(s), CF_BINARY_DIR);
  cf_scene_destroy(s);
}

/* --- what is worked out ----------------------------------------------------------------------- */

static void scene_front_speed_stands_for_tau_or_k(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME "diffusion: {k: 2, front_speed: 4, f_t: 0.5}\n");
  CLOSE(s->diffusion.tau, 0.5 * 2 / 16, 1e-17);
  assert_true(isnan(s->diffusion.front_speed) && !s->diffusion.given.front_speed);
  cf_scene_destroy(s);
  s = read_text(HEAD BOX TIME "diffusion: {tau: 2, front_speed: 4, f_t: 0.5}\n");
  CLOSE(at(&s->diffusion.k, 0, 0), 16 * 2 / 0.5, 1e-12);
  cf_scene_destroy(s);
}

static void scene_field_has_what_it_does_not_override(void **state) {
  (void)state;
  cf_scene *s = read_text(full);
  const cf_scene_field *phi = &s->fields.item[0], *salt = &s->fields.item[1];
  CLOSE(phi->diffusion.tau, 240, 0);
  CLOSE(salt->diffusion.tau, 1, 0);
  CLOSE(salt->diffusion.f_t, 0.25, 1e-16);
  CLOSE(at(&salt->diffusion.k, 0, 0), 2.5e-4, 1e-19);
  CLOSE(cf_fn_at(&salt->diffusion.capacity.fn, 0, 2, 0, 0), 5, 0);
  assert_int_equal(salt->diffusion.scheme, CF_SCENE_SCHEME_PAPER);
  assert_int_equal(phi->walls.walls.kind[0][0], CF_WALL_OPEN);
  assert_int_equal(salt->walls.walls.kind[0][0], CF_WALL_INSULATED);
  assert_int_equal(salt->walls.walls.kind[0][1], CF_WALL_VALUE);
  CLOSE(cf_fn_at(&salt->walls.walls.value[0][1], 0, 0, 0, 1), 2 * sin(1.0), 0);
  assert_int_equal(salt->walls.walls.kind[1][0], CF_WALL_RADIATE);
  assert_int_equal(salt->walls.walls.kind[1][1], CF_WALL_INSULATED);
  cf_scene_destroy(s);
}

static void scene_field_may_have_a_front_speed_of_its_own(void **state) {
  (void)state;
  cf_scene *s = read_text(
      HEAD BOX TIME "diffusion: {k: 2, tau: 3}\nfields: {a: {diffusion: {k: 8, front_speed: 2}}, b: {}}\n");
  CLOSE(s->fields.item[0].diffusion.tau, 2, 0);
  CLOSE(s->fields.item[1].diffusion.tau, 3, 0);
  cf_scene_destroy(s);
}

static void scene_flux_belongs_to_a_scalar(void **state) {
  (void)state;
  cf_scene *s = read_text(full);
  assert_int_equal(cf_scene_flux_scalar(s, "q"), 0);
  assert_int_equal(cf_scene_flux_scalar(s, "q_salt"), 1);
  assert_int_equal(cf_scene_flux_scalar(s, "q_sugar"), -1);
  assert_int_equal(cf_scene_flux_scalar(s, "salt"), -1);
  assert_int_equal(cf_scene_field_index(s, "q_salt"), 2);
  assert_int_equal(s->fields.item[2].initial.count, 2);
  cf_scene_destroy(s);
  s = read_text(HEAD BOX TIME "fields: {heat: {}, q: {}}\n");
  assert_int_equal(cf_scene_flux_scalar(s, "q"), 0);
  assert_int_equal(s->fields.item[1].initial.count, 2);
  cf_scene_destroy(s);
}

static void scene_source_finds_the_only_scalar(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME "fields: {heat: {}}\nsources: [{shape: everywhere, rate: 1}]\n");
  assert_string_equal(s->sources.item[0].field, "heat");
  cf_scene_destroy(s);
}

/* --- overrides -------------------------------------------------------------------------------- */

static void scene_override_goes_before_the_file(void **state) {
  (void)state;
  const char *const set[] = {
      "diffusion.tau=2 min",        "sources.0.rate=x*t",     "title=a: b, [c",
      "fields.phi.initial=7",       "velocity=[1, \"2\"]",    "let.H=4",
      "domain.cells.0=16*H",        "fields.new.unit=K",      "output.preview.map=\"gr\\u00E4y\"",
      "domain.walls.x-={value: 5}", "solver={tolerance: 0.5}"};
  cf_scene *s = read_set(full, sizeof set / sizeof set[0], set);
  CLOSE(s->diffusion.tau, 120, 0);
  CLOSE(cf_fn_at(&s->sources.item[0].rate.axis[0].fn, 2, 0, 0, 3), 6, 0);
  assert_string_equal(s->title, "a: b, [c");
  CLOSE(at(&s->fields.item[0].initial.axis[0], 1, 0), 7, 0);
  CLOSE(at(&s->velocity.axis[1], 0, 0), 2, 0);
  CLOSE(s->let.value[0], 4, 0);
  assert_int_equal(s->domain.cells.value[0], 64);
  assert_true(cf_scene_field_index(s, "new") == 3);
  assert_string_equal(s->output.preview.map, "gr\u00E4y");
  assert_int_equal(s->domain.walls.walls.kind[0][0], CF_WALL_VALUE);
  CLOSE(s->solver.tolerance, 0.5, 0);
  assert_int_equal(s->solver.max_iterations, 200);
  cf_scene_destroy(s);
}

static void scene_last_override_counts(void **state) {
  (void)state;
  const char *const set[] = {"time={end: 2}",   "diffusion={tau: 1, k: 3}", "diffusion.tau=2",
                             "diffusion.tau=5", "diffusion={k: 3, tau: 6}", "title=z"};
  cf_scene *s = read_set(HEAD BOX TIME, 6, set);
  CLOSE(s->diffusion.tau, 6, 0);
  CLOSE(at(&s->diffusion.k, 0, 0), 3, 0);
  assert_string_equal(s->title, "z");
  cf_scene_destroy(s);
}

/* --- errors from elsewhere -------------------------------------------------------------------- */

static void said_at(const cf_scene *scene, const char *key, const char *message) {
  assert_int_equal(cf_scene_fail_at(scene, key, "%s is no good", key), CF_BAD_SCENE);
  const char *colon = strstr(cf_status_sentence(), ".yaml");
  assert_non_null(colon);
  assert_string_equal(colon, message);
}

static void scene_error_points_at_the_key(void **state) {
  (void)state;
  cf_scene *s = read_text(HEAD BOX TIME "diffusion:\n  tau: 4\nsources:\n  - {shape: everywhere, rate: 1}\n");
  said_at(
      s, "diffusion.tau",
      ".yaml:6:8: error: diffusion.tau is no good\n  tau: 4\n       ^\ntry: cattaneo explain diffusion.tau");
  said_at(
      s, "diffusion.k",
      ".yaml:5:1: error: diffusion.k is no good\ndiffusion:\n^~~~~~~~~\ntry: cattaneo explain diffusion.k");
  said_at(s, "sources.0.rate",
          ".yaml:8:31: error: sources.0.rate is no good\n  - {shape: everywhere, rate: 1}\n"
          "                              ^\ntry: cattaneo explain sources.0.rate");
  said_at(s, "domain.cells.1",
          ".yaml:3:36: error: domain.cells.1 is no good\n" BOX
          "                                   ^~~\n"
          "try: cattaneo explain domain.cells");
  said_at(s, "solver.levels", ".yaml: error: solver.levels is no good\ntry: cattaneo explain solver.levels");
  cf_scene_destroy(s);
}

/* --- writing ---------------------------------------------------------------------------------- */

static void same_functions(const cf_param_functions *a, const cf_param_functions *b) {
  assert_int_equal(a->count, b->count);
  for (int i = 0; i < a->count; ++i) {
    assert_string_equal(a->axis[i].text, b->axis[i].text);
    for (double x = -1; x < 2; x += 0.37)
      CLOSE(cf_fn_at(&a->axis[i].fn, x, 2 * x, 3 * x, x), cf_fn_at(&b->axis[i].fn, x, 2 * x, 3 * x, x), 0);
  }
}

static void same_walls(const cf_param_walls *a, const cf_param_walls *b) {
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, high = side % 2;
    assert_int_equal(a->walls.kind[axis][high], b->walls.kind[axis][high]);
    CLOSE(cf_fn_at(&a->walls.value[axis][high], 1, 2, 3, 4),
          cf_fn_at(&b->walls.value[axis][high], 1, 2, 3, 4), 0);
  }
}

static void same_diffusion(const cf_scene_diffusion *a, const cf_scene_diffusion *b) {
  CLOSE(cf_fn_at(&a->k.fn, 1, 2, 3, 0), cf_fn_at(&b->k.fn, 1, 2, 3, 0), 0);
  CLOSE(cf_fn_at(&a->capacity.fn, 1, 2, 3, 0), cf_fn_at(&b->capacity.fn, 1, 2, 3, 0), 0);
  CLOSE(a->tau, b->tau, 0);
  CLOSE(a->f_t, b->f_t, 0);
  assert_int_equal(a->scheme, b->scheme);
  assert_int_equal(a->flux_rate, b->flux_rate);
  assert_int_equal(a->front_filter, b->front_filter);
}

static void same_scene(const cf_scene *a, const cf_scene *b) {
  assert_string_equal(a->title, b->title);
  CLOSE(a->spacing, b->spacing, 0);
  for (int i = 0; i < a->dim; ++i) CLOSE(a->domain.origin.value[i], b->domain.origin.value[i], 0);
  CLOSE(a->time.end, b->time.end, 0);
  assert_true(isnan(a->time.dt) ? isnan(b->time.dt) : a->time.dt == b->time.dt);
  CLOSE(a->time.frames, b->time.frames, 0);
  same_walls(&a->domain.walls, &b->domain.walls);
  same_diffusion(&a->diffusion, &b->diffusion);
  same_functions(&a->velocity, &b->velocity);
  assert_int_equal(a->fields.count, b->fields.count);
  for (int i = 0; i < a->fields.count; ++i) {
    const cf_scene_field *f = &a->fields.item[i], *g = &b->fields.item[i];
    assert_string_equal(f->name, g->name);
    assert_string_equal(f->unit, g->unit);
    same_functions(&f->initial, &g->initial);
    if (cf_scene_name_is_flux(f->name)) continue;
    same_diffusion(&f->diffusion, &g->diffusion);
    same_walls(&f->walls, &g->walls);
  }
  assert_int_equal(a->sources.count, b->sources.count);
  for (int i = 0; i < a->sources.count; ++i) {
    const cf_scene_source *f = &a->sources.item[i], *g = &b->sources.item[i];
    assert_memory_equal(&f->given, &g->given, sizeof f->given);
    assert_string_equal(f->field, g->field);
    assert_int_equal(f->shape, g->shape);
    assert_memory_equal(&f->center, &g->center, sizeof f->center);
    assert_memory_equal(&f->half, &g->half, sizeof f->half);
    assert_memory_equal(&f->at, &g->at, sizeof f->at);
    same_functions(&f->rate, &g->rate);
    same_functions(&f->value, &g->value);
  }
  CLOSE(a->solver.tolerance, b->solver.tolerance, 0);
  assert_int_equal(a->solver.levels, b->solver.levels);
  assert_int_equal(a->output.formats, b->output.formats);
  assert_int_equal(a->output.fields.count, b->output.fields.count);
  CLOSE(a->output.checkpoint.every.every, b->output.checkpoint.every.every, 0);
  assert_memory_equal(&a->output.preview.range, &b->output.preview.range, sizeof a->output.preview.range);
}

static void round_trip(const char *text) {
  char *once, *twice;
  cf_scene *a = read_text(text);
  OK(cf_scene_write(a, &once));
  cf_scene *b = read_text(once);
  OK(cf_scene_write(b, &twice));
  same_scene(a, b);
  assert_string_equal(once, twice);
  cf_free(once);
  cf_free(twice);
  cf_scene_destroy(a);
  cf_scene_destroy(b);
}

static void scene_written_and_read_is_the_same(void **state) {
  (void)state;
  round_trip(full);
  round_trip(HEAD BOX TIME);
  round_trip(HEAD TIME
             "domain: {size: [1, 1, 1], cells: [8, 8, 8], walls: periodic}\n"
             "diffusion: {k: 1/3, front_speed: 0.1 cm/s, f_t: 0.1}\nvelocity: [1, 1/3, \"sin(t)\"]\n"
             "fields: {a: {diffusion: {front_speed: 7, tau: 1/7}}, b: {}, q_a: {}}\n"
             "output: {formats: [], fields: [], checkpoint: {every: never}}\n"
             "title: \"#: {[\\\"\\\\'\\n\"\n");
}

static void scene_written_has_every_default(void **state) {
  (void)state;
  static const char *const lines[] = {
      "\n  dt: auto\n",       "\n  scheme: default\n", "\n  tolerance: 1e-06\n",      "\nsources: []\n",
      "\n    every: 600 s\n", "\n  origin: [0, 0]\n",  "\nvelocity: [\"0\", \"0\"]\n"};
  char *text;
  cf_scene *s = read_text(HEAD BOX TIME);
  OK(cf_scene_write(s, &text));
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i)
    if (strstr(text, lines[i]) == NULL) fail_msg("there is no line %s in\n%s", lines[i], text);
  assert_true(strncmp(text, "cattaneo: 1\n", 12) == 0);
  cf_free(text);
  cf_scene_destroy(s);
}

/* --- explaining ------------------------------------------------------------------------------- */

static void scene_explains_every_key(void **state) {
  (void)state;
  static const char *const keys[] = {"\ndiffusion.k\n", "\nfields.NAME.initial\n", "\nsources.0.rate\n",
                                     "\noutput.checkpoint.every\n", "\ntime.dt\n"};
  char *text;
  OK(cf_scene_explain(NULL, &text));
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) assert_non_null(strstr(text, keys[i]));
  cf_free(text);
}

static void scene_explains_a_key(void **state) {
  (void)state;
  char *text;
  OK(cf_scene_explain("diffusion.f_t", &text));
  assert_string_equal(
      text,
      "diffusion.f_t\n  The fraction F_T of Fourier's law in the flux: 0 is Cattaneo's law, 1 Fourier's\n"
      "  type     number\n  range    >= 0 and <= 1\n  default  0\n");
  cf_free(text);
  OK(cf_scene_explain("fields.salt.diffusion.tau", &text));
  assert_non_null(strstr(text, "  unit     s\n"));
  cf_free(text);
  assert_int_equal(cf_scene_explain("difusion.k", &text), CF_BAD_USAGE);
  assert_string_equal(cf_status_sentence(), "there is no key difusion.k: did you mean diffusion.k?");
  assert_null(text);
}

/* --- memory ----------------------------------------------------------------------------------- */

static void scene_survives_every_failed_allocation(void **state) {
  (void)state;
  cf_scene *s = NULL;
  char *text = NULL;
  cf_status status = CF_NO_MEMORY;
  put(full);
  for (int n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_scene_read(&s, path(), 0, NULL);
    cf_mem_fail_at(0);
    assert_true(status == CF_OK ? n > 100 : status == CF_NO_MEMORY && s == NULL);
  }
  remove(path());
  status = CF_NO_MEMORY;
  for (int n = 1; status != CF_OK; ++n) {
    cf_mem_fail_at(n);
    status = cf_scene_write(s, &text);
    cf_mem_fail_at(0);
    assert_true(status == CF_OK ? n > 1 : status == CF_NO_MEMORY && text == NULL);
  }
  cf_free(text);
  cf_scene_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scene_values_are_read),
      cmocka_unit_test(scene_units_are_changed),
      cmocka_unit_test(scene_left_out_has_its_defaults),
      cmocka_unit_test(scene_tells_what_was_given),
      cmocka_unit_test(scene_may_be_json),
      cmocka_unit_test(scene_title_may_be_any_text),
      cmocka_unit_test(scene_anchors_stand_for_what_they_name),
      cmocka_unit_test(scene_folder_is_that_of_the_file),
      cmocka_unit_test(scene_front_speed_stands_for_tau_or_k),
      cmocka_unit_test(scene_field_has_what_it_does_not_override),
      cmocka_unit_test(scene_field_may_have_a_front_speed_of_its_own),
      cmocka_unit_test(scene_flux_belongs_to_a_scalar),
      cmocka_unit_test(scene_source_finds_the_only_scalar),
      cmocka_unit_test(scene_override_goes_before_the_file),
      cmocka_unit_test(scene_last_override_counts),
      cmocka_unit_test(scene_error_points_at_the_key),
      cmocka_unit_test(scene_written_and_read_is_the_same),
      cmocka_unit_test(scene_written_has_every_default),
      cmocka_unit_test(scene_explains_every_key),
      cmocka_unit_test(scene_explains_a_key),
      cmocka_unit_test(scene_survives_every_failed_allocation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
