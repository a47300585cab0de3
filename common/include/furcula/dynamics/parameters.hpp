// The parameters of each kind as plain structs, templated on the scalar. Names, units and meaning: kinds.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "furcula/dynamics/kinds.hpp"
#include "furcula/dynamics/members.hpp"

namespace furcula::dynamics {

template <class T>
struct HopperLinearParameters {
  static constexpr Kind kKind = Kind::hopper_linear;
  T mass_kg{}, stiffness_npm{}, rest_height_m{}, damping_stance_nspm{}, damping_flight_nspm{};
  T restitution_touchdown{}, restitution_liftoff{}, link_length_m{}, touchdown_angle_rad{}, gravity_mps2{};

  using Self = HopperLinearParameters;
  static constexpr std::array<T Self::*, 10> kMembers{&Self::mass_kg,
                                                      &Self::stiffness_npm,
                                                      &Self::rest_height_m,
                                                      &Self::damping_stance_nspm,
                                                      &Self::damping_flight_nspm,
                                                      &Self::restitution_touchdown,
                                                      &Self::restitution_liftoff,
                                                      &Self::link_length_m,
                                                      &Self::touchdown_angle_rad,
                                                      &Self::gravity_mps2};
  static_assert(kMembers.size() == kHopperLinearParameters.size());
};

template <class T>
struct HopperNonlinearParameters : HopperLinearParameters<T> {
  static constexpr Kind kKind = Kind::hopper_nonlinear;
  T inertia_a_kgm2{}, inertia_b_kgm{}, inertia_e_kgm{};

  using Self = HopperNonlinearParameters;
  static constexpr auto kMembers =
      joined(HopperLinearParameters<T>::kMembers,
             std::array<T Self::*, 3>{&Self::inertia_a_kgm2, &Self::inertia_b_kgm, &Self::inertia_e_kgm});
  static_assert(kMembers.size() == kHopperNonlinearParameters.size());
};

template <class T>
struct MotorAxisParameters {
  static constexpr Kind kKind = Kind::motor_axis;
  T mass_kg{}, damping_nspm{};

  using Self = MotorAxisParameters;
  static constexpr std::array<T Self::*, 2> kMembers{&Self::mass_kg, &Self::damping_nspm};
  static_assert(kMembers.size() == kMotorAxisParameters.size());
};

template <class T>
struct RotaryJointParameters {
  static constexpr Kind kKind = Kind::rotary_joint;
  T inertia_kgm2{}, gravity_torque_nm{}, damping_nmspr{};

  using Self = RotaryJointParameters;
  static constexpr std::array<T Self::*, 3> kMembers{&Self::inertia_kgm2, &Self::gravity_torque_nm,
                                                     &Self::damping_nmspr};
  static_assert(kMembers.size() == kRotaryJointParameters.size());
};

template <class T>
struct RailCarriageParameters {
  static constexpr Kind kKind = Kind::rail_carriage;
  T mass_kg{}, damping_nspm{}, gravity_mps2{};

  using Self = RailCarriageParameters;
  static constexpr std::array<T Self::*, 3> kMembers{&Self::mass_kg, &Self::damping_nspm,
                                                     &Self::gravity_mps2};
  static_assert(kMembers.size() == kRailCarriageParameters.size());
};

template <class T>
struct ClutchBenchParameters {
  static constexpr Kind kKind = Kind::clutch_bench;
  T load_mass_kg{}, pulley_radius_m{}, pulley_inertia_kgm2{}, damping_nmspr{}, auxiliary_stiffness_npm{};
  T tooth_pitch_m{}, tooth_height_m{}, release_delay_s{}, catch_delay_s{};

  using Self = ClutchBenchParameters;
  static constexpr std::array<T Self::*, 9> kMembers{
      &Self::load_mass_kg,   &Self::pulley_radius_m,         &Self::pulley_inertia_kgm2,
      &Self::damping_nmspr,  &Self::auxiliary_stiffness_npm, &Self::tooth_pitch_m,
      &Self::tooth_height_m, &Self::release_delay_s,         &Self::catch_delay_s};
  static_assert(kMembers.size() == kClutchBenchParameters.size());
};

/// The clutch of a hopper that has one (kClutchParameters); its pitch is 0 where there is none.
template <class T>
struct HopperClutchParameters {
  T release_delay_s{}, catch_delay_s{}, auxiliary_stiffness_npm{}, tooth_pitch_m{};
};

/// The struct from values in the order of the kind's table (`values.size()` = number of parameters).
template <class Parameters, class T>
constexpr Parameters from_table(std::span<const T> values) {
  Parameters p{};
  for (std::size_t i = 0; i < Parameters::kMembers.size(); ++i) p.*Parameters::kMembers[i] = values[i];
  return p;
}

}  // namespace furcula::dynamics
