// Reads numbers from bytes, in bounds: MCAP's records (little-endian, without gaps) and CDR (aligned, of either byte order).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

namespace furcula::bags {

/// The bytes end before what should be there.
struct Cut {};

/// @throws Cut
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}

  /// CDR: numbers are aligned to their size, `largest` at most, from the first byte on.
  void align_to(std::size_t largest) { largest_ = largest; }
  void swap_bytes(bool swap) { swap_ = swap; }

  std::size_t left() const { return bytes_.size() - at_; }

  std::string_view take(std::size_t size) {
    if (size > left()) throw Cut{};
    const std::string_view out = bytes_.substr(at_, size);
    at_ += size;
    return out;
  }

  template <class T>
  T number() {
    align(sizeof(T));
    T value;
    const std::string_view from = take(sizeof(T));
    if (!swap_) {
      std::memcpy(&value, from.data(), sizeof(T));
      return value;
    }
    char turned[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) turned[i] = from[sizeof(T) - 1 - i];
    std::memcpy(&value, turned, sizeof(T));
    return value;
  }

  /// `count` numbers of `size` bytes. Where there are none, nothing is aligned.
  void skip(std::uint64_t count, std::size_t size) {
    if (count == 0) return;
    align(size);
    if (count > left() / size) throw Cut{};
    at_ += static_cast<std::size_t>(count) * size;
  }

  /// A length of 32 bits and so many bytes.
  std::string_view text() { return take(number<std::uint32_t>()); }

 private:
  static_assert(std::endian::native == std::endian::little);

  void align(std::size_t size) {
    if (largest_ == 1) return;
    const std::size_t to = size < largest_ ? size : largest_;
    const std::size_t gap = (to - at_ % to) % to;
    if (gap > left()) throw Cut{};
    at_ += gap;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t largest_ = 1;
  bool swap_ = false;
};

}  // namespace furcula::bags
