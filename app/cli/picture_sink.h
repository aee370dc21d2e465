/// app/cli/picture_sink.h: a picture sink on the offscreen renderer; writes PNG files into one folder.   Thread  main; owns the GL context.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/job/picture_sink.h"
#include "app/view/color_bar.h"
#include "app/view/tip_slices.h"

namespace burrhole {
class GlContext;
class Renderer;
}  // namespace burrhole

namespace burrhole::cli {

class FilmWriter;

struct PictureOptions {
  std::string folder;                                ///< of the pictures; empty: none is written
  std::string gl = "auto";                           ///< value of --gl
  std::string shader_folder{};                       ///< value of --shader-dir; empty: the built-in shaders
  FilmWriter* film = nullptr;                        ///< receives the frames of a film; must outlive the sink
  std::function<void(const std::string&)> report{};  ///< receives one line when a budget has chosen the quality; may be empty
  std::optional<ColorBar> bar{};                     ///< drawn into each picture
};

/// A sink, and the renderer that it owns.
struct DrawingSink {
  std::unique_ptr<PictureSink> sink;
  Renderer* renderer = nullptr;
};
/// The sink of a window, which draws in the window's context. Errors as make_picture_sink().
[[nodiscard]] Result<DrawingSink> make_window_sink(const DisplayConfig& display, const PictureOptions& options, GlContext context);
/// @param display how bone is drawn. @returns unavailable without such an OpenGL context or in a build without renderer; bad_input for an
/// invalid shader.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig& display, const PictureOptions& options);

/// @returns unavailable if the pixels of a picture are predicted to need more memory than there is; it is checked before anything is drawn.
[[nodiscard]] Status check_picture_memory(const DisplayConfig& display);

/// Writes slices with labels, the tool's outline and a scale bar into a PNG file; needs no OpenGL. @param make makes the slices of a size
/// [pixels]. bad_input: the file cannot be written.
[[nodiscard]] Status write_tip_slices(const std::string& file, int width, int height, const std::function<TipSlices(int size)>& make,
                                      const std::vector<std::string>& legend);

}  // namespace burrhole::cli
