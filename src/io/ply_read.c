/* SPDX-License-Identifier: MIT
 *
 * The head of a PLY file says which elements follow, how many of each, and which properties one of them has, in order;
 * so whatever the elements are, they can be read or passed over.
 */
#define _GNU_SOURCE
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "io/mesh_build.h"

#define PROPERTIES 64
#define ELEMENTS   16
#define WORD       64

typedef enum form { ASCII, LITTLE, BIG } form;

typedef struct kind {
  const char *name, *alias;
  int bytes;
  char sort; /* i: signed, u: unsigned, f: float */
} kind;

static const kind kinds[] = {{"char", "int8", 1, 'i'},     {"uchar", "uint8", 1, 'u'},
                             {"short", "int16", 2, 'i'},   {"ushort", "uint16", 2, 'u'},
                             {"int", "int32", 4, 'i'},     {"uint", "uint32", 4, 'u'},
                             {"float", "float32", 4, 'f'}, {"double", "float64", 8, 'f'}};
#define KINDS ((int)(sizeof kinds / sizeof *kinds))

typedef struct property {
  char name[WORD];
  const kind *count; /* of a list; NULL: a number */
  const kind *value;
  cf_real *to; /* where the numbers of vertices go; NULL: nowhere */
  int step;    /* from one vertex to the next there */
} property;

typedef struct element {
  char name[WORD];
  int64_t count;
  int properties;
  property property[PROPERTIES];
} element;

typedef struct reader {
  const char *path;
  const char *at, *end;
  form form;
  int64_t line; /* of the head */
  int elements;
  element *element; /* ELEMENTS of them */
  cf_mesh_build build;
} reader;

/* --- head ------------------------------------------------------------------------------------------------- */

static cf_status bad_head(const reader *r, const char *what, const char *word) {
  return cf_fail(CF_BAD_FILE, "%s:%" PRId64 ": %s: \"%.40s\"", r->path, r->line, what, word);
}

static const kind *find_kind(const char *word) {
  for (int k = 0; k < KINDS; ++k)
    if (strcmp(word, kinds[k].name) == 0 || strcmp(word, kinds[k].alias) == 0) return &kinds[k];
  return NULL;
}

static cf_status add_element(reader *r, const char *line) {
  if (r->elements == ELEMENTS) return bad_head(r, "too many elements", line);
  element *e = &r->element[r->elements];
  if (sscanf(line, "element %63s %" SCNd64, e->name, &e->count) != 2 || e->count < 0)
    return bad_head(r, "not an element and its number", line);
  ++r->elements;
  return CF_OK;
}

static cf_status add_property(reader *r, const char *line) {
  char first[WORD], second[WORD], third[WORD], fourth[WORD];
  const int words = sscanf(line, "property %63s %63s %63s %63s", first, second, third, fourth);
  if (r->elements == 0) return bad_head(r, "a property of no element", line);
  element *e = &r->element[r->elements - 1];
  if (e->properties == PROPERTIES) return bad_head(r, "too many properties", line);
  property *p = &e->property[e->properties++];
  const bool list = words == 4 && strcmp(first, "list") == 0;
  if (!list && words != 2) return bad_head(r, "not a property", line);
  p->count = list ? find_kind(second) : NULL;
  p->value = find_kind(list ? third : first);
  snprintf(p->name, sizeof p->name, "%s", list ? fourth : second);
  if (p->value == NULL || (list && (p->count == NULL || p->count->sort == 'f')))
    return bad_head(r, "a property of an unknown type", line);
  return CF_OK;
}

static cf_status read_format(reader *r, const char *line) {
  static const char *const words[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  char word[WORD], version[WORD];
  if (sscanf(line, "format %63s %63s", word, version) != 2 || strcmp(version, "1.0") != 0)
    return bad_head(r, "not a format and version 1.0", line);
  for (int f = 0; f < 3; ++f)
    if (strcmp(word, words[f]) == 0) {
      r->form = (form)f;
      return CF_OK;
    }
  return bad_head(r, "an unknown format", word);
}

/* The next line of the head, without its end. */
static cf_status next_line(reader *r, char line[256]) {
  const size_t left = (size_t)(r->end - r->at);
  const char *end = memchr(r->at, '\n', left);
  ++r->line;
  if (end == NULL) return cf_fail(CF_BAD_FILE, "%s:%" PRId64 ": the head has no end", r->path, r->line);
  size_t length = (size_t)(end - r->at);
  if (length > 0 && r->at[length - 1] == '\r') --length;
  snprintf(line, 256, "%.*s", (int)CF_MIN(length, 255), r->at);
  r->at = end + 1;
  return CF_OK;
}

static bool begins(const char *line, const char *word) {
  const size_t length = strlen(word);
  return strncmp(line, word, length) == 0 && (line[length] == ' ' || line[length] == '\0');
}

static cf_status read_head(reader *r) {
  char line[256];
  bool format = false;
  CF_TRY(next_line(r, line));
  if (strcmp(line, "ply") != 0) return cf_fail(CF_BAD_FILE, "%s: is not a PLY file", r->path);
  for (;;) {
    CF_TRY(next_line(r, line));
    if (strcmp(line, "end_header") == 0) break;
    if (begins(line, "comment") || begins(line, "obj_info") || line[0] == '\0') continue;
    if (begins(line, "format")) {
      CF_TRY(read_format(r, line));
      format = true;
    } else if (begins(line, "element")) {
      CF_TRY(add_element(r, line));
    } else if (begins(line, "property")) {
      CF_TRY(add_property(r, line));
    } else {
      return bad_head(r, "an unknown word", line);
    }
  }
  return format ? CF_OK : cf_fail(CF_BAD_FILE, "%s: does not say its format", r->path);
}

/* --- numbers ---------------------------------------------------------------------------------------------- */

static double decode(const unsigned char *at, const kind *k, const form f) {
  uint64_t bits = 0;
  for (int b = 0; b < k->bytes; ++b) bits |= (uint64_t)at[f == BIG ? k->bytes - 1 - b : b] << 8 * b;
  if (k->sort == 'f' && k->bytes == 4) {
    const uint32_t word = (uint32_t)bits;
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
  }
  if (k->sort == 'f') {
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
  }
  const uint64_t sign = (uint64_t)1 << (8 * k->bytes - 1);
  return k->sort == 'i' && (bits & sign) ? (double)bits - 2 * (double)sign : (double)bits;
}

/* The next number; false where there is none. */
static bool next_number(reader *r, const kind *k, double *value) {
  if (r->form == ASCII) {
    char *end;
    *value = strtod(r->at, &end);
    const bool good = end != r->at && end <= r->end;
    r->at = end;
    return good;
  }
  if (r->end - r->at < k->bytes) return false;
  *value = decode((const unsigned char *)r->at, k, r->form);
  r->at += k->bytes;
  return true;
}

static cf_status ended(const reader *r, const element *e, const int64_t i) {
  return cf_fail(CF_BAD_FILE, "%s: %s %" PRId64 " of %" PRId64 " is not there, or holds what is no number",
                 r->path, e->name, i, e->count);
}

/* --- elements --------------------------------------------------------------------------------------------- */

static bool is_corners(const property *p) {
  return p->count != NULL && (strcmp(p->name, "vertex_indices") == 0 || strcmp(p->name, "vertex_index") == 0);
}

static cf_status bad_corner(const reader *r, const int64_t face, const double vertex,
                            const int64_t vertices) {
  return cf_fail(CF_BAD_FILE, "%s: face %" PRId64 " names vertex %.17g of %" PRId64, r->path, face, vertex,
                 vertices);
}

/* A list; that of a face makes triangles. */
static cf_status read_list(reader *r, const element *e, const property *p, const int64_t i,
                           const int64_t vertices) {
  const bool corners = vertices >= 0 && is_corners(p);
  double length, value;
  if (!next_number(r, p->count, &length) || !(length >= 0)) return ended(r, e, i);
  if (corners) cf_mesh_build_polygon(&r->build);
  if (corners && length < 3)
    return cf_fail(CF_BAD_FILE, "%s: face %" PRId64 " has %g corners", r->path, i, length);
  for (int64_t c = 0; (double)c < length; ++c) {
    if (!next_number(r, p->value, &value)) return ended(r, e, i);
    if (!corners) continue;
    if (!(value >= 0 && value < (double)vertices) || value != floor(value))
      return bad_corner(r, i, value, vertices);
    cf_mesh_build_corner(&r->build, (int64_t)value);
  }
  return CF_OK;
}

/* `vertices`: how many there are, if this is the element face; otherwise -1. */
static cf_status read_element(reader *r, const element *e, const int64_t vertices) {
  for (int64_t i = 0; i < e->count && e->properties > 0; ++i)
    for (int n = 0; n < e->properties; ++n) {
      const property *p = &e->property[n];
      double value;
      if (p->count != NULL) {
        CF_TRY(read_list(r, e, p, i, vertices));
        continue;
      }
      if (!next_number(r, p->value, &value)) return ended(r, e, i);
      if (r->build.filling && p->to != NULL) p->to[i * p->step] = (cf_real)value;
    }
  return CF_OK;
}

static element *find_element(reader *r, const char *name) {
  for (int e = 0; e < r->elements; ++e)
    if (strcmp(r->element[e].name, name) == 0) return &r->element[e];
  return NULL;
}

static property *find_property(element *e, const char *name) {
  for (int p = 0; p < e->properties; ++p)
    if (e->property[p].count == NULL && strcmp(e->property[p].name, name) == 0) return &e->property[p];
  return NULL;
}

static cf_status pass(reader *r, const char *body, const element *vertex, const element *face,
                      const bool filling) {
  r->at = body;
  r->build = (cf_mesh_build){.mesh = r->build.mesh, .filling = filling};
  for (int e = 0; e < r->elements; ++e)
    CF_TRY(read_element(r, &r->element[e], &r->element[e] == face ? vertex->count : -1));
  return CF_OK;
}

/* Every element takes at least a byte, so a short file cannot ask for much memory. */
static cf_status check_counts(const reader *r) {
  for (int e = 0; e < r->elements; ++e)
    if (r->element[e].properties > 0 && r->element[e].count > r->end - r->at)
      return cf_fail(CF_BAD_FILE, "%s: is cut short: %" PRId64 " of %s cannot be in %td bytes", r->path,
                     r->element[e].count, r->element[e].name, r->end - r->at);
  return CF_OK;
}

/* --- the mesh --------------------------------------------------------------------------------------------- */

/* What a comment in the head says of an attribute: "comment unit of T: K". */
static void find_unit(const char *head, const char *body, const char *name, char unit[CF_NAME_MAX]) {
  char wanted[WORD + 24];
  const int length = snprintf(wanted, sizeof wanted, "\ncomment unit of %s: ", name);
  const char *at = memmem(head, (size_t)(body - head), wanted, (size_t)length);
  unit[0] = '\0';
  if (at == NULL) return;
  at += length;
  snprintf(unit, CF_NAME_MAX, "%.*s", (int)CF_MIN(strcspn(at, "\r\n"), CF_NAME_MAX), at);
}

/* Where the numbers of a vertex go: its place, its normal, attributes. */
static cf_status connect(cf_mesh *m, element *vertex, const char *head, const char *body) {
  static const char *const place[3] = {"x", "y", "z"}, *const normal[3] = {"nx", "ny", "nz"};
  for (int a = 0; a < 3; ++a) {
    property *p = find_property(vertex, place[a]), *n = find_property(vertex, normal[a]);
    p->to = &m->place[0][a], p->step = 3;
    if (m->normal != NULL) n->to = &m->normal[0][a], n->step = 3;
  }
  for (int i = 0; i < vertex->properties; ++i) {
    char unit[CF_NAME_MAX];
    property *p = &vertex->property[i];
    if (p->count != NULL || p->to != NULL || m->attributes == CF_MESH_ATTRIBUTES) continue;
    if (find_property(vertex, p->name) != p) continue; /* of two with one name the first */
    if (strcmp(p->name, "nx") == 0 || strcmp(p->name, "ny") == 0 || strcmp(p->name, "nz") == 0) continue;
    find_unit(head, body, p->name, unit);
    CF_TRY(cf_mesh_attribute_add(m, p->name, unit, &p->to));
    p->step = 1;
  }
  return CF_OK;
}

static cf_status read_all(reader *r, cf_mesh *mesh) {
  const char *head = r->at;
  CF_TRY(read_head(r));
  CF_TRY(check_counts(r));
  const char *body = r->at;
  element *vertex = find_element(r, "vertex");
  const element *face = find_element(r, "face");
  if (vertex == NULL || face == NULL)
    return cf_fail(CF_BAD_FILE, "%s: has no %s", r->path, vertex == NULL ? "vertices" : "faces");
  for (int a = 0; a < 3; ++a)
    if (find_property(vertex, (const char *const[]){"x", "y", "z"}[a]) == NULL)
      return cf_fail(CF_BAD_FILE, "%s: its vertices have no %c", r->path, "xyz"[a]);
  CF_TRY(pass(r, body, vertex, face, false));
  const bool normals = find_property(vertex, "nx") != NULL && find_property(vertex, "ny") != NULL &&
                       find_property(vertex, "nz") != NULL;
  CF_TRY(cf_mesh_resize(mesh, vertex->count, r->build.triangles, normals));
  CF_TRY(connect(mesh, vertex, head, body));
  return pass(r, body, vertex, face, true);
}

cf_status cf_ply_read(cf_mesh *mesh, const char *path, char *text, const size_t size) {
  reader r = {.path = path, .at = text, .end = text + size, .build = {.mesh = mesh}};
  CF_TRY(CF_NEW(&r.element, ELEMENTS));
  const cf_status s = read_all(&r, mesh);
  cf_free(r.element);
  return s;
}
