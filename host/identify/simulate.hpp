// Runs a model free over a window of a recording, on the recorded input held from row to row.
#pragma once

#include <span>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
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

}  // namespace detail

/// Calls use(plant) with the plant of the kind, in the scalar T.
template <class T, class Use>
void with_plant(dynamics::Kind kind, const PlantSetup<T>& setup, const Use& use) {
  const auto make = [&]<class Parameters>() {
    return dynamics::from_table<Parameters>(
        std::span<const T>(setup.parameters.data(), Parameters::kMembers.size()));
  };
  switch (kind) {
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

/// Starts at (position, velocity) and visits visit(row, position, velocity) for each row of the window.
template <class T, class Visit>
void simulate(const PlantSetup<T>& setup, const Recording& r, const Window& w, const T& position,
              const T& velocity, const Visit& visit) {
  with_plant(r.kind, setup, [&](auto& plant) {
    plant.reset(position, velocity);
    visit(w.first, position, velocity);
    for (std::size_t i = w.first; i < w.last; ++i) {
      plant.advance(T(r.input[i]), r.time_s[i + 1] - r.time_s[i]);
      visit(i + 1, detail::height(plant), detail::speed(plant));
    }
  });
}

}  // namespace furcula::identify
