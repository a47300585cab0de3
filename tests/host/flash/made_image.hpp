// Small ELF files with an image's header, made by the documents (System V ABI;
// firmware/startup/image_header.hpp) and not by the code under test.
#pragma once

#include <cstdint>
#include <string>

namespace furcula::test {

inline void put(std::string& to, std::size_t at, std::uint32_t value, int bytes = 4) {
  for (int i = 0; i < bytes; ++i) to.at(at + i) = static_cast<char>(value >> (8 * i));
}

/// CRC-32 bit by bit.
inline std::uint32_t bitwise_crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int i = 0; i < 8; ++i) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return ~crc;
}

/// `length` bytes of an image for a board, version 1.2.3, build 0badcafe.
inline std::string made_image(const std::string& board, std::uint32_t length = 1000) {
  std::string bytes(length, '\0');
  for (std::size_t i = 0; i < length; ++i) bytes[i] = static_cast<char>(i * 7);
  bytes.replace(0x200, 80, 80, '\0');
  put(bytes, 0x200, 0x43525546);  // "FURC"
  put(bytes, 0x204, 1);
  bytes.replace(0x208, board.size(), board);
  put(bytes, 0x220, 0x00010203);
  put(bytes, 0x224, length);
  put(bytes, 0x238, 0xfecaad0b);
  put(bytes, 0x200 + 76, bitwise_crc32(bytes));
  return bytes;
}

/// Two segments: all but the last `tail` bytes of the image, and those, which run elsewhere but lie after the
/// others; and one of memory alone.
inline std::string made_elf(const std::string& image, std::uint32_t tail = 100) {
  const std::uint32_t headers = 52, each = 32, begin = headers + 3 * each;
  const auto size = static_cast<std::uint32_t>(image.size()), first = size - tail;
  std::string elf(begin, '\0');
  elf.replace(0, 6,
              "\x7f"
              "ELF\x01\x01");
  put(elf, 16, 2, 2);
  put(elf, 18, 40, 2);
  put(elf, 28, headers);
  put(elf, 42, each, 2);
  put(elf, 44, 3, 2);
  const std::uint32_t segments[3][5] = {// offset, virtual address, physical address, in file, in memory
                                        {begin, 0x08000000, 0x08000000, first, first},
                                        {begin + first, 0x20000000, 0x08000000 + first, tail, tail + 50},
                                        {0, 0x20001000, 0x20001000, 0, 4096}};
  for (std::size_t i = 0; i < 3; ++i) {
    put(elf, headers + each * i, 1);
    for (std::size_t k = 0; k < 5; ++k) put(elf, headers + each * i + 4 * (k + 1), segments[i][k]);
  }
  return elf + image;
}

}  // namespace furcula::test
