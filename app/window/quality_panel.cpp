#include "app/window/quality_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/window/panel_parts.h"
#include "app/window/quality_steps.h"

namespace burrhole {
namespace {

constexpr float kWide = 20.0f;  // [-] of the box, in heights of letters

/// Words of which one is chosen. @returns the one that was clicked.
template <std::size_t N>
std::optional<std::size_t> draw_row(const char* label, const std::array<const char*, N>& words, std::size_t chosen) {
  std::optional<std::size_t> out;
  ImGui::AlignTextToFramePadding();
  text(label);
  for (std::size_t n = 0; n < N; ++n) {
    ImGui::SameLine();
    ImGui::PushID(static_cast<int>(n));
    ImGui::PushID(label);
    if (ImGui::RadioButton(words[n], n == chosen)) out = n;
    ImGui::PopID();
    ImGui::PopID();
  }
  return out;
}

/// The knobs. @returns what the person wants now.
std::optional<DrawingQuality> draw_knobs(const DisplayFigures& figures) {
  const DrawingQuality& now = figures.at_rest;
  std::optional<DrawingQuality> wanted;
  const ImVec2 half(0.5f * (kWide * ImGui::GetFontSize() - ImGui::GetStyle().ItemSpacing.x), 0.0f);
  if (ImGui::Button("Coarser", half)) wanted = next_quality(figures.front, now, false);
  ImGui::SameLine();
  if (ImGui::Button("Finer", half)) wanted = next_quality(figures.front, now, true);
  if (const auto n = draw_row("rays", std::array{"1", "4", "9", "16"}, static_cast<std::size_t>(now.supersample - 1))) {
    wanted = now;
    wanted->supersample = static_cast<int>(*n) + 1;
  }
  constexpr std::array kShares{0.5, 0.75, 1.0};
  const auto share = static_cast<std::size_t>(std::ranges::find(kShares, now.resolution) - kShares.begin());
  if (const auto n = draw_row("size", std::array{"1/2", "3/4", "1"}, share)) {
    wanted = now;
    wanted->resolution = kShares[*n];
  }
  bool finish = now.finish;
  if (ImGui::Checkbox("smooth normals, occlusion", &finish)) {
    wanted = now;
    wanted->finish = finish;
  }
  return wanted;
}

/// The knobs of shadows and highlights. @returns what the person wants now.
std::optional<SurfaceLights> draw_light_knobs(const SurfaceLights& now) {
  SurfaceLights wanted = now;
  ImGui::Checkbox("shadows of bone and tool", &wanted.shadow);
  ImGui::Checkbox("highlights", &wanted.specular);
  return wanted == now ? std::nullopt : std::optional(wanted);
}

}  // namespace

void draw_quality(const Gui& gui, WindowState& state, const DisplayFigures& figures) {
  caption(gui, "PICTURE AT REST");
  const auto wanted = draw_knobs(figures);
  if (wanted) state.with_controls([&](Controls& controls) { controls.requests().quality = *wanted; });
  if (figures.lights)
    if (const auto lights = draw_light_knobs(*figures.lights))
      state.with_controls([&](Controls& controls) { controls.requests().lights = *lights; });
  ImGui::PushTextWrapPos(kWide * ImGui::GetFontSize());
  text(quality_text(figures.at_rest, false));
  text(figures.full_ms ? fmt::format("time: {:.0f} ms for all pixels, measured here", *figures.full_ms) : "time: not measured yet");
  const auto known = known_psnr(figures.front, figures.at_rest);
  const bool lit = figures.lights && (figures.lights->shadow || figures.lights->specular);
  text(known ? fmt::format("error: {:.1f} dB to the best, on a skull patch{} (docs/drawing.md)", *known,
                           lit ? " without shadows and highlights" : "")
             : "error: not in the table of docs/drawing.md");
  if (figures.lights) text(lights_text(figures.relit));
  if (figures.moving_psnr) text(fmt::format("while it moved: {:.1f} dB to this picture, measured here", *figures.moving_psnr));
  if (figures.refined_ms > 0.0) text(fmt::format("refined {:.0f} ms after the last change", figures.refined_ms));
  ImGui::PopTextWrapPos();
}

}  // namespace burrhole
