/* SPDX-License-Identifier: MIT
 *
 * The lists that a region's fast path goes by: every cell inside lies in one segment, whose table says of it what its neighbours
 * are; and what levels of couplings visit of their rows.
 */
#include "solve/segments.h"

#include <string.h>

#include "solve/box_part.h"
#include "solve/multigrid.h"
#include "testing.h"

static uint64_t seed = 11;

static int pick(const int count) { return (int)(test_random(&seed) * count); }

/* A box and a region in it. */
typedef struct scene {
  cf_grid g;
  cf_walls walls;
  cf_region *region;
  cf_helmholtz *A;
  cf_cell x, b;
} scene;

static void begin(const int dim, const int n[3], scene *s) {
  *s = (scene){0};
  OK(cf_grid_init(&s->g, dim, n, 1, NULL));
  for (int a = 0; a < dim; ++a) {
    const cf_wall kinds[] = {CF_WALL_INSULATED, CF_WALL_VALUE};
    const bool periodic = pick(4) == 0 && n[a] % 2 == 0;
    for (int side = 0; side < 2; ++side)
      s->walls.kind[a][side] = periodic ? CF_WALL_PERIODIC : kinds[pick(2)];
  }
  OK(cf_region_create(&s->region, &s->g));
  OK(cf_helmholtz_create(&s->A, &s->g, &s->walls, 0));
  cf_helmholtz_forbid_windows(s->A);
  OK(cf_cell_create(&s->x, &s->g.box));
  OK(cf_cell_create(&s->b, &s->g.box));
}

static void end(scene *s) {
  cf_helmholtz_destroy(s->A);
  cf_region_destroy(s->region);
  cf_cell_destroy(&s->x, &s->g.box);
  cf_cell_destroy(&s->b, &s->g.box);
}

static void set(scene *s) {
  OK(cf_region_update(s->region));
  OK(cf_helmholtz_set(s->A, &(cf_coefficients){.alpha = 1, .beta = 50, .region = s->region}));
  assert_true(s->A->around_is_set && s->A->in_box);
}

static void check_cell(const scene *s, const cf_segment_table *t, const int from, const int at[3]) {
  const cf_box *box = &s->g.box;
  const cf_split *split = &s->A->around->level[0];
  const ptrdiff_t p = cf_box_at(box, at[0], at[1], at[2]);
  int faces = CF_FACES_INSIDE | CF_FACES_TRANSFER, open = 0, held = 0;
  for (int v = 0; v < 2 * box->dim; ++v) {
    const int a = v / 2, n = box->n[a], next = at[a] + (v % 2 ? 1 : -1), wall = (int)s->walls.kind[a][v % 2];
    const bool is_end = (next < 0 || next >= n) && wall != CF_WALL_PERIODIC;
    const int kind = is_end ? -1 : s->region->kind[p + ((next + n) % n - at[a]) * box->stride[a]];
    faces |= kind == CF_CELL_INSIDE ? 1 << v : 0;
    open += kind == CF_CELL_INSIDE;
    held += is_end ? 2 * (wall == CF_WALL_VALUE) : kind == CF_CELL_HELD ? 2 : 0;
  }
  const int lane = cf_lane_of(at[0]);
  assert_in_range(at[0] - from, t->low, t->high - 1);
  assert_int_equal(t->faces[lane] | CF_FACES_TRANSFER, faces);
  assert_int_equal(t->held[lane], held + CF_HELD_COUNT * (open + held));
  assert_float_equal(t->inverse[lane] * (split->alpha + (float)(open + held) * split->coupling), 1, 1e-6);
}

/* Row (j, k): pieces and their segments, and how often each cell is met. */
static void check_row(const scene *s, const int j, const int k) {
  const cf_split *split = &s->A->around->level[0];
  const cf_segments *g = &s->A->around->segments;
  const int n = s->g.box.n[0];
  const ptrdiff_t row = cf_segments_row(split, j, k) * g->pieces, p = cf_box_at(&s->g.box, 0, j, k);
  int met[2048] = {0};
  for (int piece = 0; piece < g->pieces; ++piece)
    for (ptrdiff_t v = g->all.first[row + piece]; v < g->all.first[row + piece + 1]; ++v) {
      const cf_segment *q = &g->all.at[v];
      const int from = cf_segment_cell(split, q, j, k);
      assert_int_equal(q->place & CF_PLACE_PARITY, (j + k) & 1);
      assert_int_equal(CF_MIN(from / 2 / CF_WAVE_COLUMN, g->pieces - 1), piece);
      for (int i = from; i < from + CF_SEGMENT_CELLS; ++i) {
        const bool inside = i < n && s->region->kind[p + i] == CF_CELL_INSIDE;
        if (inside)
          check_cell(s, &g->table[q->table], from, (int[]){i, j, k});
        else
          assert_true(g->table[q->table].inverse[cf_lane_of(i)] == 0 &&
                      g->table[q->table].faces[cf_lane_of(i)] == 0);
        met[i] += inside;
      }
    }
  for (int i = 0; i < n; ++i) assert_int_equal(met[i], s->region->kind[p + i] == CF_CELL_INSIDE);
}

/* Of the segments of the rows of a coarse row at the same place the first says so, and no other. */
static void check_first(const scene *s, const int j, const int k) {
  const cf_split *split = &s->A->around->level[0];
  const cf_segments *g = &s->A->around->segments;
  bool seen[2048 / CF_SEGMENT_CELLS] = {false};
  for (int kk = k; kk < CF_MIN(k + 2, s->g.box.n[2]); ++kk)
    for (int jj = j; jj < CF_MIN(j + 2, s->g.box.n[1]); ++jj)
      CF_FOR_ROW_SEGMENTS (g, &g->all, split, jj, kk, q) {
        bool *here = &seen[cf_segment_cell(split, q, jj, kk) / CF_SEGMENT_CELLS];
        assert_int_equal((q->place & CF_PLACE_FIRST) != 0, !*here);
        *here = true;
      }
}

/* Every segment with a table of its own, and those beside one, in order. */
static void check_edges(const cf_segments *g) {
  ptrdiff_t edge = 0;
  for (ptrdiff_t v = 0; v < g->all.count; ++v) {
    const bool is_next = edge < g->edges.count && g->all.at[v].place == g->edges.at[edge].place;
    assert_true(is_next || g->all.at[v].table < CF_REGULAR_TABLES);
    edge += is_next;
  }
  assert_int_equal(edge, g->edges.count);
}

static void segments_say_what_is_around_every_cell(void **state) {
  (void)state;
  const int shapes[][4] = {
      {3, 150, 24, 21}, {3, 33, 18, 23}, {3, 64, 33, 16}, {2, 1100, 18, 1}, {2, 97, 70, 1}};
  for (int v = 0; v < 15; ++v) {
    scene s;
    const int *n = shapes[v % 5];
    begin(n[0], (int[]){n[1], n[2], n[3]}, &s);
    const cf_box *box = &s.g.box;
    for (int hole = 0; hole < 4; ++hole) {
      const int at[3] = {pick(n[1]), pick(n[2]), pick(n[3])}, wide = hole == 0 ? n[1] / 2 : 3;
      for (int i = at[0]; i < CF_MIN(at[0] + wide, n[1]); ++i)
        s.region->kind[cf_box_at(box, i, at[1], at[2])] = hole % 2 ? CF_CELL_HELD : CF_CELL_WALL;
    }
    set(&s);
    const cf_segments *g = &s.A->around->segments;
    for (int k = 0; k < n[3]; ++k)
      for (int j = 0; j < n[2]; ++j) check_row(&s, j, k);
    for (int k = 0; k < n[3]; k += 2)
      for (int j = 0; j < n[2]; j += 2) check_first(&s, j, k);
    check_edges(g);
    assert_int_equal(g->pieces, n[1] > 1024 ? 2 : 1);
    end(&s);
  }
}

/* A ball of cells inside. */
static void put_ball(const scene *s, const double middle, const double radius) {
  const cf_box *box = &s->g.box;
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i) {
        const double x = i - middle, y = j - 20, z = k - 20;
        s->region->kind[cf_box_at(box, i, j, k)] =
            x * x + y * y + z * z < radius * radius ? CF_CELL_INSIDE : CF_CELL_WALL;
      }
}

/* What spans leave out has no equation, and nothing of an earlier region. */
static void check_spans(const scene *s) {
  ptrdiff_t left_out = 0;
  for (int at = 1; at < s->A->varied->depth; ++at) {
    const cf_coupled *l = &s->A->varied->level[at];
    for (int k = 0; k < l->box.n[2]; ++k)
      for (int j = 0; j < l->box.n[1]; ++j) {
        const cf_run *run, *runs_end;
        cf_coupled_runs(l, j, k, &run, &runs_end);
        for (int i = 0; i < l->box.n[0]; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          if (run < runs_end && i >= run->low && i < run->high) continue;
          assert_false(cf_coupled_has(l, p));
          assert_true(l->e[p] == 0 && l->rest[p] == 0);
          ++left_out;
        }
      }
  }
  assert_true(left_out > 1000);
}

static void levels_visit_what_has_equations(void **state) {
  (void)state;
  scene s;
  begin(3, (int[]){120, 40, 40}, &s);
  const double middle[] = {30, 34, 70, 60}, radius[] = {18, 12, 12, 30};
  for (int v = 0; v < 4; ++v) {
    cf_solve_report report;
    put_ball(&s, middle[v], radius[v]);
    set(&s);
    for (ptrdiff_t p = 0; p < s.g.box.size - s.g.box.first; ++p) s.b.at[p] = (cf_real)(p % 7) - 3;
    OK(cf_helmholtz_solve(s.A, s.b, &(cf_solve_options){1e-5, 20}, s.x, &report));
    assert_true(report.converged);
    check_spans(&s);
  }
  end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(segments_say_what_is_around_every_cell),
      cmocka_unit_test(levels_visit_what_has_equations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
