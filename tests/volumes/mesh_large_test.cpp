// A mesh file of ten million triangles: read right, within stated memory. A program of its own, as memory is the process's.

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <string>

#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"

using namespace burrhole;

namespace {

constexpr std::uint32_t kAround = 2500, kAcross = 2000;  // two triangles for each product
constexpr double kRing = 30.0, kTube = 10.0;             // [mm] radii of a torus

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Writes the torus as a binary PLY in mm, piece by piece. @param last corner of the last triangle.
void write_torus(const std::string& path, std::uint32_t last) {
  std::ofstream file(path, std::ios::binary);
  constexpr std::uint32_t kVertices = kAround * kAcross, kTriangles = 2 * kVertices;
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << kVertices
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << kTriangles
       << "\nproperty list uchar uint vertex_indices\nend_header\n";
  std::string piece;
  for (std::uint32_t i = 0; i < kAround; ++i, piece.clear()) {
    const double u = 2.0 * std::numbers::pi * i / kAround;
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const double v = 2.0 * std::numbers::pi * j / kAcross, r = kRing + kTube * std::cos(v);
      for (const double x : {r * std::cos(u), r * std::sin(u), kTube * std::sin(v)}) put(piece, static_cast<float>(x));
    }
    file << piece;
  }
  const auto at = [](std::uint32_t i, std::uint32_t j) { return i % kAround * kAcross + j % kAcross; };
  for (std::uint32_t i = 0; i < kAround; ++i, piece.clear()) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const bool at_end = i + 1 == kAround && j + 1 == kAcross;
      for (const std::uint32_t id : {at(i, j), at(i + 1, j), at(i + 1, j + 1)}) {
        if (id == at(i, j)) put(piece, std::uint8_t{3});
        put(piece, id);
      }
      put(piece, std::uint8_t{3});
      for (const std::uint32_t id : {at(i, j), at(i + 1, j + 1), at_end && last > 0 ? last : at(i, j + 1)}) put(piece, id);
    }
    file << piece;
  }
}

}  // namespace

TEST_CASE(
    "read_mesh_scan: ten million triangles keep the volume of their closed form within 3 GiB, and one wrong index among them is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("torus.ply");
  ReadOptions options;
  options.unit = 1e-3;
  options.pitch = 0.5e-3;
  write_torus(path, kAround * kAcross);
  const auto refused = read_mesh_scan(path, options);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().message == "a face names vertex 5000000 of 5000000");
  write_torus(path, 7);
  const auto open = read_mesh_scan(path, options);
  REQUIRE_FALSE(open.ok());
  CHECK_MESSAGE(open.error().message.starts_with("open: "), open.error().message);
  write_torus(path, 0);
  const auto read = read_mesh_scan(path, options);
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  CHECK(read->report.skipped.empty());
  CHECK(read->report.assumed.back().starts_with("solid within 1 closed surface, "));
  double volume = 0.0;
  for (const float v : read->scan.values) volume += static_cast<double>(v) * 0.125;
  const double exact = 2.0 * std::numbers::pi * std::numbers::pi * kRing * kTube * kTube;
  MESSAGE("volume " << volume / exact - 1.0 << " off");
  // Chords take 1e-6; the ramp of occupancy weighs its outer half more, by (1 + 4 / pi) (pitch / radius)^2 on a ball, less on a tube.
  CHECK(std::abs(volume / exact - 1.0) < (1.0 + 4.0 / std::numbers::pi) * (0.5 / kTube) * (0.5 / kTube));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  MESSAGE("peak memory " << usage.ru_maxrss / 1024 << " MiB");
  CHECK(usage.ru_maxrss < 3L * 1024 * 1024);
}
