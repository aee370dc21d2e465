#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/front.h"
#include "core/base/units.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "volumes/read/mesh_file.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;
constexpr double kListPitch = 0.25e-3;  // [m] erosion pitch the counts are given for

std::vector<std::string> shipped_tools() {
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(share_folder()) / "tools", ignored))
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string find_tool_file(const std::string& name) {
  if (fs::is_regular_file(name)) return name;
  const fs::path shipped = fs::path(share_folder()) / "tools" / (name + ".toml");
  return fs::is_regular_file(shipped) ? shipped.string() : std::string();
}

std::string region_text(const RegionSpec& region) {
  const ErosionRule& e = region.erosion;
  std::string text = fmt::format("  {:<14} ", region.name);
  text += e.base > 0.0 ? fmt::format("cuts, {:.3g} a revolution", e.base) : std::string("does not cut");
  if (e.base > 0.0 && (e.axis != 1.0 || e.rim != 1.0)) text += fmt::format(", x{:.2g} on the axis to x{:.2g} at the rim", e.axis, e.rim);
  if (e.base > 0.0 && e.needs_depth())
    text += fmt::format(", bottom x{:.2g}, side x{:.2g}, top x{:.2g}, interior x{:.2g}", e.bottom, e.side, e.top, e.interior);
  return text + "\n";
}

std::string mesh_text(const MeshToolSpec& spec) {
  std::string text = fmt::format("  {:<14} one unit is {:g} mm; ", spec.file, spec.unit / kMillimetre);
  if (spec.erosion_factor <= 0.0) return text + "does not cut\n";
  return text + fmt::format("cuts, {:.3g} a revolution, from {:g} to {:g} mm above the tip\n", spec.erosion_factor,
                            spec.cut_from / kMillimetre, spec.cut_to / kMillimetre);
}

/// One line a region, or one about the mesh; empty with faults in issues.
std::string parts_text(const TomlDocument& document, Issues& issues) {
  std::string text;
  if (has_tool_mesh(document)) {
    if (const auto spec = read_mesh_tool_spec(document, issues)) text = mesh_text(*spec);
  } else if (const auto spec = read_tool_spec(document, issues)) {
    for (const RegionSpec& region : spec->regions) text += region_text(region);
  }
  return text;
}

std::string details_text(const Tool& tool, const std::string& parts) {
  const Vec3 size = tool.bound_hi - tool.bound_lo;
  const auto cutting = std::count(tool.shell.cutting.begin(), tool.shell.cutting.end(), std::uint8_t{1});
  std::string text = fmt::format("{}: {}\n", tool.name, tool.title);
  text += fmt::format("  size           {:.1f} x {:.1f} x {:.1f} mm\n", size.x / kMillimetre, size.y / kMillimetre, size.z / kMillimetre);
  text += fmt::format("  haptic points  {} ({} on cutting faces)\n", tool.shell.size(), cutting);
  text += fmt::format("  erosion points {} at a pitch of {:.3g} mm, {:.1f} mm3\n", tool.erosion.size(), tool.erosion.pitch / kMillimetre,
                      static_cast<double>(tool.erosion.size()) * tool.erosion.pitch * tool.erosion.pitch * tool.erosion.pitch /
                          (kMillimetre * kMillimetre * kMillimetre));
  return text + parts;
}

int show_tool(const std::string& name) {
  const std::string file = find_tool_file(name);
  if (file.empty()) {
    std::vector<std::string> names;
    for (const std::string& shipped : shipped_tools()) names.push_back(fs::path(shipped).stem().string());
    const auto near = nearest_name(name, names);
    return report(bad_input("no tool \"" + name + "\"" + (near ? "; did you mean \"" + *near + "\"?" : "")));
  }
  Issues issues;
  const auto document = TomlDocument::load(file);
  if (!document) return report(document.error());
  const auto tool = make_tool(*document, {.erosion_pitch = kListPitch, .read_mesh = read_mesh}, issues);
  if (!tool) return report(issues);
  print(details_text(*tool, parts_text(*document, issues)));
  return kDone;
}

int list_tools(bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const std::string& file : shipped_tools()) {
    Issues issues;
    const auto tool = load_tool(file, {.erosion_pitch = kListPitch, .read_mesh = read_mesh}, issues);
    if (!tool) return report(issues);
    if (json)
      rows.push_back({{"name", tool->name},
                      {"title", tool->title},
                      {"haptic_points", tool->shell.size()},
                      {"erosion_points", tool->erosion.size()},
                      {"file", file}});
    else
      print(
          fmt::format("{:<24} {:>5} haptic {:>6} erosion points  {}\n", tool->name, tool->shell.size(), tool->erosion.size(), tool->title));
  }
  if (json) print(rows.dump(2) + "\n");
  return kDone;
}

}  // namespace

void add_tools(CLI::App& app, int& exit_code) {
  struct Options {
    std::string name;
    bool json = false;
  };
  CLI::App* command = add_command(
      app, "tools", kSceneGroup,
      {.summary = "The shipped bits, or what one of them is",
       .about =
           "Without a name, lists the shipped bits with the number of points that feel and that cut. With a name or a tool file, tells "
           "the bit's size, its points, and what each of its regions cuts.",
       .examples = {"burrhole tools", "burrhole tools perforator_14_11", "burrhole tools my_bit.toml"},
       .exits = {}});
  auto option = std::make_shared<Options>();
  command->add_option("name", option->name, "shipped tool, or a tool file")->type_name(kToolValue);
  command->add_flag("--json", option->json, "the list as JSON on stdout");
  command->callback([option, &exit_code] { exit_code = option->name.empty() ? list_tools(option->json) : show_tool(option->name); });
}

}  // namespace burrhole::cli
