#include <doctest/doctest.h>

#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "core/base/caught_error.h"

using namespace burrhole;

namespace {

template <class Exception>
Error error_of(const Exception& exception) {
  try {
    throw exception;
  } catch (...) {
    return caught_error();
  }
}

}  // namespace

TEST_CASE("caught_error: memory and threads are unavailable, a path is bad input, the rest is internal") {
  CHECK(error_of(std::bad_alloc()).code == ErrorCode::unavailable);
  CHECK(error_of(std::length_error("vector")).code == ErrorCode::unavailable);
  CHECK(error_of(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))).code == ErrorCode::unavailable);
  const Error path = error_of(std::filesystem::filesystem_error("status", "/a/b", std::make_error_code(std::errc::filename_too_long)));
  CHECK(path.code == ErrorCode::bad_input);
  CHECK(path.text() == "/a/b: File name too long");
  CHECK(error_of(std::runtime_error("pthread_create has failed: Resource temporarily unavailable")).code == ErrorCode::unavailable);
  CHECK(error_of(std::runtime_error("x")).code == ErrorCode::internal);
  CHECK(error_of(7).code == ErrorCode::internal);
  CHECK(error_of(std::make_exception_ptr(std::bad_alloc())).code == ErrorCode::unavailable);
}
