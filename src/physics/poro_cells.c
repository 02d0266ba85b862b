/* SPDX-License-Identifier: MIT
 *
 * What each cell is to the water (free, or held by which source at which value), and what each face conducts.
 */
#include <math.h>

#include "physics/poro_part.h"

/* Where a bath holds: below this distance from the surface, in h. With 0.05 to 0.25 the uptake is the same. */
#define HELD_BELOW 0.1

/* Distances between a free cell and the surface that holds its value, in h. */
#define NEAREST  0.1
#define FARTHEST 1.5

double cf_poro_distance(const double theta) {
  if (theta <= 0) return -1.5;
  if (theta >= 1) return 1.5;
  if (theta < 1.0 / 6) return cbrt(6 * theta) - 1.5;
  if (theta > 5.0 / 6) return 1.5 - cbrt(6 * (1 - theta));
  return sqrt(3) * sin(asin((2 * theta - 1) / sqrt(0.75)) / 3); /* 1/2 + 3z/4 - z^3/3 = theta */
}

/* --- cells ------------------------------------------------------------------------------------------------- */

/* Whether a cell two or fewer away is outside all bodies. */
static bool outside_within_two(const cf_poro *w, const ptrdiff_t p) {
  const cf_box *box = &w->grid->box;
  const int deep = box->dim == 3 ? 2 : 0;
  for (int k = -deep; k <= deep; ++k)
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i)
        if (!((double)w->fill.at[p + cf_box_at(box, i, j, k)] > CF_PORO_LEAST_FILL)) return true;
  return false;
}

static bool works(const cf_poro_source *s, const double t) {
  return t > s->from && t <= s->to && (s->given == NULL || *s->given < s->amount);
}

/* The source that holds cell p, or -1. */
static int holder(const cf_poro *w, const ptrdiff_t p, const double place[3], const double t) {
  int at_surface = -1; /* -1: not asked yet */
  for (int s = 0; s < w->p.sources; ++s) {
    const cf_poro_source *source = &w->p.source[s];
    if (source->kind == CF_PORO_RATE || !works(source, t)) continue;
    if (source->kind == CF_PORO_BATH && at_surface < 0)
      at_surface = cf_poro_distance((double)w->fill.at[p]) < HELD_BELOW && outside_within_two(w, p);
    if (source->kind == CF_PORO_BATH && at_surface == 0) continue;
    if (source->shape == NULL || cf_shape_distance(source->shape, NULL, t, place) < 0) return s;
  }
  return -1;
}

static void place_of(const cf_poro *w, const int i, const int j, const int k, double place[3]) {
  place[0] = cf_grid_place(w->grid, 0, i, 0);
  place[1] = cf_grid_place(w->grid, 1, j, 0);
  place[2] = w->grid->box.dim == 3 ? cf_grid_place(w->grid, 2, k, 0) : 0;
}

/* Expressions are not for concurrent use: values are taken once a step where they do not vary in space, which is what
 * the scene allows. */
static void find_kinds(const cf_poro *w, const double t, const double *values) {
  const cf_tiles *tiles = w->tiles;
  const cf_box *box = &w->grid->box;
  unsigned char *kind = w->kind + box->first, *inside = w->region->kind;
  CF_PARALLEL_TILES (tiles, w->grid->threads, r)
    CF_TILE_ROWS (tiles, r, j, k)
      CF_TILE_RUNS (tiles, r, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(box, i, j, k);
          double place[3];
          kind[p] = CF_PORO_NONE;
          inside[p] = CF_CELL_WALL;
          if (!((double)w->fill.at[p] > CF_PORO_LEAST_FILL)) continue;
          place_of(w, i, j, k, place);
          const int s = holder(w, p, place, t);
          if (s < 0) {
            kind[p] = CF_PORO_FREE;
            inside[p] = CF_CELL_INSIDE;
          } else {
            kind[p] = w->p.source[s].kind == CF_PORO_BATH ? CF_PORO_HELD_SURFACE : CF_PORO_HELD_CELL;
            w->value.at[p] = (cf_real)values[s];
          }
        }
}

/* At a byte of a neighbour, while another thread changes it in what is of no importance here. */
static int look(const unsigned char *at) { return __atomic_load_n(at, __ATOMIC_RELAXED); }

/* Free cells beside held ones. Reads only whether neighbours are held, which nobody changes here. */
static void find_near(const cf_poro *w) {
  const cf_box *box = &w->grid->box;
  unsigned char *kind = w->kind + box->first;
  FOR_CELLS(w, p) {
    if (kind[p] != CF_PORO_FREE) continue;
    for (int a = 0; a < box->dim; ++a)
      if (look(&kind[p + box->stride[a]]) >= CF_PORO_HELD_SURFACE ||
          look(&kind[p - box->stride[a]]) >= CF_PORO_HELD_SURFACE)
        __atomic_store_n(&kind[p], CF_PORO_NEAR, __ATOMIC_RELAXED);
  }
  END_CELLS
}

cf_status cf_poro_find_cells(cf_poro *w, const double t) {
  double values[CF_PORO_SOURCES_MAX];
  for (int s = 0; s < w->p.sources; ++s) values[s] = cf_fn_at(&w->p.source[s].value, 0, 0, 0, t);
  find_kinds(w, t, values);
  find_near(w);
  return cf_region_update(w->region);
}

/* --- faces ------------------------------------------------------------------------------------------------- */

/* c h^(d-2): what a face between two full cells with k = 1 conducts, c the water per volume of cell p. */
static double full(const cf_poro *w, const ptrdiff_t p) {
  return (double)w->C.at[p] / (double)w->fill.at[p] / (w->grid->h * w->grid->h);
}

double cf_poro_to_held(const cf_poro *w, const ptrdiff_t p, const ptrdiff_t q) {
  if (w->kind[q + w->grid->box.first] == CF_PORO_HELD_CELL) return full(w, p);
  const double here = cf_poro_distance((double)w->fill.at[p]),
               there = cf_poro_distance((double)w->fill.at[q]);
  const double d = here > there ? here / (here - there) : FARTHEST;
  return full(w, p) / CF_MAX(NEAREST, CF_MIN(FARTHEST, d));
}

/* Within two cells of a wet surface the fill says where the surface is, not how much of a face there is: those cells
 * are found by widening the held ones along one axis after the other, a bit each. */
static void find_wet(const cf_poro *w) {
  const cf_box *box = &w->grid->box;
  const unsigned char *kind = w->kind + box->first;
  unsigned char *wet = w->wet + box->first;
  FOR_CELLS(w, p)
  wet[p] = kind[p] == CF_PORO_HELD_SURFACE;
  END_CELLS
  for (int a = 0; a < box->dim; ++a) FOR_CELLS(w, p) {
      const ptrdiff_t s = box->stride[a];
      const int here = wet[p], any = look(&wet[p - 2 * s]) | look(&wet[p - s]) | here | look(&wet[p + s]) |
                                     look(&wet[p + 2 * s]);
      __atomic_store_n(&wet[p], (unsigned char)(here | ((any >> a & 1) << (a + 1))), __ATOMIC_RELAXED);
    }
  END_CELLS
}

static bool is_wet(const cf_poro *w, const ptrdiff_t p) {
  return w->wet[p + w->grid->box.first] >> w->grid->box.dim & 1;
}

/* The same for a face as it is. */
static double between(const cf_poro *w, const ptrdiff_t p, const ptrdiff_t q) {
  if (is_wet(w, p) || is_wet(w, q)) return (full(w, p) + full(w, q)) / 2;
  return ((double)w->C.at[p] + (double)w->C.at[q]) / (2 * w->grid->h * w->grid->h);
}

static double harmonic(const cf_cell k, const ptrdiff_t p, const ptrdiff_t q) {
  const double a = (double)k.at[p], b = (double)k.at[q];
  return a + b > 0 ? 2 * a * b / (a + b) : 0;
}

void cf_poro_set_faces(const cf_poro *w) {
  const cf_box *box = &w->grid->box;
  const double h2 = w->grid->h * w->grid->h;
  find_wet(w);
  for (int a = 0; a < box->dim; ++a) FOR_CELLS(w, p) {
      const ptrdiff_t q = p - box->stride[a];
      const bool open = cf_poro_is_free(w, p) && cf_poro_is_free(w, q);
      const double way = open ? between(w, p, q) : 0;
      if (w->p.mixture == NULL) {
        w->beta.at[a][p] = (cf_real)(w->scale * w->p.k * way);
        continue;
      }
      const double kappa = open ? harmonic(w->k, p, q) * way : 0,
                   now = open ? harmonic(w->k_now, p, q) * way : 0;
      w->kappa.at[a][p] = (cf_real)kappa;
      w->kappa_now.at[a][p] = (cf_real)now;
      w->beta.at[a][p] = (cf_real)(h2 * (w->slow * kappa + w->fast * now));
    }
  END_CELLS
}

/* --- sources ----------------------------------------------------------------------------------------------- */

void cf_poro_add_rates(const cf_poro *w, const double t, const double d) {
  const cf_tiles *tiles = w->tiles;
  const cf_box *box = &w->grid->box;
  const double volume = cf_grid_volume(w->grid);
  for (int s = 0; s < w->p.sources; ++s) {
    const cf_poro_source *source = &w->p.source[s];
    if (source->kind != CF_PORO_RATE || !works(source, t)) continue;
    const double rate = cf_fn_at(&source->value, 0, 0, 0, t);
    CF_PARALLEL_TILES (tiles, w->grid->threads, r)
      CF_TILE_ROWS (tiles, r, j, k)
        CF_TILE_RUNS (tiles, r, run)
          for (int i = run->low; i < run->high; ++i) {
            const ptrdiff_t p = cf_box_at(box, i, j, k);
            double place[3];
            if (!cf_poro_is_free(w, p)) continue;
            place_of(w, i, j, k, place);
            if (source->shape != NULL && cf_shape_distance(source->shape, NULL, t, place) >= 0) continue;
            w->m.at[p] += (cf_real)(d * rate * volume * (double)w->fill.at[p]);
          }
  }
}

void cf_poro_note_given(const cf_poro *w, const double t, const double dt, const double gained) {
  (void)dt;
  int at_work = 0;
  for (int s = 0; s < w->p.sources; ++s) at_work += works(&w->p.source[s], t);
  for (int s = 0; s < w->p.sources; ++s)
    if (w->p.source[s].given != NULL && works(&w->p.source[s], t)) *w->p.source[s].given += gained / at_work;
}
