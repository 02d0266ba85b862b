/* SPDX-License-Identifier: MIT
 *
 * The parallelogram of a flake on the picture is M (u, v), -1 <= u, v <= 1, M = Rot(phi) diag(s_1, s_2) Rot(theta). It is
 * widened to sqrt(s^2 + w^2), with w a part of the distance of the places where it is worked out and at least about half
 * a pixel, and made as much fainter: flakes smaller than that neither flicker nor vanish.
 */
#include "render/cards.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "grid/sweep.h"
#include "render/disc.h"
#include "render/sample.h"

enum { TILE = 64, COPIES_MOST = 400, SIDE_MOST = 8192, STEP_MOST = 4096 };

#define PIXEL_SIGMA 0.5f  /* w is at least this, pixels: tents of the smallest flakes add up to 1 on pixels */
#define NEAREST     0.02f /* of the focus: flakes nearer than that are not seen */
#define SHARP       0.6f  /* a blur of so many pixels is no more than widening does */
#define LETS_BY     0.2f  /* ice lets so much of what is behind through */
#define GLINT_WIDTH 0.16f /* radians */

/* --- textures ---------------------------------------------------------------------------------------------------- */

/* The mean over a square of `in`, which has `side` values a row and `step` numbers each. */
static float mean_over(const float *in, const int side, const int step, const double low[2],
                       const double wide) {
  const int x0 = (int)low[0], x1 = CF_MIN((int)ceil(low[0] + wide), side);
  const int y0 = (int)low[1], y1 = CF_MIN((int)ceil(low[1] + wide), side);
  double sum = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const double part = (CF_MIN(x + 1.0, low[0] + wide) - CF_MAX(x, low[0])) *
                          (CF_MIN(y + 1.0, low[1] + wide) - CF_MAX(y, low[1]));
      sum += part * (double)in[((size_t)y * (size_t)side + (size_t)x) * (size_t)step];
    }
  return (float)(sum / (wide * wide));
}

/* Texel (i, j) of a level; around each level lies a rim of texels that stay empty. */
static float *texel_of(const cf_flake_picture *p, const int level, const int i, const int j) {
  const size_t row = (size_t)(p->side >> level) + 2;
  return p->texel + 4 * (p->start[level] + (size_t)(j + 1) * row + (size_t)(i + 1));
}

/* Every level has half the side of the one before. */
static void coarsen(const cf_flake_picture *p) {
  for (int l = 1; l < p->levels; ++l)
    for (int y = 0; y < p->side >> l; ++y)
      for (int x = 0; x < p->side >> l; ++x)
        for (int c = 0; c < 4; ++c)
          texel_of(p, l, x, y)[c] =
              0.25f * (texel_of(p, l - 1, 2 * x, 2 * y)[c] + texel_of(p, l - 1, 2 * x + 1, 2 * y)[c] +
                       texel_of(p, l - 1, 2 * x, 2 * y + 1)[c] + texel_of(p, l - 1, 2 * x + 1, 2 * y + 1)[c]);
}

cf_status cf_flake_picture_create(cf_flake_picture *p, const int side, const float *cover,
                                  const float *bright, const float (*slope)[2]) {
  *p = (cf_flake_picture){.side = 1};
  if (side < 1 || side > SIDE_MOST)
    return cf_fail(CF_BAD_ARGUMENT, "a flake of %d pixels: must be 1 to %d", side, SIDE_MOST);
  while (2 * p->side <= side) p->side *= 2;
  size_t texels = 0;
  for (int s = p->side; s >= 1; s /= 2) {
    p->start[p->levels++] = texels;
    texels += (size_t)(s + 2) * (size_t)(s + 2);
  }
  CF_TRY(CF_NEW(&p->texel, 4 * texels));
  const double wide = (double)side / p->side;
  for (int y = 0; y < p->side; ++y)
    for (int x = 0; x < p->side; ++x) {
      const double low[2] = {x * wide, y * wide};
      float *t = texel_of(p, 0, x, y);
      t[0] = mean_over(cover, side, 1, low, wide);
      t[1] = t[0] * mean_over(bright, side, 1, low, wide);
      for (int a = 0; a < 2; ++a) t[2 + a] = t[0] * mean_over(&slope[0][a], side, 2, low, wide);
    }
  coarsen(p);
  return CF_OK;
}

void cf_flake_picture_destroy(cf_flake_picture *p) {
  cf_free(p->texel);
  *p = (cf_flake_picture){.texel = NULL};
}

/* --- a flake on the picture ------------------------------------------------------------------------------------------- */

typedef struct sprite {
  float depth, x, y, blur; /* m, pixels */
  float move[2];           /* while the shutter is open, pixels */
  float back[4];           /* from pixels to (u, v): the rows of the inverse of M */
  float reach[2], wide[2]; /* half of what a copy covers, and of what all cover, pixels */
  float narrow, even;      /* shorter axis, and mean, of what is drawn, pixels */
  float faint;             /* part of the light that is left after widening */
  int copies, level;
  int step; /* pixels from one place to the next where it is worked out */
  int64_t card;
} sprite;

/* Widens M = [right up] (columns) and inverts it. */
static void widen(sprite *s, const float m[2][2], const float w) {
  const float e = 0.5f * (m[0][0] + m[1][1]), f = 0.5f * (m[0][0] - m[1][1]);
  const float g = 0.5f * (m[1][0] + m[0][1]), h = 0.5f * (m[1][0] - m[0][1]);
  const float q = sqrtf(e * e + h * h), r = sqrtf(f * f + g * g);
  const float a = atan2f(g, f), b = atan2f(h, e), phi = 0.5f * (b + a), theta = 0.5f * (b - a);
  const float one = q + r, two = q - r;
  const float one_w = sqrtf(one * one + w * w), two_w = copysignf(sqrtf(two * two + w * w), two);
  const float c = cosf(phi), d = sinf(phi), x = cosf(theta), y = sinf(theta);
  /* Rot(-theta) diag(1/s) Rot(-phi) */
  s->back[0] = x * c / one_w - y * d / two_w, s->back[1] = x * d / one_w + y * c / two_w;
  s->back[2] = -y * c / one_w - x * d / two_w, s->back[3] = -y * d / one_w + x * c / two_w;
  s->faint = fabsf(one * two / (one_w * two_w));
  s->narrow = fminf(one_w, fabsf(two_w)), s->even = sqrtf(one_w * fabsf(two_w));
  s->reach[0] = fabsf(c * one_w * x - d * two_w * y) + fabsf(c * one_w * y + d * two_w * x);
  s->reach[1] = fabsf(d * one_w * x + c * two_w * y) + fabsf(d * one_w * y - c * two_w * x);
}

/* false: it cannot be seen. */
static bool sprite_make(sprite *s, const cf_cards *all, const int64_t i, const cf_lens *lens,
                        const float shutter) {
  const cf_card *card = &all->card[i];
  const cf_flake_picture *p = &all->picture[card->picture];
  *s = (sprite){.card = i};
  s->depth = cf_lens_project(lens, card->at, &s->x, &s->y);
  if (!(s->depth > NEAREST * lens->focus)) return false;
  const float scale = cf_lens_scale(lens, s->depth);
  s->blur = cf_lens_blur(lens, s->depth);
  s->move[0] = shutter * scale * cf_vec_dot(card->velocity, lens->right);
  s->move[1] = -shutter * scale * cf_vec_dot(card->velocity, lens->up);
  const float way = sqrtf(s->move[0] * s->move[0] + s->move[1] * s->move[1]);
  for (s->step = 1; s->step < STEP_MOST && 6 * (float)s->step <= s->blur;) s->step *= 2;
  s->copies = (int)fminf(1 + 1.3f * way / (float)s->step, COPIES_MOST);
  const float gap = way / (float)s->copies, apart = fmaxf((float)s->step, gap);
  const float w = fmaxf(PIXEL_SIGMA * (float)s->step, 0.6f * gap);
  const float m[2][2] = {
      {scale * cf_vec_dot(card->right, lens->right), scale * cf_vec_dot(card->up, lens->right)},
      {-scale * cf_vec_dot(card->right, lens->up), -scale * cf_vec_dot(card->up, lens->up)}};
  widen(s, m, w);
  /* Its texels are as wide as the places, or the copies, are apart. */
  const float texels = (float)p->side / (2 * (apart > 1 ? s->narrow : s->even)) * fmaxf(1, apart);
  /* Texels a little finer than pixels look sharper; of a flake of few texels they would miss pixels. */
  const float finer = apart > 1 || 8 * texels > (float)p->side ? 0 : 0.6f;
  s->level = (int)fminf(fmaxf(ceilf(log2f(fmaxf(texels, 1)) - finer), 0), (float)(p->levels - 1));
  const float more = 1 + 1 / (float)(p->side >> s->level); /* a texel lies across the edge */
  for (int a = 0; a < 2; ++a) s->wide[a] = more * s->reach[a] + s->blur + 0.5f * fabsf(s->move[a]) + 1;
  return s->x + s->wide[0] > 0 && s->y + s->wide[1] > 0 && s->x - s->wide[0] < (float)lens->width &&
         s->y - s->wide[1] < (float)lens->height && s->blur < (float)lens->height && s->faint > 0;
}

/* The place of copy k, at its moment while the shutter is open. */
static void copy_offset(const sprite *s, const int k, float off[2]) {
  const float time = ((float)k + 0.5f) / (float)s->copies - 0.5f;
  for (int a = 0; a < 2; ++a) off[a] = time * s->move[a];
}

/* --- drawing one into a tile --------------------------------------------------------------------------------------------- */

/* Places every `step` pixels, which all tiles share: (i0 + i, j0 + j), each at pixel (i0 + i) step. */
typedef struct places {
  int step, i0, j0, n, rows;
  ptrdiff_t row; /* from one row to the next */
  float (*at)[4];
} places;

/* Places across a tile at most, and more at both of their ends that the lens brings in: its radius is below 6 steps. */
enum { ACROSS = TILE + 2, AROUND = 7 };

typedef struct patch {
  int x0, y0, x1, y1; /* pixels of the tile that the sprite touches */
  places seen;
  float drawn[(ACROSS + 2 * AROUND) * (ACROSS + 2 * AROUND + 1)][4], soft[ACROSS * ACROSS][4];
} patch;

static void patch_begin(patch *b, const sprite *s, const int tile[4]) {
  b->x0 = CF_MAX((int)floorf(s->x - s->wide[0]), tile[0]);
  b->y0 = CF_MAX((int)floorf(s->y - s->wide[1]), tile[1]);
  b->x1 = CF_MIN((int)ceilf(s->x + s->wide[0]) + 1, tile[2]);
  b->y1 = CF_MIN((int)ceilf(s->y + s->wide[1]) + 1, tile[3]);
  b->seen = (places){.step = s->step};
  if (b->x0 >= b->x1 || b->y0 >= b->y1) return;
  const int more = s->step > 1 ? 1 : 0;
  b->seen.i0 = b->x0 / s->step, b->seen.j0 = b->y0 / s->step;
  b->seen.n = (b->x1 - 1) / s->step - b->seen.i0 + 1 + more;
  b->seen.rows = (b->y1 - 1) / s->step - b->seen.j0 + 1 + more;
}

/* A texel's four numbers, which are always treated alike. */
typedef float four __attribute__((vector_size(16)));

static inline four load(const float *at) {
  four v;
  memcpy(&v, at, sizeof v);
  return v;
}

CF_CLONES static void add_copy(const sprite *s, const cf_flake_picture *p, const float off[2],
                               const places *b) {
  const float x = s->x + off[0] - 0.5f, y = s->y + off[1] - 0.5f, part = s->faint / (float)s->copies;
  const int side = p->side >> s->level;
  const ptrdiff_t row = 4 * ((ptrdiff_t)side + 2);
  const float more = 1 + 0.999f / (float)side, wide = (float)b->step, half = 0.5f * (float)side;
  const int i0 = CF_MAX((int)ceilf((x - more * s->reach[0]) / wide) - b->i0, 0);
  const int i1 = CF_MIN((int)floorf((x + more * s->reach[0]) / wide) - b->i0 + 1, b->n);
  const int j0 = CF_MAX((int)ceilf((y - more * s->reach[1]) / wide) - b->j0, 0);
  const int j1 = CF_MIN((int)floorf((y + more * s->reach[1]) / wide) - b->j0 + 1, b->rows);
  const float *corner = texel_of(p, s->level, 0, 0);
  for (int j = j0; j < j1; ++j)
    for (int i = i0; i < i1; ++i) {
      const float dx = (float)((b->i0 + i) * b->step) - x, dy = (float)((b->j0 + j) * b->step) - y;
      const float u = s->back[0] * dx + s->back[1] * dy, v = s->back[2] * dx + s->back[3] * dy;
      if (fabsf(u) >= more || fabsf(v) >= more) continue;
      const float tx = half * (u + 1) + 0.5f, ty = half * (1 - v) + 0.5f; /* from texel -1, so >= 0 */
      const int m = (int)tx, n = (int)ty;
      const float *t = corner + row * (n - 1) + 4 * (ptrdiff_t)(m - 1);
      const float a = tx - (float)m, c = ty - (float)n, far = part * c, near = part - far;
      const four above = (1 - a) * load(t) + a * load(t + 4);
      const four below = (1 - a) * load(t + row) + a * load(t + row + 4);
      float *out = b->at[j * b->row + i];
      const four sum = load(out) + (near * above + far * below);
      memcpy(out, &sum, sizeof sum);
    }
}

/* All copies. */
static void draw(const sprite *s, const cf_flake_picture *p, const places *b) {
  memset(b->at, 0, (size_t)b->row * (size_t)b->rows * sizeof b->at[0]);
  for (int k = 0; k < s->copies; ++k) {
    float off[2];
    copy_offset(s, k, off);
    add_copy(s, p, off, b);
  }
}

/* As the lens shows it. */
static void patch_draw(patch *b, const sprite *s, const cf_flake_picture *p) {
  const float r = s->blur / (float)s->step;
  places wide = b->seen;
  wide.at = b->drawn, wide.row = wide.n;
  if (s->blur > SHARP) {
    const int m = cf_disc_margin(r);
    wide.i0 -= m, wide.j0 -= m, wide.n += 2 * m, wide.rows += 2 * m, wide.row = wide.n + 1;
    draw(s, p, &wide);
    cf_disc_blur(b->drawn, b->seen.n, b->seen.rows, r, b->soft);
    b->seen.at = b->soft;
  } else {
    draw(s, p, &wide);
    b->seen.at = b->drawn;
  }
  b->seen.row = b->seen.n;
}

/* The value at a pixel, between the places. */
static void patch_at(const places *b, const int x, const int y, float t[4]) {
  const int i = x / b->step - b->i0, j = y / b->step - b->j0;
  const float *one = b->at[j * b->row + i];
  for (int m = 0; m < 4; ++m) t[m] = one[m];
  if (b->step == 1) return;
  const float a = (float)(x % b->step) / (float)b->step, c = (float)(y % b->step) / (float)b->step;
  const float *two = b->at[(j + 1) * b->row + i];
  for (int m = 0; m < 4; ++m) {
    const float above = one[m] + a * (one[4 + m] - one[m]), below = two[m] + a * (two[4 + m] - two[m]);
    t[m] = above + c * (below - above);
  }
}

/* --- light ----------------------------------------------------------------------------------------------------------------- */

typedef struct shine {
  cf_vec even; /* scattered to all sides */
  cf_vec right, up, normal;
  cf_vec half[CF_LIGHTS];
  float kept; /* what haze leaves */
} shine;

static shine shine_of(const cf_card *card, const cf_cards_light *light, const cf_lens *lens,
                      const float depth) {
  const cf_vec view = cf_vec_unit(cf_vec_sub(lens->eye, card->at));
  shine s = {.right = cf_vec_unit(card->right), .up = cf_vec_unit(card->up)};
  s.normal = cf_vec_unit(cf_vec_cross(card->right, card->up));
  if (cf_vec_dot(s.normal, view) < 0) {
    s.normal = cf_vec_scale(-1, s.normal);
    s.right = cf_vec_scale(-1, s.right), s.up = cf_vec_scale(-1, s.up);
  }
  s.even = cf_vec_scale(0.5f, cf_vec_add(light->sky.zenith, light->sky.horizon));
  for (int l = 0; l < light->lights; ++l) {
    const cf_light *e = &light->light[l];
    s.half[l] = cf_vec_unit(cf_vec_add(view, e->toward));
    s.even = cf_vec_along(s.even, 0.25f + 0.5f * fabsf(cf_vec_dot(s.normal, e->toward)), e->colour);
  }
  s.even = cf_vec_times(s.even, light->tint);
  s.kept = expf(-depth * cf_vec_luminance(light->haze));
  return s;
}

/* What a pixel of the flake sends, for all of its cover. */
static cf_vec sent(const shine *s, const cf_cards_light *light, const float t[4]) {
  cf_vec sum = cf_vec_scale(t[1], s->even);
  const float cover = fmaxf(t[0], 1e-6f);
  const cf_vec tilted =
      cf_vec_unit(cf_vec_along(cf_vec_along(s->normal, -t[2] / cover, s->right), -t[3] / cover, s->up));
  for (int l = 0; l < light->lights; ++l) {
    const float c = cf_vec_dot(tilted, s->half[l]), off = 1 - c * c;
    if (off > 9 * GLINT_WIDTH * GLINT_WIDTH) continue;
    const float glint = light->glint * t[0] * expf(-off / (GLINT_WIDTH * GLINT_WIDTH));
    sum = cf_vec_along(sum, glint, light->light[l].colour);
  }
  return sum;
}

static void lay_over(const sprite *s, const cf_cards *all, const cf_cards_light *light, const cf_lens *lens,
                     const patch *b, cf_film *film) {
  const shine how = shine_of(&all->card[s->card], light, lens, s->depth);
  for (int j = b->y0; j < b->y1; ++j)
    for (int i = b->x0; i < b->x1; ++i) {
      const size_t p = (size_t)j * (size_t)film->width + (size_t)i;
      float t[4];
      patch_at(&b->seen, i, j, t);
      const float open = film->distance[p] < s->depth ? 1 - film->share[p] : 1;
      for (int m = 0; m < 4; ++m) t[m] *= open;
      if (t[0] <= 0) continue;
      const float cover = fminf(t[0], 1), left = 1 - (1 - LETS_BY) * cover;
      const cf_vec fog = cf_vec_scale((1 - how.kept) * (1 - LETS_BY) * cover, light->haze_colour);
      const cf_vec own = cf_vec_along(fog, how.kept, sent(&how, light, t));
      film->light[p] = cf_vec_along(own, left, film->light[p]);
    }
}

static void draw_in_tile(const sprite *s, const cf_cards *all, const cf_cards_light *light,
                         const cf_lens *lens, const int tile[4], patch *b, cf_film *film) {
  patch_begin(b, s, tile);
  if (b->seen.n == 0) return;
  patch_draw(b, s, &all->picture[all->card[s->card].picture]);
  lay_over(s, all, light, lens, b, film);
}

/* --- all of them ------------------------------------------------------------------------------------------------------------- */

/* The far ones first; of equally far ones in their order. */
static int farther(const void *a, const void *b) {
  const sprite *p = a, *q = b;
  if (p->depth != q->depth) return p->depth > q->depth ? -1 : 1;
  return p->card < q->card ? -1 : p->card > q->card;
}

typedef struct plan {
  int across, down;
  int64_t sprites;
  sprite *sprite;
  int64_t *first; /* of a tile's list; one more at the end */
  int32_t *list;
} plan;

static void tiles_of(const plan *t, const sprite *s, int box[4]) {
  box[0] = CF_MAX((int)floorf((s->x - s->wide[0]) / TILE), 0);
  box[1] = CF_MAX((int)floorf((s->y - s->wide[1]) / TILE), 0);
  box[2] = CF_MIN((int)floorf((s->x + s->wide[0] + 1) / TILE), t->across - 1);
  box[3] = CF_MIN((int)floorf((s->y + s->wide[1] + 1) / TILE), t->down - 1);
}

/* Which sprites touch a tile, in their order. */
static cf_status make_lists(plan *t) {
  const int tiles = t->across * t->down;
  int box[4];
  CF_TRY(CF_NEW(&t->first, tiles + 2));
  for (int64_t i = 0; i < t->sprites; ++i) {
    tiles_of(t, &t->sprite[i], box);
    for (int y = box[1]; y <= box[3]; ++y)
      for (int x = box[0]; x <= box[2]; ++x) ++t->first[y * t->across + x + 2];
  }
  for (int n = 2; n < tiles + 2; ++n) t->first[n] += t->first[n - 1];
  CF_TRY(CF_NEW(&t->list, CF_MAX(t->first[tiles + 1], 1)));
  for (int64_t i = 0; i < t->sprites; ++i) {
    tiles_of(t, &t->sprite[i], box);
    for (int y = box[1]; y <= box[3]; ++y)
      for (int x = box[0]; x <= box[2]; ++x) t->list[t->first[y * t->across + x + 1]++] = (int32_t)i;
  }
  return CF_OK;
}

static cf_status make_sprites(plan *t, const cf_cards *c, const cf_lens *lens, const double shutter) {
  CF_TRY(CF_NEW(&t->sprite, CF_MAX(c->count, 1)));
  for (int64_t i = 0; i < c->count; ++i)
    t->sprites += sprite_make(&t->sprite[t->sprites], c, i, lens, (float)shutter) ? 1 : 0;
  qsort(t->sprite, (size_t)t->sprites, sizeof *t->sprite, farther);
  return make_lists(t);
}

static void draw_tiles(const plan *t, const cf_cards *c, const cf_cards_light *light, const cf_lens *lens,
                       patch *patches, const int threads, cf_film *film) {
  CF_PRAGMA(omp parallel for schedule(dynamic) num_threads(threads))
  for (int n = 0; n < t->across * t->down; ++n) {
    const int x = n % t->across * TILE, y = n / t->across * TILE;
    const int tile[4] = {x, y, CF_MIN(x + TILE, film->width), CF_MIN(y + TILE, film->height)};
    for (int64_t i = t->first[n]; i < t->first[n + 1]; ++i)
      draw_in_tile(&t->sprite[t->list[i]], c, light, lens, tile, &patches[omp_get_thread_num()], film);
  }
}

cf_status cf_cards_draw(const cf_cards *c, const cf_cards_light *light, const cf_camera *camera,
                        const double shutter, const int threads, cf_film *film) {
  plan t = {.across = (film->width + TILE - 1) / TILE, .down = (film->height + TILE - 1) / TILE};
  cf_lens lens;
  patch *patches = NULL;
  for (int64_t i = 0; i < c->count; ++i)
    if (c->card[i].picture < 0 || c->card[i].picture >= c->pictures)
      return cf_fail(CF_BAD_ARGUMENT, "flake %lld has the picture %d of %d", (long long)i, c->card[i].picture,
                     c->pictures);
  if (c->count > INT32_MAX) return cf_fail(CF_BAD_ARGUMENT, "more flakes than %d", INT32_MAX);
  CF_TRY(cf_lens_grind(&lens, camera, film->width, film->height));
  cf_status s = make_sprites(&t, c, &lens, shutter);
  if (s == CF_OK) s = CF_NEW(&patches, CF_MAX(threads, 1));
  if (s == CF_OK) draw_tiles(&t, c, light, &lens, patches, CF_MAX(threads, 1), film);
  cf_free(patches);
  cf_free(t.list);
  cf_free(t.first);
  cf_free(t.sprite);
  return s;
}
