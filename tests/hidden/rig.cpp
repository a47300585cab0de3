// See rig.hpp.
#include "tests/hidden/rig.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace furcula::hidden {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kRow_s = 1e-3;
constexpr double kNever = std::numeric_limits<double>::infinity();

double quantised(double value, double quantum, double offset_counts) {
  return quantum * (std::round(value / quantum + offset_counts) - offset_counts);
}

void note(Trajectory& truth, const Machine& m, double command) {
  truth.time_s.push_back(m.time_s());
  truth.position.push_back(m.position());
  truth.velocity.push_back(m.velocity());
  truth.command.push_back(command);
}

// The position sensor: what it makes of a true position, before noise and quantisation.
class PositionSensor {
 public:
  PositionSensor(const Truth& truth, double touchdown_height_m) : centre_(touchdown_height_m) {
    if (const auto* v = find(truth.planted, "encoder_offset")) offset_ = (*v)[0];
    if (const auto* v = find(truth.planted, "height_scale_error")) scale_ = (*v)[0];
    if (const auto* v = find(truth.planted, "height_eccentricity")) wheel_ = *v;
    if (const auto* v = find(truth.planted, "encoder_slip")) slip_ = *v;
    if (const auto* v = find(truth.planted, "wandering_zero")) wander_ = *v;
    if (const auto* v = find(truth.planted, "torque_crosstalk")) crosstalk_ = (*v)[0];
    if (const auto* v = find(truth.planted, "time_skew")) skew_s_ = (*v)[0];
    if (const auto* v = find(truth.planted, "sticking_counts")) sticking_ = (*v)[0];
  }
  double skew_s() const { return skew_s_; }
  double operator()(double x, double time_s, double command) const {
    double seen = centre_ + scale_ * (x - centre_) + offset_ + crosstalk_ * command;
    if (wheel_[0] != 0) seen += wheel_[0] * std::sin(kTwoPi * x / wheel_[1] + wheel_[2]);
    if (slip_[0] != 0 && time_s >= slip_[1]) seen += slip_[0];
    if (wander_[0] != 0) seen += wander_[0] * std::sin(kTwoPi * time_s / wander_[1] + wander_[2]);
    return seen;
  }
  /// A reading that sticks: it moves on only once it would be off by more than so much.
  double stuck(double reading) {
    if (sticking_ > 0 && std::abs(reading - shown_) < sticking_) return shown_;
    shown_ = reading;
    return reading;
  }

 private:
  double centre_, offset_ = 0, scale_ = 1, crosstalk_ = 0, skew_s_ = 0, sticking_ = 0;
  Values wheel_{}, slip_{}, wander_{};
  double shown_ = std::numeric_limits<double>::quiet_NaN();
};

// True position between the rows, to well below a count; what an impact bends within a row is lost.
double position_at(const Trajectory& t, double time_s) {
  const auto after = std::upper_bound(t.time_s.begin(), t.time_s.end(), time_s);
  if (after == t.time_s.begin()) return t.position.front();
  if (after == t.time_s.end()) return t.position.back();
  const auto i = static_cast<std::size_t>(after - t.time_s.begin());
  const double h = t.time_s[i] - t.time_s[i - 1], s = (time_s - t.time_s[i - 1]) / h;
  return t.position[i - 1] * (1 + 2 * s) * (1 - s) * (1 - s) + t.position[i] * s * s * (3 - 2 * s) +
         h * s * (1 - s) * (t.velocity[i - 1] * (1 - s) - t.velocity[i] * s);
}

// Of the rows, those whose skewed position lies beyond the recording's end.
std::size_t rows_beyond(const std::vector<double>& time_s, double skew_s) {
  std::size_t rows = 0;
  while (rows < time_s.size() && time_s[time_s.size() - 1 - rows] - skew_s > time_s.back()) ++rows;
  return rows;
}

// Rows lost on the way to the disk; the first and last stay.
void drop_rows(log::Log& log, double fraction, Random& random) {
  if (fraction <= 0) return;
  const std::size_t rows = log.rows();
  std::vector<char> kept(rows, 1);
  for (std::size_t i = 1; i + 1 < rows; ++i)
    if (random.chance(fraction)) kept[i] = 0;
  for (auto& [name, column] : log.columns) {
    std::size_t to = 0;
    for (std::size_t from = 0; from < rows; ++from)
      if (kept[from]) column[to++] = column[from];
    column.resize(to);
  }
}

// Backward difference over at least 8 ms (fewer rows at the start; the first is 0).
std::vector<double> derived_velocity(const std::vector<double>& time_s, const std::vector<double>& position) {
  constexpr double kSpan_s = 8e-3;
  std::vector<double> velocity(time_s.size(), 0.0);
  std::size_t from = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    while (from + 1 < i && time_s[i] - time_s[from + 1] >= kSpan_s - 1e-9) ++from;
    velocity[i] = (position[i] - position[from]) / (time_s[i] - time_s[from]);
  }
  return velocity;
}

// The profile's torque; positive torque flexes the leg, so it pumps energy in while the body sinks.
double profile_torque(const HopperExperiment& e, double since_touchdown_s, double velocity_mps) {
  switch (e.profile) {
    case Profile::none:
      return 0.0;
    case Profile::harmonic:
      return e.amplitude_nm * std::sin(kTwoPi * since_touchdown_s / e.period_s);
    case Profile::constant:
      return velocity_mps < 0 ? e.amplitude_nm : -e.amplitude_nm;
  }
  return 0.0;
}

// The switch reports an event before or after it happens, so the machine_type is run ahead to know when it will.
class ContactSwitch {
 public:
  ContactSwitch(const HopperSensors& sensors, double delay_s, Random& random)
      : sensors_(sensors), delay_s_(delay_s), random_(random) {}

  // When the toe will touch down has changed.
  void look_again() { flight_ = std::numeric_limits<double>::quiet_NaN(); }

  // Called once a row. `torque_ahead(time, velocity)` is what the rig would command from here on.
  template <class Torque>
  bool raw(const Machine& m, const Torque& torque_ahead) {
    constexpr double kUnseenFlight_s = 0.03;
    const double now = m.time_s();
    if (!m.stance() && !(flight_ == m.liftoff_s())) {
      flight_ = m.liftoff_s();
      Machine ahead = m;
      while (!ahead.stance() && ahead.time_s() < now + 1.0) ahead.advance(ahead.time_s() + kRow_s, 0.0);
      const double touchdown = ahead.touchdown_s();
      if (touchdown - now < kUnseenFlight_s) {
        opens_ = kNever;
        if (!closed_) closes_ = touchdown;
      } else {
        if (closed_ && opens_ == kNever) opens_ = m.liftoff_s() + std::abs(error());
        closes_ = touchdown + error();
      }
    }
    if (m.stance() && m.velocity() <= 0) {
      rising_ = false;
      // It opened too early, and the body came down again without leaving the ground.
      if (!closed_ && closes_ == kNever) closes_ = now;
    }
    if (m.stance() && m.velocity() > 0 && !rising_) {
      rising_ = true;
      Machine ahead = m;
      while (ahead.stance() && ahead.velocity() > 0 && ahead.time_s() < now + 0.4)
        ahead.advance(ahead.time_s() + kRow_s, torque_ahead(ahead.time_s(), ahead.velocity()));
      if (!ahead.stance() && closed_) opens_ = ahead.liftoff_s() + error();
    }
    if (opens_ <= now) change(opens_, false);
    if (closes_ <= now && opens_ == kNever) change(closes_, true);
    return now - changed_s_ < sensors_.bounce_s ? random_.chance(0.5) : closed_;
  }

 private:
  double error() { return delay_s_ + random_.uniform(-sensors_.report_error_s, sensors_.report_error_s); }
  void change(double& when, bool closed) {
    if (closed_ != closed) changed_s_ = when;
    closed_ = closed;
    when = kNever;
  }

  const HopperSensors& sensors_;
  double delay_s_;
  Random& random_;
  bool closed_ = false, rising_ = false;
  double changed_s_ = -1.0, flight_ = std::numeric_limits<double>::quiet_NaN();
  double opens_ = kNever, closes_ = kNever;  // when the next reports come
};

}  // namespace

HopperRecording record_hopper(const Truth& truth, const HopperExperiment& experiment,
                              const HopperSensors& sensors, Random& random) {
  constexpr double kVibration_hz = 60.0, kVibrationDecay_s = 0.010, kShortestStance_s = 0.05;
  constexpr double kAngleCount_rad = kTwoPi / 16384, kCurrentNoise_nm = 0.01;
  constexpr double kGravity_mps2 = 9.81, kCaught_s = 0.035;  // that the key takes, and a margin
  Machine m(truth, experiment.drop_height_m, 0.0);
  PositionSensor sensor(truth, m.touchdown_height_m());
  const auto* switch_delay = find(truth.planted, "contact_delay");
  ContactSwitch contact_switch(sensors, switch_delay ? (*switch_delay)[0] : 0.0, random);
  const double offset_counts = random.uniform(-0.5, 0.5);
  // What only some logs hold has its own draws, so that a log is the same with and without.
  Random more(static_cast<std::uint64_t>(1e9 * (offset_counts + 1)));
  HopperRecording out;
  std::vector<double> time, height, contact, torque, drive_torque, leg_angle, noise;
  struct Impact {
    double time_s, speed_mps;
  };
  std::vector<Impact> impacts;
  const auto vibration = [&](double t) {
    double sum = 0.0;
    for (auto i = impacts.rbegin(); i != impacts.rend() && t - i->time_s < 6 * kVibrationDecay_s; ++i)
      if (t > i->time_s)
        sum += sensors.vibration_m * i->speed_mps * std::exp(-(t - i->time_s) / kVibrationDecay_s) *
               std::sin(kTwoPi * kVibration_hz * (t - i->time_s));
    return sum;
  };

  bool believes_stance = false, was_closed = false;
  double stance_s = 0.2;  // the last one's length
  double believed_touchdown_s = 0.0, impact_mps = 0.0, moved_s = 0.0, last_liftoff = m.liftoff_s();
  double command = 0.0;
  const bool clutched = truth.clutch[3] > 0;
  const auto* late = find(truth.planted, "late_catch");
  const double release_s = truth.clutch[0], catch_s = late ? (*late)[0] : truth.clutch[1];
  std::vector<double> solenoid;
  double on_s = kNever, off_s = kNever;  // of the coil, next
  bool coil = false;
  std::vector<std::pair<double, bool>> key;  // when it goes out, or comes back
  std::size_t next_key = 0;
  int stances = 0;
  bool home_due = false;
  double left_s = kNever;  // the last believed lift-off
  std::size_t next_fold = 0;
  bool folds = false;  // in this flight
  for (int row = 0;; ++row) {
    const double now = row * kRow_s;

    // What the sensors say.
    noise.push_back(sensors.noise_m * random.normal());
    if (m.touchdown_s() >= 0 && (impacts.empty() || impacts.back().time_s != m.touchdown_s()))
      impacts.push_back({m.touchdown_s(), impact_mps});
    const double seen = sensor(m.position(), now, command) + vibration(now) + noise.back();
    const bool closed = contact_switch.raw(m, [&](double t, double velocity) {
      return believes_stance ? profile_torque(experiment, t - believed_touchdown_s, velocity) : 0.0;
    });
    time.push_back(now);
    height.push_back(sensor.stuck(quantised(seen, sensors.quantum_m, offset_counts)));
    contact.push_back(closed ? 1.0 : 0.0);
    leg_angle.push_back(quantised(m.motor_angle_rad(), kAngleCount_rad, offset_counts));

    // What the controller makes of it: a change of phase when the switch says the same twice running.
    if (!believes_stance && closed && was_closed) {
      believes_stance = true;
      believed_touchdown_s = now;
    } else if (believes_stance && !closed && !was_closed && now - believed_touchdown_s > kShortestStance_s) {
      believes_stance = false;
      stance_s = now - believed_touchdown_s;
      left_s = now;
      // Thrown up so fast, the body is back after twice the speed over gravity.
      const double room_s = 2 * m.velocity() / kGravity_mps2 - kCaught_s;
      folds = !experiment.folds.empty() &&
              room_s > experiment.folds.front().after_s + experiment.folds.front().length_s;
      next_fold = 0;
    }
    was_closed = closed;
    while (folds && !believes_stance && !m.stance() && next_fold < experiment.folds.size() &&
           now >= left_s + experiment.folds[next_fold].after_s - 1e-9) {
      m.fold_leg(experiment.folds[next_fold].depth_m, experiment.folds[next_fold].length_s);
      contact_switch.look_again();
      ++next_fold;
    }
    if (clutched && !experiment.folds.empty()) {
      const auto& first = experiment.folds.front();
      const double from_s = left_s + first.after_s - release_s - 2e-3;
      const bool on =
          folds && !believes_stance && now >= from_s && now < left_s + first.after_s + first.length_s;
      if (on != coil) key.emplace_back(now + (on ? release_s : catch_s), on);
      coil = on;
      solenoid.push_back(coil ? 1.0 : 0.0);
    } else if (clutched) {
      // In every second stance the spring is let go for a while, late in the push-off, as the one before
      // went: earlier it would cost the hop. In the flight after it the cable goes home.
      const bool now_stands = believes_stance && believed_touchdown_s == now;
      const bool now_flies = !believes_stance && home_due && on_s == kNever && !coil;
      if (now_stands && ++stances % 2 == 0) {
        home_due = true;
        on_s = now + std::round(1e3 * (stance_s - more.uniform(0.03, 0.07))) * 1e-3;
        off_s = on_s + std::round(1e3 * more.uniform(0.015, 0.06)) * 1e-3;
      } else if (now_flies) {
        on_s = now + 0.02;
        off_s = on_s + 0.02;
        home_due = false;
      }
      if (!coil && now >= on_s - 1e-9) {
        coil = true;
        on_s = kNever;
        key.emplace_back(now + release_s, true);
      } else if (coil && now >= off_s - 1e-9) {
        coil = false;
        key.emplace_back(now + catch_s, false);
      }
      solenoid.push_back(coil ? 1.0 : 0.0);
    }
    const std::size_t back = std::min<std::size_t>(time.size() - 1, 8);
    const double rising = height.back() - height[height.size() - 1 - back];
    command = believes_stance ? profile_torque(experiment, now - believed_touchdown_s, rising) : 0.0;
    // The motor moves the leg then, and nothing else.
    if (!believes_stance && !m.stance() && m.leg_length_m() < m.touchdown_height_m() - 1e-4) command = 0.8;
    torque.push_back(command);
    drive_torque.push_back(m.reported_torque(command) + kCurrentNoise_nm * more.normal());
    note(out.truth, m, command);

    // When to stop: enough hops, too long, or the body at rest.
    if (m.liftoff_s() != last_liftoff) ++out.liftoffs;
    last_liftoff = m.liftoff_s();
    if (std::abs(m.velocity()) > 5e-3) moved_s = now;
    if (out.liftoffs > experiment.hops || now >= experiment.longest_s || now - moved_s > 0.1) break;

    if (!m.stance()) impact_mps = std::abs(m.velocity());
    while (next_key < key.size() && key[next_key].first < (row + 1) * kRow_s) {
      m.advance(std::max(now, key[next_key].first), command);
      key[next_key++].second ? m.pull_key() : m.press_key();
    }
    m.advance((row + 1) * kRow_s, command);
  }
  out.ground_pulled = m.ground_pulled();

  // The skew is the log's: what the sensor saw at another instant stands in the row.
  std::size_t beyond = 0;
  if (const double skew = sensor.skew_s(); skew != 0) {
    PositionSensor skewed(truth, m.touchdown_height_m());
    for (std::size_t i = 0; i < time.size(); ++i) {
      const double t = time[i] - skew;
      const double seen = skewed(position_at(out.truth, t), t, torque[i]) + vibration(t) + noise[i];
      height[i] = skewed.stuck(quantised(seen, sensors.quantum_m, offset_counts));
    }
    beyond = rows_beyond(time, skew);
  }

  out.log.rig = "hopper";
  out.log.columns = {{"time_s", time}, {"height_m", height}, {"contact", contact}, {"torque_cmd_nm", torque}};
  if (sensors.velocity_column) out.log.columns["velocity_mps"] = derived_velocity(time, height);
  if (sensors.torque_column) out.log.columns["torque_nm"] = drive_torque;
  if (sensors.leg_angle_column) out.log.columns["leg_angle_rad"] = leg_angle;
  if (clutched) out.log.columns["solenoid"] = solenoid;
  for (auto& [name, column] : out.log.columns) column.resize(column.size() - beyond);
  drop_rows(out.log, sensors.dropped_fraction, random);
  return out;
}

double Course::at(double time_s) const {
  double position = 0.0;
  if (!moves.empty()) {
    position = moves.front().from;
    for (const Move& m : moves) {
      if (time_s < m.begin_s) break;
      const double s = std::min(1.0, (time_s - m.begin_s) / (m.end_s - m.begin_s));
      position = m.from + (m.to - m.from) * s * s * s * (10 + s * (6 * s - 15));
    }
  }
  const double fade = std::clamp(time_s / 0.5, 0.0, 1.0), smooth_fade = fade * fade * (3 - 2 * fade);
  for (const Sine& s : sines)
    position += smooth_fade * s.amplitude * std::sin(kTwoPi * s.frequency_hz * time_s + s.phase_rad);
  return position;
}

double Course::velocity(double time_s) const {
  constexpr double kH = 1e-4;
  return (at(time_s + kH) - at(time_s - kH)) / (2 * kH);
}

double Course::acceleration(double time_s) const {
  constexpr double kH = 1e-3;
  return (at(time_s + kH) - 2 * at(time_s) + at(time_s - kH)) / (kH * kH);
}

AxisRecording record_axis(const Truth& truth, const std::vector<double>& known,
                          const AxisExperiment& experiment, const AxisSensors& sensors, Random& random) {
  constexpr double kCurrentNoise = 5e-3;  // of the largest reported torque
  const bool rotary = truth.kind == Kind::rotary_joint;
  const double inertia = known[0], gravity = rotary ? known[1] : 0.0, damping = known[rotary ? 2 : 1];
  const double bandwidth = kTwoPi * experiment.feedback_hz;
  Machine m(truth, experiment.start_position, experiment.start_velocity);
  PositionSensor sensor(truth, 0.0);
  const double offset_counts = random.uniform(-0.5, 0.5);
  AxisRecording out;
  std::vector<double> time, position, input, reported, reference, noise;
  double filtered_velocity = 0.0, command = 0.0;

  for (double now = 0.0; now <= experiment.duration_s;) {
    noise.push_back(sensors.noise * random.normal());
    const double seen = sensor.stuck(
        quantised(sensor(m.position(), now, command) + noise.back(), sensors.quantum, offset_counts));
    if (!position.empty()) {
      const double dt = now - time.back();
      filtered_velocity += dt / (dt + 5e-3) * ((seen - position.back()) / dt - filtered_velocity);
    }
    command = 0.0;
    if (experiment.feedback_hz > 0) {
      const double target = experiment.course.at(now), target_velocity = experiment.course.velocity(now);
      command = inertia * (experiment.course.acceleration(now) + bandwidth * bandwidth * (target - seen) +
                           1.4 * bandwidth * (target_velocity - filtered_velocity)) +
                damping * target_velocity + gravity * std::sin(target);
    }
    for (const Sine& s : experiment.open_loop)
      command += s.amplitude * std::sin(kTwoPi * s.frequency_hz * now + s.phase_rad);
    command = std::clamp(command, -experiment.limit, experiment.limit);

    time.push_back(now);
    position.push_back(seen);
    input.push_back(command);
    reported.push_back(m.reported_torque(command));
    note(out.truth, m, command);
    reference.push_back(experiment.course.at(now));
    now = sensors.interval_spread_s > 0 ? now + sensors.interval_s + sensors.interval_spread_s * random.unit()
                                        : static_cast<double>(time.size()) * sensors.interval_s;
    m.advance(now, command, 100e-6);
  }

  std::size_t beyond = 0;
  if (const double skew = sensor.skew_s(); skew != 0) {
    PositionSensor skewed(truth, 0.0);
    for (std::size_t i = 0; i < time.size(); ++i) {
      const double t = time[i] - skew;
      position[i] = skewed.stuck(quantised(skewed(position_at(out.truth, t), t, input[i]) + noise[i],
                                           sensors.quantum, offset_counts));
    }
    beyond = rows_beyond(time, skew);
  }

  log::Log& log = out.log;
  log.rig = std::string(dynamics::info(truth.kind).rig);
  log.columns = {{"time_s", time}};
  log.columns[rotary ? "angle_rad" : "position_m"] = position;
  log.columns[rotary ? "torque_nm" : "force_n"] = input;
  if (!rotary && experiment.feedback_hz > 0) log.columns["reference_m"] = reference;
  if (sensors.velocity_column)
    log.columns[rotary ? "velocity_radps" : "velocity_mps"] = derived_velocity(time, position);
  if (rotary && sensors.drive_reports) {
    Random more(static_cast<std::uint64_t>(1e9 * (offset_counts + 1)));
    double largest = 0.0;
    for (double r : reported) largest = std::max(largest, std::abs(r));
    for (double& r : reported) r += kCurrentNoise * largest * more.normal();
    log.columns["torque_cmd_nm"] = input;
    log.columns["torque_nm"] = reported;
  }
  for (auto& [name, column] : log.columns) column.resize(column.size() - beyond);
  drop_rows(log, sensors.dropped_fraction, random);
  return out;
}

AxisRecording record_carriage(const Truth& truth, const CarriageExperiment& experiment,
                              const AxisSensors& sensors, Random& random) {
  PositionSensor sensor(truth, 0.0);
  const double offset_counts = random.uniform(-0.5, 0.5);
  AxisRecording out;
  std::vector<double> time, height, contact;
  const auto row = [&](double x, double v, bool held) {
    const double now = static_cast<double>(time.size()) * sensors.interval_s;
    time.push_back(now);
    height.push_back(sensor.stuck(
        quantised(sensor(x, now, 0.0) + sensors.noise * random.normal(), sensors.quantum, offset_counts)));
    contact.push_back(held ? 1.0 : 0.0);
    out.truth.time_s.push_back(now);
    out.truth.position.push_back(x);
    out.truth.velocity.push_back(v);
    out.truth.command.push_back(0.0);
    out.truth.held.push_back(held);
  };
  const auto fly = [&](double from, double speed) {
    const auto first = static_cast<double>(time.size());
    Machine m(truth, from, speed, first * sensors.interval_s);
    for (double rows = 0; m.position() > 0 || rows == 0; ++rows) {
      row(m.position(), m.velocity(), false);
      m.advance((first + rows + 1) * sensors.interval_s, 0.0);
    }
  };
  if (experiment.fall_m > 0.0) fly(experiment.fall_m, 0.0);
  for (double speed : experiment.speeds_mps) {
    for (double rest = 0.0; rest < experiment.rest_s; rest += sensors.interval_s) row(0.0, 0.0, true);
    fly(0.0, speed);
  }
  for (int i = 0; i < 20; ++i) row(0.0, 0.0, true);

  out.log.rig = std::string(dynamics::info(truth.kind).rig);
  out.log.columns = {{"time_s", time}, {"height_m", height}, {"contact", contact}};
  if (sensors.velocity_column) out.log.columns["velocity_mps"] = derived_velocity(time, height);
  drop_rows(out.log, sensors.dropped_fraction, random);
  return out;
}

}  // namespace furcula::hidden
