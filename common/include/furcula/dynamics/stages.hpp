// How a plant, its drive and its encoder are joined, in one place: simulation, simulated boards, both methods
// of identification and the residual force of a diagnosis run a machine through these four stages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "furcula/dynamics/actuation.hpp"
#include "furcula/dynamics/sensing.hpp"

namespace furcula::dynamics {

/// Position of the body that the encoder measures: of a hopper its height, else the position of the axis; m or rad.
decltype(auto) position_of(const auto& plant) {
  if constexpr (requires { plant.height_m(); })
    return plant.height_m();
  else
    return plant.position();
}
/// Velocity of that body, m/s or rad/s.
decltype(auto) velocity_of(const auto& plant) {
  if constexpr (requires { plant.velocity_mps(); })
    return plant.velocity_mps();
  else
    return plant.velocity();
}
/// What a wrong scale of the position turns about: the touch-down height, or zero.
template <class T>
T reference_of(const auto& plant) {
  if constexpr (requires { plant.touchdown_height_m(); })
    return plant.touchdown_height_m();
  else
    return T(ValueOf<T>(0));
}

/// Whose clock tells the instants of a run's rows. A simulation goes by the commands'. A fit goes by the
/// encoder's, since it compares with measured positions: so a skew between the two moves the commands.
enum class Clock : std::uint8_t {
  commands,  ///< that of the commands
  encoder    ///< that of the encoder
};

/// What a run's commands are: what the drive is told, or what it reports to have made of that, in which case
/// only the motor is left of the actuation.
enum class Input : std::uint8_t {
  command,      ///< what the drive is told
  drive_torque  ///< what the drive reports
};

///   command ─► actuation: drive, motor ─► plant: rotor, mechanism, contact ─► sensing: encoder ─► measured
///
/// The rotor belongs to the actuation and turns with the leg. Each effect is in the stage that the catalogue
/// says, and is read there alone (EffectsOf).
template <class Plant, class T>
class Stages {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;

  /// The plant is made of its parameters and the effects.
  template <class Parameters>
  Stages(const Parameters& parameters, const Effects<T>& effects, Clock clock = Clock::commands,
         Input input = Input::command)
      : plant_(parameters, effects),
        sensing_(effects, reference_of<T>(plant_)),
        actuation_(actuation_of(effects, clock, input)) {}

  /// Takes a plant and the effects that it was made with.
  Stages(const Plant& plant, const Effects<T>& effects, Clock clock = Clock::commands,
         Input input = Input::command)
      : plant_(plant),
        sensing_(effects, reference_of<T>(plant_)),
        actuation_(actuation_of(effects, clock, input)) {}

  /// Drive and motor.
  Actuation<T>& actuation() { return actuation_; }
  /// The plant, which may be changed.
  Plant& plant() { return plant_; }
  /// The plant.
  const Plant& plant() const { return plant_; }
  /// Encoder and contact switch.
  const Sensing<T>& sensing() const { return sensing_; }

  /// From row `row` on over `dt_s` seconds, with its command: one row after the other.
  void step(const Commands<V>& commands, std::size_t row, V dt_s) {
    plant_.advance(actuation_.torque(commands, row, dt_s), dt_s);
  }

  /// Position as it is measured, m or rad.
  T position() const { return sensing_.measured(position_of(plant_)); }
  /// Velocity as it is measured, m/s or rad/s.
  T velocity() const {
    if (sensing_.ideal()) return velocity_of(plant_);
    return velocity_of(plant_) * sensing_.gain(position_of(plant_));
  }

  /// A state of the plant.
  struct State {
    T position,    ///< true position, m or rad
        velocity;  ///< true velocity, m/s or rad/s
  };
  /// The plant's state in which these are measured.
  State behind(const T& position, const T& velocity) const {
    if (sensing_.ideal()) return {position, velocity};
    const T at = sensing_.position(position);
    return {at, T(velocity / sensing_.gain(at))};
  }
  /// Starts the plant in the state in which these are measured.
  void reset(const T& position, const T& velocity) {
    const State at = behind(position, velocity);
    plant_.reset(at.position, at.velocity);
  }

 private:
  Actuation<T> actuation_of(const Effects<T>& effects, Clock clock, Input input) const {
    std::optional<T> behind_s;
    if (clock == Clock::encoder) behind_s = sensing_.skew_s();
    return {input == Input::command ? Drive<T>(effects, behind_s) : Drive<T>(Effects<T>{}, behind_s),
            Motor<T>(effects)};
  }

  Plant plant_;
  Sensing<T> sensing_;
  Actuation<T> actuation_;
};

}  // namespace furcula::dynamics
