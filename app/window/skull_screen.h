/// app/window/skull_screen.h: the page on which a person chooses a place on the bone of a scan: picture, slices, figures and buttons.
///   Frame  bone frame.   Units  SI; pixels.   Errors  those of Renderer.   Thread  the one that draws.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/window/gui.h"
#include "app/window/skull_pointer.h"
#include "app/window/skull_view.h"
#include "volumes/import_bone.h"

namespace burrhole {

class SkullScreen {
 public:
  enum class Answer { none, starts, leaves };

  /// @param gui must outlive the screen. @param bit, solid as ChooserConfig.
  [[nodiscard]] static Result<std::unique_ptr<SkullScreen>> create(GlContext context, const Gui& gui, const TriangleMesh& bit,
                                                                   const TriangleMesh& solid);
  /// Shows a bone, with the bit at the first region that has bone.
  [[nodiscard]] Status show(ImportedBone bone, const SkullSource& source);
  void handle(const WindowEvent& event, bool taken) { pointer_->handle(event, taken); }
  void step(double dt) { pointer_->step(dt); }
  [[nodiscard]] const std::optional<DrillSite>& site() const noexcept { return pointer_->site(); }

  void draw_picture(int width, int height);
  /// Between Gui::begin() and Gui::end().
  Answer draw_panel(int width, int height);

 private:
  explicit SkullScreen(const Gui& gui, std::unique_ptr<SkullView> view) : gui_(&gui), view_(std::move(view)) {}
  void draw_figures();
  void draw_regions();
  Answer draw_buttons();
  /// A button presses a key.
  void press(Key key);

  const Gui* gui_;
  std::unique_ptr<SkullView> view_;
  std::unique_ptr<SkullPointer> pointer_;
  ImportReport report_;
  std::string name_, failure_;
};

}  // namespace burrhole
