/// app/render/transfer_texture.h: the table of a transfer function for the shader. Internal to app/render.   Errors  out_of_range.
#pragma once

#include <array>
#include <cstdint>

#include "app/render/gl_object.h"
#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// One value for each 8-bit density: RGB tint, A extinction [1/m].
using TransferTable = std::array<glm::fvec4, 256>;

/// @returns ErrorCode::out_of_range if there is no point, densities do not increase within 0..1, or a value is not finite, negative, or
/// (tint) above 1.
[[nodiscard]] Status check_transfer(const TransferFunction& transfer);
/// Linear between points. @pre `transfer` has passed the check.
[[nodiscard]] TransferTable make_transfer_table(const TransferFunction& transfer);
/// @returns an 8-bit density. Filtered texels below it have an extinction of exactly 0 for any rounding of the driver. 0 if empty texels
/// are visible.
[[nodiscard]] std::uint8_t seen_from(const TransferTable& table);
/// @returns whether a tint differs from 1; without tints the texture contains extinctions only.
[[nodiscard]] bool has_tint(const TransferTable& table);
[[nodiscard]] GlObject make_transfer_texture(const GladGLContext& gl, const TransferTable& table);

}  // namespace burrhole
