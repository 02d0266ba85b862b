/* SPDX-License-Identifier: MIT
 *
 * Colour maps built from curves in OKLab, a colour space in which equal distances look equal: the lightness
 * runs evenly along every map, so equal steps of the data look like equal steps, in grey print too.
 *
 *   ember     black, purple, red, orange, pale yellow: what is there shines
 *   ice       black, deep blue, cyan, white
 *   ink       white to blue to near black: ink in a back-lit tank
 *   moss      deep violet-blue, teal, green, yellow
 *   balance   blue, white, red; for signed values
 *   dusk      blue, black, orange; for signed values on dark ground
 *   grey      black to white
 */
#ifndef CF_RENDER_COLORMAP_H
#define CF_RENDER_COLORMAP_H

#include <stdbool.h>

#include "render/canvas.h"

/* name, whether its middle means 0 */
#define CF_COLORMAP_LIST(M) \
  M(ember, false) M(ice, false) M(ink, false) M(moss, false) M(balance, true) M(dusk, true) M(grey, false)

typedef enum cf_colormap {
#define CF_COLORMAP_ENUM(name, signed_) CF_COLORMAP_##name,
  CF_COLORMAP_LIST(CF_COLORMAP_ENUM)
#undef CF_COLORMAP_ENUM
      CF_COLORMAP_COUNT
} cf_colormap;

/* CF_BAD_ARGUMENT: no map of that name (the sentence lists them). */
cf_status cf_colormap_find(const char *name, cf_colormap *map);
const char *cf_colormap_name(cf_colormap map);
bool cf_colormap_is_signed(cf_colormap map);

/* The colour at s, 0 to 1 (clamped). */
cf_colour cf_colormap_at(cf_colormap map, double s);

/* `count` colours at equal steps from 0 to 1. */
void cf_colormap_fill(cf_colormap map, int count, cf_colour *colours);

/* sRGB to OKLab: lightness 0 to 1, a (green to red), b (blue to yellow). */
void cf_colour_oklab(cf_colour c, double lab[3]);

#endif
