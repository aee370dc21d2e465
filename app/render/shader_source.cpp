#include "app/render/shader_source.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <system_error>

namespace burrhole {
namespace {

constexpr int kMaxIncludeDepth = 8;
constexpr std::uintmax_t kMostBytes = 4u << 20;  // of a shader
constexpr std::size_t kLinesPerFile = 10000;     // the line number also encodes the file: Mesa loses the source number of an expression

/// Replaces includes and evaluates branches; #line keeps the compiler's line numbers equal to those of the file on disk and encodes the
/// file.
class Expander {
 public:
  Expander(const ShaderFiles& files, const std::vector<std::string>& defines) : files_(&files), defines_(&defines) {}

  Status append(std::string_view file, const std::string& asked_from, int depth) {
    const auto found = files_->find(file);
    if (found == files_->end()) return bad_input("no shader file \"" + std::string(file) + "\"", asked_from);
    if (depth > kMaxIncludeDepth) return bad_input("shader includes nest deeper than 8: does a file include itself?", asked_from);
    const std::size_t open = branches_.size();
    const auto first = static_cast<std::size_t>(std::distance(files_->begin(), found)) * kLinesPerFile;
    const auto add_line = [&](std::size_t number) { out_ += "#line " + std::to_string(first + number) + "\n"; };
    add_line(1);
    std::istringstream lines(found->second);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      const std::string place = std::string(file) + ":" + std::to_string(number);
      if (line.starts_with("#ifdef ") || line.starts_with("#ifndef ") || line.starts_with("#else") || line.starts_with("#endif")) {
        if (!line.starts_with("#if") && branches_.size() == open) return bad_input(line + " without a branch", place);
        branch(line);
        out_ += '\n';
      } else if (!taken()) {
        out_ += '\n';
      } else if (line.starts_with(kInclude)) {
        const std::string name = line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size());
        if (Status included = append(name, place, depth + 1); !included) return included;
        add_line(static_cast<std::size_t>(number) + 1);
      } else {
        out_ += line + '\n';
      }
    }
    if (branches_.size() != open) return bad_input("a branch is not closed", std::string(file));
    return {};
  }
  [[nodiscard]] std::string& text() noexcept { return out_; }

 private:
  static constexpr std::string_view kInclude = "#include \"";

  void branch(const std::string& line) {
    if (line.starts_with("#endif")) return branches_.pop_back();
    if (line.starts_with("#else")) {
      branches_.back() = !branches_.back();
      return;
    }
    const std::string word = line.substr(line.find(' ') + 1);
    const std::string name = word.substr(0, word.find_first_of(" \t\r/"));
    const bool defined = std::find(defines_->begin(), defines_->end(), name) != defines_->end();
    branches_.push_back(defined == line.starts_with("#ifdef"));
  }
  [[nodiscard]] bool taken() const { return std::find(branches_.begin(), branches_.end(), false) == branches_.end(); }

  const ShaderFiles* files_;
  const std::vector<std::string>* defines_;
  std::vector<bool> branches_;
  std::string out_;
};

void add_define(ShaderVariant& variant, bool on, const char* define, const char* suffix) {
  if (!on) return;
  variant.defines.emplace_back(define);
  variant.name += suffix;
}

void add_level(ShaderVariant& variant, VolumeLevel level) {
  add_define(variant, level == VolumeLevel::whole, "HOLE", "_whole");
  add_define(variant, level == VolumeLevel::detail, "DETAIL", "_detail");
}

}  // namespace

ShaderVariant raycast_variant(const RaycastChoice& choice) {
  ShaderVariant variant{"raycast", "screen.vert", "raycast.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.skip, "SKIP", "_skip");
  add_define(variant, choice.probe, "PROBE", "_probe");
  add_define(variant, choice.table, "TABLE", "_table");
  add_define(variant, choice.fog, "FOG", "_fog");
  add_level(variant, choice.level);
  return variant;
}

ShaderVariant surface_variant(const SurfaceChoice& choice) {
  ShaderVariant variant{"surface", "screen.vert", "surface.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.soft, "SOFT", "_soft");
  add_define(variant, choice.finish, "FINISH", "_finish");
  add_level(variant, choice.level);
  const Appearance& appearance = choice.appearance;
  add_define(variant, appearance.tissue, "TISSUE", "_tissue");
  add_define(variant, appearance.occlusion, "OCCLUSION", "_occlusion");
  add_define(variant, appearance.shadow, "SHADOW", "_shadow");
  add_define(variant, appearance.specular, "SPECULAR", "_specular");
  add_define(variant, appearance.labels, "LABELS", "_labels");
  add_define(variant, appearance.normals == NormalSource::recomputed, "RECOMPUTED", "_recomputed");
  add_define(variant, appearance.drape, "DRAPE", "_drape");
  add_define(variant, choice.fog, "FOG", "_fog");
  add_define(variant, choice.tool_shadow, "TOOL_SHADOW", "_tool_shadow");
  return variant;
}

ShaderVariant stale_occlusion_variant(const SurfaceChoice& choice) {
  ShaderVariant variant{"stale_occlusion", "screen.vert", "stale_occlusion.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  const bool recomputed = choice.appearance.normals == NormalSource::recomputed;
  add_define(variant, choice.finish && !recomputed, "FINISH", "_finish");
  add_level(variant, choice.level);
  add_define(variant, recomputed, "RECOMPUTED", "_recomputed");
  return variant;
}

ShaderVariant slices_variant(const SlicesChoice& choice) {
  ShaderVariant variant{"slices", "slices.vert", "slices.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.correct, "CORRECT", "_correct");
  add_define(variant, choice.labels, "LABELS", "_labels");
  add_define(variant, choice.normals == NormalSource::recomputed, "RECOMPUTED", "_recomputed");
  add_define(variant, choice.fog, "FOG", "_fog");
  return variant;
}

ShaderVariant translucent_variant(const TranslucentChoice& choice) {
  ShaderVariant variant{"translucent", "screen.vert", "translucent.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.soft, "SOFT", "_soft");
  add_define(variant, choice.skip, "SKIP", "_skip");
  add_define(variant, choice.probe, "PROBE", "_probe");
  add_define(variant, choice.labels, "LABELS", "_labels");
  add_define(variant, choice.tint, "TINT", "_tint");
  add_define(variant, choice.fog, "FOG", "_fog");
  return variant;
}

ShaderVariant tool_variant(ToolPass pass, bool fog) {
  ShaderVariant variant{"tool", "tool.vert", "tool.frag", {}};
  add_define(variant, pass == ToolPass::probe, "PROBE", "_probe");
  add_define(variant, pass == ToolPass::layer, "LAYER", "_layer");
  add_define(variant, fog, "FOG", "_fog");
  return variant;
}

ShaderVariant added_variant(const AddedChoice& choice) {
  ShaderVariant variant{"added", "added.vert", "added.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.pass == ToolPass::probe, "PROBE", "_probe");
  add_define(variant, choice.pass == ToolPass::layer, "LAYER", "_layer");
  add_define(variant, choice.fog, "FOG", "_fog");
  add_define(variant, choice.wet, "WET", "_wet");
  return variant;
}

ShaderVariant tool_depth_variant() { return {"tool_depth", "tool_depth.vert", "tool_depth.frag", {}}; }

ShaderVariant tool_shadow_variant() { return {"tool_shadow", "screen.vert", "tool_shadow.frag", {}}; }

ShaderVariant background_variant(bool table, bool fog) {
  ShaderVariant variant{"background", "screen.vert", "background.frag", {}};
  add_define(variant, table, "TABLE", "_table");
  add_define(variant, fog, "FOG", "_fog");
  return variant;
}

ShaderVariant skin_variant(const SkinChoice& choice) {
  ShaderVariant variant{"skin", "skin.vert", "skin.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.rim, "RIM", "_rim");
  add_define(variant, choice.fog, "FOG", "_fog");
  return variant;
}

ShaderVariant mesh_variant(const MeshChoice& choice) {
  ShaderVariant variant{"mesh", "mesh.vert", "mesh.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.probe, "PROBE", "_probe");
  add_define(variant, choice.finish, "FINISH", "_finish");
  add_define(variant, choice.specular, "SPECULAR", "_specular");
  add_define(variant, choice.fog, "FOG", "_fog");
  if (choice.exterior || choice.interior) variant.defines.emplace_back("TEXTURED");
  add_define(variant, choice.exterior, "EXTERIOR", "_exterior");
  add_define(variant, choice.interior, "INTERIOR", "_interior");
  return variant;
}

namespace {

/// A surface; if it has shadows, also that in the shadow of the tool.
void add_surface(SurfaceChoice choice, std::vector<ShaderVariant>& variants) {
  variants.push_back(surface_variant(choice));
  if (!choice.appearance.shadow) return;
  choice.tool_shadow = true;
  variants.push_back(surface_variant(choice));
}

/// Fog with each drawing method, with the options of a default scene and with all of them.
void add_fog_variants(const Appearance& usual, const Appearance& all, std::vector<ShaderVariant>& variants) {
  variants.push_back(background_variant(false, true));
  for (const ToolPass pass : {ToolPass::picture, ToolPass::probe, ToolPass::layer}) variants.push_back(tool_variant(pass, true));
  for (const VolumeLevel level : {VolumeLevel::only, VolumeLevel::whole, VolumeLevel::detail})
    for (const bool cut : {false, true}) {
      variants.push_back(raycast_variant({.cut = cut, .skip = true, .fog = true, .level = level}));
      add_surface({.cut = cut, .soft = true, .finish = true, .fog = true, .appearance = usual, .level = level}, variants);
    }
  variants.push_back(raycast_variant({.cut = true, .skip = true, .probe = true, .fog = true}));
  add_surface({.cut = true, .soft = true, .finish = true, .fog = true, .appearance = all}, variants);
  for (const bool on : {false, true}) {
    variants.push_back(translucent_variant({.cut = on, .soft = on, .skip = true, .probe = on, .labels = true, .tint = on, .fog = true}));
    variants.push_back(slices_variant({.cut = on, .correct = true, .labels = true, .fog = true}));
  }
}

}  // namespace

std::vector<ShaderVariant> all_shader_variants() {
  std::vector<ShaderVariant> variants{background_variant(),          background_variant(true),      tool_variant(ToolPass::picture),
                                      tool_variant(ToolPass::probe), tool_variant(ToolPass::layer), tool_depth_variant(),
                                      tool_shadow_variant()};
  const auto bit = [](unsigned bits, unsigned n) { return (bits >> n & 1u) != 0; };
  const auto options = [bit](unsigned bits) {
    return Appearance{.tissue = bit(bits, 0),
                      .occlusion = bit(bits, 1),
                      .shadow = bit(bits, 2),
                      .specular = bit(bits, 3),
                      .drape = bit(bits, 6),
                      .labels = bit(bits, 4),
                      .normals = bit(bits, 5) ? NormalSource::recomputed : NormalSource::texture};
  };
  for (const VolumeLevel level : {VolumeLevel::only, VolumeLevel::whole, VolumeLevel::detail})
    for (unsigned bits = 0; bits < 16; ++bits)
      variants.push_back(
          raycast_variant({.cut = bit(bits, 0), .skip = bit(bits, 1), .probe = bit(bits, 2), .table = bit(bits, 3), .level = level}));
  for (const VolumeLevel level : {VolumeLevel::only, VolumeLevel::whole, VolumeLevel::detail})
    for (unsigned bits = 0; bits < 6; ++bits) {  // stored normals, smoothed or not, and recomputed ones
      SurfaceChoice choice{.cut = bit(bits, 0), .finish = bits / 2 == 1, .level = level};
      if (bits / 2 == 2) choice.appearance.normals = NormalSource::recomputed;
      variants.push_back(stale_occlusion_variant(choice));
    }
  constexpr unsigned kDrawn = 8, kOptions = 7, kAllOptions = (1u << kOptions) - 1u;
  const auto add = [&](unsigned bits, unsigned chosen, VolumeLevel level) {
    add_surface({.cut = bit(bits, 0), .soft = bit(bits, 1), .finish = bit(bits, 2), .appearance = options(chosen), .level = level},
                variants);
  };
  constexpr unsigned kDefault = 0b010011u;  // tissue, occlusion, labels
  for (unsigned bits = 0; bits < kDrawn; ++bits)
    for (const unsigned chosen : {0u, kDefault, kAllOptions})
      for (const VolumeLevel level : {VolumeLevel::only, VolumeLevel::whole, VolumeLevel::detail}) add(bits, chosen, level);
  for (const unsigned bits : {0u, kDrawn - 1u})
    for (unsigned n = 0; n < kOptions; ++n)
      for (const unsigned chosen : {1u << n, kAllOptions ^ 1u << n}) add(bits, chosen, VolumeLevel::only);
  for (unsigned bits = 0; bits < 64; ++bits)
    variants.push_back(translucent_variant({.cut = bit(bits, 0),
                                            .soft = bit(bits, 1),
                                            .skip = bit(bits, 2),
                                            .probe = bit(bits, 3),
                                            .labels = bit(bits, 4),
                                            .tint = bit(bits, 5)}));
  for (unsigned bits = 0; bits < 16; ++bits)
    variants.push_back(slices_variant({.cut = bit(bits, 0),
                                       .correct = bit(bits, 1),
                                       .labels = bit(bits, 2),
                                       .normals = bit(bits, 3) ? NormalSource::recomputed : NormalSource::texture}));
  for (unsigned bits = 0; bits < 8; ++bits)
    variants.push_back(skin_variant({.cut = bit(bits, 0), .fog = bit(bits, 1), .rim = bit(bits, 2)}));
  for (unsigned bits = 0; bits < 128; ++bits)
    variants.push_back(mesh_variant({.cut = bit(bits, 0),
                                     .probe = bit(bits, 1),
                                     .finish = bit(bits, 2),
                                     .specular = bit(bits, 3),
                                     .fog = bit(bits, 4),
                                     .exterior = bit(bits, 5),
                                     .interior = bit(bits, 6)}));
  for (const ToolPass pass : {ToolPass::picture, ToolPass::probe, ToolPass::layer})
    for (unsigned bits = 0; bits < 8; ++bits)
      variants.push_back(added_variant({.pass = pass, .cut = bit(bits, 0), .fog = bit(bits, 1), .wet = bit(bits, 2)}));
  add_fog_variants(options(kDefault), options(kAllOptions), variants);
  return variants;
}

Result<std::string> expand_shader(const ShaderFiles& files, std::string_view file, const std::vector<std::string>& defines) {
  Expander expander(files, defines);
  expander.text() = "#version 450 core\n";
  for (const std::string& name : defines) expander.text() += "#define " + name + " 1\n";
  const Status done = expander.append(file, "", 0);
  if (!done) return done.error();
  return std::move(expander.text());
}

Error shader_error(const ShaderFiles& files, std::string_view log) {
  std::istringstream lines{std::string(log)};
  std::string line, first;
  while (std::getline(lines, line)) {
    if (first.empty()) first = line;
    std::smatch found;
    // "FILE:LINE(COLUMN): error: what" as Mesa writes it, "FILE(LINE) : error CODE: what" as NVIDIA does.
    if (!std::regex_match(line, found, std::regex(R"(\d+(?::(\d+)\((\d+)\)| ?\((\d+)\)) ?: *(error.*))"))) continue;
    const std::size_t number = std::stoul(found[1].matched ? found[1] : found[3]);
    if (number / kLinesPerFile >= files.size()) continue;
    std::string place = std::next(files.begin(), static_cast<std::ptrdiff_t>(number / kLinesPerFile))->first;
    place += ":" + std::to_string(number % kLinesPerFile);
    if (found[2].matched) place += ":" + found[2].str();
    return bad_input(found[4].str(), place);
  }
  return bad_input(first.empty() ? "the driver gives no reason" : first);
}

Result<ShaderFiles> read_shader_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::directory_iterator entries(folder, failed);
  if (failed) return bad_input("cannot read the shader folder: " + failed.message(), folder.string());
  ShaderFiles files;
  for (const auto& entry : entries) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".glsl" && extension != ".vert" && extension != ".frag") continue;
    // Without core's reader of files: the program that embeds the shaders at build time is made of this file alone.
    if (!entry.is_regular_file(failed) || failed) return bad_input("is not a regular file", entry.path().string());
    if (entry.file_size(failed) > kMostBytes || failed)
      return bad_input("is larger than " + std::to_string(kMostBytes) + " bytes, the most that a shader may have", entry.path().string());
    std::ifstream in(entry.path(), std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) return bad_input("cannot read the shader", entry.path().string());
    files.emplace(entry.path().filename().string(), std::move(text).str());
  }
  if (files.empty()) return bad_input("holds no shader (*.glsl, *.vert, *.frag)", folder.string());
  return files;
}

}  // namespace burrhole
