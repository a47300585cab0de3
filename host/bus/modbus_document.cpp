// The page on Modbus, see modbus_document.hpp.
#include "host/bus/modbus_document.hpp"

#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::rounded;

constexpr std::string_view kModbusHead = R"(# Modbus registers

This page is what `furcula bus docs modbus` prints, from the tables that firmware, simulation and host use
(`common/include/furcula/bus/registers.hpp`, `parameters.hpp`, `node_words.hpp`). How they are used: [CAN and Modbus](board_link.md).

A number of 32 bits takes two registers, the more significant word first; `real` is IEEE 754.

## Requests

Three holding registers, written at once:

| address | holding register |
|---|---|
)";

std::string word_table(std::span<const Word> words) {
  std::string out = "\n| number | name | meaning |\n|---|---|---|\n";
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
  out += word_table(kRequests) + "\n## States\n" + word_table(kNodeStates) + "\n## Reasons\n" +
         word_table(kReasons) + "\n## Refusals\n" + word_table(kRefusals);
  out += "\n## Input registers\n\n| address | name | type | unit | meaning |\n|---|---|---|---|---|\n";
  for (const InputRegister& r : kInputRegisters) out += register_row(r);
  out += "\n### Reset causes\n" + word_table(kResetCauses);
  out += "\n### The log of faults\n\nThe last " + std::to_string(kLoggedFaults) +
         ", the newest first: entry k, from 0 on, begins at input register " + std::to_string(kLogBase) +
         " + " + std::to_string(kLogEntryWords) +
         " k; all 0: none. Kept over a reset, not over a power cut.\n"
         "\n| address + | name | type | unit | meaning |\n|---|---|---|---|---|\n";
  for (const LogRegister& r : kLogRegisters) out += register_row(r);
  out +=
      "\n### The last trial on the clutch's bench\n\nRead after the trial ([bench](bench.md)); a row is a "
      "millisecond.\n\n| address | meaning |\n|---|---|\n";
  out += row(kTrialNumberAddress, "number of the trial since the start; 0: there was none");
  out += row(kTrialRowsAddress, "rows that it has, up to " + std::to_string(kTrialRowsMost));
  out += row(kTrialCountBase,
             "and on, one a row: what the cable's encoder had moved since the first row, in counts, signed");
  out += row(kTrialCoilBase, "and on, one a row: the coil's duty from then on, in percent");
  out += R"(
## Parameters

Two holding registers each, `real`.

| address | number | name | unit | least | most | default | meaning |
|---|---|---|---|---|---|---|---|
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
