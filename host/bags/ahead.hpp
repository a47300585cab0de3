// A source whose first bytes are looked at before it is read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "host/core/byte_source.hpp"

namespace furcula::bags {

/// Bytes that were read ahead, then the source's.
class Ahead final : public core::ByteSource {
 public:
  Ahead(std::string head, core::ByteSource& source) : head_(std::move(head)), source_(source) {}
  explicit Ahead(std::unique_ptr<core::FileSource> file) : file_(std::move(file)), source_(*file_) {}

  /// The first bytes, up to `size`.
  std::string_view head(std::size_t size) {
    while (head_.size() < size) {
      const std::size_t before = head_.size();
      head_.resize(size);
      const std::size_t n = source_.read(head_.data() + before, size - before);
      head_.resize(before + n);
      if (n == 0) break;
    }
    return head_;
  }
  std::size_t read(char* to, std::size_t size) override {
    if (given_ == head_.size()) return source_.read(to, size);
    const std::size_t n = std::min(size, head_.size() - given_);
    std::memcpy(to, head_.data() + given_, n);
    given_ += n;
    return n;
  }

 private:
  std::unique_ptr<core::FileSource> file_;
  std::string head_;
  std::size_t given_ = 0;
  core::ByteSource& source_;
};

}  // namespace furcula::bags
