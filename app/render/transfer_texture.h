/// app/render/transfer_texture.h: a transfer function as the shader reads it. Internal: only app/render's sources include it.
#pragma once

#include <array>
#include <cstdint>

#include "app/engine/view.h"
#include "app/render/gl_object.h"
#include "core/base/result.h"

namespace burrhole {

/// One value for each 8-bit density: RGB tint, A extinction [1/m].
using TransferTable = std::array<glm::fvec4, 256>;

/// @returns ErrorCode::out_of_range if there is no corner, densities do not rise within 0..1, or a value is not finite, negative, or (tint)
/// above 1.
[[nodiscard]] Status check_transfer(const TransferFunction& transfer);
/// Linear between corners. `transfer` has passed the check.
[[nodiscard]] TransferTable make_transfer_table(const TransferFunction& transfer);
/// An 8-bit density: texels below it, filtered, have an extinction of exactly 0 whatever the driver's rounding. 0 when an empty texel is
/// seen already.
[[nodiscard]] std::uint8_t seen_from(const TransferTable& table);
/// Whether a tint is anything but 1; without one the texture holds extinctions alone.
[[nodiscard]] bool has_tint(const TransferTable& table);
[[nodiscard]] GlObject make_transfer_texture(const GladGLContext& gl, const TransferTable& table);

}  // namespace burrhole
