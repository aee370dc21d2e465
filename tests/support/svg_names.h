/// tests/support/svg_names.h: texts of an SVG of gnuplot, and whether their boxes intersect.
#pragma once

#include <regex>
#include <string>
#include <vector>

namespace burrhole::test {

/// A text that is centred at x; y is its baseline, downwards.
struct SvgText {
  double x = 0.0, y = 0.0, size = 0.0;
  std::string text;
};

/// @returns the centred horizontal texts of that size [px].
inline std::vector<SvgText> svg_texts(const std::string& svg, double size) {
  static const std::regex kText(
      R"re(<g transform="translate\(([-0-9.]+),([-0-9.]+)\)"[^>]*font-size="([0-9.]+)"\s+text-anchor="middle">\s*<text>([^<]*)</text>)re");
  std::vector<SvgText> out;
  for (std::sregex_iterator at(svg.begin(), svg.end(), kText), end; at != end; ++at)
    if (std::stod((*at)[3]) == size) out.push_back({std::stod((*at)[1]), std::stod((*at)[2]), size, (*at)[4]});
  return out;
}

/// @returns the number of pairs whose boxes intersect: digits of Helvetica are 0.556 em wide and 0.72 em high.
inline int intersecting_pairs(const std::vector<SvgText>& texts) {
  int out = 0;
  for (std::size_t a = 0; a < texts.size(); ++a)
    for (std::size_t b = a + 1; b < texts.size(); ++b) {
      const auto half = [](const SvgText& t) { return 0.278 * t.size * static_cast<double>(t.text.size()); };
      const bool beside = std::abs(texts[a].x - texts[b].x) >= half(texts[a]) + half(texts[b]);
      const bool above = std::abs(texts[a].y - texts[b].y) >= 0.72 * std::max(texts[a].size, texts[b].size);
      out += beside || above ? 0 : 1;
    }
  return out;
}

}  // namespace burrhole::test
