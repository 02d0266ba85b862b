/* SPDX-License-Identifier: MIT
 *
 * also in single precision
 */
#define _GNU_SOURCE
#include <signal.h>
#include <sys/resource.h>

#include "io/checkpoint.h"
#include "output_case.h"

/* Everything that is state, one after the other. */
static size_t snapshot(const output_case *c, unsigned char *bytes) {
  const cf_box *b = &c->grid.box;
  size_t n = 0;
  for (int k = 0; k < b->n[2] + (b->dim == 3); ++k)
    for (int j = 0; j <= b->n[1]; ++j)
      for (int i = 0; i <= b->n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(b, i, j, k);
        const int out[3] = {i == b->n[0], j == b->n[1], k == b->n[2]};
        for (int a = -1; a < b->dim; ++a) {
          bool inside = true;
          for (int d = 0; d < 3; ++d) inside = inside && (out[d] == 0 || d == a);
          if (inside) memcpy(bytes + n, a < 0 ? &c->phi.at[p] : &c->q.at[a][p], sizeof(cf_real));
          n += inside ? sizeof(cf_real) : 0;
        }
      }
  memcpy(bytes + n, c->ledger, sizeof c->ledger);
  memcpy(bytes + n + sizeof c->ledger, &c->step, sizeof c->step);
  n += sizeof c->ledger + sizeof c->step;
  for (int a = 0; a < c->ink->attributes; ++a)
    for (int d = 0; d < c->ink->attribute[a].components; ++d, n += CASE_PARTICLES * sizeof(cf_real))
      memcpy(bytes + n, c->ink->attribute[a].at[d], CASE_PARTICLES * sizeof(cf_real));
  memcpy(bytes + n, c->ink->id, CASE_PARTICLES * sizeof *c->ink->id);
  n += CASE_PARTICLES * sizeof *c->ink->id;
  memcpy(bytes + n, &c->ink->next_id, sizeof c->ink->next_id);
  return n + sizeof c->ink->next_id;
}

static void write_good(output_case *c, const int64_t step, const int keep) {
  c->stamp.step = step;
  assert_int_equal(cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, keep), CF_OK);
}

static void checkpoint_restores_every_bit(void **state) {
  output_case *c = *state;
  static unsigned char before[1 << 16], after[1 << 16];
  write_good(c, 12, 2);
  const size_t n = snapshot(c, before);
  output_case_fill(c, 55);
  snapshot(c, after);
  assert_memory_not_equal(before, after, n);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_OK);
  assert_int_equal(snapshot(c, after), n);
  assert_memory_equal(before, after, n);
}

static void checkpoint_describes_itself(void **state) {
  output_case *c = *state;
  cf_checkpoint_facts facts;
  char *scene;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  assert_int_equal(cf_checkpoint_describe(path.text, &facts, &scene), CF_OK);
  assert_string_equal(facts.title, c->stamp.title);
  assert_string_equal(facts.precision, CF_PRECISION);
  assert_string_equal(scene, c->stamp.scene);
  assert_true(facts.time == c->stamp.time && facts.step == 12 && facts.h == c->grid.h && facts.n[0] == 5);
  cf_free(scene);
}

static void every_flipped_bit_is_found_and_the_state_stays(void **state) {
  output_case *c = *state;
  static unsigned char before[1 << 16], after[1 << 16];
  char *bytes;
  size_t size;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5"), bad = case_path(c, "bad.h5");
  assert_int_equal(cf_file_read(path.text, 1 << 24, &bytes, &size), CF_OK);
  output_case_fill(c, 3);
  const size_t n = snapshot(c, before);
  for (size_t i = 0; i < size; i += 13) {
    bytes[i] = (char)(bytes[i] ^ (1 << (i % 8)));
    assert_int_equal(cf_file_write(bad.text, bytes, size), CF_OK);
    assert_int_equal(cf_checkpoint_read(bad.text, &c->registry), CF_BAD_FILE);
    assert_says("bad.h5: ");
    bytes[i] = (char)(bytes[i] ^ (1 << (i % 8)));
  }
  for (size_t length = 0; length < size; length += 101) {
    assert_int_equal(cf_file_write(bad.text, bytes, length), CF_OK);
    assert_int_equal(cf_checkpoint_read(bad.text, &c->registry), CF_BAD_FILE);
  }
  assert_says("cut short");
  snapshot(c, after);
  assert_memory_equal(before, after, n);
  cf_free(bytes);
}

static void damage_names_the_array(void **state) {
  output_case *c = *state;
  char *bytes;
  size_t size;
  const cf_real wanted = c->phi.at[0];
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  assert_int_equal(cf_file_read(path.text, 1 << 24, &bytes, &size), CF_OK);
  unsigned char *phi = memmem(bytes, size, &wanted, sizeof wanted);
  assert_non_null(phi);
  phi[1] = (unsigned char)(phi[1] ^ 4);
  assert_int_equal(cf_file_write(path.text, bytes, size), CF_OK);
  assert_int_equal(cf_checkpoint_check(path.text), CF_BAD_FILE);
  assert_says("is damaged: phi (checksum ");
  cf_free(bytes);
}

static void other_shapes_and_names_are_refused(void **state) {
  output_case *c = *state;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  const cf_registry kept = c->registry;
  c->registry.count -= 1;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("has \"step\", which this scene does not know");
  c->registry.count += 1;
  double extra = 5;
  assert_int_equal(cf_registry_add_numbers(&c->registry, "tip", "m", &extra, 1), CF_OK);
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("has no \"tip\" (number), which this scene needs");
  c->registry.count -= 1;
  c->registry.entry[3].components = 2;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("/state/ledger has another shape");
  c->registry.entry[3].components = 3;
  c->grid.box.n[0] = 4;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("expected 4 x 4 x 3 cells, found 5 x 4 x 3");
  c->grid.box.n[0] = 5;
  c->grid.h = 0.5;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("spacing");
  c->grid.h = 0.25;
  assert_int_equal(kept.count, c->registry.count);
}

static void particles_get_room(void **state) {
  output_case *c = *state;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  cf_particles *fresh;
  assert_int_equal(cf_particles_create(&fresh, "ink", 2, 1), CF_OK);
  assert_int_equal(cf_particles_attribute(fresh, "age", "s", 1, CF_CARRIED, NULL), CF_OK);
  assert_int_equal(cf_particles_append(fresh, 3, NULL), CF_OK);
  c->registry.entry[2].particles = fresh;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_OK);
  assert_int_equal(fresh->count, CASE_PARTICLES);
  assert_memory_equal(fresh->id, c->ink->id, CASE_PARTICLES * sizeof *fresh->id);
  assert_memory_equal(fresh->attribute[0].at[1], c->ink->attribute[0].at[1],
                      CASE_PARTICLES * sizeof(cf_real));
  assert_memory_equal(fresh->attribute[1].at[0], c->ink->attribute[1].at[0],
                      CASE_PARTICLES * sizeof(cf_real));
  assert_int_equal(fresh->next_id, c->ink->next_id);
  cf_particles_destroy(fresh);
}

static void other_attributes_are_refused(void **state) {
  output_case *c = *state;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  --c->ink->attributes;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("has \"ink.age\", which this scene does not know");
  ++c->ink->attributes;
  assert_int_equal(cf_particles_attribute(c->ink, "S", "", 1, CF_CARRIED, NULL), CF_OK);
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_BAD_FILE);
  assert_says("has no array /state/ink/S");
  c->ink->attribute[2].role = CF_DERIVED;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_OK);
}

static void no_particles_is_a_state_too(void **state) {
  output_case *c = *state;
  c->ink->count = 0;
  write_good(c, 12, 2);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  c->ink->count = 3;
  assert_int_equal(cf_checkpoint_read(path.text, &c->registry), CF_OK);
  assert_int_equal(c->ink->count, 0);
}

static void the_last_few_are_kept(void **state) {
  output_case *c = *state;
  write_good(c, 900, 2); /* of a course that was given up */
  for (int64_t step = 100; step <= 400; step += 100) write_good(c, step, 2);
  assert_int_equal(files_in(c->folder.text), 3);
  assert_int_equal(access(case_path(c, "checkpoint_000300.h5").text, F_OK), 0);
  assert_int_equal(access(case_path(c, "checkpoint_000400.h5").text, F_OK), 0);
  assert_int_equal(cf_checkpoint_cut(c->folder.text, 400), CF_OK);
  assert_int_equal(files_in(c->folder.text), 2);
}

static void newest_good_one_is_found(void **state) {
  output_case *c = *state;
  cf_checkpoint_found found;
  assert_int_equal(cf_checkpoint_newest(c->folder.text, &found), CF_OK);
  assert_false(found.found);
  for (int64_t step = 100; step <= 400; step += 100) write_good(c, step, 4);
  assert_int_equal(truncate(case_path(c, "checkpoint_000400.h5").text, 3000), 0);
  assert_int_equal(truncate(case_path(c, "checkpoint_000300.h5").text, 0), 0);
  assert_int_equal(cf_checkpoint_newest(c->folder.text, &found), CF_OK);
  assert_true(found.found && found.step == 200);
  assert_non_null(strstr(found.passed_over, "checkpoint_000400.h5: is cut short"));
  assert_non_null(strstr(found.passed_over, "checkpoint_000300.h5: is empty"));
}

/* Whatever the byte at which there is no more room. */
static void a_full_disk_leaves_the_earlier_checkpoint(void **state) {
  output_case *c = *state;
  struct rlimit old;
  char *bytes;
  size_t size;
  write_good(c, 100, 1);
  const cf_path earlier = case_path(c, "checkpoint_000100.h5");
  assert_int_equal(cf_file_read(earlier.text, 1 << 24, &bytes, &size), CF_OK);
  cf_free(bytes);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  for (rlim_t most = 0; most < size; most += 61) {
    const struct rlimit limit = {most, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    c->stamp.step = 200;
    const cf_status s = cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 1);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(s, CF_CANNOT_WRITE);
    assert_says("checkpoint_000200.h5: cannot ");
    assert_says("File too large");
    assert_int_equal(files_in(c->folder.text), 1);
    assert_int_equal(cf_checkpoint_check(earlier.text), CF_OK);
  }
  write_good(c, 300, 1);
  assert_int_equal(files_in(c->folder.text), 1);
}

static void same_state_same_bytes(void **state) {
  output_case *c = *state;
  char *a, *b;
  size_t n, m;
  write_good(c, 12, 1);
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  assert_int_equal(cf_file_read(path.text, 1 << 24, &a, &n), CF_OK);
  sleep(1);
  write_good(c, 12, 1);
  assert_int_equal(cf_file_read(path.text, 1 << 24, &b, &m), CF_OK);
  assert_int_equal(n, m);
  assert_memory_equal(a, b, n);
  cf_free(a);
  cf_free(b);
}

static void failing_memory_loses_nothing(void **state) {
  output_case *c = *state;
  const cf_path path = case_path(c, "checkpoint_000012.h5");
  cf_status s = CF_NO_MEMORY;
  for (long n = 1; s != CF_OK; ++n) {
    cf_mem_fail_at(n);
    s = cf_checkpoint_write(c->folder.text, &c->registry, &c->stamp, 2);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
    /* Making the list of old ones may fail after the file is in place. */
    if (s != CF_OK) assert_true(files_in(c->folder.text) == 0 || cf_checkpoint_check(path.text) == CF_OK);
  }
  s = CF_NO_MEMORY;
  for (long n = 1; s != CF_OK; ++n) {
    cf_mem_fail_at(n);
    s = cf_checkpoint_read(path.text, &c->registry);
    cf_mem_fail_at(0);
    assert_true(s == CF_OK || s == CF_NO_MEMORY);
  }
}

static void strange_files_are_refused(void **state) {
  output_case *c = *state;
  const cf_path path = case_path(c, "bad.h5");
  static const char *const texts[] = {"",
                                      "x",
                                      "cattaneo checkpoint",
                                      "cattaneo checkpoint 2 512\n",
                                      "cattaneo checkpoint 1 513\n",
                                      "cattaneo checkpoint 1 512\n",
                                      "cattaneo checkpoint 999999999999999999 512\n"};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
    assert_int_equal(cf_file_write(path.text, texts[i], strlen(texts[i])), CF_OK);
    assert_int_equal(cf_checkpoint_check(path.text), CF_BAD_FILE);
  }
  assert_int_equal(cf_checkpoint_check(c->folder.text), CF_BAD_FILE);
  assert_int_equal(cf_checkpoint_check("/no/such/file"), CF_BAD_FILE);
  assert_says("/no/such/file: cannot be opened: No such file or directory");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(checkpoint_restores_every_bit, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(checkpoint_describes_itself, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(every_flipped_bit_is_found_and_the_state_stays, output_case_3d,
                                      output_case_end),
      cmocka_unit_test_setup_teardown(damage_names_the_array, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(other_shapes_and_names_are_refused, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(particles_get_room, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(other_attributes_are_refused, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(no_particles_is_a_state_too, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(the_last_few_are_kept, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(newest_good_one_is_found, output_case_2d, output_case_end),
      cmocka_unit_test_setup_teardown(a_full_disk_leaves_the_earlier_checkpoint, output_case_2d,
                                      output_case_end),
      cmocka_unit_test_setup_teardown(same_state_same_bytes, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(failing_memory_loses_nothing, output_case_3d, output_case_end),
      cmocka_unit_test_setup_teardown(strange_files_are_refused, output_case_3d, output_case_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
