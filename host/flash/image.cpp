#include "host/flash/image.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "furcula/core/crc32.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::flash {
namespace {

/// What an image may be at most: all of the memory.
constexpr std::uint32_t kMostBytes = 1u << 20;

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw core::DataError(name + ": " + message);
}

std::string hexadecimal(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof(text), "%08x", value);
  return text;
}

/// Numbers of the file at a place, the lowest byte first.
class Reader {
 public:
  Reader(std::string_view file, const std::string& name) : file_(file), name_(name) {}
  std::uint32_t number(std::size_t at, std::size_t bytes) const {
    if (at > file_.size() || file_.size() - at < bytes) fail(name_, "the ELF file ends too early");
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(file_[at + i])) << (8 * i);
    return value;
  }
  std::string_view part(std::uint32_t at, std::uint32_t size) const {
    if (at > file_.size() || file_.size() - at < size) fail(name_, "the ELF file ends too early");
    return file_.substr(at, size);
  }

 private:
  std::string_view file_;
  const std::string& name_;
};

/// Places in an ELF file, System V ABI, chapter 4 and 5.
constexpr std::size_t kMachine = 18, kProgramHeaders = 28, kProgramHeaderSize = 42, kProgramHeaderCount = 44;
constexpr std::uint32_t kArm = 40, kLoad = 1;

}  // namespace

std::string Image::board() const {
  const auto& name = header.names.board;
  return {name.begin(), std::find(name.begin(), name.end(), '\0')};
}

std::string Image::version() const {
  const std::uint32_t v = header.names.firmware_version;
  return std::to_string(v >> 16) + "." + std::to_string(v >> 8 & 0xff) + "." + std::to_string(v & 0xff) +
         ", build " + hexadecimal(firmware::build_id(header));
}

Image image_of(std::vector<std::uint8_t> bytes, const std::string& name) {
  Image image{std::move(bytes), {}};
  constexpr std::size_t kAt = firmware::kImageHeaderOffset;
  const bool holds_header = image.bytes.size() >= kAt + sizeof(image.header);
  if (holds_header) std::memcpy(&image.header, image.bytes.data() + kAt, sizeof(image.header));
  const firmware::ImageHeader& header = image.header;
  if (!holds_header || header.names.magic != firmware::kImageMagic)
    fail(name, "no header of a Furcula image at " + hexadecimal(firmware::kFlashBase + kAt));
  if (header.names.header_version != firmware::kImageHeaderVersion)
    fail(name, "its header is of version " + std::to_string(header.names.header_version) + "; expected " +
                   std::to_string(firmware::kImageHeaderVersion));
  if (header.length != image.bytes.size())
    fail(name, "its header says " + std::to_string(header.length) + " bytes, and it has " +
                   std::to_string(image.bytes.size()));
  Crc32 crc;
  constexpr std::size_t kCrcAt = kAt + offsetof(firmware::ImageHeader, crc);
  for (std::size_t i = 0; i < image.bytes.size(); ++i)
    crc.add(i >= kCrcAt && i < kCrcAt + 4 ? std::uint8_t{0} : image.bytes[i]);
  if (crc.value() != header.crc)
    fail(name, "its CRC-32 is " + hexadecimal(crc.value()) + ", and its header says " +
                   hexadecimal(header.crc) + ": the image is damaged, or scripts/finish-image was not run");
  return image;
}

Image read_elf(std::string_view file, const std::string& name) {
  constexpr std::string_view kMagic(
      "\x7f"
      "ELF\x01\x01",
      6);  // of 32 bits, little-endian
  const Reader reader(file, name);
  if (!file.starts_with(kMagic) || reader.number(kMachine, 2) != kArm)
    fail(name, "not an ELF file for a Cortex-M (32 bits, little-endian, ARM)");
  const std::uint32_t first = reader.number(kProgramHeaders, 4);
  const std::uint32_t size = reader.number(kProgramHeaderSize, 2);
  const std::uint32_t count = reader.number(kProgramHeaderCount, 2);
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t at = std::size_t{first} + std::size_t{i} * size;
    const std::uint32_t type = reader.number(at, 4), offset = reader.number(at + 4, 4);
    const std::uint32_t address = reader.number(at + 12, 4), length = reader.number(at + 16, 4);
    if (type != kLoad || length == 0) continue;
    const std::uint32_t from_base = address - firmware::kFlashBase;
    if (from_base >= kMostBytes || length > kMostBytes - from_base)
      fail(name, "a segment at " + hexadecimal(address) + " that is not in the flash memory");
    const std::string_view content = reader.part(offset, length);
    if (bytes.size() < from_base + length) bytes.resize(from_base + length, 0);
    std::copy(content.begin(), content.end(), bytes.begin() + from_base);
  }
  return image_of(std::move(bytes), name);
}

}  // namespace furcula::flash
