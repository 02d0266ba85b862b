/* SPDX-License-Identifier: MIT
 *
 * examples/coral, with its own numbers: it grows up against the current, gives off the heat of what freezes, and its
 * surface is closed and moves on from step to step without flicker.
 */
#include "example.h"
#include "grid/mesh.h"
#include "model/sim.h"

static cf_mesh_facts look(const example *e) {
  cf_mesh *mesh;
  cf_mesh_facts facts;
  OK(cf_mesh_create(&mesh));
  OK(e->sim->model->mesh(e->sim->state, mesh));
  OK(cf_mesh_check_closed(mesh));
  OK(cf_mesh_look(mesh, &facts));
  cf_mesh_destroy(mesh);
  return facts;
}

static void reef_grows_upwards_and_keeps_its_heat(void **state) {
  (void)state;
  example e = example_open("coral/scene.yaml", NULL);
  double height = look(&e).high[1], volume = look(&e).volume;
  for (int i = 1; i <= 3; ++i) {
    example_run(&e, 0.002 * i);

    const cf_mesh_facts f = look(&e);
    print_message("t = %.3f s: %.3f m high, %.4f m^3, heat %.1e\n", 0.002 * i, f.high[1], f.volume,
                  example_metric(&e, "error_heat"));
    assert_true(f.high[1] > height);
    assert_true(f.volume > volume);
    BELOW(fabs(example_metric(&e, "error_heat")), 1e-11);
    height = f.high[1];
    volume = f.volume;
  }
  /* From step to step: a surface made by another rule, or with holes that come and go, would jump. */
  double area = look(&e).area;
  for (int s = 0; s < 3; ++s) {
    OK(cf_sim_step(e.sim, NULL));
    const cf_mesh_facts f = look(&e);
    assert_true(f.volume > volume);
    BELOW(f.volume / volume, 1.03);
    BELOW(fabs(f.area / area - 1), 0.03);
    volume = f.volume;
    area = f.area;
  }
  example_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(reef_grows_upwards_and_keeps_its_heat)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
