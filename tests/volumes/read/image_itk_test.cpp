#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "core/base/units.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/itk_twin.h"
#include "tests/volumes/read/volume_files.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Turned but not sheared, and exact in float (a 3-4-5 triangle in binary fractions is not, so a turn by 90 degrees): what ITK 5.2 reads.
SmallVolume straight_volume() {
  SmallVolume out = small_volume();
  out.lps_mm.linear = Mat3(Vec3(0, 0.5, 0), Vec3(-0.75, 0, 0), Vec3(0, 0, 1.25));
  return out;
}

double apart(const Affine& ours, const TwinVolume& twin) {
  double farthest = glm::length(ours.offset - twin.origin_mm * kMillimetre);
  for (std::size_t n = 0; n < 3; ++n)
    farthest = std::max(farthest, glm::length(ours.linear[n] - twin.direction[n] * twin.spacing_mm[n] * kMillimetre));
  return farthest;
}

/// @param rounding [m] what ITK's float arithmetic on the affine may differ by.
void check_equal(const Result<ReadScan>& ours, const std::string& path, double rounding) {
  INFO(path);
  if (!ours) FAIL(ours.error().text());
  const TwinVolume twin = read_by_itk(path);
  CHECK(ours.value().scan.dims == twin.dims);
  CHECK(apart(ours.value().scan.bone_from_index, twin) < rounding);
  REQUIRE(ours.value().scan.values.size() == twin.values.size());
  std::size_t different = 0;
  for (std::size_t n = 0; n < twin.values.size(); ++n)
    different += ours.value().scan.values[n] != static_cast<float>(twin.values[n]) ? 1 : 0;
  CHECK(different == 0);
}

}  // namespace

TEST_CASE("readers: ITK reads the same voxels at the same place from NIfTI, NRRD and MetaImage") {
  const TemporaryFolder folder;
  const SmallVolume v = straight_volume();
  for (const bool big : {false, true}) {
    const std::string voxels = stored<std::int16_t>(v.values, big), endian = big ? "big" : "little";
    const std::string nifti = nifti_header(v, {.big = big, .slope = 2.5, .intercept = -7.0}) + voxels;
    write_bytes(folder.file("a.nii"), nifti);
    write_bytes(folder.file("a.nii.gz"), gzip(nifti));
    write_bytes(folder.file("a.nrrd"), nrrd_header(v, "short", endian, "raw") + "\n" + voxels);
    write_bytes(folder.file("b.nrrd"), nrrd_header(v, "short", endian, "gzip") + "\n" + gzip(voxels));
    write_bytes(folder.file("a.mha"), meta_header(v, "MET_SHORT", big, false, "LOCAL") + voxels);
    // MetaIO reads no packed data whose size is not said
    const std::string packed = zlib_packed(voxels), size = fmt::format("CompressedDataSize = {}\n", packed.size());
    write_bytes(folder.file("b.mha"), size + meta_header(v, "MET_SHORT", big, true, "LOCAL") + packed);
    // NIfTI in ITK goes through float matrices: 1e-7 of 30 mm; the others keep doubles
    for (const char* const name : {"a.nii", "a.nii.gz"}) check_equal(read_nifti(folder.file(name), {}), folder.file(name), 1e-8);
    for (const char* const name : {"a.nrrd", "b.nrrd"}) check_equal(read_nrrd(folder.file(name), {}), folder.file(name), 1e-12);
    for (const char* const name : {"a.mha", "b.mha"}) check_equal(read_metaimage(folder.file(name), {}), folder.file(name), 1e-12);
  }
}

TEST_CASE("readers: ITK reads the same of real scans") {
  const std::string data = real_data().string();
  // float matrices of ITK's NIfTI on origins of a few 100 mm: 1e-7 of that; a pitched affine is made orthonormal on top
  for (const char* const name : {"/nifti/example_ct.nii.gz", "/nifti/example_ct_sm.nii.gz", "/nifti/CT_pitch.nii.gz"})
    check_equal(read_nifti(data + name, {}), data + name, 1e-6);
  for (const char* const name : {"/nrrd/FLAIR.nrrd", "/nrrd/BallBinary30x30x30.nrrd", "/nrrd/BallBinary30x30x30.nhdr"})
    check_equal(read_nrrd(data + name, {}), data + name, 1e-9);
  for (const char* const name : {"/metaimage/mha.mha", "/head_ct_mha/head.mha"})
    check_equal(read_metaimage(data + name, {}), data + name, 1e-9);
}

TEST_CASE("why the readers decode by themselves: ITK 5.2 refuses a sheared NIfTI and NIfTI-2, which are read here") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  write_bytes(folder.file("sheared.nii"), nifti_header(v, {}) + stored<std::int16_t>(v.values, false));
  write_bytes(folder.file("two.nii"), nifti_header(straight_volume(), {.version = 2}) + stored<std::int16_t>(v.values, false));
  for (const char* const name : {"sheared.nii", "two.nii"}) {
    CHECK_THROWS(static_cast<void>(read_by_itk(folder.file(name))));
    CHECK(read_nifti(folder.file(name), {}).ok());
  }
}
