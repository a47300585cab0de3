// Arm semihosting, the four calls that the board needs (Arm IHI 0110): BKPT 0xAB with the operation in r0 and
// its arguments' block in r1.
#pragma once

#include <cstdint>

namespace furcula::semihosting {

enum class Mode : std::uint32_t { read_binary = 1, write_binary = 5 };

inline std::int32_t call(std::uint32_t operation, const void* arguments) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

/// A file's handle, or -1. Blocks while a named pipe has no other end.
inline std::int32_t open(const char* path, std::uint32_t length, Mode mode) {
  const struct {
    const char* path;
    Mode mode;
    std::uint32_t length;
  } arguments{path, mode, length};
  return call(0x01, &arguments);
}

/// Whether all of it was written.
inline bool write(std::int32_t handle, const void* data, std::uint32_t size) {
  const struct {
    std::int32_t handle;
    const void* data;
    std::uint32_t size;
  } arguments{handle, data, size};
  return call(0x05, &arguments) == 0;
}

/// Blocks until `size` bytes came (true) or the other end closed (false).
inline bool read(std::int32_t handle, void* data, std::uint32_t size) {
  auto* bytes = static_cast<std::uint8_t*>(data);
  while (size > 0) {
    const struct {
      std::int32_t handle;
      void* data;
      std::uint32_t size;
    } arguments{handle, bytes, size};
    const std::int32_t missing = call(0x06, &arguments);
    if (missing < 0 || static_cast<std::uint32_t>(missing) >= size) return false;
    bytes += size - static_cast<std::uint32_t>(missing);
    size = static_cast<std::uint32_t>(missing);
  }
  return true;
}

/// Ends QEMU with this exit status.
[[noreturn]] inline void exit(std::uint32_t status) {
  const struct { std::uint32_t reason, status; } arguments{0x20026, status};  // ADP_Stopped_ApplicationExit
  for (;;) call(0x20, &arguments);
}

}  // namespace furcula::semihosting
