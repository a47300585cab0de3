// Errors without exceptions: a status, and a value or a status.
#pragma once

#include <cstdint>

namespace furcula {

/// Outcome of a function that can fail.
enum class [[nodiscard]] Status : std::uint8_t{
    ok = 0,
    disconnected = 1,  ///< the peer did not answer; asking again on the next tick is right
    invalid = 2,       ///< a value makes no sense; asking again changes nothing
};

/// A value, or the status that says why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  /// A value, with status ok. Implicit, so that a function can return the value itself.
  constexpr Result(const T& value) : value_(value) {}
  /// `status` is not ok.
  constexpr Result(Status status) : status_(status) {}

  /// Whether there is a value.
  constexpr bool ok() const { return status_ == Status::ok; }
  /// ok, or why there is no value.
  constexpr Status status() const { return status_; }
  /// Only where ok().
  constexpr const T& value() const { return value_; }

 private:
  T value_{};
  Status status_ = Status::ok;
};

}  // namespace furcula
