/// app/render/png.h: pictures as PNG files (8-bit RGBA, row 0 at the top).   Errors  bad_input.
#pragma once

#include <filesystem>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Writes the file as OutputFile does: a reader sees the old or the new picture, never a part.
/// @returns ErrorCode::bad_input with the path and the reason if the picture is empty or the path cannot be written.
[[nodiscard]] Status write_png(const std::filesystem::path& path, const Image& image);
/// @returns ErrorCode::bad_input if the file is missing or not a PNG.
[[nodiscard]] Result<Image> read_png(const std::filesystem::path& path);

}  // namespace burrhole
