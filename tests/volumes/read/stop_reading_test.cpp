// A reading that shall stop ends with an error, of slices, a mesh or grids, and reports no more of its progress.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <string>

#include "tests/support/dicom_writer.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/temporary_folder.h"
#include "volumes/import_bone.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Reads until the share done has been reported `reports` times. @returns how often it was reported in all.
int reports_until_stopped(const std::string& path, int reports) {
  std::stop_source source;
  if (reports == 0) source.request_stop();
  int calls = 0;
  ReadOptions options;
  if (path.ends_with(".stl") || path.ends_with(".vdb")) options.unit = 1e-3;
  options.stop = source.get_token();
  options.progress = [&](double) {
    if (++calls == reports) source.request_stop();
  };
  const auto read = read_scan(path, options);
  REQUIRE_FALSE(read.ok());
  CHECK(read.error().code == ErrorCode::unavailable);
  CHECK(read.error().message.find("stopped") != std::string::npos);
  return calls;
}

std::string write_slices(const TemporaryFolder& folder) {
  for (int k = 0; k < 4; ++k) {
    CtSlice slice;
    slice.position.z += k;
    slice.instance = fmt::format("{}.{}", slice.series, k + 1);
    ct_slice(slice).write(folder.file(fmt::format("slice{}", k)));
  }
  return folder.path().string();
}

std::string write_ball(const TemporaryFolder& folder) {
  return write_mesh(folder.file("ball"), sphere_mesh(Vec3(0), 0.02, 3), MeshForm::stl_binary);
}

/// Deep enough for several slabs.
std::string write_fog(const TemporaryFolder& folder) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0.0f);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(3, 3, 299)), 1.0f);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setName("fog");
  openvdb::io::File file(folder.file("fog.vdb"));
  file.write({grid});
  return folder.file("fog.vdb");
}

}  // namespace

TEST_CASE("readers: a reading that shall stop before its first value reports nothing") {
  const TemporaryFolder slices, others;
  for (const std::string& path : {write_slices(slices), write_ball(others), write_fog(others)}) {
    CAPTURE(path);
    CHECK(reports_until_stopped(path, 0) == 0);
  }
}

TEST_CASE("readers: a reading stops between the headers of a folder, before it knows what is wrong with the series") {
  const TemporaryFolder uneven;
  for (const double z : {0.0, 1.0, 3.7, 4.1}) {
    CtSlice slice;
    slice.position.z += z;
    slice.instance = fmt::format("{}.{}", slice.series, z);
    ct_slice(slice).write(uneven.file(fmt::format("slice{}", z)));
  }
  const auto whole = read_scan(uneven.path().string(), {});
  REQUIRE_FALSE(whole.ok());
  CHECK(whole.error().code == ErrorCode::bad_input);
  CHECK(reports_until_stopped(uneven.path().string(), 0) == 0);
}

TEST_CASE("readers: of a scan that was read when the reading shall stop no bone is made") {
  const TemporaryFolder slices;
  std::stop_source source;
  ImportRequest request{write_slices(slices), {}, {}};
  request.read.stop = source.get_token();
  request.read.progress = [&](double share) {
    if (share == 1.0) source.request_stop();
  };
  const auto bone = import_bone(request, {});
  REQUIRE(source.stop_requested());
  REQUIRE_FALSE(bone.ok());
  CHECK(bone.error().code == ErrorCode::unavailable);
  CHECK(bone.error().message.find("stopped") != std::string::npos);
}

TEST_CASE("readers: a reading stops at the next slice or slab") {
  const TemporaryFolder slices, others;
  for (const std::string& path : {write_slices(slices), write_ball(others), write_fog(others)}) {
    CAPTURE(path);
    CHECK(reports_until_stopped(path, 2) == 2);
  }
}
