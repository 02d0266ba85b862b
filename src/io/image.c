/* SPDX-License-Identifier: MIT
 *
 * libpng reports errors by longjmp: what must survive one stands in a struct of the caller.
 */
#define _GNU_SOURCE
#include "io/image.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "base/version.h"
#include "io/folder.h"

#define TEXTS_MAX 15

typedef struct reason {
  char text[256];
} reason;

static void on_error(png_structp png, png_const_charp message) {
  reason *r = png_get_error_ptr(png);
  snprintf(r->text, sizeof r->text, "%s", errno != 0 ? strerror(errno) : message);
  longjmp(*png_set_longjmp_fn(png, longjmp, sizeof(jmp_buf)), 1);
}

static void on_warning(png_structp png, png_const_charp message) {
  (void)png;
  (void)message;
}

static bool is_ascii(const char *text) {
  for (; *text != '\0'; ++text)
    if ((unsigned char)*text >= 128) return false;
  return true;
}

/* tEXt where it can be, iTXt (UTF-8) where it must. libpng copies the values and does not change them. */
static void add_texts(png_structp png, png_infop info, const int texts, const cf_image_text *text) {
  png_text list[TEXTS_MAX + 1];
  char software[128];
  int count = 0;
  memset(list, 0, sizeof list);
  snprintf(software, sizeof software, "Cattaneo %s (%s)", cf_version(), cf_git_hash());
  for (int i = -1; i < CF_MIN(texts, TEXTS_MAX); ++i) {
    const char *value = i < 0 ? software : text[i].value;
    if (value == NULL || value[0] == '\0') continue;
    list[count].key = i < 0 ? "Software" : (char *)(uintptr_t)text[i].key;
    list[count].text = (char *)(uintptr_t)value;
    list[count++].compression = is_ascii(value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
  }
  png_set_text(png, info, list, count);
}

typedef struct picture {
  int width, height, channels, bits; /* bits of a channel: 8 or 16 */
  const void *pixels;
  int texts;
  const cf_image_text *text;
} picture;

static int colour_type(const picture *p) {
  if (p->channels == 1) return PNG_COLOR_TYPE_GRAY;
  return p->channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA;
}

static bool low_byte_first(void) {
  const uint16_t one = 1;
  return *(const uint8_t *)&one == 1;
}

/* Everything between creating and destroying the writer; false after an error. */
static bool write_chunks(png_structp png, png_infop info, FILE *file, const picture *p) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  errno = 0;
  png_init_io(png, file);
  png_set_compression_level(png, 6);
  png_set_IHDR(png, info, (png_uint_32)p->width, (png_uint_32)p->height, p->bits, colour_type(p),
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  /* Maps too: 16 bits without a word on colour are taken for linear light, and changed by who reads 8 of them. */
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  add_texts(png, info, p->texts, p->text);
  png_write_info(png, info);
  if (p->bits == 16 && low_byte_first()) png_set_swap(png);
  const size_t row = (size_t)p->width * (size_t)(p->channels * p->bits / 8);
  for (int y = 0; y < p->height; ++y) png_write_row(png, (const png_byte *)p->pixels + row * (size_t)y);
  png_write_end(png, info);
  return true;
}

static bool write_png(FILE *file, const picture *p, reason *why) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, why, on_error, on_warning);
  png_infop info = png == NULL ? NULL : png_create_info_struct(png);
  bool good = false;
  if (info != NULL)
    good = write_chunks(png, info, file, p);
  else
    snprintf(why->text, sizeof why->text, "out of memory");
  png_destroy_write_struct(&png, &info);
  return good;
}

static cf_status write_whole(const char *path, const picture *p) {
  cf_draft draft;
  reason why = {""};
  if (p->width < 1 || p->height < 1 || p->width > CF_IMAGE_SIDE_MAX || p->height > CF_IMAGE_SIDE_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "%s: a picture of %d x %d pixels: sides must be 1 to %d", path, p->width,
                   p->height, CF_IMAGE_SIDE_MAX);
  CF_TRY(cf_draft_begin(&draft, path));
  FILE *file = fopen(draft.temporary.text, "wbe");
  if (file == NULL) return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, strerror(errno));
  bool good = write_png(file, p, &why);
  if (fclose(file) != 0 && good) {
    snprintf(why.text, sizeof why.text, "%s", strerror(errno));
    good = false;
  }
  if (good) return cf_draft_keep(&draft);
  cf_draft_drop(&draft);
  return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", path, why.text);
}

cf_status cf_image_write(const char *path, const int width, const int height, const uint8_t *rgb,
                         const int texts, const cf_image_text *text) {
  return write_whole(path, &(picture){width, height, 3, 8, rgb, texts, text});
}

cf_status cf_image_write_deep(const char *path, const int width, const int height, const int channels,
                              const uint16_t *values) {
  if (channels != 1 && channels != 3 && channels != 4)
    return cf_fail(CF_BAD_ARGUMENT, "%s: %d channels: must be 1, 3 or 4", path, channels);
  return write_whole(path, &(picture){width, height, channels, 16, values, 0, NULL});
}

static cf_status read_stream(const char *path, FILE *file, const png_uint_32 format, int *width, int *height,
                             uint8_t **pixels) {
  png_image image = {.version = PNG_IMAGE_VERSION};
  const png_color white = {255, 255, 255};
  if (!png_image_begin_read_from_stdio(&image, file))
    return cf_fail(CF_BAD_FILE, "%s: is no PNG picture that can be read: %s", path, image.message);
  image.format = format;
  cf_status s = CF_OK;
  if (image.width > CF_IMAGE_SIDE_MAX || image.height > CF_IMAGE_SIDE_MAX)
    s = cf_fail(CF_BAD_FILE, "%s: %u x %u pixels: sides must be 1 to %d", path, image.width, image.height,
                CF_IMAGE_SIDE_MAX);
  if (s == CF_OK) s = CF_NEW(pixels, PNG_IMAGE_SIZE(image));
  if (s == CF_OK && !png_image_finish_read(&image, &white, *pixels, 0, NULL))
    s = cf_fail(CF_BAD_FILE, "%s: cannot be read: %s", path, image.message);
  png_image_free(&image);
  if (s != CF_OK) {
    cf_free(*pixels);
    *pixels = NULL;
    return s;
  }
  *width = (int)image.width;
  *height = (int)image.height;
  return CF_OK;
}

static cf_status read_as(const char *path, const png_uint_32 format, int *width, int *height,
                         uint8_t **pixels) {
  FILE *file;
  size_t size;
  *pixels = NULL;
  CF_TRY(cf_file_open(path, &file, &size));
  const cf_status s = read_stream(path, file, format, width, height, pixels);
  fclose(file);
  return s;
}

cf_status cf_image_read(const char *path, int *width, int *height, uint8_t **rgb) {
  return read_as(path, PNG_FORMAT_RGB, width, height, rgb);
}

cf_status cf_image_read_cover(const char *path, int *width, int *height, uint8_t **rgba) {
  return read_as(path, PNG_FORMAT_RGBA, width, height, rgba);
}
