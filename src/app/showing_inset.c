/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "app/showing.h"
#include "base/mem.h"
#include "base/real.h"
#include "io/column.h"
#include "render/graph.h"

enum { CURVES = 6 };

static cf_status read_curves(const cf_showing *s, const char *path, double **time, double *values[CURVES],
                             cf_curve *curve) {
  const cf_param_texts *names = &s->scene->render.plot;
  int64_t times;
  CF_TRY(cf_column_read(path, "time", &times, time));
  for (int i = 0; i < CF_MIN(names->count, CURVES); ++i) {
    int64_t count;
    CF_TRY(cf_column_read(path, names->item[i], &count, &values[i]));
    curve[i] = (cf_curve){.count = CF_MIN(count, times),
                          .x = *time,
                          .y = values[i],
                          .colour = cf_graph_colour(i),
                          .label = names->item[i]};
  }
  return CF_OK;
}

cf_status cf_showing_inset(cf_showing *s) {
  const cf_param_texts *names = &s->scene->render.plot;
  const int curves = CF_MIN(names->count, CURVES);
  const int width = CF_MAX((int)(0.34 * s->look.width), 160),
            height = CF_MAX((int)(0.30 * s->look.height), 110);
  double *time = NULL, *values[CURVES] = {NULL};
  cf_curve curve[CURVES];
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/metrics.csv", s->folder));
  cf_status status = read_curves(s, path.text, &time, values, curve);
  const cf_graph g = {.title = curves == 1 ? names->item[0] : NULL,
                      .x_name = "t (s)",
                      .curves = curves,
                      .curve = curve,
                      .now = s->exhibit.time};
  if (status == CF_OK) status = cf_graph_draw(&g, width, height, &s->inset);
  for (int i = 0; i < CURVES; ++i) cf_free(values[i]);
  cf_free(time);
  return status;
}
