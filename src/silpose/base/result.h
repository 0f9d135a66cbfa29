// Result<T>: a value, or the reason why the outside world (a file, a device, a setting) did not give one.
// The caller's own mistakes are not Results: they throw std::invalid_argument (check.h).
// Threads: values, as safe as T.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace silpose {

// One line that names the thing and what is wrong with it: "walk.mp4: not a video".
struct Error {
  std::string message;
};

// Makes an Error from a format string: `return error("{}: no such file", path);`
template <class... Args>
[[nodiscard]] tl::unexpected<Error> error(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected<Error>(Error{fmt::format(format, std::forward<Args>(args)...)});
}

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : expected_(std::move(value)) {}                                 // NOLINT: implicit by design
  Result(tl::unexpected<Error> failure) : expected_(std::move(failure)) {}         // NOLINT: implicit by design
  Result(Error failure) : expected_(tl::unexpected<Error>(std::move(failure))) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return expected_.has_value(); }
  explicit operator bool() const { return ok(); }

  // The value. Errors: throws std::runtime_error with the message.
  // A temporary gives value, content and error away by value: `for (x : f().value())` and `const auto& x = *f();` are
  // safe. What is inside the value and reached by a call dies with it: `for (x : f().value().members())` is not.
  T& value() & { return throw_unless_ok(), *expected_; }
  const T& value() const& { return throw_unless_ok(), *expected_; }
  T value() && { return throw_unless_ok(), std::move(*expected_); }

  // REQUIRES: ok().
  T& operator*() & { return *expected_; }
  const T& operator*() const& { return *expected_; }
  T operator*() && { return std::move(*expected_); }
  T* operator->() { return &*expected_; }
  const T* operator->() const { return &*expected_; }

  // REQUIRES: !ok().
  [[nodiscard]] const Error& error() const& { return expected_.error(); }
  [[nodiscard]] Error error() && { return std::move(expected_.error()); }

  // Passes a failure on as another type's: `if (!mesh) return mesh.failure();`
  [[nodiscard]] tl::unexpected<Error> failure() const { return tl::unexpected<Error>(expected_.error()); }

 private:
  void throw_unless_ok() const {
    if (!ok()) throw std::runtime_error(expected_.error().message);
  }
  tl::expected<T, Error> expected_;
};

// A Result without a value: `return {};` is success.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(tl::unexpected<Error> failure) : expected_(std::move(failure)) {}         // NOLINT: implicit by design
  Result(Error failure) : expected_(tl::unexpected<Error>(std::move(failure))) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return expected_.has_value(); }
  explicit operator bool() const { return ok(); }
  void value() const {
    if (!ok()) throw std::runtime_error(expected_.error().message);
  }
  [[nodiscard]] const Error& error() const& { return expected_.error(); }
  [[nodiscard]] Error error() && { return std::move(expected_.error()); }
  [[nodiscard]] tl::unexpected<Error> failure() const { return tl::unexpected<Error>(expected_.error()); }

 private:
  tl::expected<void, Error> expected_;
};

}  // namespace silpose
