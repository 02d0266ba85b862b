/* SPDX-License-Identifier: MIT
 *
 * cattaneo render DIR... [-o FRAME.png]
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/command.h"
#include "app/showing.h"
#include "base/mem.h"
#include "base/real.h"
#include "io/image.h"

enum { CAPTION = 160, SHOWN = 64 };

static cf_status write_picture(const char *path, const cf_canvas *c, const char *title, const double time) {
  char when[40] = "";
  if (isfinite(time)) snprintf(when, sizeof when, "%.17g", time);
  const cf_image_text text[] = {{"Title", title != NULL ? title : ""}, {"Time", when}};
  CF_TRY(cf_image_write(path, c->width, c->height, c->rgb, 2, text));
  printf("%s\n", path);
  return CF_OK;
}

/* Which frames --frame means, by place in the list: the last, one by its number, or all. */
static cf_status choose(const cf_showing *s, const char *frame, int64_t *from, int64_t *to) {
  *from = *to = s->frames - 1;
  if (frame == NULL || strcmp(frame, "last") == 0) return CF_OK;
  if (strcmp(frame, "all") == 0) {
    *from = 0;
    return CF_OK;
  }
  char *end;
  const long long number = strtoll(frame, &end, 10);
  if (end == frame || *end != '\0' || number < 0)
    return cf_fail(CF_BAD_USAGE, "--frame %.32s: must be the number of a frame, last, or all", frame);
  for (int64_t i = 0; i < s->frames; ++i)
    if (s->number[i] == number) {
      *from = *to = i;
      return CF_OK;
    }
  return cf_fail(CF_BAD_USAGE,
                 "--frame %lld: %s has no such frame; the first is %" PRId64 " and the last %" PRId64, number,
                 s->folder, s->number[0], s->number[s->frames - 1]);
}

static cf_status picture_of(cf_showing *s, const int64_t number, cf_canvas *c) {
  CF_TRY(cf_showing_load(s, number));
  return cf_showing_draw(s, c);
}

static cf_status render_one(cf_showing *s, const cf_arguments *a) {
  int64_t from, to;
  CF_TRY(choose(s, a->frame, &from, &to));
  if (from < to && a->output != NULL)
    return cf_fail(CF_BAD_USAGE, "--frame all writes into the folder of the run: it goes without -o");
  CF_TRY(cf_showing_range(1, s, &from, &to));
  for (int64_t i = from; i <= to; ++i) {
    cf_path path;
    cf_canvas c;
    CF_TRY(a->output != NULL ? cf_path_make(&path, "%s", a->output)
                             : cf_path_make(&path, "%s/render_%06" PRId64 ".png", s->folder, s->number[i]));
    CF_TRY(cf_draft_try(path.text));
    CF_TRY(picture_of(s, s->number[i], &c));
    const cf_status status = write_picture(path.text, &c, s->exhibit.title, s->exhibit.time);
    cf_canvas_destroy(&c);
    CF_TRY(status);
  }
  return CF_OK;
}

/* --- side by side -------------------------------------------------------------------------------------------------- */

static cf_status side_by_side(cf_showing *s, const int count, const cf_arguments *a, cf_canvas *picture,
                              char (*caption)[CAPTION]) {
  const cf_canvas *pictures[SHOWN];
  const char *captions[SHOWN];
  int64_t at[SHOWN] = {0}, to;
  cf_canvas c;
  for (int i = 0; i < count; ++i) {
    CF_TRY(choose(&s[i], a->frame, &at[i], &to));
    if (at[i] < to) return cf_fail(CF_BAD_USAGE, "--frame all takes one folder");
  }
  CF_TRY(cf_showing_range(count, s, at, at));
  for (int i = 0; i < count; ++i) {
    CF_TRY(picture_of(&s[i], s[i].number[at[i]], &picture[i]));
    const char *title = s[i].exhibit.title != NULL ? s[i].exhibit.title : s[i].folder;
    snprintf(caption[i], CAPTION, "%s, t = %.4g s", title, s[i].exhibit.time);
    pictures[i] = &picture[i], captions[i] = caption[i];
  }
  const int columns = a->columns > 0 ? CF_MIN(a->columns, count) : CF_MIN((int)ceil(sqrt(count)), count);
  const int width = CF_MIN(columns * picture[0].width, 3840);
  CF_TRY(cf_sheet_pictures(&c, count, pictures, captions, columns, width));
  const cf_status status = write_picture(a->output, &c, "Several runs side by side", (double)NAN);
  cf_canvas_destroy(&c);
  return status;
}

static cf_status render_several(cf_showing *s, const int count, const cf_arguments *a) {
  cf_canvas *picture;
  char(*caption)[CAPTION];
  if (a->output == NULL) return cf_fail(CF_BAD_USAGE, "render: with several folders -o FILE.png is missing");
  CF_TRY(CF_NEW(&picture, count));
  caption = NULL;
  cf_status status = CF_NEW(&caption, count);
  if (status == CF_OK) status = side_by_side(s, count, a, picture, caption);
  for (int i = 0; i < count; ++i) cf_canvas_destroy(&picture[i]);
  cf_free(caption);
  cf_free(picture);
  return status;
}

cf_status cf_render_command(cf_arguments *a) {
  cf_showing *s;
  int open = 0;
  CF_TRY(cf_arguments_check_file(a, ".png"));
  CF_TRY(CF_NEW(&s, a->operands));
  cf_status status = CF_OK;
  for (; open < a->operands && status == CF_OK; ++open)
    status = cf_showing_open(&s[open], a->operand[open], a);
  if (status == CF_OK) status = open == 1 ? render_one(s, a) : render_several(s, open, a);
  for (int i = 0; i < open; ++i) cf_showing_close(&s[i]);
  cf_free(s);
  return status;
}
