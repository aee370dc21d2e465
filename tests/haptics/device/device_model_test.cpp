#include "haptics/device/device_model.h"
#include "tests/support/source_folder.h"

#include <doctest/doctest.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

using namespace burrhole;

namespace {

const DeviceModel& device(std::string_view name) {
  const auto found = find_device(name);
  REQUIRE(found.ok());
  return **found;
}

}  // namespace

TEST_CASE("find_device: every device and hand is found by its own name, and a misspelt name suggests the nearest") {
  REQUIRE_FALSE(device_models().empty());
  REQUIRE_FALSE(hand_models().empty());
  for (const DeviceModel& model : device_models()) CHECK(&device(model.name) == &model);
  for (const HandModel& model : hand_models()) {
    const auto found = find_hand(model.name);
    REQUIRE(found.ok());
    CHECK(*found == &model);
  }
  CHECK(find_device("facon").error().message == "unknown device \"facon\"; did you mean \"falcon\"?");
  CHECK(find_device("omega3").error().message == "unknown device \"omega3\"; did you mean \"omega_3\"?");
  CHECK(find_hand("nominl").error().message == "unknown hand \"nominl\"; did you mean \"nominal\"?");
  CHECK(find_hand("xyzzyx").error().message == "unknown hand \"xyzzyx\"; there are none nominal light firm arm");
  CHECK(find_device("").error().code == ErrorCode::bad_input);
}

TEST_CASE("device models: each figure says where it comes from, and only a figure that nobody has is zero") {
  std::set<std::string_view> names;
  for (const DeviceModel& model : device_models()) {
    CAPTURE(std::string(model.name));
    CHECK(names.insert(model.name).second);
    for (const DeviceFigureName& named : device_figure_names()) {
      const Figure& figure = model.*named.figure;
      CAPTURE(std::string(named.name));
      CHECK_FALSE(figure.source.empty());
      CHECK((figure.value > 0.0) == (figure.provenance != Provenance::absent));
      CHECK_FALSE(name_of(figure.provenance).empty());
    }
  }
  for (const HandModel& model : hand_models())
    for (const Figure& figure : {model.mass, model.damping, model.stiffness}) CHECK_FALSE(figure.source.empty());
}

TEST_CASE("device models: what a device does not publish is the generic test device's, said to be assumed") {
  const DeviceModel& generic = device("generic");
  int assumed = 0;
  for (const DeviceModel& model : device_models())
    for (const DeviceFigureName& named : device_figure_names()) {
      const Figure& figure = model.*named.figure;
      if (figure.provenance != Provenance::assumed) continue;
      CHECK(figure.value == (generic.*named.figure).value);
      CHECK(figure.source == "generic test device");
      ++assumed;
    }
  CHECK(assumed > 6);
  CHECK(device("falcon").mass.provenance == Provenance::assumed);
  CHECK(device("falcon").largest_force.provenance == Provenance::read);
  CHECK(device("touch").friction.provenance == Provenance::unverified);
}

TEST_CASE("device models: the Falcon's step is that of its encoder at the end of the upper arm") {
  // 0.01425 * 360 / (4 * 320 * 0.110) degrees a count, on an arm of 60 mm; the table has two figures.
  const double step = 0.01425 * 360.0 / (4.0 * 320.0 * 0.110) * std::numbers::pi / 180.0 * 0.060;
  CHECK(std::abs(device("falcon").quantum.value - step) < 0.5e-6);
}

TEST_CASE("device models: at its largest force against the library's stiffest wall a device sinks by more than the inner table is thick") {
  // 2.7, 8.3 and 4.7 mm in the project's facts; the inner table is 1.7 mm.
  for (const auto& [name, depth] : {std::pair{"falcon", 2.7e-3}, {"touch", 8.3e-3}, {"omni", 4.7e-3}}) {
    const DeviceModel& model = device(name);
    CHECK(std::abs(model.largest_force.value / model.library_stiffness.value - depth) < 0.06e-3);
  }
}

TEST_CASE("body_of: masses and dampings add, the spring is the hand's") {
  const auto hand = find_hand("nominal");
  REQUIRE(hand.ok());
  const MassSpringDamperConfig body = body_of(device("generic"), **hand);
  CHECK(body.mass == 0.25);
  CHECK(body.damping == 5.0);
  CHECK(body.stiffness == 300.0);
}

namespace {

/// "0.26 U": a figure as the page's tables write it, in their unit; an absent one is "-".
std::string cell(const Figure& figure, double unit) {
  if (figure.provenance == Provenance::absent) return "-";
  std::ostringstream text;
  text << figure.value / unit << ' ' << static_cast<char>(std::toupper(name_of(figure.provenance).front()));
  return text.str();
}

std::string page() {
  std::ifstream file(test::in_source("docs/devices.md"));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("docs/devices.md: its tables say what the code says, figure by figure") {
  const std::string text = page();
  for (const DeviceModel& model : device_models()) {
    std::string row = "| `" + std::string(model.name) + "` | " + std::string(model.title);
    for (const DeviceFigureName& named : device_figure_names()) row += " | " + cell(model.*named.figure, named.unit == "m" ? 1e-3 : 1.0);
    row += " |";
    CHECK_MESSAGE(text.find(row) != std::string::npos, row);
  }
  for (const HandModel& model : hand_models()) {
    std::string row = "| `" + std::string(model.name) + "` | " + std::string(model.title);
    for (const Figure& figure : {model.mass, model.damping, model.stiffness}) row += " | " + cell(figure, 1.0);
    row += " |";
    CHECK_MESSAGE(text.find(row) != std::string::npos, row);
  }
}
