// UTF-16 to UTF-8, see utf8_source.hpp.
#include "host/log/utf8_source.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace furcula::log {
namespace {

constexpr std::uint32_t kReplacement = 0xFFFD;

}  // namespace

void Utf8Source::append(std::uint32_t c) {
  const auto byte = [this](std::uint32_t b) { out_ += static_cast<char>(b); };
  if (c < 0x80) {
    byte(c);
  } else if (c < 0x800) {
    byte(0xC0 | (c >> 6));
    byte(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    byte(0xE0 | (c >> 12));
    byte(0x80 | ((c >> 6) & 0x3F));
    byte(0x80 | (c & 0x3F));
  } else {
    byte(0xF0 | (c >> 18));
    byte(0x80 | ((c >> 12) & 0x3F));
    byte(0x80 | ((c >> 6) & 0x3F));
    byte(0x80 | (c & 0x3F));
  }
}

void Utf8Source::take_unit(std::uint32_t unit) {
  const bool low = unit >= 0xDC00 && unit < 0xE000;
  if (high_ != 0) {
    if (low)
      append(0x10000 + ((high_ - 0xD800) << 10) + (unit - 0xDC00));
    else
      append(kReplacement);
    high_ = 0;
    if (low) return;
  }
  if (unit >= 0xD800 && unit < 0xDC00)
    high_ = unit;
  else
    append(low ? kReplacement : unit);
}

void Utf8Source::convert(const char* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    if (has_odd_) {
      const unsigned first = odd_, second = byte;
      take_unit(encoding_ == Encoding::utf16_little ? first | (second << 8) : (first << 8) | second);
    } else {
      odd_ = byte;
    }
    has_odd_ = !has_odd_;
  }
}

void Utf8Source::find_encoding() {
  std::array<char, 4> head{};
  std::size_t n = 0;
  while (n < head.size()) {
    const std::size_t got = source_.read(head.data() + n, head.size() - n);
    if (got == 0) break;
    n += got;
  }
  const auto is = [&](std::size_t i, unsigned value) { return static_cast<unsigned char>(head[i]) == value; };
  const auto zero = [&](std::size_t i) { return head[i] == '\0'; };
  std::size_t mark = 2;
  if (n >= 2 && is(0, 0xFF) && is(1, 0xFE)) {
    encoding_ = Encoding::utf16_little;
  } else if (n >= 2 && is(0, 0xFE) && is(1, 0xFF)) {
    encoding_ = Encoding::utf16_big;
  } else if (n == 4 && !zero(0) && zero(1) && !zero(2) && zero(3)) {
    encoding_ = Encoding::utf16_little;
    mark = 0;
  } else if (n == 4 && zero(0) && !zero(1) && zero(2) && !zero(3)) {
    encoding_ = Encoding::utf16_big;
    mark = 0;
  } else {
    encoding_ = Encoding::utf8;
    mark = n >= 3 && std::memcmp(head.data(), "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    out_.assign(head.data() + mark, n - mark);
    return;
  }
  convert(head.data() + mark, n - mark);
}

std::size_t Utf8Source::read(char* to, std::size_t size) {
  if (encoding_ == Encoding::unknown) find_encoding();
  while (begin_ == out_.size()) {
    if (encoding_ == Encoding::utf8) return source_.read(to, size);
    out_.clear();
    begin_ = 0;
    std::array<char, 16384> bytes;
    const std::size_t n = source_.read(bytes.data(), bytes.size());
    if (n != 0) {
      convert(bytes.data(), n);
      continue;
    }
    if (high_ != 0 || has_odd_) append(kReplacement);
    high_ = 0;
    has_odd_ = false;
    if (out_.empty()) return 0;
  }
  const std::size_t n = std::min(size, out_.size() - begin_);
  std::memcpy(to, out_.data() + begin_, n);
  begin_ += n;
  return n;
}

}  // namespace furcula::log
