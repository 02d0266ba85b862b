/* SPDX-License-Identifier: MIT */
#include "solve/matching.h"

#include <string.h>

#include "base/mem.h"

/* What two grids may leave: clusters are matched up to this (clusters.h). Seven-point Laplacians of equal couplings have 6. */
#define KAPPA 8.0f
/* Where that leaves more than a fourth of the nodes, a 2.5th in the plane, as it does where the neighbours of many nodes are all
 * taken, it is done again, so often at most, with a bound that many times larger. */
#define MORE       3
#define KAPPA_MORE 2.0f
#define LEFT_3D    0.25
#define LEFT_2D    0.4
/* Where alpha and known values have so large a share of the diagonal, smoothing does. */
#define HELD_FAST 0.25f
/* A level that has more of the one above is not worth having. */
#define LEAST_GAIN 0.7

/* --- the graph that is matched ------------------------------------------------------------------------ */

/* Nodes are the cells of l, by where they are in the box, or unknowns of `of`. */
typedef struct graph {
  const cf_coupled *l;
  const cf_cluster_level *of;
  bool periodic;
} graph;

typedef struct edges {
  int count;
  const int32_t *to;
  const float *c;
  int32_t own_to[6];
  float own_c[6];
} edges;

static void edges_of_cell(const graph *g, const ptrdiff_t p, edges *e) {
  const cf_coupled *l = g->l;
  int at[3] = {1, 1, 1}, count = 0;
  if (g->periodic) cf_coupled_place(&l->box, p, at);
  for (int a = 0; a < l->dim; ++a) {
    const ptrdiff_t s = l->box.stride[a], around = (l->box.n[a] - 1) * s;
    const float low = l->c[a][p], high = l->c[a][p + s];
    if (low > 0) {
      e->own_to[count] = (int32_t)(l->periodic[a] && at[a] == 0 ? p + around : p - s);
      e->own_c[count++] = low;
    }
    if (high > 0) {
      e->own_to[count] = (int32_t)(l->periodic[a] && at[a] == l->box.n[a] - 1 ? p - around : p + s);
      e->own_c[count++] = high;
    }
  }
  e->count = count;
  e->to = e->own_to;
  e->c = e->own_c;
}

static void edges_of(const graph *g, const int32_t node, edges *e) {
  if (g->of == NULL) {
    edges_of_cell(g, node, e);
    return;
  }
  const int32_t from = g->of->start[node];
  e->count = g->of->start[node + 1] - from;
  e->to = g->of->to + from;
  e->c = g->of->c + from;
}

static float fixed_of(const graph *g, const int32_t node) {
  return g->of == NULL ? g->l->free[node] + g->l->held[node] : g->of->fixed[node];
}

static float inverse_of(const graph *g, const int32_t node) {
  return g->of == NULL ? g->l->inverse[node] : g->of->inverse[node];
}

/* --- groups ------------------------------------------------------------------------------------------- */

/* Nodes in groups of at most `width`: node[width g], ... of group g, then -1. */
typedef struct groups {
  graph of;
  int32_t n;
  int width;
  int32_t *node;
  float *diagonal, *fixed; /* sums over nodes; the latter with couplings to nodes in no group */
  int32_t *group;          /* of a node, and 1; 0: in none. Of cells: at their places, in pages */
  size_t bytes;            /* of these */
  int32_t *number;         /* of a group: where it was last met among another's neighbours */
  int32_t *met;            /* neighbours of a group, */
  float *through;          /* and couplings with them */
  int32_t room;
} groups;

static void groups_clear(groups *s) {
  cf_free(s->node);
  cf_free(s->diagonal);
  cf_free(s->fixed);
  if (s->group != NULL) cf_pages_release(s->group - (s->of.of == NULL ? s->of.l->box.first : 0), s->bytes);
  cf_free(s->number);
  cf_free(s->met);
  cf_free(s->through);
  *s = (groups){0};
}

static cf_status more_room(groups *s) {
  const int32_t room = 2 * s->room + 64;
  int32_t *met;
  float *through;
  CF_TRY(CF_NEW(&met, room));
  if (s->room > 0) memcpy(met, s->met, (size_t)s->room * sizeof *met);
  cf_free(s->met);
  s->met = met;
  CF_TRY(CF_NEW(&through, room));
  if (s->room > 0) memcpy(through, s->through, (size_t)s->room * sizeof *through);
  cf_free(s->through);
  s->through = through;
  s->room = room;
  return CF_OK;
}

/* The groups that g is coupled to, in the order they are met in, into met and through. */
static cf_status find_neighbours(groups *s, const int32_t g, int32_t *count) {
  *count = 0;
  for (int v = 0; v < s->width; ++v) {
    const int32_t node = s->node[(ptrdiff_t)s->width * g + v];
    edges e;
    if (node < 0) break;
    edges_of(&s->of, node, &e);
    for (int q = 0; q < e.count; ++q) {
      const int32_t h = s->group[e.to[q]] - 1;
      if (h < 0 || h == g) continue;
      const int32_t at = s->number[h];
      if (at < *count && s->met[at] == h) {
        s->through[at] += e.c[q];
        continue;
      }
      if (*count == s->room) CF_TRY(more_room(s));
      s->number[h] = *count;
      s->met[*count] = h;
      s->through[(*count)++] = e.c[q];
    }
  }
  return CF_OK;
}

static void add_node(groups *s, const int32_t node) {
  const float inverse = inverse_of(&s->of, node);
  if (!(inverse > 0) || fixed_of(&s->of, node) * inverse >= HELD_FAST) return;
  s->node[s->n++] = node;
  s->group[node] = s->n;
}

/* Cells in the order of the box, whatever tiles there are. */
static void add_cells(groups *s) {
  const cf_coupled *l = s->of.l;
  for (int k = 0; k < l->box.n[2]; ++k)
    for (int j = 0; j < l->box.n[1]; ++j) {
      const cf_tile_row *row = cf_coupled_row_at(l, j, k);
      for (ptrdiff_t q = row != NULL ? row->run : 0; row != NULL && q < row->run_end; ++q)
        for (int i = l->run[q].low; i < l->run[q].high; ++i)
          add_node(s, (int32_t)cf_box_at(&l->box, i, j, k));
    }
}

/* Each node that is not held fast, by itself. */
static cf_status groups_begin(groups *s) {
  const cf_coupled *l = s->of.l;
  const cf_part all = cf_coupled_all(l);
  const ptrdiff_t most = s->of.of != NULL ? s->of.of->n : cf_part_cells(&all);
  void *pages;
  s->bytes = (size_t)(s->of.of != NULL ? most : l->box.size) * sizeof *s->group;
  CF_TRY(cf_pages_reserve(&pages, s->bytes, s->of.of != NULL || l->tiles == NULL));
  s->group = (int32_t *)pages + (s->of.of != NULL ? 0 : l->box.first);
  s->width = 1;
  CF_TRY(CF_NEW(&s->node, most));
  CF_TRY(CF_NEW(&s->diagonal, most));
  CF_TRY(CF_NEW(&s->fixed, most));
  CF_TRY(CF_NEW(&s->number, most));
  if (s->of.of == NULL)
    add_cells(s);
  else
    for (int32_t u = 0; u < s->of.of->n; ++u) add_node(s, u);
  for (int32_t g = 0; g < s->n; ++g) {
    edges e;
    float fixed = fixed_of(&s->of, s->node[g]);
    edges_of(&s->of, s->node[g], &e);
    for (int q = 0; q < e.count; ++q)
      if (s->group[e.to[q]] == 0) fixed += e.c[q];
    s->fixed[g] = fixed;
    s->diagonal[g] = 1 / inverse_of(&s->of, s->node[g]);
  }
  return CF_OK;
}

/* --- matching ----------------------------------------------------------------------------------------- */

/* What two grids leave if g and h are matched, at most. */
static float bound_of(const groups *s, const int32_t g, const int32_t h, const float c) {
  const float f = s->fixed[g], i = s->fixed[h], D = s->diagonal[g], E = s->diagonal[h];
  return 2 * D * E / ((D + E) * (c + (f + i > 0 ? f * i / (f + i) : 0)));
}

/* mate[g]: the group that g is matched with, or itself. */
static cf_status match(groups *s, const float kappa, int32_t *mate) {
  for (int32_t g = 0; g < s->n; ++g) mate[g] = -1;
  for (int32_t g = 0; g < s->n; ++g) {
    int32_t count, best = g;
    float least = kappa;
    if (mate[g] >= 0) continue;
    CF_TRY(find_neighbours(s, g, &count));
    for (int32_t q = 0; q < count; ++q) {
      const int32_t h = s->met[q];
      if (mate[h] >= 0) continue;
      const float bound = bound_of(s, g, h, s->through[q]);
      if (bound < 0.999f * least) least = bound, best = h;
    }
    mate[g] = best;
    mate[best] = g;
  }
  return CF_OK;
}

/* Makes one group of each pair; each is where the first of its two was. */
static void merge(groups *s, const int32_t *mate, int32_t *node) {
  const int width = s->width;
  int32_t n = 0;
  for (int32_t g = 0; g < s->n; ++g) {
    const int32_t h = mate[g];
    if (h < g) continue;
    int32_t *to = node + (ptrdiff_t)2 * width * n;
    int count = 0;
    for (int part = 0; part < 1 + (h > g); ++part)
      for (int v = 0; v < width; ++v) {
        const int32_t q = s->node[(ptrdiff_t)width * (part ? h : g) + v];
        if (q < 0) break;
        to[count++] = q;
      }
    if (count < 2 * width) to[count] = -1;
    const float diagonal = s->diagonal[g] + (h > g ? s->diagonal[h] : 0);
    const float fixed = s->fixed[g] + (h > g ? s->fixed[h] : 0);
    s->diagonal[n] = diagonal; /* n <= g: what is overwritten has been read */
    s->fixed[n] = fixed;
    ++n;
  }
  s->n = n;
  s->width = 2 * width;
  for (int32_t g = 0; g < n; ++g)
    for (int v = 0; v < 2 * width && node[(ptrdiff_t)2 * width * g + v] >= 0; ++v)
      s->group[node[(ptrdiff_t)2 * width * g + v]] = g + 1;
}

static cf_status match_once(groups *s, const float kappa) {
  int32_t *mate, *node, pairs = 0;
  CF_TRY(CF_NEW(&mate, s->n));
  cf_status status = match(s, kappa, mate);
  for (int32_t g = 0; g < s->n && status == CF_OK; ++g) pairs += mate[g] >= g;
  if (status == CF_OK) status = CF_NEW(&node, (ptrdiff_t)2 * s->width * pairs);
  if (status == CF_OK) {
    merge(s, mate, node);
    cf_free(s->node);
    s->node = node;
  }
  cf_free(mate);
  return status;
}

/* --- the level ---------------------------------------------------------------------------------------- */

void cf_matching_clear(cf_cluster_level *q) {
  void *arrays[] = {q->start, q->to,    q->later, q->c, q->fixed, q->inverse, q->first,
                    q->child, q->order, q->e,     q->r, q->rest,  q->u,       q->Au};
  for (size_t v = 0; v < sizeof arrays / sizeof *arrays; ++v) cf_free(arrays[v]);
  *q = (cf_cluster_level){0};
}

/* Room for `more` couplings behind the first `count`. */
static cf_status couplings_room(cf_cluster_level *q, const int32_t count, const int32_t more, int32_t *room) {
  if (count + more <= *room) return CF_OK;
  const int32_t next = *room + *room / 2 + more;
  int32_t *to;
  float *c;
  CF_TRY(CF_NEW(&to, next));
  if (count > 0) memcpy(to, q->to, (size_t)count * sizeof *to);
  cf_free(q->to);
  q->to = to;
  CF_TRY(CF_NEW(&c, next));
  if (count > 0) memcpy(c, q->c, (size_t)count * sizeof *c);
  cf_free(q->c);
  q->c = c;
  *room = next;
  return CF_OK;
}

static cf_status take_couplings(cf_cluster_level *q, groups *s) {
  int32_t room = 0, count = 0, met;
  CF_TRY(couplings_room(q, 0, 9 * q->n + 16, &room));
  for (int32_t u = 0; u < q->n; ++u) {
    CF_TRY(find_neighbours(s, u, &met));
    CF_TRY(couplings_room(q, count, met, &room));
    float sum = s->fixed[u];
    q->start[u] = count;
    for (int32_t v = 0; v < met; ++v) {
      q->to[count] = s->met[v];
      q->c[count++] = s->through[v];
      sum += s->through[v];
    }
    q->fixed[u] = s->fixed[u];
    q->inverse[u] = sum > 0 ? 1 / sum : 0;
  }
  q->start[q->n] = count;
  return CF_OK;
}

static cf_status take_children(cf_cluster_level *q, const groups *s) {
  int32_t count = 0;
  for (int32_t u = 0; u < q->n; ++u)
    for (int v = 0; v < s->width && s->node[(ptrdiff_t)s->width * u + v] >= 0; ++v) ++count;
  CF_TRY(CF_NEW(&q->child, count));
  count = 0;
  for (int32_t u = 0; u < q->n; ++u) {
    q->first[u] = count;
    for (int v = 0; v < s->width && s->node[(ptrdiff_t)s->width * u + v] >= 0; ++v)
      q->child[count++] = s->node[(ptrdiff_t)s->width * u + v];
  }
  q->first[q->n] = count;
  return CF_OK;
}

/* Neighbours in two parts: those that a sweep forth meets before u, and those that it meets later. */
static void part_neighbours(cf_cluster_level *q, const unsigned char *colour) {
  for (int32_t u = 0; u < q->n; ++u) {
    int32_t low = q->start[u], high = q->start[u + 1];
    while (low < high) {
      const int32_t v = q->to[low];
      const float c = q->c[low];
      if (colour[v] < colour[u] || (colour[v] == colour[u] && v < u)) {
        ++low;
        continue;
      }
      --high;
      q->to[low] = q->to[high], q->c[low] = q->c[high];
      q->to[high] = v, q->c[high] = c;
    }
    q->later[u] = low;
  }
}

/* Each unknown has the first colour that no neighbour with a lower number has; the last one is for all that are left. */
static cf_status find_colours(cf_cluster_level *q) {
  unsigned char *colour;
  CF_TRY(CF_NEW(&colour, q->n));
  for (int32_t u = 0; u < q->n; ++u) {
    uint32_t taken = 0;
    for (int32_t v = q->start[u]; v < q->start[u + 1]; ++v)
      if (q->to[v] < u) taken |= UINT32_C(1) << colour[q->to[v]];
    int mine = 0;
    while (mine < CF_CLUSTER_COLOURS_MAX - 1 && (taken >> mine & 1)) ++mine;
    colour[u] = (unsigned char)mine;
    ++q->colour[mine + 1];
    q->colours = CF_MAX(q->colours, mine + 1);
  }
  for (int v = 0; v < q->colours; ++v) q->colour[v + 1] += q->colour[v];
  int32_t at[CF_CLUSTER_COLOURS_MAX];
  memcpy(at, q->colour, sizeof at);
  for (int32_t u = 0; u < q->n; ++u) q->order[at[colour[u]]++] = u;
  part_neighbours(q, colour);
  cf_free(colour);
  return CF_OK;
}

static cf_status take(cf_cluster_level *q, groups *s) {
  q->n = s->n;
  CF_TRY(CF_NEW(&q->start, q->n + 1));
  CF_TRY(CF_NEW(&q->later, q->n));
  CF_TRY(CF_NEW(&q->first, q->n + 1));
  CF_TRY(CF_NEW(&q->order, q->n));
  float **field[] = {&q->fixed, &q->inverse, &q->e, &q->r, &q->rest, &q->u, &q->Au};
  for (int v = 0; v < 7; ++v) CF_TRY(CF_NEW(field[v], q->n));
  CF_TRY(take_couplings(q, s));
  CF_TRY(take_children(q, s));
  return find_colours(q);
}

cf_status cf_matching_make(cf_cluster_level *coarse, const cf_coupled *l, const cf_cluster_level *of,
                           const int times) {
  groups s = {.of = {l, of, l->periodic[0] || l->periodic[1] || l->periodic[2]}};
  *coarse = (cf_cluster_level){0};
  cf_status status = groups_begin(&s);
  const int32_t nodes = s.n;
  float kappa = KAPPA;
  for (int v = 0; v < times && status == CF_OK && s.n > 0; ++v) status = match_once(&s, kappa);
  const double left = l->dim == 3 ? LEFT_3D : LEFT_2D;
  for (int v = 0; v < MORE && status == CF_OK && s.n > left * nodes; ++v)
    status = match_once(&s, kappa *= KAPPA_MORE);
  if (status == CF_OK && s.n > 0 && s.n <= LEAST_GAIN * nodes) status = take(coarse, &s);
  groups_clear(&s);
  return status;
}
