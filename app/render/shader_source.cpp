#include "app/render/shader_source.h"

#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <system_error>

namespace burrhole {
namespace {

constexpr int kMaxIncludeDepth = 8;
constexpr std::size_t kLinesPerFile = 10000;  // a line's number tells its file too: Mesa forgets the source number of an expression

/// Appends `file`, includes replaced; #line keeps the compiler's line numbers those of the file on disk, and tells files apart.
Status append_expanded(const ShaderFiles& files, std::string_view file, const std::string& asked_from, int depth, std::string& out) {
  const auto found = files.find(file);
  if (found == files.end()) return bad_input("no shader file \"" + std::string(file) + "\"", asked_from);
  if (depth > kMaxIncludeDepth) return bad_input("shader includes nest deeper than 8: does a file include itself?", asked_from);
  std::istringstream lines(found->second);
  constexpr std::string_view kInclude = "#include \"";
  const auto first = static_cast<std::size_t>(std::distance(files.begin(), found)) * kLinesPerFile;
  const auto add_line = [&](std::size_t number) { out += "#line " + std::to_string(first + number) + "\n"; };
  add_line(1);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.starts_with(kInclude)) {
      out += line + '\n';
      continue;
    }
    const std::size_t end = line.find('"', kInclude.size());
    const std::string name = line.substr(kInclude.size(), end - kInclude.size());
    const Status included = append_expanded(files, name, std::string(file) + ":" + std::to_string(number), depth + 1, out);
    if (!included) return included;
    add_line(static_cast<std::size_t>(number) + 1);
  }
  return {};
}

void add_define(ShaderVariant& variant, bool on, const char* define, const char* suffix) {
  if (!on) return;
  variant.defines.emplace_back(define);
  variant.name += suffix;
}

}  // namespace

ShaderVariant raycast_variant(const RaycastChoice& choice) {
  ShaderVariant variant{"raycast", "screen.vert", "raycast.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.soft, "SOFT", "_soft");
  add_define(variant, choice.skip, "SKIP", "_skip");
  add_define(variant, choice.finish, "FINISH", "_finish");
  add_define(variant, choice.probe, "PROBE", "_probe");
  return variant;
}

ShaderVariant slices_variant(const SlicesChoice& choice) {
  ShaderVariant variant{"slices", "slices.vert", "slices.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.soft, "SOFT", "_soft");
  add_define(variant, choice.correct, "CORRECT", "_correct");
  return variant;
}

ShaderVariant translucent_variant(const TranslucentChoice& choice) {
  ShaderVariant variant{"translucent", "screen.vert", "translucent.frag", {}};
  add_define(variant, choice.cut, "CUT", "_cut");
  add_define(variant, choice.soft, "SOFT", "_soft");
  add_define(variant, choice.skip, "SKIP", "_skip");
  add_define(variant, choice.probe, "PROBE", "_probe");
  return variant;
}

ShaderVariant tool_variant(bool probe) {
  if (probe) return {"tool_probe", "tool.vert", "tool.frag", {"PROBE"}};
  return {"tool", "tool.vert", "tool.frag", {}};
}

ShaderVariant background_variant() { return {"background", "screen.vert", "background.frag", {}}; }

std::vector<ShaderVariant> all_shader_variants() {
  std::vector<ShaderVariant> variants{background_variant(), tool_variant(false), tool_variant(true)};
  for (unsigned bits = 0; bits < 32; ++bits)
    variants.push_back(raycast_variant({.cut = (bits & 1u) != 0,
                                        .soft = (bits & 2u) != 0,
                                        .skip = (bits & 4u) != 0,
                                        .finish = (bits & 8u) != 0,
                                        .probe = (bits & 16u) != 0}));
  for (unsigned bits = 0; bits < 16; ++bits)
    variants.push_back(
        translucent_variant({.cut = (bits & 1u) != 0, .soft = (bits & 2u) != 0, .skip = (bits & 4u) != 0, .probe = (bits & 8u) != 0}));
  for (unsigned bits = 0; bits < 8; ++bits)
    variants.push_back(slices_variant({.cut = (bits & 1u) != 0, .soft = (bits & 2u) != 0, .correct = (bits & 4u) != 0}));
  return variants;
}

Result<std::string> expand_shader(const ShaderFiles& files, std::string_view file, const std::vector<std::string>& defines) {
  std::string out = "#version 450 core\n";
  for (const std::string& name : defines) out += "#define " + name + " 1\n";
  const Status done = append_expanded(files, file, "", 0, out);
  if (!done) return done.error();
  return out;
}

Error shader_fault(const ShaderFiles& files, std::string_view log) {
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
