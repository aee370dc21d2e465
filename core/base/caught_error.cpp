#include "core/base/caught_error.h"

#include <cerrno>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

namespace burrhole {
namespace {

Error no_memory() {
  return {ErrorCode::unavailable,
          "there is not enough memory: close other programs, raise the limit (ulimit -v), or take a coarser spacing or a smaller picture",
          {}};
}

Error refused(const std::string& why) {
  return {
      ErrorCode::unavailable, "the system refused a thread or another resource: " + why + ": raise its limit (ulimit -u, ulimit -v)", {}};
}

}  // namespace

Error caught_error() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return no_memory();
  } catch (const std::length_error&) {  // an array of more elements than any memory has
    return no_memory();
  } catch (const std::filesystem::filesystem_error& error) {
    return bad_input(error.code().message(), error.path1().string());
  } catch (const std::system_error& error) {
    return refused(error.code().message());
  } catch (const std::exception& error) {
    // TBB reports a thread that it did not get as a std::runtime_error with the system's text.
    const std::string text = error.what();
    for (const int refusal : {EAGAIN, ENOMEM})
      if (text.ends_with(std::generic_category().message(refusal))) return refused(std::generic_category().message(refusal));
    return {ErrorCode::internal, std::string("internal error: ") + error.what(), {}};
  } catch (...) {
    return {ErrorCode::internal, "internal error: an exception of an unknown type", {}};
  }
}

Error error_of(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (...) {
    return caught_error();
  }
}

}  // namespace burrhole
