/* SPDX-License-Identifier: MIT
 *
 * Pictures as PNG files: 8 bits each of red, green and blue (sRGB), with text that says where they come from; and maps
 * of 16 bits, which other programs read as numbers.
 * No time of day goes in: the same picture gives the same bytes.
 */
#ifndef CF_IO_IMAGE_H
#define CF_IO_IMAGE_H

#include <stdint.h>

#include "base/status.h"

#define CF_IMAGE_SIDE_MAX 32768

typedef struct cf_image_text {
  const char *key;   /* 1 to 79 ASCII letters, "Title", "Software" ... */
  const char *value; /* UTF-8 */
} cf_image_text;

/* Writes `width` x `height` pixels, rows from the top, 3 bytes each, whole or not at all. The key Software
 * is added. CF_CANNOT_WRITE, CF_BAD_ARGUMENT (sides), CF_NO_MEMORY. */
cf_status cf_image_write(const char *path, int width, int height, const uint8_t *rgb, int texts,
                         const cf_image_text *text);

/* The same for maps: `channels` values of 16 bits a pixel, 1 (grey), 3 (RGB) or 4 (RGB and cover, not multiplied by it).
 */
cf_status cf_image_write_deep(const char *path, int width, int height, int channels, const uint16_t *values);

/* Reads a PNG file of any kind as RGB (on white where it is transparent). The pixels are the caller's:
 * cf_free. CF_BAD_FILE. */
cf_status cf_image_read(const char *path, int *width, int *height, uint8_t **rgb);

/* The same as red, green, blue and how much of the pixel they cover (not multiplied by it). */
cf_status cf_image_read_cover(const char *path, int *width, int *height, uint8_t **rgba);

#endif
