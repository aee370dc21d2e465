/// core/tool/make_tool.h: makes a Tool from a tool file.
///   Frame  tool frame.   Units  SI.   Errors  all errors of the file are pushed to Issues with file:line:column.   Thread  not the servo.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/config/toml.h"
#include "core/tool/surface_mesh.h"
#include "core/tool/tool.h"

namespace burrhole {

struct ToolOptions {
  double erosion_pitch = 0.25e-3;  ///< [m] > 0; usually half a voxel of the bone
  double cutting_voxel = 0.0;      ///< [m] voxel edge of the bone; > 0: Tool::cutting is made with cutting_field_size()
  /// Reads the surface file of a [mesh]; `unit` [m] is the length of one unit of the file. core reads no files. Empty: such tools are
  /// errors.
  std::function<Result<SurfaceMesh>(const std::string& path, double unit)> read_mesh = nullptr;
};

/// @returns nothing if an issue was pushed. Allocates; not for the servo path.
[[nodiscard]] std::optional<Tool> make_tool(const TomlDocument& document, const ToolOptions& options, Issues& issues);

/// @returns what is repaired in the surface file of a [mesh] (core/tool/join_rounded.h), one sentence; empty: nothing, or the file cannot be
/// read.
[[nodiscard]] std::string find_tool_repair(const TomlDocument& document, const ToolOptions& options);

/// Reads the file at `path` and makes the tool. A file that cannot be read or parsed is an issue.
[[nodiscard]] std::optional<Tool> load_tool(const std::string& path, const ToolOptions& options, Issues& issues);

}  // namespace burrhole
