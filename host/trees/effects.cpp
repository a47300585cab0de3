// The catalogue on trees, see effects.hpp.
#include "host/trees/effects.hpp"

#include <iterator>

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::trees {
namespace {

constexpr double kMostTorque = 1e4;

/// A law that machines of one joint have too: its words are theirs.
constexpr EffectInfo shared(Effect effect, dynamics::Effect one_joint, LocationType location_type,
                            std::array<Parameter, kMostParameters> parameters, std::size_t count) {
  const dynamics::EffectInfo& i = dynamics::kCatalogue[static_cast<std::size_t>(one_joint)];
  return {effect,     i.name, i.title,       location_type,   i.law,
          parameters, count,  i.explanation, i.where_to_look, i.best_experiment};
}
using One = dynamics::Effect;

constexpr EffectInfo kAll[] = {
    shared(Effect::coulomb_friction, One::coulomb_friction, LocationType::joint,
           {{{"torque_nm", "N m", "force_n", "N", 0.0, kMostTorque}}}, 1),
    shared(Effect::stribeck_friction, One::stribeck_friction, LocationType::joint,
           {{{"torque_nm", "N m", "force_n", "N", 0.0, kMostTorque},
             {"static_torque_nm", "N m", "static_force_n", "N", 0.0, kMostTorque},
             {"velocity_radps", "rad/s", "velocity_mps", "m/s", 1e-4, 50.0}}},
           3),
    shared(Effect::asymmetric_friction, One::asymmetric_friction, LocationType::joint,
           {{{"torque_up_nm", "N m", "force_up_n", "N", 0.0, kMostTorque},
             {"torque_down_nm", "N m", "force_down_n", "N", 0.0, kMostTorque}}},
           2),
    shared(Effect::quadratic_drag, One::quadratic_drag, LocationType::joint,
           {{{"drag_nms2prad2", "N m s^2/rad^2", "drag_ns2pm2", "N s^2/m^2", 0.0, 1e4}}}, 1),
    shared(Effect::binding_spot, One::binding_spot, LocationType::joint,
           {{{"torque_nm", "N m", "force_n", "N", 0.0, kMostTorque},
             {"centre_rad", "rad", "centre_m", "m", -1e3, 1e3},
             {"width_rad", "rad", "width_m", "m", 1e-4, 10.0}}},
           3),
    shared(Effect::damping_error, One::damping_error, LocationType::joint,
           {{{"damping_nmspr", "N m s/rad", "damping_nspm", "N s/m", 0.0, 1e6}}}, 1),
    {Effect::load_friction,
     "load_friction",
     "dry friction that grows with the load",
     LocationType::joint,
     "-r |tau| sgn(v), tau the drive's torque",
     {{{"ratio", "", "ratio", "", 0.0, 0.95}}},
     1,
     "Dry friction in proportion to the torque that the drive passes on.",
     "The gear: worn or badly lubricated teeth, a worm or a harmonic drive that runs warm.",
     "The same slow strokes with and without a load at the end of the arm: the loss grows with the load."},
    shared(Effect::force_offset, One::force_offset, LocationType::joint,
           {{{"torque_nm", "N m", "force_n", "N", -kMostTorque, kMostTorque}}}, 1),
    shared(Effect::mass_error, One::mass_error, LocationType::link,
           {{{"mass_kg", "kg", "mass_kg", "kg", 0.0, 1e5}}}, 1),
    {Effect::com_error,
     "com_error",
     "the model's centre of mass",
     LocationType::link,
     "the link's centre of mass is elsewhere, its inertia about it the same",
     {{{"offset_x_m", "m", "offset_x_m", "m", -10.0, 10.0},
       {"offset_y_m", "m", "offset_y_m", "m", -10.0, 10.0},
       {"offset_z_m", "m", "offset_z_m", "m", -10.0, 10.0}}},
     3,
     "The link's centre of mass is not where the model has it.",
     "What is mounted on the link and is not in the CAD model: cables, connectors, a gripper.",
     "Hold the joints in postures all around: the holding torques against gravity tell mass times offset."},
    {Effect::inertia_error,
     "inertia_error",
     "the model's moment of inertia",
     LocationType::link,
     "the link's inertia about its centre of mass is scaled",
     {{{"scale", "", "scale", "", 0.0, 1e3}}},
     1,
     "The link turns heavier or lighter than its mass and centre say.",
     "The link's inertia in the CAD model: wrong density, parts left out far from the centre.",
     "Fast strokes of the joint, alone: torque over acceleration, gravity taken off."},
    {Effect::payload,
     "payload",
     "a payload",
     LocationType::link,
     "a point mass that is fixed to the link",
     {{{"mass_kg", "kg", "mass_kg", "kg", 0.0, 1e5},
       {"x_m", "m", "x_m", "m", -10.0, 10.0},
       {"y_m", "m", "y_m", "m", -10.0, 10.0},
       {"z_m", "m", "z_m", "m", -10.0, 10.0}}},
     4,
     "Something that the model does not have is fixed to the link.",
     "The link: a tool, a sensor, a battery, a cable.",
     "Postures all around at rest, then fast strokes: gravity tells mass times lever, strokes tell mass times lever squared."},
    {Effect::base_tilt,
     "base_tilt",
     "a tilt of the base",
     LocationType::base,
     "the base is turned by roll about x, then by pitch about y",
     {{{"roll_rad", "rad", "roll_rad", "rad", -3.2, 3.2},
       {"pitch_rad", "rad", "pitch_rad", "rad", -3.2, 3.2}}},
     2,
     "The base does not stand level: gravity pulls another way than the model says.",
     "The table, the bolts of the base; the axes of gravity in the model.",
     "Put a level on the base. Postures at rest all around the first vertical axis."},
    {Effect::rotor_inertia_error,
     "rotor_inertia_error",
     "the rotor's inertia",
     LocationType::drive,
     "the rotor's inertia, reflected to the joint, differs from the model's",
     {{{"inertia_kgm2", "kg m^2", "mass_kg", "kg", 0.0, 1e5}}},
     1,
     "The drive's rotor takes torque to speed up, by its inertia times the square of the gear ratio.",
     "The motor's data sheet and the gear ratio: is the inertia there, and multiplied by the ratio squared?",
     "Fast strokes of one joint, the others still, in postures of small and of large inertia of the arm."},
    shared(Effect::torque_gain_error, One::torque_gain_error, LocationType::drive,
           {{{"gain", "", "gain", "", 0.0, 10.0}}}, 1),
    {Effect::position_gain_error,
     "position_gain_error",
     "the gains of the drive's position law",
     LocationType::drive,
     "torque = kp (set point - q) - kd v with other gains",
     {{{"kp_nmprad", "N m/rad", "kp_npm", "N/m", 0.0, 1e6},
       {"kd_nmsprad", "N m s/rad", "kd_nspm", "N s/m", 0.0, 1e6}}},
     2,
     "The drive's stiffness or damping is not what the model says.",
     "The gains that the drive has in force, their units, and the torque constant that turns them to current.",
     "Steps of the set point of several sizes, and the sag of a joint that holds a weight."},
    shared(Effect::actuator_delay, One::actuator_delay, LocationType::drive,
           {{{"delay_s", "s", "delay_s", "s", 0.0, 0.2}}}, 1),
    shared(Effect::actuator_lag, One::actuator_lag, LocationType::drive,
           {{{"time_constant_s", "s", "time_constant_s", "s", 0.0, 1.0}}}, 1),
    shared(Effect::torque_saturation, One::torque_saturation, LocationType::drive,
           {{{"limit_nm", "N m", "limit_n", "N", 0.0, kMostTorque}}}, 1),
    shared(Effect::torque_ripple, One::torque_ripple, LocationType::drive,
           {{{"amplitude_nm", "N m", "amplitude_n", "N", 0.0, kMostTorque},
             {"cycles_per_rev", "", "cycles_per_m", "1/m", 0.5, 1e4},
             {"phase_rad", "rad", "phase_rad", "rad", -10.0, 10.0}}},
           3),
    {Effect::joint_elasticity,
     "joint_elasticity",
     "elasticity between drive and joint",
     LocationType::drive,
     "the rotor turns the joint through a spring: K (rotor - q)",
     {{{"stiffness_nmprad", "N m/rad", "stiffness_npm", "N/m", 1.0, 1e8}}},
     1,
     "The drive gives before the joint moves: gear or belt act as a spring.",
     "A belt's tension, a harmonic drive's flexspline, couplings and the seat of the gear.",
     "A blow against the arm with the drive holding: the frequency at which it rings."},
    shared(Effect::encoder_offset, One::encoder_offset, LocationType::encoder,
           {{{"offset_rad", "rad", "offset_m", "m", -10.0, 10.0}}}, 1),
    shared(Effect::time_skew, One::time_skew, LocationType::log,
           {{{"skew_s", "s", "skew_s", "s", -0.1, 0.1}}}, 1),
    {Effect::spring_rate_error,
     "spring_rate_error",
     "the rate of the joint's spring",
     LocationType::spring,
     "-k max(q - rest, 0) with another rate k",
     {{{"stiffness_nmprad", "N m/rad", "stiffness_npm", "N/m", 0.0, 1e7}}},
     1,
     "The spring beside the drive is stiffer or softer than the model says.",
     "The spring's drawing and its lever: the rate at the joint goes with the lever squared.",
     "Turn the joint slowly by hand or by its drive, foot on the ground: torque over angle is the rate."},
    {Effect::latch_delay,
     "latch_delay",
     "a switched spring that catches late",
     LocationType::spring,
     "rest = the joint's angle so much after the touch-down",
     {{{"delay_s", "s", "delay_s", "s", -0.05, 0.1}}},
     1,
     "The clutch catches the spring some time after the touch-down: the joint has moved on by then.",
     "The solenoid's rise, the debouncing of the foot's switch, the control board's cycle.",
     "Land at several speeds of the joint: an angle that is lost grows with the speed if it is a time."},
    {Effect::latch_offset,
     "latch_offset",
     "play of a switched spring",
     LocationType::spring,
     "rest = the joint's angle at the touch-down + offset",
     {{{"offset_rad", "rad", "offset_m", "m", -1.0, 1.0}}},
     1,
     "The spring begins at another angle than that of the touch-down: by play, or by the way to the clutch's next tooth.",
     "The clutch's teeth, a slack cable, the seat of the spring.",
     "Land at several speeds of the joint: an angle that is lost stays the same if it is play."},
    {Effect::second_spring,
     "second_spring",
     "the soft spring that keeps a released spring tight",
     LocationType::spring,
     "-t on the joint while the foot is in the air",
     {{{"torque_nm", "N m", "force_n", "N", -kMostTorque, kMostTorque}}},
     1,
     "A released spring does not let go of the joint altogether: what keeps its cable tight turns the joint back.",
     "The return spring of the clutch, friction of the cable in its sheath.",
     "Hold the robot up and swing the joint slowly: a torque that does not change with angle or sense."},
    {Effect::length_error,
     "length_error",
     "the model's length of a link",
     LocationType::link,
     "the next joint, or the foot, is so much further from the link's joint",
     {{{"extension_m", "m", "extension_m", "m", -1.0, 1.0}}},
     1,
     "The link is longer or shorter than the model says.",
     "A measuring tape from joint to joint, and to the ground's contact under load.",
     "Stand on the foot and move the joints slowly: the base moves as the links' lengths say."},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(kAll); ++i)
    if (static_cast<std::size_t>(kAll[i].effect) != i) return false;
  for (std::size_t i = 0; i < std::size(dynamics::kCatalogue); ++i)
    if (static_cast<std::size_t>(dynamics::kCatalogue[i].effect) != i) return false;
  return true;
}
static_assert(in_order());

}  // namespace

std::span<const EffectInfo> catalogue() { return kAll; }
const EffectInfo& info(Effect effect) { return kAll[static_cast<std::size_t>(effect)]; }

std::optional<Effect> effect_named(std::string_view name) {
  for (const EffectInfo& e : kAll)
    if (e.name == name) return e.effect;
  return std::nullopt;
}

std::string_view name(LocationType location_type) {
  constexpr std::string_view kNames[] = {"joint", "drive", "encoder", "link", "base", "log", "spring"};
  return kNames[static_cast<std::size_t>(location_type)];
}

}  // namespace furcula::trees
