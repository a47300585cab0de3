// See laws.hpp.
#include "tests/hidden/laws.hpp"

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::hidden {

namespace {

constexpr Acts kBody = Acts::on_the_body, kSensors = Acts::on_the_sensors, kOutside = Acts::outside_catalogue;

// clang-format off
constexpr LawInfo kLaws[] = {
    // name                  acts      hopper axis  joint  rail
    {"coulomb_friction",     kBody,    true,  true,  true,  true,  {"force_n"}, true},
    {"stribeck_friction",    kBody,    true,  true,  true,  true,  {"force_n", "static_force_n", "velocity_mps"}},
    {"asymmetric_friction",  kBody,    true,  true,  true,  true,  {"force_up_n", "force_down_n"}},
    {"quadratic_drag",       kBody,    true,  true,  true,  true,  {"drag_ns2pm2"}},
    {"binding_spot",         kBody,    true,  true,  true,  true,  {"force_n", "centre_m", "width_m"}},
    {"damping_error",        kBody,    true,  true,  true,  true,  {"damping_nspm"}, true},
    {"force_offset",         kBody,    true,  true,  true,  true,  {"force_n"}},
    {"guide_tilt",           kBody,    true,  false, false, true,  {"tilt_rad"}},
    {"mass_error",           kBody,    true,  true,  true,  true,  {"mass_kg"}},
    {"stiffness_error",      kBody,    true,  false, false, false, {"stiffness_npm"}},
    {"rest_height_error",    kBody,    true,  false, false, false, {"rest_height_m"}},
    {"spring_preload",       kBody,    true,  false, false, false, {"force_n"}},
    {"spring_hardening",     kBody,    true,  false, false, false, {"cubic_npm3"}},
    {"spring_hysteresis",    kBody,    true,  false, false, false, {"ratio"}},
    {"leg_inertia",          kBody,    true,  false, false, false, {"inertia_a_kgm2", "inertia_b_kgm", "inertia_e_kgm"}},
    {"torque_gain_error",    kBody,    true,  true,  true,  false, {"gain"}},
    {"torque_offset",        kBody,    true,  false, false, false, {"torque_nm"}},
    {"actuator_delay",       kBody,    true,  true,  true,  false, {"delay_s"}},
    {"actuator_lag",         kBody,    true,  true,  true,  false, {"time_constant_s"}},
    {"torque_saturation",    kBody,    true,  true,  true,  false, {"limit_nm"}},
    {"torque_ripple",        kBody,    true,  false, true,  false, {"amplitude_nm", "cycles_per_rev", "phase_rad"}},
    {"thermal_derating",     kBody,    true,  true,  true,  false, {"final_gain", "time_constant_s"}},
    {"backlash",             kBody,    true,  false, false, false, {"gap_rad"}},
    {"touchdown_loss",       kBody,    true,  false, false, false, {"restitution_touchdown"}},
    {"liftoff_loss",         kBody,    true,  false, false, false, {"restitution_liftoff"}},
    {"ground_compliance",    kBody,    true,  false, false, false, {"stiffness_npm", "damping_nspm"}},
    {"toe_sticking",         kBody,    true,  false, false, false, {"force_n"}},
    {"encoder_offset",       kSensors, true,  true,  true,  false, {"offset_m"}},
    {"height_scale_error",   kSensors, true,  false, false, true,  {"scale"}},
    {"height_eccentricity",  kSensors, true,  true,  true,  true,  {"amplitude_m", "pitch_m", "phase_rad"}},
    {"encoder_slip",         kSensors, true,  true,  true,  true,  {"step_m", "time_s"}, true},
    {"contact_delay",        kSensors, true,  false, false, false, {"delay_s"}},
    {"time_skew",            kSensors, true,  true,  true,  false, {"skew_s"}},
    {"bump_stop",            kBody,    true,  false, false, false, {"compression_m", "stiffness_npm"}},
    {"clutch_slip",          kBody,    false, false, false, false, {"holding_force_n"}, true},
    {"late_catch",           kBody,    true,  false, false, false, {"delay_s"}, true},
    {"incomplete_release",   kBody,    true,  false, false, false, {"ratio"}},
    {"auxiliary_spring",     kBody,    true,  false, false, false, {"stiffness_npm"}, true},
    // Mechanical.
    {"side_mass",            kOutside, true,  true,  true,  true,  {"mass_kg", "frequency_hz", "damping_ratio"}},
    {"end_stop",             kOutside, false, true,  true,  false, {"position_m", "stiffness_npm"}},
    {"cable_snag",           kOutside, true,  true,  true,  true,  {"force_n", "centre_m", "width_m"}, true},
    {"detents",              kOutside, false, true,  false, false, {"force_n", "pitch_m", "phase_rad"}},
    {"periodic_force",       kOutside, true,  true,  true,  true,  {"force_n", "frequency_hz", "phase_rad"}},
    {"gusts",                kOutside, true,  true,  true,  true,  {"force_n", "duration_s", "rate_hz"}},
    // Changing with time.
    {"warming_friction",     kOutside, true,  true,  true,  true,  {"force_n", "time_constant_s"}, true},
    {"fading_spring",        kOutside, true,  false, false, false, {"share", "time_constant_s"}},
    {"creeping_spring",      kOutside, true,  false, false, false, {"share", "time_constant_s"}},
    {"catch_scatter",        kOutside, false, false, false, false, {"spread_s"}, true},
    // Electrical.
    {"drive_dropout",        kOutside, true,  true,  true,  false, {"duration_s", "rate_hz"}},
    {"drive_deadband",       kOutside, true,  true,  true,  false, {"limit_nm"}},
    // Sensing.
    {"sticking_counts",      kOutside, true,  true,  true,  true,  {"offset_m"}},
    {"torque_crosstalk",     kOutside, true,  true,  true,  false, {"position_per_input"}},
    {"wandering_zero",       kOutside, true,  true,  true,  true,  {"amplitude_m", "period_s", "phase_rad"}},
};

// Contract, section 3: on a rotary axis the names carry rotary units.
constexpr std::pair<std::string_view, std::string_view> kRotary[] = {
    {"force_n", "torque_nm"},           {"static_force_n", "static_torque_nm"}, {"force_up_n", "torque_up_nm"},
    {"force_down_n", "torque_down_nm"}, {"velocity_mps", "velocity_radps"},     {"drag_ns2pm2", "drag_nms2prad2"},
    {"mass_kg", "inertia_kgm2"},        {"centre_m", "centre_rad"},             {"width_m", "width_rad"},
    {"offset_m", "offset_rad"},         {"amplitude_m", "amplitude_rad"},       {"damping_nspm", "damping_nmspr"},
    {"pitch_m", "pitch_rad"},           {"step_m", "step_rad"},                 {"position_m", "angle_rad"},
    {"stiffness_npm", "stiffness_nmprad"},
};
// clang-format on

}  // namespace

std::span<const LawInfo> laws() { return kLaws; }

const LawInfo* law_named(std::string_view name) {
  for (const LawInfo& law : kLaws)
    if (law.name == name) return &law;
  return nullptr;
}

std::string parameter_name(const LawInfo& law, std::size_t index, Kind kind) {
  const std::string_view name = law.parameters[index];
  if (kind == Kind::motor_axis && name == "limit_nm") return "limit_n";
  if (dynamics::info(kind).rotary && law.name != "auxiliary_spring")  // whose rate is along the belt
    for (const auto& [linear, rotary] : kRotary)
      if (linear == name) return std::string(rotary);
  return std::string(name);
}

bool can_be_named(std::string_view law, Kind kind) {
  const auto effect = dynamics::effect_named(law);
  return effect && dynamics::applies(*effect, kind);
}

bool can_be_planted(std::string_view law, Kind kind) {
  const LawInfo* info = law_named(law);
  return info && info->on(kind) && (info->acts == Acts::outside_catalogue || can_be_named(law, kind));
}

const Values* find(const std::vector<Planted>& planted, std::string_view law) {
  for (const Planted& p : planted)
    if (p.law == law) return &p.values;
  return nullptr;
}

}  // namespace furcula::hidden
