// Writes a file whole or not at all.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace furcula::core {

/// A result could not be written where it was asked for. Ends a command with exit status 2.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes `content` into a temporary file beside `path` and renames it: a reader sees the old file or the new
/// one, never a part. A device or pipe (/dev/stdout) is written to as it is. @throws OutputError.
void write_file_atomically(const std::string& path, std::string_view content);

struct NewFile {
  std::string path;
  std::string content;
};

/// Writes the files of one result together, and removes `obsolete` ones of an earlier result, where they are.
/// All that can fail for want of room or permission is done before the first old file is replaced, and what is
/// replaced is put back where a later one fails: after an error the old files are whole, and none is new. No
/// signal but SIGKILL ends the program between the first and the last; a kill or a power cut in these
/// microseconds can leave some files old and some new, each of them whole. @throws OutputError.
void write_files_together(std::span<const NewFile> files, std::span<const std::string> obsolete = {});

}  // namespace furcula::core
