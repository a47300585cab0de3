// The node's Modbus registers: what a read gives and what a write does (table: bus/registers.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/app/node.hpp"

namespace furcula::firmware {

/// A view of a node; the node must outlive it. To be called between ticks.
template <class N>
class NodeRegisters {
 public:
  explicit NodeRegisters(N& node) : node_(node) {}

  bus::ModbusException read_input(std::uint16_t first, std::span<std::uint16_t> out) const {
    node_.hear_host();
    if (first >= bus::kTrialNumberAddress) return read_trial(first, out);
    if (first >= bus::kLogBase) return read_log(first - bus::kLogBase, out);
    if (first + out.size() > bus::kInputWords) return bus::ModbusException::illegal_address;
    const auto words = bus::to_words(node_.snapshot());
    std::copy_n(words.begin() + first, out.size(), out.begin());
    return bus::ModbusException::none;
  }

  /// Parameters; the request's registers read as 0.
  bus::ModbusException read_holding(std::uint16_t first, std::span<std::uint16_t> out) const {
    node_.hear_host();
    if (first + out.size() <= bus::kRequestWords) {
      for (std::uint16_t& word : out) word = 0;
      return bus::ModbusException::none;
    }
    if (!in_parameters(first, out.size())) return bus::ModbusException::illegal_address;
    const auto words = bus::to_words(node_.config());
    std::copy_n(words.begin() + (first - bus::kParameterBase), out.size(), out.begin());
    return bus::ModbusException::none;
  }

  /// A request, or one parameter or several that follow each other, all or none of them.
  bus::ModbusException write_holding(std::uint16_t first, std::span<const std::uint16_t> in) {
    node_.hear_host();
    if (first + in.size() <= bus::kRequestWords) return write_request(first, in);
    if (!in_parameters(first, in.size())) return bus::ModbusException::illegal_address;
    // Half a number is none.
    if ((first - bus::kParameterBase) % 2 != 0 || in.size() % 2 != 0)
      return bus::ModbusException::illegal_address;
    if (!node_.may_configure()) return answer(node_.refuse(bus::Refusal::not_in_this_state));
    control::Config edited = node_.config();
    for (std::size_t i = 0; i < in.size(); i += 2) {
      const bus::Parameter& p = bus::kParameters[(first - bus::kParameterBase + i) / 2];
      const auto value = std::bit_cast<float>(bus::bits_of(in[i], in[i + 1]));
      if (!bus::allows(p, value)) {
        node_.refuse(bus::Refusal::value_not_allowed);
        return bus::ModbusException::illegal_value;
      }
      p.put(edited, value);
    }
    return answer(node_.configure(edited));
  }

  /// Objects 0 to 2 of the device identification: vendor, product, revision; empty: no such object.
  std::string_view identification(std::uint8_t object) const {
    node_.hear_host();
    return object == 0   ? "Furcula"
           : object == 1 ? node_.identity().board
           : object == 2 ? node_.identity().text
                         : "";
  }

 private:
  bus::ModbusException read_log(std::size_t first, std::span<std::uint16_t> out) const {
    if (first + out.size() > bus::kLogWords) return bus::ModbusException::illegal_address;
    std::array<bus::LoggedFault, bus::kLoggedFaults> entries;
    for (std::uint32_t age = 0; age < node_.faults().count(); ++age) entries[age] = node_.faults().entry(age);
    const auto words = bus::to_words(entries);
    std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
    return bus::ModbusException::none;
  }

  static bool in_parameters(std::uint16_t first, std::size_t count) {
    return first >= bus::kParameterBase && first + count <= bus::kParameterBase + bus::kParameterWords;
  }

  bus::ModbusException read_trial(std::uint16_t first, std::span<std::uint16_t> out) const {
    for (std::size_t i = 0; i < out.size(); ++i)
      if (!node_.trial().read(static_cast<std::uint16_t>(first + i), out[i]))
        return bus::ModbusException::illegal_address;
    return bus::ModbusException::none;
  }

  static bus::ModbusException answer(bus::Refusal refusal) {
    switch (refusal) {
      case bus::Refusal::none:
        return bus::ModbusException::none;
      case bus::Refusal::unknown_request:
      case bus::Refusal::value_not_allowed:
      case bus::Refusal::makes_no_sense:
      case bus::Refusal::beyond_envelope:
        return bus::ModbusException::illegal_value;
      default:
        return bus::ModbusException::device_failure;
    }
  }

  bus::ModbusException write_request(std::uint16_t first, std::span<const std::uint16_t> in) {
    const auto stop = static_cast<std::uint16_t>(bus::Request::stop);
    if (first + in.size() == bus::kRequestWords && in.back() == stop)
      return answer(node_.request(bus::Request::stop));
    if (first != bus::kRequestKeyAddress || in.size() != bus::kRequestWords)
      return bus::ModbusException::illegal_address;
    if (in[bus::kRequestKeyAddress] != bus::kRequestKey) return answer(node_.refuse(bus::Refusal::wrong_key));
    if (in[bus::kRequestSessionAddress] != node_.session())
      return answer(node_.refuse(bus::Refusal::wrong_session));
    node_.next_session();
    if (in[bus::kRequestAddress] >= bus::kRequests.size())
      return answer(node_.refuse(bus::Refusal::unknown_request));
    const auto wanted = static_cast<bus::Request>(in[bus::kRequestAddress]);
    const bus::Refusal refusal = node_.request(wanted);
    // Taken, and not done yet.
    if (wanted == bus::Request::save && refusal == bus::Refusal::none && node_.is_saving())
      return bus::ModbusException::acknowledge;
    return answer(refusal);
  }

  N& node_;
};

}  // namespace furcula::firmware
