/* SPDX-License-Identifier: MIT */
#include "solve/window.h"

#include <stdint.h>
#include <string.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "grid/sweep.h"
#include "solve/held.h"

/* Of the box's cells a window has at most this share, and of its own cells at least that share is inside. */
#define MOST_OF_BOX     0.5
#define LEAST_OF_WINDOW 0.2
/* Rows ahead of the one being copied. */
#define AHEAD 2

struct cf_window {
  cf_grid grid; /* of the window */
  cf_walls walls;
  int low[3]; /* its first cell, in the large box */
  cf_helmholtz *A;
  cf_region *region;
  cf_cell x, b, alpha;
  cf_face beta;
  cf_run *run;      /* of cells inside, row by row, in cells of the window; */
  ptrdiff_t *first; /* where those of each row begin, and one more */
  ptrdiff_t room;

  /* What has been set. */
  cf_grid outer;
  cf_coefficients law;
  cf_held held;   /* the region, and the law's beta */
  uint64_t stamp; /* of the region; 0: nothing */
};

/* --- where -------------------------------------------------------------------------------------------- */

/* Cells low <= (i, j, k) < high of the box, and what holds at the ends. */
typedef struct frame {
  int low[3], high[3];
  cf_walls walls;
} frame;

static frame frame_of(const cf_grid *g, const cf_walls *walls, const cf_region *r) {
  frame f = {.high = {1, 1, 1}};
  for (int a = 0; a < g->box.dim; ++a) {
    const int n = g->box.n[a];
    const bool periodic = walls->kind[a][0] == CF_WALL_PERIODIC;
    const int low = (r->low[a] - 1) / CF_WINDOW_STEP * CF_WINDOW_STEP;
    const int high = (r->high[a] + CF_WINDOW_STEP) / CF_WINDOW_STEP * CF_WINDOW_STEP;
    const bool whole = periodic && (r->low[a] == 0 || r->high[a] == n);
    f.low[a] = whole ? 0 : CF_MAX(low, 0);
    f.high[a] = whole ? n : CF_MIN(high, n);
    for (int side = 0; side < 2; ++side) {
      const bool at_end = f.low[a] == 0 && side == 0 ? true : f.high[a] == n && side == 1;
      const bool own = periodic ? whole : at_end;
      f.walls.kind[a][side] = own ? walls->kind[a][side] : CF_WALL_INSULATED;
    }
  }
  return f;
}

static double cells_of(const frame *f) {
  double cells = 1;
  for (int a = 0; a < 3; ++a) cells *= f->high[a] - f->low[a];
  return cells;
}

static bool is_of(const cf_grid *g, const cf_region *r) {
  for (int a = 0; a < 3; ++a)
    if (r->grid.box.n[a] != g->box.n[a] || r->grid.box.stride[a] != g->box.stride[a]) return false;
  return true;
}

bool cf_window_pays(const cf_grid *g, const cf_walls *walls, const cf_coefficients *c) {
  if (c->region == NULL || c->region->inside == 0 || !is_of(g, c->region)) return false;
  const frame f = frame_of(g, walls, c->region);
  const double cells = cells_of(&f);
  return cells <= MOST_OF_BOX * (double)cf_box_cells(&g->box) &&
         (double)c->region->inside >= LEAST_OF_WINDOW * cells;
}

/* --- making ------------------------------------------------------------------------------------------- */

void cf_window_destroy(cf_window *w) {
  if (w == NULL) return;
  cf_helmholtz_destroy(w->A);
  cf_region_destroy(w->region);
  cf_cell_destroy(&w->x, &w->grid.box);
  cf_cell_destroy(&w->b, &w->grid.box);
  cf_cell_destroy(&w->alpha, &w->grid.box);
  cf_face_destroy(&w->beta, &w->grid.box);
  cf_free(w->run);
  cf_free(w->first);
  cf_free(w);
}

static cf_status make(cf_window *w, const cf_grid *g, const frame *f, const int levels) {
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = f->high[a] - f->low[a];
  CF_TRY(cf_box_init(&w->grid.box, g->box.dim, n, 1));
  w->grid.h = g->h;
  w->grid.threads = g->threads;
  w->walls = f->walls;
  CF_TRY(cf_helmholtz_create(&w->A, &w->grid, &w->walls, levels));
  cf_helmholtz_forbid_windows(w->A);
  CF_TRY(cf_region_create(&w->region, &w->grid));
  CF_TRY(cf_cell_create(&w->x, &w->grid.box));
  CF_TRY(cf_cell_create(&w->b, &w->grid.box));
  return CF_NEW(&w->first, cf_box_rows(&w->grid.box) + 1);
}

static cf_status create(cf_window **w, const cf_grid *g, const frame *f, const int levels) {
  *w = NULL;
  cf_window *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  const cf_status s = make(fresh, g, f, levels);
  if (s != CF_OK) {
    cf_window_destroy(fresh);
    return s;
  }
  *w = fresh;
  return CF_OK;
}

/* Whether the window has this shape already: then it may lie elsewhere and stay what it is. */
static bool fits(const cf_window *w, const frame *f) {
  for (int a = 0; a < 3; ++a) {
    if (w->grid.box.n[a] != f->high[a] - f->low[a]) return false;
    for (int side = 0; side < 2; ++side)
      if (w->walls.kind[a][side] != f->walls.kind[a][side]) return false;
  }
  return true;
}

/* --- runs of cells inside ------------------------------------------------------------------------------- */

#define FOR_ROW_RUNS(w, r, q) \
  for (const cf_run *q = (w)->run + (w)->first[r]; q < (w)->run + (w)->first[(r) + 1]; ++(q))

/* Where row r of the window begins in the large box. */
static ptrdiff_t outer_row(const cf_window *w, const ptrdiff_t r) {
  const int n = w->grid.box.n[1];
  return cf_box_at(&w->outer.box, w->low[0], w->low[1] + (int)(r % n), w->low[2] + (int)(r / n));
}

CF_CLONES static int count_runs(const int n, const unsigned char *kind) {
  int count = kind[0] == CF_CELL_INSIDE;
  CF_ROW_LOOP
  for (int i = 1; i < n; ++i) count += (kind[i] == CF_CELL_INSIDE) & (kind[i - 1] != CF_CELL_INSIDE);
  return count;
}

/* The first cell from i on that is not inside. */
static int end_of_run(const unsigned char *kind, int i, const int n) {
  uint64_t all, eight;
  memset(&all, CF_CELL_INSIDE, sizeof all);
  for (; i + 8 <= n; i += 8) {
    memcpy(&eight, kind + i, sizeof eight);
    if (eight != all) break;
  }
  while (i < n && kind[i] == CF_CELL_INSIDE) ++i;
  return i;
}

static void find_runs_in_row(const unsigned char *kind, const int n, cf_run *run) {
  for (int i = 0; i < n;) {
    const unsigned char *next = memchr(kind + i, CF_CELL_INSIDE, (size_t)(n - i));
    if (next == NULL) return;
    const int low = (int)(next - kind);
    i = end_of_run(kind, low, n);
    *run++ = (cf_run){low, i};
  }
}

static cf_status find_runs(cf_window *w) {
  const cf_box *b = &w->grid.box;
  const ptrdiff_t rows = cf_box_rows(b);
  const unsigned char *kind = w->region->kind;
  CF_PARALLEL_ROWS (b, w->grid.threads, r) w->first[r + 1] = count_runs(b->n[0], kind + cf_box_row(b, r));
  for (ptrdiff_t r = 0; r < rows; ++r) w->first[r + 1] += w->first[r];
  if (w->first[rows] > w->room) {
    cf_free(w->run);
    w->run = NULL;
    w->room = 0;
    CF_TRY(CF_NEW(&w->run, w->first[rows] + w->first[rows] / 4));
    w->room = w->first[rows] + w->first[rows] / 4;
  }
  CF_PARALLEL_ROWS (b, w->grid.threads, r)
    find_runs_in_row(kind + cf_box_row(b, r), b->n[0], w->run + w->first[r]);
  return CF_OK;
}

/* --- copying ------------------------------------------------------------------------------------------ */

/* Asks for what is copied of a row that comes later: every row of the large box lies in other pages. */
static void ask_for(const cf_window *w, const ptrdiff_t r, const cf_real *outer, const cf_real *own,
                    const bool outwards) {
  if (r >= cf_box_rows(&w->grid.box)) return;
  const cf_real *there = outer + outer_row(w, r), *here = own + cf_box_row(&w->grid.box, r);
  FOR_ROW_RUNS (w, r, q)
    for (int i = q->low; i < q->high; i += CF_LANES) {
      if (outwards)
        __builtin_prefetch(there + i, 1), __builtin_prefetch(here + i);
      else
        __builtin_prefetch(there + i), __builtin_prefetch(here + i, 1);
    }
}

static void fetch(const cf_window *w, const cf_cell from, const cf_cell to) {
  const cf_box *b = &w->grid.box;
  CF_PARALLEL_ROWS (b, w->grid.threads, r) {
    const cf_real *there = from.at + outer_row(w, r);
    cf_real *here = to.at + cf_box_row(b, r);
    ask_for(w, r + AHEAD, from.at, to.at, false);
    FOR_ROW_RUNS (w, r, q) memcpy(here + q->low, there + q->low, (size_t)(q->high - q->low) * sizeof *here);
  }
}

static void bring(const cf_window *w, const cf_cell from, const cf_cell to) {
  const cf_box *b = &w->grid.box;
  CF_PARALLEL_ROWS (b, w->grid.threads, r) {
    const cf_real *here = from.at + cf_box_row(b, r);
    cf_real *there = to.at + outer_row(w, r);
    ask_for(w, r + AHEAD, to.at, from.at, true);
    FOR_ROW_RUNS (w, r, q) memcpy(there + q->low, here + q->low, (size_t)(q->high - q->low) * sizeof *here);
  }
}

/* Where cells have been inside nothing stays: what is computed must not depend on it. */
static void clear(const cf_window *w, const cf_cell f) {
  const cf_box *b = &w->grid.box;
  CF_PARALLEL_ROWS (b, w->grid.threads, r) {
    cf_real *here = f.at + cf_box_row(b, r);
    FOR_ROW_RUNS (w, r, q) memset(here + q->low, 0, (size_t)(q->high - q->low) * sizeof *here);
  }
}

/* All faces of the window: those beside cells inside are among them. */
static void fetch_faces(const cf_window *w, const int a, const cf_real *from) {
  const cf_box *b = &w->grid.box;
  const int rows = cf_box_extent(b, 1, a), n = cf_box_extent(b, 0, a);
  CF_PARALLEL_FACE_ROWS (b, w->grid.threads, a, r) {
    const int j = (int)(r % rows), k = (int)(r / rows);
    memcpy(w->beta.at[a] + cf_box_at(b, 0, j, k),
           from + cf_box_at(&w->outer.box, w->low[0], w->low[1] + j, w->low[2] + k),
           (size_t)n * sizeof *from);
  }
}

/* --- setting ------------------------------------------------------------------------------------------ */

static cf_status take_region(cf_window *w, const cf_region *region) {
  if (w->room > 0) {
    clear(w, w->x);
    clear(w, w->b);
  }
  cf_region_look(w->region, region, w->low);
  return find_runs(w);
}

/* The law for the window; fields of coefficients are copied. */
static cf_status translate(cf_window *w, const cf_coefficients *c, cf_coefficients *own) {
  *own = *c;
  own->region = w->region;
  if (c->alpha_at != NULL) {
    if (w->alpha.at == NULL) CF_TRY(cf_cell_create(&w->alpha, &w->grid.box));
    fetch(w, *c->alpha_at, w->alpha);
    own->alpha_at = &w->alpha;
  }
  if (c->beta_at == NULL) return CF_OK;
  if (w->beta.at[0] == NULL) CF_TRY(cf_face_create(&w->beta, &w->grid.box));
  cf_halo seams = {.threads = w->grid.threads};
  for (int a = 0; a < w->grid.box.dim; ++a)
    if (w->walls.kind[a][0] == CF_WALL_PERIODIC) seams.rule[a][0] = seams.rule[a][1] = CF_HALO_WRAP;
  for (int a = 0; a < w->grid.box.dim; ++a) {
    cf_halo_fill(&w->outer.box, &seams, 0, a, c->beta_at->at[a]);
    fetch_faces(w, a, c->beta_at->at[a]);
  }
  own->beta_at = &w->beta;
  return CF_OK;
}

static bool has(const cf_window *w, const cf_coefficients *c) {
  return w->stamp != 0 && w->stamp == c->region->stamp && w->law.region == c->region && c->alpha_at == NULL &&
         c->beta_at == NULL && w->law.alpha_at == NULL && w->law.beta_at == NULL &&
         w->law.alpha == c->alpha && w->law.beta == c->beta;
}

static cf_held held_of(const cf_grid *g, const cf_walls *walls, const cf_coefficients *c) {
  cf_held held = {.region = c->region, .number = c->beta};
  if (c->beta_at != NULL) held.beta = *c->beta_at;
  for (int a = 0; a < g->box.dim; ++a) held.periodic[a] = walls->kind[a][0] == CF_WALL_PERIODIC;
  return held;
}

static cf_status set(cf_window *w, const cf_grid *g, const frame *f, const cf_coefficients *c) {
  const bool same_region = w->stamp != 0 && w->stamp == c->region->stamp && w->law.region == c->region;
  cf_coefficients own;
  w->stamp = 0;
  w->outer = *g;
  memcpy(w->low, f->low, sizeof w->low);
  if (!same_region) CF_TRY(take_region(w, c->region));
  CF_TRY(translate(w, c, &own));
  CF_TRY(cf_helmholtz_set(w->A, &own));
  w->law = *c;
  w->stamp = c->region->stamp;
  return CF_OK;
}

cf_status cf_window_set(cf_window **w, const cf_grid *g, const cf_walls *walls, const int levels,
                        const cf_coefficients *c) {
  if (*w != NULL && has(*w, c)) return CF_OK;
  const frame f = frame_of(g, walls, c->region);
  if (*w != NULL && !fits(*w, &f)) {
    cf_window_destroy(*w);
    *w = NULL;
  }
  if (*w == NULL) CF_TRY(create(w, g, &f, levels));
  const cf_status s = set(*w, g, &f, c);
  if (s != CF_OK) {
    cf_window_destroy(*w);
    *w = NULL;
    return s;
  }
  (*w)->held = held_of(g, walls, c);
  return CF_OK;
}

/* --- what is asked of it --------------------------------------------------------------------------------- */

cf_status cf_window_solve(cf_window *w, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                          cf_solve_report *report) {
  fetch(w, b, w->b);
  fetch(w, x, w->x);
  CF_TRY(cf_helmholtz_solve(w->A, w->b, o, w->x, report));
  bring(w, w->x, x);
  if (report->pockets > 0) bring(w, w->b, b); /* without means that nothing could answer */
  return CF_OK;
}

/* f = 0 wherever it may be written. */
static void clear_all(const cf_grid *g, const cf_tiles *t, const cf_cell f) {
  const cf_box *b = &g->box;
  if (t == NULL) {
    CF_PARALLEL_ROWS (b, g->threads, r) memset(f.at + cf_box_row(b, r), 0, (size_t)b->n[0] * sizeof *f.at);
    return;
  }
  CF_PARALLEL_TILES (t, g->threads, r)
    CF_TILE_ROWS (t, r, j, k)
      CF_TILE_RUNS (t, r, run)
        memset(f.at + cf_box_at(b, run->low, j, k), 0, (size_t)(run->high - run->low) * sizeof *f.at);
}

void cf_window_apply(cf_window *w, const cf_cell x, const cf_cell y) {
  fetch(w, x, w->x);
  cf_helmholtz_apply(w->A, w->x, w->b);
  clear_all(&w->outer, w->law.region->tiles, y);
  bring(w, w->b, y);
}

double cf_window_residual(cf_window *w, const cf_cell x, const cf_cell b) {
  fetch(w, b, w->b);
  fetch(w, x, w->x);
  return cf_helmholtz_residual(w->A, w->x, w->b);
}

void cf_window_add_held(const cf_window *w, const cf_cell b) {
  const cf_box *own = &w->grid.box;
  CF_PARALLEL_ROWS (own, w->grid.threads, r) {
    const ptrdiff_t row = outer_row(w, r);
    const int j = w->low[1] + (int)(r % own->n[1]), k = w->low[2] + (int)(r / own->n[1]);
    FOR_ROW_RUNS (w, r, q)
      for (int i = q->low; i < q->high; ++i)
        b.at[row + i] += (cf_real)cf_held_beside(&w->held, (int[]){w->low[0] + i, j, k}, row + i);
  }
}

double cf_window_wall_beta(const cf_window *w, const int axis, const ptrdiff_t p, const ptrdiff_t face) {
  if (w->held.region->kind[p] != CF_CELL_INSIDE) return 0;
  return w->held.beta.at[0] != NULL ? (double)w->held.beta.at[axis][face] : w->held.number;
}

const char *cf_window_method(const cf_window *w) { return cf_helmholtz_method(w->A); }
