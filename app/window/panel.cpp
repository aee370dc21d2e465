#include "app/window/panel.h"

#include <fmt/format.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>

#include "app/stage/zone_state.h"
#include "app/window/color_scale.h"
#include "app/window/over_bone.h"
#include "app/window/panel_parts.h"
#include "app/window/panel_text.h"
#include "app/window/quality_panel.h"
#include "app/window/transport_bar.h"
#include "core/base/units.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

/// Ivory tables, reddish diploe, and labels of the user in their own colours.
ImU32 color_of_layer(VoxelLabel label, const LabelTable& labels) {
  for (const NamedLabel& one : labels)
    if (one.label == label) return IM_COL32(one.color[0], one.color[1], one.color[2], 255);
  return label == VoxelLabel::diploe ? IM_COL32(150, 95, 70, 255) : IM_COL32(225, 214, 190, 255);
}

constexpr float kPanelWidth = 300.0f;  // [pixels] at scale 1
constexpr double kHistory = 0.05;      // [s] between two points of a plot

}  // namespace

void PanelHistory::add(double time, double force, double depth, bool jumps) {
  constexpr double kFeedOver = 0.5, kGap = 1.0;  // [s]
  if (!time_.empty() && (time < time_.back() || (jumps && time - time_.back() > kGap))) {
    time_.clear();
    force_.clear();
    depth_.clear();
    feed_ = 0.0;
  }
  if (!time_.empty() && time - time_.back() < kHistory) return;
  if (time_.size() >= kMost) {
    time_.erase(time_.begin());
    force_.erase(force_.begin());
    depth_.erase(depth_.begin());
  }
  time_.push_back(time);
  force_.push_back(static_cast<float>(force));
  depth_.push_back(static_cast<float>(depth * 1e3));
  const auto from = std::ranges::lower_bound(time_, time - kFeedOver);
  const auto first = static_cast<std::size_t>(from - time_.begin());
  if (time > time_[first]) feed_ = static_cast<double>(depth_.back() - depth_[first]) / (time - time_[first]);
}

void LatestValues::add(float value) {
  if (values_.size() < kMost)
    values_.push_back(value);
  else
    values_[next_++ % kMost] = value;
}

float LatestValues::at(double share) const {
  if (values_.empty()) return 0.0f;
  std::vector<float> sorted = values_;
  const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, nth);
  return *nth;
}

int panel_width(int window_width, float scale) noexcept { return std::min(static_cast<int>(kPanelWidth * scale), window_width / 2); }

void Panel::draw(const WindowView& view, const DisplayFigures& figures, int width, int height) {
  if (view.stage == RunStage::drilling || plan_.title.empty()) plan_ = state_->plan();
  if (view.stage == RunStage::drilling) {
    history_.add(view.live.time, glm::length(view.live.force), view.live.progress.depth, view.transport.has_value());
    servo_us_.add(view.live.servo_us);
    contact_us_.add(view.live.contact_us);
    bone_us_.add(view.live.bone_us);
  }
  const int side_width = panel_width(width, gui_->scale());
  over_picture(view, figures, width - side_width, height);
  side(view, figures, side_width, height);
}

void Panel::side(const WindowView& view, const DisplayFigures& figures, int width, int height) {
  const auto x = ImGui::GetIO().DisplaySize.x - static_cast<float>(width);
  ImGui::SetNextWindowPos(ImVec2(x, 0.0f));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), static_cast<float>(height)));
  ImGui::Begin("side", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav);
  ImGui::PushTextWrapPos(0.0f);
  text(plan_.title.empty() ? "Loading the bone ..." : plan_.title);
  ImGui::PopTextWrapPos();
  ImGui::Separator();
  if (view.stage != RunStage::loading) {
    push_gauge(view);
    figures_of(view);
    if (view.live.zone) zone(*view.live.zone);
    layers(view);
    drive(view);
    instruments(view);
    if (view.requests.lab) lab(view, figures);
    buttons(view);
    tools(view);
  }
  ImGui::End();
}

void Panel::push_gauge(const WindowView& view) {
  const double most = plan_.largest_push > 0.0 ? plan_.largest_push : 80.0;
  const double push = std::max(0.0, view.live.hand.thrust);
  caption(*gui_, "PUSH");
  ImGui::PushFont(gui_->big());
  ImGui::TextColored(color(push > 0.9 * most ? gui_->colors().red : gui_->colors().sky), "%.0f N", push);
  ImGui::PopFont();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float wide = ImGui::GetContentRegionAvail().x, tall = 14.0f * gui_->scale();
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const auto place = [&](double newton) { return at.x + wide * static_cast<float>(std::min(1.0, newton / most)); };
  list->AddRectFilled(at, ImVec2(at.x + wide, at.y + tall), paint(gui_->colors().grey, 0.25f), 4.0f);
  list->AddRectFilled(at, ImVec2(place(push), at.y + tall), paint(push > 0.9 * most ? gui_->colors().red : gui_->colors().sky), 4.0f);
  if (plan_.reference_push > 0.0) {
    const float mark = place(plan_.reference_push);
    list->AddLine(ImVec2(mark, at.y - 3.0f), ImVec2(mark, at.y + tall + 3.0f), paint(gui_->colors().yellow), 2.0f);
  }
  if (view.held_push > 0.0) {
    const float held = place(view.held_push), foot = at.y + tall;
    list->AddTriangleFilled(ImVec2(held, foot - 5.0f), ImVec2(held - 6.0f, foot + 5.0f), ImVec2(held + 6.0f, foot + 5.0f),
                            paint(gui_->colors().text));
  }
  ImGui::Dummy(ImVec2(wide, tall + 4.0f));
  if (plan_.reference_push > 0.0) caption(*gui_, fmt::format("mark: {:.0f} N, the scene's own thrust", plan_.reference_push).c_str());
  if (view.held_push > 0.0) caption(*gui_, fmt::format("held: {:.0f} N; G relaxes", view.held_push).c_str());
}

void Panel::big(const char* label, const std::string& value, unsigned rgb) {
  ImGui::BeginGroup();
  caption(*gui_, label);
  ImGui::PushFont(gui_->big());
  ImGui::PushStyleColor(ImGuiCol_Text, color(rgb));
  text(value);
  ImGui::PopStyleColor();
  ImGui::PopFont();
  ImGui::EndGroup();
}

void Panel::figures_of(const WindowView& view) {
  const double half = ImGui::GetContentRegionAvail().x * 0.5f;
  if (plan_.bone_moves) {
    big("REMOVED", removed_text(view.live), gui_->colors().sky);
    ImGui::SameLine(static_cast<float>(half) + 2.0f * ImGui::GetStyle().WindowPadding.x);
    big("BONE TURNED", turned_text(view.live), gui_->colors().sky);
    return;
  }
  big("DEPTH", depth_text(view.live.progress), beyond_bone(plan_, view.live) > 0.0 ? gui_->colors().red : gui_->colors().sky);
  ImGui::SameLine(static_cast<float>(half) + 2.0f * ImGui::GetStyle().WindowPadding.x);
  big("BONE LEFT", bone_left_text(plan_, view.live),
      is_near_exit(plan_.approach, view.live.progress) ? gui_->colors().orange : gui_->colors().sky);
}

void Panel::zone(const ZoneReading& zone) {
  const GuiColors& colors = gui_->colors();
  big("TO THE NEAREST ZONE", zone_text(zone),
      zone.level >= kZoneInside ? colors.red
      : zone.level >= kZoneNear ? colors.orange
                                : colors.green);
}

void Panel::layers(const WindowView& view) {
  if (plan_.bone_moves) {
    caption(*gui_, "BONE MOVED");
    text(moved_text(plan_, view.live));
    return;
  }
  caption(*gui_, "UNDER THE TIP");
  ImGui::PushStyleColor(ImGuiCol_Text, color(gui_->colors().green));
  text(layer_under_tip(plan_, view.live));
  ImGui::PopStyleColor();
  // The bone from outside (left) to inside, with the part that is cut and the tip.
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float wide = ImGui::GetContentRegionAvail().x, tall = 12.0f * gui_->scale();
  const double thick = std::max(plan_.approach.thickness, 1e-4);
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const auto place = [&](double depth) { return at.x + wide * static_cast<float>(std::clamp(depth / thick, 0.0, 1.0)); };
  for (const Approach::Layer& layer : plan_.approach.layers)
    list->AddRectFilled(ImVec2(place(layer.from), at.y), ImVec2(place(layer.to), at.y + tall), color_of_layer(layer.label, plan_.labels));
  list->AddRectFilled(at, ImVec2(place(thick - bone_left(plan_.approach, view.live.progress)), at.y + tall), IM_COL32(20, 22, 26, 190));
  const float tip = place(view.live.progress.depth);
  list->AddTriangleFilled(ImVec2(tip, at.y + tall * 0.5f), ImVec2(tip - tall * 0.6f, at.y - 2.0f),
                          ImVec2(tip - tall * 0.6f, at.y + tall + 2.0f), paint(gui_->colors().sky));
  ImGui::Dummy(ImVec2(wide, tall + 4.0f));
}

void Panel::drive(const WindowView& view) {
  const bool turns = view.live.hand.spin > 0.0 && view.live.driven.value_or(true);
  big("DRILL", drive_text(plan_, view.live), turns ? gui_->colors().green : gui_->colors().grey);
  ImGui::PushFont(gui_->small());
  if (view.transport)
    text("as recorded");
  else if (plan_.demonstration && !view.goal.takes_over)
    text("The scene's own hand drills; T takes over");
  else
    text(view.locked_on ? "on until X is pressed again" : "hold Space to drill, X to keep it on");
  ImGui::PopFont();
  ImGui::Separator();
}

void Panel::instruments(const WindowView& view) {
  if (plan_.instruments == 0 || view.transport || view.stage != RunStage::drilling) return;
  caption(*gui_, "ASSISTANT");
  const float wide = ImGui::GetContentRegionAvail().x;
  for (const auto& [instrument, label] : {std::pair{kSuctionSwitch, "Suction (U)"}, std::pair{kIrrigationSwitch, "Irrigation (I)"},
                                          std::pair{kWaxSwitch, "Wax on the pores (M)"}}) {
    if ((plan_.instruments & instrument) == 0) continue;
    const bool on = (view.instruments_on & instrument) != 0;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, color(gui_->colors().green, 0.5f));
    if (ImGui::Button((std::string(label) + (on ? ": on" : "")).c_str(), ImVec2(wide, 0.0f)))
      state_->with_controls([&](Controls& p) { p.use_instrument(instrument); });
    if (on) ImGui::PopStyleColor();
  }
  ImGui::Separator();
}

void Panel::tools(const WindowView& view) {
  if ((plan_.demonstration && !view.goal.takes_over) || view.transport || !ImGui::CollapsingHeader("Tool", ImGuiTreeNodeFlags_DefaultOpen))
    return;
  std::optional<std::size_t> wanted;
  std::vector<std::string> names;
  state_->with_controls([&](Controls& controls) {
    for (const ToolText& tool : controls.tools()) names.push_back(tool.name);
  });
  ImGui::PushFont(gui_->small());
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (!view.requests.lab && n >= 5) break;
    const std::string key = n < 10 ? fmt::format("{}  ", (n + 1) % 10) : std::string("    ");
    if (ImGui::Selectable((key + tool_title(names[n])).c_str(), names[n] == view.tool)) wanted = n;
  }
  if (!view.requests.lab && names.size() > 5) ImGui::TextDisabled("F2 shows all %d", static_cast<int>(names.size()));
  ImGui::PopFont();
  if (wanted) state_->with_controls([&](Controls& controls) { controls.change_tool(*wanted); });
}

void Panel::buttons(const WindowView& view) {
  if (view.stage != RunStage::drilling) return;
  const float wide = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) * 0.5f;
  const ImVec2 size(wide, 0.0f);
  const auto button = [&](const char* label, const std::function<void(Controls&)>& f) {
    if (ImGui::Button(label, size)) state_->with_controls(f);
  };
  const bool drills = !view.transport;
  if (drills) {
    button("Undo (Z)", [](Controls& p) { p.undo(); });
    ImGui::SameLine();
    button(view.paused ? "Resume (P)" : "Pause (P)", [](Controls& p) { p.toggle_pause(); });
  }
  if (drills && view.requests.lab) {
    button("Reset bone", [](Controls& p) { p.reset(); });
    ImGui::SameLine();
    button("Checkpoint", [this](Controls& p) { checkpoints_ += p.checkpoint(fmt::format("checkpoint {}", checkpoints_ + 1)) ? 1 : 0; });
    if (checkpoints_ > 0)
      button(fmt::format("Restore {}", checkpoints_).c_str(),
             [this](Controls& p) { p.restore(fmt::format("checkpoint {}", checkpoints_)); });
  }
  if (view.requests.lab) {
    button("Screenshot (F12)", [](Controls& p) { p.requests().screenshot = true; });
    ImGui::SameLine();
    button("Export STL (F9)", [](Controls& p) { p.export_bone(); });
  }
  button("Keys (F1)", [](Controls& p) { p.requests().help = !p.requests().help; });
  ImGui::SameLine();
  if (drills)
    button("End (Esc)", [](Controls& p) { p.requests().asks_end = true; });
  else
    button("Close (Esc)", [](Controls& p) { p.end(); });
  button(view.cut.on ? "Close the cut (K)" : "Cut open (K)", [](Controls& p) { p.toggle_cut(); });
  ImGui::SameLine();
  button(view.requests.slices ? "No slices (L)" : "Slices (L)", [](Controls& p) { p.requests().slices = !p.requests().slices; });
  button(view.requests.lab ? "Trainee (F2)" : "Lab (F2)", [](Controls& p) { p.requests().lab = !p.requests().lab; });
  text_buttons(wide);
  draw_cut_sliders(*gui_, *state_, view);
}

void Panel::text_buttons(float wide) {
  // Beside the last button, in halves of its place.
  ImGui::SameLine();
  const ImVec2 half((wide - ImGui::GetStyle().ItemSpacing.x) * 0.5f, 0.0f);
  for (const bool larger : {false, true}) {
    if (larger) ImGui::SameLine();
    if (ImGui::Button(larger ? "A +" : "A -", half)) state_->with_controls([&](Controls& p) { p.change_text(larger); });
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("letters %s (Ctrl and %s)", larger ? "larger" : "smaller", larger ? "+" : "-");
  }
}

void Panel::lab(const WindowView& view, const DisplayFigures& figures) {
  ImGui::PushFont(gui_->small());
  const auto plot = [&](const char* name, const std::vector<float>& values, const char* unit) {
    if (values.empty()) return;
    const float most = std::max(1.0f, *std::ranges::max_element(values));
    const std::string over = fmt::format("{:.1f} {}", values.back(), unit);
    ImGui::PlotLines(name, values.data(), static_cast<int>(values.size()), 0, over.c_str(), 0.0f, most,
                     ImVec2(ImGui::GetContentRegionAvail().x * 0.75f, 46.0f * gui_->scale()));
  };
  plot("force", history_.force(), "N");
  if (!plan_.bone_moves) {
    plot("depth", history_.depth(), "mm");
    text(fmt::format("feed {:.2f} mm/s, {:.1f} deg off the bone's normal", history_.feed(), angle_to_surface(plan_, view.live) / kDegree));
    text(fmt::format("plan: {:.1f} mm of bone, {:.1f} deg off its normal", plan_.approach.thickness / kMillimetre,
                     plan_.approach.angle / kDegree));
  }
  if (!view.transport) {
    constexpr double kHigh = 0.99;
    text(fmt::format("servo {:.0f} us (p99 {:.0f}), contact {:.0f} us (p99 {:.0f}),", view.live.servo_us, servo_us_.at(kHigh),
                     view.live.contact_us, contact_us_.at(kHigh)));
    text(fmt::format("bone {:.1f} ms (p99 {:.1f})", view.live.bone_us * 1e-3f, bone_us_.at(kHigh) * 1e-3f));
    text(fmt::format("{} ticks missed", view.live.missed));
    if (view.live.prices)
      for (const StepPrice& price : *view.live.prices)
        text(fmt::format("[{}] {}: {:.0f} us, {:.1f} % of a core", price.effect, price.step, price.us, 100.0 * price.share));
  }
  text(fmt::format("{:.0f} pictures/s, {:.0f} ms each, {:.0f} ms late", figures.frames_per_s, figures.picture_ms, figures.latency_ms));
  ImGui::PopFont();
  ImGui::Separator();
}

void Panel::over_picture(const WindowView& view, const DisplayFigures& figures, int width, int height) {
  const float w = static_cast<float>(width), h = static_cast<float>(height), edge = 12.0f * gui_->scale();
  if (view.stage == RunStage::loading) {
    begin_over("loading", ImVec2(0.5f * w, 0.5f * h), ImVec2(0.5f, 0.5f));
    text("Loading the bone ...");
    ImGui::End();
    return;
  }
  draw_cut_handle(*gui_, *state_, view, plan_, width, height);
  warnings(view, width);
  if (!view.lines.empty()) {
    // Below the warnings, which stand in the middle of the upper edge.
    begin_over("lines", ImVec2(edge, edge + 3.2f * ImGui::GetFontSize()), ImVec2(0.0f, 0.0f));
    ImGui::PushTextWrapPos(w - 3.0f * edge);
    for (const MessageLine& line : view.lines)
      ImGui::TextColored(line.warning ? color(gui_->colors().orange) : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s",
                         printable_text(line.text).c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
  }
  const float hinted = has_hints(view) ? hints(view, width, height) : 0.0f;
  if (plan_.scale && view.stage == RunStage::drilling) draw_scale(*plan_.scale, *gui_, view, hinted, height);
  if (figures.coarse) {
    const float below = view.transport ? transport_height(*gui_) : 0.0f;
    begin_over("coarse", ImVec2(w - edge, h - edge - below), ImVec2(1.0f, 1.0f));
    ImGui::PushFont(gui_->small());
    text("coarser while moving");
    ImGui::PopFont();
    ImGui::End();
  }
  if (view.mode != CameraMode::orbit || view.fine) {
    begin_over("mode", ImVec2(w - edge, edge), ImVec2(1.0f, 0.0f));
    ImGui::PushFont(gui_->small());
    text(fmt::format("{}{}", view.mode != CameraMode::orbit ? fmt::format("view: {}", name_of(view.mode)) : std::string(),
                     view.fine ? "  fine control" : ""));
    ImGui::PopFont();
    ImGui::End();
  }
  if (view.paused) {
    begin_over("paused", ImVec2(0.5f * w, 0.35f * h), ImVec2(0.5f, 0.5f));
    ImGui::PushFont(gui_->big());
    text("Paused");
    ImGui::PopFont();
    text("P goes on");
    ImGui::End();
  }
  if (view.transport && view.stage == RunStage::drilling) draw_transport(*gui_, *state_, view, plan_, width, height);
  if (view.stage == RunStage::writing) {
    begin_over("writing", ImVec2(0.5f * w, 0.5f * h), ImVec2(0.5f, 0.5f));
    text("Writing the report ...");
    ImGui::End();
  }
  if (view.requests.lab && view.stage == RunStage::drilling) quality(view, figures, width, height);
  if (view.requests.help) help(view.transport.has_value(), width, height);
  if (view.stage == RunStage::drilling && view.requests.asks_end) end_question(width, height);
  if (view.stage == RunStage::ended) end_screen(width, height);
}

void Panel::quality(const WindowView& view, const DisplayFigures& figures, int width, int height) {
  const float edge = 12.0f * gui_->scale(), below = edge + 2.4f * ImGui::GetFontSize() + (view.transport ? transport_height(*gui_) : 0.0f);
  fit_over(width, height);
  begin_over("quality", ImVec2(static_cast<float>(width) - edge, static_cast<float>(height) - below), ImVec2(1.0f, 1.0f), true);
  ImGui::PushFont(gui_->small());
  draw_quality(*gui_, *state_, figures);
  ImGui::PopFont();
  ImGui::End();
}

bool Panel::has_hints(const WindowView& view) const noexcept {
  return view.stage == RunStage::drilling && view.requests.hints && !view.requests.slices && !view.requests.lab &&
         (!plan_.demonstration || view.goal.takes_over) && !view.transport;
}

void Panel::warnings(const WindowView& view, int width) {
  const std::vector<std::string> lines = warnings_of(plan_, view);
  if (lines.empty() || view.stage != RunStage::drilling) return;
  begin_over("warnings", ImVec2(0.5f * static_cast<float>(width), 10.0f * gui_->scale()), ImVec2(0.5f, 0.0f));
  for (const std::string& line : lines) ImGui::TextColored(color(gui_->colors().orange), "%s", printable_text(line).c_str());
  ImGui::End();
}

float Panel::hints(const WindowView& view, int width, int height) {
  const float edge = 12.0f * gui_->scale();
  begin_over("hints", ImVec2(edge, static_cast<float>(height) - edge), ImVec2(0.0f, 1.0f));
  ImGui::PushTextWrapPos(static_cast<float>(width) - 3.0f * edge);  // large letters stay on the picture
  const auto step = [&](bool done, const char* words) {
    ImGui::TextColored(done ? color(gui_->colors().green) : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s %s", done ? "+" : "-", words);
  };
  step(view.live.hand.spin > 0.0 || view.live.progress.deepest > 0.0, "Hold Space: the drill spins. X keeps it on.");
  step(glm::length(view.live.force) > 1.0 || view.live.progress.deepest > 0.0,
       "Hold W: the drill advances and presses; released, it rests lightly. The wheel presses and holds. S moves back.");
  step(false, "Arrows or left drag move it across the bone, right drag turns the view.");
  ImGui::PushFont(gui_->small());
  text("F1 shows all keys. H hides this.");
  ImGui::PopFont();
  ImGui::PopTextWrapPos();
  const float high = ImGui::GetWindowHeight();  // with the lines that the width of the picture broke
  ImGui::End();
  return high;
}

void Panel::help(bool watches, int width, int height) {
  fit_over(width, height);
  begin_over("help", ImVec2(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height)), ImVec2(0.5f, 0.5f), true);
  const bool is_low = static_cast<float>(height) < 30.0f * ImGui::GetFontSize();
  if (is_low) ImGui::PushFont(gui_->small());
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const auto& [key, meaning] : watches ? watching_keys() : key_table(plan_)) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextColored(color(gui_->colors().sky), "%s", key);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(meaning);
    }
    ImGui::EndTable();
  }
  if (is_low) ImGui::PopFont();
  ImGui::End();
}

void Panel::end_question(int width, int height) {
  fit_over(width, height);
  begin_over("end", ImVec2(0.5f * static_cast<float>(width), 0.45f * static_cast<float>(height)), ImVec2(0.5f, 0.5f), true);
  text("End the run and write the report?");
  if (ImGui::Button("End (Enter)")) state_->with_controls([](Controls& p) { p.end(); });
  ImGui::SameLine();
  if (ImGui::Button("Go on (Esc)")) state_->with_controls([](Controls& p) { p.requests().asks_end = false; });
  ImGui::End();
}

void Panel::end_screen(int width, int height) {
  fit_over(width, height);
  begin_over("ended", ImVec2(0.5f * static_cast<float>(width), 0.45f * static_cast<float>(height)), ImVec2(0.5f, 0.5f), true);
  const std::string failure = state_->failure();
  if (!failure.empty()) {
    ImGui::TextColored(color(gui_->colors().red), "The run failed");
    text(failure);
  }
  if (const auto summary = state_->summary()) {
    paragraph(outcome_text(*summary), ImGui::GetFontSize() * 26.0f);
    ImGui::Separator();
    if (ImGui::BeginTable("figures", 2, ImGuiTableFlags_SizingFixedFit)) {
      for (const auto& [name, value] : end_figures(*summary)) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        text(name);
        ImGui::TableNextColumn();
        ImGui::TextColored(color(gui_->colors().sky), "%s", printable_text(value).c_str());
      }
      ImGui::EndTable();
    }
    for (const std::string& line : summary->warnings) {
      ImGui::PushStyleColor(ImGuiCol_Text, color(gui_->colors().orange));
      paragraph(line, ImGui::GetFontSize() * 26.0f);
      ImGui::PopStyleColor();
    }
  }
  if (!report_.empty() && failure.empty()) {
    if (ImGui::Button("Open the report") && !open_file(report_)) state_->say("xdg-open is missing; the report is " + report_, true);
    ImGui::SameLine();
  }
  if (ImGui::Button("Close (Esc)")) state_->close();
  if (!report_.empty() && failure.empty()) caption(*gui_, report_.c_str());
  ImGui::End();
}

}  // namespace burrhole
