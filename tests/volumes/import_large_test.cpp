// A whole head at 512 x 512 x 300: read right, and within the memory that is promised. A program of its own, as memory is the process's.

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <filesystem>

#include "app/bench/dicom_series.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/import_bone.h"

using namespace burrhole;

TEST_CASE("import: 300 DICOM slices of 512 x 512 stay within 1.5 GiB, and every value is its file's") {
  constexpr int kSlices = 300;
  const TemporaryFolder folder;
  const auto files = write_long_series(real_data("head_ct_dicom_phantom_1mm").string(), folder.path().string(), kSlices);
  REQUIRE(files);
  const auto imported = import_bone({folder.path().string(), {}, {}}, {});
  REQUIRE_MESSAGE(imported.ok(), imported.error().text());
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  MESSAGE("peak memory " << usage.ru_maxrss / 1024 << " MiB");
  CHECK(usage.ru_maxrss < 1536L * 1024);
  CHECK(imported->report.dims == Vec3i(512, 512, kSlices));
  // Slices are 1 mm apart as written, and each source slice comes round every 48th: bone is spread evenly.
  CHECK(std::abs(imported->report.grid.spacing.z - 1e-3) < 1e-9);
  CHECK(imported->report.scan.skipped.empty());

  const auto scan = read_scan(folder.path().string(), {});
  REQUIRE(scan);
  const auto plain = read_plainly(*files);
  REQUIRE(plain);
  CHECK(scan->scan.values == *plain);
}
