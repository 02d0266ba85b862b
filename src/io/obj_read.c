/* SPDX-License-Identifier: MIT
 *
 * Line by line: "v x y z ..." and "f a b c ...", where a corner is V, V/T, V//N or V/T/N and a negative V counts back
 * from the latest vertex. A line that ends in a backslash goes on in the next.
 */
#define _GNU_SOURCE
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "io/mesh_build.h"

typedef struct reader {
  const char *path;
  int64_t line;
  cf_mesh_build build;
} reader;

static const char *skip_blanks(const char *at) {
  while (*at == ' ' || *at == '\t' || *at == '\r') ++at;
  return at;
}

static cf_status read_vertex(reader *r, const char *at) {
  double place[3];
  for (int a = 0; a < 3; ++a) {
    char *end;
    place[a] = strtod(at, &end);
    if (end == at)
      return cf_fail(CF_BAD_FILE, "%s:%" PRId64 ": a vertex without its %c", r->path, r->line, "xyz"[a]);
    at = end;
  }
  cf_mesh_build_vertex(&r->build, place);
  return CF_OK;
}

static cf_status read_face(reader *r, const char *at) {
  int64_t corners = 0;
  cf_mesh_build_polygon(&r->build);
  for (at = skip_blanks(at); *at != '\0'; at = skip_blanks(at), ++corners) {
    char *end;
    const int64_t number = strtoll(at, &end, 10), v = number < 0 ? r->build.vertices + number : number - 1;
    if (end == at)
      return cf_fail(CF_BAD_FILE, "%s:%" PRId64 ": \"%.20s\" is no vertex", r->path, r->line, at);
    if (v < 0 || v >= r->build.vertices)
      return cf_fail(CF_BAD_FILE,
                     "%s:%" PRId64 ": a face names vertex %" PRId64 "; there are %" PRId64 " so far", r->path,
                     r->line, number, r->build.vertices);
    cf_mesh_build_corner(&r->build, v);
    at = end + strcspn(end, " \t\r");
  }
  if (corners >= 3) return CF_OK;
  return cf_fail(CF_BAD_FILE, "%s:%" PRId64 ": a face of %" PRId64 " corners", r->path, r->line, corners);
}

static cf_status read_line(reader *r, const char *line) {
  line = skip_blanks(line);
  if (line[0] == 'v' && (line[1] == ' ' || line[1] == '\t')) return read_vertex(r, line + 2);
  if (line[0] == 'f' && (line[1] == ' ' || line[1] == '\t')) return read_face(r, line + 2);
  return CF_OK;
}

/* Ends lines with zeros; those that go on lose their end instead, and an empty one follows so that numbers stay right. */
static void cut_lines(char *text, const size_t size) {
  for (size_t i = 0; i < size; ++i) {
    if (text[i] != '\n') continue;
    const size_t back = i >= 2 && text[i - 1] == '\r' ? 2 : 1;
    if (i >= back && text[i - back] == '\\')
      memset(text + i - back, ' ', back + 1);
    else
      text[i] = '\0';
  }
}

static cf_status pass(reader *r, cf_mesh *mesh, const bool filling, const char *text, const size_t size) {
  r->build = (cf_mesh_build){.mesh = mesh, .filling = filling};
  r->line = 0;
  for (const char *at = text; at < text + size; at += strlen(at) + 1) {
    ++r->line;
    CF_TRY(read_line(r, at));
  }
  return CF_OK;
}

cf_status cf_obj_read(cf_mesh *mesh, const char *path, char *text, const size_t size) {
  reader r = {.path = path};
  if (memchr(text, '\0', size) != NULL)
    return cf_fail(CF_BAD_FILE, "%s: is no OBJ file: it has zero bytes", path);
  cut_lines(text, size);
  CF_TRY(pass(&r, mesh, false, text, size));
  CF_TRY(cf_mesh_resize(mesh, r.build.vertices, r.build.triangles, false));
  return pass(&r, mesh, true, text, size);
}
