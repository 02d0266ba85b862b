/* SPDX-License-Identifier: MIT
 *
 * The letters, each a few strokes of the pen. Units: 10 to the top of a capital, 7 to that of an x, -3 to the foot of
 * a p; y counts up from the baseline.
 *
 * A path is words and numbers:  M x y x y ...  a new stroke of straight lines;  L x y ...  goes on with it;
 * C x1 y1 x2 y2 x y  a cubic;  A cx cy rx ry from to  an arc of an ellipse, degrees, counterclockwise if from < to (it
 * goes on with the stroke if there is one after M, else begins one);  O cx cy rx ry  a whole ellipse;  D x y  a dot.
 */
#ifndef CF_RENDER_ALPHABET_H
#define CF_RENDER_ALPHABET_H

#include <stdint.h>

typedef struct cf_glyph {
  uint32_t code;            /* Unicode */
  float left, width, right; /* room before, of the strokes' axes, after */
  const char *path;
} cf_glyph;

/* A box for what is not there. */
const cf_glyph *cf_alphabet_find(uint32_t code);

/* A letter with an accent: the letter, and the code of the accent (a combining mark, 0: none) to be drawn over it. */
uint32_t cf_alphabet_split(uint32_t code, uint32_t *accent);

#endif
