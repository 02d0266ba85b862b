// SPDX-License-Identifier: MIT
//
// The one file in C++. Compiled with -O1: OpenVDB's headers are long. No exception leaves it.
#include "io/vdb_shim.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

namespace {

using openvdb::Coord;

// How a tree takes what rows give.
struct Scalar {
  using Grid = openvdb::FloatGrid;
  static float value(const std::vector<float> *row, size_t i) { return row[0][i]; }
  static float size(const std::vector<float> *row, size_t i) { return std::fabs(row[0][i]); }
};

struct Vector {
  using Grid = openvdb::Vec3SGrid;
  static openvdb::Vec3s value(const std::vector<float> *row, size_t i) { return {row[0][i], row[1][i], row[2][i]}; }
  static float size(const std::vector<float> *row, size_t i) {
    return std::fmax(std::fabs(row[0][i]), std::fmax(std::fabs(row[1][i]), std::fabs(row[2][i])));
  }
};

template <typename Kind>
typename Kind::Grid::Ptr make(const cf_vdb_grid &g) {
  auto grid = Kind::Grid::create();
  auto to = grid->getAccessor();
  std::vector<float> row[3];
  for (auto &r : row) r.resize(static_cast<size_t>(g.n[0]));
  for (int k = 0; k < g.n[2]; ++k)
    for (int j = 0; j < g.n[1]; ++j) {
      for (int c = 0; c < g.components; ++c) g.row(g.context, c, j, k, row[c].data());
      for (int i = 0; i < g.n[0]; ++i) {
        const auto at = static_cast<size_t>(i);
        if (Kind::size(row, at) > g.least) to.setValueOn(Coord(i, j, k), Kind::value(row, at));
      }
    }
  grid->pruneGrid();
  return grid;
}

openvdb::GridBase::Ptr make_grid(const cf_vdb_file &file, const cf_vdb_grid &g) {
  openvdb::GridBase::Ptr grid;
  if (g.components == 1) {
    grid = make<Scalar>(g);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  } else {
    grid = make<Vector>(g);
    grid->setGridClass(openvdb::GRID_STAGGERED);
    grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  }
  auto transform = openvdb::math::Transform::createLinearTransform(file.h);
  transform->postTranslate(openvdb::Vec3d(file.place));
  grid->setTransform(transform);
  grid->setName(g.name);
  grid->setSaveFloatAsHalf(file.half);
  grid->insertMeta("unit", openvdb::StringMetadata(g.unit));
  grid->insertMeta("field", openvdb::StringMetadata(g.field));
  return grid;
}

openvdb::MetaMap describe(const cf_vdb_file &file) {
  openvdb::MetaMap meta;
  meta.insertMeta("title", openvdb::StringMetadata(file.title));
  meta.insertMeta("creator", openvdb::StringMetadata(file.program));
  meta.insertMeta("length_unit", openvdb::StringMetadata("m"));
  meta.insertMeta("time_unit", openvdb::StringMetadata("s"));
  meta.insertMeta("time", openvdb::DoubleMetadata(file.time));
  meta.insertMeta("step", openvdb::Int64Metadata(file.step));
  if (file.rate > 0) meta.insertMeta("frames_per_second", openvdb::DoubleMetadata(file.rate));
  return meta;
}

// As openvdb::io::File writes, which does not notice a full disk.
class Writer final : public openvdb::io::Archive {
public:
  Ptr copy() const override { return Ptr(new Writer(*this)); }

  void save(const char *path, const openvdb::GridCPtrVec &grids, const openvdb::MetaMap &meta) {
    // Blosc, which OpenVDB itself prefers, packs nearly as well as ZIP in a tenth of the time.
    const auto packer = hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP;
    setCompression(packer | openvdb::io::COMPRESS_ACTIVE_MASK);
    errno = 0;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    if (out) write(out, grids, true, meta);
    if (!out.flush()) throw std::runtime_error(errno != 0 ? std::strerror(errno) : "the disk takes no more");
  }
};

// Every file gets a random identifier in its head, as text of 36 letters; ours has zeros, so that the same values are
// the same bytes.
void forget_identifier(const char *path) {
  std::FILE *f = std::fopen(path, "r+b");
  char head[96] = "";
  if (f == nullptr) return;
  const size_t size = std::fread(head, 1, sizeof head, f);
  for (size_t at = 0; at + 36 <= size; ++at) {
    if (head[at + 8] != '-' || head[at + 13] != '-' || head[at + 18] != '-' || head[at + 23] != '-') continue;
    std::fseek(f, static_cast<long>(at), SEEK_SET);
    std::fwrite("00000000-0000-0000-0000-000000000000", 1, 36, f);
    break;
  }
  std::fclose(f);
}

bool say(const char *what, char *why, size_t size) {
  std::snprintf(why, size, "%s", what);
  return false;
}

template <typename Task>
bool guarded(Task task, char *why, size_t size) {
  try {
    openvdb::initialize();
    task();
    return true;
  } catch (const std::exception &e) {
    return say(e.what(), why, size);
  } catch (...) {
    return say("for a reason OpenVDB does not give", why, size);
  }
}

template <typename GridType, typename Size>
void look_at_values(const GridType &grid, Size size_of, cf_vdb_facts &facts) {
  bool first = true;
  for (auto at = grid.cbeginValueOn(); at; ++at) {
    const double size = size_of(*at);
    facts.low = first ? size : std::fmin(facts.low, size);
    facts.high = first ? size : std::fmax(facts.high, size);
    first = false;
  }
}

cf_vdb_facts look_at(const openvdb::GridBase &grid) {
  cf_vdb_facts facts = {};
  std::snprintf(facts.name, sizeof facts.name, "%s", grid.getName().c_str());
  std::snprintf(facts.kind, sizeof facts.kind, "%s", openvdb::GridBase::gridClassToString(grid.getGridClass()).c_str());
  if (const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit"))
    std::snprintf(facts.unit, sizeof facts.unit, "%s", unit->value().c_str());
  facts.active = static_cast<int64_t>(grid.activeVoxelCount());
  facts.h = grid.voxelSize()[0];
  facts.half = grid.saveFloatAsHalf();
  const auto place = grid.indexToWorld(Coord(0, 0, 0));
  const auto used = grid.evalActiveVoxelBoundingBox();
  const openvdb::Vec3d half(0.5);
  const auto low = grid.indexToWorld(used.min().asVec3d() - half), high = grid.indexToWorld(used.max().asVec3d() + half);
  for (int a = 0; a < 3; ++a) facts.place[a] = place[a], facts.box[0][a] = low[a], facts.box[1][a] = high[a];
  facts.components = grid.isType<openvdb::FloatGrid>() ? 1 : grid.isType<openvdb::Vec3SGrid>() ? 3 : 0;
  if (facts.components == 1)
    look_at_values(static_cast<const openvdb::FloatGrid &>(grid), [](float v) { return double(v); }, facts);
  if (facts.components == 3)
    look_at_values(static_cast<const openvdb::Vec3SGrid &>(grid), [](const openvdb::Vec3s &v) { return double(v.length()); },
                   facts);
  return facts;
}

}  // namespace

bool cf_vdb_shim_write(const cf_vdb_file *file, char *why, size_t size) {
  return guarded(
      [&] {
        openvdb::GridCPtrVec grids;
        for (int g = 0; g < file->grids; ++g) grids.push_back(make_grid(*file, file->grid[g]));
        Writer().save(file->path, grids, describe(*file));
        forget_identifier(file->path);
      },
      why, size);
}

bool cf_vdb_shim_look(const char *path, const cf_vdb_viewer *viewer, char *why, size_t size) {
  return guarded(
      [&] {
        openvdb::io::File in(path);
        in.open();
        const auto meta = in.getMetadata();
        for (auto at = meta->beginMeta(); viewer->word != nullptr && at != meta->endMeta(); ++at)
          viewer->word(viewer->context, at->first.c_str(), at->second->str().c_str());
        const auto grids = in.getGrids();
        for (const auto &grid : *grids) {
          const cf_vdb_facts facts = look_at(*grid);
          viewer->grid(viewer->context, &facts);
        }
      },
      why, size);
}

bool cf_vdb_shim_probe(const char *path, const char *name, const int at[3], float value[3], char *why, size_t size) {
  return guarded(
      [&] {
        openvdb::io::File in(path);
        in.open();
        const auto grid = in.readGrid(name);
        const Coord place(at[0], at[1], at[2]);
        value[0] = value[1] = value[2] = 0;
        if (const auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) value[0] = scalar->tree().getValue(place);
        if (const auto vector = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid))
          for (int a = 0; a < 3; ++a) value[a] = vector->tree().getValue(place)[a];
      },
      why, size);
}
