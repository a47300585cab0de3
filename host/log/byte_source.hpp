// Where bytes come from: a file or a text in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace furcula::log {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Up to `size` bytes into `to`; 0 at the end.
  virtual std::size_t read(char* to, std::size_t size) = 0;
};

/// An open file. @throws DataError, at opening and reading: not there, not readable, a directory. `what` says
/// what was expected, as in "a log".
class FileSource final : public ByteSource {
 public:
  FileSource(const std::string& path, std::string_view what);
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  std::size_t read(char* to, std::size_t size) override;

 private:
  std::string path_;
  std::string what_;
  int fd_;
};

class TextSource final : public ByteSource {
 public:
  explicit TextSource(std::string_view text) : text_(text) {}
  std::size_t read(char* to, std::size_t size) override {
    const std::size_t n = std::min(size, text_.size());
    if (n != 0) std::memcpy(to, text_.data(), n);
    text_.remove_prefix(n);
    return n;
  }

 private:
  std::string_view text_;
};

}  // namespace furcula::log
