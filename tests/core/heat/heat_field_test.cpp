// Heat in bone: closed forms of an instantaneous and of a moving source, a plain explicit twin in uneven bone, the balance of energy, the
// maximum principle at any step. The closed forms with a wrong diffusivity, and the twin with one axis left out, must fail.
#include "core/heat/heat_field.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

using namespace burrhole;

namespace {

constexpr double kPi = std::numbers::pi;

VoxelBox cube(int half) { return {Vec3i(-half), Vec3i(half + 1)}; }

HeatField make(const HeatConfig& config, double edge, const VoxelBox& domain) {
  auto field = HeatField::create(config, Vec3(edge), domain);
  REQUIRE(field.ok());
  return std::move(field).value();
}

HeatField full(const HeatConfig& config, double edge, const VoxelBox& domain) {
  HeatField field = make(config, edge, domain);
  field.set_bone(domain, std::vector<float>(domain.count(), 1.0f));
  return field;
}

/// Rise [K] round a point source of `joule` released at once in endless bone.
double instantaneous(const HeatConfig& c, double diffusivity, double joule, double r, double t) {
  return joule / (c.density * c.capacity * std::pow(4.0 * kPi * diffusivity * t, 1.5)) * std::exp(-r * r / (4.0 * diffusivity * t));
}

/// Largest error against the closed form beyond two cells, over the largest rise at its place.
double error_of_instantaneous(double diffusivity_factor, const HeatConfig& config, double edge) {
  const int half = 40;
  HeatField field = full(config, edge, cube(half));
  const double joule = 0.01, alpha = config.diffusivity() * diffusivity_factor;
  field.release_at(Vec3i(0), joule);
  double worst = 0.0, t = 0.0;
  const double end = 36.0 * edge * edge / (6.0 * config.diffusivity());  // the rise is largest at r = 6 cells
  while (t < end) {
    field.step(field.longest_step());
    t += field.longest_step();
    for_each_voxel(cube(7), [&](const Vec3i& cell) {
      const double r = glm::length(Vec3(cell)) * edge;
      if (r <= 2.0 * edge) return;
      const double largest = instantaneous(config, alpha, joule, r, r * r / (6.0 * alpha));
      worst = std::max(worst, std::abs(static_cast<double>(field.rise(cell)) - instantaneous(config, alpha, joule, r, t)) / largest);
    });
  }
  return worst;
}

}  // namespace

TEST_CASE("heat: a point source in endless bone follows the closed form beyond two cells within 3 % of the largest rise") {
  for (const double edge : {0.1e-3, 0.25e-3, 0.5e-3}) {
    const double error = error_of_instantaneous(1.0, {}, edge);
    MESSAGE("cells of " << edge * 1e3 << " mm: " << error * 100.0 << " %");
    CHECK(error < 0.03);
  }
  CHECK(error_of_instantaneous(1.1, {}, 0.25e-3) > 0.03);  // a diffusivity that is wrong by a tenth is noticed
}

TEST_CASE("heat: a source that moves at constant speed approaches Rosenthal's field beyond two cells within 3 % of its largest rise") {
  const HeatConfig config{};
  const double edge = 0.25e-3, speed = 0.156e-3, watt = 0.2, alpha = config.diffusivity();
  const VoxelBox domain{Vec3i(-44, -20, -20), Vec3i(41, 21, 21)};
  HeatField field = full(config, edge, domain);
  // The feed of a burrhole of 7 mm in 45 s: alpha / speed, the length over which heat runs ahead, is 1.4 mm.
  // The source starts at cell -30 and ends at cell 20. Between two cells, both receive heat, in proportion to its place.
  const int first = -30, last = 20, parts = 32;
  const double part = edge / speed / parts;
  for (int n = 0; n < (last - first) * parts; ++n) {
    const double way = (n + 0.5) / parts;
    const int cell = first + static_cast<int>(way);
    const double beyond = way - std::floor(way);
    field.release_at(Vec3i(cell, 0, 0), watt * part * (1.0 - beyond));
    field.release_at(Vec3i(cell + 1, 0, 0), watt * part * beyond);
    field.advance(part);
  }
  // The path has an end behind: the closed form is the integral of instantaneous sources over the time that it took.
  const double time = (last - first) * edge / speed;
  const auto expected = [&](const Vec3& from) {  // from the source [m]
    double sum = 0.0;
    const int pieces = 20000;
    for (int n = 0; n < pieces; ++n) {
      const double ago = time * std::pow((n + 0.5) / pieces, 2.0), width = 2.0 * time * (n + 0.5) / pieces / pieces;
      sum += instantaneous(config, alpha, watt, glm::length(from + Vec3(speed * ago, 0.0, 0.0)), ago) * width;
    }
    return sum;
  };
  double worst = 0.0, largest = 0.0;
  for (const Vec3i at : {Vec3i(3, 0, 0), Vec3i(-3, 0, 0), Vec3i(0, 3, 0), Vec3i(0, 0, 3), Vec3i(0, 2, 2), Vec3i(-10, 2, 2), Vec3i(-5, 4, 0),
                         Vec3i(0, 6, 0), Vec3i(-15, 3, 0), Vec3i(4, 3, 3)}) {
    const double closed = expected(Vec3(at) * edge);
    largest = std::max(largest, closed);
    worst = std::max(worst, std::abs(static_cast<double>(field.rise(Vec3i(last, 0, 0) + at)) - closed));
  }
  // Rosenthal's steady field, which the integral approaches near the source: a check of the check.
  const Vec3 side(0.0, 3.0 * edge, 0.0);
  const double steady = watt / (4.0 * kPi * config.conductivity * side.y) * std::exp(-speed * side.y / (2.0 * alpha));
  CHECK(expected(side) == doctest::Approx(steady).epsilon(0.01));
  MESSAGE("largest error " << worst / largest * 100.0 << " % of " << largest << " K");
  CHECK(worst < 0.03 * largest);
}

namespace {

struct Uneven {
  VoxelBox domain{Vec3i(0), Vec3i(14, 12, 10)};
  std::vector<float> share;
  explicit Uneven(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> any(-0.3f, 1.3f);  // a fifth of the cells empty, a fifth full
    for (std::size_t n = 0; n < domain.count(); ++n) share.push_back(std::clamp(any(random), 0.0f, 1.0f));
  }
};

/// One sweep along an axis as the header defines it, each line by Gaussian elimination of a dense matrix in double precision.
void twin_sweep(const Uneven& bone, std::vector<double>& rise, int axis, double lambda) {
  const double implicit = lambda > 1.0 / 3.0 ? 1.0 : std::max(0.0, 0.5 - 1.0 / (12.0 * lambda));
  const int length = bone.domain.size()[axis];
  for_each_voxel(bone.domain, [&](const Vec3i& start) {
    if (start[axis] != 0) return;
    std::vector<std::vector<double>> matrix(static_cast<std::size_t>(length),
                                            std::vector<double>(static_cast<std::size_t>(length) + 1, 0.0));
    const auto place = [&](int n) {
      Vec3i cell = start;
      cell[axis] = n;
      return bone.domain.offset_of(cell);
    };
    const auto holding = [&](int n) { return bone.share[place(n)] >= 0.02f ? static_cast<double>(bone.share[place(n)]) : 0.0; };
    for (int n = 0; n < length; ++n) {
      auto& row = matrix[static_cast<std::size_t>(n)];
      const double f = holding(n), old = rise[place(n)];
      row[static_cast<std::size_t>(n)] = f > 0.0 ? f : 1.0;
      row.back() = f * old;
      for (const int other : {n - 1, n + 1}) {
        const bool inside = other >= 0 && other < length;
        const double g = inside ? holding(other) : f, there = inside ? rise[place(other)] : 0.0;
        const double flow = f > 0.0 && g > 0.0 ? lambda * 2.0 * f * g / (f + g) : 0.0;
        row[static_cast<std::size_t>(n)] += implicit * flow;
        if (inside) row[static_cast<std::size_t>(other)] -= implicit * flow;
        row.back() += (1.0 - implicit) * flow * (there - old);
      }
    }
    for (int n = 0; n < length; ++n)
      for (int m = 0; m < length; ++m) {
        if (m == n) continue;
        const auto a = static_cast<std::size_t>(n), b = static_cast<std::size_t>(m);
        const double factor = matrix[b][a] / matrix[a][a];
        for (std::size_t c = a; c < matrix[b].size(); ++c) matrix[b][c] -= factor * matrix[a][c];
      }
    for (int n = 0; n < length; ++n) {
      const auto& row = matrix[static_cast<std::size_t>(n)];
      rise[place(n)] = row.back() / row[static_cast<std::size_t>(n)];
    }
  });
}

/// Difference after some steps over the largest rise at the start. @param axes of the twin; fewer than three is sabotage.
double difference_from_twin(unsigned seed, double fourier, int axes) {
  const Uneven bone(seed);
  const HeatConfig config{.fourier = fourier, .least_rise = 1e-9};
  HeatField field = make(config, 0.5e-3, bone.domain);
  field.set_bone(bone.domain, bone.share);
  std::vector<double> rise(bone.domain.count());
  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<double> joule(0.0, 5e-3);
  for (const Vec3i corner : {bone.domain.lo, bone.domain.hi - 1})  // the warm box is the whole domain
    if (field.share(corner) >= 0.02f) field.release_at(corner, 1e-3);
  for_each_voxel(bone.domain, [&](const Vec3i& cell) {
    if (random() % 7 == 0 && field.share(cell) >= 0.02f) field.release_at(cell, joule(random));
    rise[bone.domain.offset_of(cell)] = static_cast<double>(field.rise(cell));
  });
  const double largest = *std::ranges::max_element(rise);
  for (int n = 1; n <= 5; ++n) {
    field.step(field.longest_step());
    for (int turn = 0; turn < axes; ++turn) twin_sweep(bone, rise, n % 2 == 0 ? turn : 2 - turn, fourier);
  }
  double worst = 0.0;
  for_each_voxel(bone.domain, [&](const Vec3i& cell) {
    worst = std::max(worst, std::abs(static_cast<double>(field.rise(cell)) - rise[bone.domain.offset_of(cell)]));
  });
  return worst / largest;
}

}  // namespace

TEST_CASE("heat: uneven bone follows a twin by elimination of dense matrices, at short and long steps; a missing axis is noticed") {
  // Floats: 15 sweeps of 14 cells, each operation rounds by 6e-8 of the largest value.
  constexpr double kRounding = 15 * 14 * 6e-8;
  for (const unsigned seed : {1u, 2u, 3u})
    for (const double fourier : {0.05, 0.2, 0.3, 0.5, 10.0, 1e5}) {
      INFO("seed " << seed << ", fourier " << fourier);
      CHECK(difference_from_twin(seed, fourier, 3) < kRounding);
      CHECK(difference_from_twin(seed, fourier, 2) > kRounding);
    }
}

TEST_CASE("heat: no step of any length makes bone hotter than it was, or colder than the coldest, and none is lost") {
  for (const double seconds : {1e-3, 1e-2, 0.1, 1.0, 100.0, 1e6}) {
    for (const double edge : {0.1e-3, 0.5e-3}) {
      const Uneven bone(7);
      HeatField field = make({.least_rise = 1e-6}, edge, bone.domain);
      field.set_bone(bone.domain, bone.share);
      std::mt19937 random(11);
      for (int n = 0; n < 40; ++n) {
        const Vec3i cell(static_cast<int>(random() % 14), static_cast<int>(random() % 12), static_cast<int>(random() % 10));
        if (field.share(cell) >= 0.02f) field.release_at(cell, 1e-4);
      }
      float before = 0.0f;
      for_each_voxel(bone.domain, [&](const Vec3i& cell) { before = std::max(before, field.rise(cell)); });
      for (int n = 0; n < 30; ++n) {
        field.step(seconds);
        float now = 0.0f, least = 0.0f;
        for_each_voxel(bone.domain, [&](const Vec3i& cell) {
          now = std::max(now, field.rise(cell));
          least = std::min(least, field.rise(cell));
        });
        CHECK(now <= before * (1.0f + 1e-6f));
        CHECK(least >= -1e-6f * before);
        before = now;
      }
      const HeatBalance& b = field.balance();
      CHECK(std::abs(b.input - field.in_bone() - b.edge - b.chips - b.unplaced) < 1e-4 * b.input);
    }
  }
}

TEST_CASE("heat: energy is balanced while bone is drilled, cooled and put back") {
  const VoxelBox domain{Vec3i(0), Vec3i(24, 24, 16)};
  const double edge = 0.5e-3;
  HeatField field = full({}, edge, domain);
  double removed = 0.0;
  for (int layer = 0; layer < 10; ++layer)
    for (int quarter = 3; quarter >= 0; --quarter) {
      const VoxelBox cut{Vec3i(8, 8, layer), Vec3i(16, 16, layer + 1)};
      field.set_bone(cut, std::vector<float>(cut.count(), static_cast<float>(quarter) * 0.25f));
      field.release(0.4);
      removed += static_cast<double>(cut.count()) * 0.25;
      const Cooling water{.centre = Vec3(12.0, 12.0, layer + 1), .radius = 6e-3, .film = 3000.0, .rise = -15.0, .arriving = 8.0};
      field.advance(0.25, &water);
      const HeatBalance& b = field.balance();
      const double found = field.in_bone() + b.chips + b.cooled + b.edge + b.unplaced;
      CHECK(std::abs(b.input - found) < 1e-4 * b.input);
    }
  const HeatBalance b = field.balance();
  CHECK(b.input == doctest::Approx(40 * 0.4));
  CHECK(b.chips > 0.0);
  CHECK(b.cooled > 0.0);
  CHECK(b.unplaced == 0.0);
  // Bone that is put back is cold: it holds no heat, so the sum does not change.
  const double before = field.in_bone();
  field.set_bone(domain, std::vector<float>(domain.count(), 1.0f));
  field.forget_losses();
  CHECK(field.in_bone() == doctest::Approx(before).epsilon(1e-5));
}

TEST_CASE("heat: energy is balanced with a cut cell at each of the six faces of the domain, through which heat leaves") {
  // Floats: 20 steps of 3 sweeps of 10 operations, each rounds by 6e-8 of the largest value.
  constexpr double kRounding = 20 * 3 * 10 * 6e-8;
  for (const double fourier : {0.2236, 0.3, 2.0})
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        INFO("fourier " << fourier << ", axis " << axis << ", side " << side);
        HeatField field = full({.fourier = fourier}, 0.5e-3, cube(1));
        Vec3i cell(0);
        cell[axis] = side;
        field.set_bone({cell, cell + 1}, std::vector<float>{0.5f});
        field.release(1e-3);
        for_each_voxel(cube(1), [&](const Vec3i& at) { field.release_at(at, 1e-3); });
        for (int n = 0; n < 20; ++n) {
          field.step(field.longest_step());
          const HeatBalance& b = field.balance();
          CHECK(std::abs(b.input - field.in_bone() - b.edge - b.chips) < kRounding * b.input);
        }
      }
}

TEST_CASE("heat: bone that an undo brings back before a step has the temperature of bone that was never cut") {
  for (const float left : {0.0f, 0.4f}) {
    HeatField cut = full({}, 0.5e-3, cube(3)), whole = full({}, 0.5e-3, cube(3));
    const VoxelBox cell{Vec3i(0), Vec3i(1)};
    cut.set_bone(cell, std::vector<float>{left});
    cut.release(1e-3);
    cut.set_bone(cell, std::vector<float>{1.0f});
    cut.forget_losses();
    whole.release_at(Vec3i(0), 1e-3);
    for (int n = 0; n < 3; ++n) {
      cut.step(cut.longest_step());
      whole.step(whole.longest_step());
      for_each_voxel(cube(3), [&](const Vec3i& at) { CHECK(cut.rise(at) == whole.rise(at)); });
    }
    CHECK(cut.balance().chips == 0.0);
  }
}

TEST_CASE("heat: bone that is put back in part is charged for the part that stays cut") {
  // Half of the loss is put back: as if a cut of that half had been made at once, with the same heat.
  HeatField back = full({}, 0.5e-3, cube(3)), once = full({}, 0.5e-3, cube(3));
  const VoxelBox cell{Vec3i(0), Vec3i(1)};
  back.set_bone(cell, std::vector<float>{0.5f});
  back.release(1e-3);
  back.set_bone(cell, std::vector<float>{0.75f});
  back.forget_losses();
  once.set_bone(cell, std::vector<float>{0.75f});
  once.release(1e-3);
  for (HeatField* field : {&back, &once}) field->step(field->longest_step());
  for_each_voxel(cube(3), [&](const Vec3i& at) { CHECK(back.rise(at) == once.rise(at)); });
  CHECK(back.balance().chips == once.balance().chips);
  CHECK(once.balance().chips > 0.0);
}

TEST_CASE("heat: bone that left where no other was takes nothing from bone that is put there later") {
  HeatField field = make({}, 0.5e-3, cube(1));
  const VoxelBox cell{Vec3i(0), Vec3i(1)};
  const auto set = [&](float share) { field.set_bone(cell, std::vector<float>{share}); };
  set(1.0f);
  set(0.0f);
  field.release(1e-3);
  field.step(field.longest_step());
  const double chips = field.balance().chips;
  set(1.0f);
  field.forget_losses();
  field.release_at(Vec3i(0), 1e-3);
  const float before = field.rise(Vec3i(0));
  field.step(field.longest_step());  // alone, it keeps its heat
  CHECK(field.rise(Vec3i(0)) == doctest::Approx(before).epsilon(1e-6));
  CHECK(field.balance().chips == chips);
}

TEST_CASE("heat: a coolant takes no more than warms it to the hottest bone that it wets, and cools a slab as the film says") {
  const VoxelBox domain{Vec3i(0), Vec3i(20, 20, 4)};
  const HeatConfig config{};
  const double edge = 0.5e-3, capacity = config.density * config.capacity * edge * edge * edge;
  const auto warm = [&] {
    HeatField field = full(config, edge, {domain.lo, domain.hi + Vec3i(0, 0, 4)});
    const VoxelBox air{Vec3i(0, 0, 4), Vec3i(20, 20, 8)};
    field.set_bone(air, std::vector<float>(air.count(), 0.0f));
    field.forget_losses();
    for_each_voxel(domain, [&](const Vec3i& cell) { field.release_at(cell, 10.0 * capacity); });
    return field;
  };
  HeatField wet = warm();
  const double dt = 0.05, film = 2000.0;
  wet.cool({.centre = Vec3(10.0, 10.0, 3.0), .radius = 1.0, .film = film, .rise = -17.0, .arriving = 1e9}, dt);
  // A cell of the free face: capacity over face, implicit in time.
  const double expected = 10.0 - 27.0 * film * edge * edge * dt / (capacity + film * edge * edge * dt);
  CHECK(static_cast<double>(wet.rise(Vec3i(10, 10, 3))) == doctest::Approx(expected).epsilon(1e-5));
  CHECK(wet.rise(Vec3i(10, 10, 2)) == doctest::Approx(10.0));  // under the face: only by conduction
  HeatField below = warm();                                    // the coolant lies below bone
  below.cool({.centre = Vec3(10.0, 10.0, 6.0), .up = Vec3(0.0, 0.0, 1.0), .radius = 1.0, .film = film, .rise = -17.0, .arriving = 1e9}, dt);
  CHECK(below.balance().cooled == 0.0);
  HeatField scarce = warm();
  const double arriving = 0.1;  // [W/K]
  scarce.cool({.centre = Vec3(10.0, 10.0, 3.0), .radius = 1.0, .film = film, .rise = -17.0, .arriving = arriving}, dt);
  CHECK(scarce.balance().cooled == doctest::Approx(arriving * dt * 27.0).epsilon(1e-5));
  CHECK(scarce.balance().cooled < wet.balance().cooled);
  // Sabotage: a film that is off by a tenth, and a coolant without the limit of its warming, are noticed.
  HeatField thick = warm();
  thick.cool({.centre = Vec3(10.0, 10.0, 3.0), .radius = 1.0, .film = 1.1 * film, .rise = -17.0, .arriving = 1e9}, dt);
  CHECK(static_cast<double>(thick.rise(Vec3i(10, 10, 3))) != doctest::Approx(expected).epsilon(1e-5));
  CHECK(wet.balance().cooled > arriving * dt * 27.0 * (1.0 + 1e-5));
}

TEST_CASE("heat: work follows the warm box, and cold bone costs nothing") {
  HeatField field = full({}, 0.5e-3, cube(60));
  field.advance(10.0);
  CHECK(field.conducted_cells() == 0);
  field.release_at(Vec3i(0), 1e-3);
  field.advance(1.0);
  CHECK(field.conducted_cells() / std::max<std::uint64_t>(1, field.steps()) < cube(60).count() / 20);
  CHECK(field.hottest() > 0.0);
}

TEST_CASE("heat: numbers that are not above 0 are refused") {
  const VoxelBox one = cube(1);
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    CHECK_FALSE(HeatField::create({.conductivity = bad}, Vec3(1e-3), one).ok());
    CHECK_FALSE(HeatField::create({.density = bad}, Vec3(1e-3), one).ok());
    CHECK_FALSE(HeatField::create({.capacity = bad}, Vec3(1e-3), one).ok());
    CHECK_FALSE(HeatField::create({.fourier = bad}, Vec3(1e-3), one).ok());
    CHECK_FALSE(HeatField::create({}, Vec3(bad, 1e-3, 1e-3), one).ok());
  }
  CHECK_FALSE(HeatField::create({.body = std::nan("")}, Vec3(1e-3), one).ok());
  CHECK_FALSE(HeatField::create({}, Vec3(1e-3), {}).ok());
}
