#include "app/window/panel_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "app/stage/zone_state.h"
#include "core/base/child_attributes.h"
#include "core/base/rotation.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kNearExit = 1.0e-3;  // [m] of bone
constexpr double kBesidePlan = 3e-3;  // [m] of the tip from the axis along which bone is measured
constexpr double kTouch = 0.5;        // [N]
constexpr double kMuchPush = 0.9;     // [-] of the arm's largest force
constexpr double kMuchLean = 15.0 * kDegree;

/// Of the bone along the planned axis.
void add_warnings_of_plan(const WindowPlan& plan, const LiveState& live, std::vector<std::string>& out) {
  if (const double away = beside_plan(plan, live); away > kBesidePlan && live.progress.depth > 0.0)
    out.push_back(fmt::format("{:.1f} mm beside the plan: bone left is unknown", away / kMillimetre));
  else if (const double beyond = beyond_bone(plan, live); beyond > kNearExit)
    out.push_back(fmt::format("{:.0f} mm beyond the bone, where dura and brain are: move back", beyond / kMillimetre));
  else if (live.progress.breakthrough_time && live.hand.spin > 0.0)
    out.emplace_back("Through the bone: stop the drill and move back");
  else if (is_near_exit(plan.approach, live.progress))
    out.push_back(fmt::format("{:.1f} mm of bone left: press less", bone_left(plan.approach, live.progress) / kMillimetre));
}

}  // namespace

double bone_left(const Approach& approach, const DrillProgress& progress) noexcept {
  return progress.breakthrough_time ? 0.0 : std::clamp(approach.thickness - progress.front, 0.0, approach.thickness);
}

bool is_near_exit(const Approach& approach, const DrillProgress& progress) noexcept {
  return !progress.breakthrough_time && progress.deepest > 0.0 && bone_left(approach, progress) < kNearExit;
}

double beyond_bone(const WindowPlan& plan, const LiveState& live) noexcept {
  return live.progress.breakthrough_time ? std::max(0.0, live.progress.depth - plan.approach.thickness) : 0.0;
}

std::string depth_text(const DrillProgress& progress) {
  const double mm = std::max(0.0, progress.depth) / kMillimetre;
  return mm < 10.0 ? fmt::format("{:.1f} mm", mm) : fmt::format("{:.0f} mm", mm);
}

double beside_plan(const WindowPlan& plan, const LiveState& live) {
  const Vec3 tip =
      (live.world_from_rest * plan.world_from_bone * plan.approach.bone_from_approach).inverse() * live.world_from_tool.translation;
  return std::hypot(tip.x, tip.y);
}

double angle_to_surface(const WindowPlan& plan, const LiveState& live) {
  const Vec3 shaft = live.world_from_tool.rotate(Vec3(0.0, 0.0, 1.0)),
             normal = (live.world_from_rest * plan.world_from_bone).rotate(plan.approach.normal);
  return std::acos(std::clamp(glm::dot(shaft, normal), -1.0, 1.0));
}

std::string drive_text(const WindowPlan& plan, const LiveState& live) {
  if (!(live.hand.spin > 0.0)) return "off";
  return live.driven.value_or(true) ? fmt::format("{:.0f} rpm", live.hand.spin * plan.spin_rpm) : "clutch open";
}

std::string bone_left_text(const WindowPlan& plan, const LiveState& live) {
  if (live.progress.breakthrough_time) return "through";
  return beside_plan(plan, live) > kBesidePlan ? "-" : fmt::format("{:.1f} mm", bone_left(plan.approach, live.progress) / kMillimetre);
}

std::string layer_under_tip(const WindowPlan& plan, const LiveState& live) {
  const Approach& approach = plan.approach;
  const DrillProgress& p = live.progress;
  if (const double away = beside_plan(plan, live); away > kBesidePlan) return fmt::format("{:.1f} mm beside the plan", away / kMillimetre);
  if (p.depth < 0.0 && glm::length(live.force) < kTouch) return fmt::format("air, {:.1f} mm above the bone", -p.depth / kMillimetre);
  if (p.breakthrough_time) return "through the bone";
  for (const Approach::Layer& layer : approach.layers)
    if (p.front >= layer.from && p.front < layer.to)
      if (std::string name = label_name(layer.label, plan.labels); !name.empty()) return name;
  return "bone";
}

std::string removed_text(const LiveState& live) {
  const double mm3 = live.removed / (kMillimetre * kMillimetre * kMillimetre);
  return mm3 < 10.0 ? fmt::format("{:.1f} mm3", mm3) : fmt::format("{:.0f} mm3", mm3);
}

std::string turned_text(const LiveState& live) {
  return fmt::format("{:.0f} deg", glm::length(rotation_vector(live.world_from_rest.rotation)) / kDegree);
}

std::string moved_text(const WindowPlan& plan, const LiveState& live) {
  const Vec3 entry = plan.world_from_approach.translation;
  return fmt::format("{:.1f} mm", glm::length(live.world_from_rest * entry - entry) / kMillimetre);
}

std::string zone_text(const ZoneReading& zone) {
  return fmt::format("{}{:.1f} mm", zone.distance < 0.0 ? "inside " : "", std::abs(zone.distance) / kMillimetre);
}

std::vector<std::string> warnings_of(const WindowPlan& plan, const WindowView& view) {
  std::vector<std::string> out;
  const LiveState& live = view.live;
  if (!plan.bone_moves) add_warnings_of_plan(plan, live, out);
  if (live.zone && live.zone->level >= kZoneInside)
    out.push_back(fmt::format("{:.1f} mm inside a zone: move back", -live.zone->distance / kMillimetre));
  else if (live.zone && live.zone->level >= kZoneNear)
    out.push_back(fmt::format("{:.1f} mm from a zone", live.zone->distance / kMillimetre));
  if (plan.largest_push > 0.0 && live.hand.thrust > kMuchPush * plan.largest_push) out.emplace_back("The arm is at its largest force");
  // A bit that leans skates before it cuts, and its hole is oval.
  if (const double angle = angle_to_surface(plan, live); angle > kMuchLean && !view.transport && !plan.bone_moves)
    out.push_back(fmt::format("The drill stands {:.0f} degrees off the bone's normal", angle / kDegree));
  for (const ServoFault fault :
       {kServoForceNotFinite, kServoHandNotFinite, kServoHandLost, kServoContactStale, kServoEnergy, kServoSwinging})
    if ((live.faults & fault) != 0) out.push_back(fmt::format("Force: {}", name_of(fault)));
  return out;
}

std::vector<std::pair<const char*, const char*>> key_table(const WindowPlan& plan) {
  std::vector<std::pair<const char*, const char*>> out{
      {"Space (hold), X", "drill on; X keeps it on"},
      {"W; S", "advance and press, and rest lightly when released; move back"},
      {"wheel; G", "advance and press, and hold that; relax"},
      {"arrows, left drag", "move across the bone"},
      {"A, D, Q, E", "lean left, right, towards you, away"},
      {"R, Home", "straighten; back to the entry"},
      {"Shift", "fine control, a fifth of the speed"},
      {"right drag, Ctrl+arrows", "turn the view"},
      {"middle drag", "move the view"},
      {"Ctrl+wheel, + and -", "zoom"},
      {"F", "show the hole as at the start"},
      {"V", "view: orbit, surgeon, microscope"},
      {"K, L", "cut the bone open; slices through the tip"},
      {"1 to 9, 0", "change the tool"},
      {"Z, Ctrl+R", "undo; bone as at the start"},
      {"P", "pause"},
      {"T", "take a demonstration over"},
      {"F2", "panel for trainees or for the lab"},
      {"F9, F11, F12", "bone as a file (STL); full screen; screenshot"},
      {"Ctrl and +, -, 0", "letters larger, smaller, as at the start"},
      {"H, F1", "hints; these keys"},
      {"Esc", "end the run"},
      {"pad: triggers", "left advances, right drills; right bumper moves back"},
      {"pad: sticks", "left moves, right leans; B undo, X straight, Y view, Start pause"},
  };
  if (plan.instruments != 0) out.emplace_back("U, I, M", "suction; irrigation; wax on the pores");
  if (plan.bone_moves) {
    out.emplace_back("Alt + D, A, W, S, E, Q", "move the bone along its axes x, y, z");
    out.emplace_back("Alt + arrows, page keys", "turn the bone");
  }
  return out;
}

std::vector<std::pair<const char*, const char*>> watching_keys() {
  return {
      {"Space, P", "run; pause"},
      {"left, right", "a second back, ahead"},
      {"Shift+left, right", "pause, and 10 ms back, ahead"},
      {"up, down", "twice, half the speed"},
      {"Home", "to the start"},
      {"drag, Ctrl+arrows", "turn the view"},
      {"middle drag", "move the view"},
      {"wheel, + and -", "zoom"},
      {"F, V", "show the hole as at the start; orbit, surgeon, microscope"},
      {"K, L", "cut the bone open; slices through the tip"},
      {"F2, F11, F12", "all figures; full screen; screenshot"},
      {"F9", "bone at this moment as a file (STL)"},
      {"Ctrl and +, -, 0", "letters larger, smaller, as at the start"},
      {"F1, Esc", "these keys; close"},
  };
}

std::string tool_title(const std::string& name) {
  std::string out;
  for (std::size_t n = 0; n < name.size(); ++n) {
    const char c = name[n] == '_' ? ' ' : name[n];
    // "4mm" is "4 mm", "2_5mm" is "2.5 mm".
    const bool after_digit = !out.empty() && std::isdigit(static_cast<unsigned char>(out.back())) != 0;
    if (name[n] == '_' && after_digit && n + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[n + 1])) != 0)
      out += name.find("mm", n) != std::string::npos ? '.' : '/';
    else if (c == 'm' && after_digit)
      out += " m";
    else
      out += c;
  }
  return out;
}

std::vector<std::pair<std::string, std::string>> end_figures(const RunSummary& s) {
  const auto mm = [](const std::optional<double>& value) { return value ? fmt::format("{:.2f} mm", *value) : std::string("-"); };
  const RunOutcome outcome = outcome_of(s);
  const std::vector<std::string> flags = flag_names(outcome.flags);
  return {{"result", fmt::format("{}{}{}", name_of(outcome.result), flags.empty() ? "" : ", ", fmt::join(flags, ", "))},
          {"bone on the plan", fmt::format("{:.2f} mm", s.thickness_mm)},
          {"deepest", fmt::format("{:.2f} mm", s.reached_mm)},
          {"plunge, without support", mm(s.plunge_mm)},
          {"hole outside, inside", mm(s.hole_diameter_mm) + ", " + mm(s.inner_diameter_mm)},
          {"largest force", fmt::format("{:.1f} N", s.peak_force_N)},
          {"bone removed", fmt::format("{:.1f} mm3", s.removed_mm3)},
          {"time", fmt::format("{:.1f} s", s.duration_s)}};
}

std::string broken_lines(const std::string& line, float width, const std::function<float(const std::string&)>& width_of) {
  std::string out, row;
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::string word = line.substr(at, end - at);
    const std::string longer = row.empty() ? word : row + " " + word;
    if (!row.empty() && width_of(longer) > width) {
      out += row + "\n";
      row = word;
    } else {
      row = longer;
    }
    at = end + 1;
  }
  return out + row;
}

bool open_file(const std::string& path) {
  std::string program = "xdg-open", file = std::filesystem::absolute(path).string();
  char* const arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  return posix_spawnp(&child, program.c_str(), nullptr, ChildAttributes().get(), arguments, environ) == 0;
}

}  // namespace burrhole
