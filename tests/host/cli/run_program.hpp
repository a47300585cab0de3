// Runs a program as a user would, and gives what it said.
#pragma once

#include <string>
#include <vector>

namespace furcula::test {

struct Ran {
  /// Exit status; 128 + signal if one ended it; -1 if it ran longer than the limit and was ended.
  int status;
  std::string out;
  std::string err;
};

/// Runs `program` with arguments (no shell), stdin empty, and waits for its end.
Ran run_program(const std::string& program, const std::vector<std::string>& arguments, int limit_s = 60);

/// Runs `furcula` of this build.
Ran run_furcula(const std::vector<std::string>& arguments, int limit_s = 60);

/// A folder under the system's temporary folder, removed with all in it at the end of the object's life.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Writes a file in the folder and gives its path.
  std::string file(const std::string& name, const std::string& content) const;
  /// Names of the files in the folder, sorted.
  std::vector<std::string> names() const;

 private:
  std::string path_;
};

}  // namespace furcula::test
