// The diagnosis of a machine with one joint in the form that all families share.
#pragma once

#include <string_view>

#include "host/diagnose/diagnosis.hpp"
#include "host/result/diagnosis.hpp"

namespace furcula::diagnose {

result::Diagnosis result_of(const Diagnosis& diagnosis);

/// "m", "m/s", "rad", "rad/s", "s" or "N m" of a channel of this kind; empty if the channel is unknown.
std::string_view channel_unit(std::string_view channel, dynamics::Kind kind);

/// Errors in the order of their channels' names, with the units of this kind.
std::vector<result::ChannelError> channel_errors(const Errors& errors, dynamics::Kind kind);

std::vector<result::ExcludedWindows> excluded_windows(const std::vector<identify::Excluded>& windows);

}  // namespace furcula::diagnose
