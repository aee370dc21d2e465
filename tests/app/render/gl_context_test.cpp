#include "app/render/gl_context.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <iostream>
#include <optional>

#include "app/render/gl_platform.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"
#include "tests/support/skip.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Sets a variable of the environment for a scope; without a value it is taken out.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    set(value);
  }
  ~ScopedVariable() { set(old_ ? old_->c_str() : nullptr); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  void set(const char* value) const {
    if (value == nullptr)
      unsetenv(name_);
    else
      setenv(name_, value, 1);
  }
  const char* name_;
  std::optional<std::string> old_;
};

bool is_one_line_with(const Error& error, const std::string& word) {
  return error.code == ErrorCode::unavailable && error.message.find(word) != std::string::npos &&
         error.message.find('\n') == std::string::npos;
}

constexpr GlBackend kBackends[] = {GlBackend::osmesa, GlBackend::egl, GlBackend::window};

}  // namespace

TEST_CASE("context: it is OpenGL 4.5 core or newer, and a second one beside it works") {
  const Renderer first = require_renderer();
  CHECK(first.driver().starts_with(std::string(gl_backend_name(tested_backend())) + ": 4."));
  auto second = GlContext::create(8, 8, tested_backend());
  REQUIRE(second.ok());
  CHECK(second.value().version() >= "4.5");
  GlContext moved = std::move(second).value();
  CHECK(moved.make_current().ok());
  CHECK(moved.backend() == tested_backend());
}

TEST_CASE("context: a surface without pixels is refused") {
  CHECK(GlContext::create(0, 8).error().code == ErrorCode::out_of_range);
  CHECK(GlContext::create(8, 100'000).error().code == ErrorCode::out_of_range);
}

TEST_CASE("context: a driver name that Mesa would crash on is refused in words") {
  static_cast<void>(require_renderer());
  const ScopedVariable driver("GALLIUM_DRIVER", "no-such-driver");
  const auto context = GlContext::create(8, 8, tested_backend());
  if (context.ok()) {  // a GPU, which that name does not concern
    CHECK(tested_backend() == GlBackend::egl);
    return;
  }
  CHECK(is_one_line_with(context.error(), "GALLIUM_DRIVER"));
}

// Mesa reads that variable once a process, so ctest sets it for a run of this case alone.
TEST_CASE("context: a driver that is too old is refused in words") {
  if (std::getenv("MESA_GL_VERSION_OVERRIDE") == nullptr) return;
  int old = 0;
  for (const GlBackend backend : kBackends) {
    const auto context = GlContext::create(8, 8, backend);
    REQUIRE_FALSE(context.ok());
    CHECK(is_one_line_with(context.error(), std::string(gl_backend_name(backend)) + ": "));
    if (is_one_line_with(context.error(), "4.5")) ++old;
  }
  if (old == 0) test::skip("no driver here is Mesa's");
}

TEST_CASE("context: without a display a window is refused in words, and nothing else is") {
  if (tested_backend() == GlBackend::window) return;  // GLFW keeps the display that it found
  const ScopedVariable display("DISPLAY", nullptr);
  const auto window = GlContext::create(8, 8, GlBackend::window);
  REQUIRE_FALSE(window.ok());
  // Built without it, without its library, or without a display: each says so.
  CHECK(is_one_line_with(window.error(), "window: "));
  CHECK(require_renderer().driver().find("4.") != std::string::npos);
}

TEST_CASE("context: a library that is not there is named with its package") {
  const auto library = open_gl_library("libno-such-thing.so.7", "libno-such-thing7");
  REQUIRE_FALSE(library.ok());
  CHECK(is_one_line_with(library.error(), "libno-such-thing.so.7 (Debian: libno-such-thing7)"));
}

// The drivers of Mesa share shaders, compiler and rasteriser: 0 bytes may differ. With a GPU behind egl or the window filtering differs by
// the hardware's own weights: then a level of 3 on all but silhouettes, as between the shader and its slow twin.
TEST_CASE("context: every back end that exists here draws the same bytes, one after the other and in turns") {
  struct Drawn {
    std::string driver;
    Renderer renderer;
    Image image;
  };
  std::vector<Drawn> drawn;
  for (const GlBackend backend : kBackends) {
    auto renderer = Renderer::create({.finish = true, .appearance = {.occlusion = true, .shadow = true, .specular = true}, .gl = backend});
    if (!renderer) {
      REQUIRE(renderer.error().code == ErrorCode::unavailable);
      std::cerr << "left out: " << renderer.error().message << '\n';
      continue;
    }
    REQUIRE(renderer.value().set_volume(ball_on_plate()).ok());
    REQUIRE(renderer.value().set_tool(square(3e-3, 12e-3)).ok());
    drawn.push_back({renderer.value().driver(), std::move(renderer).value(), {}});
  }
  if (drawn.empty()) test::skip("no back end of OpenGL can be made here");
  FrameView view = oblique_view();
  view.world_from_tool = Pose{};
  for (int turn = 0; turn < 2; ++turn)
    for (Drawn& one : drawn) {
      auto image = one.renderer.draw(view, 160, 120);
      REQUIRE(image.ok());
      if (turn == 0) one.image = std::move(image).value();
      if (turn == 1) CHECK(pictures_agree("in-turns", image.value(), one.image, {}));
    }
  for (const Drawn& one : drawn) {
    const bool software = one.driver.find("llvmpipe") != std::string::npos && drawn.front().driver.find("llvmpipe") != std::string::npos;
    const PictureTolerance tolerance = software ? PictureTolerance{} : PictureTolerance{.level = 3, .share = 0.01};
    std::cerr << one.driver << ": " << 100.0 * compare_pictures(one.image, drawn.front().image, 0).differing_share
              << " % of the pixels differ from " << drawn.front().driver << '\n';
    CHECK(pictures_agree("back-ends", one.image, drawn.front().image, tolerance));
  }
  // The comparison notices a light moved by a degree.
  view.light.direction_to_light += 0.02 * Vec3(1.0, 1.0, 0.0);
  const auto lit = drawn.front().renderer.draw(view, 160, 120);
  REQUIRE(lit.ok());
  CHECK(compare_pictures(lit.value(), drawn.front().image, 0).differing_share > 0.05);
}
