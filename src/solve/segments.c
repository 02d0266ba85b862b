/* SPDX-License-Identifier: MIT
 *
 * Rows are looked at in blocks of 2 CF_SEGMENT_STEP cells, a bit a block: first whether all or some of a block's cells
 * are inside, then, from the bits of the rows around, what is plain. "Around" reaches as far as a coarse cell and its
 * neighbours do, so that in a plain segment restriction and interpolation are those of the whole box as well.
 */
#include "solve/segments.h"

#include <stdint.h>
#include <string.h>

#include "base/mem.h"

enum { BLOCK = 2 * CF_SEGMENT_STEP, BITS = 64 };

/* Elements of a half that a plain segment has at least, where the row has as many. */
enum { PLAIN_LEAST = 4 * CF_SEGMENT_STEP };

/* While segments are found. */
typedef struct finding {
  cf_segments *g;
  const cf_split *s;
  const cf_region *r;
  int words;            /* a row */
  uint64_t *all, *some; /* of every row of the box */
} finding;

void cf_segments_destroy(cf_segments *g) {
  cf_free(g->first);
  cf_free(g->number);
  cf_free(g->segment);
  cf_free(g->inverse);
  cf_free(g->faces);
  cf_free(g->held);
  for (int a = 0; a < 3; ++a) cf_free(g->weight[a]);
  *g = (cf_segments){0};
}

/* --- bits --------------------------------------------------------------------------------------------- */

static bool is_inside(const finding *f, const unsigned char *row, int i) {
  const int n = f->s->n[0];
  if (i < 0 || i >= n) {
    if (!f->s->plain->axis[0].periodic) return true;
    i = (i + n) % n;
  }
  return row[i] == CF_CELL_INSIDE;
}

/* Cells inside among `count`. */
CF_CLONES static int count_inside(const unsigned char *kind, const int count) {
  int sum = 0;
  CF_ROW_LOOP
  for (int i = 0; i < count; ++i) sum += kind[i] == CF_CELL_INSIDE;
  return sum;
}

/* Bits of the blocks that meet cells [low, high) of a row. */
static void look_at(const finding *f, const int low, const int high, const int j, const int k) {
  const unsigned char *kind = f->r->kind + cf_box_at(&f->r->grid.box, 0, j, k);
  const ptrdiff_t word = cf_segments_row(f->s, j, k) * f->words;
  for (int block = low / BLOCK; block * BLOCK < high; ++block) {
    const int i = block * BLOCK, end = CF_MIN(i + BLOCK, f->s->n[0]);
    const int inside = count_inside(kind + i, end - i);
    if (inside == 0) continue;
    const uint64_t bit = (uint64_t)1 << (block % BITS);
    f->some[word + block / BITS] |= bit;
    if (inside == end - i && is_inside(f, kind, i - 1) && is_inside(f, kind, i - 2) &&
        is_inside(f, kind, end) && is_inside(f, kind, end + 1))
      f->all[word + block / BITS] |= bit;
  }
}

static void look_at_all(const finding *f) {
  const cf_tiles *t = f->r->tiles;
  if (t == NULL) {
#pragma omp parallel for schedule(static) num_threads(f->s->threads)
    for (ptrdiff_t row = 0; row < (ptrdiff_t)f->s->n[1] * f->s->n[2]; ++row)
      look_at(f, 0, f->s->n[0], (int)(row % f->s->n[1]), (int)(row / f->s->n[1]));
    return;
  }
  CF_PARALLEL_TILES (t, f->s->threads, v)
    CF_TILE_ROWS (t, v, j, k)
      CF_TILE_RUNS (t, v, run) look_at(f, run->low, run->high, j, k);
}

/* Row j of axis a as far as it exists, around the seam where there is one; -1: beyond a wall. */
static int row_in(const cf_split *s, const int a, const int j) {
  if (j >= 0 && j < s->n[a]) return j;
  return s->plain->axis[a].periodic ? (j + s->n[a]) % s->n[a] : -1;
}

/* The plain blocks among those of a word of row (j, k): all inside in the coarse row to which the row belongs and
 * in the coarse rows around it. */
static uint64_t plain_of(const finding *f, const int j, const int k, const int word) {
  uint64_t plain = f->all[cf_segments_row(f->s, j, k) * f->words + word];
  const bool deep = f->s->dim == 3;
  for (int K = deep ? k - k % 2 - 2 : 0; K < (deep ? k - k % 2 + 4 : 1) && plain != 0; ++K)
    for (int J = j - j % 2 - 2; J < j - j % 2 + 4; ++J) {
      const int jj = row_in(f->s, 1, J), kk = deep ? row_in(f->s, 2, K) : 0;
      if (jj >= 0 && kk >= 0) plain &= f->all[cf_segments_row(f->s, jj, kk) * f->words + word];
    }
  return plain;
}

/* --- segments ----------------------------------------------------------------------------------------- */

static cf_status grow(cf_segments *g) {
  if (g->count < g->room) return CF_OK;
  cf_segment *more;
  CF_TRY(CF_NEW(&more, 2 * g->room + 1024));
  if (g->count > 0) memcpy(more, g->segment, (size_t)g->count * sizeof *more);
  cf_free(g->segment);
  g->segment = more;
  g->room = 2 * g->room + 1024;
  return CF_OK;
}

/* First and last cell inside. */
static void trim(const finding *f, const int j, const int k, cf_segment *q) {
  const unsigned char *kind = f->r->kind + cf_box_at(&f->r->grid.box, 0, j, k);
  q->low = 2 * q->from;
  q->high = CF_MIN(2 * q->to, f->s->n[0]);
  while (kind[q->low] != CF_CELL_INSIDE) ++q->low;
  while (kind[q->high - 1] != CF_CELL_INSIDE) --q->high;
}

/* Short plain segments beside others are not worth a kernel of their own: they become edge segments, joined with those next to
 * them. */
static void absorb(cf_segments *g, const ptrdiff_t begun, const int width) {
  ptrdiff_t kept = begun;
  for (ptrdiff_t v = begun; v < g->count; ++v) {
    cf_segment q = g->segment[v];
    if (q.table < 0 && q.to - q.from < CF_MIN(PLAIN_LEAST, width)) q.table = 0;
    cf_segment *before = kept > begun ? &g->segment[kept - 1] : NULL;
    if (before != NULL && before->to == q.from && before->table == q.table)
      before->to = q.to;
    else
      g->segment[kept++] = q;
  }
  g->count = kept;
}

static cf_status make_row(const finding *f, const int j, const int k) {
  cf_segments *g = f->g;
  const ptrdiff_t row = cf_segments_row(f->s, j, k), begun = g->count;
  g->first[row] = g->count;
  for (int word = 0; word < f->words; ++word) {
    const uint64_t some = f->some[row * f->words + word], plain = some != 0 ? plain_of(f, j, k, word) : 0;
    for (uint64_t bits = some; bits != 0; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits), from = (word * BITS + bit) * CF_SEGMENT_STEP;
      const bool is_plain = plain >> bit & 1;
      cf_segment *before = g->count > begun ? &g->segment[g->count - 1] : NULL;
      if (before != NULL && before->to == from && (before->table < 0) == is_plain) {
        before->to += CF_SEGMENT_STEP;
        continue;
      }
      CF_TRY(grow(g));
      g->segment[g->count++] =
          (cf_segment){.from = from, .to = from + CF_SEGMENT_STEP, .table = is_plain ? -1 : 0};
    }
  }
  absorb(g, begun, f->s->width);
  g->number[row] = g->rows;
  g->rows += g->count > begun;
  for (ptrdiff_t v = begun; v < g->count; ++v) {
    trim(f, j, k, &g->segment[v]);
    if (g->segment[v].table < 0) continue;
    g->segment[v].table = g->elements;
    g->elements += 2 * (g->segment[v].to - g->segment[v].from);
  }
  if (g->count == begun) return CF_OK;
  const int at[3] = {0, j, k};
  for (int a = 1; a < 3; ++a) {
    g->low[a] = CF_MIN(g->low[a], at[a]);
    g->high[a] = CF_MAX(g->high[a], at[a] + 1);
  }
  return CF_OK;
}

static cf_status make_segments(const finding *f) {
  cf_segments *g = f->g;
  g->count = g->rows = g->elements = 0;
  for (int a = 0; a < 3; ++a) g->low[a] = f->s->n[a], g->high[a] = 0;
  for (int k = 0; k < f->s->n[2]; ++k)
    for (int j = 0; j < f->s->n[1]; ++j) CF_TRY(make_row(f, j, k));
  g->first[(ptrdiff_t)f->s->n[1] * f->s->n[2]] = g->count;
  return CF_OK;
}

/* --- tables ------------------------------------------------------------------------------------------- */

static cf_status make_room(cf_segments *g) {
  if (g->elements <= g->elements_room) return CF_OK;
  const ptrdiff_t room = g->elements + g->elements / 4;
  g->elements_room = 0;
  unsigned char **bytes[] = {&g->faces, &g->held, &g->weight[0], &g->weight[1], &g->weight[2]};
  cf_free(g->inverse);
  g->inverse = NULL;
  CF_TRY(CF_NEW(&g->inverse, room));
  for (int v = 0; v < 5; ++v) {
    cf_free(*bytes[v]);
    *bytes[v] = NULL;
    CF_TRY(CF_NEW(bytes[v], room));
  }
  g->elements_room = room;
  return CF_OK;
}

/* Cell i of a row: its faces, one by one. */
static void fill_cell(const finding *f, const int at[3], const ptrdiff_t entry) {
  const cf_segments *g = f->g;
  const cf_split *s = f->s;
  const cf_box *b = &f->r->grid.box;
  const ptrdiff_t p = cf_box_at(b, at[0], at[1], at[2]);
  g->inverse[entry] = 0;
  g->faces[entry] = g->held[entry] = 0;
  for (int a = 0; a < 3; ++a) g->weight[a][entry] = 0;
  if (at[0] >= s->n[0] || f->r->kind[p] != CF_CELL_INSIDE) return;
  int faces = CF_FACES_INSIDE, open = 0, held = 0;
  for (int a = 0; a < s->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const int next = at[a] + (side ? 1 : -1), n = s->n[a];
      const cf_axis *axis = &s->plain->axis[a];
      if ((next < 0 || next >= n) && !axis->periodic) {
        held += axis->held[side] ? 2 : 0;
        continue;
      }
      const int kind = f->r->kind[p + ((next + n) % n - at[a]) * b->stride[a]];
      if (kind == CF_CELL_INSIDE) {
        faces |= 1 << (2 * a + side);
        ++open;
      } else if (kind != CF_CELL_WALL) {
        held += 2;
      }
    }
  const float diagonal = s->alpha + (float)(open + held) * s->coupling;
  g->faces[entry] = (unsigned char)faces;
  g->held[entry] = (unsigned char)(held + CF_HELD_COUNT * (open + held));
  g->inverse[entry] = diagonal > 0 ? 1 / diagonal : 0;
}

static void fill_tables(const finding *f) {
  cf_segments *g = f->g;
  const cf_split *s = f->s;
  int any = 0;
#pragma omp parallel for schedule(static) num_threads(s->threads) reduction(| : any)
  for (int k = g->low[2]; k < g->high[2]; ++k)
    for (int j = g->low[1]; j < g->high[1]; ++j) {
      const ptrdiff_t row = cf_segments_row(s, j, k);
      for (ptrdiff_t v = g->first[row]; v < g->first[row + 1]; ++v) {
        const cf_segment *q = &g->segment[v];
        if (q->table < 0) continue;
        for (int i = 2 * q->from; i < 2 * q->to; ++i) {
          const ptrdiff_t entry = cf_segment_entry(q, i & 1, i / 2);
          fill_cell(f, (int[]){i, j, k}, entry);
          any |= g->held[entry] & CF_HELD_MASK;
        }
      }
    }
  g->any_held = any != 0;
}

static cf_status find(finding *f) {
  const ptrdiff_t rows = (ptrdiff_t)f->s->n[1] * f->s->n[2];
  f->words = (f->s->n[0] + BLOCK * BITS - 1) / (BLOCK * BITS);
  if (f->g->first == NULL) {
    CF_TRY(CF_NEW(&f->g->first, rows + 1));
    CF_TRY(CF_NEW(&f->g->number, rows));
  }
  CF_TRY(CF_NEW(&f->all, rows * f->words));
  CF_TRY(CF_NEW(&f->some, rows * f->words));
  look_at_all(f);
  CF_TRY(make_segments(f));
  CF_TRY(make_room(f->g));
  fill_tables(f);
  return CF_OK;
}

cf_status cf_segments_find(cf_segments *g, const cf_split *s, const cf_region *r) {
  finding f = {.g = g, .s = s, .r = r};
  g->cells = r->inside;
  const cf_status status = find(&f);
  if (status != CF_OK) g->rows = 0;
  cf_free(f.all);
  cf_free(f.some);
  return status;
}

/* --- use ---------------------------------------------------------------------------------------------- */

void cf_segments_clear(const cf_segments *g, const cf_split *s) {
  for (int k = g->low[2]; k < g->high[2]; ++k)
    for (int j = g->low[1]; j < g->high[1]; ++j) {
      const ptrdiff_t row = cf_segments_row(s, j, k), at = j * s->row + k * s->plane;
      for (ptrdiff_t v = g->first[row]; v < g->first[row + 1]; ++v)
        for (int parity = 0; parity < 2; ++parity) {
          const cf_segment *q = &g->segment[v];
          const ptrdiff_t from = at + (parity ? s->odd : 0) + q->from - 1;
          memset(s->e + from, 0, (size_t)(q->to - q->from + 2) * sizeof(float));
          memset(s->r + from, 0, (size_t)(q->to - q->from + 2) * sizeof(float));
        }
    }
}

const cf_segment *cf_segments_at(const cf_segments *g, const cf_split *s, const int j, const int k,
                                 const int m) {
  const ptrdiff_t row = cf_segments_row(s, j, k);
  for (ptrdiff_t v = g->first[row]; v < g->first[row + 1]; ++v)
    if (m >= g->segment[v].from && m < g->segment[v].to) return &g->segment[v];
  return NULL;
}
