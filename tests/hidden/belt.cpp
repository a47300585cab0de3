// See belt.hpp.
#include "tests/hidden/belt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace furcula::hidden {

namespace {

constexpr double kGravity_mps2 = 9.81;
constexpr double kStep_s = 50e-6, kEventWidth_s = 1e-10, kRow_s = 1e-3;

double value(const Truth& truth, std::string_view name) {
  return truth.parameters.at(*dynamics::parameter_index(truth.kind, name));
}

}  // namespace

Belt::Belt(const Truth& truth)
    : mass_(value(truth, "load_mass_kg")),
      radius_(value(truth, "pulley_radius_m")),
      inertia_(mass_ * radius_ * radius_ + value(truth, "pulley_inertia_kgm2")),
      damping_(value(truth, "damping_nmspr")),
      spring_npm_(value(truth, "auxiliary_stiffness_npm")),
      pitch_rad_(value(truth, "tooth_pitch_m") / radius_),
      disturbed_(truth.disturbance, truth.draw) {
  for (const Planted& p : truth.planted) {
    const auto [v0, v1, v2] = p.values;
    if (p.law == "coulomb_friction") friction_nm_ = v0;
    if (p.law == "damping_error") damping_ = v0;
    if (p.law == "clutch_slip") holding_n_ = v0;
    if (p.law == "auxiliary_spring") spring_npm_ = v0;
    if (p.law == "cable_snag") {
      snag_nm_ = v0;
      snag_from_ = v1 - v2 / 2;
      snag_to_ = v1 + v2 / 2;
    }
    if (p.law == "warming_friction") {
      warm_nm_ = v0;
      warming_s_ = v1;
    }
  }
}

void Belt::pull_key() { state_ = State::loose; }
void Belt::press_key() {
  if (state_ == State::loose) state_ = State::seeking;
}

double Belt::torque(double angle, double speed, bool with_friction) const {
  double sum = mass_ * kGravity_mps2 * radius_ - spring_npm_ * radius_ * radius_ * angle - damping_ * speed +
               disturbed_.force(time_s_);
  double dry = friction_nm_ + warm_nm_ * (1 - std::exp(-time_s_ / warming_s_));
  if (angle > snag_from_ && angle < snag_to_) dry += snag_nm_;
  if (state_ == State::skipping && with_friction) dry += holding_n_ * radius_;
  if (speed != 0) return sum - std::copysign(dry, speed);
  return std::abs(sum) <= dry ? 0.0 : sum - std::copysign(dry, sum);
}

void Belt::stepped(double h, double& angle, double& speed) const {
  const auto rate = [&](double a, double v) { return torque(a, v, true) / inertia_; };
  const double v1 = speed, a1 = rate(angle, v1);
  const double v2 = speed + h / 2 * a1, a2 = rate(angle + h / 2 * v1, v2);
  const double v3 = speed + h / 2 * a2, a3 = rate(angle + h / 2 * v2, v3);
  const double v4 = speed + h * a3, a4 = rate(angle + h * v3, v4);
  angle += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
  speed += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
}

/// The first one beyond the present angle, in that direction.
double Belt::next_tooth(int direction) const {
  constexpr double kOn = 1e-7;
  const double teeth = (angle_ - from_) / pitch_rad_;
  return from_ + pitch_rad_ * (direction > 0 ? std::floor(teeth + kOn) + 1 : std::ceil(teeth - kOn) - 1);
}

/// Of a belt on a tooth: whether the load is no more than what it holds.
bool Belt::bears() const {
  const int direction = speed_ != 0 ? (speed_ > 0 ? 1 : -1) : torque(angle_, 0, false) >= 0 ? 1 : -1;
  const double pull = direction * torque(angle_ + direction * pitch_rad_ / 2, speed_, false) / radius_;
  const double energy = 0.5 * inertia_ * speed_ * speed_;
  return holding_n_ >= pull + energy / (pitch_rad_ * radius_);
}

void Belt::advance(double until_s) {
  while (time_s_ < until_s - 1e-15) {
    double h = std::min(kStep_s, until_s - time_s_);
    if (state_ == State::held) {
      time_s_ += h;
      continue;
    }
    const int direction = speed_ != 0 ? (speed_ > 0 ? 1 : -1) : torque(angle_, 0, false) > 0 ? 1 : -1;
    const double tooth = next_tooth(direction);
    const bool seeks = state_ == State::seeking || state_ == State::skipping;
    const auto passes = [&](double t) {
      double a = angle_, v = speed_;
      stepped(t, a, v);
      return (seeks && direction * (a - tooth) >= 0) || (speed_ != 0 && v * speed_ < 0);
    };
    if (passes(h)) {
      double before = 0, after = h;
      while (after - before > kEventWidth_s) {
        const double middle = (before + after) / 2;
        (passes(middle) ? after : before) = middle;
      }
      h = after;
      const double was = speed_;
      stepped(h, angle_, speed_);
      time_s_ += h;
      if (was != 0 && speed_ * was <= 0) speed_ = 0;
      if (seeks && direction * (angle_ - tooth) >= -1e-9) {
        angle_ = tooth;
        if (bears()) {
          state_ = State::held;
          speed_ = 0;
        } else {
          state_ = State::skipping;
          ++skipped_;
        }
      }
      continue;
    }
    stepped(h, angle_, speed_);
    time_s_ += h;
  }
}

log::Log record_bench(const Truth& truth, const BenchExperiment& experiment, const BenchSensors& sensors,
                      Random& random) {
  Belt belt(truth);
  const double release_s = value(truth, "release_delay_s");
  double catch_s = value(truth, "catch_delay_s"), spread_s = 0;
  if (const auto* late = find(truth.planted, "late_catch")) catch_s = (*late)[0];
  if (const auto* loose = find(truth.planted, "catch_scatter")) spread_s = (*loose)[0];
  const auto* slip = find(truth.planted, "encoder_slip");
  const double offset = random.uniform(-0.5, 0.5);
  log::Log log;
  log.rig = "clutch_bench";
  log.columns = {{"time_s", {}}, {"pulley_angle_rad", {}}, {"solenoid", {}}};
  std::vector<std::pair<double, bool>> key;  // when it goes out, or comes
  std::size_t next = 0, row = 0;
  const auto rows = [&](double for_s, bool on) {
    for (std::size_t end = row + static_cast<std::size_t>(std::lround(for_s / kRow_s)); row < end; ++row) {
      const double now = static_cast<double>(row) * kRow_s;
      while (next < key.size() && key[next].first <= now) {
        belt.advance(key[next].first);
        key[next].second ? belt.pull_key() : belt.press_key();
        ++next;
      }
      belt.advance(now);
      double seen = belt.angle_rad() + sensors.noise_rad * random.normal();
      if (slip && now >= (*slip)[1]) seen += (*slip)[0];
      log.columns["time_s"].push_back(now);
      log.columns["pulley_angle_rad"].push_back(sensors.quantum_rad *
                                                (std::round(seen / sensors.quantum_rad + offset) - offset));
      log.columns["solenoid"].push_back(on ? 1.0 : 0.0);
    }
  };
  for (double window_s : experiment.windows_s) {
    rows(experiment.rest_s, false);
    const double on_s = static_cast<double>(row) * kRow_s;
    const double whole_s = std::round(window_s / kRow_s) * kRow_s;
    key.push_back({on_s + release_s, true});
    key.push_back({on_s + whole_s + std::max(1e-3, catch_s + spread_s * random.normal()), false});
    rows(whole_s, true);
  }
  rows(experiment.rest_s, false);
  // Rows that the rig lost.
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < row; ++i)
    if (i == 0 || i + 1 == row || !random.chance(sensors.dropped_fraction)) kept.push_back(i);
  for (auto& [name, column] : log.columns) {
    std::vector<double> some;
    for (std::size_t i : kept) some.push_back(column[i]);
    column = std::move(some);
  }
  return log;
}

}  // namespace furcula::hidden
