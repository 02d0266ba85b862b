/* SPDX-License-Identifier: MIT
 *
 * Advection does not know left from right, x from y, nor how many threads work: to the last bit. The axes are
 * swept one after the other, so a transposed field gives the transposed result only with the order reversed.
 */
/* also in single precision */
#include "../unit/physics/advect_flows.h"

#define EPS ((double)CF_REAL_EPSILON)

static void fill_noise(const cf_box *b, cf_real *f, const int64_t stream) {
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i)
        f[cf_box_at(b, i, j, k)] = (cf_real)noise((k * 1009 + j) * 1009 + i, stream);
}

/* Index maps a cell (or face) index of `from` to that of `to`; sign[a]: of velocity component a. */
typedef struct image {
  int axis[3];    /* axis a of the original becomes axis[a] */
  int flipped[3]; /* axis a is reversed (before it is renamed) */
} image;

static ptrdiff_t image_of(const image *m, const scene *from, const scene *to, const int component,
                          const int i[3]) {
  int out[3];
  for (int a = 0; a < 3; ++a) {
    const int last = from->grid.box.n[a] - (a == component ? 0 : 1);
    out[m->axis[a]] = m->flipped[a] ? last - i[a] : i[a];
  }
  return cf_box_at(&to->grid.box, out[0], out[1], out[2]);
}

static void copy_image(const image *m, const scene *from, scene *to) {
  const cf_box *b = &from->grid.box;
  for (int c = -1; c < b->dim; ++c)
    for (int k = 0; k < cf_box_extent(b, 2, c); ++k)
      for (int j = 0; j < cf_box_extent(b, 1, c); ++j)
        for (int i = 0; i < cf_box_extent(b, 0, c); ++i) {
          const int at[3] = {i, j, k};
          const ptrdiff_t p = cf_box_at(b, i, j, k), q = image_of(m, from, to, c, at);
          if (c < 0)
            to->phi.at[q] = from->phi.at[p];
          else
            to->u.at[m->axis[c]][q] = m->flipped[c] ? -from->u.at[c][p] : from->u.at[c][p];
        }
}

static double worst_difference(const image *m, const scene *from, const scene *to) {
  const cf_box *b = &from->grid.box;
  double worst = 0;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const int at[3] = {i, j, k};
        const double one = (double)from->phi.at[cf_box_at(b, i, j, k)],
                     other = (double)to->phi.at[image_of(m, from, to, CF_CENTRES, at)];
        worst = fmax(worst, fabs(one - other));
      }
  return worst;
}

static void prepare(scene *s, const cf_wall kind) {
  set_random_flow(s, 11, kind == CF_WALL_INSULATED);
  fill_noise(&s->grid.box, s->phi.at, 4);
}

static void run_steps(scene *s, const double dt, const int64_t parity) {
  OK(cf_advect_set_velocity(s->advect, s->u, &s->walls));
  *cf_advect_parity(s->advect) = parity;
  for (int step = 0; step < 4; ++step) move_cells(s, 0, dt, NULL);
}

static void image_moves_alike(const int dim, const cf_wall kind, const image *m, const int64_t parity) {
  const int cells[3] = {20, 14, dim == 3 ? 10 : 1};
  int turned[3] = {1, 1, 1};
  for (int a = 0; a < dim; ++a) turned[m->axis[a]] = cells[a];
  scene one, other;
  scene_open(&one, dim, cells, walls_all(kind));
  scene_open(&other, dim, turned, walls_all(kind));
  other.grid.h = one.grid.h;
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      one.walls.value[a][side] = cf_fn_constant(a + 2 * side);
      other.walls.value[m->axis[a]][m->flipped[a] ? 1 - side : side] = cf_fn_constant(a + 2 * side);
    }
  prepare(&one, kind);
  copy_image(m, &one, &other);
  OK(cf_advect_set_velocity(one.advect, one.u, &one.walls));
  const double dt = step_of(&one, 0.9);
  run_steps(&one, dt, 0);
  run_steps(&other, dt, parity);
  assert_true(worst_difference(m, &one, &other) == 0);
  scene_close(&one);
  scene_close(&other);
}

static void advect_mirrors_to_the_bit(void **state) {
  (void)state;
  const cf_wall kinds[3] = {CF_WALL_PERIODIC, CF_WALL_INSULATED, CF_WALL_VALUE};
  for (int w = 0; w < 3; ++w)
    for (int flips = 1; flips < 8; ++flips) {
      const image m = {{0, 1, 2}, {flips & 1, flips >> 1 & 1, flips >> 2 & 1}};
      if (flips < 4) image_moves_alike(2, kinds[w], &m, 0);
      image_moves_alike(3, kinds[w], &m, 0);
    }
}

static void advect_transposes_to_the_bit_with_the_axes_reversed(void **state) {
  (void)state;
  const image flat = {{1, 0, 2}, {0, 0, 0}}, solid = {{2, 1, 0}, {0, 0, 0}};
  image_moves_alike(2, CF_WALL_PERIODIC, &flat, 1);
  image_moves_alike(2, CF_WALL_INSULATED, &flat, 1);
  image_moves_alike(2, CF_WALL_VALUE, &flat, 1);
  image_moves_alike(3, CF_WALL_PERIODIC, &solid, 1);
  image_moves_alike(3, CF_WALL_VALUE, &solid, 1);
}

/* All that the flow carries, with a number of threads; the result in phi, q and through. */
typedef struct outcome {
  scene s;
  cf_face q;
  cf_through through;
  double rate;
} outcome;

static void run_threads(outcome *o, const int dim, const cf_wall kind, const int threads,
                        const cf_advect_scheme scheme) {
  const int cells[3] = {dim == 2 ? 700 : 34, dim == 2 ? 90 : 31, 29};
  OK(cf_grid_init(&o->s.grid, dim, cells, 1.0 / cells[0], NULL));
  o->s.grid.threads = threads;
  o->s.walls = walls_all(kind);
  OK(cf_advect_create(&o->s.advect, &o->s.grid, scheme));
  OK(cf_face_create(&o->s.u, &o->s.grid.box));
  OK(cf_cell_create(&o->s.phi, &o->s.grid.box));
  OK(cf_face_create(&o->q, &o->s.grid.box));
  o->through = (cf_through){0, 0};
  prepare(&o->s, kind);
  for (int a = 0; a < dim; ++a) fill_noise(&o->s.grid.box, o->q.at[a], a);
  OK(cf_advect_set_velocity(o->s.advect, o->s.u, &o->s.walls));
  o->rate = cf_advect_rate(o->s.advect);
  for (int step = 0; step < 3; ++step) {
    move_cells(&o->s, 0, step_of(&o->s, 0.9), &o->through);
    OK(cf_advect_face(o->s.advect, &o->s.walls, CF_RATE_OBJECTIVE, o->q));
  }
}

static void outcome_close(outcome *o) {
  cf_face_destroy(&o->q, &o->s.grid.box);
  scene_close(&o->s);
}

static void threads_agree(const int dim, const cf_wall kind, const cf_advect_scheme scheme) {
  outcome one, many;
  run_threads(&one, dim, kind, 1, scheme);
  for (int threads = 2; threads <= 3; ++threads) {
    run_threads(&many, dim, kind, threads, scheme);
    const cf_box *b = &one.s.grid.box;
    assert_memory_equal(&one.rate, &many.rate, sizeof one.rate);
    assert_memory_equal(&one.through, &many.through, sizeof one.through);
    const size_t row = (size_t)b->n[0] * sizeof(cf_real);
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) {
      const ptrdiff_t p = cf_box_row(b, r);
      assert_memory_equal(one.s.phi.at + p, many.s.phi.at + p, row);
      for (int a = 0; a < dim; ++a) assert_memory_equal(one.q.at[a] + p, many.q.at[a] + p, row);
    }
    outcome_close(&many);
  }
  outcome_close(&one);
}

static void advect_gives_the_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    threads_agree(dim, CF_WALL_PERIODIC, CF_ADVECT_PPM);
    threads_agree(dim, CF_WALL_INSULATED, CF_ADVECT_PPM);
    threads_agree(dim, CF_WALL_OPEN, CF_ADVECT_PPM);
    threads_agree(dim, CF_WALL_OPEN, CF_ADVECT_LINEAR);
  }
}

/* A 3D box one cell thick along `thin` against the 2D box of its other two axes. */
static void thin_box_is_flat(const int thin, const cf_wall thin_kind, const cf_wall kind) {
  const int first = thin == 0 ? 1 : 0, second = thin == 2 ? 1 : 2;
  const int flat_cells[2] = {18, 15};
  int cells[3] = {1, 1, 1};
  cells[first] = flat_cells[0], cells[second] = flat_cells[1];
  scene flat, solid;
  scene_open(&flat, 2, flat_cells, walls_all(kind));
  scene_open(&solid, 3, cells, walls_all(kind));
  solid.grid.h = flat.grid.h;
  solid.walls.kind[thin][0] = solid.walls.kind[thin][1] = thin_kind;
  prepare(&flat, kind);
  const int axis[2] = {first, second};
  for (int c = -1; c < 2; ++c)
    for (int j = 0; j < cf_box_extent(&flat.grid.box, 1, c); ++j)
      for (int i = 0; i < cf_box_extent(&flat.grid.box, 0, c); ++i) {
        int at[3] = {0, 0, 0};
        at[first] = i, at[second] = j;
        const ptrdiff_t p = cf_box_at(&flat.grid.box, i, j, 0),
                        q = cf_box_at(&solid.grid.box, at[0], at[1], at[2]);
        if (c < 0)
          solid.phi.at[q] = flat.phi.at[p];
        else
          solid.u.at[axis[c]][q] = flat.u.at[c][p];
      }
  OK(cf_advect_set_velocity(flat.advect, flat.u, &flat.walls));
  OK(cf_advect_set_velocity(solid.advect, solid.u, &solid.walls));
  const double dt = step_of(&flat, 0.9);
  assert_true(cf_advect_rate(flat.advect) == cf_advect_rate(solid.advect));
  for (int step = 0; step < 6; ++step) move_cells(&flat, 0, dt, NULL), move_cells(&solid, 0, dt, NULL);
  for (int j = 0; j < flat_cells[1]; ++j)
    for (int i = 0; i < flat_cells[0]; ++i) {
      int at[3] = {0, 0, 0};
      at[first] = i, at[second] = j;
      const double one = (double)flat.phi.at[cf_box_at(&flat.grid.box, i, j, 0)],
                   other = (double)solid.phi.at[cf_box_at(&solid.grid.box, at[0], at[1], at[2])];
      assert_true(fabs(one - other) < 30 * EPS);
    }
  scene_close(&flat);
  scene_close(&solid);
}

static void advect_in_a_box_one_cell_thick_is_flat(void **state) {
  (void)state;
  for (int thin = 0; thin < 3; ++thin) {
    thin_box_is_flat(thin, CF_WALL_PERIODIC, CF_WALL_INSULATED);
    thin_box_is_flat(thin, CF_WALL_INSULATED, CF_WALL_PERIODIC);
    thin_box_is_flat(thin, CF_WALL_OPEN, CF_WALL_OPEN);
  }
}

static void advect_in_a_single_cell_moves_nothing(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    const int cells[3] = {1, 1, 1};
    outcome o = {0};
    scene_open(&o.s, dim, cells, walls_all(CF_WALL_PERIODIC));
    OK(cf_face_create(&o.q, &o.s.grid.box));
    for (int a = 0; a < dim; ++a) o.s.u.at[a][0] = 2, o.q.at[a][0] = 3;
    o.s.phi.at[0] = 5;
    OK(cf_advect_set_velocity(o.s.advect, o.s.u, &o.s.walls));
    move_cells(&o.s, 0, 0.3, NULL);
    OK(cf_advect_face(o.s.advect, &o.s.walls, CF_RATE_OBJECTIVE, o.q));
    assert_true(o.s.phi.at[0] == 5);
    for (int a = 0; a < dim; ++a) assert_true(o.q.at[a][0] == 3);
    outcome_close(&o);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(advect_mirrors_to_the_bit),
      cmocka_unit_test(advect_transposes_to_the_bit_with_the_axes_reversed),
      cmocka_unit_test(advect_gives_the_same_bits_for_any_number_of_threads),
      cmocka_unit_test(advect_in_a_box_one_cell_thick_is_flat),
      cmocka_unit_test(advect_in_a_single_cell_moves_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
