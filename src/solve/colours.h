/* SPDX-License-Identifier: MIT
 *
 * Rows that compute the cells of both colours and keep one, so that the loop runs in vectors. What they read for the cells
 * that they throw away, other threads may be changing. Under the thread sanitizer, which takes that for a race, these
 * cells are left out, so that all other races of such rows are seen.
 */
#ifndef CF_SOLVE_COLOURS_H
#define CF_SOLVE_COLOURS_H

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CF_ONE_COLOUR
#endif
#elif defined(__SANITIZE_THREAD__)
#define CF_ONE_COLOUR
#endif

/* In the body of the loop over cells. */
#ifdef CF_ONE_COLOUR
#define CF_THROWN_AWAY(is_so) \
  if (is_so) continue
#else
#define CF_THROWN_AWAY(is_so)
#endif

#endif
