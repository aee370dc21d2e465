// Distances sampled by vectors against the plain sampler.
#include "core/tool/field_kernels.h"

#include <doctest/doctest.h>

#include <vector>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/tool/field_sampler.h"

using namespace burrhole;

namespace {

void compare_with_plain(bool revolved) {
  CuttingField field;
  field.pitch = 0.125e-3;
  field.margin = 0.5e-3;
  field.revolved = revolved;
  field.dims = Vec3i(20, revolved ? 1 : 17, 33);
  field.origin = revolved ? Vec3(0.0) : Vec3(-1e-3);
  std::uint64_t n = 0;
  for_each_voxel({Vec3i(0), field.dims}, [&](const Vec3i&) {
    field.distance.push_back(static_cast<float>(1e-3 * uniform11(1, n++)));
    field.factor.push_back(1.0f);
  });
  const FieldSampler sampler(field);
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const std::string& level : levels) {
    CAPTURE(level);
    REQUIRE(choose_simd(level).ok());
    int outside = 0;
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{16}, std::size_t{501}}) {
      std::vector<float> x(count), y(count), z(count), out(count + kFieldPad, 1e9f);
      for (std::size_t k = 0; k < count; ++k) {
        x[k] = 10.0f + 14.0f * static_cast<float>(uniform11(2, 3 * k));
        y[k] = 8.0f + 12.0f * static_cast<float>(uniform11(2, 3 * k + 1));
        z[k] = 16.0f + 20.0f * static_cast<float>(uniform11(2, 3 * k + 2));
      }
      // Whole vectors are read: lists are padded.
      for (std::vector<float>* list : {&x, &y, &z}) list->resize(count + kFieldPad);
      sample_field(field_job(field), {count, x.data(), y.data(), z.data()}, out.data());
      for (std::size_t k = 0; k < count; ++k) {
        REQUIRE(out[k] == sampler.distance({x[k], y[k], z[k]}));
        outside += static_cast<double>(out[k]) >= field.margin ? 1 : 0;
      }
    }
    CHECK(outside > 50);
  }
  REQUIRE(choose_simd("auto").ok());
}

}  // namespace

TEST_CASE("field kernels: distances are those of the plain sampler, inside the table and out, at every level, for lists of any length") {
  compare_with_plain(false);
}

TEST_CASE("field kernels: the same for a solid of revolution") { compare_with_plain(true); }
