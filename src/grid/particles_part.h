/* SPDX-License-Identifier: MIT
 *
 * What the two files of particles share.
 */
#ifndef CF_GRID_PARTICLES_PART_H
#define CF_GRID_PARTICLES_PART_H

/* Particles that a thread takes at a time. */
#define CF_PARTICLE_CHUNK     ((int64_t)16384)
#define CF_PARTICLE_CHUNKS(n) (((n) + CF_PARTICLE_CHUNK - 1) / CF_PARTICLE_CHUNK)

/* Sorting: 11 bits of the key a pass, counted apart in so many parts of the set. */
#define CF_SORT_BITS   11
#define CF_SORT_BINS   (1 << CF_SORT_BITS)
#define CF_SORT_CHUNKS 64

#endif
