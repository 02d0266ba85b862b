/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "grid/tiles.h"

#include <string.h>
#include <sys/mman.h>

#include "base/mem.h"

#define PAGE 4096

/* --- making ------------------------------------------------------------------------------------------- */

static int log_of(const int power) {
  int s = 0;
  while (1 << s < power) ++s;
  return 1 << s == power ? s : -1;
}

static cf_status shape(cf_tiles *t, const cf_box *b, const int edge[3]) {
  const int usual[2][3] = {{16, 16, 1}, {16, 8, 8}};
  t->box = *b;
  for (int a = 0; a < 3; ++a) {
    t->edge[a] = edge != NULL && a < b->dim ? edge[a] : usual[b->dim - 2][a];
    t->shift[a] = log_of(t->edge[a]);
    if (t->shift[a] < 0 || (a == 0 && t->edge[0] < CF_SUM_LANES))
      return cf_fail(CF_BAD_ARGUMENT,
                     "tiles of %d cells along axis %d: must be a power of two, along x at least %d",
                     t->edge[a], a, CF_SUM_LANES);
    t->n[a] = (b->n[a] + t->edge[a] - 1) >> t->shift[a];
  }
  t->words = (t->n[0] + 63) / 64;
  return CF_OK;
}

static size_t pages_of(const cf_tiles *t, const int log_size) {
  return ((size_t)t->box.size << log_size) / PAGE + 2;
}

static cf_status allocate(cf_tiles *t) {
  const ptrdiff_t rows = (ptrdiff_t)t->n[1] * t->n[2], words = rows * t->words;
  CF_TRY(CF_NEW(&t->active, words));
  CF_TRY(CF_NEW(&t->seen, words));
  CF_TRY(CF_NEW(&t->left, words));
  CF_TRY(CF_NEW(&t->asked, rows));
  CF_TRY(CF_NEW(&t->pending, rows));
  CF_TRY(CF_NEW(&t->changed, rows));
  CF_TRY(CF_NEW(&t->row, rows));
  for (int v = 0; v < 4; ++v) CF_TRY(CF_NEW(&t->users[v], pages_of(t, v)));
  return CF_OK;
}

cf_status cf_tiles_create(cf_tiles **tiles, const cf_box *b, const int edge[3]) {
  *tiles = NULL;
  cf_tiles *t;
  CF_TRY(CF_NEW(&t, 1));
  cf_status s = shape(t, b, edge);
  if (s == CF_OK) s = allocate(t);
  if (s != CF_OK) {
    cf_tiles_destroy(t);
    return s;
  }
  *tiles = t;
  return CF_OK;
}

void cf_tiles_destroy(cf_tiles *t) {
  if (t == NULL) return;
  cf_free(t->active);
  cf_free(t->seen);
  cf_free(t->left);
  cf_free(t->asked);
  cf_free(t->pending);
  cf_free(t->changed);
  cf_free(t->row);
  cf_free(t->run);
  for (int v = 0; v < 4; ++v) cf_free(t->users[v]);
  cf_free(t);
}

static cf_status small_pages(const cf_box *b, cf_real **at) {
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)b->size * sizeof(cf_real), false));
  *at = (cf_real *)pages + b->first;
  return CF_OK;
}

cf_status cf_tiles_cell_create(const cf_tiles *t, cf_cell *f) {
  f->at = NULL;
  return small_pages(&t->box, &f->at);
}

cf_status cf_tiles_face_create(const cf_tiles *t, cf_face *f) {
  *f = (cf_face){{NULL, NULL, NULL}};
  for (int a = 0; a < t->box.dim; ++a) {
    const cf_status s = small_pages(&t->box, &f->at[a]);
    if (s != CF_OK) {
      cf_face_destroy(f, &t->box);
      return s;
    }
  }
  return CF_OK;
}

/* --- the set ------------------------------------------------------------------------------------------ */

static uint64_t *ask(cf_tiles *t, const int ti, const ptrdiff_t row) {
  if (!t->asked[row]) {
    t->asked[row] = true;
    t->pending[t->pendings++] = row;
  }
  return &t->active[row * t->words + ti / 64];
}

static ptrdiff_t row_of(const cf_tiles *t, const int tj, const int tk) {
  return (ptrdiff_t)tk * t->n[1] + tj;
}

void cf_tiles_add(cf_tiles *t, const int ti, const int tj, const int tk) {
  if (!cf_tiles_has(t, ti, tj, tk)) *ask(t, ti, row_of(t, tj, tk)) |= (uint64_t)1 << (ti % 64);
}

void cf_tiles_drop(cf_tiles *t, const int ti, const int tj, const int tk) {
  if (cf_tiles_has(t, ti, tj, tk)) *ask(t, ti, row_of(t, tj, tk)) &= ~((uint64_t)1 << (ti % 64));
}

void cf_tiles_add_box(cf_tiles *t, const int low[3], const int high[3]) {
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    const int first = CF_MAX(low[a], 0), end = CF_MIN(high[a], t->box.n[a]);
    if (first >= end) return;
    from[a] = first >> t->shift[a];
    to[a] = ((end - 1) >> t->shift[a]) + 1;
  }
  for (int tk = from[2]; tk < to[2]; ++tk)
    for (int tj = from[1]; tj < to[1]; ++tj)
      for (int ti = from[0]; ti < to[0]; ++ti) cf_tiles_add(t, ti, tj, tk);
}

void cf_tiles_add_cell(cf_tiles *t, const int i, const int j, const int k, const int margin) {
  const int deep = t->box.dim == 3 ? margin : 0;
  const int low[3] = {i - margin, j - margin, k - deep};
  const int high[3] = {i + margin + 1, j + margin + 1, k + deep + 1};
  cf_tiles_add_box(t, low, high);
}

void cf_tiles_drop_all(cf_tiles *t) {
  for (ptrdiff_t r = 0; r < (ptrdiff_t)t->n[1] * t->n[2]; ++r)
    for (int w = 0; w < t->words; ++w)
      if (t->active[r * t->words + w] != 0) *ask(t, 64 * w, r) = 0;
}

ptrdiff_t cf_tiles_cells(const cf_tiles *t) {
  ptrdiff_t cells = 0;
  for (ptrdiff_t r = 0; r < t->rows; ++r) {
    const cf_tile_row *row = &t->row[r];
    const ptrdiff_t lines = (ptrdiff_t)(row->j_end - row->j) * (row->k_end - row->k);
    for (ptrdiff_t v = row->run; v < row->run_end; ++v) cells += lines * (t->run[v].high - t->run[v].low);
  }
  return cells;
}

/* --- the update --------------------------------------------------------------------------------------- */

/* The next tile >= ti whose bit in a row of words is `bit`; n[0] if there is none. */
static int next_bit(const cf_tiles *t, const uint64_t *word, int ti, const bool bit) {
  while (ti < t->n[0]) {
    const uint64_t rest = (bit ? word[ti / 64] : ~word[ti / 64]) >> (ti % 64);
    if (rest != 0) return CF_MIN(ti + __builtin_ctzll(rest), t->n[0]);
    ti = (ti / 64 + 1) * 64;
  }
  return t->n[0];
}

static ptrdiff_t count_runs(const cf_tiles *t) {
  ptrdiff_t runs = 0;
  for (ptrdiff_t r = 0; r < (ptrdiff_t)t->n[1] * t->n[2]; ++r) {
    const uint64_t *word = t->active + r * t->words;
    for (int w = 0; w < t->words; ++w) { /* bits that begin a run */
      const uint64_t before = word[w] << 1 | (w > 0 ? word[w - 1] >> 63 : 0);
      runs += __builtin_popcountll(word[w] & ~before);
    }
  }
  return runs;
}

/* A tile's rows of cells come to use their pages (step 1), or no longer do (-1). */
static void count_users(cf_tiles *t, const int ti, const ptrdiff_t r, const int step) {
  const cf_box *b = &t->box;
  const int i = ti << t->shift[0], i_end = CF_MIN(i + t->edge[0], b->n[0]);
  const int j0 = (int)(r % t->n[1]) << t->shift[1], k0 = (int)(r / t->n[1]) << t->shift[2];
  for (int k = k0; k < CF_MIN(k0 + t->edge[2], b->n[2]); ++k)
    for (int j = j0; j < CF_MIN(j0 + t->edge[1], b->n[1]); ++j) {
      const size_t at = (size_t)(b->first + cf_box_at(b, i, j, k)), end = at + (size_t)(i_end - i);
      for (int v = 0; v < 4; ++v)
        for (size_t page = (at << v) / PAGE; page <= ((end << v) - 1) / PAGE; ++page)
          t->users[v][page] = (uint16_t)(t->users[v][page] + step);
    }
}

static void take_changes(cf_tiles *t, const ptrdiff_t r) {
  bool any = false;
  for (int w = 0; w < t->words; ++w) {
    const ptrdiff_t at = r * t->words + w;
    const uint64_t entered = t->active[at] & ~t->seen[at], left = t->seen[at] & ~t->active[at];
    for (uint64_t bits = entered; bits != 0; bits &= bits - 1)
      count_users(t, 64 * w + __builtin_ctzll(bits), r, 1);
    for (uint64_t bits = left; bits != 0; bits &= bits - 1)
      count_users(t, 64 * w + __builtin_ctzll(bits), r, -1);
    t->count += __builtin_popcountll(entered) - __builtin_popcountll(left);
    t->left[at] = left;
    t->seen[at] = t->active[at];
    any = any || (entered | left) != 0;
  }
  if (any) t->changed[t->changes++] = r;
}

static void make_runs(cf_tiles *t) {
  t->rows = t->runs = 0;
  for (ptrdiff_t r = 0; r < (ptrdiff_t)t->n[1] * t->n[2]; ++r) {
    const uint64_t *word = t->seen + r * t->words;
    int ti = next_bit(t, word, 0, true);
    if (ti == t->n[0]) continue;
    cf_tile_row *row = &t->row[t->rows++];
    row->j = (int)(r % t->n[1]) << t->shift[1];
    row->k = (int)(r / t->n[1]) << t->shift[2];
    row->j_end = CF_MIN(row->j + t->edge[1], t->box.n[1]);
    row->k_end = CF_MIN(row->k + t->edge[2], t->box.n[2]);
    row->run = t->runs;
    while (ti < t->n[0]) {
      const int end = next_bit(t, word, ti, false);
      t->run[t->runs++] = (cf_run){ti << t->shift[0], CF_MIN(end << t->shift[0], t->box.n[0])};
      ti = next_bit(t, word, end, true);
    }
    row->run_end = t->runs;
  }
}

cf_status cf_tiles_update(cf_tiles *t) {
  const ptrdiff_t runs = t->pendings > 0 ? count_runs(t) : 0;
  if (runs > t->room) {
    cf_run *more;
    CF_TRY(CF_NEW(&more, 2 * runs));
    cf_free(t->run);
    t->run = more;
    t->room = 2 * runs;
  }
  for (ptrdiff_t v = 0; v < t->changes; ++v)
    memset(t->left + t->changed[v] * t->words, 0, (size_t)t->words * sizeof *t->left);
  t->changes = 0;
  for (ptrdiff_t v = 0; v < t->pendings; ++v) {
    take_changes(t, t->pending[v]);
    t->asked[t->pending[v]] = false;
  }
  t->pendings = 0;
  ++t->updates;
  if (t->changes > 0) make_runs(t);
  return CF_OK;
}

/* --- giving back -------------------------------------------------------------------------------------- */

/* Pages in a row that nobody uses, gathered so that they are given back at once. */
typedef struct idle {
  char *low, *high;
} idle;

static void give_back(idle *p) {
  if (p->high > p->low) madvise(p->low, (size_t)(p->high - p->low), MADV_DONTNEED);
  p->low = p->high = NULL;
}

/* Bytes [from, to) of a field that starts at `pages`: cleared, or given back with their page. */
static void clear_bytes(const uint16_t *users, char *pages, size_t from, const size_t to, idle *p) {
  while (from < to) {
    const size_t page = from / PAGE, end = CF_MIN(to, (page + 1) * PAGE);
    char *start = pages + page * PAGE;
    if (users[page] > 0) {
      memset(pages + from, 0, end - from);
    } else if (start >= p->low && start < p->high) {
      /* gathered already */
    } else {
      if (start != p->high) {
        give_back(p);
        p->low = start;
      }
      p->high = start + PAGE;
    }
    from = end;
  }
}

void cf_tiles_retire_bytes(const cf_tiles *t, void *at, const size_t element) {
  const cf_box *b = &t->box;
  const int v = log_of((int)element);
  char *pages = (char *)at - (size_t)b->first * element;
  idle p = {NULL, NULL};
  for (ptrdiff_t c = 0; c < t->changes; ++c) {
    const ptrdiff_t r = t->changed[c];
    const uint64_t *left = t->left + r * t->words;
    const int j0 = (int)(r % t->n[1]) << t->shift[1], k0 = (int)(r / t->n[1]) << t->shift[2];
    for (int ti = next_bit(t, left, 0, true); ti < t->n[0];) {
      const int end = next_bit(t, left, ti, false);
      const int i = ti << t->shift[0], i_end = CF_MIN(end << t->shift[0], b->n[0]);
      for (int k = k0; k < CF_MIN(k0 + t->edge[2], b->n[2]); ++k)
        for (int j = j0; j < CF_MIN(j0 + t->edge[1], b->n[1]); ++j) {
          const size_t from = (size_t)(b->first + cf_box_at(b, i, j, k)) * element;
          clear_bytes(t->users[v], pages, from, from + (size_t)(i_end - i) * element, &p);
        }
      ti = next_bit(t, left, end, true);
    }
  }
  give_back(&p);
}

void cf_tiles_follow_bytes(const cf_tiles *t, const int64_t since, void *at, const size_t element) {
  if (since == t->updates) return;
  if (since == t->updates - 1)
    cf_tiles_retire_bytes(t, at, element);
  else
    madvise((char *)at - (size_t)t->box.first * element, (size_t)t->box.size * element, MADV_DONTNEED);
}

void cf_tiles_retire_cell(const cf_tiles *t, const cf_cell f) {
  cf_tiles_retire_bytes(t, f.at, sizeof(cf_real));
}

void cf_tiles_retire_face(const cf_tiles *t, const cf_face f) {
  for (int a = 0; a < t->box.dim; ++a) cf_tiles_retire_bytes(t, f.at[a], sizeof(cf_real));
}

/* --- sums --------------------------------------------------------------------------------------------- */

/* Goes through the rows of cells that active tiles have, in the order of their places: [at, end) is the next piece. Rows
 * of tiles first ... last - 1 lie beside each other and share their layers, of which k is one. */
typedef struct walk {
  const cf_tiles *t;
  ptrdiff_t first, last, row;
  int k;
  ptrdiff_t at, end;
} walk;

static void find_piece(walk *w) {
  const cf_tile_row *row = &w->t->row[w->row];
  w->at = row->j + (ptrdiff_t)w->k * w->t->box.n[1];
  w->end = w->at + row->j_end - row->j;
}

/* Begins with the rows of tiles from `first` on. */
static void enter_layers(walk *w) {
  const cf_tiles *t = w->t;
  w->row = w->last = w->first;
  w->at = w->end = PTRDIFF_MAX;
  if (w->first == t->rows) return;
  w->k = t->row[w->first].k;
  while (w->last < t->rows && t->row[w->last].k == w->k) ++w->last;
  find_piece(w);
}

static void next_piece(walk *w) {
  if (++w->row == w->last) {
    if (++w->k == w->t->row[w->first].k_end) {
      w->first = w->last;
      enter_layers(w);
      return;
    }
    w->row = w->first;
  }
  find_piece(w);
}

static double sum_of(walk *w, const double *v, const ptrdiff_t from, const ptrdiff_t n) {
  if (w->at >= from + n) return 0;
  if (n > 8) {
    const double low = sum_of(w, v, from, n / 2);
    return low + sum_of(w, v, from + n / 2, n - n / 2);
  }
  double sum = 0;
  while (w->at < from + n) {
    for (; w->at < CF_MIN(w->end, from + n); ++w->at) sum += v[w->at];
    if (w->at == w->end) next_piece(w);
  }
  return sum;
}

double cf_tiles_sum_rows(const cf_tiles *t, const double *v) {
  walk w = {.t = t};
  enter_layers(&w);
  return sum_of(&w, v, 0, cf_box_rows(&t->box));
}
