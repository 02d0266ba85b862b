/* SPDX-License-Identifier: MIT
 *
 * Tables of parameters. A parameter exists once, as a row of a table
 *
 *     #define CF_TIME_TABLE(P, R)                                                      \
 *       P(end, number, CF_REQUIRED, "s", "(0, inf)", "the time at which the run ends") \
 *       P(dt, number_or_auto, "auto", "s", "(0, inf)", "length of a step")
 *
 * and everything else is made from the row: the member of the C struct, its default, what a scene may
 * write for it, the unit and the range that are checked, "did you mean", and the page that explains it.
 * A row of a sub-record is R(kind, name, struct, doc) with kind record, optional, list or map.
 *
 * The columns of P: name, type (see below), default as a scene would write it, unit, range, meaning.
 *   default  CF_REQUIRED: must be given. CF_NONE: may be left out and has no default; the member is then
 *            empty (NaN, 0 entries, NULL) and its `given` is false.
 *   unit     "" for plain numbers.
 *   range    for numbers an interval, "(0, 1]", "[0, inf)", or ""; before it, for lists of numbers, how many:
 *            "2..3 of (0, inf)". For words the words: "warn|stop" (CF_WORDS makes them from a list).
 *
 * Every struct starts with a member `given` that has one flag for each row, of the same name:
 * `scene->diffusion.given.tau` says whether tau was written down.
 *
 * This file knows no file format; who fills the structs in is above (io/scene.h).
 */
#ifndef CF_BASE_PARAM_H
#define CF_BASE_PARAM_H

#include <stdbool.h>
#include <stddef.h>

#include "base/fn.h"
#include "base/status.h"
#include "base/walls.h"

#define CF_REQUIRED ((const char *)-1) /* in the column `default` */
#define CF_NONE     ((const char *)0)

/* A function with the text it was given as; the text is what a resolved scene writes. */
typedef struct cf_function {
  cf_fn fn;
  const char *text;
} cf_function;

/* Every so many steps, or seconds of the wall clock; `every` is 0 for never. */
typedef struct cf_interval {
  double every;
  bool in_steps;
} cf_interval;

/* type of a row -> type of the member */
typedef double cf_param_number;         /* in the unit of the row */
typedef double cf_param_number_or_auto; /* NaN: auto */
typedef long cf_param_integer;
typedef bool cf_param_flag;
typedef int cf_param_word;       /* index among the words of the row */
typedef unsigned cf_param_words; /* a set of words: bit i is word i */
typedef const char *cf_param_text;
typedef const char *cf_param_path;     /* of a file, from the root of the file system; "": none */
typedef const char *cf_param_key;      /* not a key of the scene: the name of a record in its map */
typedef cf_function cf_param_function; /* of x, y, z and t */
typedef cf_function cf_param_profile;  /* of x, y and z */
typedef cf_interval cf_param_interval;
typedef struct cf_param_texts {
  int count;
  const char **item;
} cf_param_texts;
typedef struct cf_param_numbers {
  int count;
  double value[3];
} cf_param_numbers;
typedef cf_param_numbers cf_param_numbers_or_auto; /* count 0: auto */
typedef struct cf_param_integers {
  int count;
  long value[3];
} cf_param_integers;
typedef struct cf_param_functions {
  int count; /* 1, or one an axis */
  cf_function axis[3];
} cf_param_functions;
typedef cf_param_functions cf_param_profiles;
typedef struct cf_param_walls {
  cf_walls walls;
  const char *text[3][2]; /* the expression of a value; NULL where there is none */
  bool given[3][2];       /* this side was named (or all were, with one word) */
} cf_param_walls;
typedef struct cf_param_constants { /* names for numbers, in the order given */
  int count;
  const char **name;
  const char **text;
  double *value;
} cf_param_constants;

/* clang-format off */
#define CF_PARAM_TYPE_LIST(T)                                                           \
  T(number, "number") T(number_or_auto, "number or auto") T(integer, "whole number")    \
  T(flag, "true or false") T(word, "word") T(words, "list of words") T(text, "text")    \
  T(path, "name of a file")                                                             \
  T(key, "name") T(texts, "list of texts") T(numbers, "list of numbers")                \
  T(numbers_or_auto, "list of numbers, or auto") T(integers, "list of whole numbers")   \
  T(function, "number or expression in x, y, z, t")                                     \
  T(profile, "number or expression in x, y, z")                                         \
  T(functions, "number or expression in x, y, z, t; for a vector a list, one an axis")  \
  T(profiles, "number or expression in x, y, z; for a vector a list, one an axis")      \
  T(walls, "word, or map of sides") T(interval, "N steps, a time, or never")            \
  T(constants, "map of names to numbers") T(record, "map") T(optional, "map")           \
  T(list, "list of maps") T(map, "map of names to maps")
/* clang-format on */

typedef enum cf_param_type {
#define CF_PARAM_TYPE_ENUM(type, what) CF_PARAM_##type,
  CF_PARAM_TYPE_LIST(CF_PARAM_TYPE_ENUM)
#undef CF_PARAM_TYPE_ENUM
} cf_param_type;

typedef struct cf_param_table cf_param_table;

/* One row. */
typedef struct cf_param {
  const char *name;
  cf_param_type type;
  size_t offset; /* of the member in its struct */
  size_t given;  /* of its flag */
  const char *fallback, *unit, *range, *doc;
  const cf_param_table *table; /* of a record, optional, list or map; else NULL */
} cf_param;

struct cf_param_table {
  size_t size; /* of the struct */
  int count;
  const cf_param *param;
};

/* How list and map members are laid out, whatever the type of the record: read and write them through
 * cf_param_items. */
typedef struct cf_param_items {
  int count;
  void *item;
} cf_param_items;
cf_param_items cf_param_items_get(const void *member);
void cf_param_items_set(void *member, cf_param_items items);

/* --- from a table to C ------------------------------------------------------------------------ */

/* Inside a struct: the flags and the members of a table. */
#define CF_PARAM_MEMBERS(TABLE)                  \
  struct {                                       \
    TABLE(CF_PARAM_FLAG_ROW, CF_RECORD_FLAG_ROW) \
  } given;                                       \
  TABLE(CF_PARAM_MEMBER_ROW, CF_RECORD_MEMBER_ROW)

#define CF_PARAM_FLAG_ROW(name, type, fallback, unit, range, doc)   bool name;
#define CF_RECORD_FLAG_ROW(kind, name, record, doc)                 bool name;
#define CF_PARAM_MEMBER_ROW(name, type, fallback, unit, range, doc) cf_param_##type name;
#define CF_RECORD_MEMBER_ROW(kind, name, record, doc)               CF_RECORD_MEMBER_##kind(name, record)
#define CF_RECORD_MEMBER_record(name, record)                       record name;
#define CF_RECORD_MEMBER_optional(name, record)                     record name;
#define CF_RECORD_MEMBER_list(name, record) \
  struct {                                  \
    int count;                              \
    record *item;                           \
  } name;
#define CF_RECORD_MEMBER_map(name, record) CF_RECORD_MEMBER_list(name, record)

/* In one .c, with CF_PARAM_STRUCT defined as the struct:
 *     #define CF_PARAM_STRUCT cf_scene_time
 *     CF_PARAM_TABLE(cf_scene_time, CF_TIME_TABLE)
 *     #undef CF_PARAM_STRUCT
 * makes the constant cf_scene_time_table. Tables of sub-records come first. */
#define CF_PARAM_TABLE(record, TABLE)                                                                    \
  static const cf_param record##_rows[] = {TABLE(CF_PARAM_ROW, CF_RECORD_ROW)};                          \
  const cf_param_table record##_table = {.size = sizeof(record),                                         \
                                         .count = (int)(sizeof record##_rows / sizeof record##_rows[0]), \
                                         .param = record##_rows};

#define CF_PARAM_ROW(name_, type_, fallback_, unit_, range_, doc_) \
  {.name = #name_,                                                 \
   .type = CF_PARAM_##type_,                                       \
   .offset = offsetof(CF_PARAM_STRUCT, name_),                     \
   .given = offsetof(CF_PARAM_STRUCT, given.name_),                \
   .fallback = (fallback_),                                        \
   .unit = (unit_),                                                \
   .range = (range_),                                              \
   .doc = (doc_)},
#define CF_RECORD_ROW(kind_, name_, record_, doc_)  \
  {.name = #name_,                                  \
   .type = CF_PARAM_##kind_,                        \
   .offset = offsetof(CF_PARAM_STRUCT, name_),      \
   .given = offsetof(CF_PARAM_STRUCT, given.name_), \
   .fallback = CF_NONE,                             \
   .unit = "",                                      \
   .range = "",                                     \
   .doc = (doc_),                                   \
   .table = &record_##_table},

/* Words from a list W(UPPER, lower): the text for the column `range`, and the enum with a prefix of its own.
 */
#define CF_WORD_TEXT(upper, lower) #lower "|"
#define CF_WORDS(LIST)             LIST(CF_WORD_TEXT)

/* --- what tables can answer ------------------------------------------------------------------- */

/* The row of `name` in one table; NULL: there is none. */
const cf_param *cf_param_find(const cf_param_table *table, const char *name);

/* The row of a path from the root: "diffusion.k", "fields.NAME.initial", "sources.0.rate"; parts that name an
 * entry of a map or list may be anything or be left out ("sources.rate"). NULL: there is none. */
const cf_param *cf_param_find_path(const cf_param_table *root, const char *path);

/* The row of the table whose name is most like `name`, if one is like enough to be meant; else NULL. */
const char *cf_param_nearest(const cf_param_table *table, const char *name);

/* The path of the row whose name is most like the last part of `path`, in the whole tree, written to
 * `nearest`
 * (`size` bytes); false: nothing is like it. */
bool cf_param_nearest_path(const cf_param_table *root, const char *path, char *nearest, size_t size);

/* Whether `word` could be a slip of the pen for `wanted`, and how far off it is (0: the same; a swap of two
 * neighbours counts 1). -1: too far. */
int cf_param_distance(const char *word, const char *wanted);

/* Among "a|b|c|" the index of `word` (`length` bytes), or -1. */
int cf_param_word_index(const char *words, const char *word, size_t length);

/* The i-th word of "a|b|c|" copied into `word` (`size` bytes); false past the last. */
bool cf_param_word_at(const char *words, int i, char *word, size_t size);

/* Like `nearest`, among the words. */
bool cf_param_word_nearest(const char *words, const char *word, char *nearest, size_t size);

/* An interval of the column `range`, taken apart. */
typedef struct cf_param_range {
  int count_min, count_max; /* how many numbers; 1, 1 if it does not say */
  double low, high;
  bool low_open, high_open;
} cf_param_range;
cf_param_range cf_param_range_of(const cf_param *param);
bool cf_param_range_has(const cf_param_range *range, double value); /* false for NaN */

/* "> 0", ">= 0 and < 1", "between 0 and 1" ... for "must be %s"; "" if any number will do. */
void cf_param_range_sentence(const cf_param_range *range, char *sentence, size_t size);

/* "number", "list of words" ... */
const char *cf_param_type_name(cf_param_type type);

/* NULL unless the row has one; CF_REQUIRED and CF_NONE give NULL. */
const char *cf_param_default(const cf_param *param);

#endif
