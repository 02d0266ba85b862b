/* SPDX-License-Identifier: MIT
 *
 * A level of the hierarchy for equations whose coefficients vary or that hold in a part of the box only: cells, and how
 * strongly neighbours are coupled.
 *
 *     (A e)_p = (free_p + held_p) e_p + sum over axes of  c_p (e_p - e_{p-a}) + c_{p+a} (e_p - e_{p+a})
 *
 * c_p belongs to the low face of cell p and is 0 where no flux passes; held is what faces with a known value add, free
 * the rest of the diagonal (alpha). Everything is extensive, integrated over the cell: a coarse cell's free is the
 * sum of its children's, a coarse residual the sum of theirs. A cell with no diagonal has no equation.
 *
 * The level lives in single precision: it only preconditions (varied.h). The equation is scaled so that the largest
 * diagonal of the finest level is about 1.
 *
 * What is around it comes in four steps: half sweeps of red-black Gauss-Seidel, mildly over-relaxed; extra sweeps
 * over the rows that have cells near closed and held faces (after McAdams, Sifakis, Teran 2010), for which neither smoothing
 * nor correction is as good as inside; the residual summed over the children of coarse cells; and interpolation
 *
 *     e_p += e_c + sum over axes of w_a (e_{c+a} - e_c)
 *
 * from the parent and its nearest neighbour along each axis, where w_a is the share of the resistance between the two
 * coarse centres that lies before the fine one: 1/4 where nothing varies, 0 through a closed face (coarsen.h makes
 * it; bytes in units of 1/256).
 *
 * Sweeps visit the runs of active tiles, or all rows; those on one side of the coarse correction in one pass over memory
 * (lean.h), where no axis is periodic.
 */
#ifndef CF_SOLVE_COUPLED_H
#define CF_SOLVE_COUPLED_H

#include "grid/tiles.h"

/* The parent of a cell of an island. */
#define CF_NO_PARENT PTRDIFF_MIN

/* Cells of a level that are made anew: all rows and runs of the level, or those of tiles. */
typedef struct cf_part {
  const cf_tile_row *row;
  const cf_run *run;
  ptrdiff_t rows;
  const cf_tiles *tiles; /* NULL: all */
} cf_part;

/* Bits of cf_coupled.mark. */
#define CF_MARK_EDGE 1 /* a face of the cell is closed or held, other than by a wall of the box */
#define CF_MARK_ODD  2 /* it is among the odds */

typedef struct cf_coupled {
  int dim, threads;
  cf_box box;
  bool periodic[3];
  bool coarsened[3];     /* towards the next level */
  const cf_tiles *tiles; /* NULL: dense */
  cf_tiles *own_tiles;   /* of coarse levels */
  int64_t followed;      /* the update of the tiles that the fields are right for */
  cf_tile_row *row;      /* what sweeps visit: of the tiles, or all */
  cf_run *run;
  ptrdiff_t rows;
  cf_tile_row *all_rows; /* our own, where there are no tiles */
  cf_run all[1];
  int32_t *row_at;     /* with tiles: which entry of `row` a row of tiles is, -1: none */
  int low[3], high[3]; /* cells that are visited lie within */
  cf_run *span; /* of rows in twos along both axes (spans.c): what is visited of them; NULL: all of it */

  float *e, *r, *rest;          /* correction, right side, residual */
  float *inverse, *free, *held; /* 1/diagonal (0: no equation) and its parts */
  float *c[3];                  /* couplings on low faces */
  unsigned char *weight[3];     /* of interpolation from the next level */
  float excess
      [3]; /* by what share alpha, beta, and couplings at corners differ from what blocks tell (amend.h) */
  unsigned char *mark; /* bits, for those who make levels; written only where they change */

  /* Cells whose parent is not the coarse cell around them (coarsen.h), and islands: pieces of a block coupled to nothing
   * else, whose constant is solved for by itself. They take no part in the sweeps of restriction and interpolation. In
   * the order of their blocks; those of an island follow each other. */
  ptrdiff_t odds, odd_room, *odd_cell, *odd_block, *odd_parent;
  float *odd_value;
  int32_t *odd_island; /* 0: has a parent, or the number of the island */

  bool is_open;        /* no face is closed but walls of the box (open.h), */
  bool is_fixed;       /* ... and some alpha or known value fixes the level of the solution */
  bool is_gentle;      /* alpha holds some cells so much that they must not be over-relaxed */
  bool has_band;       /* some face is closed or held */
  unsigned char *band; /* of row j + n[1] k: whether it has cells at such a face, or beside one that is */
} cf_coupled;

/* Shapes a level on the box `b`; fields are pages, untouched. CF_NO_MEMORY; what was made is freed by destroy. */
cf_status cf_coupled_create(cf_coupled *l, const cf_box *b, const bool periodic[3], int threads,
                            const cf_tiles *tiles);
void cf_coupled_destroy(cf_coupled *l); /* a zeroed one is fine */

/* After the tiles have been updated: visits their runs, and gives back what is no longer under one. */
void cf_coupled_follow_tiles(cf_coupled *l);

static inline cf_part cf_coupled_all(const cf_coupled *l) { return (cf_part){l->row, l->run, l->rows, NULL}; }

static inline bool cf_part_has(const cf_part *w, const int at[3]) {
  return w->tiles == NULL || cf_tiles_has_cell(w->tiles, at[0], at[1], at[2]);
}

ptrdiff_t cf_part_cells(const cf_part *w);

/* From c, free and held: inverse, seams, and the band, where a part has been made anew. CF_NO_MEMORY. */
cf_status cf_coupled_finish(cf_coupled *l, const cf_part *w);

/* Where cell p of a box is. */
void cf_coupled_place(const cf_box *b, ptrdiff_t p, int at[3]);

/* Sweeps over the band, and how much they are over-relaxed. */
typedef struct cf_band_sweeps {
  int count;
  float omega;
} cf_band_sweeps;

/* e from e = 0: a red-black sweep, and those over the band; then, if asked, rest = r - A e. */
void cf_coupled_smooth_first(const cf_coupled *l, float omega, cf_band_sweeps band, bool with_rest);

/* Sweeps over the band, then `sweeps` full ones. */
void cf_coupled_smooth(const cf_coupled *l, float omega, cf_band_sweeps band, int sweeps);

/* A full sweep, then rest = r - A e. */
void cf_coupled_smooth_again(const cf_coupled *l, float omega);

/* What smooth_first does in the opposite order: its transpose, for a cycle that must be symmetric. */
void cf_coupled_smooth_back(const cf_coupled *l, float omega, cf_band_sweeps band);

/* coarse->r = sums of the rest of `l`, which is changed. */
void cf_coupled_restrict(const cf_coupled *l, const cf_coupled *coarse);

/* e += interpolated coarse->e. */
void cf_coupled_prolong(const cf_coupled *coarse, const cf_coupled *l);

/* The same for a run of row (j, k), without cells that have another parent; seams of coarse->e are right. */
void cf_coupled_spread(const cf_coupled *coarse, const cf_coupled *l, const cf_run *run, int j, int k);

/* The correction of each cell that has another parent, from its rest in odd_value into odd_value: its parent's e, or
 * the constant of its island. */
void cf_coupled_lift_odds(const cf_coupled *coarse, const cf_coupled *l);

/* For a cycle that must be symmetric: interpolation that knows nothing of alpha, and its transpose in place of sums. */
void cf_coupled_prolong_alike(const cf_coupled *coarse, const cf_coupled *l);
void cf_coupled_restrict_alike(const cf_coupled *l, const cf_coupled *coarse);

/* Copies the outermost layers of f to the ghosts across periodic seams; of one axis. */
void cf_coupled_wrap(const cf_coupled *l, float *f);
void cf_coupled_wrap_axis(const cf_coupled *l, int a, float *f);

/* Whether cell p has an equation. */
static inline bool cf_coupled_has(const cf_coupled *l, const ptrdiff_t p) { return l->inverse[p] > 0; }

static inline int cf_coupled_threads(const cf_coupled *l) {
  return l->tiles != NULL ? cf_tiles_threads(l->tiles, l->threads) : cf_sweep_threads(&l->box, l->threads);
}

/* The entry of cf_coupled.row that has row (j, k); NULL: nothing of it is visited. Where all rows are, any entry has its
 * runs. */
static inline const cf_tile_row *cf_coupled_row_at(const cf_coupled *l, const int j, const int k) {
  if (l->tiles == NULL) return l->row;
  const cf_tiles *t = l->tiles;
  const int32_t v = l->row_at[(k >> t->shift[2]) * (ptrdiff_t)t->n[1] + (j >> t->shift[1])];
  return v >= 0 ? &l->row[v] : NULL;
}

/* Dense levels: of every row as much as has equations, in whole vectors. What is visited no more is 0 from now on in e and rest.
 * CF_NO_MEMORY. */
cf_status cf_coupled_find_spans(cf_coupled *l);

static inline const cf_run *cf_coupled_span(const cf_coupled *l, const int j, const int k) {
  return &l->span[(ptrdiff_t)(k >> 1) * ((l->box.n[1] + 1) / 2) + (j >> 1)];
}

/* Runs [*run, *end) that are visited of row (j, k). */
static inline void cf_coupled_runs(const cf_coupled *l, const int j, const int k, const cf_run **run,
                                   const cf_run **end) {
  if (l->span != NULL) {
    *run = cf_coupled_span(l, j, k);
    *end = *run + ((*run)->low < (*run)->high);
    return;
  }
  const cf_tile_row *row = cf_coupled_row_at(l, j, k);
  *run = row != NULL ? l->run + row->run : NULL;
  *end = row != NULL ? l->run + row->run_end : NULL;
}

/* The rows of a part w of level l. */
#define CF_PARALLEL_PART(l, w, v)                                                 \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(cf_coupled_threads(l))) \
  for (ptrdiff_t v = 0; v < (w)->rows; ++v)

/* With CF_TILE_ROWS and CF_TILE_RUNS of grid/tiles.h. */
#define CF_PARALLEL_COUPLED(l, v)                                                 \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(cf_coupled_threads(l))) \
  for (ptrdiff_t v = 0; v < (l)->rows; ++v)

#endif
