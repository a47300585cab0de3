// Files as byte sources, see byte_source.hpp.
#include "host/core/byte_source.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "host/core/error.hpp"

namespace furcula::core {

// Without O_NONBLOCK opening a FIFO waits for its writer, for ever if need be.
FileSource::FileSource(const std::string& path, std::string_view what)
    : path_(path), what_(what), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
  const int error = errno;
  if (fd_ < 0) throw DataError(path + ": cannot be read: " + std::strerror(error) + "; expected " + what_);
  try {
    struct stat status {};
    const bool known = ::fstat(fd_, &status) == 0;
    if (known && S_ISDIR(status.st_mode)) throw DataError(path + ": is a directory; expected " + what_);
    if (known && S_ISFIFO(status.st_mode)) wait_for_writer();
    ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) & ~O_NONBLOCK);
  } catch (const DataError&) {
    ::close(fd_);
    throw;
  }
}

FileSource::~FileSource() { ::close(fd_); }

/// read(2) of a pipe tells whether somebody could write: then it has no data yet (EAGAIN), and no end.
void FileSource::wait_for_writer() {
  const auto limit = std::chrono::steady_clock::now() + kWriterWait;
  char first = 0;
  for (;;) {
    const ssize_t n = ::read(fd_, &first, 1);
    if (n > 0) ahead_.assign(1, first);
    if (n > 0 || (n < 0 && errno != EINTR)) return;
    // A writer that came and went without a word: the end.
    pollfd pipe{fd_, POLLIN, 0};
    if (::poll(&pipe, 1, 10) > 0 && pipe.revents == POLLHUP) return;
    if (std::chrono::steady_clock::now() >= limit)
      throw DataError(path_ + ": is a pipe that no program writes to (waited " +
                      std::to_string(kWriterWait.count() / 1000) + " s); expected " + what_);
  }
}

std::size_t FileSource::read(char* to, std::size_t size) {
  if (!ahead_.empty() && size > 0) {
    *to = ahead_.front();
    ahead_.clear();
    return 1;
  }
  for (;;) {
    const ssize_t n = ::read(fd_, to, size);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR)
      throw DataError(path_ + ": cannot be read: " + std::strerror(errno) + "; expected " + what_);
  }
}

}  // namespace furcula::core
