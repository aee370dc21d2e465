#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/given_paths.h"
#include "app/report/tool_sheet.h"
#include "core/base/units.h"
#include "core/drill/removal_rate.h"
#include "core/tool/buried_cutters.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "volumes/read/mesh_file.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;
constexpr double kListPitch = 0.25e-3;   // [m] erosion pitch of the listed counts
constexpr double kFeedPitch = 0.125e-3;  // [m] erosion pitch of the predicted feed: half a voxel of 0.25 mm, as in a scene

std::vector<std::string> shipped_tools() {
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(share_folder()) / "tools", ignored))
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string find_tool_file(const std::string& name) {
  std::error_code ignored;  // a name that is too long: not there
  if (fs::exists(name, ignored) && !fs::is_directory(name, ignored)) return name;
  const fs::path shipped = fs::path(share_folder()) / "tools" / (name + ".toml");
  return fs::is_regular_file(shipped, ignored) ? shipped.string() : std::string();
}

double volume_mm3(const Tool& tool) {
  const double pitch_mm = tool.erosion.pitch / kMillimetre;
  return static_cast<double>(tool.erosion.size()) * pitch_mm * pitch_mm * pitch_mm;
}

std::size_t cutting_points(const Tool& tool) {
  return static_cast<std::size_t>(std::count(tool.shell.cutting.begin(), tool.shell.cutting.end(), std::uint8_t{1}));
}

/// @returns the factors of a region's faces that differ from that of the interior.
std::string face_text(const RegionSpec& region) {
  const ErosionRule& e = region.erosion;
  std::vector<std::pair<const char*, double>> faces{{"bottom", e.bottom}, {"top", e.top}};
  if (region.solid.kind == SolidKind::box)
    faces.insert(faces.end(), {{"-x", e.flanks[0]}, {"+x", e.flanks[1]}, {"-y", e.flanks[2]}, {"+y", e.flanks[3]}});
  else
    faces.emplace_back("side", e.side);
  if (region.solid.bored()) faces.emplace_back("bore", e.inner);
  std::string text;
  for (const auto& [name, factor] : faces)
    if (factor != e.interior) text += fmt::format(", {} x{:.2g}", name, factor);
  if (e.interior != 1.0) text += fmt::format(", interior x{:.2g}", e.interior);
  return text;
}

std::string region_text(const RegionSpec& region) {
  const ErosionRule& e = region.erosion;
  std::string text = fmt::format("  {:<14} ", region.name);
  text += e.base > 0.0 ? fmt::format("cuts, {:.3g} per revolution", e.base) : std::string("does not cut");
  if (e.base > 0.0 && (e.axis != 1.0 || e.rim != 1.0))
    text += fmt::format(", x{:.2g} within {:g} mm of the axis to x{:.2g} at the rim", e.axis, e.core / kMillimetre, e.rim);
  if (e.base > 0.0) text += face_text(region);
  return text + "\n";
}

std::string mesh_text(const MeshToolSpec& spec) {
  std::string text = fmt::format("  {:<14} one unit is {:g} mm; ", spec.file, spec.unit / kMillimetre);
  if (spec.erosion_factor <= 0.0) return text + "does not cut\n";
  return text + fmt::format("cuts, {:.3g} per revolution, from {:g} to {:g} mm above the tip\n", spec.erosion_factor,
                            spec.cut_from / kMillimetre, spec.cut_to / kMillimetre);
}

/// The parts of a bit: its regions, or its mesh.
struct ToolParts {
  std::string text;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::vector<BuriedCutter> buried;
};

/// @returns nothing when any issue was pushed.
std::optional<ToolParts> read_parts(const TomlDocument& document, Issues& issues) {
  ToolParts out;
  if (has_tool_mesh(document)) {
    const auto spec = read_mesh_tool_spec(document, issues);
    if (!spec) return std::nullopt;
    out.text = mesh_text(*spec);
    out.json.push_back({{"name", spec->file}, {"cuts", spec->erosion_factor > 0.0}, {"erosion_factor_per_rev", spec->erosion_factor}});
    return out;
  }
  const auto spec = read_tool_spec(document, issues);
  if (!spec) return std::nullopt;
  out.buried = find_buried_cutters(*spec);
  for (const RegionSpec& region : spec->regions) {
    out.text += region_text(region);
    const auto found = std::ranges::find(out.buried, region.name, &BuriedCutter::region);
    out.json.push_back(
        {{"name", region.name},
         {"cuts", region.erosion.base > 0.0},
         {"erosion_factor_per_rev", region.erosion.base},
         {"covered_share", found == out.buried.end() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(found->share)}});
  }
  return out;
}

/// A predicted feed with the names of its direction in text and JSON.
struct NamedFeed {
  const char *label, *key;
  FeedPrediction feed;
};

std::vector<NamedFeed> feeds_of(const Tool& tool) {
  return {{"plunging", "plunge", predict_feed(tool, FeedDirection::plunge, {})},
          {"sideways", "sideways", predict_feed(tool, FeedDirection::sideways, {})}};
}

std::string feed_text(const NamedFeed& named) {
  const FeedPrediction& feed = named.feed;
  const double mm3 = kMillimetre * kMillimetre * kMillimetre;
  std::string text = fmt::format("  {:<14} ", named.label);
  if (feed.speed <= 0.0) return text + "0 mm3/s: the leading face does not cut\n";
  const double mm2 = kMillimetre * kMillimetre;
  if (!feed.unknown.empty())
    return text + fmt::format("unknown, about {:.2g} mm/s over {:.3g} mm2: {}\n", feed.speed / kMillimetre, feed.area / mm2, feed.unknown);
  return text + fmt::format("{:.3g} mm3/s, {:.3g} mm/s over {:.3g} mm2\n", feed.rate / mm3, feed.speed / kMillimetre, feed.area / mm2);
}

std::string conditions_text() {
  const FeedConditions c;
  return fmt::format("{:.0f} N, {:.0f} rpm, hardness {:.3g}, cutting stiffness {:.0f} kN/m, voxels of {:.3g} mm", c.thrust,
                     c.spin / kRevPerMinute, c.hardness, 1e-3 * c.cutting_stiffness, c.voxel_edge / kMillimetre);
}

std::string size_text(const Tool& tool) {
  const Vec3 size = (tool.bound_hi - tool.bound_lo) / kMillimetre;
  return fmt::format("{:.1f} x {:.1f} x {:.1f} mm", size.x, size.y, size.z);
}

std::string details_text(const Tool& tool, const std::string& parts, const std::vector<NamedFeed>& feeds) {
  std::string text = fmt::format("{}: {}\n", tool.name, tool.title);
  text += fmt::format("  size           {}\n", size_text(tool));
  text += fmt::format("  shell points   {} ({} on cutting faces)\n", tool.shell.size(), cutting_points(tool));
  text += fmt::format("  erosion points {} at a pitch of {:.3g} mm, {:.1f} mm3\n", tool.erosion.size(), tool.erosion.pitch / kMillimetre,
                      volume_mm3(tool));
  text += parts;
  text += fmt::format("  predicted at   {}, fully engaged\n", conditions_text());
  for (const NamedFeed& feed : feeds) text += feed_text(feed);
  return text;
}

nlohmann::ordered_json tool_json(const Tool& tool, const std::string& file) {
  return {{"name", tool.name},
          {"title", tool.title},
          {"haptic_points", tool.shell.size()},
          {"erosion_points", tool.erosion.size()},
          {"file", file}};
}

nlohmann::ordered_json details_json(const Tool& tool, const ToolParts& parts, const std::vector<NamedFeed>& feeds,
                                    const std::string& file) {
  const double mm2 = kMillimetre * kMillimetre, mm3 = mm2 * kMillimetre;
  const FeedConditions c;
  nlohmann::ordered_json out = tool_json(tool, file);
  const Vec3 size = (tool.bound_hi - tool.bound_lo) / kMillimetre;
  out["size_mm"] = {size.x, size.y, size.z};
  out["cutting_haptic_points"] = cutting_points(tool);
  out["erosion_pitch_mm"] = tool.erosion.pitch / kMillimetre;
  out["erosion_volume_mm3"] = volume_mm3(tool);
  out["regions"] = parts.json;
  nlohmann::ordered_json& predicted = out["predicted"];
  predicted = {{"thrust_N", c.thrust},
               {"spin_rpm", c.spin / kRevPerMinute},
               {"hardness", c.hardness},
               {"cutting_stiffness_N_per_m", c.cutting_stiffness},
               {"voxel_mm", c.voxel_edge / kMillimetre}};
  for (const NamedFeed& named : feeds) {
    const FeedPrediction& feed = named.feed;
    nlohmann::ordered_json& row = predicted[named.key];
    const bool known = feed.unknown.empty();
    row["rate_mm3_per_s"] = known ? nlohmann::ordered_json(feed.rate / mm3) : nlohmann::ordered_json(nullptr);
    row["feed_mm_per_s"] = known ? nlohmann::ordered_json(feed.speed / kMillimetre) : nlohmann::ordered_json(nullptr);
    row["feed_range_mm_per_s"] = {feed.least / kMillimetre, feed.most / kMillimetre};
    row["area_mm2"] = feed.area / mm2;
    row["unknown"] = known ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(feed.unknown);
  }
  return out;
}

/// @returns an erosion pitch for the picture: a 250th of the cutting part's largest extent, or coarser, so that there are at most 2e6
/// points.
double picture_pitch(const Tool& tool) {
  if (tool.erosion.size() == 0) return kListPitch;
  Vec3 lo = tool.erosion.positions.front(), hi = lo;
  for (const Vec3& p : tool.erosion.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const Vec3 size = hi - lo + tool.erosion.pitch;
  const double volume = static_cast<double>(tool.erosion.size()) * tool.erosion.pitch * tool.erosion.pitch * tool.erosion.pitch;
  return std::max(std::max({size.x, size.y, size.z}) / 250.0, std::cbrt(volume / 2e6));
}

Status draw_sheet(const TomlDocument& document, const Tool& tool, const std::vector<NamedFeed>& feeds, const std::string& path) {
  Issues issues;
  const auto fine = make_tool(document, {.erosion_pitch = picture_pitch(tool), .read_mesh = read_mesh}, issues);
  if (!fine) return issues.front();
  const NamedFeed& shown = feeds[0].feed.speed > 0.0 ? feeds[0] : feeds[1];
  ToolSheet sheet{&*fine, tool.title, {}};
  sheet.subtitle =
      fmt::format("{}; {} shell points, {} of them on cutting faces; {} at {}: {}{:.3g} mm/s, {:.3g} mm3/s", size_text(tool),
                  tool.shell.size(), cutting_points(tool), shown.label, conditions_text(), shown.feed.unknown.empty() ? "" : "about ",
                  shown.feed.speed / kMillimetre, shown.feed.rate / (kMillimetre * kMillimetre * kMillimetre));
  return write_tool_sheet(sheet, path);
}

/// @returns the error of a name that is no tool file: a mesh, a folder, or not there.
Status is_a_tool(const std::string& name) {
  std::error_code ignored;
  if (const auto mesh = mesh_as_tool(name))
    return bad_input(*mesh + (fs::exists(name, ignored) ? "" : "; the mesh is not there either"), name);
  if (!find_tool_file(name).empty()) return {};
  if (const std::string here = tool_file_here(name); !here.empty())
    return bad_input(fmt::format("no shipped tool has that name; for the file in the current folder write {}", here), name);
  const auto near = nearest_name(fs::path(name).stem().string(), shipped_names("tools"));
  return bad_input(fmt::format("tool not found in the current folder, {}{}", (fs::path(share_folder()) / "tools").string(),
                               near ? "; did you mean \"" + *near + "\"?" : " (burrhole tools lists the shipped ones)"),
                   name);
}

/// @returns an error for the file of a scene in place of a tool.
Status is_no_scene(const TomlDocument& document) {
  Issues unread;
  const TableReader root = document.root(unread);
  const bool scene = root.has("volume") && root.has("tool") && !root.has("region") && !root.has("mesh");
  if (!scene) return {};
  return bad_input("is a scene, not a tool: its [tool] names the bit, and burrhole tools NAME shows that", document.file_name());
}

struct Options {
  std::string name, image;
  bool json = false;
};

int show_tool(const Options& options) {
  if (const Status valid = is_a_tool(options.name); !valid) return report(valid.error());
  const std::string file = find_tool_file(options.name);
  Issues issues;
  const auto document = TomlDocument::load(file);
  if (!document) return report(document.error());
  if (const Status valid = is_no_scene(*document); !valid) return report(valid.error());
  const auto tool = make_tool(*document, {.erosion_pitch = kListPitch, .read_mesh = read_mesh}, issues);
  if (!tool) return report(issues);
  const auto fine = make_tool(*document, {.erosion_pitch = kFeedPitch, .read_mesh = read_mesh}, issues);
  const auto parts = read_parts(*document, issues);
  if (!parts || !fine) return report(issues);
  if (const std::string repair = find_tool_repair(*document, {.read_mesh = read_mesh}); !repair.empty()) print_warning(file, repair);
  for (const BuriedCutter& cutter : parts->buried) print_warning(file, buried_text(cutter));
  const std::vector<NamedFeed> feeds = feeds_of(*fine);
  if (!options.image.empty())
    if (Status drawn = draw_sheet(*document, *tool, feeds, options.image); !drawn) return report(drawn.error());
  if (!options.image.empty()) print_line("picture: " + options.image);
  print(options.json ? details_json(*tool, *parts, feeds, file).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"
                     : details_text(*tool, parts->text, feeds));
  return kDone;
}

int list_tools(bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const std::string& file : shipped_tools()) {
    Issues issues;
    const auto tool = load_tool(file, {.erosion_pitch = kListPitch, .read_mesh = read_mesh}, issues);
    if (!tool) return report(issues);
    if (json)
      rows.push_back(tool_json(*tool, file));
    else
      print(
          fmt::format("{:<24} {:>5} shell {:>6} erosion points  {}\n", tool->name, tool->shell.size(), tool->erosion.size(), tool->title));
  }
  if (json) print(rows.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return kDone;
}

int run_tools(const Options& options) {
  if (!options.image.empty() && options.name.empty())
    return report(bad_input("--image draws one bit and needs its name: burrhole tools NAME --image FILE"));
  if (!options.image.empty() && fs::path(options.image).extension() != ".png")
    return report(bad_input("--image writes PNG: the file name must end in .png", options.image));
  return options.name.empty() ? list_tools(options.json) : show_tool(options);
}

}  // namespace

void add_tools(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "tools", kSceneGroup,
      {.summary = "Lists the shipped bits, or describes and draws one of them",
       .about =
           "Without a name, lists the shipped bits with their numbers of shell points and erosion points. With a name or a tool file, "
           "prints the bit's size, its points, the erosion factors of its regions, and the predicted feed in bone; --image draws the bit, "
           "its point shell and its erosion factors.",
       .examples = {"burrhole tools", "burrhole tools perforator_14_11 --image perforator.png", "burrhole tools my_bit.toml"},
       .exits = {}});
  auto option = std::make_shared<Options>();
  command->add_option("name", option->name, "name of a shipped tool, or a tool file")->type_name(kToolValue);
  command->add_option("--image", option->image, "draw the bit, its point shell and its erosion factors into this PNG")
      ->type_name(kFileValue);
  command->add_flag("--json", option->json, "print the list, or the bit, as JSON on stdout");
  command->callback([option, &exit_code] { exit_code = run_tools(*option); });
}

}  // namespace burrhole::cli
