// The board's end of an exchange with the host, tick by tick over two named pipes: fixed-size messages, what an image ends with, and what its
// instruction counter is worth.
#pragma once

#include <cstdint>

#include "boards/qemu_netduinoplus2/instruction_counter.hpp"
#include "boards/qemu_netduinoplus2/pipes.hpp"
#include "boards/qemu_netduinoplus2/semihosting.hpp"

namespace furcula::pil {

// Exit statuses of QEMU.
enum Exit : std::uint32_t { kDone = 0, kNoPipes = 2, kPeerGone = 3, kBadMessage = 4, kException = 5 };

/// Both pipes, once the host has opened them too; without the host the image ends.
class Pipes {
 public:
  void open() {
    using semihosting::Mode;
    in_ = semihosting::open(kToBoard, sizeof(kToBoard) - 1, Mode::read_binary);
    out_ = semihosting::open(kFromBoard, sizeof(kFromBoard) - 1, Mode::write_binary);
    if (in_ < 0 || out_ < 0) semihosting::exit(kNoPipes);
  }
  void receive(void* bytes, std::uint32_t size) const {
    if (!semihosting::read(in_, bytes, size)) semihosting::exit(kPeerGone);
  }
  template <class Message>
  void receive(Message& message) const {
    receive(&message, sizeof(message));
  }
  template <class Message>
  void send(const Message& message) const {
    if (!semihosting::write(out_, &message, sizeof(message))) semihosting::exit(kPeerGone);
  }

 private:
  std::int32_t in_ = -1, out_ = -1;
};

/// What a hundred instructions measure: 100, if the emulator counts as it should.
[[gnu::noinline]] inline std::uint32_t hundred_nops(const InstructionCounter& counter) {
  const std::uint32_t before = counter.read();
  asm volatile(".rept 100\n nop\n .endr");
  const std::uint32_t after = counter.read();
  return counter.between(before, after);
}

}  // namespace furcula::pil
