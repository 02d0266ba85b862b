/* SPDX-License-Identifier: MIT
 *
 * What vdb.c needs of OpenVDB, which speaks C++: vdb_shim.cpp gives it a face in C. Nothing else includes this.
 */
#ifndef CF_IO_VDB_SHIM_H
#define CF_IO_VDB_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Voxels 0 <= i < n[0] and so on. One component: values at the centres of voxels. Three: component a on the low faces of
 * axis a. */
typedef struct cf_vdb_grid {
  const char *name, *unit, *field; /* field: what we call it */
  int components, n[3];
  void (*row)(const void *context, int component, int j, int k, float *values); /* n[0] of them */
  const void *context;
  float least; /* voxels with nothing larger than this in size are left out */
} cf_vdb_grid;

typedef struct cf_vdb_file {
  const char *path;
  double h, place[3]; /* spacing of the voxels, and the centre of voxel (0, 0, 0), m */
  bool half;          /* values with 16 bits */
  int grids;
  const cf_vdb_grid *grid;
  const char *title, *program;
  double time, rate; /* s; frames per unit of time, 0: none */
  int64_t step;
} cf_vdb_file;

/* false: why[size] says what OpenVDB said. */
bool cf_vdb_shim_write(const cf_vdb_file *file, char *why, size_t size);

typedef struct cf_vdb_facts {
  char name[64], unit[64], kind[32]; /* kind: "fog volume", "staggered" ... */
  int components;
  int64_t active;
  double h, place[3], low, high; /* of the active values (of vectors: their sizes) */
  double box[2][3];              /* what the active voxels cover, corner to corner */
  bool half;
} cf_vdb_facts;

typedef struct cf_vdb_viewer {
  void (*word)(void *context, const char *name,
               const char *value); /* title, time ... of the file; NULL: not wanted */
  void (*grid)(void *context, const cf_vdb_facts *facts);
  void *context;
} cf_vdb_viewer;

/* Shows what a file has; it may be anybody's. */
bool cf_vdb_shim_look(const char *path, const cf_vdb_viewer *viewer, char *why, size_t size);

/* The value at a voxel. */
bool cf_vdb_shim_probe(const char *path, const char *name, const int at[3], float value[3], char *why,
                       size_t size);

#ifdef __cplusplus
}
#endif

#endif
