#include <doctest/doctest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/random.h"
#include "tests/support/plain_trilinear.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"

using namespace burrhole;

// OpenVDB loses the nodes it was building when reading throws within a tree (RootNode::readTopology holds them by bare pointers).
extern "C" const char* __lsan_default_suppressions() { return "leak:readTopology\n"; }

namespace {

constexpr double kMm = 1e-3;
constexpr std::uint64_t kSeed = 31;

ReadOptions options(std::optional<double> unit, const std::string& grid = {}) {
  ReadOptions made;
  made.unit = unit;
  made.series = grid;
  return made;
}

std::string refusal(const std::string& path, const ReadOptions& asked, ErrorCode code = ErrorCode::bad_input) {
  const auto read = read_foreign_vdb(path, asked);
  if (read) return "";
  CHECK(read.error().code == code);
  CHECK(read.error().place == path);
  CHECK(read.error().message.find('\n') == std::string::npos);
  return read.error().message;
}

openvdb::FloatGrid::Ptr named(openvdb::FloatGrid::Ptr grid, const std::string& name) {
  grid->setName(name);
  return grid;
}

/// Fog: a block of `value`, in voxels of 2 x 3 x 4 with shear.
openvdb::FloatGrid::Ptr fog(const std::string& name, int edge, float value, float background = 0.0f) {
  auto grid = openvdb::FloatGrid::create(background);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-2), openvdb::Coord(-3 + edge)), value);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  const openvdb::Mat4d m(2.0, 0.0, 0.0, 0.0, 0.5, 3.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 10.0, 20.0, 30.0,
                         1.0);  // rows are what index axes map to
  grid->setTransform(openvdb::math::Transform::createLinearTransform(m));
  return named(grid, name);
}

void write(const std::string& path, const openvdb::GridCPtrVec& grids) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.write(grids);
}

double occupancy(const Scan& scan, const Vec3& p) {
  return test::plain_trilinear(scan.bone_from_index.inverse() * p, [&](const Vec3i& v) {
    return scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of(v)];
  });
}

std::string bytes_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("foreign vdb: a level set of a sphere has its 0.5 level on the sphere, with its interior full") {
  openvdb::initialize();
  const TemporaryFolder folder;
  // 20 voxels in radius, centre off the lattice, lengths in cm: voxels of 0.1 cm.
  const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.0f, openvdb::Vec3f(0.537f, -0.281f, 0.112f), 0.1f, 3.0f);
  write(folder.file("s.vdb"), {named(sphere, "skull")});
  const auto read = read_foreign_vdb(folder.file("s.vdb"), options(0.01));
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  const Scan& scan = read->scan;
  CHECK(scan.quantity == Quantity::occupancy);
  const Vec3 centre = 0.01 * Vec3(0.537, -0.281, 0.112);
  const double radius = 0.02, pitch = 0.001;
  CHECK(occupancy(scan, centre) == doctest::Approx(1.0).epsilon(1e-12));
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const double z = uniform11(kSeed, 2 * n), angle = 3.14159265358979 * uniform11(kSeed, 2 * n + 1);
    const Vec3 d(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    double t0 = 0.8 * radius, t1 = radius + 2 * pitch;
    REQUIRE(occupancy(scan, centre + t0 * d) > 0.5);
    REQUIRE(occupancy(scan, centre + t1 * d) < 0.5);
    for (int step = 0; step < 50; ++step) {
      const double t = 0.5 * (t0 + t1);
      (occupancy(scan, centre + t * d) >= 0.5 ? t0 : t1) = t;
    }
    worst = std::max(worst, std::abs(t0 - radius));
  }
  MESSAGE("level set of 20 voxels radius: 0.5 level at most " << worst / pitch << " voxel off");
  // pitch / (4 radius) = 0.0125 of a voxel by curvature, as for any sphere on such a ramp, and w turning with the normal: up to 0.005; w
  // from one-sided steps is too large by up to pitch / (2 radius) of itself, alike all round: another 0.0025 at the ramp's slope.
  CHECK(worst < 0.02 * pitch);
  CHECK(read->report.assumed.at(1) == "one unit of the file is 10 mm");
}

TEST_CASE("foreign vdb: a fog volume keeps its values and its sheared map, and others are reported") {
  openvdb::initialize();
  const TemporaryFolder folder;
  const auto vectors = openvdb::Vec3SGrid::create();
  vectors->setName("velocity");
  write(folder.file("f.vdb"), {fog("small", 3, 0.25f), fog("large", 6, 0.75f), vectors});
  const auto read = read_foreign_vdb(folder.file("f.vdb"), options(kMm));
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  const Scan& scan = read->scan;
  CHECK(scan.dims == Vec3i(6 + 4));
  for_each_voxel({Vec3i(0), scan.dims}, [&](const Vec3i& v) {
    const bool inside = VoxelBox{Vec3i(2), Vec3i(8)}.contains(v);
    CHECK(scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of(v)] == (inside ? 0.75f : 0.0f));
  });
  // Index (0, 0, 0) of the grid is voxel (4, 4, 4) here; steps of i, j, k lead where the rows of the matrix say.
  const double rounding = 1e-15;
  const auto near = [&](const Vec3& a, const Vec3& b) { return glm::length(a - b) < rounding; };
  CHECK(near(scan.bone_from_index * Vec3(4), kMm * Vec3(10, 20, 30)));
  CHECK(near(scan.bone_from_index.linear[0], kMm * Vec3(2, 0, 0)));
  CHECK(near(scan.bone_from_index.linear[1], kMm * Vec3(0.5, 3, 0)));
  CHECK(near(scan.bone_from_index.linear[2], kMm * Vec3(0, 0, 4)));
  REQUIRE(read->report.skipped.size() == 2);
  CHECK(read->report.skipped[0].reason == "another float grid: small");
  CHECK(read->report.skipped[1].reason == "grid that holds no floats");
  CHECK(read->report.assumed.at(2) == "grid \"large\" is a fog volume of 216 active voxels; its values are taken for occupancy");

  const auto chosen = read_foreign_vdb(folder.file("f.vdb"), options(kMm, "small"));
  REQUIRE(chosen.ok());
  CHECK(chosen->scan.dims == Vec3i(3 + 4));
  CHECK(refusal(folder.file("f.vdb"), options(kMm, "medium")) == "holds no float grid \"medium\"; it has \"small\", \"large\"");
  CHECK(refusal(folder.file("f.vdb"), options(kMm, "velocity")) == "holds no float grid \"velocity\"; it has \"small\", \"large\"");
}

TEST_CASE("foreign vdb: values outside 0..1 are clamped and reported, not finite ones refused") {
  openvdb::initialize();
  const TemporaryFolder folder;
  auto grid = fog("smoke", 4, 3.5f);
  grid->tree().setValue(openvdb::Coord(0), -1.0f);
  write(folder.file("c.vdb"), {grid});
  const auto read = read_foreign_vdb(folder.file("c.vdb"), options(kMm));
  REQUIRE(read.ok());
  CHECK(read->report.assumed.back() == "64 values outside 0..1 are clamped");
  for (const float v : read->scan.values) CHECK((v == 0.0f || v == 1.0f));
  grid->tree().setValue(openvdb::Coord(1), std::nanf(""));
  write(folder.file("n.vdb"), {grid});
  CHECK(refusal(folder.file("n.vdb"), options(kMm)) == "grid \"smoke\" holds 1 values that are not finite");
}

TEST_CASE("foreign vdb: refusals say what and how much") {
  openvdb::initialize();
  const TemporaryFolder folder;
  write(folder.file("good.vdb"), {fog("density", 4, 1.0f)});
  CHECK(refusal(folder.file("good.vdb"), {}) == "a .vdb of another program carries no unit of length: give --unit mm, cm, m or in");
  CHECK(refusal(folder.file("good.vdb"), options(0.0)) == "unit = 0 m must be > 0");
  ReadOptions little = options(kMm);
  little.memory = 2047.0;  // 8 x 8 x 8 floats take 2048
  CHECK(refusal(folder.file("good.vdb"), little, ErrorCode::unavailable).starts_with("grid \"density\" spans 8 x 8 x 8 voxels: needs"));
  little.memory = 2048.0;
  CHECK(refusal(folder.file("good.vdb"), little) == "");
  CHECK(refusal(folder.file("none.vdb"), options(kMm)) == "cannot be read: No such file or directory");
  write(folder.file("empty.vdb"), {named(openvdb::FloatGrid::create(0.0f), "nothing")});
  CHECK(refusal(folder.file("empty.vdb"), options(kMm)) == "grid \"nothing\" is empty");
  write(folder.file("vectors.vdb"), {openvdb::Vec3SGrid::create()});
  CHECK(refusal(folder.file("vectors.vdb"), options(kMm)) == "holds no float grid");
  write(folder.file("full.vdb"), {fog("rock", 4, 0.0f, 1.0f)});
  CHECK(refusal(folder.file("full.vdb"), options(kMm)) == "grid \"rock\" has infinite bone: its background is 1");
  auto far = fog("far", 4, 1.0f);
  far->tree().setValue(openvdb::Coord(20000, 9000, 0), 1.0f);
  write(folder.file("far.vdb"), {far});
  CHECK(refusal(folder.file("far.vdb"), options(kMm)) == "grid \"far\" spans 20007 x 9007 x 8 voxels (5.77 GB), at most 1e+09 are allowed");
  far->tree().setValue(openvdb::Coord(2147483000, 0, 0), 1.0f);
  write(folder.file("farther.vdb"), {far});
  CHECK(refusal(folder.file("farther.vdb"), options(kMm)) == "grid \"far\" has voxels at indices beyond 2^28");
  auto frustum = fog("camera", 4, 1.0f);
  frustum->setTransform(
      openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(100)), 0.6, 100.0));
  write(folder.file("camera.vdb"), {frustum});
  CHECK(refusal(folder.file("camera.vdb"), options(kMm)) == "grid \"camera\" lies in a camera's frustum, not on an affine grid");
}

TEST_CASE("foreign vdb: cut and damaged files are refused or read, never a crash") {
  openvdb::initialize();
  const TemporaryFolder folder;
  const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.2f, openvdb::Vec3f(0.0f), 0.1f, 3.0f);
  write(folder.file("s.vdb"), {named(sphere, "skull")});
  const std::string bytes = bytes_of(folder.file("s.vdb"));
  REQUIRE(read_foreign_vdb(folder.file("s.vdb"), options(0.01)).ok());
  // Damage beyond the first tenth, which is the header: vdb_header_test.cpp.
  std::size_t refused = 0;
  for (std::uint64_t n = 0; n < 20; ++n) {
    std::string bad = bytes;
    for (std::uint64_t m = 0; m < 4; ++m)
      bad[static_cast<std::size_t>((0.1 + 0.9 * uniform01(kSeed, 1000 + 10 * n + 2 * m)) * static_cast<double>(bytes.size()))] =
          static_cast<char>(static_cast<int>(256.0 * uniform01(kSeed, 1001 + 10 * n + 2 * m)));
    std::ofstream(folder.file("bad.vdb"), std::ios::binary) << bad;
    refused += refusal(folder.file("bad.vdb"), options(0.01)) != "" ? 1 : 0;
  }
  MESSAGE(refused << " of 20 damaged files were refused; values have no check sum, so the others were read");
  std::string newer = bytes;
  newer[8] = '\xff';
  std::ofstream(folder.file("newer.vdb"), std::ios::binary) << newer;
  CHECK(refusal(folder.file("newer.vdb"), options(0.01)) == "has version 255 of the format; 220 to 224 are read");
  std::ofstream(folder.file("text.vdb"), std::ios::binary) << "no grid at all, but a text";
  CHECK(refusal(folder.file("text.vdb"), options(0.01)) == "is no .vdb file");
  for (std::size_t n = 0; n < 20; ++n) {
    std::ofstream(folder.file("cut.vdb"), std::ios::binary) << bytes.substr(0, bytes.size() * n / 20);
    CAPTURE(n);
    CHECK(refusal(folder.file("cut.vdb"), options(0.01)) != "");
  }
}

TEST_CASE("foreign vdb: real fog volumes are read") {
  const std::string data = real_data("vdb").string();
  for (const auto& [file, dims] : {std::pair{"sphere.vdb", Vec3i(25 + 4)}, std::pair{"torus01.vdb", Vec3i(22 + 4, 9 + 4, 22 + 4)}}) {
    const auto read = read_foreign_vdb(data + "/" + file, options(kMm * 10));
    REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
    CHECK(read->scan.dims == dims);
    CHECK(*std::max_element(read->scan.values.begin(), read->scan.values.end()) > 0.9f);
    for (const std::string& line : read->report.assumed) MESSAGE(std::string(file) << ": " << line);
  }
}
