// The header of a .vdb file before OpenVDB sees it: whole files pass, and no length in it is believed.

#include "core/voxel/vdb_header.h"

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/voxel/vdb_grids.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

std::string fault(const std::string& bytes) {
  std::istringstream in(bytes);
  return vdb_header_fault(in, bytes.size()).value_or("");
}

/// A file with two grids, as the program writes it.
std::string whole_file() {
  const TemporaryFolder folder;
  FloatVdb one("occupancy", 0.0f), two("hardness", 0.0f);
  const std::array<float, 8> values{1, 2, 3, 4, 5, 6, 7, 8};
  one.write_box({{0, 0, 0}, {2, 2, 2}}, values);
  two.write_box({{8, 8, 8}, {10, 10, 10}}, values);
  const std::array<const FloatVdb*, 2> grids{&one, &two};
  REQUIRE(write_vdb(folder.file("a.vdb"), {16, 16, 16}, Affine{Mat3(1e-3), Vec3(0)}, grids, "notes", nullptr));
  std::ifstream file(folder.file("a.vdb"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// @returns the file with the four bytes before a text, which are its length, replaced.
std::string with_length(std::string file, const std::string& text, std::uint32_t length, std::size_t from = 0) {
  const std::size_t at = file.find(text, from);
  REQUIRE(at != std::string::npos);
  std::memcpy(file.data() + at - sizeof length, &length, sizeof length);
  return file;
}

TEST_CASE("vdb header: a file of the program passes, and no part of its header does") {
  const std::string file = whole_file();
  CHECK(fault(file).empty());
  // The name of the last grid's transform is what is read last.
  const std::size_t end = file.rfind("AffineMap") + std::strlen("AffineMap");
  REQUIRE(end < file.size());
  for (std::size_t size = 0; size < end; ++size) {
    CAPTURE(size);
    CHECK_FALSE(fault(file.substr(0, size)).empty());
  }
}

TEST_CASE("vdb header: a length beyond the file is refused, in the first grid and in the second") {
  const std::string file = whole_file();
  const std::size_t second = file.find("hardness");  // in its descriptor
  for (const std::uint32_t length : {0xffffffffu, 0x7fffffffu, static_cast<std::uint32_t>(file.size())}) {
    CHECK(fault(with_length(file, "burrhole_notes", length)).find("beyond its end") != std::string::npos);
    CHECK(fault(with_length(file, "burrhole_notes", length, second)).find("beyond its end") != std::string::npos);
    CHECK_FALSE(fault(with_length(file, "notes", length, file.find("burrhole_notes") + 20)).empty());
  }
  CHECK(fault(with_length(file, "burrhole_notes", 5000) + std::string(10000, 'x')).find("at most 4096 are read") != std::string::npos);
}

TEST_CASE("vdb header: other versions, and files that are none") {
  std::string file = whole_file();
  for (const std::uint32_t version : {0u, 219u, 225u, 0xffffffffu}) {
    std::memcpy(file.data() + 8, &version, sizeof version);
    CHECK(fault(file) == "has version " + std::to_string(version) + " of the format; 220 to 224 are read");
  }
  CHECK(fault("").starts_with("is no .vdb file"));
  CHECK(fault("no grid at all, but a text") == "is no .vdb file");
}

}  // namespace
}  // namespace burrhole
