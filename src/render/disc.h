/* SPDX-License-Identifier: MIT
 *
 * A lens out of focus: every place becomes the mean of a disc around it.
 *
 *     out(i, j) = 1/(pi r^2) sum_dj int_{i-w}^{i+w} in(x, j+dj) dx        2w(dj): area of the strip of the disc that is
 *                                                                          within half a place of dj
 *
 * with `in` constant on each place, so that rows are sums of differences of running sums: the cost of a place is 2r + 1
 * times four values, and what it sums to is kept. Across rows strips of a disc have the same width everywhere.
 */
#ifndef CF_RENDER_DISC_H
#define CF_RENDER_DISC_H

/* Places that `in` has more than `out`, on every side. r: in places. */
int cf_disc_margin(float r);

/* in: rows + 2 margin rows of n + 2 margin places and one that is spare, of four numbers each; becomes the running sums.
 * out: rows of n places. r > 0. */
void cf_disc_blur(float (*in)[4], int n, int rows, float r, float (*out)[4]);

#endif
