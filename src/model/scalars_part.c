/* SPDX-License-Identifier: MIT
 *
 * The part of the box that scalars are computed in, where `sparse:` lets it follow them.
 *
 * It is the least box around all cells in which a scalar, or the divergence of its flux, is above a share of its largest
 * value, and around the sources; widened by how far things come in a step; and rounded to whole blocks, so that it does
 * not change with every step. Around it everything is exactly 0, and since nothing that is 0 sends out anything,
 * moves and explicit diffusion in the part are those of the whole box, bit for bit, but for what the threshold cuts off.
 * Implicit diffusion reaches everywhere at once; there the margin is as wide as its reach down to the threshold.
 *
 * The part follows from the state alone (it is found anew in every step), so a stop does not change it. Diffusion and
 * sources live on it and are made anew when it changes; moves are told of it. It is a box and not a set of tiles because
 * a plume and its margin fill theirs well, and every kernel and the solver run in it as they are.
 *
 * It does not do: values on walls, fluxes on faces, obstacles, the paper's scheme (all of them dense).
 */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "grid/sweep.h"
#include "model/scalars.h"
#include "stencil/regime.h"

/* Blocks that the part is rounded to, in cells. */
#define BLOCK 16
/* Ghosts that diffusion may have written beside the part. */
#define GHOSTS CF_HALO

typedef struct extent {
  int low[3], high[3]; /* cells low <= . < high; none where low > high */
} extent;

static extent extent_of(const cf_scalars *s) {
  extent e;
  ptrdiff_t from = s->corner;
  for (int a = 2; a >= 0; --a) {
    e.low[a] = (int)(from / s->grid->box.stride[a]);
    from -= e.low[a] * s->grid->box.stride[a];
    e.high[a] = e.low[a] + s->part.box.n[a];
  }
  return e;
}

/* --- whether ---------------------------------------------------------------------------------------------- */

static cf_status refuse(const cf_scalars *s, const cf_scalar *one, const char *why) {
  return cf_scene_fail_at(s->scene, "sparse.follow", "sparse.follow: %s %s: it needs the whole box",
                          one->name, why);
}

cf_status cf_scalars_may_follow(const cf_scalars *s, bool *may) {
  *may = false;
  if (s->scene->sparse.follow == CF_SPARSE_OFF) return CF_OK;
  if (s->scene->obstacles.count > 0)
    return cf_scene_fail_at(s->scene, "sparse.follow", "sparse.follow: does not go with obstacles");
  for (int i = 0; i < s->count; ++i) {
    const cf_scalar *one = &s->item[i];
    if (!one->plan.scalar_form)
      return refuse(s, one,
                    "has a flux on faces (a scheme, rate or source of its own, or `q` in fields or output)");
    if (!cf_fn_is_constant(&one->scene->capacity.fn)) return refuse(s, one, "has a capacity that varies");
    for (int a = 0; a < s->grid->box.dim; ++a)
      for (int side = 0; side < 2; ++side)
        if (one->walls.kind[a][side] == CF_WALL_VALUE) return refuse(s, one, "has a value on a wall");
  }
  *may = true;
  return CF_OK;
}

cf_walls cf_scalars_ends(const cf_scalars *s, const cf_walls *walls, const cf_wall inside) {
  const extent e = extent_of(s);
  cf_walls ends = *walls;
  for (int a = 0; a < s->grid->box.dim; ++a) {
    if (e.low[a] > 0) ends.kind[a][0] = inside;
    if (e.high[a] < s->grid->box.n[a]) ends.kind[a][1] = inside;
  }
  return ends;
}

double cf_scalars_share(const cf_scalars *s) {
  return (double)cf_box_cells(&s->part.box) / (double)cf_box_cells(&s->grid->box);
}

/* --- where ------------------------------------------------------------------------------------------------ */

static void include(extent *e, const int a, const int low, const int high) {
  e->low[a] = CF_MIN(e->low[a], low);
  e->high[a] = CF_MAX(e->high[a], high);
}

CF_CLONES static cf_real largest_of(const int n, const cf_real *f) {
  cf_real lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) CF_ROW_LOOP
  for (int l = 0; l < CF_SUM_LANES; ++l) {
    const cf_real size = f[i + l] < 0 ? -f[i + l] : f[i + l];
    lane[l] = size > lane[l] ? size : lane[l];
  }
  for (int l = 0; i < n; ++i, ++l) {
    const cf_real size = f[i] < 0 ? -f[i] : f[i];
    lane[l] = size > lane[l] ? size : lane[l];
  }
  for (int l = 1; l < CF_SUM_LANES; ++l) lane[0] = lane[l] > lane[0] ? lane[l] : lane[0];
  return lane[0];
}

/* Cells of the row that are above `level`, from either end. */
static void row_extent(const int n, const cf_real *f, const double level, int *low, int *high) {
  int i = 0, j = n;
  while (i < n && fabs((double)f[i]) <= level) ++i;
  while (j > i && fabs((double)f[j - 1]) <= level) --j;
  *low = i, *high = j;
}

/* Where a field is above its threshold, from what is computed now; every row by itself, then all in order. */
static void include_field(const cf_scalars *s, const cf_real *field, const int low[3], extent *e) {
  const cf_box *b = &s->part.box;
  const ptrdiff_t rows = cf_box_rows(b);
  const cf_real *f = field + s->corner;
  double most = 0;
  CF_PARALLEL_ROWS (b, s->grid->threads, r) s->rows[r] = (double)largest_of(b->n[0], f + cf_box_row(b, r));
  for (ptrdiff_t r = 0; r < rows; ++r) most = CF_MAX(most, s->rows[r]);
  const double level = s->scene->sparse.threshold * most;
  if (!(most > 0)) return;
  for (ptrdiff_t r = 0; r < rows; ++r) {
    if (s->rows[r] <= level) continue;
    int from, to;
    row_extent(b->n[0], f + cf_box_row(b, r), level, &from, &to);
    const int j = (int)(r % b->n[1]), k = (int)(r / b->n[1]);
    include(e, 0, low[0] + from, low[0] + to);
    include(e, 1, low[1] + j, low[1] + j + 1);
    include(e, 2, low[2] + k, low[2] + k + 1);
  }
}

/* The cells that a source touches. */
static void include_source(const cf_scalars *s, const cf_scene_source *from, extent *e) {
  const cf_grid *g = s->grid;
  for (int a = 0; a < 3; ++a) {
    const bool everywhere = !from->given.at && from->shape == CF_SCENE_SHAPE_EVERYWHERE;
    if (a >= g->box.dim || everywhere) {
      include(e, a, 0, g->box.n[a]);
      continue;
    }
    const double middle = from->given.at ? from->at.value[a] : from->center.value[a];
    const double reach = from->given.at                      ? 0
                         : from->shape == CF_SCENE_SHAPE_BOX ? from->half.value[a]
                                                             : from->radius;
    const double low = floor((middle - reach - g->origin[a]) / g->h) - 2,
                 high = ceil((middle + reach - g->origin[a]) / g->h) + 2;
    include(e, a, (int)CF_MAX(0, CF_MIN(low, g->box.n[a])), (int)CF_MAX(0, CF_MIN(high, g->box.n[a])));
  }
}

/* Cells that anything can come in dt. */
static int reach_of(const cf_scalars *s, const double dt) {
  double cells = (double)s->scene->sparse.margin;
  double moved = 0;
  for (int a = 0; a < CF_ADVECT_SCHEMES; ++a)
    if (s->by_scheme[a] != NULL) /* weno5 in three stages */
      moved = CF_MAX(moved, 2 * cf_advect_substeps(s->by_scheme[a], dt / 2) * (a == CF_ADVECT_WENO5 ? 9 : 1));
  for (int i = 0; i < s->count; ++i) {
    const cf_scalar *one = &s->item[i];
    double spread = 2 * cf_diffuse_substeps(one->diffuse, dt) + 2; /* and their front filter */
    const double beta =
        cf_regime_stage(dt, one->scene->tau, one->scene->tau > 0 ? one->scene->f_t : 1) * one->D;
    const double tail =
        log(1 / CF_MAX(s->scene->sparse.threshold, 1e-16)) * sqrt(CF_MAX(beta, 0)) / s->grid->h;
    if (one->plan.scheme != CF_DIFFUSE_LEAPFROG || one->scene->f_t > 0) spread += tail;
    cells = CF_MAX(cells, moved + spread);
  }
  return (int)CF_MIN(ceil(cells), 1e6);
}

/* Rounded to blocks; all of an axis that is periodic, or where nothing is. */
static void round_out(const cf_scalars *s, const int reach, extent *e) {
  for (int a = 0; a < 3; ++a) {
    const int n = s->grid->box.n[a];
    const bool whole = a >= s->grid->box.dim || s->scene->domain.walls.walls.kind[a][0] == CF_WALL_PERIODIC;
    if (e->low[a] >= e->high[a]) e->low[a] = 0, e->high[a] = BLOCK; /* nothing anywhere */
    e->low[a] = whole ? 0 : CF_MAX(0, e->low[a] - reach) / BLOCK * BLOCK;
    e->high[a] = whole ? n : CF_MIN(n, (e->high[a] + reach + BLOCK - 1) / BLOCK * BLOCK);
  }
}

/* --- following -------------------------------------------------------------------------------------------- */

/* Zero in cells [from, to) of a row; returns the sum of what was there. */
static double clear_row(cf_real *row, const int from, const int to) {
  double sum = 0;
  for (int i = from; i < to; ++i) {
    if (row[i] == 0) continue;
    sum += (double)row[i];
    row[i] = 0;
  }
  return sum;
}

/* Zero in all cells of `old` that are not in `fresh`; returns the sum of what was there. */
static double clear_outside(const cf_scalars *s, const extent *old, const extent *fresh, cf_real *f) {
  double sum = 0;
  for (int k = old->low[2]; k < old->high[2]; ++k)
    for (int j = old->low[1]; j < old->high[1]; ++j) {
      cf_real *row = f + cf_box_at(&s->grid->box, 0, j, k);
      const bool kept = j >= fresh->low[1] && j < fresh->high[1] && k >= fresh->low[2] && k < fresh->high[2];
      if (!kept) {
        sum += clear_row(row, old->low[0], old->high[0]);
        continue;
      }
      sum += clear_row(row, old->low[0], CF_MIN(old->high[0], fresh->low[0]));
      sum += clear_row(row, CF_MAX(old->low[0], fresh->high[0]), old->high[0]);
    }
  return sum;
}

void cf_scalars_clear_ghosts(const cf_scalars *s) {
  if (!s->follows) return;
  const extent part = extent_of(s);
  extent wide = part;
  for (int a = 0; a < s->grid->box.dim; ++a) {
    wide.low[a] = CF_MAX(0, part.low[a] - GHOSTS);
    wide.high[a] = CF_MIN(s->grid->box.n[a], part.high[a] + GHOSTS);
  }
  for (int i = 0; i < s->count; ++i) {
    (void)clear_outside(s, &wide, &part, s->item[i].phi.at);
    (void)clear_outside(s, &wide, &part, s->item[i].s.at);
  }
}

/* What is cut off has left (or come, where it was negative). */
static void cut(cf_scalars *s, cf_scalar *one, const extent *old, const extent *fresh) {
  const double lost = clear_outside(s, old, fresh, one->phi.at) * cf_grid_volume(s->grid);
  if (lost > 0)
    one->ledger.left += lost * one->scene->capacity.fn.value;
  else
    one->ledger.entered -= lost * one->scene->capacity.fn.value;
  (void)clear_outside(s, old, fresh, one->s.at);
}

static cf_status move_part(cf_scalars *s, const extent *fresh) {
  s->corner = cf_box_at(&s->grid->box, fresh->low[0], fresh->low[1], fresh->low[2]);
  for (int a = 0; a < 3; ++a) {
    s->part.box.n[a] = fresh->high[a] - fresh->low[a];
    s->part.origin[a] = s->grid->origin[a] + fresh->low[a] * s->grid->h;
  }
  for (int i = 0; i < s->count; ++i) {
    cf_scalar *one = &s->item[i];
    cf_diffuse_destroy(one->diffuse);
    cf_sources_destroy(one->sources);
    one->diffuse = NULL, one->sources = NULL;
    CF_TRY(cf_scalars_make_diffuse(s, one));
  }
  return CF_OK;
}

cf_status cf_scalars_follow(cf_scalars *s, const double dt) {
  extent fresh = {{INT_MAX, INT_MAX, INT_MAX}, {0, 0, 0}};
  if (!s->follows) return CF_OK;
  const extent old = extent_of(s);
  for (int i = 0; i < s->count; ++i) {
    include_field(s, s->item[i].phi.at, old.low, &fresh);
    include_field(s, s->item[i].s.at, old.low, &fresh);
  }
  for (int i = 0; i < s->scene->sources.count; ++i) include_source(s, &s->scene->sources.item[i], &fresh);
  round_out(s, reach_of(s, dt), &fresh);
  for (int i = 0; i < s->count; ++i) cut(s, &s->item[i], &old, &fresh);
  const bool same =
      memcmp(old.low, fresh.low, sizeof old.low) == 0 && memcmp(old.high, fresh.high, sizeof old.high) == 0;
  return same ? CF_OK : move_part(s, &fresh);
}
