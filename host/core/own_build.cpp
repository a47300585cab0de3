#include "host/core/own_build.hpp"

#include <elf.h>
#include <link.h>

#include <cstdio>
#include <cstring>

namespace furcula::core {
namespace {

/// Of the notes between `at` and `end`, as the loader has them in memory.
std::uint32_t build_id_among(const unsigned char* at, const unsigned char* end) {
  const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
  ElfW(Nhdr) head;
  for (; static_cast<std::size_t>(end - at) >= sizeof head;) {
    std::memcpy(&head, at, sizeof head);
    const std::size_t name = padded(head.n_namesz), size = sizeof head + name + padded(head.n_descsz);
    if (static_cast<std::size_t>(end - at) < size) return 0;
    const unsigned char* hash = at + sizeof head + name;
    if (head.n_type == NT_GNU_BUILD_ID && head.n_descsz >= 4 && head.n_namesz == 4 &&
        std::memcmp(at + sizeof head, "GNU", 4) == 0)
      return static_cast<std::uint32_t>(hash[0]) << 24 | static_cast<std::uint32_t>(hash[1]) << 16 |
             static_cast<std::uint32_t>(hash[2]) << 8 | hash[3];
    at += size;
  }
  return 0;
}

/// The program itself is the first object.
int look(dl_phdr_info* object, std::size_t, void* found) {
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type != PT_NOTE) continue;
    const auto* begin = reinterpret_cast<const unsigned char*>(object->dlpi_addr + part.p_vaddr);
    const std::uint32_t id = build_id_among(begin, begin + part.p_memsz);
    if (id != 0) *static_cast<std::uint32_t*>(found) = id;
  }
  return 1;
}

}  // namespace

std::uint32_t own_build_id() {
  std::uint32_t id = 0;
  ::dl_iterate_phdr(look, &id);
  return id;
}

std::string hexadecimal(std::uint32_t number) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", number);
  return text;
}

}  // namespace furcula::core
