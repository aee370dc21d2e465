#include "app/view/driver_text.h"

#include <algorithm>
#include <array>

namespace burrhole {

std::string driver_text(std::string_view driver) {
  const auto backend = driver.find(": "), version = driver.find(", ", backend);
  if (backend == std::string_view::npos || version == std::string_view::npos) return std::string(driver);
  const std::string_view renderer = driver.substr(version + 2);
  const std::string_view number = driver.substr(backend + 2, driver.find(' ', backend + 2) - backend - 2);
  constexpr std::array<std::string_view, 3> kSoftware{"llvmpipe", "softpipe", "swrast"};
  const bool software =
      std::ranges::any_of(kSoftware, [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
  return std::string("rendering on ")
      .append(software ? "CPU: " : "GPU: ")
      .append(renderer)
      .append(", OpenGL ")
      .append(number)
      .append(" by ")
      .append(driver.substr(0, backend));
}

}  // namespace burrhole
