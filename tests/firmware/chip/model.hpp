// A register as the host's tests have it: a word that may answer reads and writes as the peripheral would.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace furcula::test {

/// Without hooks it keeps what is written. A hook is what the reference manual says about the register's
/// bits.
class Register {
 public:
  operator std::uint32_t() const { return on_read ? on_read(value) : value; }
  Register& operator=(std::uint32_t written) {
    writes.push_back(written);
    value = on_write ? on_write(value, written) : written;
    return *this;
  }
  Register& operator=(const Register&) = delete;
  Register() = default;

  std::uint32_t value = 0;
  std::vector<std::uint32_t> writes;  ///< all of them, the first first
  std::function<std::uint32_t(std::uint32_t value)> on_read;
  std::function<std::uint32_t(std::uint32_t old, std::uint32_t written)> on_write;
};

/// A flag that comes so many reads after it became due.
class LateFlag {
 public:
  explicit LateFlag(int polls) : polls_(polls) {}
  bool operator()() { return polls_ <= 0 || --polls_ <= 0; }

 private:
  int polls_;
};

}  // namespace furcula::test
