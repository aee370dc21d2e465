/// app/render/added_mesh_buffer.h: the triangles that effects add to a picture, on the GPU. Internal to app/render.
///   Frame  bone frame.   Units  m.   Errors  bad_input, unavailable.
#pragma once

#include <array>
#include <cstdint>

#include "app/render/gl_object.h"
#include "app/view/added_mesh.h"
#include "core/base/result.h"

namespace burrhole {

class AddedMeshBuffer {
 public:
  /// @param version differs from that of every earlier one. @returns ErrorCode::bad_input for no triangle, colours of another number than
  /// vertices, more unlit shares than vertices, an index beyond them or a vertex that is not finite; ErrorCode::unavailable if the driver has
  /// not enough memory.
  [[nodiscard]] static Result<AddedMeshBuffer> create(const GladGLContext& gl, const AddedMesh& mesh, std::uint64_t version);
  void draw() const;
  /// Shine from which a vertex is under a film of fluid, which mirrors the room.
  static constexpr std::uint8_t kLeastWet = 128;
  /// @returns whether a vertex has it: otherwise the program that draws the mesh has no room.
  [[nodiscard]] bool is_wet() const noexcept { return is_wet_; }
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  /// @returns the corners of its bounding box [m] in the world.
  [[nodiscard]] std::array<Vec3, 8> corners_at(const Pose& world_from_bone) const noexcept;

 private:
  const GladGLContext* gl_ = nullptr;
  GlObject array_, vertices_, indices_;
  GLsizei index_count_ = 0;
  bool is_wet_ = false;
  std::uint64_t version_ = 0;
  std::array<Vec3, 8> corners_{};
};

}  // namespace burrhole
