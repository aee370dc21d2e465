// Any text as the argument of --set and --unset on a valid scene: errors are values of one line, and a scene that is accepted is one.
#include <cstdlib>
#include <string>
#include <string_view>

#include "app/scene/scene.h"

namespace {

using namespace burrhole;

constexpr std::string_view kScene =
    "[volume]\nsource = \"phantom:plate\"\n[tool]\nname = \"any\"\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n[hand]\n[contact]\n"
    "[erosion]\n[display]\nsize = [160, 120]\n";

void check_error(const Status& status) {
  if (status.ok()) return;
  const std::string text = status.error().text();
  if (text.empty() || text.find('\n') != std::string::npos) std::abort();
}

}  // namespace

/// Each line is one assignment; a line that begins with '-' is the argument of --unset.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto document = TomlDocument::parse(kScene, "scene.toml");
  if (!document) std::abort();
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  for (int lines = 0; !rest.empty() && lines < 8; ++lines) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    check_error(line.starts_with('-') ? document->unset(line.substr(1)) : document->set(line));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  Issues issues;
  const SceneContext context{.tool_folders = {}, .tool_given = true};
  const auto scene = read_scene(*document, context, issues);
  if (scene.has_value() != issues.empty()) std::abort();
  for (const Error& issue : issues)
    if (issue.text().find('\n') != std::string::npos) std::abort();
  return 0;
}
