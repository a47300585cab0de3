// Runs a model free over a window of a recording, on the recorded input held from row to row.
#pragma once

#include <span>

#include "furcula/dynamics/actuation.hpp"
#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/sensing.hpp"
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

/// What a wrong scale of the position turns about: the touch-down height, or zero.
template <class T>
T reference(const auto& plant) {
  if constexpr (requires { plant.touchdown_height_m(); })
    return plant.touchdown_height_m();
  else
    return T(0.0);
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
  }
}

/// Starts at the measured (position, velocity) and visits visit(row, position, velocity, drive) for each row
/// of the window: what would be measured, and what the drive's current would show (of the last row: the
/// command).
template <class T, class Visit>
void simulate(const PlantSetup<T>& setup, const Recording& r, const Window& w, const T& position,
              const T& velocity, const Visit& visit) {
  const dynamics::Commands<double> commands = r.commands();
  dynamics::Actuation<T> actuation(setup.effects);
  with_plant(r.kind, setup, [&](auto& plant) {
    const dynamics::Sensing<T> sensing(setup.effects, detail::reference<T>(plant));
    const T start = sensing.position(position);
    plant.reset(start, T(velocity / sensing.gain(start)));
    const bool ideal = actuation.ideal_drive();
    if (!ideal) {
      std::size_t from = w.first;
      const double since = r.time_s[w.first] - actuation.memory_s();
      while (from > 0 && r.time_s[from] > since) --from;
      actuation.reset(commands, from);
      for (; from < w.first; ++from) actuation.drive(commands, from, r.time_s[from + 1] - r.time_s[from]);
    }
    T x = position, v = velocity;
    for (std::size_t i = w.first; i < w.last; ++i) {
      const double interval_s = r.time_s[i + 1] - r.time_s[i];
      visit(i, x, v, ideal ? T(r.input[i]) : actuation.at_row(commands, i, interval_s));
      const T drive = ideal ? T(r.input[i]) : actuation.drive(commands, i, interval_s);
      plant.advance(actuation.motor(drive, commands, i), interval_s);
      x = sensing.measured(detail::height(plant));
      v = detail::speed(plant) * sensing.gain(detail::height(plant));
    }
    visit(w.last, x, v, T(r.input[w.last]));
  });
}

/// How much later than the measured height falls through the model's touch-down height the contact switch
/// reports, in this model: the switch's own delay, a skewed height channel, and a height that is measured
/// wrongly. `velocity` at the crossing, below zero.
template <class T>
T report_lag(const PlantSetup<T>& setup, double touchdown_height_m, double velocity) {
  using dynamics::Effect;
  T lag = T(0.0);
  if (setup.effects.has(Effect::contact_delay)) lag += setup.effects.value(Effect::contact_delay);
  if (setup.effects.has(Effect::time_skew)) lag -= setup.effects.value(Effect::time_skew);
  const dynamics::Sensing<T> sensing(setup.effects, T(touchdown_height_m));
  if (!sensing.ideal() && velocity < 0.0)
    lag += (sensing.measured(T(touchdown_height_m)) - touchdown_height_m) / velocity;
  return lag;
}

}  // namespace furcula::identify
