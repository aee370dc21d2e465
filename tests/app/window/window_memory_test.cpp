// The drawing thread may end for want of memory. Its error must not need any. In a program of its own, since the trap replaces malloc,
// which a sanitizer does too.
#include <doctest/doctest.h>

#include <exception>
#include <new>
#include <utility>

#include "app/window/window_state.h"
#include "tests/support/memory_trap.h"

using namespace burrhole;
using namespace burrhole::test;

TEST_CASE("window state: an exception that ends the drawing is kept without memory, and named by who asks") {
  WindowState state;
  CHECK_FALSE(state.error().has_value());
  std::exception_ptr thrown = std::make_exception_ptr(std::bad_alloc());
  clear_trap();
  on_trap([&] { state.fail(std::move(thrown)); });
  CHECK(trapped().allocations == 0);
  CHECK(state.closed());
  REQUIRE(state.error().has_value());
  CHECK(state.error()->code == ErrorCode::unavailable);
  CHECK(state.error()->message.find("not enough memory") != std::string::npos);
}
