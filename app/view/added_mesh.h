/// app/view/added_mesh.h: what an effect adds to pictures beside bone and tool: triangles, and a new place of the upper face of soft tissue.
///   An effect that shows something returns a PictureSource from Effect::picture_source(). The frame step asks it in two calls:
///     copy_for_picture()  by the owner of the bone (simulation thread), between two steps: copies positions, not triangles.
///     append_mesh()       by the frame thread: makes triangles of that copy, and reads nothing that a step writes.
///   The two never run at once: in a live run by BatchHandOff (app/run/live_run.h), otherwise on one thread. So neither needs a lock. A scene
///   without such an effect has no source: no call, buffer, program or branch. A replay runs the same steps and shows the same; the file of a
///   drilled bone holds bone alone.
///   Drawn with depth where the tool is drawn, over rays and mesh alike, clipped at the cut, without shadows. Pixels that neither the last nor
///   the new mesh can cover keep the last picture.
///   Frame  bone frame.   Units  m.   Errors  bad_input where a renderer takes it.   Thread  as above.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "app/view/view.h"
#include "core/base/bounds.h"

namespace burrhole {

/// Triangles that an effect adds to a picture: opaque, coloured by vertex, lit unless `unlit` says otherwise. Normals are the means at shared vertices; give an edge that shall
/// be sharp two vertices.
struct AddedMesh {
  std::vector<glm::vec3> vertices;  ///< [m] bone frame
  std::vector<Rgba8> colors;        ///< of each vertex; a = shine 0..255 (specular of a wet surface)
  /// Of each vertex, the share 0..255 of its colour that is shown as it is, in light and in shade: for colours that are read on a scale. 0 for
  /// vertices beyond its end.
  std::vector<std::uint8_t> unlit;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside; both sides are drawn
};

/// The upper face of soft tissue where an effect moves it: pictures show the soft tissue of the bone as loaded only below it.
class SoftTop {
 public:
  virtual ~SoftTop() = default;
  /// @returns the share [-] of soft tissue that is shown at a point of the bone, 0..1. @param edge [m] of the voxels, over which it is a ramp.
  [[nodiscard]] virtual double shown(const Vec3& p_bone, double edge) const = 0;
  /// Box [m] of the points whose share differs from that before the last copy; lo above hi: none.
  [[nodiscard]] virtual Bounds changed() const = 0;
  /// Box [m] of all points whose share may be below 1.
  [[nodiscard]] virtual Bounds extent() const = 0;
};

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// Copies what the next picture shows. May allocate. @param exactly false: a change that is too small to be seen may wait, so that fewer
  /// triangles are made; true: none does, so that the picture depends on the present state alone, as a recorded still must to be drawn again by a
  /// replay, which copies at other times. @returns whether the triangles differ from those of the last copy; true at first.
  [[nodiscard]] virtual bool copy_for_picture(bool exactly) = 0;
  /// Appends the triangles of the last copy.
  virtual void append_mesh(AddedMesh& out) const = 0;
  /// @returns where soft tissue is shown; null: as loaded. Valid as long as the source, and as the last copy has it.
  [[nodiscard]] virtual const SoftTop* soft_top() const { return nullptr; }
};

}  // namespace burrhole
