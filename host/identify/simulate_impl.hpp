// What simulate.hpp names, for any number type, to be instantiated (window_run_of.cpp.in).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "furcula/dynamics/plants.hpp"
#include "furcula/dynamics/stages.hpp"
#include "host/identify/dual.hpp"
#include "host/identify/simulate.hpp"

namespace furcula::identify {

namespace detail {

/// Of the leg, on the motor's side; 0 on an axis without one.
template <class T>
T leg_angle(const auto& plant) {
  if constexpr (requires { plant.leg_angle_rad(); })
    return plant.leg_angle_rad();
  else
    return T(0.0);
}

/// Between the rows in a straight line, held at the ends. Carries the derivative by `t`.
template <class T>
T interpolated(const std::vector<double>& time_s, const std::vector<double>& values, const T& t) {
  const double at = dynamics::value_of(t);
  if (!(at > time_s.front())) return T(values.front());
  if (!(at < time_s.back())) return T(values.back());
  const auto after =
      static_cast<std::size_t>(std::upper_bound(time_s.begin(), time_s.end(), at) - time_s.begin());
  const double slope = (values[after] - values[after - 1]) / (time_s[after] - time_s[after - 1]);
  return values[after - 1] + slope * (t - time_s[after - 1]);
}

/// By how much the measured position of a row is off by slips, if the model has them.
template <class T>
double slipped(const dynamics::Sensing<T>& sensing, const Recording& r, std::size_t row) {
  return sensing.slips() && !r.slip_offset.empty() ? r.slip_offset[row] : 0.0;
}

/// The position that would be measured in a row.
template <class Plant, class T>
T measured_position(const dynamics::Stages<Plant, T>& stages, const Recording& r, std::size_t row) {
  T position = stages.position();
  if (const double off = slipped(stages.sensing(), r, row); off != 0.0) position += off;
  return position;
}

/// Of a leg that folds in flight: puts a plant that was reset into the flight in which it is at a row, and leads
/// its leg from a row to the next.
template <class T>
struct LeggedRecording {
  const Recording& r;
  std::optional<T> skew_s;  ///< of the height's clock behind the leg angle's

  T length(std::size_t row) const {
    if (!skew_s) return T(r.leg_length[row]);
    return interpolated(r.time_s, r.leg_length, T(r.time_s[row] - *skew_s));
  }
  T rate(std::size_t row) const {
    const std::size_t from = std::min(row, r.rows() - 2);
    return (length(from + 1) - length(from)) / (r.time_s[from + 1] - r.time_s[from]);
  }
  void start(auto& plant, std::size_t row) const {
    if constexpr (requires { plant.start_led(T(0.0), T(0.0)); })
      if (!r.leg_length.empty() && r.position[row] > dynamics::value_of(length(row)))
        plant.start_led(length(row), rate(row));
  }
  void lead(auto& plant, std::size_t row) const {
    if constexpr (requires { plant.lead_leg(T(0.0), T(0.0)); })
      if (!r.leg_length.empty()) plant.lead_leg(length(row), rate(row));
  }
};
/// Where a window finds a hopper's clutch: its coil's past is in the recording, and the travel that a caught
/// cable has follows from the measured heights at which the key came. False where there is no clutch, or its
/// coil is never on.
template <class T>
bool start_clutch(auto& plant, const PlantSetup<T>& setup, const Recording& r, std::size_t first) {
  if constexpr (!requires { plant.has_clutch(); }) {
    return false;
  } else {
    if (!plant.has_clutch() || r.solenoid.empty()) return false;
    const double pitch_m = dynamics::value_of(setup.clutch.tooth_pitch_m);
    dynamics::KeyTiming<T> key = plant.key();
    const auto travel = [&](double height_m) {
      return dynamics::value_of(plant.loose_travel_m(T(height_m)));
    };
    // The leg's length is the height in stance.
    std::vector<double> folded;
    if (!r.leg_length.empty())
      for (std::size_t i = 0; i <= first; ++i) folded.push_back(std::min(r.position[i], r.leg_length[i]));
    const std::vector<double>& length_m = r.leg_length.empty() ? r.position : folded;
    bool held = true;  // else out, or on its way to a tooth
    int teeth = 0;
    double last_m = 0.0;
    std::size_t from = 0;
    // What was before the key was out for the last time does not matter: the past of a long recording is not gone through.
    const T catch_s = dynamics::MechanismEffects<T>(setup.effects)
                          .value_or(dynamics::Effect::late_catch, setup.clutch.catch_delay_s);
    const double settled_s = dynamics::value_of(setup.clutch.release_delay_s) + dynamics::value_of(catch_s);
    if (const auto out = surely_out(r, first, settled_s)) {
      from = *out;
      key.reset(true);
      held = false;
      last_m = travel(r.position[from]);
    }
    for (std::size_t i = from; i < first; ++i) {
      key.energise(r.solenoid[i] != 0.0);
      T left_s(r.time_s[i + 1] - r.time_s[i]);
      while (key.changes_within(dynamics::value_of(left_s))) {
        const T until_s = key.change_in();
        key.pass(until_s);
        left_s -= until_s;
        key.change();
        if (key.out()) {
          held = false;
          continue;
        }
        const double at_s = r.time_s[i + 1] - dynamics::value_of(left_s);
        last_m = travel(interpolated(r.time_s, length_m, at_s));
        // As the plant has it: in flight, near home, it falls into the gap that it left.
        if (!r.leg_length.empty() && r.position[i + 1] > r.leg_length[i + 1] && last_m < 0.5 * pitch_m) {
          held = true;
          teeth = 0;
        }
      }
      key.pass(left_s);
      if (held) continue;
      // The cable follows the leg; the pressed key meets a tooth where its travel passes one, and at home.
      const double travel_m = travel(length_m[i + 1]);
      if (!key.out()) {
        const double before = last_m / pitch_m, now = travel_m / pitch_m;
        const double tooth = now > before ? std::floor(now) : std::ceil(now);
        if (!(travel_m > 0.0) || (now > before ? tooth > before : tooth < before)) {
          held = true;
          teeth = travel_m > 0.0 ? static_cast<int>(tooth) : 0;
        }
      }
      last_m = travel_m;
    }
    plant.start_clutch(key, held, teeth);
    return true;
  }
}

/// Puts a plant where a measured state finds it at row `row` of a recording; the leg's angle is looked at up
/// to row `last`. True if its clutch is to be told of the coil.
template <class Plant, class T>
bool start(dynamics::Stages<Plant, T>& stages, const PlantSetup<T>& setup, const Recording& r,
           std::size_t row, std::size_t last, const T& position, const T& velocity) {
  Plant& plant = stages.plant();
  stages.reset(T(position - slipped(stages.sensing(), r, row)), velocity);
  if constexpr (requires { plant.has_backlash(); })
    if (plant.has_backlash()) {
      plant.press_rotor(r.input[last_driven(r, row)]);
      if constexpr (requires { plant.place_rotor(0.0, 0.0); })
        if (!r.leg_angle.empty()) {
          constexpr std::size_t kRows = 10;
          const auto seen =
              local_polynomial(r.time_s, r.leg_angle, row, std::min(last, row + kRows), r.time_s[row], 1);
          plant.place_rotor(seen.value, seen.slope);
        }
    }
  LeggedRecording<T>{r, stages.sensing().skew_s()}.start(plant, row);
  return start_clutch<T>(plant, setup, r, row);
}

/// Calls use(stages) with the machine that a recording is of, in the scalar T, as fits run it: by the
/// encoder's clock, on what the recording has for an input.
template <class T, class Use>
void with_stages(const PlantSetup<T>& setup, const Recording& r, const Use& use) {
  dynamics::with_machine(r.kind, [&]<class Machine>() {
    using Parameters = typename Machine::template Parameters<T>;
    dynamics::Stages<typename Machine::template Plant<T>, T> stages(
        dynamics::from_table<Parameters>(
            std::span<const T>(setup.parameters.data(), Parameters::kMembers.size())),
        setup.effects, dynamics::Clock::encoder,
        r.drive_command.empty() ? dynamics::Input::command : dynamics::Input::drive_torque);
    if constexpr (requires { stages.plant().fit_clutch(setup.clutch); })
      if (dynamics::value_of(setup.clutch.tooth_pitch_m) > 0.0) stages.plant().fit_clutch(setup.clutch);
    use(stages);
  });
}

/// simulate() with a visitor that is compiled into it.
template <class T, class Visit>
void run_through(const PlantSetup<T>& setup, const Recording& r, const Window& w, const T& position,
                 const T& velocity, const Visit& visit) {
  const dynamics::Commands<double> commands = r.commands(), told = r.drive_commands();
  with_stages(setup, r, [&](auto& stages) {
    auto& drive = stages.actuation().drive;
    drive.start(commands, w.first);
    // What the drive reports stands on the commands' clock, and is its answer to what it is told.
    const std::optional<T> skew_s = stages.sensing().skew_s();
    std::optional<dynamics::Drive<T>> apart;
    if (!r.drive_command.empty() || (!r.drive.empty() && skew_s)) {
      apart.emplace(setup.effects);
      apart->start(told, w.first);
    }
    [[maybe_unused]] const bool clutched = start(stages, setup, r, w.first, w.last, position, velocity);
    const LeggedRecording<T> leg{r, skew_s};
    T x = position, v = velocity;
    std::size_t row = w.first;
    const auto leg_angle = [&] {
      T angle = detail::leg_angle<T>(stages.plant());
      // The leg's angle is on the commands' clock too, and the run is at the instants of the encoder's: what
      // the one is ahead of the other is taken from the measured angle.
      if (skew_s && !r.leg_angle.empty())
        angle += r.leg_angle[row] - interpolated(r.time_s, r.leg_angle, T(r.time_s[row] - *skew_s));
      return angle;
    };
    for (std::size_t i = w.first; i < w.last; ++i) {
      const double interval_s = r.time_s[i + 1] - r.time_s[i];
      visit(i, x, v, apart ? apart->shown(told, i, interval_s) : drive.shown(commands, i, interval_s),
            leg_angle);
      if (apart) apart->torque(told, i, interval_s);
      if constexpr (requires { stages.plant().energise(true); })
        if (clutched) stages.plant().energise(r.solenoid[i] != 0.0);
      leg.lead(stages.plant(), i);
      stages.step(commands, i, interval_s);
      x = measured_position(stages, r, i + 1);
      v = stages.velocity();
      row = i + 1;
    }
    visit(w.last, x, v, T(r.input[w.last]), leg_angle);
  });
}

}  // namespace detail

template <class T>
void simulate(const PlantSetup<T>& setup, const Recording& r, const Window& w,
              const std::type_identity_t<T>& position, const std::type_identity_t<T>& velocity,
              const VisitRow<std::type_identity_t<T>>& visit) {
  detail::run_through(setup, r, w, position, velocity,
                      [&](std::size_t row, const T& x, const T& v, const T& drive, const auto& leg_angle) {
                        visit(row, x, v, drive, std::cref(leg_angle));
                      });
}

template <class T>
void one_step_each(const PlantSetup<T>& setup, const Recording& r, const Window& w,
                   const VisitStep<std::type_identity_t<T>>& visit) {
  const dynamics::Commands<double> commands = r.commands();
  detail::with_stages(setup, r, [&](auto& stages) {
    stages.actuation().drive.start(commands, w.first);
    for (std::size_t i = w.first; i < w.last; ++i) {
      [[maybe_unused]] const bool clutched =
          detail::start(stages, setup, r, i, w.last, T(r.position[i]), T(r.velocity_smoothed[i]));
      if constexpr (requires { stages.plant().energise(true); })
        if (clutched) stages.plant().energise(r.solenoid[i] != 0.0);
      detail::LeggedRecording<T>{r, stages.sensing().skew_s()}.lead(stages.plant(), i);
      stages.step(commands, i, r.time_s[i + 1] - r.time_s[i]);
      visit(i + 1, detail::measured_position(stages, r, i + 1), stages.velocity());
    }
  });
}

template <class T>
T report_lag(const PlantSetup<T>& setup, const Recording& r, const Window& w, double touchdown_height_m) {
  const dynamics::Sensing<T> sensing(setup.effects, T(touchdown_height_m));
  return sensing.report_lag_s(w.touchdown_velocity, detail::slipped(sensing, r, w.touchdown));
}

}  // namespace furcula::identify
