// [heat] in a scene: the amount by which each key changes the figure that it names, by closed forms. Bone that conducts a thousand times as well as
// bone has one temperature everywhere, which follows from what was removed alone.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/color_ramp.h"
#include "core/drill/energy.h"
#include "tests/support/drilled_post.h"

namespace burrhole::test {
namespace {

constexpr double kTick = 0.02;  // [s] of bone
constexpr double kShare = 0.5;  // [-] of the work that enters bone

/// Keys of [heat]; what a test does not name is as here.
struct Keys {
  double share = kShare, conductivity = 0.5, density = 1810.0, capacity = 1250.0, fourier = 0.2236;
  int cell = 2;
  std::string more = {};
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "[heat]\nshare = {}\nconductivity_W_per_m_K = {}\ndensity_kg_per_m3 = {}\ncapacity_J_per_kg_K = {}\nfourier = {}\ncell_voxels = "
        "{}\n{}",
        share, conductivity, density, capacity, fourier, cell, more);
  }
  [[nodiscard]] double diffusivity() const { return conductivity / (density * capacity); }
  /// [s] of a step of conduction.
  [[nodiscard]] double step(double voxel) const { return fourier * cell * cell * voxel * voxel / diffusivity(); }
};

double heat_figure(DrillRun& run, const std::string& name) { return figure(run.simulation(), "heat", name); }

/// A post of one temperature, drilled for some seconds.
struct EvenPost {
  static constexpr double kConductivity = 500.0;
  std::unique_ptr<DrillRun> run;
  double whole = 0.0, left = 0.0;  // [m^3] of bone before and after
  std::vector<double> rises;       // [K] by the closed form, after each tick
  double rise = 0.0;               // [K] the last
  double error = 0.0;              // [K] derived

  /// Bone of the volume V takes share e dV of heat for each dV that leaves at its temperature: rho c V dT = - share e dV, so
  /// T = share e / (rho c) ln(V0 / V). The hottest is q L / (3 k) above the mean of a layer of the length L; heat of a tick enters in whole steps of
  /// conduction, so q is up to twice as large for a step. Heat of the last tick waits for a step.
  EvenPost(const Keys& keys, double seconds, const std::vector<std::string>& sets = {}) {
    std::vector<std::string> all{fmt::format("duration_s={}", seconds)};
    all.insert(all.end(), sets.begin(), sets.end());
    LoadedScene loaded = drilled_post(keys.text(), all);
    const double* removed = nullptr;
    std::vector<double> course;  // [m^3] removed up to the end of each tick of bone
    std::size_t ticks = 0;
    WatchedFeed hand(loaded, [&] {
      if (ticks++ % 20 == 10) course.push_back(*removed);
    });
    SimulationOptions options;
    options.hand = &hand;
    run = std::make_unique<DrillRun>(std::move(loaded), options);
    removed = column_of(*run, "removed_mass");
    whole = bone_left(*run);
    run->run();
    left = bone_left(*run);
    course.push_back(*removed);
    REQUIRE(std::abs(course.back() / (whole - left) - 1.0) < 1e-4);
    const double source = keys.share * EnergyConfig{}.specific_energy, unit = keys.density * keys.capacity;
    for (std::size_t n = 1; n < course.size(); ++n) rises.push_back(source / unit * std::log(whole / (whole - course[n])));
    rise = rises.back();
    const double length = left / 4e-6, flow = source * kPostFeed;
    error = 2.0 * flow * length / (3.0 * keys.conductivity) + flow / (unit * length) * (kTick + keys.step(run->voxel()));
  }
  /// @returns the dose [min] of a body of 43 C, from which on it grows by 2^rise; bone warmer by less than 0.01 K is not warm.
  [[nodiscard]] double dose() const {
    double out = 0.0;
    for (const double one : rises) out += one >= 0.01 ? std::exp2(one) * kTick / 60.0 : 0.0;
    return out;
  }
};

Keys even_keys(const std::string& more) { return {.conductivity = EvenPost::kConductivity, .fourier = 10.0, .more = more}; }

/// @returns whether all vertices have the colour of a place on the scale, to `off` of it and to rounding.
bool colours_fit(const AddedMesh& mesh, double place, double off) {
  const RampColor a = ramp_color(place - off), b = ramp_color(place + off), middle = ramp_color(place);
  const auto between = [](int value, int x, int y, int z) { return value >= std::min({x, y, z}) - 1 && value <= std::max({x, y, z}) + 1; };
  return !mesh.colors.empty() && std::ranges::all_of(mesh.colors, [&](const Rgba8& c) {
    return between(c.r, a.r, b.r, middle.r) && between(c.g, a.g, b.g, middle.g) && between(c.b, a.b, b.b, middle.b);
  });
}

}  // namespace

TEST_CASE("heat: density_kg_per_m3 and capacity_J_per_kg_K divide the rise of a post of one temperature; the heat in it stays") {
  for (const auto& [density, capacity, cell] : {std::tuple{1810.0, 1250.0, 2},
                                                {905.0, 1250.0, 2},
                                                {3000.0, 1250.0, 2},
                                                {1810.0, 625.0, 2},
                                                {1810.0, 4000.0, 2},
                                                {1810.0, 1250.0, 1}}) {
    CAPTURE(density);
    CAPTURE(capacity);
    CAPTURE(cell);
    const Keys keys{.conductivity = EvenPost::kConductivity, .density = density, .capacity = capacity, .fourier = 10.0, .cell = cell};
    const EvenPost post(keys, 10.0);
    const double rise = heat_figure(*post.run, "hottest_C") - 37.0, in_bone = heat_figure(*post.run, "in_bone_J");
    MESSAGE("rise " << rise << " K, closed form " << post.rise << " K, derived error " << post.error << " K");
    CHECK(std::abs(rise - post.rise) < post.error);
    CHECK(std::abs(rise - 1.1 * post.rise) > 3.0 * post.error);  // sabotage: as if a key were wrong by a tenth
    const double heat = kShare * EnergyConfig{}.specific_energy * post.left * std::log(post.whole / post.left);
    CHECK(std::abs(in_bone / heat - 1.0) < post.error / post.rise);
  }
}

TEST_CASE(
    "heat: conductivity_W_per_m_K: bone that conducts n times as well is as warm if all goes n times as fast, with one n-th of the dose") {
  struct Course {
    double hottest, in_bone, dose, released;
  };
  const auto course = [](double conductivity, int speed) {
    DrillRun run(drilled_post(Keys{.conductivity = conductivity, .more = "body_C = 48\n"}.text(),
                              {fmt::format("servo_hz={}", 1000 * speed), fmt::format("erosion.rate_hz={}", 50 * speed),
                               fmt::format("hand.feed_mm_per_s={}", 0.15 * speed), fmt::format("duration_s={}", 20.0 / speed)}));
    run.run();
    return Course{heat_figure(run, "hottest_C"), heat_figure(run, "in_bone_J"), heat_figure(run, "dose_inner_face_min"),
                  heat_figure(run, "released_J")};
  };
  const Course slow = course(0.4, 1);
  for (const int n : {2, 4}) {
    CAPTURE(n);
    const Course fast = course(0.4 * n, n), wrong = course(0.44 * n, n);
    MESSAGE("hottest " << slow.hottest << ", " << fast.hottest << ", " << wrong.hottest << " C; in bone " << slow.in_bone << ", "
                       << fast.in_bone << ", " << wrong.in_bone << " J; dose " << slow.dose << ", " << fast.dose << ", " << wrong.dose
                       << " min");
    // Each number of the one run is that of the other times a power of two, up to rounding of the places of the bit.
    REQUIRE(fast.dose > 1.0);  // above the minute at which the dose below a face is extrapolated with another slope
    CHECK(std::abs(fast.released / slow.released - 1.0) < 1e-5);
    CHECK(fast.hottest - 48.0 == doctest::Approx(slow.hottest - 48.0).epsilon(1e-5));
    CHECK(std::abs(fast.in_bone / slow.in_bone - 1.0) < 1e-5);
    CHECK(fast.dose == doctest::Approx(slow.dose / n).epsilon(1e-5));
    CHECK(std::abs(wrong.in_bone / slow.in_bone - 1.0) > 0.01);  // sabotage: a conductivity that is wrong by a tenth
    CHECK(std::abs(wrong.dose * n / slow.dose - 1.0) > 0.1);
  }
}

TEST_CASE("heat: conductivity_W_per_m_K is how fast a post of the length L gets even once nothing is cut: by exp(-pi^2 alpha t / L^2)") {
  for (const double conductivity : {0.4, 0.5, 0.8}) {
    CAPTURE(conductivity);
    const Keys keys{.conductivity = conductivity, .fourier = 0.2, .cell = 1};
    // The bit stops at 0.75 mm and goes up: [s] from then on.
    const double stop = 4.75e-3 / kPostFeed, first = 4.0 / conductivity, second = 6.0 / conductivity;
    LoadedScene loaded = drilled_post(keys.text(), {"hand.stop_mm=0.75", "hand.standoff_mm=4",
                                                    fmt::format("duration_s={:.2f}", stop + second), "volume.spacing_mm=0.125"});
    const double* hottest = nullptr;
    std::vector<double> course;
    WatchedFeed hand(loaded, [&] { course.push_back(*hottest); });
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(std::move(loaded), options);
    hottest = column_of(run, "hottest");
    const double whole = bone_left(run);
    run.run();
    const double left = bone_left(run), length = left * 0.75e-3 / (whole - left);
    const double mean = 37.0 + heat_figure(run, "in_bone_J") / (keys.density * keys.capacity * left);
    const auto uneven = [&](double seconds) { return course[static_cast<std::size_t>(std::lround((stop + seconds) * 1000.0)) - 1] - mean; };
    const double rate = std::log(uneven(first) / uneven(second)) / (second - first);
    const double expected = std::pow(std::numbers::pi / length, 2.0) * keys.diffusivity();
    MESSAGE(uneven(first) << " and " << uneven(second) << " K: " << rate << " 1/s, closed form " << expected << " 1/s, "
                          << 100.0 * (rate / expected - 1.0) << " %");
    // The next part of the profile dies out four times as fast: of it exp(-4.8) is left at first, 0.8 % in a time in which the profile falls by exp(-0.8).
    // Ends of two voxels that are bone in part: (pi voxel / L)^2, 1.4 %, at most.
    CHECK(std::abs(rate / expected - 1.0) < 0.025);
    CHECK(std::abs(rate / (1.1 * expected) - 1.0) > 0.05);  // sabotage
  }
}

TEST_CASE("heat: fourier is the length of a step of conduction, so steps are the time over it") {
  const auto steps = [](const Keys& keys) {
    DrillRun run(drilled_post(keys.text(), {"duration_s=4.0"}));
    run.run();
    return heat_figure(run, "steps");
  };
  const double voxel = 0.25e-3;
  for (const Keys& keys :
       {Keys{.fourier = 0.01}, Keys{.fourier = 0.02}, Keys{.fourier = 0.011}, Keys{.conductivity = 0.8, .fourier = 0.02},
        Keys{.density = 905.0, .fourier = 0.02}, Keys{.capacity = 2500.0, .fourier = 0.01}, Keys{.fourier = 0.02, .cell = 1}}) {
    const double expected = 4.0 / keys.step(voxel), found = steps(keys);
    MESSAGE(found << " steps, expected " << expected);
    CHECK(std::abs(found - std::floor(expected)) <= 1.0);  // the last may end with the run
    CHECK(std::abs(found - 1.1 * expected) > 10.0);        // sabotage
  }
}

TEST_CASE(
    "heat: damage_dose_min is the dose above which bone dies: all bone of one temperature, whose dose follows from its course, or none") {
  const auto keys = [](double limit) {
    return Keys{.share = 0.1,
                .conductivity = EvenPost::kConductivity,
                .fourier = 16.0,
                .cell = 1,
                .more = fmt::format("body_C = 43\ndamage_dose_min = {:.17g}\n", limit)};
  };
  const EvenPost post(keys(16.0), 10.0);
  const double dose = post.dose(), error = std::exp2(post.error) - 1.0;
  MESSAGE("dose " << heat_figure(*post.run, "dose_inner_face_min") << " min, twin " << dose << " min, derived " << error * 100.0 << " %");
  REQUIRE(error < 0.02);
  CHECK(std::abs(heat_figure(*post.run, "dose_inner_face_min") / dose - 1.0) < error);
  for (const double factor : {0.97, 1.03}) {  // a limit that is wrong by a tenth would be on the other side once
    CAPTURE(factor);
    const EvenPost limited(keys(factor * dose), 10.0);
    const double whole = limited.left * 1e9;  // [mm^3]
    CHECK(std::abs(heat_figure(*limited.run, "dead_bone_mm3") - (factor < 1.0 ? whole : 0.0)) < 1e-5 * whole);
  }
}

TEST_CASE("heat: reach_mm is the distance of the box's faces from the drilled line, cell_voxels the edge of its cells") {
  // Voxels of 0.1 mm; the line goes from the middle of the post's face 3 mm down.
  DrillRun plain(drilled_post("", {"volume.spacing_mm=0.1"}));
  const Affine index_from_bone = plain.loaded().bone->bone_from_index().inverse();
  const auto expected = [&](double reach, int cell) {
    double count = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 low(0.0), high(0.0);
      low[axis] = -reach * 1e-3 - (axis == 2 ? 3e-3 : 0.0);
      high[axis] = reach * 1e-3;
      const double first = std::floor(std::floor((index_from_bone * low)[axis]) / cell);
      const double last = std::floor(std::floor((index_from_bone * high)[axis]) / cell);
      count *= last - first + 1.0;
    }
    return count;
  };
  for (const double reach : {0.87, 1.23})
    for (const int cell : {1, 2, 3}) {
      CAPTURE(reach);
      CAPTURE(cell);
      DrillRun run(drilled_post(Keys{.cell = cell, .more = fmt::format("reach_mm = {}\n", reach)}.text(), {"volume.spacing_mm=0.1"}));
      const double cells = heat_figure(run, "cells");
      MESSAGE(cells << " cells, expected " << expected(reach, cell));
      CHECK(cells == expected(reach, cell));
      if (cell == 1) CHECK(cells != expected(1.1 * reach, cell));  // sabotage
      CHECK(cells != expected(reach, cell + 1));
      for (const Stage::MadeEffect& made : run.simulation().stage().effects())
        for (const ValueMap& map : made.effect->maps()) CHECK(map.pitch == doctest::Approx(0.1 * cell).epsilon(1e-9));
    }
}

TEST_CASE("heat picture: lowest_C and highest_C are the ends of the scale: the colour of bone of a known temperature, and none below") {
  const auto shown = [](const std::string& keys) {
    const EvenPost post(even_keys("[heat.picture]\n" + keys), 10.0);
    return std::pair{mesh_of(*post.run), post.rise};
  };
  const EvenPost plain(even_keys(""), 10.0);
  const double celsius = 37.0 + plain.rise;
  for (const auto& [lowest, highest] : {std::pair{40.0, 60.0}, {44.0, 60.0}, {40.0, 50.0}, {30.0, 90.0}, {20.0, 60.0}}) {
    CAPTURE(lowest);
    CAPTURE(highest);
    const AddedMesh mesh = shown(fmt::format("lowest_C = {}\nhighest_C = {}\n", lowest, highest)).first;
    const double place = (celsius - lowest) / (highest - lowest), off = plain.error / (highest - lowest);
    CHECK(colours_fit(mesh, place, off));
    CHECK_FALSE(colours_fit(mesh, (celsius - lowest) / (1.1 * highest - lowest), off));  // sabotage
    CHECK_FALSE(colours_fit(mesh, (celsius - 1.1 * lowest) / (highest - 1.1 * lowest), off));
  }
  // The face and the sides of the post, all or nothing.
  const AddedMesh below = shown(fmt::format("lowest_C = {}\n", celsius - plain.error)).first;
  const AddedMesh above = shown(fmt::format("lowest_C = {}\n", celsius + plain.error)).first;
  CHECK(std::abs(area_of(below) / area_of(shown("lowest_C = 0\n").first) - 1.0) < 1e-5);
  CHECK(area_of(below) > 20e-6);
  CHECK(area_of(above) == 0.0);
}

TEST_CASE("heat picture: quantity shows the present temperature, the highest so far, or the dose on a scale round damage_dose_min") {
  // Saline cools the face while the bit leaves it, until the bit is more than a cell above it. The face is colder than the post by the film's flow times
  // L / k, 2000 x 3 K x 3 mm / 1000 = 0.02 K, and 0.01 K warmer while it is cut: together 0.004 of a scale of 8 K.
  const double off = 0.004;
  const auto cooled = [](const std::string& quantity) {
    const Keys keys{.conductivity = 1000.0,
                    .fourier = 1.0,
                    .more = fmt::format("[heat.picture]\nquantity = \"{}\"\nlowest_C = 36\nhighest_C = 44\n", quantity)};
    DrillRun run(drilled_post(keys.text() + "[irrigation]\nalways = true\ntemperature_C = 36\n", {"hand.stop_mm=1.0", "duration_s=11.0"}));
    run.run();
    struct Seen {
      AddedMesh mesh;
      double present, peak;  // [-] of the scale
    };
    return Seen{mesh_of(run), (*column_of(run, "hottest") - 36.0) / 8.0, (heat_figure(run, "hottest_C") - 36.0) / 8.0};
  };
  const auto now = cooled("temperature"), highest = cooled("peak");
  MESSAGE("present " << now.present << ", highest " << now.peak << " of the scale");
  REQUIRE(now.peak - now.present > 10.0 * off);
  CHECK(colours_fit(now.mesh, now.present, off));
  CHECK(colours_fit(highest.mesh, highest.peak, off));
  CHECK_FALSE(colours_fit(highest.mesh, highest.present, off));  // sabotage
  CHECK_FALSE(colours_fit(now.mesh, now.peak, off));

  // A factor of 16 in the dose is half of the scale.
  for (const double limit : {0.05, 0.3, 2.0}) {
    CAPTURE(limit);
    Keys keys = even_keys(fmt::format("body_C = 43\ndamage_dose_min = {}\n[heat.picture]\nquantity = \"dose\"\n", limit));
    keys.share = 0.1;
    const EvenPost post(keys, 10.0);
    const AddedMesh mesh = mesh_of(*post.run);
    const auto place = [&](double least) { return 0.5 + std::log2(post.dose() / least) / 8.0; };
    CHECK(colours_fit(mesh, place(limit), post.error / 8.0));
    CHECK_FALSE(colours_fit(mesh, place(1.1 * limit), post.error / 8.0));  // sabotage
  }
}

}  // namespace burrhole::test
