/* SPDX-License-Identifier: MIT
 *
 * Rows are looked at in blocks of CF_SEGMENT_CELLS cells, a bit a block: first whether all or some of a block's cells
 * are inside, then, from the bits of the rows around, what is regular. "Around" reaches as far as a coarse cell and its
 * neighbours do, so that in a regular block restriction and interpolation are those of the whole box as well.
 */
#include "solve/segments.h"

#include <limits.h>
#include <string.h>

#include "base/mem.h"
#include "solve/wave.h"

enum { BLOCK = CF_SEGMENT_CELLS, BITS = 64 };

/* While segments are found. */
typedef struct finding {
  cf_segments *g;
  const cf_split *s;
  const cf_region *r;
  int words;            /* a row */
  uint64_t *all, *some; /* of every row of the box */
} finding;

static void list_destroy(cf_segment_list *l) {
  cf_free(l->first);
  cf_free(l->at);
}

void cf_segments_destroy(cf_segments *g) {
  list_destroy(&g->all);
  list_destroy(&g->edges);
  cf_free(g->number);
  cf_free(g->table);
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

/* The regular blocks among those of a word of row (j, k): all inside in the coarse row to which the row belongs and
 * in the coarse rows around it. */
static uint64_t regular_of(const finding *f, const int j, const int k, const int word) {
  uint64_t regular = f->all[cf_segments_row(f->s, j, k) * f->words + word];
  const bool deep = f->s->dim == 3;
  for (int K = deep ? k - k % 2 - 2 : 0; K < (deep ? k - k % 2 + 4 : 1) && regular != 0; ++K)
    for (int J = j - j % 2 - 2; J < j - j % 2 + 4; ++J) {
      const int jj = row_in(f->s, 1, J), kk = deep ? row_in(f->s, 2, K) : 0;
      if (jj >= 0 && kk >= 0) regular &= f->all[cf_segments_row(f->s, jj, kk) * f->words + word];
    }
  return regular;
}

/* --- segments ----------------------------------------------------------------------------------------- */

static cf_status append(cf_segment_list *l, const cf_segment q) {
  if (l->count == l->room) {
    const ptrdiff_t room = 2 * l->room + 4096;
    cf_segment *more;
    CF_TRY(CF_NEW(&more, room));
    if (l->count > 0) memcpy(more, l->at, (size_t)l->count * sizeof *more);
    cf_free(l->at);
    l->at = more;
    l->room = room;
  }
  l->at[l->count++] = q;
  return CF_OK;
}

/* The walls that place i of axis a meets, as bits of a regular table's number. */
static int walls_at(const cf_split *s, const int a, const int i) {
  if (a >= s->dim || s->plain->axis[a].periodic) return 0;
  return (i == 0 ? 1 : 0) << (2 * a) | (i == s->n[a] - 1 ? 2 : 0) << (2 * a);
}

/* The same for the block that begins at element `from` of the halves. */
static int regular_table(const cf_split *s, const int from, const int j, const int k) {
  const int low = from == 0 && !s->plain->axis[0].periodic, high = 2 * from + BLOCK >= s->n[0] ? 2 : 0;
  return low | high | walls_at(s, 1, j) | walls_at(s, 2, k);
}

/* The blocks of a word that some row has that belongs to the same coarse row as (j, k) and comes before it. */
static uint64_t before(const finding *f, const int j, const int k, const int word) {
  const bool deep = f->s->dim == 3;
  uint64_t bits = 0;
  for (int kk = deep ? k - k % 2 : k; kk <= k; ++kk)
    for (int jj = j - j % 2; jj < j - j % 2 + 2 && (kk < k || jj < j); ++jj)
      if (jj < f->s->n[1]) bits |= f->some[cf_segments_row(f->s, jj, kk) * f->words + word];
  return bits;
}

/* What is known of a block. NEAR: it is not regular, or the one before or behind it is not. */
enum { REGULAR = 1, NEAR = 2, FIRST = 4 };

static cf_status make_segment(const finding *f, const int j, const int k, const int from, const int block) {
  const cf_split *s = f->s;
  cf_segments *g = f->g;
  const ptrdiff_t place = (j * s->row + k * s->plane + from) / CF_SEGMENT;
  const int bits = ((j + k) & 1 ? CF_PLACE_PARITY : 0) | (block & FIRST ? CF_PLACE_FIRST : 0);
  const cf_segment q = {.place = (uint32_t)(4 * place + bits),
                        .table = block & REGULAR ? regular_table(s, from, j, k) : (int32_t)g->tables};
  g->tables += block & REGULAR ? 0 : 1;
  CF_TRY(append(&g->all, q));
  return block & NEAR ? append(&g->edges, q) : CF_OK;
}

/* Pieces of a row up to that of element `from` begin where the lists are now. */
static void begin_pieces(cf_segments *g, const ptrdiff_t row, const int from, int *begun) {
  for (; *begun <= CF_MIN(from / CF_WAVE_COLUMN, g->pieces - 1); ++*begun) {
    g->all.first[row * g->pieces + *begun] = g->all.count;
    g->edges.first[row * g->pieces + *begun] = g->edges.count;
  }
}

static cf_status make_row(const finding *f, const int j, const int k) {
  cf_segments *g = f->g;
  const ptrdiff_t row = cf_segments_row(f->s, j, k), count = g->all.count;
  int begun = 0;
  for (int word = 0; word < f->words; ++word) {
    const uint64_t some = f->some[row * f->words + word];
    if (some == 0) continue;
    const uint64_t regular = regular_of(f, j, k, word), later = before(f, j, k, word), own = some & ~regular;
    const uint64_t near = own | own << 1 | own >> 1; /* not from word to word */
    for (uint64_t bits = some; bits != 0; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits), from = (word * BITS + bit) * CF_SEGMENT;
      begin_pieces(g, row, f->s->dim == 3 ? 0 : from, &begun);
      CF_TRY(make_segment(f, j, k, from,
                          (regular >> bit & 1 ? REGULAR : 0) | (near >> bit & 1 ? NEAR : 0) |
                              (later >> bit & 1 ? 0 : FIRST)));
    }
  }
  begin_pieces(g, row, INT_MAX, &begun);
  g->number[row] = g->rows;
  if (g->all.count == count) return CF_OK;
  ++g->rows;
  const int at[3] = {0, j, k};
  for (int a = 1; a < 3; ++a) {
    g->low[a] = CF_MIN(g->low[a], at[a]);
    g->high[a] = CF_MAX(g->high[a], at[a] + 1);
  }
  return CF_OK;
}

static cf_status make_segments(const finding *f) {
  cf_segments *g = f->g;
  const ptrdiff_t ends = (ptrdiff_t)f->s->n[1] * f->s->n[2] * g->pieces;
  g->all.count = g->edges.count = g->rows = 0;
  g->tables = CF_REGULAR_TABLES;
  for (int a = 0; a < 3; ++a) g->low[a] = f->s->n[a], g->high[a] = 0;
  for (int k = 0; k < f->s->n[2]; ++k)
    for (int j = 0; j < f->s->n[1]; ++j) CF_TRY(make_row(f, j, k));
  g->all.first[ends] = g->all.count;
  g->edges.first[ends] = g->edges.count;
  return CF_OK;
}

/* --- tables ------------------------------------------------------------------------------------------- */

static cf_status make_room(cf_segments *g) {
  if (g->tables <= g->tables_room) return CF_OK;
  const ptrdiff_t room = g->tables + g->tables / 4;
  cf_free(g->table);
  g->table = NULL;
  g->tables_room = 0;
  CF_TRY(CF_NEW(&g->table, room));
  g->tables_room = room;
  return CF_OK;
}

/* A cell inside, with so many open faces, and known values that add so much to its diagonal. */
static void fill_inside(const cf_split *s, const int faces, const int open, const int held, const int lane,
                        cf_segment_table *t) {
  const float diagonal = s->alpha + (float)(open + held) * s->coupling;
  t->faces[lane] = (unsigned char)(faces | CF_FACES_INSIDE);
  t->held[lane] = (unsigned char)(held + CF_HELD_COUNT * (open + held));
  t->inverse[lane] = diagonal > 0 ? 1 / diagonal : 0;
}

/* A cell at those walls, in the middle of cells inside. Along an axis an even cell is interpolated from the coarse one below as
 * well, an odd one from that above. */
static void fill_regular(const cf_split *s, const int walls, const int i, cf_segment_table *t) {
  int faces = 0, open = 0, held = 0;
  for (int a = 0; a < s->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (!(walls >> (2 * a + side) & 1)) {
        faces |= 1 << (2 * a + side);
        ++open;
      } else if (s->plain->axis[a].held[side]) {
        held += 2;
      }
    }
  const int lane = cf_lane_of(i);
  fill_inside(s, faces | CF_FACES_TRANSFER, open, held, lane, t);
  t->weight[0][lane] = walls >> (i & 1) & 1 ? 0 : CF_LINEAR;
}

static void fill_regular_tables(const finding *f) {
  const cf_split *s = f->s;
  const int rest = (s->n[0] - 1) % BLOCK + 1; /* cells of the last vector of a row */
  for (int v = 0; v < CF_REGULAR_TABLES; ++v) {
    const int last = v & 2 ? rest : BLOCK;
    f->g->table[v] = (cf_segment_table){.high = last};
    for (int i = 0; i < last; ++i) {
      int walls = v & ~3;
      if (v & 1 && i == 0) walls |= 1;
      if (v & 2 && i == last - 1) walls |= walls_at(s, 0, s->n[0] - 1) & 2;
      fill_regular(s, walls, i, &f->g->table[v]);
    }
  }
}

/* Cell i of a row: its faces, one by one. */
static void fill_cell(const finding *f, const int at[3], cf_segment_table *t) {
  const cf_split *s = f->s;
  const cf_box *b = &f->r->grid.box;
  if (at[0] >= s->n[0]) return;
  const ptrdiff_t p = cf_box_at(b, at[0], at[1], at[2]);
  if (f->r->kind[p] != CF_CELL_INSIDE) return;
  int faces = 0, open = 0, held = 0;
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
  fill_inside(s, faces, open, held, cf_lane_of(at[0]), t);
}

/* The table of a segment's own. Returns whether known values hold any of its cells. */
static int fill_table(const finding *f, const int from, const int j, const int k, cf_segment_table *t) {
  int any = 0;
  *t = (cf_segment_table){.low = BLOCK};
  for (int i = 0; i < BLOCK; ++i) {
    const int lane = cf_lane_of(i);
    fill_cell(f, (int[]){from + i, j, k}, t);
    any |= t->held[lane] & CF_HELD_MASK;
    if (!(t->faces[lane] & CF_FACES_INSIDE)) continue;
    t->low = CF_MIN(t->low, i);
    t->high = i + 1;
  }
  return any;
}

static void fill_tables(const finding *f) {
  cf_segments *g = f->g;
  const cf_split *s = f->s;
  int any = 0;
  fill_regular_tables(f);
#pragma omp parallel for schedule(static) num_threads(s->threads) reduction(| : any)
  for (int k = g->low[2]; k < g->high[2]; ++k)
    for (int j = g->low[1]; j < g->high[1]; ++j) {
      CF_FOR_ROW_SEGMENTS (g, &g->edges, s, j, k, q)
        if (q->table >= CF_REGULAR_TABLES)
          any |= fill_table(f, cf_segment_cell(s, q, j, k), j, k, &g->table[q->table]);
    }
  g->any_held = any != 0;
}

static cf_status lists_create(cf_segments *g, const cf_split *s) {
  const ptrdiff_t rows = (ptrdiff_t)s->n[1] * s->n[2];
  if (g->number != NULL) return CF_OK;
  g->pieces = cf_wave_pieces(s);
  CF_TRY(CF_NEW(&g->all.first, rows * g->pieces + 1));
  CF_TRY(CF_NEW(&g->edges.first, rows * g->pieces + 1));
  return CF_NEW(&g->number, rows);
}

static cf_status find(finding *f) {
  const ptrdiff_t rows = (ptrdiff_t)f->s->n[1] * f->s->n[2];
  f->words = (f->s->n[0] + BLOCK * BITS - 1) / (BLOCK * BITS);
  CF_TRY(lists_create(f->g, f->s));
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
  for (ptrdiff_t v = 0; v < g->all.count; ++v)
    for (int parity = 0; parity < 2; ++parity) {
      const ptrdiff_t from = cf_segment_at(&g->all.at[v]) + (parity ? s->odd : 0) - 1;
      memset(s->e + from, 0, (CF_SEGMENT + 2) * sizeof(float));
      memset(s->r + from, 0, (CF_SEGMENT + 2) * sizeof(float));
    }
}

cf_segment_table *cf_segments_table_at(const cf_segments *g, const cf_split *s, const int at[3]) {
  const cf_segment *found = NULL;
  CF_FOR_ROW_SEGMENTS (g, &g->all, s, at[1], at[2], q)
    if (cf_segment_cell(s, q, at[1], at[2]) == at[0] / BLOCK * BLOCK) found = q;
  return &g->table[found->table];
}
