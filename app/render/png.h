/// app/render/png.h: pictures as PNG files (8-bit RGBA, row 0 at the top).
#pragma once

#include <filesystem>

#include "app/engine/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Writes beside `path` and renames, so that a reader sees the old picture or the new one, never half of it.
/// @returns ErrorCode::bad_input with the path and the reason when the picture is empty or the place cannot be written.
[[nodiscard]] Status write_png(const std::filesystem::path& path, const Image& image);
/// @returns ErrorCode::bad_input when the file is missing or no PNG.
[[nodiscard]] Result<Image> read_png(const std::filesystem::path& path);

}  // namespace burrhole
