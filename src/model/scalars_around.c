/* SPDX-License-Identifier: MIT
 *
 * The scalars around obstacles: regions, and what becomes of scalars where obstacles come and go.
 */
#include <math.h>

#include "grid/sweep.h"
#include "model/scalars.h"

cf_status cf_scalars_make_solid(cf_scalars *s) {
  if (s->obstacles == NULL || s->obstacles->count == 0) return CF_OK;
  CF_TRY(cf_region_create(&s->solid, s->grid));
  CF_TRY(cf_obstacles_region(s->obstacles, CF_OBSTACLES_SOLID, s->solid));
  CF_TRY(cf_rim_create(&s->rim, &s->grid->box));
  return cf_rim_find(&s->rim, s->solid);
}

cf_status cf_scalars_make_region(const cf_scalars *s, cf_scalar *i) {
  if (s->solid == NULL) return CF_OK;
  CF_TRY(cf_region_create(&i->region, s->grid));
  return cf_obstacles_region(s->obstacles, i->field, i->region);
}

cf_status cf_scalars_restored(cf_scalars *s) {
  if (s->solid == NULL) return CF_OK;
  for (int i = 0; i < s->count; ++i) {
    CF_TRY(cf_obstacles_region(s->obstacles, s->item[i].field, s->item[i].region));
    CF_TRY(cf_diffuse_region_changed(s->item[i].diffuse));
  }
  CF_TRY(cf_obstacles_region(s->obstacles, CF_OBSTACLES_SOLID, s->solid));
  return cf_rim_find(&s->rim, s->solid);
}

cf_status cf_scalars_place(cf_scalars *s) {
  if (s->solid == NULL || !s->obstacles->changes) return CF_OK;
  for (int i = 0; i < s->count; ++i) {
    cf_rim_fill(&s->rim, s->item[i].phi);
    s->item[i].before = cf_diffuse_content(s->item[i].diffuse, s->item[i].phi);
  }
  CF_TRY(cf_scalars_restored(s));
  for (int i = 0; i < s->count; ++i) {
    cf_scalar *one = &s->item[i];
    cf_diffuse_set_outside(one->diffuse, one->phi);
    if (!one->plan.scalar_form) cf_diffuse_close_faces(one->diffuse, one->q);
    cf_ledger_add(&one->ledger, cf_diffuse_content(one->diffuse, one->phi) - one->before);
  }
  return CF_OK;
}

cf_range cf_scalars_range_around(const cf_scalars *s, const cf_scalar *i) {
  const cf_box *b = &s->grid->box;
  cf_range range = {0, INFINITY, -INFINITY};
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int c = 0; c < b->n[0]; ++c) {
      const ptrdiff_t p = cf_box_row(b, r) + c;
      const double phi = (double)i->phi.at[p];
      if (cf_region_kind(i->region, p) != CF_CELL_INSIDE) continue;
      range.sum += phi;
      range.min = CF_MIN(range.min, phi);
      range.max = CF_MAX(range.max, phi);
    }
  return range.min <= range.max ? range : (cf_range){0};
}
