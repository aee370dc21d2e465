#include "core/drill/removal_rate.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/tool/make_tool.h"

using namespace burrhole;

namespace {

Tool tool_of(const std::string& regions, double pitch = 0.1e-3) {
  const auto document = TomlDocument::parse("title = \"Bit\"\n[shell]\npitch_mm = 0.4\n" + regions, "bit.toml");
  REQUIRE(document.ok());
  Issues issues;
  auto tool = make_tool(*document, {.erosion_pitch = pitch}, issues);
  REQUIRE_MESSAGE(tool.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*tool);
}

const std::string kPin = "[[region]]\nshape = \"cylinder\"\nz_mm = 0\nheight_mm = 5\ndiameter_mm = 4\nerosion_factor = 0.1\n";

/// The closed form of a flat end with an even factor.
double flat_speed(const FeedConditions& c, double factor) { return c.thrust / c.cutting_stiffness * factor * c.spin / c.hardness; }

}  // namespace

TEST_CASE("feed: a flat end with an even factor has the closed form, whatever the conditions") {
  const Tool pin = tool_of(kPin);
  for (const FeedConditions& c : {FeedConditions{}, {.thrust = 7.0}, {.spin = 100.0}, {.hardness = 0.3}, {.cutting_stiffness = 33e3}}) {
    const FeedPrediction plunge = predict_feed(pin, FeedDirection::plunge, c);
    CHECK(plunge.engaged == c.thrust / c.cutting_stiffness);
    CHECK(plunge.speed == doctest::Approx(flat_speed(c, 0.1)).epsilon(1e-6));  // factors are floats
    // the circle problem: a disc of radius 20 cells is off by under a per cent
    CHECK(plunge.area == doctest::Approx(std::numbers::pi * 4e-6).epsilon(0.01));
    CHECK(plunge.rate == plunge.area * plunge.speed);
  }
}

TEST_CASE(
    "feed: at equal thrust the power of cutting is the same in tables and diploe, so the motor's pitch does not step (docs/sound.md)") {
  const Tool pin = tool_of(kPin);
  constexpr double kSpecificEnergy = 1e8;  // [J/m^3] of hardness 1; any value
  const auto torque = [&](double hardness, double thrust) {
    const FeedConditions c{.thrust = thrust, .hardness = hardness};
    return kSpecificEnergy * hardness * predict_feed(pin, FeedDirection::plunge, c).rate / (2.0 * std::numbers::pi * c.spin);
  };
  for (const double hardness : {0.9, 0.45, 0.12}) CHECK(torque(hardness, 20.0) == doctest::Approx(torque(1.0, 20.0)).epsilon(1e-12));
  CHECK(torque(0.9, 10.0) == doctest::Approx(0.5 * torque(0.9, 20.0)).epsilon(1e-12));  // it follows the thrust, as M = mu F r does
}

TEST_CASE("feed: sideways a cylinder shows its diameter times its height and is limited where it leads") {
  const FeedConditions c;
  const FeedPrediction side = predict_feed(tool_of(kPin), FeedDirection::sideways, c);
  CHECK(side.area == doctest::Approx(4e-3 * 5e-3).epsilon(1e-9));
  // in front the wall is a step of the lattice: cells of 0.1 mm beside an engaged depth of 0.2 mm are off by up to half a cell
  CHECK(side.speed == doctest::Approx(flat_speed(c, 0.1)).epsilon(0.25));
  CHECK(predict_feed(tool_of(kPin, 0.02e-3), FeedDirection::sideways, c).speed == doctest::Approx(flat_speed(c, 0.1)).epsilon(0.05));
}

TEST_CASE("feed: a weak axis holds a burr back, a weak end a matchstick, a passive sole a foot") {
  const FeedConditions c;
  const Tool burr = tool_of("[[region]]\nshape = \"sphere\"\nz_mm = 0\ndiameter_mm = 4\nerosion_factor = 0.1\naxis_factor = 0.2\n");
  CHECK(predict_feed(burr, FeedDirection::plunge, c).speed == doctest::Approx(flat_speed(c, 0.1 * 0.2)).epsilon(1e-6));
  const Tool weak = tool_of(kPin + "bottom_factor = 0.2\nskin_mm = 1\n");
  CHECK(predict_feed(weak, FeedDirection::plunge, c).speed == doctest::Approx(flat_speed(c, 0.02)).epsilon(1e-6));
  const Tool foot = tool_of(
      "[[region]]\nshape = \"box\"\nz_mm = 0\nheight_mm = 1\nwidth_mm = 6\ndepth_mm = 3\nerosion_factor = 0\n"
      "[[region]]\nshape = \"cylinder\"\nz_mm = 1\nheight_mm = 5\ndiameter_mm = 2\nerosion_factor = 0.1\n");
  CHECK(predict_feed(foot, FeedDirection::plunge, c).speed == 0.0);
  CHECK(predict_feed(foot, FeedDirection::sideways, c).speed > 0.0);
}

TEST_CASE("feed: beside a pore on the axis a round burr cuts with its factor at 0.35 mm, a bit of one factor as ever") {
  const Tool burr = tool_of("[[region]]\nshape = \"sphere\"\nz_mm = 0\ndiameter_mm = 4\nerosion_factor = 0.1\naxis_factor = 0.2\n");
  // the nearest cells of 0.1 mm lie up to half a cell farther out, where the factor is 9 % higher
  const double beside = 0.2 + 0.8 * (0.35 - 0.25) / (2.0 - 0.25);
  CHECK(feed_beside_pore(burr) >= (1.0 - 1e-6) * beside / 0.2);
  CHECK(feed_beside_pore(burr) < 1.1 * beside / 0.2);
  CHECK(feed_beside_pore(tool_of(kPin)) == 1.0);
  const Tool crown =
      tool_of("[[region]]\nshape = \"tube\"\nz_mm = 0\nheight_mm = 2\ndiameter_mm = 8\ninner_diameter_mm = 6\nerosion_factor = 0.1\n");
  CHECK(feed_beside_pore(crown) == 1.0);
}

TEST_CASE("feed: a crown's cap above its teeth is clear of bone, and the core is no part of the area") {
  const Tool crown = tool_of(
      "[[region]]\nshape = \"tube\"\nz_mm = 0\nheight_mm = 2\ndiameter_mm = 8\ninner_diameter_mm = 6\nerosion_factor = 0.1\n"
      "[[region]]\nshape = \"tube\"\nz_mm = 2\nheight_mm = 4\ndiameter_mm = 8\ninner_diameter_mm = 6\nerosion_factor = 0\n"
      "[[region]]\nshape = \"cylinder\"\nz_mm = 6\nheight_mm = 2\ndiameter_mm = 8\nerosion_factor = 0\n");
  const FeedConditions c;
  const FeedPrediction plunge = predict_feed(crown, FeedDirection::plunge, c);
  CHECK(plunge.speed == doctest::Approx(flat_speed(c, 0.1)).epsilon(1e-6));
  CHECK(plunge.area == doctest::Approx(std::numbers::pi * (16e-6 - 9e-6)).epsilon(0.02));
}

TEST_CASE("feed: a bit without an erosion point goes nowhere") {
  Tool pin = tool_of(kPin);
  pin.erosion.positions.clear();
  pin.erosion.factors.clear();
  const FeedPrediction none = predict_feed(pin, FeedDirection::plunge, {});
  CHECK(none.speed == 0.0);
  CHECK(none.rate == 0.0);
}
