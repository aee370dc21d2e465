#include "app/window/panel_parts.h"

#include "app/window/panel_text.h"
#include "core/config/toml_messages.h"

namespace burrhole {

ImVec4 color(unsigned rgb, float alpha) {
  const auto part = [&](int shift) { return static_cast<float>(rgb >> shift & 0xFFu) / 255.0f; };
  return {part(16), part(8), part(0), alpha};
}
ImU32 paint(unsigned rgb, float alpha) { return ImGui::ColorConvertFloat4ToU32(color(rgb, alpha)); }

void text(const std::string& line) { ImGui::TextUnformatted(printable_text(line).c_str()); }

void paragraph(const std::string& line, float width) {
  text(broken_lines(printable_text(line), width, [](const std::string& row) { return ImGui::CalcTextSize(row.c_str()).x; }));
}

void caption(const Gui& gui, const char* words) {
  ImGui::PushFont(gui.small());
  ImGui::PushStyleColor(ImGuiCol_Text, color(gui.colors().grey));
  ImGui::TextUnformatted(words);
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

void fit_over(int width, int height) {
  ImGui::SetNextWindowSizeConstraints(ImVec2(0.0f, 0.0f), ImVec2(static_cast<float>(width), static_cast<float>(height)));
}

bool begin_over(const char* name, const ImVec2& place, const ImVec2& pivot, bool takes_mouse) {
  ImGui::SetNextWindowPos(place, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowBgAlpha(kOverPicture);
  return ImGui::Begin(name, nullptr,
                      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                          (takes_mouse ? 0 : ImGuiWindowFlags_NoInputs) | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                          ImGuiWindowFlags_NoMove);
}

}  // namespace burrhole
