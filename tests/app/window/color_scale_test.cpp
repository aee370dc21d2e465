// The scale of colours over the picture: its place, its colours by height, and its values, in a layout without a window.
#include "app/window/color_scale.h"

#include <doctest/doctest.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/color_ramp.h"

namespace burrhole {
namespace {

const ColorBar kBar{.title = "temperature (C)", .marks = {{0.0, "40"}, {0.25, "45"}, {0.5, "50"}, {0.75, "55"}, {1.0, "60"}}};

/// What ImGui would draw of a scale; the letters are 13 pixels high.
class Layout {
 public:
  Layout(const ColorBar& bar, const ScaleRoom& room, float text_scale = 1.0f) : scale(text_scale) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(900.0f, 800.0f);
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    for (int frame = 0; frame < 3; ++frame) {  // a window that takes the size of its content is drawn from the second on
      ImGui::NewFrame();
      draw_scale(bar, room, text_scale);
      ImGui::Render();
    }
    const ImDrawData& data = *ImGui::GetDrawData();
    for (int n = 0; n < data.CmdListsCount; ++n)
      for (const ImDrawVert& one : data.CmdLists[n]->VtxBuffer) vertices.push_back(one);
    ink = ImGui::GetColorU32(ImGuiCol_Text);
    ImGui::DestroyContext();
  }

  /// Heights of the corners of the colour.
  [[nodiscard]] std::vector<float> heights_of(const RampColor& color) const {
    std::vector<float> out;
    for (const ImDrawVert& one : vertices)
      if (one.col == IM_COL32(color.r, color.g, color.b, 255)) out.push_back(one.pos.y);
    return out;
  }
  /// Middles of the lines of text right of the colours, from below. Letters of a line differ by less than half their height.
  [[nodiscard]] std::vector<float> values() const {
    float right = 0.0f;
    for (const ImDrawVert& one : vertices)
      if (one.col == IM_COL32(0x2c, 0x11, 0x5f, 255)) right = std::max(right, one.pos.x);
    std::vector<float> ys;
    for (const ImDrawVert& one : vertices)
      if (one.col == ink && one.pos.x > right + 7.5f * scale && one.pos.y > top() - 7.0f) ys.push_back(one.pos.y);
    std::ranges::sort(ys, std::greater<>());
    std::vector<float> out;
    for (std::size_t n = 0; n < ys.size();) {
      std::size_t end = n;
      while (end < ys.size() && ys[n] - ys[end] < 12.0f) ++end;
      out.push_back(0.5f * (ys[n] + ys[end - 1]));
      n = end;
    }
    return out;
  }
  [[nodiscard]] float top() const {
    return heights_of(kValueRamp.back().color).empty() ? 0.0f : heights_of(kValueRamp.back().color).front();
  }
  [[nodiscard]] float bottom() const { return heights_of(kValueRamp.front().color).front(); }

  float scale;
  std::vector<ImDrawVert> vertices;
  ImU32 ink = 0;
};

bool has_ramp(const Layout& layout, double share_of_top) {
  const float top = layout.top(), bottom = layout.bottom();
  return std::ranges::all_of(kValueRamp, [&](const RampStop& stop) {
    const std::vector<float> found = layout.heights_of(stop.color);
    const double share = share_of_top * stop.share + (1.0 - share_of_top) * (1.0 - stop.share);
    const double expected = bottom + share * (top - bottom);
    return !found.empty() && std::ranges::all_of(found, [&](float y) { return std::abs(y - expected) < 0.01; });
  });
}

}  // namespace

TEST_CASE("color scale: the room is that of still pictures, less what stands above and below; none in a picture that is too low") {
  const ScaleRoom whole = scale_room(800.0f, 12.0f, 12.0f, 13.0f);
  CHECK(whole.tall == doctest::Approx(320.0f));
  CHECK(whole.bottom == doctest::Approx(573.0f));
  for (const float height : {90.0f, 200.0f, 420.0f, 800.0f, 2000.0f})
    for (const float below : {12.0f, 130.0f, 224.0f, 700.0f}) {
      CAPTURE(height);
      CAPTURE(below);
      const ScaleRoom room = scale_room(height, 12.0f, below, 13.0f);
      if (room.tall == 0.0f) {
        CHECK((height < 176.0f || height - below < 136.0f));  // title, spaces and three lines are 9.5 letters
        continue;
      }
      CHECK(room.tall >= 3.0f * 13.0f);
      CHECK(room.bottom <= height - below);
      CHECK(room.bottom - room.tall - 3.0f * 13.0f >= 12.0f);  // of the title, three lines
    }
}

TEST_CASE("color scale: each colour of the ramp lies at its share of the height, the lowest below, and each value at its mark") {
  for (const float scale : {1.0f, 2.0f}) {
    const Layout layout(kBar, {.bottom = 600.0f, .tall = 300.0f}, scale);
    REQUIRE_FALSE(layout.heights_of(kValueRamp.front().color).empty());
    CHECK(layout.bottom() - layout.top() == doctest::Approx(300.0f));
    CHECK(layout.bottom() < 600.0f);
    CHECK(has_ramp(layout, 1.0));
    CHECK_FALSE(has_ramp(layout, 0.0));  // the sabotage: upside down
    const std::vector<float> values = layout.values();
    REQUIRE(values.size() == kBar.marks.size());
    for (std::size_t n = 0; n < values.size(); ++n)  // digits are not centred in their line
      CHECK(std::abs(values[n] - (layout.bottom() - 300.0f * static_cast<float>(kBar.marks[n].first))) < 3.0f);
  }
}

TEST_CASE("color scale: values for which there is no room are left out, the lowest stays; without room nothing is drawn") {
  const Layout low(kBar, {.bottom = 300.0f, .tall = 39.0f});
  const std::vector<float> values = low.values();
  REQUIRE(values.size() == 3);  // marks are 9.75 pixels apart, letters 13 high: every second one
  CHECK(std::abs(values.front() - low.bottom()) < 3.0f);
  for (std::size_t n = 1; n < values.size(); ++n) CHECK(values[n - 1] - values[n] >= 12.0f);
  CHECK(Layout(kBar, {.bottom = 300.0f, .tall = 0.0f}).vertices.empty());
}

}  // namespace burrhole
