// Text as UTF-8: a log in UTF-16 (Excel's "Unicode text", PowerShell's `>`) is converted while it is read.
#pragma once

#include <cstdint>
#include <string>

#include "host/core/byte_source.hpp"

namespace furcula::log {

/// Passes the bytes of `source` on, without a byte order mark, and UTF-16 as UTF-8. UTF-16 is told by its byte order mark, or by two first
/// characters of which every other byte is zero: a log begins with ASCII. Half of a surrogate pair becomes U+FFFD.
class Utf8Source final : public core::ByteSource {
 public:
  explicit Utf8Source(core::ByteSource& source) : source_(source) {}
  std::size_t read(char* to, std::size_t size) override;

 private:
  enum class Encoding { unknown, utf8, utf16_little, utf16_big };

  void find_encoding();
  void convert(const char* bytes, std::size_t size);
  void take_unit(std::uint32_t unit);
  void append(std::uint32_t code_point);

  core::ByteSource& source_;
  Encoding encoding_ = Encoding::unknown;
  std::string out_;  ///< converted, from begin_ on not yet given
  std::size_t begin_ = 0;
  bool has_odd_ = false;  ///< the first byte of a unit whose second is not read yet
  unsigned char odd_ = 0;
  std::uint32_t high_ = 0;  ///< first half of a surrogate pair; 0: none
};

}  // namespace furcula::log
