#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string format_of(const std::string& path) {
  const auto read = read_scan(path, {});
  return read ? read.value().report.format : read.error().text();
}

}  // namespace

TEST_CASE("read_scan: the ending says the format, and without one the content") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  const std::string voxels = stored<std::int16_t>(v.values, false);
  const auto write = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.file(name), bytes);
    return folder.file(name);
  };
  for (const char* const name : {"a.nii", "A.NII", "noending1"}) CHECK(format_of(write(name, nifti_header(v, {}) + voxels)) == "NIfTI-1");
  CHECK(format_of(write("two", nifti_header(v, {.version = 2}) + voxels)) == "NIfTI-2");
  for (const char* const name : {"a.nii.gz", "noending2"}) CHECK(format_of(write(name, gzip(nifti_header(v, {}) + voxels))) == "NIfTI-1");
  for (const char* const name : {"a.nrrd", "noending3"})
    CHECK(format_of(write(name, nrrd_header(v, "short", "little", "raw") + "\n" + voxels)) == "NRRD");
  for (const char* const name : {"a.mha", "noending4"})
    CHECK(format_of(write(name, meta_header(v, "MET_SHORT", false, false, "LOCAL") + voxels)) == "MetaImage");
  write("v.bin", voxels);
  CHECK(format_of(write("v.toml", raw_sidecar(v, "little", "data = \"v.bin\""))) == "raw");
}

TEST_CASE("read_scan: what is of no known kind is refused with the list of what is read") {
  const TemporaryFolder folder;
  CHECK(holds(format_of(folder.file("none")), "no such file or folder"));
  for (const std::string& bytes : {std::string(), std::string("hello world\n"), std::string(5000, 'x')}) {
    write_bytes(folder.file("unknown"), bytes);
    const std::string error = format_of(folder.file("unknown"));
    CHECK(error.starts_with(folder.file("unknown") + ": is not in a supported format"));
    for (const char* const kind : {"DICOM", ".nii", ".nrrd", ".mha", ".toml", ".stl", ".vdb"}) CHECK(holds(error, kind));
    CHECK_FALSE(holds(error, "\n"));
  }
}

TEST_CASE("read_scan: voxels that are not finite are counted and refused") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  std::string voxels = stored<float>(v.values, false);
  for (std::size_t n = 0; n < 17; ++n) set(voxels, 8 * n, n % 2 == 0 ? std::nanf("") : HUGE_VALF, false);
  write_bytes(folder.file("n.nrrd"), nrrd_header(v, "float", "little", "raw") + "\n" + voxels);
  CHECK(format_of(folder.file("n.nrrd")) == folder.file("n.nrrd") + ": holds 17 NaN or infinite voxels");
  // values that only become infinite as floats
  SmallVolume wide = v;
  std::string doubles = stored<double>(wide.values, false);
  set(doubles, 0, 1e300, false);
  write_bytes(folder.file("d.nrrd"), nrrd_header(wide, "double", "little", "raw") + "\n" + doubles);
  CHECK(holds(format_of(folder.file("d.nrrd")), "holds 1 NaN or infinite"));
}

TEST_CASE("read_scan: a volume that takes more memory than there is is refused with both numbers") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  const double bytes = 4.0 * static_cast<double>(v.values.size());
  const std::string voxels = stored<std::int16_t>(v.values, false);
  write_bytes(folder.file("v.nii.gz"), gzip(nifti_header(v, {}) + voxels));
  write_bytes(folder.file("v.nrrd"), nrrd_header(v, "short", "little", "raw") + "\n" + voxels);
  for (const char* const name : {"v.nii.gz", "v.nrrd"}) {
    ReadOptions options;
    options.memory = bytes;
    CHECK(read_scan(folder.file(name), options).ok());
    options.memory = bytes - 1.0;
    const auto read = read_scan(folder.file(name), options);
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().code == ErrorCode::unavailable);
    CHECK(read.error().place == folder.file(name));
    CHECK(holds(read.error().message, "GB are available"));
  }
}
