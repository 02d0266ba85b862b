/* SPDX-License-Identifier: MIT
 *
 * A plane of a field in colours: the preview (preview.h) with lines of equal value and arrows.
 */
#include "base/real.h"
#include "render/look_part.h"

cf_status cf_draw_field(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  if (e->fields == 0) return cf_look_no(look, "a field");
  const cf_exhibit_field *x = cf_exhibit_find(e, "arrows_x"), *y = cf_exhibit_find(e, "arrows_y");
  cf_preview p = cf_preview_default(e->field[0].name, e->field[0].unit);
  p.title = e->title;
  p.time = e->time;
  p.map = look->map;
  p.size = CF_MAX(look->width, look->height);
  if (look->framed) p.frame[0] = look->width, p.frame[1] = look->height;
  p.lines = e->lines, p.line = e->line;
  p.contours = look->contours;
  const cf_exhibit_field *solid = cf_exhibit_find(e, "solid");
  if (solid != NULL) p.solid = solid->at;
  if (x != NULL && y != NULL) p.arrows[0] = x->at, p.arrows[1] = y->at;
  if (!isnan(look->low) && !isnan(look->high)) p.low = look->low, p.high = look->high;
  return cf_preview_draw(c, e->grid, e->field[0].at, &p);
}
