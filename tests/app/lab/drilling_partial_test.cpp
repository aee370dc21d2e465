#include "app/lab/drilling_partial.h"

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>

#include "tests/support/file_limit.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

DrillingResult result(double volume, std::optional<double> depth) {
  DrillingResult out;
  out.volume_mm3 = volume;
  out.cpu_s = -0.0;
  out.summary.removed_mm3 = 1e-310;  // subnormal
  out.summary.depth_mm = depth;
  out.summary.predicted_bytes = 1ull << 60;
  return out;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST_CASE("partial drillings: figures read back as the same bits, and a write that fails keeps those of before") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt");
  const std::string bit = drilling_bits().front().name;
  const DrillingTrial first{.bit = bit}, second{.bit = bit, .sets = {"hand.push_N=17"}};
  PartialDrillings kept(path);
  REQUIRE(kept.add(first, result(0.1, std::nullopt)));
  {
    const FileLimit full(std::filesystem::file_size(path) + 20);
    const Status failed = kept.add(second, result(0.2, 1.0));
    REQUIRE_FALSE(failed);
    CHECK(failed.error().place == path);
  }
  CHECK_FALSE(PartialDrillings(path).find(second));
  REQUIRE(kept.add(second, result(0.2, 1.0 / 3.0)));
  const PartialDrillings again(path);
  const auto a = again.find(first), b = again.find(second);
  REQUIRE(a);
  REQUIRE(b);
  CHECK(bits(a->volume_mm3) == bits(0.1));
  CHECK(bits(a->cpu_s) == bits(-0.0));
  CHECK(bits(a->summary.removed_mm3) == bits(1e-310));
  CHECK_FALSE(a->summary.depth_mm);
  CHECK(a->summary.predicted_bytes == 1ull << 60);
  REQUIRE(b->summary.depth_mm);
  CHECK(bits(*b->summary.depth_mm) == bits(1.0 / 3.0));
}

}  // namespace
}  // namespace burrhole
