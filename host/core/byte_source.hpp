// Where bytes come from: a file or a text in memory.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace furcula::core {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Up to `size` bytes into `to`; 0 at the end.
  virtual std::size_t read(char* to, std::size_t size) = 0;
};

/// An open file, or a pipe (/dev/stdin, a shell's <(...), a FIFO) that a program writes to, however slowly.
/// @throws DataError, at opening and reading: not there, not readable, a directory, a FIFO that nobody has
/// opened for writing after kWriterWait. `what` says what was expected, as in "a log".
class FileSource final : public ByteSource {
 public:
  static constexpr std::chrono::milliseconds kWriterWait{2000};

  FileSource(const std::string& path, std::string_view what);
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  std::size_t read(char* to, std::size_t size) override;

 private:
  void wait_for_writer();

  std::string path_;
  std::string what_;
  int fd_;
  std::string ahead_;  ///< read already, from a pipe
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

}  // namespace furcula::core
