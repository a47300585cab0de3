#include "host/core/parameter_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>

#include "furcula/core/crc32.hpp"
#include "host/core/atomic_file.hpp"

namespace furcula::core {
namespace {

constexpr std::string_view kTitle = "furcula-parameters/1\n";
constexpr std::size_t kChecksumBytes = 4;

/// Least significant byte first.
std::string checksum(std::string_view image) {
  Crc32 crc;
  for (const char c : image) crc.add(static_cast<std::uint8_t>(c));
  std::string bytes;
  for (unsigned i = 0; i < kChecksumBytes; ++i)
    bytes.push_back(static_cast<char>(crc.value() >> 8 * i & 0xffu));
  return bytes;
}

}  // namespace

Result<std::size_t> ParameterFile::load(std::span<std::uint8_t> into) const {
  if (path_.empty()) return std::size_t{0};
  // A pipe is not waited for.
  const int fd = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0) return errno == ENOENT ? Result<std::size_t>(std::size_t{0}) : Status::invalid;
  // One byte more than the largest that is whole.
  std::string bytes(kTitle.size() + into.size() + kChecksumBytes + 1, '\0');
  std::size_t size = 0;
  ssize_t n = 0;
  do {
    n = ::read(fd, bytes.data() + size, bytes.size() - size);
    if (n > 0) size += static_cast<std::size_t>(n);
  } while ((n > 0 && size < bytes.size()) || (n < 0 && errno == EINTR));
  ::close(fd);
  if (n < 0) return Status::invalid;
  return read(std::string_view(bytes).substr(0, size), into);
}

Result<std::size_t> ParameterFile::read(std::string_view file, std::span<std::uint8_t> into) {
  if (!file.starts_with(kTitle) || file.size() < kTitle.size() + kChecksumBytes) return Status::invalid;
  const std::string_view image = file.substr(kTitle.size(), file.size() - kTitle.size() - kChecksumBytes);
  if (image.size() > into.size() || checksum(image) != file.substr(file.size() - kChecksumBytes))
    return Status::invalid;
  std::copy(image.begin(), image.end(), into.begin());
  return image.size();
}

Status ParameterFile::save(std::span<const std::uint8_t> image) const {
  if (path_.empty()) return Status::disconnected;
  try {
    const std::string content(image.begin(), image.end());
    write_file_atomically(path_, std::string(kTitle) + content + checksum(content));
    return Status::ok;
  } catch (const std::exception&) {
    return Status::disconnected;
  }
}

}  // namespace furcula::core
