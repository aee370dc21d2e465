// Contrast of texts by WCAG 2.1, and the size of texts.
#include <doctest/doctest.h>

#include <cmath>

#include "app/window/gui.h"
#include "app/window/panel_parts.h"
#include "app/window/text_scale.h"

using namespace burrhole;

namespace {

/// Relative luminance of WCAG 2.1 of a colour 0..1.
double luminance(const ImVec4& c) {
  const auto linear = [](double v) { return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(static_cast<double>(c.x)) + 0.7152 * linear(static_cast<double>(c.y)) + 0.0722 * linear(static_cast<double>(c.z));
}

double contrast(const ImVec4& a, const ImVec4& b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

/// A ground of a window over a picture of one grey.
ImVec4 over(const ImVec4& ground, float grey, float alpha) {
  const auto mix = [&](float g) { return alpha * g + (1.0f - alpha) * grey; };
  return {mix(ground.x), mix(ground.y), mix(ground.z), 1.0f};
}

}  // namespace

TEST_CASE("colours: known contrasts") {
  CHECK(contrast(color(0xFFFFFF), color(0x000000)) == doctest::Approx(21.0));
  CHECK(contrast(color(0x777777), color(0xFFFFFF)) == doctest::Approx(4.48).epsilon(0.002));
  CHECK(contrast(color(0xE69F00), color(0xF0F0F0)) < 2.5);  // the amber of a dark theme on a light ground
}

TEST_CASE("colours: every text has a contrast of 4.5 on panel, chosen line, and over any picture, in both themes") {
  for (const GuiColors& theme : {GuiColors::dark(), GuiColors::light()})
    for (const unsigned ink : {theme.text, theme.sky, theme.orange, theme.green, theme.red, theme.grey}) {
      CAPTURE(ink);
      CHECK(contrast(color(ink), color(theme.ground)) >= 4.5);
      CHECK(contrast(color(ink), color(theme.chosen)) >= 4.5);
      for (const float grey : {0.0f, 0.5f, 1.0f}) CHECK(contrast(color(ink), over(color(theme.ground), grey, kOverPicture)) >= 4.5);
    }
}

TEST_CASE("texts: steps are kept in their range, and a step back ends where it began") {
  double scale = 1.0;
  for (int n = 0; n < 3; ++n) scale = next_text_scale(scale, true);
  CHECK(scale > 1.3);
  for (int n = 0; n < 3; ++n) scale = next_text_scale(scale, false);
  CHECK(scale == doctest::Approx(1.0).epsilon(1e-12));
  for (int n = 0; n < 99; ++n) scale = next_text_scale(scale, true);
  CHECK(scale == kLargestText);
  CHECK(next_text_scale(scale, false) < kLargestText);
  for (int n = 0; n < 99; ++n) scale = next_text_scale(scale, false);
  CHECK(scale == kSmallestText);
}
