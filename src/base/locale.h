/* SPDX-License-Identifier: MIT
 *
 * Scenes, tables and checkpoints have decimal points wherever they are read. A program that uses the library may have
 * chosen another language with setlocale, in which strtod and printf take commas: between these two calls the calling
 * thread has that of C, other threads keep theirs.
 */
#ifndef CF_BASE_LOCALE_H
#define CF_BASE_LOCALE_H

/* What was before, to be given back. */
void *cf_locale_plain(void);
void cf_locale_back(void *before);

#endif
