// Parameters in a file, see file_store.hpp.
#include "boards/linux_sbc/file_store.hpp"

#include <algorithm>
#include <exception>
#include <fstream>
#include <iterator>

#include "host/log/atomic_file.hpp"

namespace furcula::linux_sbc {
namespace {

constexpr std::string_view kTitle = "furcula-parameters/1\n";
constexpr std::size_t kChecksumBytes = 4;

/// FNV-1a, 32 bits: tells a damaged file, not a forged one.
std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t hash = 0x811c9dc5u;
  for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x01000193u;
  return hash;
}

std::string as_bytes(std::uint32_t number) {
  std::string bytes;
  for (unsigned i = 0; i < kChecksumBytes; ++i) bytes.push_back(static_cast<char>(number >> 8 * i & 0xffu));
  return bytes;
}

}  // namespace

Result<std::size_t> FileStore::load(std::span<std::uint8_t> into) {
  if (path_.empty()) return std::size_t{0};
  std::ifstream file(path_, std::ios::binary);
  if (!file) return std::size_t{0};
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return read(bytes, into);
}

Result<std::size_t> FileStore::read(std::string_view all, std::span<std::uint8_t> into) {
  if (!all.starts_with(kTitle) || all.size() < kTitle.size() + kChecksumBytes) return Status::invalid;
  const std::string_view image = all.substr(kTitle.size(), all.size() - kTitle.size() - kChecksumBytes);
  if (image.size() > into.size() || as_bytes(checksum(image)) != all.substr(all.size() - kChecksumBytes))
    return Status::invalid;
  std::copy(image.begin(), image.end(), into.begin());
  return image.size();
}

Status FileStore::save(std::span<const std::uint8_t> image) {
  if (path_.empty()) return Status::disconnected;
  try {
    const std::string content(image.begin(), image.end());
    log::write_file_atomically(path_, std::string(kTitle) + content + as_bytes(checksum(content)));
    return Status::ok;
  } catch (const std::exception&) {
    return Status::disconnected;
  }
}

}  // namespace furcula::linux_sbc
