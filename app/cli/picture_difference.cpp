#include "app/cli/picture_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/render/png.h"

namespace burrhole::cli {
namespace {

constexpr double kFull = 64.0;  // difference of a channel that is drawn in full colour
constexpr double kOrange[] = {214.0, 84.0, 20.0};

int difference_of(const Rgba8& a, const Rgba8& b) { return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}); }

}  // namespace

Result<std::string> write_picture_difference(const std::string& first, const std::string& second, const std::string& file) {
  const auto a = read_png(first), b = read_png(second);
  if (!a) return a.error();
  if (!b) return b.error();
  if (a->width != b->width || a->height != b->height) return std::string();
  Image out{a->width, a->height, a->pixels};
  std::size_t differing = 0;
  for (std::size_t n = 0; n < out.pixels.size(); ++n) {
    const Rgba8& p = a->pixels[n];
    const int difference = difference_of(p, b->pixels[n]);
    differing += difference > 0 ? 1 : 0;
    const double grey = 0.45 * (0.299 * p.r + 0.587 * p.g + 0.114 * p.b) + 0.55 * 255.0, share = std::min(1.0, difference / kFull);
    const auto mixed = [&](int channel) { return static_cast<std::uint8_t>(std::lround(grey + share * (kOrange[channel] - grey))); };
    out.pixels[n] = {mixed(0), mixed(1), mixed(2), 255};
  }
  if (differing == 0) return std::string(kNoDifference);
  if (Status written = write_png(file, out); !written) return written.error();
  return fmt::format("difference, in {:.2g} % of the pixels",
                     100.0 * static_cast<double>(differing) / static_cast<double>(out.pixels.size()));
}

}  // namespace burrhole::cli
