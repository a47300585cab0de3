// Writing whole files, see atomic_file.hpp.
#include "host/log/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace furcula::log {
namespace {

[[noreturn]] void give_up(const std::string& path, int error) {
  throw OutputError(path + ": cannot be written: " + std::strerror(error));
}

// Writes everything and closes; on failure the errno, else 0.
int write_and_close(int fd, std::string_view content, bool to_disk) {
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t n = ::write(fd, content.data(), content.size());
    if (n >= 0) {
      content.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  // Without the sync a power cut after the rename could leave an empty file under the final name.
  if (error == 0 && to_disk && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view content) {
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) give_up(path, EISDIR);
  if (exists && !S_ISREG(status.st_mode)) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) give_up(path, errno);
    if (const int error = write_and_close(fd, content, false)) give_up(path, error);
    return;
  }

  // A link's target is replaced, not the link.
  std::error_code ignored;
  const std::string target = exists ? std::filesystem::canonical(path, ignored).string() : path;
  if (target.empty()) give_up(path, ENOENT);
  std::string temporary = target + ".part-XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) give_up(path, errno);
  // mkostemp gives 0600; the result shall have the old file's mode, or that of any new file.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  int error = ::fchmod(fd, exists ? status.st_mode & 07777 : 0666 & ~mask) == 0 ? 0 : errno;
  const int write_error = write_and_close(fd, content, true);
  if (error == 0) error = write_error;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    give_up(path, error);
  }
}

}  // namespace furcula::log
