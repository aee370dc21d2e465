/// app/cli/volume_picture.h: pictures of a bone without a scene, as PNG files.
///   Errors  unavailable without OpenGL, or in a build without renderer; bad_input.   Thread  main; owns the GL context.
#pragma once

#include <string>

#include "app/view/display_config.h"
#include "app/view/whole_bone.h"
#include "core/base/result.h"
#include "core/voxel/bone_model.h"

namespace burrhole::cli {

struct VolumePicture {
  DisplayConfig display;  ///< method, quality, size, scale bar, directions of the patient
  OuterView view;
  std::string gl = "auto", shader_folder{};  ///< values of --gl and --shader-dir
};

/// Draws all of a bone from outside, with scale bar and the directions of the patient. @returns the name of the renderer.
[[nodiscard]] Result<std::string> write_volume_picture(const std::string& file, const BoneModel& bone, const VolumePicture& picture);

/// Draws a sheet: axial, coronal and sagittal slices through the middle of a box, the bone from outside, and the box in each.
/// @param box in the bone frame, around the bone or its largest part.
[[nodiscard]] Result<std::string> write_volume_sheet(const std::string& file, const BoneModel& bone, const Bounds& box,
                                                     const VolumePicture& picture);

}  // namespace burrhole::cli
