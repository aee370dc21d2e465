#include "core/sheet/elastic_sheet.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>

namespace burrhole::test {
namespace {

constexpr double kPi = 3.14159265358979323846, kRadius = 8e-3;

ElasticSheet flat(const SheetConfig& config, double spacing, double radius = kRadius) {
  auto lattice = SheetLattice::create(radius, spacing);
  REQUIRE(lattice);
  const std::vector<double> level(lattice->nodes(), 0.0);
  auto out = ElasticSheet::create(config, std::move(*lattice), level);
  REQUIRE(out);
  return std::move(out).value();
}

/// Nothing but the sheet itself.
SheetConfig bare() { return {.strain_limit = 10.0, .support = 0.0, .resistance = 1.0, .adhesion = 0.0}; }

/// [m] of the node in the middle, towards +z.
double middle(const ElasticSheet& sheet) {
  double out = 0.0, nearest = 1.0;
  for (std::size_t n = 0; n < sheet.lattice().nodes(); ++n) {
    const double away = std::hypot(sheet.lattice().x(n), sheet.lattice().y(n));
    if (away < nearest) {
      nearest = away;
      out = sheet.position(n).z - sheet.rest(n).z;
    }
  }
  return out;
}

/// [m] radius of the clamped edge of a lattice: that of the rim's nodes, by their area.
double clamped_radius(const SheetLattice& lattice) {
  double free = 0.0, rim = 0.0;
  for (std::size_t n = 0; n < lattice.nodes(); ++n) (lattice.on_rim(n) ? rim : free) += lattice.area();
  return std::sqrt((free + 0.5 * rim) / kPi);
}

/// Twin: an axisymmetric membrane that is clamped at its edge, under a uniform pressure: N_r dw/dr = -q r / 2 and the compatibility of the
/// strains, r^2 N'' + 3 r N' = -(E t / 2) (dw/dr)^2 (Foeppl, Hencky 1915), by shooting for u = 0 at the edge. @returns w in the middle.
double pressed_membrane(double stiffness, double poisson, double radius, double pressure) {
  constexpr int kSteps = 4000;
  const double h = radius / kSteps;
  const auto shoot = [&](double start, double* deflection) {
    double n = start, slope = 0.0, w = 0.0;
    const auto tilt = [&](double r, double force) { return -pressure * r / (2.0 * force); };
    const auto curvature = [&](double r, double force, double d) {
      const double t = tilt(r, force);
      return (-0.5 * stiffness * t * t - 3.0 * r * d) / (r * r);
    };
    for (int k = 0; k < kSteps; ++k) {
      const double r = h * k;
      if (k == 0) {
        // N = N0 + c r^2 near the middle: 8 c r^2 = -(E t / 2) (q r / (2 N0))^2.
        const double c = -stiffness * pressure * pressure / (64.0 * start * start);
        n = start + c * h * h;
        slope = 2.0 * c * h;
        w += 0.5 * h * tilt(h, n);
        continue;
      }
      const double k1 = slope, l1 = curvature(r, n, slope);
      const double k2 = slope + 0.5 * h * l1, l2 = curvature(r + 0.5 * h, n + 0.5 * h * k1, k2);
      const double k3 = slope + 0.5 * h * l2, l3 = curvature(r + 0.5 * h, n + 0.5 * h * k2, k3);
      const double k4 = slope + h * l3, l4 = curvature(r + h, n + h * k3, k4);
      const double before = tilt(r, n);
      n += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      slope += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
      if (!(n > 0.0)) return -1.0;
      w += 0.5 * h * (before + tilt(r + h, n));
    }
    if (deflection != nullptr) *deflection = -w;
    return radius * slope + (1.0 - poisson) * n;
  };
  double low = 0.0, high = 1e4;
  for (int n = 0; n < 200; ++n) {
    const double mid = 0.5 * (low + high);
    (shoot(mid, nullptr) > 0.0 ? high : low) = mid;
  }
  double out = 0.0;
  (void)shoot(high, &out);
  return out;
}

/// Steps until nothing moves.
void settle(ElasticSheet& sheet, const SheetLoad& load) {
  for (int n = 0; n < 40; ++n) (void)sheet.step(10.0, load);
}

}  // namespace

TEST_CASE("sheet: the twin of a pressed membrane has the value in print") {
  // Timoshenko & Woinowsky-Krieger: w = 0.662 R (q R / (E t))^(1/3) at a Poisson's ratio of 0.3, to about 2 % (Hencky's series: 0.653).
  const double value = pressed_membrane(35e3, 0.3, 8e-3, 1e3) / (8e-3 * std::cbrt(1e3 * 8e-3 / 35e3));
  CHECK(value == doctest::Approx(0.653).epsilon(0.005));
}

TEST_CASE("sheet: a membrane under pressure comes to the deflection of the twin as its mesh is refined") {
  // The rim of a lattice is a polygon: its radius is uncertain by a quarter of a spacing or so on each side, and w goes with R^(4/3): the bound is
  // 4/3 x 0.25 s / R, 4 % at R / s = 8, and half of it at 16.
  double before = 1.0;
  for (const double spacing : {1.6e-3, 0.8e-3, 0.4e-3}) {
    SheetConfig config = bare();
    config.thickness = 0.02e-3;  // so that bending, which is not in the twin, is nothing
    config.modulus = 35e3 / config.thickness;
    ElasticSheet sheet = flat(config, spacing);
    const double pressure = 1e3;
    settle(sheet, {.pressure = pressure});
    const double twin = pressed_membrane(35e3, 1.0 / 3.0, clamped_radius(sheet.lattice()), pressure);
    const double error = std::abs(middle(sheet) / twin - 1.0);
    MESSAGE("spacing " << spacing * 1e3 << " mm: " << middle(sheet) * 1e3 << " mm, twin " << twin * 1e3 << " mm, " << error * 100.0
                       << " %");
    CHECK(error < 4.0 / 3.0 * 0.25 * spacing / kRadius + 0.005);
    CHECK(error < before + 0.005);
    before = error;
  }
  // The sabotage: springs of half the stiffness are found.
  SheetConfig soft = bare();
  soft.thickness = 0.02e-3;
  soft.modulus = 0.5 * 35e3 / soft.thickness;
  ElasticSheet sheet = flat(soft, 0.8e-3);
  settle(sheet, {.pressure = 1e3});
  CHECK(std::abs(middle(sheet) / pressed_membrane(35e3, 1.0 / 3.0, clamped_radius(sheet.lattice()), 1e3) - 1.0) > 0.15);
}

TEST_CASE("sheet: under tension a small pressure deflects it by q R^2 / (4 T), without by q R^4 / (64 D)") {
  for (const bool tense : {true, false}) {
    double errors[2];
    int at = 0;
    for (const double spacing : {0.8e-3, 0.4e-3}) {
      SheetConfig config = bare();
      config.tension = tense ? 0.02 : 0.0;
      if (tense) config.thickness = 0.02e-3;
      ElasticSheet sheet = flat(config, spacing);
      const double r = clamped_radius(sheet.lattice()), pressure = tense ? 1.0 : 100.0;  // 8 um, of a sheet of 500 um
      settle(sheet, {.pressure = pressure});
      // T = E t e / (1 - 1/3), e the strain of an edge over its length at rest; D as in elastic_sheet.h.
      const double force = config.modulus * config.thickness * 0.02 / (2.0 / 3.0);
      const double d = config.modulus * std::pow(config.thickness, 3) / (12.0 * (1.0 - 1.0 / 9.0));
      const double truth = tense ? pressure * r * r / (4.0 * force) : pressure * std::pow(r, 4) / (64.0 * d);
      errors[at++] = middle(sheet) / truth - 1.0;
      MESSAGE(std::string(tense ? "tension" : "plate") << ", spacing " << spacing * 1e3 << " mm: " << errors[at - 1] * 100.0 << " %");
    }
    // w goes with R^2 and R^4: a quarter of a spacing of R, twice or four times.
    const double power = tense ? 2.0 : 4.0;
    CHECK(std::abs(errors[0]) < power * 0.25 * 0.8e-3 / kRadius);
    CHECK(std::abs(errors[1]) < power * 0.25 * 0.4e-3 / kRadius + 0.005);
  }
}

TEST_CASE("sheet: half the tension is twice the deflection by a small pressure, q R^2 / (4 T)") {
  for (const double tension : {0.01, 0.02, 0.04}) {
    SheetConfig config = bare();
    config.tension = tension;
    config.thickness = 0.02e-3;
    ElasticSheet sheet = flat(config, 0.8e-3);
    settle(sheet, {.pressure = 1.0});
    const double r = clamped_radius(sheet.lattice()), force = config.modulus * config.thickness * tension / (2.0 / 3.0);
    CHECK(std::abs(middle(sheet) * 4.0 * force / (r * r) - 1.0) < 2.0 * 0.25 * 0.8e-3 / kRadius + 0.005);  // as above
  }
}

TEST_CASE("sheet: on a body below alone it follows a pressure with the time constant resistance / support") {
  // u = p / g (1 - (1 + g dt / b)^-n) of implicit steps. A step leaves forces of 1e-4 of the load; the sheet itself has no stiffness.
  for (const double resistance : {1e6, 2e6}) {
    SheetConfig config = bare();
    config.modulus = 1.0;
    config.support = 2e7;
    config.resistance = resistance;
    ElasticSheet sheet = flat(config, 0.8e-3);
    const auto expected = [&](double b, int n) { return 1e4 / 2e7 * (1.0 - std::pow(1.0 + 2e7 * 0.02 / b, -n)); };
    for (int n = 1; n <= 8; ++n) {
      (void)sheet.step(0.02, {.pressure = 1e4});
      CHECK(std::abs(middle(sheet) / expected(resistance, n) - 1.0) < 2e-3);
      CHECK(std::abs(middle(sheet) / expected(1.2 * resistance, n) - 1.0) > 2e-3);  // sabotage
    }
  }
}

TEST_CASE("sheet: under a pressure away from the bone it comes off at its adhesion and what the body below carries until then") {
  // A sheet without stiffness moves by u = p / (adhesion / way + support) everywhere: it comes off where u passes the way.
  for (const double adhesion : {2e3, 5e3, 20e3}) {
    CAPTURE(adhesion);
    SheetConfig config;
    config.strain_limit = 10.0;
    config.modulus = 1.0;
    config.adhesion = adhesion;
    const double limit = adhesion + config.support * config.adhesion_way;
    for (const double share : {0.98, 1.02}) {
      ElasticSheet sheet = flat(config, 0.8e-3);
      for (std::size_t n = 0; n < sheet.lattice().nodes(); ++n) sheet.cover(n, SheetCover::bone);
      settle(sheet, {});
      settle(sheet, {.pressure = -share * limit});
      CHECK((sheet.state().separated > 0.0) == (share > 1.0));
    }
  }
}

TEST_CASE("sheet: a stamp pressed into it meets the derivative of its energy, and the stiffness is that of the force") {
  SheetConfig config;
  config.strain_limit = 1.0;
  ElasticSheet sheet = flat(config, 0.8e-3);
  std::vector<Vec3> stamp;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j) stamp.emplace_back(0.3e-3 * i, 0.3e-3 * j, 0.0);
  const auto at = [&](double depth) {
    for (Vec3& p : stamp) p.z = -depth;
    settle(sheet, {.tool_points = stamp});
    return sheet.state();
  };
  const double d = 2e-6;
  for (const double depth : {0.2e-3, 0.8e-3, 1.5e-3}) {
    const SheetState low = at(depth - d), mid = at(depth), high = at(depth + d);
    // A central difference: its error is of second order in d / depth, below 1e-4; the forces are found to 1e-6 N.
    CHECK(mid.force == doctest::Approx((high.energy - low.energy) / (2.0 * d)).epsilon(1e-3));
    CHECK(mid.stiffness == doctest::Approx((high.force - low.force) / (2.0 * d)).epsilon(0.02));
    CHECK(mid.indentation > 0.95 * depth);
    // A triangle at the edge of the stamp tilts about its points: its inner node lies deeper by the slope there, depth / (a ln(R / a)), times the
    // spacing; a = 1.2 mm.
    CHECK(mid.indentation < depth * (1.0 + 0.8 / (1.2 * std::log(8.0 / 1.2))));
    MESSAGE(depth * 1e3 << " mm: " << mid.force << " N, " << mid.stiffness * 1e-3 << " N/mm");
  }
}

TEST_CASE("sheet: its energy is that of a plain sum over edges and nodes; a sum without the mirrored rim is noticed") {
  SheetConfig config;
  config.strain_limit = 1.0;
  config.adhesion = 0.0;
  ElasticSheet sheet = flat(config, 0.8e-3);
  const SheetLattice& lattice = sheet.lattice();
  std::vector<Vec3> spikes;
  for (const double x : {-6.3e-3, -3e-3, 1e-3, 5.9e-3}) spikes.emplace_back(x, 0.2 * x + 0.5e-3, -0.6e-3);
  // The sum of elastic_sheet.h, term by term; the matrices of the step are not in it.
  const auto twin = [&](bool mirrored) {
    const double s = lattice.spacing(), area = lattice.area();
    const double d = config.modulus * std::pow(config.thickness, 3) / (12.0 * (1.0 - 1.0 / 9.0));
    const double stiffness = std::sqrt(3.0) / 2.0 * config.modulus * config.thickness;
    double sum = 0.0;
    for (const SheetEdge& edge : lattice.edges()) {
      const double longer =
          glm::length(sheet.position(edge.a) - sheet.position(edge.b)) - glm::length(sheet.rest(edge.a) - sheet.rest(edge.b));
      sum += 0.5 * stiffness * longer * longer;
    }
    const auto moved = [&](std::size_t n) { return sheet.position(n) - sheet.rest(n); };
    for (std::size_t n = 0; n < lattice.nodes(); ++n) {
      Vec3 bent(0.0);
      for (std::size_t k = 0; k < 6; ++k) {
        std::uint32_t other = lattice.neighbours(n)[k];
        if (other == SheetLattice::kNoNode && mirrored) other = lattice.neighbours(n)[(k + 3) % 6];
        if (other != SheetLattice::kNoNode) bent += moved(other) - moved(n);
      }
      const Vec3 curvature = 2.0 / (3.0 * s * s) * bent;
      sum += (lattice.on_rim(n) ? 0.5 : 1.0) * 0.5 * d * area * glm::dot(curvature, curvature);
      sum += 0.5 * area * config.support * moved(n).z * moved(n).z;
    }
    for (const Vec3& spike : spikes) {
      const auto place = lattice.find(spike.x, spike.y);
      REQUIRE(place);
      double z = 0.0;
      for (std::size_t k = 0; k < 3; ++k) z += place->weights[k] * sheet.position(place->nodes[k]).z;
      sum += 0.5 * config.tool_stiffness * std::pow(std::max(0.0, z - spike.z), 2);
    }
    return sum;
  };
  for (int n = 0; n < 5; ++n) {
    const double energy = sheet.step(0.02, {.tool_points = spikes}).energy;
    REQUIRE(energy > 1e-6);
    CHECK(energy == doctest::Approx(twin(true)).epsilon(1e-10));  // rounding of some thousand terms
    CHECK_FALSE(energy == doctest::Approx(twin(false)).epsilon(1e-6));
  }
}

TEST_CASE("sheet: its equilibrium does not depend on how the tool came there, to what a step may leave") {
  SheetConfig config;
  config.strain_limit = 1.0;
  std::vector<Vec3> stamp;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j) stamp.emplace_back(0.4e-3 * i, 0.4e-3 * j, 0.0);
  // At once, slowly, and from below: the starts of Newton's method and of the stiffness differ.
  std::vector<SheetState> found;
  for (const std::vector<double>& depths : {std::vector{1.2e-3}, {0.3e-3, 0.6e-3, 0.9e-3, 1.2e-3}, {1.8e-3, 1.5e-3, 1.2e-3}}) {
    ElasticSheet sheet = flat(config, 0.8e-3);
    for (const double depth : depths) {
      for (Vec3& p : stamp) p.z = -depth;
      (void)sheet.step(0.02, {.tool_points = stamp});
    }
    settle(sheet, {.tool_points = stamp});
    found.push_back(sheet.state());
  }
  for (const SheetState& state : found) {
    // A step leaves forces of 1e-4 of the tool's.
    CHECK(state.force == doctest::Approx(found[0].force).epsilon(1e-3));
    CHECK(state.stiffness == doctest::Approx(found[0].stiffness).epsilon(1e-2));
    CHECK(std::abs(state.indentation - found[0].indentation) < 1e-6);
  }
}

TEST_CASE("sheet: its energy never grows without load, at steps of 1 to 100 ms and any start; it ends where it was") {
  std::mt19937 random(11);
  MESSAGE("seed 11");
  for (const double dt : {1e-3, 3e-3, 1e-2, 1e-1}) {
    SheetConfig config;
    config.strain_limit = 10.0;
    ElasticSheet sheet = flat(config, 1e-3);
    std::uniform_real_distribution<double> place(-5e-3, 5e-3);
    std::vector<Vec3> spikes;
    for (int n = 0; n < 60; ++n) spikes.emplace_back(place(random), place(random), -3e-3 + 0.2 * place(random));
    double before = sheet.step(dt, {.pressure = -5e3, .tool_points = spikes}).energy;
    REQUIRE(before > 1e-6);
    for (int n = 0; n < 200; ++n) {
      const double now = sheet.step(dt, {}).energy;
      REQUIRE(std::isfinite(now));
      REQUIRE(now <= before * (1.0 + 1e-12) + 1e-18);
      before = now;
    }
    CHECK(sheet.state().force == 0.0);
    // The slowest mode relaxes at g / b = 10 / s or faster: 20 s leave exp(-200) of it.
    for (int n = 0; n < 200; ++n) (void)sheet.step(0.1, {});
    CHECK(sheet.state().energy < 1e-12);
  }
}

TEST_CASE("sheet: it tears at its strain limit and the tool then goes through; extreme motions stay finite") {
  SheetConfig config;
  ElasticSheet sheet = flat(config, 0.8e-3);
  std::vector<Vec3> tip{Vec3(0.1e-3, 0.05e-3, 0.0)};
  double force = 0.0, largest = 0.0, torn_at = 0.0, strain = 0.0;
  for (double depth = 0.0; depth < 6e-3; depth += 0.05e-3) {
    tip[0].z = -depth;
    force = sheet.step(0.02, {.tool_points = tip}).force;
    largest = std::max(largest, force);
    if (sheet.state().torn == 0) strain = sheet.state().strain;
    if (sheet.state().torn > 0 && torn_at == 0.0) torn_at = depth;
  }
  CHECK(torn_at > 0.3e-3);
  CHECK(strain > 0.8 * config.strain_limit);
  CHECK(strain <= config.strain_limit * (1.0 + 1e-9));
  CHECK(largest > 0.1);
  CHECK(force == 0.0);
  // Divided steps: the largest strain of an edge that is whole lies between the limit and 1.02 of it, just before the edge breaks. The sabotage:
  // a limit that is a tenth larger is found.
  for (const double wrong : {1.0, 1.1}) {
    SheetConfig other = config;
    other.strain_limit *= wrong;
    ElasticSheet pressed = flat(other, 0.8e-3);
    std::vector<Vec3> from{Vec3(0.1e-3, 0.05e-3, 0.0)}, to = from;
    double stretched = 0.0;
    for (double depth = 0.0; depth < 6e-3; depth += 0.5e-3) {
      to[0].z = -depth;
      stretched = std::max(stretched, pressed.step(0.02, {.tool_points = to, .tool_from = from}).stretched);
      from = to;
    }
    CHECK(pressed.state().torn > 0);
    CHECK((stretched >= config.strain_limit && stretched <= 1.02 * config.strain_limit) == (wrong == 1.0));
  }
  // A tool that goes a metre below in one step tears the sheet: no force is left, and none above that of a slow tool was reported.
  {
    ElasticSheet other = flat(config, 0.8e-3);
    const std::vector<Vec3> from{Vec3(0.1e-3, 0.05e-3, 0.0)}, to{Vec3(0.1e-3, 0.05e-3, -1.0)};
    const SheetState& state = other.step(0.02, {.tool_points = to, .tool_from = from});
    CHECK(state.torn > 0);
    CHECK(state.force == 0.0);
    CHECK(state.peak < 1.5 * largest);
    CHECK(state.parts <= ElasticSheet::kMostParts + ElasticSheet::kMostLastParts);
  }
  const double nan = std::nan("");
  for (const Vec3& wild : {Vec3(0.0, 0.0, -1.0), Vec3(nan, 0.0, -1e-3), Vec3(0.0, 0.0, -1e9), Vec3(1e300, 0.0, -1.0)}) {
    ElasticSheet other = flat(config, 0.8e-3);
    tip[0] = wild;
    for (const double dt : {1e-3, 0.1}) {
      const SheetState& state = other.step(dt, {.pressure = nan, .tool_points = tip});
      CHECK(std::isfinite(state.force));
      CHECK(std::isfinite(state.energy));
    }
  }
}

TEST_CASE("sheet: what tears, and at which force, depends neither on the step nor on how far the tool goes in one") {
  // Peaks: an edge breaks at up to 1.02 of its limit, which is 3 % of the force; the load on a ring of about 15 edges at the ball may be shared
  // by one edge more or less, 7 %. Together 10 %.
  // Torn edges: 3 per node are under a ball of radius a, 3 pi a^2 / (sqrt(3)/2 s^2) = 27 of them; about 15 cross its border, and half of
  // those may break or not by small differences: the most is at most 1.5 of the least. At least half as many break as there are triangles
  // under the ball, 2 per node, for each edge opens two; at most those that lie within two spacings of it, where the strain of a membrane,
  // as r^(-2/3), has fallen to 0.6 of that at its border.
  constexpr double kBall = 1.25e-3, kSpacing = 0.8e-3, kDeep = 8e-3, kAbove = 0.2e-3;
  std::vector<Vec3> ball;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) {
      const double x = 0.25e-3 * i, y = 0.25e-3 * j, r2 = x * x + y * y;
      if (r2 <= kBall * kBall) ball.emplace_back(x, y, kBall - std::sqrt(kBall * kBall - r2));
    }
  const double node = std::sqrt(0.75) * kSpacing * kSpacing;
  const double fewest = kPi * kBall * kBall / node, most = 3.0 * kPi * std::pow(kBall + 2.0 * kSpacing, 2) / node;
  struct Torn {
    double peak = 0.0, deepest = 0.0, left = 0.0;
    std::size_t edges = 0, parts = 0;
  };
  const auto through = [&](double speed, double rate, bool divided) {
    ElasticSheet sheet = flat({}, kSpacing);
    const auto at = [&](double depth) {
      std::vector<Vec3> out = ball;
      for (Vec3& p : out) p.z -= depth;
      return out;
    };
    Torn out;
    std::vector<Vec3> from = at(-kAbove);
    for (double depth = -kAbove; depth < kDeep;) {
      depth = std::min(depth + speed / rate, kDeep);
      const std::vector<Vec3> to = at(depth);
      const SheetState& state =
          sheet.step(1.0 / rate, {.tool_points = to, .tool_from = divided ? std::span<const Vec3>(from) : std::span<const Vec3>()});
      out.peak = std::max(out.peak, state.peak);
      out.deepest = std::max(out.deepest, state.deepest);
      out.parts = std::max(out.parts, state.parts);
      out.left = state.force;
      out.edges = state.torn;
      REQUIRE(state.force <= state.peak * (1.0 + 1e-12));
      from = to;
    }
    return out;
  };
  const Torn slow = through(2e-3, 1000.0, true);
  for (const double speed : {2e-3, 20e-3, 100e-3}) {
    std::size_t least = slow.edges, largest = slow.edges;
    const double fine = through(speed, 1000.0, true).peak;
    for (const double rate : {10.0, 20.0, 50.0, 100.0, 1000.0}) {
      const Torn now = through(speed, rate, true);
      MESSAGE(speed * 1e3 << " mm/s, " << rate << " Hz: " << now.peak << " N at " << now.deepest * 1e3 << " mm, " << now.edges
                          << " edges, at most " << now.parts << " solutions in a step");
      CHECK(now.peak == doctest::Approx(fine).epsilon(0.1));
      CHECK(now.left == 0.0);
      CHECK(static_cast<double>(now.edges) > fewest);
      CHECK(static_cast<double>(now.edges) < most);
      CHECK(now.parts <= ElasticSheet::kMostParts + ElasticSheet::kMostLastParts);
      least = std::min(least, now.edges);
      largest = std::max(largest, now.edges);
    }
    CHECK(static_cast<double>(largest) <= 1.5 * static_cast<double>(least));
  }
  // The sabotage: steps that are not divided miss the peak.
  CHECK(std::abs(through(20e-3, 10.0, false).peak / slow.peak - 1.0) > 0.1);
}

TEST_CASE("sheet: it sticks to bone up to its adhesion, and does not rise through bone; where bone goes it is free") {
  SheetConfig config;
  config.strain_limit = 10.0;
  const auto covered = [&](double pressure, bool hole) {
    ElasticSheet sheet = flat(config, 0.8e-3);
    for (std::size_t n = 0; n < sheet.lattice().nodes(); ++n) sheet.cover(n, SheetCover::bone);
    settle(sheet, {});
    if (hole)
      for (std::size_t n = 0; n < sheet.lattice().nodes(); ++n)
        if (std::hypot(sheet.lattice().x(n), sheet.lattice().y(n)) < 4e-3) sheet.cover(n, SheetCover::open);
    settle(sheet, {.pressure = pressure});
    return std::pair(middle(sheet), sheet.state().separated);
  };
  // Pulled down by less than the adhesion, and by more.
  CHECK(covered(-0.5 * config.adhesion, false).second == 0.0);
  CHECK(std::abs(covered(-0.5 * config.adhesion, false).first) < config.adhesion_way);
  CHECK(covered(-2.0 * config.adhesion, false).second > 0.5 * kPi * kRadius * kRadius);
  // Pushed up: it stays under the bone, and bulges into the hole.
  CHECK(std::abs(covered(2e3, false).first) < config.adhesion_way);
  CHECK(covered(2e3, true).first > 2.0 * std::abs(covered(2e3, false).first));
}

TEST_CASE("sheet: wrong sizes and values are refused") {
  CHECK_FALSE(SheetLattice::create(1e-3, 1e-3).ok());
  CHECK_FALSE(SheetLattice::create(1e-3, 0.0).ok());
  CHECK_FALSE(SheetLattice::create(1.0, 1e-6).ok());
  CHECK_FALSE(SheetLattice::create(1e-2, 1e-3, [](double, double) { return false; }).ok());
  const auto lattice = SheetLattice::create(5e-3, 1e-3);
  const std::vector<double> level(lattice->nodes(), 0.0), few(3, 0.0);
  CHECK_FALSE(ElasticSheet::create({}, *lattice, few).ok());
  CHECK_FALSE(ElasticSheet::create({.modulus = 0.0}, *lattice, level).ok());
  CHECK_FALSE(ElasticSheet::create({.resistance = 0.0}, *lattice, level).ok());
  CHECK_FALSE(ElasticSheet::create({.strain_limit = std::nan("")}, *lattice, level).ok());
}

}  // namespace burrhole::test
