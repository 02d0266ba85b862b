/* SPDX-License-Identifier: MIT */
#include "solve/pockets.h"

#include <string.h>

#include "base/mem.h"
#include "grid/lanes.h"
#include "grid/sweep.h"

void cf_pockets_clear(cf_pockets *q, const cf_coupled *l) {
  cf_free(q->united);
  cf_free(q->sum);
  cf_free(q->mean);
  cf_free(q->cells);
  cf_free(q->plain);
  cf_free(q->rows);
  if (q->label != NULL) cf_pages_release(q->label - l->box.first, (size_t)l->box.size * sizeof *q->label);
  *q = (cf_pockets){0};
}

/* --- finding ------------------------------------------------------------------------------------------ */

static int32_t root_of(int32_t *united, int32_t label) {
  while (united[label] != label) {
    united[label] = united[united[label]];
    label = united[label];
  }
  return label;
}

static void unite(int32_t *united, const int32_t a, const int32_t b) {
  const int32_t ra = root_of(united, a), rb = root_of(united, b);
  if (ra < rb)
    united[rb] = ra;
  else
    united[ra] = rb;
}

static cf_status make_room(cf_pockets *q, const ptrdiff_t more) {
  if (q->labels + more <= q->room) return CF_OK;
  const ptrdiff_t room = 2 * q->room + more;
  int32_t *united;
  CF_TRY(CF_NEW(&united, room));
  if (q->united != NULL) memcpy(united, q->united, (size_t)q->labels * sizeof *united);
  cf_free(q->united);
  q->united = united;
  q->room = room;
  return CF_OK;
}

/* Labels of a run; 0 is no part. */
static void label_run(cf_pockets *q, const cf_coupled *l, const cf_run *run, const ptrdiff_t row) {
  for (int i = run->low; i < run->high; ++i) {
    const ptrdiff_t p = row + i;
    q->label[p] = 0;
    if (!cf_coupled_has(l, p)) continue;
    if (i > 0 && l->c[0][p] > 0) {
      q->label[p] = q->label[p - 1];
      continue;
    }
    q->united[q->labels] = (int32_t)q->labels;
    q->label[p] = (int32_t)q->labels++;
  }
}

static void unite_run(const cf_pockets *q, const cf_coupled *l, const cf_run *run, const int at[3]) {
  const ptrdiff_t row = cf_box_at(&l->box, 0, at[1], at[2]);
  for (int a = 0; a < l->dim; ++a) {
    if (a == 0 ? !l->periodic[0] : at[a] == 0 && !l->periodic[a]) continue;
    const bool seam = a == 0 || at[a] == 0;
    const ptrdiff_t to = seam ? (l->box.n[a] - 1) * l->box.stride[a] : -l->box.stride[a];
    const int end = a == 0 ? CF_MIN(run->high, 1) : run->high; /* along x only the seam is left */
    for (int i = run->low; i < end; ++i)
      if (l->c[a][row + i] > 0) unite(q->united, q->label[row + i], q->label[row + i + to]);
  }
}

/* Room for what is known of each. */
static cf_status pockets_room(cf_pockets *q, const cf_coupled *l) {
  cf_free(q->sum);
  cf_free(q->mean);
  cf_free(q->cells);
  q->sum = q->mean = q->cells = NULL;
  if (q->plain == NULL) CF_TRY(CF_NEW(&q->plain, cf_box_rows(&l->box)));
  if (q->rows == NULL) CF_TRY(CF_NEW(&q->rows, cf_box_rows(&l->box)));
  CF_TRY(CF_NEW(&q->sum, q->count));
  CF_TRY(CF_NEW(&q->mean, q->count));
  return CF_NEW(&q->cells, q->count);
}

cf_status cf_pockets_take_all(cf_pockets *q, const cf_coupled *l) {
  q->count = 1;
  q->single = q->all = true;
  q->widest = 0;
  CF_TRY(pockets_room(q, l));
  q->cells[0] = (double)cf_box_cells(&l->box);
  for (ptrdiff_t r = 0; r < cf_box_rows(&l->box); ++r) q->plain[r] = true;
  return CF_OK;
}

/* The parts whose diagonal is made of couplings alone become pockets; united: from a label to its pocket or -1. */
static cf_status number_pockets(cf_pockets *q, const cf_coupled *l, const bool loose) {
  bool *fixed;
  CF_TRY(CF_NEW(&fixed, q->labels));
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          if ((loose ? 0 : l->free[p]) + l->held[p] > 0) fixed[root_of(q->united, q->label[p])] = true;
        }
  q->count = 0;
  for (ptrdiff_t v = 0; v < q->labels; ++v) q->united[v] = root_of(q->united, (int32_t)v);
  int32_t *number = q->united; /* roots come before what is united with them */
  fixed[0] = true;
  for (ptrdiff_t v = 0; v < q->labels; ++v) {
    const int32_t root = number[v];
    if (root == v)
      number[v] = fixed[v] ? -1 : q->count++;
    else
      number[v] = number[root];
  }
  cf_free(fixed);
  return pockets_room(q, l);
}

/* How many cells pockets have, which one has the most, and which rows have cells of no other. */
static cf_status count_cells(cf_pockets *q, const cf_coupled *l) {
  if (q->count == 0) return CF_OK;
  ptrdiff_t cells = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (ptrdiff_t p = cf_box_at(&l->box, run->low, j, k), end = p + run->high - run->low; p < end; ++p) {
          cells += cf_coupled_has(l, p);
          if (q->united[q->label[p]] >= 0) q->cells[q->united[q->label[p]]] += 1;
        }
  q->widest = 0;
  for (int v = 1; v < q->count; ++v)
    if (q->cells[v] > q->cells[q->widest]) q->widest = v;
  q->single = q->count == 1 && q->cells[0] == (double)cells;
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k) {
      bool plain = true;
      CF_TILE_RUNS (l, v, run)
        for (ptrdiff_t p = cf_box_at(&l->box, run->low, j, k), end = p + run->high - run->low; p < end; ++p)
          plain = plain && (!cf_coupled_has(l, p) || q->united[q->label[p]] == q->widest);
      q->plain[j + (ptrdiff_t)l->box.n[1] * k] = plain;
    }
  return CF_OK;
}

cf_status cf_pockets_find(cf_pockets *q, const cf_coupled *l, const bool loose) {
  q->count = 0;
  q->all = false;
  if (q->label == NULL) {
    void *pages;
    CF_TRY(cf_pages_reserve(&pages, (size_t)l->box.size * sizeof *q->label, l->tiles == NULL));
    q->label = (int32_t *)pages + l->box.first;
  } else if (l->tiles != NULL) {
    cf_tiles_follow_bytes(l->tiles, q->followed, q->label, sizeof *q->label);
  }
  if (l->tiles != NULL) q->followed = l->tiles->updates;
  q->labels = 0;
  CF_TRY(make_room(q, 1));
  q->united[q->labels++] = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        CF_TRY(make_room(q, run->high - run->low));
        label_run(q, l, run, cf_box_at(&l->box, 0, j, k));
      }
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) unite_run(q, l, run, (int[]){0, j, k});
  CF_TRY(number_pockets(q, l, loose));
  return count_cells(q, l);
}

/* --- means -------------------------------------------------------------------------------------------- */

/* Adds to 8 lanes what f is where a cell has an equation. */
CF_CLONES static void add_run(const int n, const float *inverse, const cf_real *f,
                              double lane[CF_SUM_LANES]) {
  cf_eight sum = CF_EIGHT_OF_DOUBLES(lane);
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) {
    const cf_eight_bits has = (cf_eight_bits)(CF_EIGHT_OF_FLOATS(inverse + i) > 0);
    sum += (cf_eight)((cf_eight_bits)CF_EIGHT_OF(f + i) & has);
  }
  memcpy(lane, &sum, sizeof sum);
  for (int m = 0; i < n; ++i, ++m) lane[m] += inverse[i] > 0 ? (double)f[i] : 0;
}

CF_CLONES static void shift_run(const int n, const float *inverse, const double by, cf_real *f) {
  if (inverse == NULL) {
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) f[i] = (cf_real)((double)f[i] - by);
    return;
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) f[i] = inverse[i] > 0 ? (cf_real)((double)f[i] - by) : f[i];
}

/* Cells from p on, before `end`, that have the label of cell p: a run of them has one pocket. */
static ptrdiff_t alike(const int32_t *label, const ptrdiff_t p, const ptrdiff_t end) {
  ptrdiff_t to = p + 1;
  while (to < end && label[to] == label[p]) ++to;
  return to;
}

/* What rows of the widest pocket sum to. */
static void sum_rows(const cf_pockets *q, const cf_coupled *l, const cf_cell f) {
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k) {
      double lane[CF_SUM_LANES] = {0};
      if (!q->plain[j + (ptrdiff_t)l->box.n[1] * k]) continue;
      double *sum = &q->rows[j + (ptrdiff_t)l->box.n[1] * k];
      if (q->all) {
        *sum = cf_sweep_row_sum(l->box.n[0], f.at + cf_box_at(&l->box, 0, j, k));
        continue;
      }
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        add_run(run->high - run->low, l->inverse + p, f.at + p, lane);
      }
      *sum = cf_sum_lanes(lane);
    }
}

/* The rows of other pockets are summed run by run; all are added in the order of rows, whatever tiles they are on. */
static void sum_up(const cf_pockets *q, const cf_coupled *l, const cf_cell f) {
  sum_rows(q, l, f);
  for (int v = 0; v < q->count; ++v) q->sum[v] = 0;
  for (int k = l->low[2]; k < l->high[2]; ++k)
    for (int j = l->low[1]; j < l->high[1]; ++j) {
      const cf_tile_row *row = cf_coupled_row_at(l, j, k);
      const ptrdiff_t number = j + (ptrdiff_t)l->box.n[1] * k, at = cf_box_at(&l->box, 0, j, k);
      if (row == NULL) continue;
      if (q->plain[number]) q->sum[q->widest] += q->rows[number];
      for (ptrdiff_t r = row->run; r < row->run_end && !q->plain[number]; ++r)
        for (ptrdiff_t p = at + l->run[r].low, to; p < at + l->run[r].high; p = to) {
          to = alike(q->label, p, at + l->run[r].high);
          const int32_t pocket = q->united[q->label[p]];
          double sum = 0;
          for (ptrdiff_t c = p; c < to && pocket >= 0; ++c) sum += (double)f.at[c];
          if (pocket >= 0) q->sum[pocket] += sum;
        }
    }
}

/* How far a pocket is from the mean kept, or from 0. */
static double excess_of(const cf_pockets *q, const int32_t pocket, const bool kept) {
  return q->sum[pocket] / q->cells[pocket] - (kept ? q->mean[pocket] : 0);
}

/* f -= (sum - kept)/cells on every pocket. */
static void shift(const cf_pockets *q, const cf_coupled *l, const bool kept, const cf_cell f) {
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t row = cf_box_at(&l->box, 0, j, k), end = row + run->high;
        ptrdiff_t p = row + run->low;
        if (q->plain[j + (ptrdiff_t)l->box.n[1] * k]) {
          shift_run(run->high - run->low, q->all ? NULL : l->inverse + p, excess_of(q, q->widest, kept),
                    f.at + p);
          continue;
        }
        for (ptrdiff_t to; p < end; p = to) {
          to = alike(q->label, p, end);
          const int32_t pocket = q->united[q->label[p]];
          if (pocket < 0) continue;
          const double by = excess_of(q, pocket, kept);
          for (ptrdiff_t c = p; c < to; ++c) f.at[c] = (cf_real)((double)f.at[c] - by);
        }
      }
}

void cf_pockets_lift(const cf_coupled *l, const double amount, const cf_cell f) {
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        shift_run(run->high - run->low, l->inverse + p, -amount, f.at + p);
      }
}

void cf_pockets_remove_means(const cf_pockets *q, const cf_coupled *l, const cf_cell f) {
  if (q->count == 0) return;
  sum_up(q, l, f);
  shift(q, l, false, f);
}

void cf_pockets_keep_means(const cf_pockets *q, const cf_coupled *l, const cf_cell f) {
  if (q->count == 0) return;
  sum_up(q, l, f);
  for (int v = 0; v < q->count; ++v) q->mean[v] = q->sum[v] / q->cells[v];
}

void cf_pockets_restore_means(const cf_pockets *q, const cf_coupled *l, const cf_cell f) {
  if (q->count == 0) return;
  sum_up(q, l, f);
  shift(q, l, true, f);
}

void cf_pockets_take_mean(const cf_pockets *q, const double sum) { q->mean[0] = sum / q->cells[0]; }

void cf_pockets_restore_mean(const cf_pockets *q, const cf_coupled *l, const double sum, const cf_cell f) {
  q->sum[0] = sum;
  if (excess_of(q, 0, true) != 0) shift(q, l, true, f);
}

void cf_pockets_ask_means(const cf_pockets *q, const cf_coupled *l, const double alpha, const cf_cell b) {
  if (q->count == 0) return;
  sum_up(q, l, b);
  for (int v = 0; v < q->count; ++v) q->mean[v] = q->sum[v] / q->cells[v] / alpha;
}

void cf_pockets_level_out(const cf_pockets *q, const cf_coupled *l, float *e) {
  for (int v = 0; v < q->count; ++v) q->sum[v] = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t row = cf_box_at(&l->box, 0, j, k);
        for (ptrdiff_t p = row + run->low; p < row + run->high; ++p) {
          const int32_t pocket = q->united[q->label[p]];
          if (pocket >= 0) q->sum[pocket] += (double)e[p];
        }
      }
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const ptrdiff_t row = cf_box_at(&l->box, 0, j, k);
        for (ptrdiff_t p = row + run->low; p < row + run->high; ++p) {
          const int32_t pocket = q->united[q->label[p]];
          if (pocket >= 0) e[p] = (float)((double)e[p] - q->sum[pocket] / q->cells[pocket]);
        }
      }
}
