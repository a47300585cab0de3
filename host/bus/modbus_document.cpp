// The page on Modbus, see modbus_document.hpp.
#include "host/bus/modbus_document.hpp"

#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::rounded;

constexpr std::string_view kModbusHead = R"(# Modbus

A board is a Modbus server: over a serial line (RTU) or TCP, with one table of registers. This page is what `furcula bus docs modbus` prints;
the tables are `common/include/furcula/bus/registers.hpp`, `parameters.hpp` and `node_words.hpp`, and firmware, simulation and host use them.

    furcula serve                                               # a simulated robot at modbus:127.0.0.1:1502
    furcula monitor --port modbus:127.0.0.1:1502                # live: what it does, and why it does not move
    furcula monitor --once --json --port modbus:127.0.0.1:1502  # the same for a program
    furcula request hop --port modbus:127.0.0.1:1502            # arms it and makes it hop until Ctrl-C; stop, reset, home, ...
    furcula param list --port modbus:/dev/ttyUSB0@115200        # over a serial line (8E1; 8N1: @115200,8N1)
    furcula param set torque_amplitude_nm 2 --port modbus:/dev/ttyUSB0@115200
    furcula param save --port modbus:/dev/ttyUSB0@115200
    furcula monitor --port can:can0                             # the same registers over CAN (bus.md)

Exit statuses: 2 for what cannot be meant, 3 where nothing answers, 4 where the robot refuses; the message says why.

Functions: 3 (read holding registers), 4 (read input registers), 6 and 16 (write one or several holding registers), 43/14 (device identification: vendor,
board, version and build). Serial: 8 data bits, even parity, 1 stop bit or as the board says; unit 1. A broadcast (unit 0) is done and not answered, as far as it writes.

A number of 32 bits takes two registers, the more significant word first; `real` is IEEE 754. What one request reads is of one tick.

| exception | means here |
| --- | --- |
| 1 | no such function |
| 2 | no such register, or half of a parameter |
| 3 | a value that is not allowed, or a request that makes no sense |
| 4 | refused; the input register `last_refusal` says why |
| 5 | taken, and it takes a while: a save on a computer's disk. `parameter_origin` is `being_saved` until it is done; then `store`, or `last_refusal` says why not |

## Making it hop

Torque stays 0 until the robot is armed and told to hop. A request is three holding registers, written at once (function 16):

| address | holding register |
| --- | --- |
)";

std::string word_table(std::span<const Word> words) {
  std::string out = "\n| number | name | meaning |\n| --- | --- | --- |\n";
  for (const Word& w : words)
    out += "| " + std::to_string(w.number) + " | `" + std::string(w.name) + "` | " + std::string(w.meaning) +
           " |\n";
  return out;
}

std::string row(std::uint32_t address, const std::string& text) {
  return "| " + std::to_string(address) + " | " + text + " |\n";
}

std::string type_name(RegisterType type) {
  return type == RegisterType::u16 ? "u16" : type == RegisterType::u32 ? "u32" : "real";
}

template <class Owner>
std::string register_row(const RegisterOf<Owner>& r) {
  return row(r.address, "`" + std::string(r.name) + "` | " + type_name(r.type) + " | " + std::string(r.unit) +
                            " | " + std::string(r.meaning));
}

}  // namespace

std::string modbus_to_markdown() {
  const control::Config defaults;
  std::string out(kModbusHead);
  out += row(kRequestKeyAddress, "key: " + std::to_string(kRequestKey));
  out += row(kRequestSessionAddress, "session: what the input register `session` shows now");
  out += row(kRequestAddress, "request: a number of the table below");
  out += R"(
1. Read `session`; write key, session and `arm`.
2. Within 2 s read `session` again, which has changed; write key, session and `hop`.

The session changes with every request that brought the right one, so a frame that comes a second time, or late, does nothing. It is a guard against accidents, not against
people: whoever reaches the bus can move the robot. `stop` may be written alone, with function 6.

What was started in this way runs until `stop`, a fault, or silence: when nothing is asked for longer than the parameter `desk_silent_s` (2 s as built in; 0: it runs on), because a cable was
pulled, a computer sleeps or a program ended, the robot stops as on `stop`, with the reason `desk_silent`. Any request that reads or writes registers counts, whoever sends it: `furcula monitor` is
enough. `furcula request hop` stays and asks until Ctrl-C, and then stops the robot; `--for 5` does so after 5 s; `--for 0` leaves the robot at once to who else asks.

What a stream of CAN commands ([bus.md](bus.md)) started stops when the stream is silent for 100 ms. A stream starts it by changing from `stop` to `hop` without a gap of 100 ms,
after 100 ms without any `hop`. A stop beside the stream, as of a second desk, is obeyed as well, and the stream that goes on does not undo it ([how](bus.md#stop)).

### Requests
)";
  out += word_table(kRequests) + "\n### States\n" + word_table(kNodeStates) + "\n### Reasons\n" +
         word_table(kReasons) + "\n### Refusals\n" + word_table(kRefusals);
  out +=
      "\n## Input registers\n\n| address | name | type | unit | meaning |\n| --- | --- | --- | --- | --- |\n";
  for (const InputRegister& r : kInputRegisters) out += register_row(r);
  out += "\n### Reset causes\n" + word_table(kResetCauses);
  out +=
      "\n### The log of faults\n\nThe last " + std::to_string(kLoggedFaults) +
      " faults, the newest first: entry k of them, from 0 on, begins at input register " +
      std::to_string(kLogBase) + " + " + std::to_string(kLogEntryWords) +
      " k. An entry that is not there reads as 0. A board keeps them over a\nreset, not over a power cut.\n"
      "\n| address + | name | type | unit | meaning |\n| --- | --- | --- | --- | --- |\n";
  for (const LogRegister& r : kLogRegisters) out += register_row(r);
  out +=
      "\n### The last trial on the clutch's bench\n\nInput registers too; a row is a millisecond. With "
      "`on_bench` set, `arm` and `hop` make one trial ([bench.md](bench.md)), which is read when it is over.\n"
      "\n| address | meaning |\n| --- | --- |\n";
  out += row(kTrialNumberAddress, "number of the trial since the start; 0: there was none");
  out += row(kTrialRowsAddress, "rows that it has, up to " + std::to_string(kTrialRowsMost));
  out += row(kTrialCountBase,
             "and on, one a row: what the cable's encoder had moved since the first row, in counts, signed");
  out += row(kTrialCoilBase, "and on, one a row: the coil's duty from then on, in percent");
  out += R"(
## Parameters

Two holding registers each, `real`. Refused while armed or running, by exception 4; and where a value is no number, out of its bounds or a fraction of what is whole, or the controller's
configuration would make no sense, by exception 3: then none of the request's parameters is written. They act at once and are forgotten at a restart, unless `save` is requested.

| address | number | name | unit | least | most | built in | meaning |
| --- | --- | --- | --- | --- | --- | --- | --- |
)";
  for (const Parameter& p : kParameters) {
    const auto text = [](float x) { return rounded(static_cast<double>(x), 6); };
    out += row(address_of(p), std::to_string(p.number) + " | `" + std::string(p.name) + "` | " +
                                  std::string(p.unit) + " | " + text(p.least) + " | " + text(p.most) + " | " +
                                  text(p.get(defaults)) + " | " + std::string(p.meaning));
  }
  out += "\nWhere they come from (`parameter_origin`):\n";
  return out + word_table(kParameterOrigins);
}

}  // namespace furcula::bus
