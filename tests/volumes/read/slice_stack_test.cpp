#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/base/bounds.h"
#include "core/base/random.h"
#include "core/base/units.h"
#include "volumes/read/slice_stack.h"

using namespace burrhole;

namespace {

// [m] roundings of double sums over coordinates below 1 m, far below what a scanner can say.
constexpr double kExact = 1e-9;

/// The test's own stack: an affine in mm from which slices are laid out.
struct Layout {
  Vec3 origin{-120.0, -110.0, 40.0};
  Vec3 row{1, 0, 0}, column{0, 1, 0};
  Vec3 step{0, 0, 1.25};
  double column_spacing = 0.45, row_spacing = 0.5;
  int count = 20;
};

std::vector<SlicePlane> lay_out(const Layout& l) {
  std::vector<SlicePlane> out;
  for (int k = 0; k < l.count; ++k)
    out.push_back({l.origin + static_cast<double>(k) * l.step, l.row, l.column, l.column_spacing, l.row_spacing, 512, 400});
  return out;
}

void shuffle(std::vector<SlicePlane>& slices, std::uint64_t seed) {
  for (std::size_t n = slices.size(); n > 1; --n)
    std::swap(slices[n - 1], slices[static_cast<std::size_t>(uniform01(seed, n) * static_cast<double>(n))]);
}

/// Largest distance [m] between what the two maps make of the corners of a 512 x 400 x count box.
double corner_error(const Affine& a, const Layout& l) {
  double worst = 0.0;
  for (const Vec3& index : Bounds{Vec3(0.0), Vec3(511.0, 399.0, l.count - 1.0)}.corners()) {
    const Vec3 own = (l.origin + index.x * l.column_spacing * l.row + index.y * l.row_spacing * l.column + index.z * l.step) * 1e-3;
    worst = std::max(worst, glm::length(a * index - own));
  }
  return worst;
}

std::string fault(const std::vector<SlicePlane>& slices, double single = 0.0) {
  const auto out = stack_slices(slices, single);
  if (out.ok()) return "";
  CHECK(out.error().code == ErrorCode::bad_input);
  return out.error().message;
}

Quat turn(double a, double b, double c) { return glm::normalize(Quat(1.0, a, b, c)); }

}  // namespace

TEST_CASE("stack_slices: a straight stack gives spacing, origin and order in closed form") {
  const Layout l;
  auto slices = lay_out(l);
  std::reverse(slices.begin(), slices.end());
  const auto stack = stack_slices(slices, 0.0);
  REQUIRE(stack.ok());
  CHECK(stack->order.front() == 19);
  CHECK(stack->order.back() == 0);
  CHECK(stack->tilt == 0.0);
  CHECK(corner_error(stack->bone_from_index, l) < kExact);
}

TEST_CASE("stack_slices: a gantry tilt of 17 degrees stays as shear, and its angle is reported") {
  Layout l;
  l.step = {0.0, 2.5 * std::tan(17.0 * kDegree), 2.5};
  const auto stack = stack_slices(lay_out(l), 0.0);
  REQUIRE(stack.ok());
  CHECK(std::abs(stack->tilt - 17.0 * kDegree) < 1e-12);
  CHECK(corner_error(stack->bone_from_index, l) < kExact);
}

TEST_CASE("stack_slices: coronal and sagittal slices stack along their own normal") {
  for (const bool sagittal : {false, true}) {
    Layout l;
    l.row = sagittal ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    l.column = Vec3(0, 0, -1);
    l.step = glm::cross(l.row, l.column) * 0.8;
    const auto stack = stack_slices(lay_out(l), 0.0);
    REQUIRE(stack.ok());
    CHECK(corner_error(stack->bone_from_index, l) < kExact);
    CHECK(stack->tilt < 1e-12);
  }
}

TEST_CASE("stack_slices: any turned, tilted and shuffled stack gives back the affine it was laid out by") {
  CHECK(rc::check([] {
    const auto word = *rc::gen::arbitrary<std::uint64_t>();
    const auto u = [&](std::uint64_t n) { return uniform11(word, n); };
    const Quat q = turn(u(1), u(2), u(3));
    Layout l;
    l.count = 2 + static_cast<int>(30.0 * uniform01(word, 4));
    l.origin = 300.0 * Vec3(u(5), u(6), u(7));
    l.row = q * Vec3(1, 0, 0);
    l.column = q * Vec3(0, 1, 0);
    l.column_spacing = 0.6 + 0.4 * u(8);
    l.row_spacing = 0.6 + 0.4 * u(9);
    l.step = q * (Vec3(0.4 * u(10), 0.4 * u(11), 1.0) * (2.6 + 2.4 * u(12)));
    auto slices = lay_out(l);
    shuffle(slices, word);
    const auto stack = stack_slices(slices, 0.0);
    RC_ASSERT(stack.ok());
    RC_ASSERT(corner_error(stack->bone_from_index, l) < kExact);
    for (int k = 0; k < l.count; ++k)
      RC_ASSERT(slices[stack->order[static_cast<std::size_t>(k)]].position == l.origin + static_cast<double>(k) * l.step);
  }));
}

// Sabotage twin of the property: the comparison must see a third column that is the normal instead of the step.
TEST_CASE("stack_slices: the corner comparison sees a tilt that was dropped") {
  Layout l;
  l.step = {0.0, 0.4, 1.25};
  const auto stack = stack_slices(lay_out(l), 0.0);
  REQUIRE(stack.ok());
  Affine straightened = stack->bone_from_index;
  straightened.linear[2] = Vec3(0, 0, 1.25e-3);
  CHECK(corner_error(straightened, l) > 5e-3);
}

TEST_CASE("stack_slices: one missing slice is named by number, step and place") {
  auto slices = lay_out({.origin = {-100, -100, -139.4}, .step = {0, 0, 1.0}, .count = 48});
  slices.erase(slices.begin() + 16);
  CHECK(fault(slices) == "slice 17 of 48 is missing: step 2.00 mm where 1.00 mm is the rule, after z = -124.4 mm");
}

TEST_CASE("stack_slices: several gaps are counted and the first is named") {
  auto slices = lay_out({.origin = {0, 0, 0}, .step = {0, 0, 1.0}, .count = 30});
  slices.erase(slices.begin() + 20, slices.begin() + 22);
  slices.erase(slices.begin() + 9);
  CHECK(fault(slices) ==
        "3 of 30 slices are missing in 2 gaps, the first after slice 9: step 2.00 mm where 1.00 mm is the rule, after z = 8.0 mm");
}

TEST_CASE("stack_slices: a step off by more than 1 % + 0.01 mm is an error, one off by less is not") {
  for (const double off : {0.019, 0.021}) {
    auto slices = lay_out({.step = {0, 0, 1.0}, .count = 11});
    for (std::size_t k = 5; k < slices.size(); ++k) slices[k].position.z += off;
    CHECK(fault(slices).empty() == (off < 0.02));
  }
  auto uneven = lay_out({.step = {0, 0, 1.0}, .count = 11});
  for (std::size_t k = 5; k < uneven.size(); ++k) uneven[k].position.z += 0.37;
  CHECK(fault(uneven) == "1 of 10 slice steps are uneven; the first: step 1.37 mm where 1.00 mm is the rule, after z = 44.0 mm");
}

TEST_CASE("stack_slices: two slices at one place are refused, with how many and where") {
  auto slices = lay_out({.origin = {0, 0, 7.5}, .step = {0, 0, 2.0}, .count = 6});
  slices.push_back(slices[2]);
  CHECK(fault(slices) == "two slices at one place: 1 of 7 slices lie where another does, the first at z = 11.5 mm");
  CHECK(fault(std::vector<SlicePlane>(5, slices[0])).find("4 of 5 slices lie where another does") != std::string::npos);
}

TEST_CASE("stack_slices: steady sideways drift is tilt, uneven drift an error") {
  auto slices = lay_out({.step = {0, 0.3, 1.0}, .count = 12});
  CHECK(fault(slices).empty());
  for (std::size_t k = 6; k < slices.size(); ++k) slices[k].position.y -= 0.3 * static_cast<double>(k - 5);  // the tilt ends half way
  CHECK(fault(slices).find("slices drift unevenly: slice ") == 0);
  auto bump = lay_out({.step = {0, 0, 1.0}, .count = 12});
  bump[4].position.x += 0.2;
  CHECK(fault(bump).find("slice 5 of 12 lies 0.20 mm sideways") != std::string::npos);
}

TEST_CASE("stack_slices: steps that grow too little to see one by one are refused once slices are off their places") {
  auto slices = lay_out({.step = {0, 0, 1.0}, .count = 100});
  // z = k + c k (99 - k): every step is within 0.02 mm of the rule, the middle is 0.45 mm off its place.
  const double c = 0.45 / (49.5 * 49.5);
  for (int k = 0; k < 100; ++k) slices[static_cast<std::size_t>(k)].position.z += c * k * (99 - k);
  CHECK(fault(slices).find("slices drift unevenly") == 0);
}

TEST_CASE("stack_slices: mixtures are refused for what is mixed") {
  const auto mixed = [](auto change) {
    auto slices = lay_out({.count = 8});
    change(slices[3]);
    return fault(slices);
  };
  CHECK(mixed([](SlicePlane&) {}).empty());
  CHECK(mixed([](SlicePlane& s) { s.row = Vec3(0, 1, 0), s.column = Vec3(0, 0, 1); }) ==
        "mixed orientations: 1 of 8 slices are turned against the first");
  CHECK(mixed([](SlicePlane& s) { s.row = -s.row, s.column = -s.column; }).find("mixed orientations") == 0);
  CHECK(mixed([](SlicePlane& s) { s.columns = 511; }) == "mixed sizes: 1 of 8 slices are not 512 x 400 pixels");
  CHECK(mixed([](SlicePlane& s) { s.row_spacing = 0.51; }) == "mixed pixel spacings: 1 of 8 slices do not have 0.45 x 0.5 mm");
}

TEST_CASE("stack_slices: unusable values are refused before anything is computed from them") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto single = [](auto change) {
    auto slices = lay_out({.count = 3});
    change(slices[1]);
    return fault(slices);
  };
  CHECK(single([&](SlicePlane& s) { s.position.y = nan; }).find("not finite") != std::string::npos);
  CHECK(single([&](SlicePlane& s) { s.row_spacing = std::numeric_limits<double>::infinity(); }).find("not finite") != std::string::npos);
  CHECK(single([](SlicePlane& s) { s.row_spacing = 0.0; }).find("must be above 0") != std::string::npos);
  CHECK(single([](SlicePlane& s) { s.columns = 0; }).find("0 x 400 pixels") != std::string::npos);
  CHECK(single([](SlicePlane& s) { s.row = Vec3(0.9, 0, 0); }).find("not perpendicular unit vectors") != std::string::npos);
  CHECK(single([](SlicePlane& s) { s.column = s.row; }).find("not perpendicular unit vectors") != std::string::npos);
  CHECK(single([](SlicePlane& s) { s.position.z = 1e300; }).find("from the origin") != std::string::npos);
  CHECK(fault({}) == "there is no slice");
}

TEST_CASE("stack_slices: one slice is as thick as said, and refused when nothing says so") {
  const Layout one{.step = {0, 0, 5.0}, .count = 1};
  const auto stack = stack_slices(lay_out(one), 5.0);
  REQUIRE(stack.ok());
  CHECK(glm::length(stack->bone_from_index.linear[2] - Vec3(0, 0, 5e-3)) < kExact);
  CHECK(corner_error(stack->bone_from_index, one) < kExact);
  CHECK(fault(lay_out(one), 0.0) == "there is one slice, and its thickness is unknown");
  CHECK_FALSE(fault(lay_out(one), std::numeric_limits<double>::quiet_NaN()).empty());
}

// Scanners write five or six digits: turning the last of them must neither refuse nor shear a stack.
TEST_CASE("stack_slices: directions and positions rounded to six decimals are taken") {
  const Quat q = turn(0.2, -0.1, 0.3);
  const auto rounded = [](const Vec3& v) { return glm::round(v * 1e6) / 1e6; };
  Layout l;
  l.row = q * Vec3(1, 0, 0);
  l.column = q * Vec3(0, 1, 0);
  l.step = q * Vec3(0, 0, 0.625);
  l.count = 200;
  auto slices = lay_out(l);
  for (SlicePlane& s : slices) s = {rounded(s.position), rounded(s.row), rounded(s.column), s.column_spacing, s.row_spacing, 512, 400};
  const auto stack = stack_slices(slices, 0.0);
  REQUIRE(stack.ok());
  CHECK(stack->tilt < 1e-5);
  // 1e-6 of direction over 0.3 m, in three places.
  CHECK(corner_error(stack->bone_from_index, l) < 1e-6);
}
