#include "app/window/skull_screen.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/window/panel.h"
#include "app/window/panel_parts.h"
#include "core/base/units.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

/// Shows a picture behind all windows.
void show(const PictureTexture& picture, float x, float y, float width, float height) {
  if (picture.name() == 0) return;
  // ImGui keeps names of OpenGL textures as pointers.  NOLINTNEXTLINE(performance-no-int-to-ptr)
  const auto texture = reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture.name()));
  ImGui::GetBackgroundDrawList()->AddImage(texture, ImVec2(x, y), ImVec2(x + width, y + height));
}

/// A coordinate of the patient with the direction that it points to.
std::string side_text(double metres, char positive, char negative) {
  return fmt::format("{} {:.1f}", metres < 0.0 ? negative : positive, std::abs(metres) / kMillimetre);
}

}  // namespace

Result<std::unique_ptr<SkullScreen>> SkullScreen::create(GlContext context, const Gui& gui, const TriangleMesh& bit,
                                                         const TriangleMesh& solid) {
  auto view = SkullView::create(std::move(context), bit, solid);
  if (!view) return view.error();
  return std::unique_ptr<SkullScreen>(new SkullScreen(gui, std::move(view).value()));
}

Status SkullScreen::show(ImportedBone bone, const SkullSource& source) {
  name_ = std::filesystem::path(source.path).filename().string();
  failure_.clear();
  report_ = std::move(bone.report);
  pointer_ = std::make_unique<SkullPointer>(bone.bone);
  return view_->set_bone(*bone.bone);
}

void SkullScreen::draw_picture(int width, int height) {
  const int picture = width - panel_width(width, gui_->scale());
  pointer_->set_picture_size(picture, height);
  const Status drawn = view_->draw(*pointer_, picture, height);
  failure_ = drawn ? std::string() : drawn.error().text();
}

SkullScreen::Answer SkullScreen::draw_panel(int width, int height) {
  const int side = panel_width(width, gui_->scale());
  const auto w = static_cast<float>(width - side), h = static_cast<float>(height), edge = 12.0f * gui_->scale();
  ::burrhole::show(view_->picture(), 0.0f, 0.0f, w, h);
  const PictureTexture& slices = view_->slices();
  if (pointer_->site() && view_->sliced() == pointer_->site()->entry)
    ::burrhole::show(slices, edge, h - edge - static_cast<float>(slices.height()), static_cast<float>(slices.width()),
                     static_cast<float>(slices.height()));
  const std::string& problem = failure_.empty() ? pointer_->problem() : failure_;
  if (!problem.empty()) {
    begin_over("problem", ImVec2(0.5f * w, edge), ImVec2(0.5f, 0.0f));
    ImGui::PushTextWrapPos(w - 4.0f * edge);
    ImGui::TextColored(color(gui_->colors().orange), "%s", printable_text(problem).c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
  }
  ImGui::SetNextWindowPos(ImVec2(w, 0.0f));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(side), h));
  ImGui::Begin("site", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav);
  draw_figures();
  const Answer answer = draw_buttons();
  draw_regions();
  ImGui::End();
  return answer;
}

void SkullScreen::draw_figures() {
  ImGui::PushTextWrapPos(0.0f);
  text(name_);
  ImGui::PushFont(gui_->small());
  const Vec3 size = (report_.bone_hi - report_.bone_lo) / kMillimetre;
  text(fmt::format("{}, bone of {:.0f} x {:.0f} x {:.0f} mm", report_.scan.format, size.x, size.y, size.z));
  if (const auto series = std::ranges::find_if(report_.scan.series, &SeriesLine::taken); series != report_.scan.series.end())
    text(fmt::format("series {} of {}: {}, {} slices of {} x {}", series->name, report_.scan.series.size(), series->direction,
                     series->dims.z, series->dims.x, series->dims.y));
  for (const std::string& line : report_.scan.assumed) text("Assumed: " + line);
  ImGui::PopFont();
  ImGui::Separator();
  const auto& site = pointer_->site();
  caption(*gui_, "WHERE IS THE HOLE?");
  text("Click on the bone. The drill stands square to it.");
  caption(*gui_, "BONE UNDER THE BIT");
  ImGui::PushFont(gui_->big());
  ImGui::TextColored(color(gui_->colors().sky), "%s", site ? fmt::format("{:.1f} mm", site->thickness / kMillimetre).c_str() : "-");
  ImGui::PopFont();
  caption(*gui_, "ENTRY, PATIENT COORDINATES [mm]");
  text(site ? fmt::format("{}   {}   {}", side_text(site->entry.x, 'L', 'R'), side_text(site->entry.y, 'P', 'A'),
                          side_text(site->entry.z, 'S', 'I'))
            : std::string("-"));
  ImGui::PopTextWrapPos();
  ImGui::Separator();
}

void SkullScreen::press(Key key) {
  pointer_->handle({.kind = WindowEvent::Kind::key, .code = static_cast<int>(key), .down = true}, false);
  pointer_->handle({.kind = WindowEvent::Kind::key, .code = static_cast<int>(key), .down = false}, false);
}

SkullScreen::Answer SkullScreen::draw_buttons() {
  const ImVec2 whole(ImGui::GetContentRegionAvail().x, 0.0f);
  Answer out = Answer::none;
  if (pointer_->site() && ImGui::Button("Drill here (Enter)", whole)) out = Answer::starts;
  if (ImGui::Button("Another file (Esc)", whole)) out = Answer::leaves;
  ImGui::Separator();
  return out;
}

void SkullScreen::draw_regions() {
  const float wide = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) * 0.5f;
  caption(*gui_, "GO TO");
  for (std::size_t n = 0; n < skull_regions().size(); ++n) {
    if (n % 2 == 1) ImGui::SameLine();
    const std::string label = fmt::format("{}  {}", n + 1, skull_regions()[n].name);
    if (ImGui::Button(label.c_str(), ImVec2(wide, 0.0f))) press(static_cast<Key>(static_cast<int>(Key::digit_0) + static_cast<int>(n) + 1));
  }
  ImGui::PushFont(gui_->small());
  ImGui::PushTextWrapPos(0.0f);
  text(
      "Arrows move the bit over the bone, with Shift a fifth as far. Right drag or Ctrl + arrows turn the view, the wheel zooms, F shows "
      "the bit.");
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
}

}  // namespace burrhole
