// The diagnosis as other programs read it: schema `furcula-diagnosis/1` (docs/contracts.md, section 4).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "host/diagnose/diagnosis.hpp"

namespace furcula::diagnose {

/// Keys stand in the contract's order. A figure that is not finite becomes null. Beyond the contract:
/// `summary`, `candidates`, `parameters`, `files`, `next_experiment`, and `parameters` of rivals.
nlohmann::ordered_json to_json(const Diagnosis& diagnosis);

/// The text of diagnosis.json: indented, UTF-8 (bytes of file names that are not become U+FFFD), numbers
/// written such that reading them gives the same double.
std::string to_json_text(const Diagnosis& diagnosis);

/// The suffix that a key of this channel carries: "m", "mps", "rad", "radps", "s"; empty if the channel is
/// unknown.
std::string_view channel_suffix(std::string_view channel, dynamics::Kind kind);

/// The channel that the diagnosis is judged by: its own statement, else the position of this kind of machine.
std::string main_channel(const Diagnosis& diagnosis);

}  // namespace furcula::diagnose
