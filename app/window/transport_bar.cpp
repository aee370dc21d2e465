#include "app/window/transport_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/window/panel_parts.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

std::string speed_text(double speed) { return speed < 1.0 ? fmt::format("1/{:.0f}x", 1.0 / speed) : fmt::format("{:g}x", speed); }

void buttons(const Gui& gui, WindowState& state, const Transport& transport) {
  const auto change = [&](const std::function<void(Transport&)>& f) {
    state.with_controls([&](Controls& controls) { f(*controls.transport()); });
  };
  const auto button = [&](const char* label, const std::function<void(Transport&)>& f) {
    if (ImGui::Button(label)) change(f);
    ImGui::SameLine();
  };
  button("|<", [](Transport& t) { t.jump(0.0); });
  button("-1 s", [](Transport& t) { t.jump(t.head() - 1.0); });
  button("-10 ms", [](Transport& t) { t.step(-0.01); });
  button(transport.runs() ? "Pause" : "Resume", [](Transport& t) { t.run(!t.runs()); });
  button("+10 ms", [](Transport& t) { t.step(0.01); });
  button("+1 s", [](Transport& t) { t.jump(t.head() + 1.0); });
  button("slower", [](Transport& t) { t.set_speed(0.5 * t.speed()); });
  button("faster", [](Transport& t) { t.set_speed(2.0 * t.speed()); });
  text(speed_text(transport.speed()));
  ImGui::SameLine();
  text(fmt::format("  {:.2f} of {:.2f} s", transport.head(), transport.duration()));
  if (transport.seeks()) {
    ImGui::SameLine();
    ImGui::TextColored(color(gui.colors().orange), "  computing %.1f s", transport.arrived());
  }
}

/// The line with its marks; a click or a drag moves the head.
void line(const Gui& gui, WindowState& state, const Transport& transport, const WindowPlan& plan) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float wide = ImGui::GetContentRegionAvail().x, tall = 22.0f * gui.scale(), middle = at.y + 0.5f * tall;
  const double duration = std::max(transport.duration(), 1e-9);
  const auto place = [&](double time) { return at.x + wide * static_cast<float>(std::clamp(time / duration, 0.0, 1.0)); };
  ImGui::InvisibleButton("line", ImVec2(wide, tall));
  const double pointed = static_cast<double>((ImGui::GetIO().MousePos.x - at.x) / wide) * duration;
  // A button that is held still asks for nothing new.
  if (ImGui::IsItemActivated() || (ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0.0f))
    state.with_controls([&](Controls& controls) { controls.transport()->jump(pointed); });
  ImDrawList* const list = ImGui::GetWindowDrawList();
  list->AddRectFilled(ImVec2(at.x, middle - 3.0f), ImVec2(at.x + wide, middle + 3.0f), paint(gui.colors().grey, 0.35f), 3.0f);
  list->AddRectFilled(ImVec2(at.x, middle - 3.0f), ImVec2(place(transport.arrived()), middle + 3.0f), paint(gui.colors().sky, 0.8f), 3.0f);
  const MessageLine* near = nullptr;
  for (const MessageLine& mark : plan.marks) {
    const float x = place(mark.time);
    list->AddLine(ImVec2(x, at.y + 2.0f), ImVec2(x, at.y + tall - 2.0f), paint(mark.warning ? gui.colors().orange : gui.colors().yellow),
                  2.0f);
    if (ImGui::IsItemHovered() && std::abs(ImGui::GetIO().MousePos.x - x) < 6.0f) near = &mark;
  }
  list->AddCircleFilled(ImVec2(place(transport.head()), middle), 7.0f * gui.scale(), paint(gui.colors().sky));
  if (near != nullptr)
    ImGui::SetTooltip("%.2f s: %s", near->time, printable_text(near->text).c_str());
  else if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%.2f s", std::clamp(pointed, 0.0, duration));
}

}  // namespace

float transport_height(const Gui& gui) noexcept { return 84.0f * gui.scale(); }

void draw_transport(const Gui& gui, WindowState& state, const WindowView& view, const WindowPlan& plan, int width, int height) {
  const float tall = transport_height(gui);
  ImGui::SetNextWindowPos(ImVec2(0.0f, static_cast<float>(height) - tall));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), tall));
  ImGui::SetNextWindowBgAlpha(kOverPicture);
  ImGui::Begin("transport", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
  line(gui, state, *view.transport, plan);
  buttons(gui, state, *view.transport);
  ImGui::End();
}

}  // namespace burrhole
