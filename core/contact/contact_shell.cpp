#include "core/contact/contact_shell.h"

#include <algorithm>
#include <cmath>

#include "core/base/morton.h"

namespace burrhole {
namespace {

ContactShellPart make_part(const PointShell& shell, std::vector<std::uint32_t> order, const Vec3& lo, double cell) {
  std::vector<std::uint64_t> codes(shell.size());
  for (const std::uint32_t n : order)
    codes[n] = morton_code(glm::min(floor_int((shell.positions[n] - lo) / cell), Vec3i(kMortonCells - 1)));
  std::ranges::stable_sort(order, {}, [&](std::uint32_t n) { return codes[n]; });
  ContactShellPart part;
  part.point = std::move(order);
  if (part.point.empty()) return part;
  const std::size_t padded = (part.size() + kShellPad - 1) / kShellPad * kShellPad;
  for (std::size_t n = 0; n < padded; ++n) {
    const Vec3& p = shell.positions[part.point[std::min(n, part.size() - 1)]];
    part.x.push_back(static_cast<float>(p.x));
    part.y.push_back(static_cast<float>(p.y));
    part.z.push_back(static_cast<float>(p.z));
  }
  return part;
}

}  // namespace

ContactShell make_contact_shell(const PointShell& shell, double cell) {
  ContactShell out;
  if (shell.size() == 0) return out;
  Vec3 lo = shell.positions.front();
  std::vector<std::uint32_t> cutting, passive;
  for (std::size_t n = 0; n < shell.size(); ++n) {
    lo = glm::min(lo, shell.positions[n]);
    out.reach = std::max(out.reach, glm::length(shell.positions[n]));
    (shell.cutting[n] != 0 ? cutting : passive).push_back(static_cast<std::uint32_t>(n));
  }
  out.cutting = make_part(shell, std::move(cutting), lo, cell);
  out.passive = make_part(shell, std::move(passive), lo, cell);
  return out;
}

namespace {

std::size_t stride(const ContactShellPart& part, std::size_t most) noexcept {
  return std::max<std::size_t>(1, (part.size() + most - 1) / most);
}

}  // namespace

ContactShellPart even_part(const ContactShellPart& from, std::size_t most) {
  ContactShellPart out;
  const std::size_t every = stride(from, most);
  for (std::size_t n = 0; n < from.size(); n += every) out.point.push_back(from.point[n]);
  const std::size_t padded = (out.size() + kShellPad - 1) / kShellPad * kShellPad;
  for (auto* axis : {&out.x, &out.y, &out.z}) axis->assign(padded, 0.0f);
  copy_even_part(from, most, out);
  return out;
}

void copy_even_part(const ContactShellPart& from, std::size_t most, ContactShellPart& to) noexcept {
  if (to.size() == 0) return;
  const std::size_t every = stride(from, most);
  for (std::size_t n = 0; n < to.x.size(); ++n) {
    const std::size_t source = std::min(n, to.size() - 1) * every;
    to.x[n] = from.x[source];
    to.y[n] = from.y[source];
    to.z[n] = from.z[source];
  }
}

}  // namespace burrhole
