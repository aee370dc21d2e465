#include "app/cli/volume_picture.h"

#include <fmt/format.h>

#include "app/cli/picture_sink.h"
#include "app/render/marks.h"
#include "app/render/overlay.h"
#include "app/render/png.h"
#include "app/render/renderer.h"
#include "app/render/tip_slices_picture.h"

namespace burrhole::cli {
namespace {

struct Drawn {
  Image image;
  FrameView frame;
  std::string driver;
};

RenderOptions options_of(const VolumePicture& picture) {
  const DisplayConfig& display = picture.display;
  RenderOptions out = make_render_options(display.quality, display.appearance);
  out.shader_folder = picture.shader_folder;
  for (const GlBackend backend : gl_backends())
    if (picture.gl == gl_backend_name(backend)) out.gl = backend;
  if (display.method == "slices") out.slices = SliceOptions{.per_voxel = display.slices_per_voxel, .correct = display.opacity_correction};
  out.mesh = display.method == "mesh";
  return out;
}

Result<Drawn> draw_outside(const BoneModel& bone, const VolumePicture& picture, std::span<const Vec3> shown, int width, int height) {
  DisplayConfig shape = picture.display;
  shape.width = width, shape.height = height;
  if (Status fits = check_picture_memory(shape); !fits) return fits.error();
  const RenderOptions options = options_of(picture);
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  const auto view = make_whole_view(bone, picture.display.whole_voxels, options.appearance.tissue);
  if (!view) return view.error();
  if (Status set = renderer->set_volume(*view); !set) return set.error();
  FrameView frame = make_outer_frame(bounds_of_bone(bone), shown, picture.view, static_cast<double>(width) / height);
  frame.background = picture.display.background;
  auto image = renderer->draw(frame, width, height);
  if (!image) return image.error();
  Drawn out{std::move(image).value(), frame, renderer->driver()};
  if (picture.display.orientation) draw_orientation(out.image, frame.camera, frame.world_from_bone);
  return out;
}

std::string bounds_text(const Bounds& box) {
  const Vec3 lo = box.lo / kMillimetre, hi = box.hi / kMillimetre;
  return fmt::format("bone: x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f} mm; x to the left, y posterior, z superior", lo.x,
                     hi.x, lo.y, hi.y, lo.z, hi.z);
}

}  // namespace

Result<std::string> write_volume_picture(const std::string& file, const BoneModel& bone, const VolumePicture& picture) {
  auto drawn = draw_outside(bone, picture, outline_points(bone), picture.display.width, picture.display.height);
  if (!drawn) return drawn.error();
  if (picture.display.scale_bar) draw_scale_bar(drawn->image, fit_scale_bar(drawn->frame.camera, drawn->image.width, drawn->image.height));
  if (Status written = write_png(file, drawn->image); !written) return written.error();
  return drawn->driver;
}

Result<std::string> write_volume_sheet(const std::string& file, const BoneModel& bone, const Bounds& box, const VolumePicture& picture) {
  const int width = picture.display.width, height = picture.display.height;
  const double letter = std::max(8.0, height / 80.0);
  const int below = static_cast<int>(2.4 * letter);
  const CellLayout layout = square_cells(width, height, below);
  Image sheet = draw_tip_slices(make_middle_slices(bone, box, layout.size), layout, {});
  auto drawn = draw_outside(bone, picture, bounds_of_bone(bone).corners(), layout.size, layout.size);
  if (!drawn) return drawn.error();
  draw_box(drawn->image, drawn->frame.camera, box);
  const int step = layout.size + layout.gap;
  copy_into(sheet, drawn->image, layout.left + step, layout.top + step);
  const std::string text = bounds_text(box);
  const double fitted = std::min(letter, letter * (width - 2.0 * letter) / std::max(1.0, text_width(text, letter)));
  draw_text(sheet, text, {0.5 * (width - text_width(text, fitted)), height - 0.5 * below + 0.2 * letter}, fitted);
  if (Status written = write_png(file, sheet); !written) return written.error();
  return drawn->driver;
}

}  // namespace burrhole::cli
