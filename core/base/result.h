/// core/base/result.h: errors of input and environment (file, scene, command line, device) as values. BH_ASSERT checks our own code.
///   Errors  ErrorCode gives the class; the message is one line.   Thread  any: values.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace burrhole {

/// The exit code of the program follows from the error code: bad_input 2, out_of_range 2, check_failed 3, unavailable 4, internal 1.
enum class ErrorCode { bad_input, out_of_range, unavailable, check_failed, internal };

/// One error, one line. `place` is "file:line:column", "file" or empty.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
  std::string place;

  [[nodiscard]] std::string text() const { return place.empty() ? message : place + ": " + message; }
};

/// A value or an Error. Call ok() first: value() on an error and error() on a value throw std::bad_variant_access.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }
  [[nodiscard]] T& value() & { return std::get<0>(state_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(state_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(state_)); }
  [[nodiscard]] const Error& error() const { return std::get<1>(state_); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }

 private:
  std::variant<T, Error> state_;
};

/// Success or an Error. error() is valid only if ok() is false.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : error_(std::move(error)) {}
  [[nodiscard]] bool ok() const noexcept { return !error_.has_value(); }
  explicit operator bool() const noexcept { return ok(); }
  [[nodiscard]] const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

[[nodiscard]] inline Error bad_input(std::string message, std::string place = {}) {
  return {ErrorCode::bad_input, std::move(message), std::move(place)};
}

}  // namespace burrhole
