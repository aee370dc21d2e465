#include "app/render/transfer_texture.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Status check_transfer(const TransferFunction& transfer) {
  const auto out_of_range = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (transfer.empty()) return out_of_range("a transfer function needs a corner");
  double before = -1.0;
  for (const TransferPoint& point : transfer) {
    if (!(point.density >= 0.0 && point.density <= 1.0 && point.density > before))
      return out_of_range("densities of a transfer function must rise within 0..1");
    if (!(point.extinction >= 0.0 && std::isfinite(point.extinction))) return out_of_range("an extinction must be 0 or more");
    for (const double channel : {point.tint.x, point.tint.y, point.tint.z})
      if (!(channel >= 0.0 && channel <= 1.0)) return out_of_range("a tint must be in 0..1");
    before = point.density;
  }
  return {};
}

TransferTable make_transfer_table(const TransferFunction& transfer) {
  TransferTable table{};
  for (std::size_t n = 0; n < table.size(); ++n) {
    const double density = static_cast<double>(n) / 255.0;
    const auto after =
        std::find_if(transfer.begin(), transfer.end(), [density](const TransferPoint& point) { return point.density >= density; });
    const TransferPoint& hi = after == transfer.end() ? transfer.back() : *after;
    const TransferPoint& lo = after == transfer.begin() || after == transfer.end() ? hi : *(after - 1);
    const double way = hi.density > lo.density ? (density - lo.density) / (hi.density - lo.density) : 0.0;
    table[n] = glm::fvec4(glm::dvec4(glm::mix(lo.tint, hi.tint, way), glm::mix(lo.extinction, hi.extinction, way)));
  }
  return table;
}

std::uint8_t seen_from(const TransferTable& table) {
  const auto seen = std::find_if(table.begin(), table.end(), [](const glm::fvec4& value) { return value.w > 0.0f; });
  if (seen == table.begin()) return 0;
  // One less than the first visible density: rounding in the filter may raise a mean, but not the mean of texels that are all 0.
  return static_cast<std::uint8_t>(std::max<std::ptrdiff_t>(seen - table.begin() - 1, 1));
}

bool has_tint(const TransferTable& table) {
  const auto is_tinted = [](const glm::fvec4& value) { return value.x != 1.0f || value.y != 1.0f || value.z != 1.0f; };
  return std::any_of(table.begin(), table.end(), is_tinted);
}

GlObject make_transfer_texture(const GladGLContext& gl, const TransferTable& table) {
  GlObject texture = make_texture(gl, GL_TEXTURE_1D);
  const auto size = static_cast<GLsizei>(table.size());
  if (has_tint(table)) {
    gl.TextureStorage1D(texture.name(), 1, GL_RGBA32F, size);
    gl.TextureSubImage1D(texture.name(), 0, 0, size, GL_RGBA, GL_FLOAT, table.data());
  } else {
    std::array<float, std::tuple_size_v<TransferTable>> extinction;
    std::transform(table.begin(), table.end(), extinction.begin(), [](const glm::fvec4& value) { return value.w; });
    gl.TextureStorage1D(texture.name(), 1, GL_R32F, size);
    gl.TextureSubImage1D(texture.name(), 0, 0, size, GL_RED, GL_FLOAT, extinction.data());
  }
  gl.TextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TextureParameteri(texture.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace burrhole
