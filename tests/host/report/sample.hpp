// A diagnosis as the engine would hand it over, worked out here in closed form: a hopper without torque that
// has dry friction in its guide, and a model that has none.
#pragma once

#include <cstddef>
#include <string>

#include "host/diagnose/diagnosis.hpp"

namespace furcula::test {

/// What the measured hopper has and the given model lacks.
inline constexpr double kTrueFriction_n = 1.6;

/// `logs` drops from different heights, each of up to `hops` strides; every fourth log is held out. All fits
/// are least squares on the closed form, all figures are computed from the traces.
diagnose::Diagnosis sample_diagnosis(std::size_t logs = 12, std::size_t hops = 8);

/// The page of a diagnosis.
std::string page_of(const diagnose::Diagnosis& d, const std::string& command = "");

}  // namespace furcula::test
