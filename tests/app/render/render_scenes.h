/// tests/app/render/render_scenes.h: small volumes with a closed form, and renderers for tests.
#pragma once

#include <functional>

#include "app/render/renderer.h"
#include "app/view/view.h"

namespace burrhole::test {

/// Signed distance [m] of a point in the bone frame, positive inside.
using Distance = std::function<double(const Vec3&)>;
using Coloring = std::function<Rgba8(const Vec3&)>;

struct VolumeRecipe {
  Vec3i dims{64};
  Affine bone_from_index;
  Distance bone;
  Distance soft;   ///< empty: none
  Coloring color;  ///< empty: ivory
};

/// Occupancy is a ramp two voxel edges wide whose 0.5 level is the zero of the distance; normals are its exact downhill directions.
[[nodiscard]] VolumeView make_volume(const VolumeRecipe& recipe);

/// Cube of 64^3 voxels of 0.5 mm round the origin of the bone frame.
[[nodiscard]] Affine half_millimetre_cube(const Vec3i& dims = Vec3i(64));

/// A ball of 8 mm over a plate, as one body.
[[nodiscard]] VolumeView ball_on_plate();

/// Camera 0.12 m away that sees the whole cube.
[[nodiscard]] FrameView oblique_view();

/// Square of edge 2 * half, facing +z and -z, at height z in the tool frame.
[[nodiscard]] TriangleMesh square(double half, double z);

/// Where the tests' OpenGL comes from: $BURRHOLE_TEST_GL (osmesa, egl or window), osmesa without it. Tests run once over each.
[[nodiscard]] GlBackend tested_backend();

/// A renderer over that, or the end of the program with 77 (skipped) where there is no such context.
[[nodiscard]] Renderer require_renderer(RenderOptions options = {.finish = false});

/// @returns a folder of the build, one for each name and back end, with the built-in shaders, in `file` the first occurrence of `right`
/// replaced by `wrong`.
[[nodiscard]] std::string changed_shaders(const std::string& name, const std::string& file, const std::string& right,
                                          const std::string& wrong);

/// The texels of a box, as update() takes them.
[[nodiscard]] TexelBox texels_of(const VolumeView& volume, const VoxelBox& box);

}  // namespace burrhole::test
