// Files as byte sources, see byte_source.hpp.
#include "host/log/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "host/log/error.hpp"

namespace furcula::log {

FileSource::FileSource(const std::string& path, std::string_view what)
    : path_(path), what_(what), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  const int error = errno;
  if (fd_ < 0) throw DataError(path + ": cannot be read: " + std::strerror(error) + "; expected " + what_);
  struct stat status {};
  if (::fstat(fd_, &status) == 0 && S_ISDIR(status.st_mode)) {
    ::close(fd_);
    throw DataError(path + ": is a directory; expected " + what_);
  }
}

FileSource::~FileSource() { ::close(fd_); }

std::size_t FileSource::read(char* to, std::size_t size) {
  for (;;) {
    const ssize_t n = ::read(fd_, to, size);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR)
      throw DataError(path_ + ": cannot be read: " + std::strerror(errno) + "; expected " + what_);
  }
}

}  // namespace furcula::log
