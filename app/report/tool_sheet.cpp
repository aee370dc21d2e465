#include "app/report/tool_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/report/file.h"
#include "app/report/gnuplot.h"
#include "app/report/tool_raster.h"

namespace burrhole {
namespace {

// Sizes [px]: three panels of one size side by side.
constexpr int kPanelWidth = 380, kPanelHeight = 520, kPanelPitch = 472, kLeft = 88, kBottom = 132;
constexpr double kPanelAspect = static_cast<double>(kPanelWidth) / kPanelHeight;
constexpr double kMm = 1e3;       // of a metre
constexpr double kLongest = 2.5;  // length over width of a bit that is drawn completely
constexpr double kShown = 2.0;    // of a longer one

std::string colour_text(const Rgb& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

/// Height of the working end: the cutting part and a part of its support.
double working_height(const Tool& tool) {
  double top = 0.0, wide = 0.0;
  for (const Vec3& p : tool.erosion.positions) {
    top = std::max(top, p.z);
    wide = std::max({wide, std::abs(p.x), std::abs(p.y)});
  }
  if (tool.erosion.size() == 0) return tool.bound_hi.z;
  return std::min(tool.bound_hi.z, top + std::max(0.4 * top, 0.8 * wide));
}

/// A shaft much longer than wide would make the working end small: it is cut off.
double drawn_height(const Tool& tool) {
  double wide = 0.0;  // of the working end
  const double working = working_height(tool);
  for (const Vec3& p : tool.shell.positions)
    if (p.z <= working) wide = std::max({wide, 2.0 * std::abs(p.x), 2.0 * std::abs(p.y)});
  return tool.bound_hi.z <= kLongest * wide ? tool.bound_hi.z : std::max(working, kShown * wide);
}

bool cuts_all_over(const Tool& tool) {
  return std::ranges::all_of(tool.shell.cutting, [](std::uint8_t cuts) { return cuts != 0; });
}

SheetFrame frame_of(const Tool& tool, const SheetView& view, double height) {
  SheetFrame frame;
  for (const Vec3& p : tool.shell.positions) {
    if (p.z > height) continue;
    const Vec3 seen = view.project(p);
    frame.include(seen.x, seen.y);
  }
  return frame.fitted(0.05, kPanelAspect);
}

/// A picture as a block of "r g b" rows, and the plot element that draws it in its frame.
std::string picture_block(const std::string& name, const Raster& raster) {
  std::string out = "$" + name + " << EOD\n";
  for (const Rgb& p : raster.pixels) out += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
  return out + "EOD\n";
}

std::string picture_element(const std::string& name, const Raster& raster, const SheetFrame& f) {
  const double du = (f.u_hi - f.u_lo) / raster.size.width * kMm, dv = (f.v_hi - f.v_lo) / raster.size.height * kMm;
  return fmt::format("${} using ({:.9g} + {:.9g} * (int($0) % {})):({:.9g} + {:.9g} * (int($0) / {})):1:2:3 with rgbimage notitle", name,
                     f.u_lo * kMm + 0.5 * du, du, raster.size.width, f.v_lo * kMm + 0.5 * dv, dv, raster.size.width);
}

/// Margins, ranges, names of the axes and title of one panel.
std::string panel_commands(int index, const SheetFrame& f, const std::string& title, const std::string& x_label,
                           const std::string& y_label) {
  const double left = kLeft + index * kPanelPitch;
  std::string out = fmt::format(
      "unset key\nset lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
      left / kToolSheetWidth, (left + kPanelWidth) / kToolSheetWidth, static_cast<double>(kBottom) / kToolSheetHeight,
      static_cast<double>(kBottom + kPanelHeight) / kToolSheetHeight);
  out += fmt::format("set xrange [{:.9g}:{:.9g}]\nset yrange [{:.9g}:{:.9g}]\n", f.u_lo * kMm, f.u_hi * kMm, f.v_lo * kMm, f.v_hi * kMm);
  return out + fmt::format("set title {} font \",14\" offset 0,-0.3\nset xlabel {} offset 0,0.3\nset ylabel {} offset 1,0\n",
                           gnuplot_quoted(title), gnuplot_quoted(x_label), gnuplot_quoted(y_label));
}

/// A legend under the panel; a plot command appends its entries after the picture.
constexpr const char* kLegend = "set key at graph 0.5, -0.13 center top horizontal maxrows 1 Left reverse samplen 1 font \",12\"\n";

std::string square_entry(const Rgb& colour, const std::string& name) {
  return fmt::format("NaN with points pointtype 5 pointsize 2 linecolor rgb \"{}\" title {}", colour_text(colour), gnuplot_quoted(name));
}

/// Shell points that are visible, with their inward normals, as "u v du dv", cutting or passive.
std::string shell_block(const std::string& name, const Tool& tool, const SheetView& view, const SheetFrame& f, const Raster& raster,
                        bool cutting) {
  const double width = f.u_hi - f.u_lo, arrow = 0.03 * width;
  std::string out = "$" + name + " << EOD\n";
  for (std::size_t n = 0; n < tool.shell.size(); ++n) {
    if ((tool.shell.cutting[n] != 0) != cutting) continue;
    const Vec3 seen = view.project(tool.shell.positions[n]), way = view.project(arrow * tool.shell.inward_normals[n]);
    const int column = static_cast<int>(std::floor((seen.x - f.u_lo) / width * raster.size.width));
    const int row = static_cast<int>(std::floor((seen.y - f.v_lo) / (f.v_hi - f.v_lo) * raster.size.height));
    if (column < 0 || row < 0 || column >= raster.size.width || row >= raster.size.height) continue;
    // Behind the drawn surface by more than the slope of a pixel or two: on the far side, hidden.
    if (seen.z < static_cast<double>(raster.depth[raster.at(column, row)]) - 0.015 * width) continue;
    out += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", seen.x * kMm, seen.y * kMm, way.x * kMm, way.y * kMm);
  }
  return out + "1e300 1e300 0 0\nEOD\n";  // a block without rows is an error for gnuplot; this row is outside every range
}

std::string picture_panel(const Tool& tool, const SheetView& view) {
  const double height = drawn_height(tool);
  const SheetFrame frame = frame_of(tool, view, height);
  std::string title = "The bit";
  if (height < tool.bound_hi.z) title += fmt::format("; its shaft ends at z = {:.0f} mm", tool.bound_hi.z * kMm);
  if (cuts_all_over(tool)) title += ", which has no shaft";
  const Raster raster = shade_tool(tool, view, frame, {kPanelWidth, kPanelHeight}, Shading::fluted);
  return picture_block("picture", raster) + panel_commands(0, frame, title, "across the picture [mm]", "up the picture [mm]") + kLegend +
         "plot " + picture_element("picture", raster, frame) + ", " + square_entry(kCuts, "cuts") + ", " +
         square_entry(kSteel, "does not cut") + "\n";
}

std::string shell_panel(const Tool& tool, const SheetView& view) {
  const SheetFrame frame = frame_of(tool, view, working_height(tool));
  const Raster raster = shade_tool(tool, view, frame, {kPanelWidth, kPanelHeight}, Shading::pale);
  const auto points = [&](const char* block, const char* colour, const char* name) {
    return fmt::format(
        "${0} using 1:2:3:4 with vectors nohead linewidth 1 linecolor rgb \"{1}\" notitle, ${0} using 1:2 with points pointtype 7 "
        "pointsize 0.55 linecolor rgb \"{1}\" title \"{2}\"",
        block, colour, name);
  };
  return picture_block("pale", raster) + shell_block("cutting", tool, view, frame, raster, true) +
         shell_block("passive", tool, view, frame, raster, false) +
         panel_commands(1, frame, "Point shell; lines lead into the bit", "across the picture [mm]", "up the picture [mm]") + kLegend +
         "plot " + picture_element("pale", raster, frame) + ", " + points("passive", "#3b5b8c", "does not cut") + ", " +
         points("cutting", "#b3420a", "cuts") + "\n";
}

std::string erosion_panel(const Tool& tool) {
  const SheetView side;
  const SheetFrame frame = frame_of(tool, side, working_height(tool));
  const Raster raster = cut_tool(tool, frame, {kPanelWidth, kPanelHeight});
  const float most = tool.erosion.size() > 0 ? *std::max_element(tool.erosion.factors.begin(), tool.erosion.factors.end()) : 1.0f;
  std::string palette;
  for (int n = 0; n <= 8; ++n) palette += fmt::format("{}{} \"{}\"", n > 0 ? ", " : "", n / 8.0, colour_text(factor_colour(n / 8.0)));
  const double left = static_cast<double>(kLeft + 2 * kPanelPitch + kPanelWidth + 14) / kToolSheetWidth;
  return picture_block("cut", raster) + panel_commands(2, frame, "Erosion factors, cut along the axis", "x [mm]", "z, up the shaft [mm]") +
         kLegend +
         fmt::format(
             "set palette defined ({})\nset cbrange [0:{:.6g}]\nset colorbox user origin {:.5f},{:.5f} size {:.5f},{:.5f}\n"
             "set cblabel \"erosion factor e [1/rev]\" offset 1.2,0\n",
             palette, static_cast<double>(most), left, static_cast<double>(kBottom) / kToolSheetHeight, 16.0 / kToolSheetWidth,
             static_cast<double>(kPanelHeight) / kToolSheetHeight) +
         "plot " + picture_element("cut", raster, frame) + ", $none using 1:2:3 with points palette notitle, " +
         square_entry(kPassive, "does not cut") + "\n";
}

}  // namespace

std::string tool_sheet_script(const ToolSheet& sheet) {
  const Tool& tool = *sheet.tool;
  const SheetView view = oblique_view();
  std::string out =
      fmt::format("set encoding utf8\nset terminal pngcairo size {},{} noenhanced font \"Helvetica,12\" background \"white\"\n",
                  kToolSheetWidth, kToolSheetHeight);
  out += "$none << EOD\n1e300 1e300 0\nEOD\nset multiplot\nset border 15 linecolor rgb \"#666666\"\nset tics out nomirror scale 0.6\n";
  out += fmt::format("set label 1 {} at screen 0.5, screen {:.5f} center font \",18\"\n", gnuplot_quoted(sheet.headline),
                     1.0 - 26.0 / kToolSheetHeight);
  out += fmt::format("set label 2 {} at screen 0.5, screen {:.5f} center font \",12\" textcolor rgb \"#444444\"\n",
                     gnuplot_quoted(sheet.subtitle), 1.0 - 56.0 / kToolSheetHeight);
  out += picture_panel(tool, view) + "unset label\n" + shell_panel(tool, view) + erosion_panel(tool);
  return out + "unset multiplot\n";
}

Status write_tool_sheet(const ToolSheet& sheet, const std::string& path, const std::string& gnuplot) {
  constexpr std::string_view kLastOfPng = "IEND\xae\x42\x60\x82";
  const Result<std::string> png = run_gnuplot(tool_sheet_script(sheet), gnuplot, kLastOfPng);
  if (!png) return png.error();
  return write_file(path, *png);
}

}  // namespace burrhole
