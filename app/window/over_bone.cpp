#include "app/window/over_bone.h"

#include <algorithm>
#include <cmath>

#include "app/window/panel_parts.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kHandleAbove = 0.004;            // [m] of the handle above the entry
constexpr float kHandle = 11.0f;                  // [pixels] its radius at scale 1
constexpr GuiColors kOnBone = GuiColors::dark();  // lines over the picture, in both themes

ImVec2 place_of(const glm::dvec2& p) { return {static_cast<float>(p.x), static_cast<float>(p.y)}; }

}  // namespace

void draw_cut_handle(const Gui& gui, WindowState& state, const WindowView& view, const WindowPlan& plan, int width, int height) {
  if (!view.cut.on || !plan.one_eye) return;
  constexpr double kStep = kMillimetre;
  const Vec3 at = view.cut.offset * view.cut.normal() + Vec3(0.0, 0.0, kHandleAbove);
  const auto seen = [&](const Vec3& p) { return project(view.camera, plan.world_from_approach * p, width, height); };
  const auto middle = seen(at), further = seen(at + kStep * view.cut.normal());
  if (!middle || !further) return;
  const glm::dvec2 a_step = *further - *middle;  // pixels of a millimetre along the normal
  const float radius = kHandle * gui.scale();
  const ImVec2 centre(std::clamp(static_cast<float>(middle->x), radius, static_cast<float>(width) - radius),
                      std::clamp(static_cast<float>(middle->y), radius, static_cast<float>(height) - radius));
  ImGui::SetNextWindowPos(ImVec2(centre.x - radius, centre.y - radius));
  ImGui::SetNextWindowSize(ImVec2(2.0f * radius, 2.0f * radius));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
  ImGui::Begin("cut", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoNav);
  ImGui::InvisibleButton("handle", ImVec2(2.0f * radius, 2.0f * radius));
  const bool held = ImGui::IsItemActive(), over = ImGui::IsItemHovered();
  if (held) {
    const ImVec2 moved = ImGui::GetIO().MouseDelta;
    const double along = glm::dot(glm::dvec2(moved.x, moved.y), a_step) / std::max(glm::dot(a_step, a_step), 1.0);
    if (along != 0.0) state.with_controls([&](Controls& controls) { controls.cut().move(along * kStep); });
  }
  if (over) ImGui::SetTooltip("drag to move the cut; K closes it");
  ImGui::End();
  ImGui::PopStyleVar();
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  const double longest = std::max(glm::length(a_step), 1e-6);
  const glm::dvec2 reach = a_step * (2.6 * radius / longest), back(centre.x, centre.y);
  list->AddLine(place_of(back - reach), place_of(back + reach), paint(kOnBone.yellow), 2.5f);
  list->AddCircleFilled(centre, 0.7f * radius, paint(held || over ? kOnBone.yellow : kOnBone.sky));
  list->AddCircle(centre, 0.7f * radius, paint(0x101418), 0, 2.0f);
}

void draw_eyepiece(int width, int height) {
  constexpr float kField = 0.98f, kSoft = 0.06f;  // of the picture's smaller half: the field, and the width of its edge
  constexpr int kRings = 12;
  const float w = static_cast<float>(width), h = static_cast<float>(height), half = 0.5f * std::min(w, h);
  const float far = std::hypot(w, h);  // covers the corners
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  list->PushClipRect(ImVec2(0.0f, 0.0f), ImVec2(w, h));
  const auto ring = [&](float from, float to, float alpha) {
    list->AddCircle(ImVec2(0.5f * w, 0.5f * h), 0.5f * (from + to), paint(0x000000, alpha), 160, to - from);
  };
  for (int n = 0; n < kRings; ++n) {
    const float a = static_cast<float>(n) / kRings, b = static_cast<float>(n + 1) / kRings;
    ring(half * (kField - kSoft * (1.0f - a)), half * (kField - kSoft * (1.0f - b)), 0.9f * b);
  }
  ring(half * kField, half * kField + far, 0.9f);
  list->PopClipRect();
}

void draw_cut_sliders(const Gui& gui, WindowState& state, const WindowView& view) {
  if (!view.cut.on) return;
  ImGui::PushFont(gui.small());
  auto offset = static_cast<float>(view.cut.offset / kMillimetre), azimuth = static_cast<float>(view.cut.azimuth / kDegree);
  constexpr auto kMost = static_cast<float>(ViewCut::kFurthest / kMillimetre);
  ImGui::PushItemWidth(0.6f * ImGui::GetContentRegionAvail().x);
  if (ImGui::SliderFloat("cut at [mm]", &offset, -kMost, kMost, "%.1f"))
    state.with_controls([&](Controls& c) { c.cut().move(static_cast<double>(offset) * kMillimetre - c.cut().offset); });
  if (ImGui::SliderFloat("towards", &azimuth, -180.0f, 180.0f, "%.0f deg"))
    state.with_controls([&](Controls& c) { c.cut().turn(static_cast<double>(azimuth) * kDegree - c.cut().azimuth); });
  ImGui::PopItemWidth();
  ImGui::PopFont();
}

void draw_note(const std::string& note, const Gui& gui, int width) {
  const ImVec2 size = ImGui::CalcTextSize(note.c_str());
  const ImVec2 at(0.5f * (static_cast<float>(width) - size.x), 6.0f * gui.scale());
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  list->AddText(ImVec2(at.x + 1.0f, at.y + 1.0f), IM_COL32(0, 0, 0, 200), note.c_str());
  list->AddText(at, IM_COL32(255, 255, 255, 235), note.c_str());
}

}  // namespace burrhole
