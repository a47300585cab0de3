// Rows as a machine predicts them, beside those measured.
#pragma once

#include <vector>

#include "host/floating/identify.hpp"

namespace furcula::floating {

/// What a fit's residuals are weighed by.
double noise_sd(std::size_t channel);

/// "left knee", "roll", "gyro x"; "rad" or "rad/s".
std::string channel_name(std::size_t channel);
const char* channel_unit(std::size_t channel);

/// The window's rows from the second on: angles, attitude and gyro as predicted, all else as measured.
std::vector<Row> predicted_rows(const Recording& recording, const Predicted& predicted);

/// The number of a row; attitude as roll, pitch and yaw.
double value_of(const Row& row, std::size_t channel);

}  // namespace furcula::floating
