#include "app/run/inputs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "haptics/hand/hand_switches.h"

namespace burrhole {
namespace {

constexpr std::array<std::pair<const char*, InputKind>, 10> kKinds{{{"spin", InputKind::spin},
                                                                    {"switches", InputKind::switches},
                                                                    {"tool", InputKind::tool},
                                                                    {"undo", InputKind::undo},
                                                                    {"reset", InputKind::reset},
                                                                    {"checkpoint", InputKind::checkpoint},
                                                                    {"restore", InputKind::restore},
                                                                    {"pause", InputKind::pause},
                                                                    {"mark", InputKind::mark},
                                                                    {"export", InputKind::export_bone}}};

bool has_name(InputKind kind) noexcept {
  return kind == InputKind::tool || kind == InputKind::checkpoint || kind == InputKind::restore || kind == InputKind::mark;
}

}  // namespace

const char* name_of(InputKind kind) noexcept {
  for (const auto& [name, value] : kKinds)
    if (value == kind) return name;
  return "";
}

bool parks(InputKind kind) noexcept {
  return kind == InputKind::tool || kind == InputKind::undo || kind == InputKind::reset || kind == InputKind::checkpoint ||
         kind == InputKind::restore || kind == InputKind::pause || kind == InputKind::export_bone;
}

Result<Input> input_from(const SessionInput& recorded) {
  for (const auto& [name, kind] : kKinds) {
    if (recorded.kind != name) continue;
    const double most = kind == InputKind::spin ? 1.0 : static_cast<double>(kAllSwitches);
    if (!(recorded.value >= 0.0 && recorded.value <= most) || recorded.tick < 0)
      return bad_input("the session holds an input \"" + recorded.kind + "\" out of its range");
    return Input{static_cast<std::uint64_t>(recorded.tick), kind, recorded.value, recorded.text, recorded.data};
  }
  return bad_input("the session holds an unknown input \"" + recorded.kind + "\"");
}

SessionInput to_record(const Input& input) {
  return {static_cast<std::int64_t>(input.tick), name_of(input.kind), input.value, input.text, input.data, {}};
}

std::optional<std::vector<Input>> read_inputs(const TomlDocument& document, int servo_hz, Issues& issues) {
  const std::size_t before = issues.size();
  std::vector<Input> out;
  TableReader root = document.root(issues);
  std::vector<std::string> words;
  for (const auto& [name, kind] : kKinds) words.emplace_back(name);
  for (TableReader& table : root.tables("input", "inputs of a user during the run, in the order of time")) {
    Input input;
    const double time = table.number("time_s", {.min = 0.0, .max = 1e5}, "simulated time at which the input is applied");
    input.tick = static_cast<std::uint64_t>(std::llround(time * servo_hz));
    const std::string word = table.choice("kind", std::nullopt, words, "what changes");
    for (const auto& [name, kind] : kKinds)
      if (word == name) input.kind = kind;
    if (input.kind == InputKind::spin)
      input.value = table.number("value", {.min = 0.0, .max = 1.0}, "command of the drive: 0 off, 1 the scene's spin rate");
    if (input.kind == InputKind::switches)
      input.value = static_cast<double>(
          table.integer("value", std::nullopt, 0, static_cast<std::int64_t>(kAllSwitches), "bits of pedals, buttons and instruments"));
    if (has_name(input.kind)) input.text = table.text("name", std::nullopt, "name of the tool or checkpoint, or text of the remark");
    if (input.kind == InputKind::export_bone)
      input.text = table.choice("format", "stl", {"stl", "ply", "obj", "nrrd", "nii", "nii.gz", "vdb"}, "of the file, by its ending");
    table.finish();
    if (!out.empty() && input.tick < out.back().tick) table.fault("time_s", "is earlier than that of the previous input");
    out.push_back(std::move(input));
  }
  root.finish();
  if (issues.size() == before && out.empty()) issues.push_back(bad_input("holds no [[input]]", document.file_name()));
  if (issues.size() != before) return std::nullopt;
  return out;
}

}  // namespace burrhole
