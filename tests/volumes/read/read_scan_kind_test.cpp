#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/dicom_writer.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

std::string format_of(const std::string& path, const ReadOptions& options = {}) {
  const auto read = read_scan(path, options);
  return read ? read->report.format : read.error().text();
}

std::string format_of_bytes(const std::string& path, const std::string& bytes) {
  write_bytes(path, bytes);
  return format_of(path);
}

}  // namespace

TEST_CASE("read_scan: meshes without their ending, and with it in capitals") {
  const TemporaryFolder folder;
  const auto copy = [&](const std::string& from, const std::string& name) {
    std::filesystem::copy_file(from, folder.file(name));
    return folder.file(name);
  };
  ReadOptions options;
  options.unit = 1e-3;
  options.pitch = 0.5e-3;
  const SurfaceMesh box = box_mesh({0.005, 0.005, 0.005});
  const std::string text = write_mesh(folder.file("text"), box, MeshForm::stl_text),
                    ply = write_mesh(folder.file("ply"), box, MeshForm::ply);
  const std::string binary = write_mesh(folder.file("binary"), box, MeshForm::stl_binary);
  CHECK(format_of(copy(text, "A.STL"), options) == "STL");
  CHECK(format_of(copy(text, "mesh1"), options) == "STL");
  CHECK(format_of(copy(ply, "mesh2"), options) == "PLY");
  CHECK(format_of(copy(binary, "B.STL"), options) == "STL");
  CHECK(format_of(copy(binary, "mesh3"), options).find("is not in a supported format") != std::string::npos);
}

TEST_CASE("read_scan: a DICOM file without its ending, and without its preamble") {
  const TemporaryFolder folder;
  const std::string file = ct_slice({}).file(), implicit = ct_slice({}).file(kImplicitLittle);
  const std::size_t begin = implicit.find(std::string("\x08\x00", 2), 132);  // from its first element of group 0008 on
  CHECK(format_of_bytes(folder.file("slice1"), file) == "DICOM");
  CHECK(format_of_bytes(folder.file("B.DCM"), file) == "DICOM");
  CHECK(format_of_bytes(folder.file("slice2"), file.substr(132)) == "DICOM");
  CHECK(format_of_bytes(folder.file("slice3"), implicit.substr(begin)) == "DICOM");
  // No data set begins with group 0009.
  std::string other = implicit.substr(begin);
  other[0] = '\x09';
  CHECK(format_of_bytes(folder.file("slice4"), other).find("is not in a supported format") != std::string::npos);
}
