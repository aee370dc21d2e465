#include "app/window/color_scale.h"

#include <algorithm>

#include "app/window/over_bone.h"
#include "app/window/panel_parts.h"
#include "app/window/transport_bar.h"
#include "core/base/color_ramp.h"

namespace burrhole {
namespace {

constexpr float kEdge = 12.0f, kWide = 18.0f, kTick = 5.0f;  // [pixels] at scale 1

}  // namespace

ScaleRoom scale_room(float height, float above, float below, float letter) noexcept {
  constexpr float kTop = 0.3f, kBottom = 0.7f;   // [-] of the height, as in still pictures
  constexpr float kFrame = 6.5f, kLeast = 3.0f;  // [letters] of title and spaces; of the colours
  const float bottom = std::min(kBottom * height + letter, height - below);
  const float tall = std::min((kBottom - kTop) * height, bottom - above - kFrame * letter);
  return {bottom, tall >= kLeast * letter ? tall : 0.0f};
}

void draw_scale(const ColorBar& bar, const ScaleRoom& room, float scale) {
  if (!(room.tall > 0.0f)) return;
  const float edge = kEdge * scale, wide = kWide * scale, tick = kTick * scale, letter = ImGui::GetFontSize();
  begin_over("scale", ImVec2(edge, room.bottom), ImVec2(0.0f, 1.0f));
  paragraph(bar.title, 6.5f * letter);
  float values = 0.0f;
  for (const auto& [share, text] : bar.marks) values = std::max(values, ImGui::CalcTextSize(text.c_str()).x);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy(ImVec2(wide + 2.0f * tick + values, room.tall + letter));
  const float top = corner.y + 0.5f * letter;
  const auto height = [&](double share) { return top + room.tall * static_cast<float>(1.0 - share); };
  const auto shade = [](const RampColor& c) { return IM_COL32(c.r, c.g, c.b, 255); };
  ImDrawList* const list = ImGui::GetWindowDrawList();
  for (std::size_t n = 1; n < kValueRamp.size(); ++n) {
    const ImU32 below = shade(kValueRamp[n - 1].color), above = shade(kValueRamp[n].color);
    list->AddRectFilledMultiColor(ImVec2(corner.x, height(kValueRamp[n].share)), ImVec2(corner.x + wide, height(kValueRamp[n - 1].share)),
                                  above, above, below, below);
  }
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  float last = height(0.0) + 2.0f * letter;  // the least height of a text that was drawn
  for (const auto& [share, text] : bar.marks) {
    const float at = height(share);
    list->AddLine(ImVec2(corner.x + wide, at), ImVec2(corner.x + wide + tick, at), ink, scale);
    if (at > last - letter) continue;
    list->AddText(ImVec2(corner.x + wide + 2.0f * tick, at - 0.5f * letter), ink, text.c_str());
    last = at;
  }
  ImGui::End();
}

void draw_scale(const ColorBar& bar, const Gui& gui, const WindowView& view, float hints, int height) {
  const float edge = kEdge * gui.scale();
  float below = edge;
  if (view.transport) below += transport_height(gui);
  if (view.requests.slices)
    below += static_cast<float>(kSliceSize) * gui.scale() + edge;
  else if (hints > 0.0f)
    below += hints + edge;
  ImGui::PushFont(gui.small());
  draw_scale(bar, scale_room(static_cast<float>(height), edge, below, ImGui::GetFontSize()), gui.scale());
  ImGui::PopFont();
}

}  // namespace burrhole
