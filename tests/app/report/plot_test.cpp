#include "app/report/plot.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <regex>
#include <set>

#include "app/report/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/xml_check.h"

namespace burrhole {
namespace {

Plot make_plot() {
  Plot plot;
  plot.x_label = "Time (s)";
  PlotSeries force{"force", {}, {}}, limit{"limit", {}, {}};
  for (int i = 0; i < 5000; ++i) {
    force.x.push_back(0.001 * i);
    force.y.push_back(i == 2500 ? std::numeric_limits<double>::quiet_NaN() : 0.002 * (i % 1000));
    limit.x.push_back(0.001 * i);
    limit.y.push_back(3.0);
  }
  plot.panels.push_back({.y_label = "Force (N)", .series = {force, limit}, .bands = {}, .from_zero = true});
  plot.panels.push_back(
      {.y_label = "Depth (mm)", .series = {force}, .bands = {{"outer table", 0.0, 1.0}, {"a \"b\" <c>", 1.0, 1.1}}, .y_down = true});
  plot.events = {{1.0, "contact"}, {1.05, "breakthrough"}};
  return plot;
}

TEST_CASE("plot: the SVG is well-formed and carries every label") {
  const Result<std::string> svg = draw_svg(make_plot());
  REQUIRE_MESSAGE(svg.ok(), (svg ? "" : svg.error().text()));
  CHECK(xml_fault(*svg) == "");
  for (const char* label : {"Force (N)", "Depth (mm)", "Time (s)", "outer table", "contact", "breakthrough", "limit", "a \"b\" &lt;c>"})
    CHECK_MESSAGE(svg->find(label) != std::string::npos, std::string(label));
}

TEST_CASE("xml_fault: finds a tag left open, so that well-formed means something") {
  CHECK(xml_fault("<svg><g></g></svg>") == "");
  CHECK(xml_fault("<svg><g></svg>") != "");
  CHECK(xml_fault("<svg>") != "");
  CHECK(xml_fault("") != "");
}

TEST_CASE("plot: the same plot gives the same script") { CHECK(plot_script(make_plot()) == plot_script(make_plot())); }

TEST_CASE("plot: a label cannot leave its quotes and become a command") {
  Plot plot = make_plot();
  plot.x_label = "\"; system \"touch /tmp/evil\nset output \\";
  const std::string script = plot_script(plot);
  CHECK(script.find("set xlabel \"\\\"; system \\\"touch /tmp/evil set output \\\\\" offset") != std::string::npos);
}

TEST_CASE("plot: series without a point, or with none that is finite, still draw their axes") {
  Plot plot;
  plot.x_label = "Time (s)";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  plot.panels.push_back({.y_label = "Empty", .series = {{"none", {}, {}}}, .bands = {}});
  plot.panels.push_back({.y_label = "Gaps", .series = {{"nan", {0.0, 1.0}, {nan, nan}}}, .bands = {}});
  plot.panels.push_back({.y_label = "Point", .series = {{"one", {0.5}, {2.0}}}, .bands = {}});
  const Result<std::string> svg = draw_svg(plot);
  REQUIRE_MESSAGE(svg.ok(), (svg ? "" : svg.error().text()));
  CHECK(svg->find("Gaps") != std::string::npos);
}

/// Series with names of that length, over each other.
Plot make_many(std::size_t count, std::size_t name_length) {
  Plot plot;
  plot.x_label = "Time (s)";
  PlotPanel panel{.y_label = "Force (N)", .series = {}, .bands = {}, .from_zero = true};
  for (std::size_t n = 0; n < count; ++n) {
    std::string name = "run" + std::to_string(100 + n);
    name.resize(name_length, '_');
    panel.series.push_back({name, {0.0, 1.0}, {0.0, 1.0 + static_cast<double>(n)}});
  }
  panel.y_range = {0.0, 20.0};  // the same grid for any count
  plot.panels = {panel};
  return plot;
}

TEST_CASE("plot: no two of fifteen curves have the same colour and dash") {
  const std::string script = plot_script(make_many(15, 6));
  const std::regex line("\\$p0_[0-9]+ using 1:2 with lines linewidth [0-9.]+ (linecolor rgb \"#[0-9a-f]{6}\" dashtype [^ ]+) title");
  std::set<std::string> styles;
  int curves = 0;
  for (std::sregex_iterator at(script.begin(), script.end(), line); at != std::sregex_iterator(); ++at, ++curves) styles.insert((*at)[1]);
  CHECK(curves == 15);
  CHECK(styles.size() == 15);
}

TEST_CASE("plot: no two curves have the same colour and dash where some of them coincide, and none hides the one that it lies on") {
  // The sliding study: the first, sixth, seventh and eighth curve run along zero.
  for (const std::vector<std::size_t>& alike : {std::vector<std::size_t>{0, 5, 6, 7}, {1, 6, 11}, {0, 1, 2, 3, 4}, {0, 2, 5, 7, 10, 12}}) {
    Plot plot = make_many(15, 6);
    for (const std::size_t n : alike) plot.panels[0].series[n].y = plot.panels[0].series[alike[0]].y;
    const std::string script = plot_script(plot);
    const std::regex line("with lines linewidth [0-9.]+ (linecolor rgb \"#[0-9a-f]{6}\") dashtype ([^ ]+) title");
    std::set<std::string> styles;
    std::vector<std::string> dashes;
    for (std::sregex_iterator at(script.begin(), script.end(), line); at != std::sregex_iterator(); ++at) {
      styles.insert(std::string((*at)[1]) + std::string((*at)[2]));
      dashes.push_back((*at)[2]);
    }
    REQUIRE(dashes.size() == 15);
    CHECK(styles.size() == 15);
    if (alike.size() > 4) continue;  // with three dashes a choice may be impossible
    for (std::size_t n = 1; n < alike.size(); ++n) CHECK(dashes[alike[n]] != dashes[alike[n - 1]]);
  }
}

TEST_CASE("plot: the samples of the legend are longer where there are dashes") {
  CHECK(plot_script(make_many(15, 6)).find(" samplen 4\n") != std::string::npos);
  CHECK(plot_script(make_many(5, 6)).find(" samplen 2\n") != std::string::npos);
}

TEST_CASE("plot: a legend of many long names takes rows, and its panel grows by them") {
  const auto rows_of = [](const std::string& script) {
    std::smatch found;
    REQUIRE(std::regex_search(script, found, std::regex("maxrows ([0-9]+)")));
    return std::stoi(found[1]);
  };
  const auto height_of = [](const std::string& script) {
    std::smatch found;
    REQUIRE(std::regex_search(script, found, std::regex("set terminal svg size [0-9]+,([0-9]+)")));
    return std::stoi(found[1]);
  };
  const std::string usual = plot_script(make_many(5, 6)), many = plot_script(make_many(15, 60));
  CHECK(rows_of(usual) == 3);
  CHECK(rows_of(many) == 15);                                  // one column of 60 letters
  CHECK(height_of(many) - height_of(usual) == (15 - 3) * 19);  // [px] of a row
}

/// Numbers that follow a word in a script, in order.
std::vector<double> numbers_after(const std::string& script, const std::string& word) {
  const std::regex number(word + "(-?[0-9.]+)");
  std::vector<double> out;
  for (std::sregex_iterator at(script.begin(), script.end(), number); at != std::sregex_iterator(); ++at)
    out.push_back(std::stod((*at)[1]));
  return out;
}

TEST_CASE("plot: there is room at the right for the names of bands only where there are bands") {
  Plot bare = make_many(2, 6);
  CHECK(numbers_after(plot_script(bare), "set rmargin at screen ").front() * bare.width_px > bare.width_px - 40.0);
  CHECK(numbers_after(plot_script(make_plot()), "set rmargin at screen ").front() * bare.width_px < bare.width_px - 100.0);
}

TEST_CASE("plot: a curve that runs along zero lies above the frame, one that only begins there does not move it") {
  const auto lower_end = [](const std::vector<double>& y) {
    Plot plot;
    plot.panels.push_back({.y_label = "Force (N)", .series = {{"a", {0.0, 1.0, 2.0}, y}}, .bands = {}, .from_zero = true});
    return numbers_after(plot_script(plot), "set yrange \\[").front();
  };
  CHECK(lower_end({0.0, 1.0, 2.0}) == 0.0);
  CHECK(lower_end({2.0, 0.0, 0.0}) < -0.05);
  CHECK(lower_end({2.0, 0.004, 0.003}) < -0.05);  // within the width of the line
}

TEST_CASE("plot: of curves that coincide the upper ones are dashed and the lowest is wider, others are plain") {
  const auto styles = [](const std::vector<double>& second, const std::vector<double>& third) {
    Plot plot;
    plot.panels.push_back({.y_label = "Force (N)",
                           .series = {{"a", {0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0, 3.0}},
                                      {"b", {0.0, 1.0, 2.0, 3.0}, second},
                                      {"c", {0.0, 1.0, 2.0, 3.0}, third}},
                           .bands = {}});
    const std::string script = plot_script(plot);
    const std::regex style("with lines linewidth ([0-9.]+) linecolor rgb \"#[0-9a-f]{6}\" dashtype ([^ ]+) title");
    std::vector<std::string> out;
    for (std::sregex_iterator at(script.begin(), script.end(), style); at != std::sregex_iterator(); ++at)
      out.push_back(std::string((*at)[1]) + " " + std::string((*at)[2]));
    return out;
  };
  using Styles = std::vector<std::string>;
  CHECK(styles({3.0, 2.5, 2.5, 2.5}, {1.0, 0.5, 0.5, 0.5}) == Styles{"1.6 1", "1.6 1", "1.6 1"});
  CHECK(styles({0.0, 1.0, 2.0, 3.0}, {1.0, 0.5, 0.5, 0.5}) == Styles{"3.4 1", "1.6 (8,4)", "1.6 1"});
  CHECK(styles({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0, 3.0}) == Styles{"3.4 1", "1.6 (8,4)", "1.6 (2,3)"});
  CHECK(styles({0.0, 1.0, 9.0, 9.0}, {1.0, 0.5, 0.5, 0.5}) == Styles{"3.4 1", "1.6 (8,4)", "1.6 1"});  // on one segment of three
  CHECK(styles({0.0, 9.0, 9.0, 9.0}, {1.0, 0.5, 0.5, 0.5}) == Styles{"1.6 1", "1.6 1", "1.6 1"});      // a common start
}

TEST_CASE("plot: a legend over a grid has the rows that its names need, all inside the picture") {
  const auto legend = [](std::size_t count) {
    Plot plot = make_many(count, 22);
    plot.columns = 1;
    plot.legend = "above";
    const Result<std::string> svg = draw_svg(plot);
    REQUIRE_MESSAGE(svg.ok(), (svg ? "" : svg.error().text()));
    const std::regex name(
        R"re(<g transform="translate\(([-0-9.]+),([-0-9.]+)\)"[^>]*>\s*<text><!\[CDATA\[run1|<g transform="translate\(([-0-9.]+),([-0-9.]+)\)"[^>]*>\s*<text>run1)re");
    std::set<double> rows;
    int names = 0;
    for (std::sregex_iterator at(svg->begin(), svg->end(), name); at != std::sregex_iterator(); ++at, ++names) {
      const double x = std::stod((*at)[1].matched ? (*at)[1] : (*at)[3]), y = std::stod((*at)[2].matched ? (*at)[2] : (*at)[4]);
      rows.insert(y);
      CHECK(x >= 0.0);
      CHECK(x < plot.width_px);
      CHECK(y > 11.0);  // [px] the letters' height: the base line of the first row
    }
    CHECK(names == static_cast<int>(count));
    return rows.size();
  };
  CHECK(legend(3) == 1);
  CHECK(legend(8) >= 2);
}

TEST_CASE("plot: without gnuplot the error says what lacks") {
  const Result<std::string> svg = draw_svg(make_plot(), "no-such-gnuplot");
  REQUIRE_FALSE(svg);
  CHECK(svg.error().code == ErrorCode::unavailable);
  CHECK(svg.error().message.find("no-such-gnuplot cannot be run") != std::string::npos);
}

TEST_CASE("plot: a program that fails is an error with its words, or says that there were none") {
  const Result<std::string> svg = draw_svg(make_plot(), "false");
  REQUIRE_FALSE(svg);
  CHECK(svg.error().message.find("no reason given") != std::string::npos);
}

TEST_CASE("plot: a program that a signal ends is not at hand, which is no error of the plot") {
  const TemporaryFolder folder;
  const std::string killed = folder.file("killed");
  REQUIRE(write_file(killed, "#!/bin/sh\nkill -KILL $$\n"));
  std::filesystem::permissions(killed, std::filesystem::perms::owner_all);
  const Result<std::string> svg = draw_svg(make_plot(), killed);
  REQUIRE_FALSE(svg);
  CHECK(svg.error().code == ErrorCode::unavailable);
  CHECK(svg.error().message == killed + " was ended by signal 9: try again");
}

TEST_CASE("plot: an unwritable path is bad input with the path") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.file("plain"), ""));
  const Status status = write_svg(make_plot(), folder.file("plain/plot.svg"));
  REQUIRE_FALSE(status);
  CHECK(status.error().code == ErrorCode::bad_input);
}

TEST_CASE("plot: a logarithmic axis has three to twelve marks, whatever its range") {
  const auto marks = [](double lo, double hi) {
    Plot plot;
    plot.columns = 1;
    plot.log_x = true;
    PlotPanel panel;
    panel.y_label = "y";
    panel.series.push_back({"", {lo, hi}, {1.0, 2.0}});
    plot.panels.push_back(panel);
    const std::string script = plot_script(plot);
    const std::size_t from = script.find("set xtics ("), to = script.find(')', from);
    REQUIRE(from != std::string::npos);
    return std::count(script.begin() + static_cast<std::ptrdiff_t>(from), script.begin() + static_cast<std::ptrdiff_t>(to), ',') + 1;
  };
  CHECK(marks(1.0, 3.0) >= 3);
  CHECK(marks(1.0, 100.0) >= 5);
  for (const double hi : {1e3, 1e4, 1e5, 1e6, 1e8}) CHECK(marks(0.1, hi) <= 12);
}

}  // namespace
}  // namespace burrhole
