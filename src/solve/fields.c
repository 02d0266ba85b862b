/* SPDX-License-Identifier: MIT */
#include "solve/fields.h"

#include "base/mem.h"

bool cf_fields_suit(const cf_coupled *l) {
  for (int a = 0; a < l->dim; ++a)
    if (l->box.n[a] < 4 || l->box.n[a] % 2 == 1) return false;
  return true;
}

/* Fields begin at different places within a page (coupled.c). */
static size_t shift_of(const int number) { return (size_t)(number + 2) * 5 * CF_ALIGN; }

static cf_status pages_create(const cf_split *s, const int number, const size_t element, void **at) {
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)s->size * element + shift_of(number), true));
  *at = (char *)pages + (size_t)s->first * element + shift_of(number);
  return CF_OK;
}

static void pages_destroy(const cf_split *s, const int number, const size_t element, void *at) {
  if (at != NULL)
    cf_pages_release((char *)at - (size_t)s->first * element - shift_of(number),
                     (size_t)s->size * element + shift_of(number));
}

static cf_status make(cf_fields *f, const cf_level *plain) {
  CF_TRY(cf_split_create(&f->split, plain, true));
  const cf_split *s = &f->split;
  for (int a = 0; a < s->dim; ++a) {
    CF_TRY(pages_create(s, a, sizeof(float), (void **)&f->c[a]));
    CF_TRY(pages_create(s, 5 + a, 1, (void **)&f->weight[a]));
    f->split.wraps[a] = plain->axis[a].periodic;
  }
  CF_TRY(pages_create(s, 3, sizeof(float), (void **)&f->inverse));
  CF_TRY(pages_create(s, 4, sizeof(float), (void **)&f->fixed));
  CF_TRY(cf_wave_create(&f->wave, s));
  CF_TRY(CF_NEW(&f->line, (ptrdiff_t)CF_FIELDS_LINES * s->width * f->wave.threads));
  f->sums = (ptrdiff_t)s->n[1] * s->n[2] * cf_wave_pieces(s);
  CF_TRY(CF_NEW(&f->rows, CF_PASS_SUMS * f->sums));
  f->split.fields = f;
  return CF_OK;
}

cf_status cf_fields_create(cf_fields *f, const struct cf_varied *of, const cf_level *plain) {
  *f = (cf_fields){.of = of};
  const cf_status status = make(f, plain);
  if (status != CF_OK) cf_fields_destroy(f);
  return status;
}

void cf_fields_destroy(cf_fields *f) {
  const cf_split *s = &f->split;
  for (int a = 0; a < 3; ++a) {
    pages_destroy(s, a, sizeof(float), f->c[a]);
    pages_destroy(s, 5 + a, 1, f->weight[a]);
  }
  pages_destroy(s, 3, sizeof(float), f->inverse);
  pages_destroy(s, 4, sizeof(float), f->fixed);
  cf_wave_destroy(&f->wave);
  cf_free(f->line);
  cf_free(f->rows);
  cf_split_destroy(&f->split);
  *f = (cf_fields){0};
}
