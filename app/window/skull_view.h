/// app/window/skull_view.h: draws the bone of a scan from outside, with a bit at the chosen site, and three slices there.
///   Frame  bone frame, which is also the world's.   Units  SI; pixels.   Errors  those of Renderer.   Thread  that of the context.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "app/render/picture_texture.h"
#include "app/render/renderer.h"
#include "app/window/skull_pointer.h"

namespace burrhole {

class SkullView {
 public:
  /// @param bit as drawn. @param solid as it erodes, for the slices.
  [[nodiscard]] static Result<std::unique_ptr<SkullView>> create(GlContext context, const TriangleMesh& bit, TriangleMesh solid);
  [[nodiscard]] const GlContext& context() const noexcept { return renderer_.context(); }
  /// Replaces the bone. One that is too large for a texture is drawn at coarser voxels.
  [[nodiscard]] Status set_bone(const BoneModel& bone);
  /// Draws what has changed: with fewer rays while the view moves, then as the pictures of a run.
  [[nodiscard]] Status draw(const SkullPointer& pointer, int width, int height);

  [[nodiscard]] const PictureTexture& picture() const noexcept { return picture_; }
  [[nodiscard]] const PictureTexture& slices() const noexcept { return slices_; }
  /// @returns the entry of the site that the slices show.
  [[nodiscard]] const std::optional<Vec3>& sliced() const noexcept { return sliced_; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  SkullView(Renderer renderer, TriangleMesh solid);
  [[nodiscard]] Status draw_slices(const std::optional<DrillSite>& site, int size);

  Renderer renderer_;
  TriangleMesh solid_;
  PictureTexture picture_, slices_;
  DynamicResolution pace_;
  std::optional<CameraView> camera_;
  std::optional<Vec3> entry_, sliced_;
  int width_ = 0, height_ = 0, slice_size_ = 0;
  bool coarse_ = false, fine_ = false;
  Time changed_{};
};

}  // namespace burrhole
