// Logs of trees, see recording.hpp.
#include "host/trees/recording.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/linear/linear.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::trees {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of a sample's noise, from third differences (a smooth motion has hardly any); at least that of
/// the smallest step between two readings.
double noise_of(const std::vector<double>& x) {
  std::vector<double> differences, steps;
  for (std::size_t i = 3; i < x.size(); ++i)
    differences.push_back(std::abs(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]));
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] != x[i - 1]) steps.push_back(std::abs(x[i] - x[i - 1]));
  // Median of |normal| is 0.6745 of its deviation; third differences of white noise have sqrt(20) of it.
  const double white = median(std::move(differences)) / 0.6745 / std::sqrt(20.0);
  double step = 0.0;
  if (!steps.empty()) step = *std::min_element(steps.begin(), steps.end());
  return std::max({white, step / std::sqrt(12.0), 1e-7});
}

[[noreturn]] void missing(const log::Log& log, const TreeModel& m, std::size_t joint,
                          const std::string& columns) {
  std::string unusable;
  for (const auto& [column, why] : log.unusable)
    if (columns.find("'" + column + "'") != columns.npos)
      unusable += " that can be used (" + core::printable(column) + ": " + core::printable(why) +
                  "; rows in which the drive does not answer yet may be cut off)";
  throw core::DataError(log.path + ": joint " + core::quoted(m.robot.joints[joint].name) + " has no column " +
                        core::printable(columns) + unusable +
                        "; expected one of each joint that moves (joints = [...] in " + m.file +
                        " says which do)" +
                        (m.map_lines.empty() ? "" : "; or in a --map file: " + core::printable(m.map_lines)));
}

/// That an angle goes far beyond the URDF's limit; empty: it does not. Limits in published URDFs are often made up: it is noted, and not refused.
std::string beyond_limit(const log::Log& log, const TreeModel& m, std::size_t joint,
                         const std::vector<double>& angle) {
  constexpr double kBeyond = 4.0;  // times the limit
  const auto& j = m.robot.joints[joint];
  if (m.prismatic(joint) || !j.limits || !(j.limits->lower < j.limits->upper)) return {};
  const double reach = std::max(std::abs(j.limits->lower), std::abs(j.limits->upper));
  double largest = 0.0;
  for (const double a : angle) largest = std::max(largest, std::abs(a));
  if (largest <= kBeyond * reach) return {};
  const bool degrees = largest * std::numbers::pi / 180.0 < 1.2 * reach;
  return log.path + ": " + core::printable(column_of(m, joint, "angle")) + " reaches " +
         core::rounded(largest) + " rad, and the URDF's limit is " + core::rounded(reach) + " rad" +
         (degrees ? ": is it in degrees? (a --map file with scale = 0.0174533 makes them radians)" : "") +
         ".";
}

}  // namespace

std::string column_of(const TreeModel& m, std::size_t joint, const std::string& quantity) {
  std::string prefix = quantity, unit = "rad";
  if (quantity.starts_with("torque")) unit = "nm";
  if (quantity == "velocity") unit = "radps";
  if (m.prismatic(joint)) {
    if (quantity.starts_with("torque")) {
      prefix = "force" + quantity.substr(6);
      unit = "n";
    } else if (quantity.starts_with("angle")) {
      prefix = "position" + quantity.substr(5);
      unit = "m";
    } else {
      unit = "mps";
    }
  }
  const std::string& name = m.robot.joints[joint].name;
  const auto logged = m.logged_names.find(name);
  return prefix + "_" + (logged == m.logged_names.end() ? name : logged->second) + "_" + unit;
}

/// The log's columns of the model's joints. What it lacks is told where it is read.
std::vector<log::Watched> watched(const TreeModel& m) {
  std::vector<log::Watched> all;
  for (std::size_t j = 0; j < m.joints(); ++j) {
    all.push_back({column_of(m, j, "angle"), true, m.prismatic(j) ? 0.0 : 2.0 * std::numbers::pi});
    for (const char* input : {"torque", "torque_cmd", "angle_cmd"})
      all.push_back({column_of(m, j, input), false});
  }
  return all;
}

const Phase& Recording::phase_at(std::size_t row) const {
  static const Phase kAll;
  if (phases.empty()) return kAll;
  const auto after = std::upper_bound(phases.begin(), phases.end(), row,
                                      [](std::size_t k, const Phase& p) { return k < p.first; });
  return after == phases.begin() ? phases.front() : *(after - 1);
}

namespace {

/// Changes of contact that follow each other sooner are one: of a switch that chatters, or a foot that bounces.
constexpr double kOneChange_s = 0.004;
/// A switch may be late by as much: these rows before a change are in no phase.
constexpr double kLate_s = 0.0025;
/// A phase of fewer rows is none.
constexpr std::size_t kFewestOfPhase = 10;

/// Angles are read off parabolas through the rows of so long.
constexpr double kFit_s = 0.03;

/// The value at `t` of a parabola through a joint's angles in rows `first` to `last`.
double parabola(const Recording& r, std::size_t joint, std::size_t first, std::size_t last, double t) {
  if (last < first + 3) return r.angle_rad[joint][first];
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = first; k <= last; ++k) {
    const double s = (r.time_s[k] - t) / kFit_s;
    const Eigen::Vector3d row(1.0, s, s * s);
    normal += row * row.transpose();
    right += row * r.angle_rad[joint][k];
  }
  return linear::solve_symmetric(normal, right)(0);
}
/// The last row up to `time_s`; at least five rows on, at most `last`.
std::size_t last_before(const Recording& r, std::size_t first, double time_s, std::size_t last) {
  std::size_t k = std::min(first + 5, last);
  while (k < last && r.time_s[k + 1] <= time_s) ++k;
  return k;
}

/// How late the switch is, of all hard touch-downs together: where the angles of flight and stance, each carried on, meet. Nothing where no
/// rate jumps by enough to tell.
void find_lateness(Recording& r) {
  constexpr double kLook_s = 1e-3, kClear = 12.0;
  double weights = 0.0, sum = 0.0;
  for (std::size_t i = 1; i < r.phases.size(); ++i) {
    const Phase &flight = r.phases[i - 1], &stance = r.phases[i];
    if (!stance.stance || flight.stance || r.time_s[stance.first] - r.time_s[flight.last] > 3.0 * kLate_s)
      continue;
    const auto start_of = [&](double span_s) {
      std::size_t k = flight.last;
      while (k > flight.first && (r.time_s[flight.last] - r.time_s[k] < span_s || flight.last - k < 5)) --k;
      return k;
    };
    for (std::size_t j = 0; j < r.angle_rad.size(); ++j) {
      // Parabolas of two lengths, now and a little earlier: they are off by as much as they differ.
      double flies[2][2], stands[2][2];
      for (int k = 0; k < 2; ++k)
        for (int early = 0; early < 2; ++early) {
          const double span_s = k == 0 ? kFit_s : 0.5 * kFit_s, t = stance.touchdown_s - early * kLook_s;
          flies[k][early] = parabola(r, j, start_of(span_s), flight.last, t);
          const std::size_t end = last_before(r, stance.first, r.time_s[stance.first] + span_s, stance.last);
          stands[k][early] = parabola(r, j, stance.first, end, t);
        }
      const double apart = stands[1][0] - flies[1][0], earlier = stands[1][1] - flies[1][1],
                   sd = std::hypot(r.angle_noise_rad[j],
                                   std::hypot(flies[0][0] - flies[1][0], stands[0][0] - stands[1][0])),
                   jump = apart - earlier;
      if (!(std::abs(jump) > kClear * sd)) continue;
      weights += jump * jump / (sd * sd);
      sum += jump * jump / (sd * sd) * std::clamp(kLook_s * apart / jump, -r.interval_s, 2.0 * kLate_s);
    }
  }
  if (!(weights > 0.0)) return;
  r.switch_late_s = std::max(-0.5 * r.interval_s, sum / weights);
  r.switch_late_precision = weights / (kLook_s * kLook_s);
}

/// Moves the touch-downs to so much before the switch's change.
void be_late(Recording& r, double late_s) {
  for (Phase& p : r.phases) {
    if (!p.stance) continue;
    p.touchdown_s = p.whole ? p.switched_s - late_s : r.time_s[p.first];
    p.at_touchdown_rad.clear();
    p.touchdown_sd_rad.clear();
    for (std::size_t j = 0; j < r.angle_rad.size(); ++j) {
      p.at_touchdown_rad.push_back(angle_after_touchdown(r, p, j, 0.0));
      p.touchdown_sd_rad.push_back(std::hypot(
          velocity_after_touchdown(r, p, j) * r.interval_s / std::sqrt(12.0), r.angle_noise_rad[j]));
    }
  }
}

std::vector<Phase> phases_of(const Recording& r, const std::vector<double>& contact) {
  const auto stands = [&](std::size_t k) { return contact[k] > 0.5; };
  std::vector<Phase> out;
  Phase now{0, 0, stands(0), false, {}, {}, 0.0, 0.0};
  const auto end = [&](std::size_t last) {
    now.last = last;
    if (last >= now.first + kFewestOfPhase) out.push_back(now);
  };
  for (std::size_t k = 1; k < r.rows(); ++k) {
    if (stands(k) == stands(k - 1)) continue;
    const std::size_t first =
        k;  // row after the first change, and after the last of those that are one with it
    std::size_t last = k;
    for (std::size_t i = k + 1; i < r.rows() && r.time_s[i] - r.time_s[last] < kOneChange_s; ++i)
      if (stands(i) != stands(i - 1)) last = i;
    k = last;
    // A switch that opens for a moment under a foot that stands.
    if (stands(first - 1) && stands(last)) continue;
    // The change lies between two rows, too.
    std::size_t before = first - 1;
    while (before > now.first && r.time_s[first - 1] - r.time_s[before] < kLate_s) --before;
    if (before > now.first) end(before);
    // A touch-down is somewhere in the interval before the first row that says so.
    const double change_s = r.time_s[first] - 0.5 * r.interval_s;
    now = {last + 1, 0, stands(last), true, {}, {}, change_s, change_s};
  }
  end(r.rows() - 1);
  return out;
}

}  // namespace

void require_motion(const TreeModel& m, const std::vector<Recording>& recordings) {
  const auto one_value = [&](const auto& column, std::size_t j) {
    return std::all_of(recordings.begin(), recordings.end(), [&](const Recording& r) {
      return std::all_of(column(r)[j].begin(), column(r)[j].end(),
                         [&](double x) { return x == column(recordings.front())[j].front(); });
    });
  };
  const auto angles = [](const Recording& r) -> const auto& { return r.angle_rad; };
  const auto inputs = [](const Recording& r) -> const auto& { return r.input; };
  for (std::size_t j = 0; j < m.joints(); ++j)
    if (one_value(angles, j) && !one_value(inputs, j))
      throw core::DataError(
          recordings.front().path + ": " + core::printable(column_of(m, j, "angle")) + " is " +
          core::rounded(recordings.front().angle_rad[j].front(), 6) +
          " in every row, as in all logs to fit, and its drive is not still; expected a joint that moves (one that is held belongs in [locked_joints] of " +
          m.file + ")");
}

void add_data_quality(log::DataQuality& data_quality, const Recording& r) {
  data_quality.refused.insert(data_quality.refused.end(), r.refused.begin(), r.refused.end());
  data_quality.notes.insert(data_quality.notes.end(), r.log_notes.begin(), r.log_notes.end());
}

Recording recording_of(const TreeModel& m, const log::Log& given, const std::vector<log::Refuted>& refuted) {
  constexpr std::size_t kFewest = 50;
  log::Clean clean = log::clean(given, watched(m), refuted);
  const log::Log& log = clean.log;
  if (log.rows() < kFewest)
    throw core::DataError(log.path + ": " + std::to_string(log.rows()) + " rows; expected at least " +
                          std::to_string(kFewest));
  Recording r;
  r.path = log.path;
  r.time_s = log.time_s();
  r.refused = log.refused;
  r.log_notes = log.notes;
  r.mapped = log.mapped;
  r.log_row = std::move(clean.row);
  std::vector<double> intervals;
  for (std::size_t i = 1; i < r.rows(); ++i) intervals.push_back(r.time_s[i] - r.time_s[i - 1]);
  r.interval_s = median(intervals);
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const std::string angle = column_of(m, j, "angle");
    if (!log.has(angle)) missing(log, m, j, "'" + angle + "'");
    r.angle_rad.push_back(log.at(angle));
    if (std::string note = beyond_limit(log, m, j, r.angle_rad.back()); !note.empty())
      r.log_notes.push_back(std::move(note));
    if (!m.driven(j)) {
      r.input_measured.push_back(false);
      r.input.emplace_back(r.rows(), 0.0);
      r.angle_noise_rad.push_back(noise_of(r.angle_rad.back()));
      continue;
    }
    const bool position = m.drives[j].law == ControlMode::position;
    const std::string measured = column_of(m, j, position ? "angle_cmd" : "torque");
    const std::string commanded = column_of(m, j, position ? "angle_cmd" : "torque_cmd");
    if (!log.has(measured) && !log.has(commanded))
      missing(log, m, j, position ? "'" + measured + "'" : "'" + measured + "' or '" + commanded + "'");
    r.input_measured.push_back(!position && log.has(measured));
    r.input.push_back(log.at(log.has(measured) ? measured : commanded));
    r.angle_noise_rad.push_back(noise_of(r.angle_rad.back()));
  }
  if (!m.foot) return r;
  const std::string contact = "contact_" + m.foot->name;
  if (!log.has(contact))
    throw core::DataError(log.path + ": foot " + core::quoted(m.foot->name) + " has no column " +
                          core::quoted(contact) + "; expected 1 in rows in which it stands, else 0");
  r.phases = phases_of(r, log.at(contact));
  if (r.phases.empty())
    throw core::DataError(
        log.path + ": " + core::quoted(contact) +
        " changes all the time; expected stances and flights of some hundredths of a second");
  find_lateness(r);
  be_late(r, r.switch_late_s);
  return r;
}

void share_lateness(std::vector<Recording>& training, std::vector<Recording>& held_out) {
  // Where no touch-down tells, this is how well a switch's lateness is known.
  constexpr double kUsual_s = 1.2e-3;
  if (std::all_of(training.begin(), training.end(), [](const Recording& r) { return r.phases.empty(); }))
    return;
  double weights = 1.0 / (kUsual_s * kUsual_s), sum = 0.0, squares = 0.0, count = 0.0;
  for (const Recording& r : training) {
    weights += r.switch_late_precision;
    sum += r.switch_late_precision * r.switch_late_s;
    count += r.switch_late_precision > 0.0 ? 1.0 : 0.0;
  }
  const double late_s = sum / weights;
  for (const Recording& r : training)
    squares += r.switch_late_precision * std::pow(r.switch_late_s - late_s, 2);
  // By what each is said to be worth, or by how they scatter where that is more.
  const double scatter = count > 1.0 ? squares / (count - 1.0) : 1.0,
               sd_s = std::sqrt(std::max(1.0, scatter) / weights);
  for (auto* recordings : {&training, &held_out})
    for (Recording& r : *recordings) {
      be_late(r, late_s);
      r.switch_late_sd_s = sd_s;
    }
}

LocalState local_state(const Recording& r, std::size_t joint, std::size_t row, double half_s) {
  constexpr std::size_t kLeast = 3;  // rows on each side, where there are
  const double t0 = r.time_s[row];
  std::size_t first = row, last = row;
  const Phase& phase = r.phase_at(row);
  const std::size_t begin = row >= phase.first && row <= phase.last ? phase.first : 0,
                    end = row >= phase.first && row <= phase.last ? std::min(phase.last, r.rows() - 1) + 1
                                                                  : r.rows();
  while (first > begin && (t0 - r.time_s[first - 1] <= half_s || row - first < kLeast)) --first;
  while (last + 1 < end && (r.time_s[last + 1] - t0 <= half_s || last - row < kLeast)) ++last;
  const auto& x = r.angle_rad[joint];
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const double unit = std::max(r.time_s[last] - t0, t0 - r.time_s[first]);
  for (std::size_t i = first; i <= last; ++i) {
    const double s = (r.time_s[i] - t0) / unit;
    const Eigen::Vector4d row_of(1.0, s, s * s, s * s * s);
    normal += row_of * row_of.transpose();
    right += row_of * (x[i] - x[row]);
  }
  // At an end of the recording a cubic has too much freedom: the last column is damped there.
  const Eigen::Matrix4d inverse =
      (normal + Eigen::Matrix4d(Eigen::Vector4d(0, 0, 1e-9, 1e-6).asDiagonal())).inverse();
  const Eigen::Vector4d c = inverse * right;
  const double sd = r.angle_noise_rad[joint];
  return {x[row] + c(0), c(1) / unit, 2.0 * c(2) / (unit * unit), sd * std::sqrt(inverse(0, 0)),
          sd * std::sqrt(inverse(1, 1)) / unit};
}

double velocity_about(const Recording& r, std::size_t joint, std::size_t row) {
  const std::size_t next = std::min(row + 1, r.rows() - 1), before = row > 0 ? row - 1 : 0;
  return (r.angle_rad[joint][next] - r.angle_rad[joint][before]) / (r.time_s[next] - r.time_s[before]);
}

bool gap_after(const Recording& r, std::size_t row) {
  return r.time_s[row + 1] - r.time_s[row] >= 5.0 * r.interval_s + 1e-3;
}

double angle_after_touchdown(const Recording& r, const Phase& p, std::size_t joint, double delay_s) {
  const double t = p.touchdown_s + delay_s, from = std::max(r.time_s[p.first], t - 0.5 * kFit_s);
  std::size_t first = p.first;
  while (first < p.last && r.time_s[first] < from) ++first;
  return parabola(r, joint, first, last_before(r, first, from + kFit_s, p.last), t);
}

double velocity_after_touchdown(const Recording& r, const Phase& p, std::size_t joint) {
  constexpr double kAfter_s = 5e-3;
  return (angle_after_touchdown(r, p, joint, kAfter_s) - angle_after_touchdown(r, p, joint, 0.0)) / kAfter_s;
}

Recording part_of(const Recording& r, std::size_t first, std::size_t last) {
  const auto cut = [&](const std::vector<double>& x) {
    return std::vector<double>(x.begin() + static_cast<std::ptrdiff_t>(first),
                               x.begin() + static_cast<std::ptrdiff_t>(last + 1));
  };
  Recording out;
  out.path = r.path;
  out.time_s = cut(r.time_s);
  for (const auto& x : r.angle_rad) out.angle_rad.push_back(cut(x));
  for (const auto& x : r.input) out.input.push_back(cut(x));
  out.angle_noise_rad = r.angle_noise_rad;
  out.input_measured = r.input_measured;
  out.interval_s = r.interval_s;
  if (r.phases.empty()) return out;
  Phase phase = r.phase_at(first);
  phase.first = 0;
  phase.last = last - first;
  out.phases = {std::move(phase)};
  return out;
}

std::vector<std::string> foreign_joints(const TreeModel& m, const log::Log& log) {
  std::vector<std::string> out;
  const auto known = [&](std::string_view joint) {
    return std::any_of(m.urdf.joints.begin(), m.urdf.joints.end(),
                       [&](const model::UrdfJoint& j) { return j.name == joint; }) ||
           std::any_of(m.logged_names.begin(), m.logged_names.end(),
                       [&](const auto& pair) { return pair.second == joint; });
  };
  for (const auto& [column, values] : log.columns) {
    // angle_cmd_y_rad is the angle of a joint cmd_y where there is one.
    std::string first;
    bool ours = false;
    for (const log::ColumnPattern& p : log::kTreeColumns) {
      const std::string_view joint = p.joint_in(column);
      if (joint.empty() || p.unit.empty()) continue;
      ours |= known(joint);
      if (first.empty()) first = joint;
    }
    if (!ours && !first.empty() && std::find(out.begin(), out.end(), first) == out.end())
      out.push_back(first);
  }
  return out;
}

}  // namespace furcula::trees
