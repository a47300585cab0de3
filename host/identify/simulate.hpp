// Runs a model free over a window of a recording, on the recorded input held from row to row.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "furcula/dynamics/actuation.hpp"
#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/sensing.hpp"
#include "furcula/dynamics/simple_clutch_bench.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/unknowns.hpp"
#include "host/identify/windows.hpp"

namespace furcula::identify {

namespace detail {

inline const auto& height(const auto& plant) {
  if constexpr (requires { plant.height_m(); })
    return plant.height_m();
  else
    return plant.position();
}
inline const auto& speed(const auto& plant) {
  if constexpr (requires { plant.velocity_mps(); })
    return plant.velocity_mps();
  else
    return plant.velocity();
}

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

/// What a wrong scale of the position turns about: the touch-down height, or zero.
template <class T>
T reference(const auto& plant) {
  if constexpr (requires { plant.touchdown_height_m(); })
    return plant.touchdown_height_m();
  else
    return T(0.0);
}

/// Without what the drive itself does to a command.
template <class T>
dynamics::Effects<T> behind_drive(dynamics::Effects<T> effects) {
  for (dynamics::Effect e : dynamics::kDriveEffects) effects.clear(e);
  return effects;
}
template <class T>
dynamics::Effects<T> of_drive(const dynamics::Effects<T>& effects) {
  dynamics::Effects<T> only;
  for (dynamics::Effect e : dynamics::kDriveEffects)
    if (effects.has(e)) only.set(e, 0, effects.value(e));
  return only;
}

template <class T>
dynamics::Effects<T> unskewed(dynamics::Effects<T> effects) {
  effects.clear(dynamics::Effect::time_skew);
  return effects;
}

/// Brings a drive to where it is at row `first`.
template <class T>
void warm_up(dynamics::Actuation<T>& drive, const Recording& r, const dynamics::Commands<double>& commands,
             std::size_t first) {
  if (drive.ideal_drive()) return;
  std::size_t from = first;
  const double since = r.time_s[first] - drive.memory_s();
  while (from > 0 && r.time_s[from] > since) --from;
  drive.reset(commands, from);
  for (; from < first; ++from) drive.drive(commands, from, r.time_s[from + 1] - r.time_s[from]);
}

/// What reaches the plant: a recording's commands through drive and motor, row by row. Where the input is the
/// drive's answer, that answer holds what the drive does already.
template <class T>
class Driven {
 public:
  /// For the rows from `first` on.
  Driven(const PlantSetup<T>& setup, const Recording& r, std::size_t first)
      : recording_(r),
        commands_(r.commands()),
        actuation_(r.drive_command.empty() ? setup.effects : behind_drive(setup.effects)),
        ideal_(actuation_.ideal_drive()) {
    warm_up(actuation_, r, commands_, first);
  }

  /// What the drive's current would show at a row, before next() is called for it.
  T shown(std::size_t row, double interval_s) const {
    return ideal_ ? T(recording_.input[row]) : actuation_.at_row(commands_, row, interval_s);
  }
  /// Mean over a row's interval. Call for one row after the other.
  T next(std::size_t row, double interval_s) {
    const T drive = ideal_ ? T(recording_.input[row]) : actuation_.drive(commands_, row, interval_s);
    return actuation_.motor(drive, commands_, row);
  }

 private:
  const Recording& recording_;
  dynamics::Commands<double> commands_;
  dynamics::Actuation<T> actuation_;
  bool ideal_;
};

/// By how much the measured position of a row is off by slips, if the model has them. A slip is an event of
/// each recording, not of the machine: where the effect is on, the recording's own.
template <class T>
double slipped(const PlantSetup<T>& setup, const Recording& r, std::size_t row) {
  return setup.effects.has(dynamics::Effect::encoder_slip) && !r.slip_offset.empty() ? r.slip_offset[row]
                                                                                     : 0.0;
}

/// Where a window finds a hopper's clutch: its coil's past is in the recording, and the travel that a caught
/// cable has follows from the measured heights at which the key came. False where there is no clutch, or its
/// coil is never on.
template <class T>
bool start_clutch(auto& plant, const PlantSetup<T>& setup, const Recording& r, std::size_t first) {
  if constexpr (!requires { plant.has_clutch(); }) {
    return false;
  } else {
    using dynamics::Effect;
    if (!plant.has_clutch() || r.solenoid.empty()) return false;
    const double pitch_m = dynamics::value_of(setup.clutch.tooth_pitch_m);
    dynamics::KeyTiming<T> key(setup.clutch.release_delay_s,
                               setup.effects.value_or(Effect::late_catch, setup.clutch.catch_delay_s));
    const auto travel = [&](double height_m) {
      return dynamics::value_of(plant.loose_travel_m(T(height_m)));
    };
    bool held = true;  // else out, or on its way to a tooth
    int teeth = 0;
    double last_m = 0.0;
    for (std::size_t i = 0; i < first; ++i) {
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
        last_m = travel(interpolated(r.time_s, r.position, at_s));
      }
      key.pass(left_s);
      if (held) continue;
      // The cable follows the leg; the pressed key meets a tooth where its travel passes one, and at home.
      const double travel_m = travel(r.position[i + 1]);
      if (!key.out()) {
        const double from = last_m / pitch_m, to = travel_m / pitch_m;
        const double tooth = to > from ? std::floor(to) : std::ceil(to);
        if (!(travel_m > 0.0) || (to > from ? tooth > from : tooth < from)) {
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
template <class T>
bool start_plant(auto& plant, const PlantSetup<T>& setup, const dynamics::Sensing<T>& sensing,
                 const Recording& r, std::size_t row, std::size_t last, const T& position,
                 const T& velocity) {
  const T start = sensing.position(T(position - slipped(setup, r, row)));
  plant.reset(start, T(velocity / sensing.gain(start)));
  if (setup.effects.has(dynamics::Effect::backlash))
    if constexpr (requires { plant.press_rotor(0.0); }) {
      std::size_t pressed = row;
      while (pressed > 0 && r.input[pressed] == 0.0) --pressed;
      plant.press_rotor(r.input[pressed]);
      if constexpr (requires { plant.place_rotor(0.0, 0.0); })
        if (!r.leg_angle.empty()) {
          constexpr std::size_t kRows = 10;
          const auto seen =
              local_polynomial(r.time_s, r.leg_angle, row, std::min(last, row + kRows), r.time_s[row], 1);
          plant.place_rotor(seen.value, seen.slope);
        }
    }
  return start_clutch<T>(plant, setup, r, row);
}

}  // namespace detail

/// Calls use(plant) with the plant of the kind, in the scalar T.
template <class T, class Use>
void with_plant(dynamics::Kind kind, const PlantSetup<T>& setup, const Use& use) {
  const auto make = [&]<class Parameters>() {
    return dynamics::from_table<Parameters>(
        std::span<const T>(setup.parameters.data(), Parameters::kMembers.size()));
  };
  switch (kind) {
    case dynamics::Kind::rail_carriage: {
      dynamics::RailCarriage<T> plant(make.template operator()<dynamics::RailCarriageParameters<T>>(),
                                      setup.effects);
      use(plant);
      return;
    }
    case dynamics::Kind::hopper_linear: {
      dynamics::Hopper<T> plant(make.template operator()<dynamics::HopperLinearParameters<T>>(),
                                setup.effects);
      if (dynamics::value_of(setup.clutch.tooth_pitch_m) > 0.0) plant.fit_clutch(setup.clutch);
      use(plant);
      return;
    }
    case dynamics::Kind::hopper_nonlinear: {
      dynamics::Hopper<T> plant(make.template operator()<dynamics::HopperNonlinearParameters<T>>(),
                                setup.effects);
      if (dynamics::value_of(setup.clutch.tooth_pitch_m) > 0.0) plant.fit_clutch(setup.clutch);
      use(plant);
      return;
    }
    case dynamics::Kind::motor_axis: {
      dynamics::MotorAxis<T> plant(make.template operator()<dynamics::MotorAxisParameters<T>>(),
                                   setup.effects);
      use(plant);
      return;
    }
    case dynamics::Kind::rotary_joint: {
      dynamics::RotaryJoint<T> plant(make.template operator()<dynamics::RotaryJointParameters<T>>(),
                                     setup.effects);
      use(plant);
      return;
    }
    case dynamics::Kind::clutch_bench: {
      dynamics::SimpleClutchBench<T> plant(make.template operator()<dynamics::ClutchBenchParameters<T>>(),
                                           setup.effects);
      use(plant);
      return;
    }
  }
}

/// Starts at the measured (position, velocity) and visits visit(row, position, velocity, drive, leg_angle)
/// for each row of the window: what would be measured, what the drive's current would show (of the last row:
/// the command), and a function that gives the leg's angle (0 where there is none).
template <class T, class Visit>
void simulate(const PlantSetup<T>& setup, const Recording& r, const Window& w, const T& position,
              const T& velocity, const Visit& visit) {
  const dynamics::Commands<double> told = r.drive_commands();
  const bool answered = !r.drive_command.empty();
  detail::Driven<T> driven(setup, r, w.first);
  // What the drive reports stands on its own clock, whatever the positions' is.
  const bool own_clock = !answered && !r.drive.empty() && setup.effects.has(dynamics::Effect::time_skew);
  dynamics::Actuation<T> drive(answered    ? detail::of_drive(setup.effects)
                               : own_clock ? detail::unskewed(setup.effects)
                                           : dynamics::Effects<T>{});
  detail::warm_up(drive, r, told, w.first);
  with_plant(r.kind, setup, [&](auto& plant) {
    const dynamics::Sensing<T> sensing(setup.effects, detail::reference<T>(plant));
    [[maybe_unused]] const bool clutched =
        detail::start_plant<T>(plant, setup, sensing, r, w.first, w.last, position, velocity);
    T x = position, v = velocity;
    // A skew is the height's alone: the run is at the instants of the heights, so what the angle's own clock
    // is ahead of them is taken from the measured angle.
    const bool skewed = setup.effects.has(dynamics::Effect::time_skew) && !r.leg_angle.empty();
    std::size_t row = w.first;
    const auto leg_angle = [&] {
      T angle = detail::leg_angle<T>(plant);
      if (skewed)
        angle += r.leg_angle[row] -
                 detail::interpolated(r.time_s, r.leg_angle,
                                      T(r.time_s[row] - setup.effects.value(dynamics::Effect::time_skew)));
      return angle;
    };
    for (std::size_t i = w.first; i < w.last; ++i) {
      const double interval_s = r.time_s[i + 1] - r.time_s[i];
      visit(i, x, v, answered || own_clock ? drive.at_row(told, i, interval_s) : driven.shown(i, interval_s),
            leg_angle);
      if (answered || own_clock) drive.drive(told, i, interval_s);
      const T input = driven.next(i, interval_s);
      if constexpr (requires { plant.energise(true); })
        if (clutched) plant.energise(r.solenoid[i] != 0.0);
      plant.advance(input, interval_s);
      x = sensing.measured(detail::height(plant));
      if (const double off = detail::slipped(setup, r, i + 1); off != 0.0) x += off;
      v = detail::speed(plant) * sensing.gain(detail::height(plant));
      row = i + 1;
    }
    visit(w.last, x, v, T(r.input[w.last]), leg_angle);
  });
}

/// From the measured state of each row of the window a step to the next row: visits visit(row, position,
/// velocity) with what would be measured there, for the rows after the first.
template <class T, class Visit>
void one_step_each(const PlantSetup<T>& setup, const Recording& r, const Window& w, const Visit& visit) {
  detail::Driven<T> driven(setup, r, w.first);
  with_plant(r.kind, setup, [&](auto& plant) {
    const dynamics::Sensing<T> sensing(setup.effects, detail::reference<T>(plant));
    for (std::size_t i = w.first; i < w.last; ++i) {
      const double interval_s = r.time_s[i + 1] - r.time_s[i];
      [[maybe_unused]] const bool clutched = detail::start_plant<T>(
          plant, setup, sensing, r, i, w.last, T(r.position[i]), T(r.velocity_smoothed[i]));
      if constexpr (requires { plant.energise(true); })
        if (clutched) plant.energise(r.solenoid[i] != 0.0);
      plant.advance(driven.next(i, interval_s), interval_s);
      visit(i + 1, T(sensing.measured(detail::height(plant)) + detail::slipped(setup, r, i + 1)),
            T(detail::speed(plant) * sensing.gain(detail::height(plant))));
    }
  });
}

/// How much later than the measured height falls through the model's touch-down height the contact switch
/// reports, in this model: the switch's own delay, a skewed height channel, and a height that is measured
/// wrongly.
template <class T>
T report_lag(const PlantSetup<T>& setup, const Recording& r, const Window& w, double touchdown_height_m) {
  using dynamics::Effect;
  T lag = T(0.0);
  if (setup.effects.has(Effect::contact_delay)) lag += setup.effects.value(Effect::contact_delay);
  if (setup.effects.has(Effect::time_skew)) lag -= setup.effects.value(Effect::time_skew);
  const dynamics::Sensing<T> sensing(setup.effects, T(touchdown_height_m));
  const double velocity = w.touchdown_velocity;
  if (velocity < 0.0) {
    if (!sensing.ideal()) lag += (sensing.measured(T(touchdown_height_m)) - touchdown_height_m) / velocity;
    lag += detail::slipped(setup, r, w.touchdown) / velocity;
  }
  return lag;
}

}  // namespace furcula::identify
