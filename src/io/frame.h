/* SPDX-License-Identifier: MIT
 *
 * Frames: what a run shows at one time, in the VTKHDF layout that ParaView (5.12 and later), VTK and h5py
 * read.
 *
 *   fields_000012.vtkhdf      ImageData. /VTKHDF/CellData/phi, shape (nz, ny, nx), nz = 1 in 2D (one cell thick).
 *                             A face field q is there as vectors at the cells (means of the two faces), and as
 *                             stored under /faces/q/x, /y, /z (low faces, and the last face of the axis). Numbers
 *                             and counters under /VTKHDF/FieldData, with `Time`.
 *   particles_000012.vtkhdf   PolyData: /VTKHDF/Points, attributes and `id` under /VTKHDF/PointData. Of a run with
 *                             several sets this is the first; the others are particles_SET_000012.vtkhdf.
 *   fields.vtkhdf.series      the times of all frames, for ParaView; likewise for particles
 *
 * Every array has its unit as an attribute; the file has title, version, precision, time, step and frame.
 * Values keep the precision of the state. The same run writes the same bytes.
 */
#ifndef CF_IO_FRAME_H
#define CF_IO_FRAME_H

#include "grid/mesh.h"
#include "io/folder.h"
#include "io/parts.h"
#include "io/stamp.h"

#define CF_FRAME_FIELDS 64

typedef struct cf_frame_plan {
  cf_choice choice;
  int compression; /* 0 (none) to 9 */
} cf_frame_plan;

/* Writes the files of frame number `frame` and lists its time in the series. CF_BAD_ARGUMENT: a name that the
 * registry does not have. CF_CANNOT_WRITE with path and reason; earlier frames are not touched. */
cf_status cf_frame_write(const char *folder, int64_t frame, const cf_registry *r, const cf_frame_plan *plan,
                         const cf_stamp *stamp);

/* Writes mesh_<frame>.vtkhdf (PolyData: triangles, `Normals` and the attributes under PointData) and lists its time in
 * mesh.vtkhdf.series. `g` says the dimension. CF_CANNOT_WRITE. */
cf_status cf_frame_write_mesh(const char *folder, int64_t frame, const cf_grid *g, const cf_mesh *mesh,
                              const cf_stamp *stamp);

/* Removes all frames numbered above `last` (files of every format) and their lines in the series. */
cf_status cf_frame_cut(const char *folder, int64_t last);

/* --- reading ---------------------------------------------------------------------------------------- */

typedef struct cf_frame_field {
  char name[CF_NAME_MAX], unit[CF_NAME_MAX];
  int components; /* 1, or 3 for vectors */
} cf_frame_field;

typedef struct cf_frame {
  cf_path path;
  cf_grid grid; /* with no ghosts; 2D where the file says so */
  char title[256], version[64], precision[16];
  double time;
  int64_t step, frame;
  int count;
  cf_frame_field field[CF_FRAME_FIELDS];
} cf_frame;

/* What is in a frame's file. CF_BAD_FILE. */
cf_status cf_frame_read(cf_frame *f, const char *path);

/* The values of one field into `values`, a field shaped by f->grid.box. `component`: 0..2, or CF_MAGNITUDE of
 * a vector. CF_BAD_ARGUMENT: no such field (the sentence lists those there are). */
cf_status cf_frame_read_cell(const cf_frame *f, const char *name, int component, cf_cell values);
#define CF_MAGNITUDE (-1)

#endif
