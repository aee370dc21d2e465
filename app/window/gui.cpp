#include "app/window/gui.h"

#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/render/gl_platform.h"

namespace burrhole {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // Debian: fonts-dejavu-core
constexpr float kText = 16.0f, kSmallText = 13.0f, kBigText = 30.0f;              // [pixels] at scale 1

ImFont* add_font(float size) {
  ImGuiIO& io = ImGui::GetIO();
  static const ImWchar ranges[] = {0x0020, 0x00FF, 0x2000, 0x206F, 0x2190, 0x21FF, 0};  // letters, punctuation, arrows
  std::error_code ignored;
  if (std::filesystem::exists(kFont, ignored))
    if (ImFont* const font = io.Fonts->AddFontFromFileTTF(kFont, size, nullptr, ranges); font != nullptr) return font;
  ImFontConfig config;
  config.SizePixels = size;
  return io.Fonts->AddFontDefault(&config);
}

ImVec4 part_of(unsigned rgb) {
  const auto part = [&](int shift) { return static_cast<float>(rgb >> shift & 0xFFu) / 255.0f; };
  return {part(16), part(8), part(0), 1.0f};
}

void set_style(float scale, bool light, const GuiColors& colors) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();  // sizes of an earlier scale
  if (light)
    ImGui::StyleColorsLight();
  else
    ImGui::StyleColorsDark();
  style.WindowRounding = 0.0f;
  style.FrameRounding = 4.0f;
  style.WindowBorderSize = 0.0f;
  style.WindowPadding = ImVec2(14.0f, 12.0f);
  style.ItemSpacing = ImVec2(8.0f, 7.0f);
  style.ScaleAllSizes(scale);
  style.Colors[ImGuiCol_WindowBg] = part_of(colors.ground);
  style.Colors[ImGuiCol_PopupBg] = part_of(colors.ground);
  style.Colors[ImGuiCol_Text] = part_of(colors.text);
  style.Colors[ImGuiCol_TextDisabled] = part_of(colors.grey);
  style.Colors[ImGuiCol_Header] = style.Colors[ImGuiCol_HeaderHovered] = style.Colors[ImGuiCol_HeaderActive] = part_of(colors.chosen);
  if (light) return;
  style.Colors[ImGuiCol_Button] = ImVec4(0.20f, 0.23f, 0.26f, 1.0f);
  style.Colors[ImGuiCol_FrameBg] = ImVec4(0.16f, 0.18f, 0.20f, 1.0f);
}

}  // namespace

Result<std::unique_ptr<Gui>> Gui::create(float scale, bool light) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  std::unique_ptr<Gui> gui(new Gui(scale, light));
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // a run leaves no file of its window behind
  io.BackendFlags |= ImGuiBackendFlags_HasMouseCursors;
  gui->apply_scale();
  if (!ImGui_ImplOpenGL3_Init("#version 450 core")) return gl_unavailable("window: the panel's shaders do not build");
  return gui;
}

Gui::~Gui() {
  if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void Gui::apply_scale() {
  ImGui::GetIO().Fonts->Clear();
  normal_ = add_font(kText * scale_);
  small_ = add_font(kSmallText * scale_);
  big_ = add_font(kBigText * scale_);
  set_style(scale_, light_, colors_);
}

void Gui::rescale(float scale) {
  scale_ = scale;
  apply_scale();
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Gui::feed(const std::vector<WindowEvent>& events) {
  ImGuiIO& io = ImGui::GetIO();
  std::vector<WindowEvent> all = std::exchange(kept_, {});
  all.insert(all.end(), events.begin(), events.end());
  bool pressed[3] = {};
  for (auto at = all.begin(); at != all.end(); ++at) {
    const WindowEvent& event = *at;
    if (event.kind == WindowEvent::Kind::button && event.code >= 0 && event.code < 3) {
      if (!event.down && pressed[event.code]) {
        kept_.assign(at, all.end());
        return;
      }
      pressed[event.code] = event.down;
    }
    const auto x = static_cast<float>(event.x), y = static_cast<float>(event.y);
    switch (event.kind) {
      case WindowEvent::Kind::motion:
        io.MousePos = ImVec2(x, y);
        break;
      case WindowEvent::Kind::button:
        io.MousePos = ImVec2(x, y);
        if (event.code >= 0 && event.code < 3) io.MouseDown[event.code] = event.down;
        break;
      case WindowEvent::Kind::scroll:
        io.MouseWheel += y;
        break;
      case WindowEvent::Kind::focus:
        if (!event.down) std::fill(std::begin(io.MouseDown), std::end(io.MouseDown), false);
        break;
      case WindowEvent::Kind::key:
      case WindowEvent::Kind::character:
      case WindowEvent::Kind::size:
      case WindowEvent::Kind::close:
        break;
    }
  }
}

void Gui::begin(int width, int height, double dt) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = static_cast<float>(std::clamp(dt, 1e-4, 1.0));
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
}

void Gui::end() {
  end_layout();
  draw();
}

void Gui::end_layout() { ImGui::Render(); }

void Gui::draw() { ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData()); }

bool Gui::wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }

}  // namespace burrhole
