// Vector table and reset of a Cortex-M4F. The linker script gives the symbols.
#include "firmware/startup/startup.hpp"

#include <cstddef>

int main();

extern "C" {

extern std::uint32_t _stack_bottom[], _stack_top[];

[[noreturn]] void reset_handler();
[[noreturn]] void exception_handler();
[[noreturn]] void furcula_on_exception();
/// The exception of the processor's timer, for an image that starts it to define.
void tick_handler();
asm(".weak tick_handler\n.thumb_set tick_handler, exception_handler");

/// FPU on before the first instruction that needs it, stack painted, .data copied, .bss zeroed. Assembly,
/// because a function's own frame would lie on the stack that is painted.
[[gnu::naked]] void reset_handler() {
  asm volatile(R"(
    ldr   r0, =0xe000ed88       // CPACR: full access to coprocessors 10 and 11
    ldr   r1, [r0]
    orr   r1, r1, #0xf00000
    str   r1, [r0]
    dsb
    isb
    ldr   r0, =_stack_bottom
    ldr   r1, =_stack_top
    ldr   r2, =0xa5a5a5a5
  1:
    cmp   r0, r1
    itt   lo
    strlo r2, [r0], #4
    blo   1b
    ldr   r0, =_data_start
    ldr   r1, =_data_end
    ldr   r2, =_data_load
  2:
    cmp   r0, r1
    ittt  lo
    ldrlo r3, [r2], #4
    strlo r3, [r0], #4
    blo   2b
    ldr   r0, =_bss_start
    ldr   r1, =_bss_end
    mov   r2, #0
  3:
    cmp   r0, r1
    itt   lo
    strlo r2, [r0], #4
    blo   3b
    bl    main
    b     exception_handler
    .ltorg
  )");
}

/// With the stack empty again: what it held is of no use, and its overflow may be what happened.
[[gnu::naked]] void exception_handler() {
  asm volatile(R"(
    ldr   r0, =_stack_top
    mov   sp, r0
    bl    furcula_on_exception
    .ltorg
  )");
}
[[noreturn, gnu::used]] void furcula_on_exception() { furcula::firmware::on_exception(); }

struct VectorTable {
  std::uint32_t* initial_stack;
  void (*handlers[15])();
};

/// The processor's own exceptions. No interrupt of a peripheral is let through: the application looks at
/// them.
[[gnu::section(".isr_vector"), gnu::used]] const VectorTable vector_table = {
    _stack_top,
    {reset_handler, exception_handler, exception_handler, exception_handler, exception_handler,
     exception_handler, nullptr, nullptr, nullptr, nullptr, exception_handler, exception_handler, nullptr,
     exception_handler, tick_handler}};
}

namespace furcula::firmware {

std::uint32_t deepest_stack_bytes() {
  const std::uint32_t* word = _stack_bottom;
  while (word < _stack_top && *word == 0xa5a5a5a5u) ++word;
  return static_cast<std::uint32_t>(_stack_top - word) * sizeof(std::uint32_t);
}

}  // namespace furcula::firmware
