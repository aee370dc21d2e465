#include "app/render/gl_context.h"

#include <doctest/doctest.h>

#include <cstdlib>

#include "tests/app/render/render_scenes.h"

using namespace burrhole;

TEST_CASE("context: it is OpenGL 4.5 core, and a second one beside it works") {
  const Renderer first = test::require_renderer();
  CHECK(first.driver().starts_with("4.5"));
  auto second = GlContext::create(8, 8);
  REQUIRE(second.ok());
  CHECK(second.value().version().starts_with("4.5"));
  GlContext moved = std::move(second).value();
  CHECK(moved.make_current().ok());
}

TEST_CASE("context: a surface without pixels is refused") {
  CHECK(GlContext::create(0, 8).error().code == ErrorCode::out_of_range);
  CHECK(GlContext::create(8, 100'000).error().code == ErrorCode::out_of_range);
}

TEST_CASE("context: a driver name that Mesa would crash on is refused in words") {
  REQUIRE(setenv("GALLIUM_DRIVER", "no-such-driver", 1) == 0);
  const auto context = GlContext::create(8, 8);
  unsetenv("GALLIUM_DRIVER");
  REQUIRE_FALSE(context.ok());
  CHECK(context.error().code == ErrorCode::unavailable);
  CHECK(context.error().message.find("GALLIUM_DRIVER") != std::string::npos);
}
