// Values that cannot be what was measured, found in a column alone; and counters that wrapped.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace furcula::log {

/// Rows of a body's position in which it steps out of the rows around and back again: a row, or up to eight in
/// a row, that lie outside of what the rows before and after span, by more than noise, and by more than twice
/// the way that the body goes there in that time. An impact, a reversal, a jittering clock, a stop and a step
/// that stays do not do that. At the ends, where there is one side alone, up to three rows that are further
/// off than the body ever moves so fast.
///
/// `noise`: at least this standard deviation; what neighbouring rows do not share is found in the values.
std::vector<std::size_t> steps_out_and_back(std::span<const double> time_s, std::span<const double> values,
                                            double noise = 0.0);

/// Up to eight rows at an end of a position that the rows beside them do not predict: a filter's or a bus's first values. They are off
/// by about the same: by more than noise and one and a half times the way that the body goes in a row (a body that sets off is off by
/// that way), and by four times what all but a hundredth of the column's rows are from what a parabola through the eight before, or
/// after, predicts. A knock, from which on the distance grows, does not look so.
std::vector<std::size_t> off_at_ends(std::span<const double> time_s, std::span<const double> values);

/// Rows of a position in which its encoder stands still while the body goes on: ten at least of exactly one value, then a jump of more
/// than noise and the way of a row, the body moving before and after, on one side about as fast as that jump would have been gone. The
/// first row of that value is not among them.
std::vector<std::size_t> stuck(std::span<const double> time_s, std::span<const double> values);

/// Rows, at most three in a row, whose size is more than fifty times that of any other row: of what may jump
/// as it likes (a torque, a speed). Of a column that is nothing else than zero none.
std::vector<std::size_t> far_beyond_others(std::span<const double> values);

/// By how much a position jumps where its counter wraps; 0 where it does not. It wraps where all large jumps
/// are the same, as large as all that the column spans, and go against the motion: two at least, or one of a
/// turn where `turn` (2 pi, or 0) is given.
double wrap_span(std::span<const double> time_s, std::span<const double> values, double turn);

/// The values with their wraps taken out, going on from the first.
std::vector<double> unwrapped(std::span<const double> values, double span);

}  // namespace furcula::log
