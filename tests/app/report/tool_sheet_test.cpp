#include "app/report/tool_sheet.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <set>

#include <string>

#include "app/render/png.h"
#include "app/report/tool_raster.h"
#include "core/tool/make_tool.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

Tool shipped(const std::string& name) {
  Issues issues;
  auto tool = load_tool(test::in_source("app/tools/") + name + ".toml", {.erosion_pitch = 0.1e-3}, issues);
  REQUIRE_MESSAGE(tool.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*tool);
}

/// Share of pixels of one colour.
double share(const Raster& raster, const Rgb& colour) {
  return static_cast<double>(std::count(raster.pixels.begin(), raster.pixels.end(), colour)) / static_cast<double>(raster.pixels.size());
}

SheetFrame square(double half) {
  SheetFrame frame;
  frame.include(-half, -half);
  frame.include(half, half);
  return frame;
}

}  // namespace

TEST_CASE("frame: it holds what was included, has the aspect asked for and grows upwards") {
  SheetFrame frame;
  frame.include(0.0, 0.0);
  frame.include(-1.0, 2.0);
  frame.include(3.0, 1.0);
  const SheetFrame fitted = frame.fitted(0.05, 0.5);
  CHECK((fitted.u_hi - fitted.u_lo) / (fitted.v_hi - fitted.v_lo) == doctest::Approx(0.5).epsilon(1e-12));
  CHECK(fitted.u_lo == doctest::Approx(-1.2).epsilon(1e-12));
  CHECK(fitted.v_lo == doctest::Approx(-0.2).epsilon(1e-12));
  CHECK(fitted.v_hi > 2.2);
}

TEST_CASE("view: three directions at right angles, right-handed") {
  const SheetView view = oblique_view();
  CHECK(glm::length(glm::cross(view.right, view.up) - view.viewer) < 1e-15);  // rounding
  CHECK(view.viewer.z < 0.0);                                                 // from below: the working end shows
}

TEST_CASE("section: a burr's head has the area of its circle in factors, its shank is passive") {
  const Tool burr = shipped("round_burr_6mm");
  const SheetFrame frame = square(5e-3);
  const Raster cut = cut_tool(burr, frame, {300, 300});
  const double passive = share(cut, kPassive), paper = share(cut, kPaper);
  // 10 x 10 mm show the half plane z < 0, empty, and z in 0..5: a circle of 3 mm cut off at z = 5, and the shank of 2.7 mm beside nothing
  const double h = 1.0, r = 3.0;  // the cap above 5 mm is 1 mm high
  const double cap = r * r * std::acos((r - h) / r) - (r - h) * std::sqrt(2 * r * h - h * h);
  const double head = 3.14159265 * r * r - cap;
  // the edge of a circle drawn in cells of 0.1 mm and pixels of 0.033: 2 % of its area
  CHECK(1.0 - passive - paper == doctest::Approx(head / 100.0).epsilon(0.03));
  CHECK(passive < 0.01);
  CHECK(cut.pixels[cut.at(150, 10)] == kPaper);
}

TEST_CASE("section: a tube is open in the middle, a cap closes it") {
  const Tool crown = shipped("trephine_12mm");
  SheetFrame frame;
  frame.include(-8e-3, 0.0);
  frame.include(8e-3, 16e-3);
  const Raster cut = cut_tool(crown, frame, {160, 160});  // 0.1 mm a pixel
  CHECK(cut.pixels[cut.at(80, 50)] == kPaper);            // on the axis, 5 mm up
  CHECK(cut.pixels[cut.at(80, 140)] == kPassive);         // in the cap
  CHECK(cut.pixels[cut.at(80 + 55, 10)] == factor_colour(1.0));
  CHECK(cut.pixels[cut.at(80 - 55, 80)] == kPassive);  // wall above the teeth
}

TEST_CASE("shading: a sphere's outline is a disc, nearest at its middle, and cutting parts are warm") {
  const Tool ball = shipped("acosta_liu_round");
  SheetFrame frame;
  frame.include(-2.5e-3, -0.5e-3);
  frame.include(2.5e-3, 4.5e-3);
  const SheetView front;
  const Raster look = shade_tool(ball, front, frame, {200, 200}, Shading::solid);
  std::size_t covered = 0;
  for (const float depth : look.depth) covered += depth > -1.0f ? 1 : 0;
  // flats of 1/64 turn lose 0.2 %; a pixel counts when one of its nine samples is covered: half a pixel of 80 all round, 1.2 %
  CHECK(static_cast<double>(covered) / 40000.0 == doctest::Approx(3.14159265 * 4.0 / 25.0).epsilon(0.02));
  CHECK(static_cast<double>(look.depth[look.at(100, 100)]) == doctest::Approx(2e-3).epsilon(0.01));
  const Rgb middle = look.pixels[look.at(100, 100)];
  CHECK(middle[0] > middle[2] + 60);
  const Tool perforator = shipped("perforator_14_11");
  SheetFrame high;
  high.include(-10e-3, 20e-3);
  high.include(10e-3, 40e-3);
  const Rgb shank = shade_tool(perforator, front, high, {100, 100}, Shading::solid).pixels[50 * 100 + 50];
  CHECK(shank[2] >= shank[0]);  // steel
}

TEST_CASE("sheet: every shipped bit makes a script of one picture each panel, names and units on it") {
  int sheets = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::in_source("app/tools"))) {
    const Tool tool = shipped(entry.path().stem().string());
    const std::string script = tool_sheet_script({&tool, "Headline \"quoted\"", "subtitle"});
    CAPTURE(tool.name);
    for (const char* needle : {"pngcairo", "Headline \\\"quoted\\\"", "subtitle", "$picture", "$pale", "$cut", "[mm]",
                               "erosion factor e [1/rev]", "does not cut"})
      CHECK(script.find(needle) != std::string::npos);
    CHECK(script.find("nan") == std::string::npos);
    CHECK(script == tool_sheet_script({&tool, "Headline \"quoted\"", "subtitle"}));
    ++sheets;
  }
  CHECK(sheets > 0);
}

TEST_CASE("sheet: the working end fills at least half of its picture across, or as much of it upwards as cuts; a missing shaft is named") {
  int burrs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::in_source("app/tools"))) {
    const Tool tool = shipped(entry.path().stem().string());
    CAPTURE(tool.name);
    const std::string script = tool_sheet_script({&tool, "headline", "subtitle"});
    // The first panel is that of the picture.
    std::smatch x, y;
    REQUIRE(std::regex_search(script, x, std::regex(R"(set xrange \[([-0-9.e]+):([-0-9.e]+)\])")));
    REQUIRE(std::regex_search(script, y, std::regex(R"(set yrange \[([-0-9.e]+):([-0-9.e]+)\])")));
    double wide = 0.0, high = 0.0;  // [m] of what cuts
    for (const Vec3& p : tool.erosion.positions) {
      wide = std::max(wide, 2.0 * std::abs(p.x));
      high = std::max(high, p.z);
    }
    const double across = 1e3 * wide / (std::stod(x[2]) - std::stod(x[1])), upwards = 1e3 * high / (std::stod(y[2]) - std::stod(y[1]));
    CHECK((across > 0.45 || upwards > 0.45));
    const bool burr = tool.name.starts_with("round_burr") || tool.name.starts_with("twist");
    if (burr) CHECK(across > 0.55);
    burrs += burr ? 1 : 0;
    CHECK((script.find("has no shaft") != std::string::npos) == tool.name.starts_with("acosta_liu"));
  }
  CHECK(burrs == 6);
}

TEST_CASE("sheet: a PNG of its size that is far from blank; no gnuplot and an invalid path are reported") {
  const TemporaryFolder folder;
  const Tool tool = shipped("craniotome_2_3mm");
  const ToolSheet sheet{&tool, "Headline", "Subtitle"};
  const Status missing = write_tool_sheet(sheet, folder.file("none.png"), "no-such-gnuplot");
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().code == ErrorCode::unavailable);
  const Status written = write_tool_sheet(sheet, folder.file("sheet.png"));
  if (!written && written.error().code == ErrorCode::unavailable) {
    MESSAGE("skipped: " << written.error().text());
    return;
  }
  REQUIRE_MESSAGE(written.ok(), (written ? "" : written.error().text()));
  const auto image = read_png(folder.file("sheet.png"));
  REQUIRE(image.ok());
  CHECK(image->width == kToolSheetWidth);
  CHECK(image->height == kToolSheetHeight);
  std::set<std::uint32_t> colours;
  std::size_t white = 0;
  for (const Rgba8& p : image->pixels) {
    colours.insert(static_cast<std::uint32_t>(p.r << 16 | p.g << 8 | p.b));
    white += p.r == 255 && p.g == 255 && p.b == 255 ? 1 : 0;
  }
  CHECK(colours.size() > 300);  // a blank sheet has one, axes alone a few dozen
  CHECK(white < image->pixels.size() * 9 / 10);
  const Status refused = write_tool_sheet(sheet, "/proc/no_such_place/sheet.png");
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::bad_input);
}
