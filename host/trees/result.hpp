// The diagnosis of a robot in the form that all families share.
#pragma once

#include "host/result/diagnosis.hpp"
#include "host/trees/diagnosis.hpp"

namespace furcula::trees {

result::Diagnosis result_of(const Diagnosis& diagnosis);

/// A cause with the names of its locations, without its values.
result::Cause named(const TreeModel& model, const Cause& cause);

/// Errors of the joints' channels, in the order of the joints.
std::vector<result::ChannelError> channel_errors(const TreeModel& model,
                                                 const std::vector<ChannelError>& errors);

}  // namespace furcula::trees
