#include "app/window/chooser.h"

#include <chrono>
#include <vector>

#include "app/render/picture_texture.h"
#include "app/window/glfw_window.h"
#include "app/window/panel_parts.h"

namespace burrhole {
namespace {

constexpr double kWait = 0.05;  // [s] for events, at most
const Vec3 kGround(0.06, 0.065, 0.075);

/// Draws the list. @returns the line that was clicked.
std::optional<std::size_t> draw_list(const Gui& gui, std::span<const Choice> choices, Selection& selection, bool moved) {
  std::optional<std::size_t> clicked;
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
    if (ImGui::Selectable("##line", here, possible ? 0 : ImGuiSelectableFlags_Disabled, ImVec2(0.0f, tall)) && selection.point_at(n))
      clicked = n;
    const ImVec2 pointer = ImGui::GetIO().MouseDelta;
    if (ImGui::IsItemHovered() && (pointer.x != 0.0f || pointer.y != 0.0f)) selection.point_at(n);
    if (here && moved) ImGui::SetScrollHereY();
    ImDrawList* const list = ImGui::GetWindowDrawList();
    const float in = 8.0f * gui.scale();
    const ImU32 ink = possible ? ImGui::GetColorU32(ImGuiCol_Text) : paint(GuiColors::kGrey);
    list->AddText(ImVec2(at.x + in, at.y + 0.25f * ImGui::GetFontSize()), ink, choice.title.c_str());
    ImGui::PushFont(gui.small());
    const std::string& below = possible ? choice.about : choice.missing;
    list->AddText(ImVec2(at.x + in, at.y + 1.35f * ImGui::GetFontSize() + 0.5f * in),
                  paint(possible ? GuiColors::kGrey : GuiColors::kOrange), below.c_str());
    ImGui::PopFont();
    ImGui::PopID();
  }
  return clicked;
}

}  // namespace

Selection::Selection(std::span<const Choice> choices) noexcept : choices_(choices) {
  if (!is_possible()) move(1);
}

void Selection::move(int by) noexcept {
  for (std::size_t n = at_ + static_cast<std::size_t>(by); n < choices_.size(); n += static_cast<std::size_t>(by))
    if (choices_[n].missing.empty()) {
      at_ = n;
      return;
    }
}

bool Selection::point_at(std::size_t line) noexcept {
  if (line >= choices_.size() || !choices_[line].missing.empty()) return false;
  at_ = line;
  return true;
}

Selection::Answer Selection::press(Key key) noexcept {
  if (key == Key::escape) return Answer::closed;
  if (key == Key::enter && is_possible()) return Answer::chosen;
  if (key == Key::up) move(-1);
  if (key == Key::down) move(1);
  if (key == Key::home) {
    at_ = 0;
    if (!is_possible()) move(1);
  }
  return Answer::none;
}

Result<std::optional<std::size_t>> choose_in_window(const std::string& title, std::span<const Choice> choices, const ChooserConfig& config,
                                                    const std::atomic<bool>* stop) {
  auto window = GlfwWindow::create(title, config.width, config.height);
  if (!window) return window.error();
  std::vector<WindowEvent> events;
  window->set_handler([&](const WindowEvent& event) { events.push_back(event); });
  auto context = window->context();
  if (!context) return context.error();
  window->set_interval(0);
  std::optional<std::size_t> chosen;
  {
    auto gui = Gui::create(static_cast<float>(config.text_scale) * window->scale(), config.light);
    if (!gui) return gui.error();
    const PictureTexture ground(*context);
    Selection selection(choices);
    auto before = std::chrono::steady_clock::now();
    for (bool done = false; !done;) {
      window->wait(kWait);
      if (window->is_lost()) return Error{ErrorCode::unavailable, "the display was lost", {}};
      if (stop != nullptr && stop->load(std::memory_order_relaxed)) break;
      bool moved = false;
      for (const WindowEvent& event : events) {
        if (event.kind == WindowEvent::Kind::close) done = true;
        if (event.kind != WindowEvent::Kind::key || !event.down) continue;
        const Selection::Answer answer = selection.press(static_cast<Key>(event.code));
        moved = true;
        done = done || answer != Selection::Answer::none;
        if (answer == Selection::Answer::chosen) chosen = selection.at();
      }
      (*gui)->feed(events);
      events.clear();
      const int width = window->width(), height = window->height();
      if (width < 1 || height < 1) continue;  // minimised
      const auto now = std::chrono::steady_clock::now();
      ground.clear_window(width, height, kGround);
      (*gui)->begin(width, height, std::chrono::duration<double>(now - before).count());
      before = now;
      ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
      ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), static_cast<float>(height)));
      ImGui::Begin("chooser", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
      ImGui::PushFont((*gui)->big());
      text("burrhole");
      ImGui::PopFont();
      const float below = 2.2f * ImGui::GetFontSize();
      ImGui::BeginChild("list", ImVec2(0.0f, -below));
      if (const auto clicked = draw_list(**gui, choices, selection, moved)) {
        chosen = clicked;
        done = true;
      }
      ImGui::EndChild();
      caption(**gui, "Click, or up, down and Enter; Esc closes. burrhole --help lists the commands.");
      ImGui::End();
      (*gui)->end();
      window->swap();
    }
  }
  return chosen;
}

}  // namespace burrhole
