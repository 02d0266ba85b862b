/* SPDX-License-Identifier: MIT
 *
 * Tables and particles read back for pictures.
 */
#include "testing.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "grid/particles.h"
#include "grid/registry.h"
#include "io/column.h"
#include "io/frame.h"
#include "io/points.h"

static void columns_are_read_by_name(void **state) {
  static const char text[] =
      "step,time,sum_phi\n0,0,1.5\n1,0.25,nan\n2,0.5,2.5\n3,0.7"; /* the last is not whole */
  const char *path = "column.csv";
  double *values;
  int64_t count;
  (void)state;
  OK(cf_file_write(path, text, strlen(text)));
  OK(cf_column_read(path, "sum_phi", &count, &values));
  assert_int_equal(count, 3);
  CLOSE(values[0], 1.5, 0);
  assert_true(isnan(values[1]));
  CLOSE(values[2], 2.5, 0);
  cf_free(values);
  OK(cf_column_read(path, "time", &count, &values));
  CLOSE(values[1], 0.25, 0);
  cf_free(values);
  assert_int_equal(cf_column_read(path, "sum", &count, &values), CF_BAD_FILE);
  assert_non_null(strstr(cf_status_sentence(), "it has: step,time,sum_phi"));
  assert_null(values);
  unlink(path);
  assert_int_equal(cf_column_read(path, "sum", &count, &values), CF_BAD_FILE);
}

static void particles_are_read_as_they_were_written(void **state) {
  const int n[3] = {4, 4, 4};
  cf_grid g;
  cf_registry r;
  cf_particles *set;
  cf_points p;
  float *v, *size;
  int64_t first;
  int number;
  (void)state;
  OK(cf_grid_init(&g, 3, n, 0.25, NULL));
  OK(cf_registry_init(&r, &g));
  OK(cf_particles_create(&set, "dust", 3, 8));
  OK(cf_particles_attribute(set, "velocity", "m/s", 3, CF_CARRIED, &number));
  OK(cf_particles_append(set, 5, &first));
  for (int i = 0; i < 5; ++i)
    for (int a = 0; a < 3; ++a) {
      set->attribute[CF_PARTICLE_POSITION].at[a][i] = (cf_real)(i + 0.25 * a);
      set->attribute[number].at[a][i] = (cf_real)(a == 0 ? 3 : a == 1 ? 4 * i : 0);
    }
  OK(cf_registry_add_particles(&r, set));
  const cf_frame_plan plan = {.compression = 0};
  const cf_stamp stamp = {.title = "dust", .time = 0.5};
  OK(cf_frame_write(".", 7, &r, &plan, &stamp));
  OK(cf_points_read(&p, "./particles_000007.vtkhdf"));
  assert_int_equal(p.count, 5);
  CLOSE(p.time, 0.5, 0);
  CLOSE(p.place[3][2], 3.5, 0);
  OK(cf_points_attribute(&p, "velocity", 3, &v));
  CLOSE(v[3 * 2 + 1], 8, 0);
  OK(cf_points_attribute(&p, "velocity", 1, &size));
  CLOSE(size[1], 5, 1e-6);
  cf_free(size);
  assert_int_equal(cf_points_attribute(&p, "colour", 1, &size), CF_BAD_FILE);
  assert_non_null(strstr(cf_status_sentence(), "velocity"));
  cf_free(v);
  cf_points_clear(&p);
  assert_int_equal(cf_points_read(&p, "./particles_000008.vtkhdf"), CF_BAD_FILE);
  assert_null(p.place);
  OK(cf_frame_cut(".", -1));
  cf_registry_clear(&r);
  cf_particles_destroy(set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(columns_are_read_by_name),
      cmocka_unit_test(particles_are_read_as_they_were_written),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
