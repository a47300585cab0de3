// Writes a file whole or not at all.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace furcula::log {

/// A result could not be written where it was asked for. Ends a command with exit status 2.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes `content` into a temporary file beside `path` and renames it: a reader sees the old file or the new
/// one, never a part. A device or pipe (/dev/stdout) is written to as it is. @throws OutputError.
void write_file_atomically(const std::string& path, std::string_view content);

}  // namespace furcula::log
