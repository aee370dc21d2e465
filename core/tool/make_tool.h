/// core/tool/make_tool.h: from a tool file to a Tool ready for use.
///   Frame  tool frame.   Units  SI.   Errors  every fault of the file, in one go, as Issues with file:line:column.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/toml.h"
#include "core/tool/surface_mesh.h"
#include "core/tool/tool.h"

namespace burrhole {

struct ToolOptions {
  double erosion_pitch = 0.25e-3;  ///< [m] > 0; half a voxel of the bone is the usual choice
  double cutting_voxel = 0.0;      ///< [m] edge of the bone's voxels; above 0: Tool::cutting is made, as fine as cutting_field_size says
  /// Reads the surface that a [mesh] names, one unit of the file `unit` [m] long; core reads no files. Empty: such tools are refused.
  std::function<Result<SurfaceMesh>(const std::string& path, double unit)> read_mesh = nullptr;
};

/// @returns nothing when any issue was pushed. Allocates; not for the servo path.
[[nodiscard]] std::optional<Tool> make_tool(const TomlDocument& document, const ToolOptions& options, Issues& issues);

/// Reads the file at `path` and makes the tool. A file that cannot be read or parsed is an issue too.
[[nodiscard]] std::optional<Tool> load_tool(const std::string& path, const ToolOptions& options, Issues& issues);

}  // namespace burrhole
