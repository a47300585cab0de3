// Tables of a diagnosis' page: each is markup, empty where there is nothing to show.
#pragma once

#include <string>
#include <vector>

#include "host/result/diagnosis.hpp"

namespace furcula::report {

/// The errors of one channel; null if the channel is not there.
const result::ChannelError* find(const std::vector<result::ChannelError>& errors, const std::string& channel);

/// "<code>coulomb_friction@elbow</code> + <code>damping_nspm</code>"; of no cause in words.
std::string names_html(const std::vector<result::Cause>& causes);

/// Held-out errors by channel, and by recording.
std::string errors_table(const result::Diagnosis& d);
std::string recordings_table(const result::Diagnosis& d);

std::string missing_force_html(const result::Diagnosis& d);
std::string remains_html(const result::Diagnosis& d);
std::string candidates_html(const result::Diagnosis& d);
std::string parameters_html(const result::Diagnosis& d);
std::string base_parameters_html(const result::Diagnosis& d);
std::string data_html(const result::Diagnosis& d);

}  // namespace furcula::report
