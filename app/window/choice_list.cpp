#include "app/window/choice_list.h"

#include "app/window/panel_parts.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

void draw_words(const Gui& gui, const Choice& choice, const ImVec2& at) {
  const bool possible = choice.missing.empty();
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const float in = 8.0f * gui.scale();
  const ImU32 ink = possible ? ImGui::GetColorU32(ImGuiCol_Text) : paint(gui.colors().grey);
  list->AddText(ImVec2(at.x + in, at.y + 0.25f * ImGui::GetFontSize()), ink, printable_text(choice.title).c_str());
  ImGui::PushFont(gui.small());
  const std::string& below = possible ? choice.about : choice.missing;
  list->AddText(ImVec2(at.x + in, at.y + 1.35f * ImGui::GetFontSize() + 0.5f * in),
                paint(possible ? gui.colors().grey : gui.colors().orange), printable_text(below).c_str());
  ImGui::PopFont();
}

}  // namespace

std::optional<std::size_t> draw_choices(const Gui& gui, const char* name, std::span<const Choice> choices, Selection& selection, bool moved,
                                        float below) {
  std::optional<std::size_t> clicked;
  ImGui::BeginChild(name, ImVec2(0.0f, -below));
  // The pointer chooses a line where it moves; where it rests it marks none.
  for (const ImGuiCol which : {ImGuiCol_Header, ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive}) ImGui::PushStyleColor(which, 0);
  for (std::size_t n = 0; n < choices.size(); ++n) {
    const Choice& choice = choices[n];
    if (!choice.heading.empty()) {
      ImGui::Dummy(ImVec2(0.0f, 4.0f * gui.scale()));
      caption(gui, choice.heading.c_str());
      ImGui::Separator();
    }
    const bool possible = choice.missing.empty();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float tall = 2.9f * ImGui::GetFontSize();
    ImGui::PushID(static_cast<int>(n));
    const bool here = selection.at() == n;
    const ImVec2 far(at.x + ImGui::GetContentRegionAvail().x, at.y + tall);
    if (here && possible) ImGui::GetWindowDrawList()->AddRectFilled(at, far, paint(gui.colors().chosen), 4.0f);
    if (ImGui::Selectable("##line", false, possible ? 0 : ImGuiSelectableFlags_Disabled, ImVec2(0.0f, tall)) && selection.point_at(n))
      clicked = n;
    const ImVec2 pointer = ImGui::GetIO().MouseDelta;
    if (ImGui::IsItemHovered() && (pointer.x != 0.0f || pointer.y != 0.0f)) selection.point_at(n);
    if (here && moved) ImGui::SetScrollHereY();
    draw_words(gui, choice, at);
    ImGui::PopID();
  }
  ImGui::PopStyleColor(3);
  ImGui::EndChild();
  return clicked;
}

}  // namespace burrhole
