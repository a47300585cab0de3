// What lies under main() on a Cortex-M4F: the image's hook for exceptions, and how deep the stack went.
#pragma once

#include <cstdint>

namespace furcula::firmware {

/// Defined by each image: what happens on a fault of the processor. Must not return.
[[noreturn]] void on_exception();

/// Bytes of stack that were ever used since reset: the stack is painted before main() runs.
std::uint32_t deepest_stack_bytes();

}  // namespace furcula::firmware
