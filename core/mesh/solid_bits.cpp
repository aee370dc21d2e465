#include "core/mesh/solid_bits.h"

#include "core/base/assert.h"
#include "core/mesh/ball_tables.h"

namespace burrhole {

SolidBits::SolidBits(const VoxelBox& box) : box_(box) {
  BH_ASSERT(!box.empty());
  const auto size = [&](int axis) { return static_cast<std::size_t>(box.size()[axis]) + 2; };
  row_ = (size(0) + 63) / 64 * 64;
  slab_ = row_ * size(1);
  words_.assign(slab_ * size(2) / 64, 0);
  const auto difference = [&](const Vec3i& step) {
    return static_cast<std::size_t>(step.x) + row_ * static_cast<std::size_t>(step.y) + slab_ * static_cast<std::size_t>(step.z);
  };
  for (unsigned code = 0; code < 27; ++code) steps_[code] = difference(step_of_code(code));
  for (unsigned n = 0; n < 8; ++n) corner_steps_[n] = difference(cell_corner(n));
}

std::vector<std::size_t> SolidBits::mixed_cells() const {
  std::vector<std::size_t> out;
  const std::size_t row = row_ / 64, slab = slab_ / 64, rows = slab_ / row_, slabs = words_.size() / slab;
  for (std::size_t k = 0; k + 1 < slabs; ++k)
    for (std::size_t j = 0; j + 1 < rows; ++j) {
      const std::uint64_t* words = words_.data() + k * slab + j * row;
      const auto any = [&](std::size_t n) { return n < row ? words[n] | words[n + row] | words[n + slab] | words[n + slab + row] : 0; };
      const auto all = [&](std::size_t n) { return n < row ? words[n] & words[n + row] & words[n + slab] & words[n + slab + row] : 0; };
      for (std::size_t n = 0; n < row; ++n) {
        std::uint64_t some = any(n), each = all(n);
        if (some == 0 && any(n + 1) == 0) continue;
        some |= some >> 1 | any(n + 1) << 63;
        each &= each >> 1 | all(n + 1) << 63;
        for (std::uint64_t mixed = some & ~each; mixed != 0; mixed &= mixed - 1)
          out.push_back(64 * static_cast<std::size_t>(words - words_.data() + static_cast<std::ptrdiff_t>(n)) +
                        static_cast<std::size_t>(std::countr_zero(mixed)));
      }
    }
  return out;
}

}  // namespace burrhole
