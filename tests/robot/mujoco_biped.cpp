#include "tests/robot/mujoco_biped.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace furcula::robot {
namespace {

using namespace dynamics::biped;
using control::kWalkerJoints;
using control::kWalkerPins;

constexpr double kStep_s = 2.5e-4, kPinStroke_s = 0.04;
constexpr double kSphere_m = 5e-3;  // of a sole's corner
// An encoder of 14 bits on the motor, before a gear of 160; the rest as an industrial IMU and load cells.
constexpr double kEncoderStep_rad = 2.4e-6, kEncoder_rad = 5e-5, kEncoder_radps = 5e-3, kGyro_radps = 3e-3,
                 kAcc_mps2 = 0.05, kFoot_n = 2.0;
constexpr double kLeastNoise = 0.02;  // a board takes an IMU whose samples are all the same for a frozen one

std::string numbers(const Vec3<double>& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.x << " " << v.y << " " << v.z;
  return out.str();
}

/// Turns about x, y, z, one after the other.
std::string turned(const Vec3<double>& turn_rad) {
  std::ostringstream out;
  out.precision(17);
  out << "\" euler=\"" << turn_rad.x << " " << turn_rad.y << " " << turn_rad.z;
  return out.str();
}

std::string body(const LinkDescription& l) {
  std::ostringstream out;
  out.precision(17);
  const auto& s = l.about_centre_kgm2;
  out << "<inertial pos=\"" << numbers(l.centre_m) << "\" mass=\"" << l.mass_kg << "\" fullinertia=\"" << s.xx
      << " " << s.yy << " " << s.zz << " " << s.xy << " " << s.xz << " " << s.yz << "\"/>";
  return out.str();
}

std::string mjcf(const Truth& t, bool passive_hips, bool held) {
  const Description& d = t.robot;
  std::ostringstream out;
  out.precision(17);
  const auto gravity = gravity_on_slope(d.gravity_mps2, d.slope_x_rad, d.slope_y_rad);
  out << "<mujoco><compiler angle=\"radian\" eulerseq=\"xyz\"/><option timestep=\"" << kStep_s
      << "\" gravity=\"" << numbers(gravity)
      << "\" cone=\"elliptic\" integrator=\"implicit\"/><default><geom contype=\"0\" conaffinity=\"0\" friction=\""
      << d.ground.friction << " 0.005 0.0001\" solref=\"" << -5e4 * t.contact_stiffness << " "
      << -500.0 * t.contact_damping
      << "\"/></default><worldbody><geom name=\"ground\" type=\"plane\" size=\"20 20 0.1\" conaffinity=\"1\"/>"
      << "<body name=\"pelvis\" pos=\"0 0 " << (held ? 2 : 1) << "\">"
      << (held ? "" : "<freejoint name=\"base\"/>") << "<site name=\"imu" << turned(t.imu_turn_rad) << "\"/>"
      << body(d.pelvis);
  static constexpr const char* kAxes[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const std::size_t i = side * kLegJoints + j;
      const auto& drive = d.drives[side][j];
      const auto& hip = d.clutches[side][kHipClutch];
      const bool free = passive_hips && j == kHipPitch;
      const bool stiff = t.elasticity_nmprad[i] == 0.0 && t.backlash_rad[i] == 0.0;
      out << "<body pos=\"" << numbers(d.legs[side][j].offset_m) << turned(t.turns_rad[side][j])
          << "\"><joint name=\"j" << i << "\" axis=\""
          << kAxes[static_cast<std::size_t>(DesignTopology::kAxes[j])] << "\" ";
      if (free)
        out << "stiffness=\"" << hip.spring_nmprad << "\" springref=\"" << hip.spring_rest_rad
            << "\" damping=\"" << hip.damping_nmspr << "\"/>";
      else if (stiff)
        out << "armature=\"" << drive.armature_kgm2 << "\" damping=\"" << drive.damping_nmspr
            << "\" frictionloss=\"" << drive.friction_nm << "\"/>";
      else
        out << "damping=\"0.5\"/>";  // of the gear's elastic part against its housing
      out << body(d.legs[side][j]);
    }
    for (const auto& v : d.vertices_m[side])
      out << "<geom type=\"sphere\" size=\"" << kSphere_m << "\" pos=\""
          << numbers({v.x, v.y, v.z + kSphere_m}) << "\" contype=\"1\" mass=\"0\"/>";
    for (std::size_t j = 0; j < kLegJoints; ++j) out << "</body>";
  }
  out << "</body></worldbody><sensor><gyro site=\"imu\"/><accelerometer site=\"imu\"/></sensor></mujoco>";
  return out.str();
}

double rounded_to(double x, double step) { return step * std::round(x / step); }

}  // namespace

MujocoBiped::MujocoBiped(const Truth& truth, bool passive_hips, bool exercises,
                         const std::array<double, kWalkerJoints>& posture_rad,
                         const Disturbances& disturbances, std::uint64_t seed)
    : truth_(truth),
      passive_hips_(passive_hips),
      exercises_(exercises),
      disturbances_(disturbances),
      noise_(seed, 1),
      pushes_(seed, 2),
      model_(test::mujoco_model(mjcf(truth, passive_hips, exercises))),
      data_(mj_makeData(model_.get())) {
  foot_n_.fill(0.5 * truth.robot.mass_kg() * truth.robot.gravity_mps2);
  on_the_way_.assign(static_cast<std::size_t>(std::lround(truth.delay_s / kTick_s)), {});
  double pitch = 0.0;
  for (std::size_t i = 0; i < kWalkerJoints; ++i) {
    const double angle = passive(i) ? truth.robot.clutches[i / kLegJoints][kHipClutch].spring_rest_rad
                                    : posture_rad[i] - truth.encoder_offset_rad[i];
    data_->qpos[coordinate(i)] = gears_[i].angle_rad = angle;
    const std::size_t j = i % kLegJoints;
    if (j == kHipPitch || j == kKnee || j == kAnklePitch) pitch -= 0.5 * angle;  // the mean of both legs
  }
  if (exercises_) {
    foot_n_ = {0.0, 0.0};
    mj_forward(model_.get(), data_.get());
    return;
  }
  data_->qpos[2] = 1.0;
  data_->qpos[3] = std::cos(0.5 * pitch), data_->qpos[5] = std::sin(0.5 * pitch);
  place_on_ground();
}

bool MujocoBiped::passive(std::size_t i) const { return passive_hips_ && i % kLegJoints == kHipPitch; }

double MujocoBiped::motor_angle_rad(std::size_t i) const {
  return passive(i) || stiff(i) ? data_->qpos[coordinate(i)] : gears_[i].angle_rad;
}
double MujocoBiped::motor_rate_radps(std::size_t i) const {
  return passive(i) || stiff(i) ? data_->qvel[rate(i)] : gears_[i].rate_radps;
}

/// Of a gear that is not stiff, on the joint.
double MujocoBiped::gear_torque_nm(std::size_t i) const {
  constexpr double kStiff_nmprad = 5e4, kDamping_nmspr = 20.0;
  const double stiffness = truth_.elasticity_nmprad[i] > 0.0 ? truth_.elasticity_nmprad[i] : kStiff_nmprad;
  const double half = 0.5 * truth_.backlash_rad[i];
  const double twist = gears_[i].angle_rad - data_->qpos[coordinate(i)];
  if (std::abs(twist) <= half) return 0.0;
  return stiffness * (twist - std::copysign(half, twist)) +
         kDamping_nmspr * (gears_[i].rate_radps - data_->qvel[rate(i)]);
}

/// Soles level, the lowest corner at the ground.
void MujocoBiped::place_on_ground() {
  mj_kinematics(model_.get(), data_.get());
  double lowest = 1e9;
  for (int g = 0; g < model_->ngeom; ++g)
    if (model_->geom_type[g] == mjGEOM_SPHERE)
      lowest = std::min(lowest, data_->geom_xpos[3 * g + 2] - kSphere_m);
  data_->qpos[2] -= lowest + 1e-3;  // which four corners sink in under the weight
  mj_forward(model_.get(), data_.get());
}

void MujocoBiped::measure_feet() {
  foot_n_ = {0.0, 0.0};
  const int middle = model_->njnt / 2;  // joints: base, six of the left leg, six of the right
  for (int c = 0; c < data_->ncon; ++c) {
    const mjContact& contact = data_->contact[c];
    const int geom = model_->geom_type[contact.geom1] == mjGEOM_SPHERE ? contact.geom1 : contact.geom2;
    mjtNum force[6];
    mj_contactForce(model_.get(), data_.get(), c, force);
    const int joint = model_->body_jntadr[model_->geom_bodyid[geom]];
    foot_n_[joint <= middle ? 0 : 1] += force[0];
  }
}

control::WalkerInputs MujocoBiped::sense() {
  control::WalkerInputs in;
  in.run = true;
  in.tick_interval_us = 1000;
  control::WalkerSample& out = in.sample;
  out.answered = control::kAllDevices;
  const bool noisy = disturbances_.sensors;
  const auto noise = [&](double sd) { return (noisy ? sd : kLeastNoise * sd) * noise_.gaussian(); };
  for (std::size_t i = 0; i < kWalkerJoints; ++i) {
    const double angle = motor_angle_rad(i) + truth_.encoder_offset_rad[i];
    out.joints[i] = {static_cast<float>(rounded_to(angle + noise(kEncoder_rad), kEncoderStep_rad)),
                     static_cast<float>(motor_rate_radps(i) + noise(kEncoder_radps)),
                     static_cast<float>(passive(i) ? 0.0 : torque_nm_[i])};
  }
  const double* s = data_->sensordata;
  const auto vector = [&](const double* v, double sd) {
    const double x = v[0] + noise(sd), y = v[1] + noise(sd), z = v[2] + noise(sd);
    return dynamics::tree::Vec3<float>{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  if (holds_) {
    // Held level by the stand: it measures gravity alone.
    const Description& d = truth_.robot;
    const auto gravity = gravity_on_slope(d.gravity_mps2, d.slope_x_rad, d.slope_y_rad);
    const double held[] = {-gravity.x, -gravity.y, -gravity.z}, still[] = {0.0, 0.0, 0.0};
    double turned_acc[3];
    mjtNum to_site[9];
    for (int k = 0; k < 9; ++k) to_site[k] = data_->site_xmat[k];
    for (int k = 0; k < 3; ++k)
      turned_acc[k] = to_site[k] * held[0] + to_site[3 + k] * held[1] + to_site[6 + k] * held[2];
    out.gyro_radps = vector(still, kGyro_radps);
    out.acc_mps2 = vector(turned_acc, kAcc_mps2);
  } else {
    out.gyro_radps = vector(s, kGyro_radps);
    out.acc_mps2 = vector(s + 3, kAcc_mps2);
  }
  for (std::size_t side = 0; side < 2; ++side)
    out.foot_n[side] =
        static_cast<float>(std::max(0.0, foot_n_[side] - truth_.foot_threshold_change_n + noise(kFoot_n)));
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin) out.pins[pin] = static_cast<float>(pins_[pin]);
  return in;
}

void MujocoBiped::step(const std::array<control::JointCommand, kWalkerJoints>& commands) {
  mju_zero(data_->qfrc_applied, model_->nv);
  for (std::size_t i = 0; i < kWalkerJoints; ++i) {
    if (passive(i)) continue;
    const auto& drive = truth_.robot.drives[i / kLegJoints][i % kLegJoints];
    const auto& nominal = commands[i];
    // A drive's gains are off by a share, whatever it is told.
    const double kp = (1.0 + truth_.kp_change[i]) * static_cast<double>(nominal.stiffness_nmprad),
                 kd = (1.0 + truth_.kd_change[i]) * static_cast<double>(nominal.damping_nmsprad);
    const double error =
        static_cast<double>(nominal.target_rad) - motor_angle_rad(i) - truth_.encoder_offset_rad[i];
    const double motor = std::clamp(kp * error - kd * motor_rate_radps(i), -drive.limit_nm, drive.limit_nm);
    torque_nm_[i] = motor;
    if (stiff(i)) {
      data_->qfrc_applied[rate(i)] = motor;
      continue;
    }
    // The motor's side: its inertia, and the gear's friction by a steep ramp.
    constexpr double kCreep_radps = 0.01;
    Gear& gear = gears_[i];
    const double through = gear_torque_nm(i);
    const double friction = drive.friction_nm * std::clamp(gear.rate_radps / kCreep_radps, -1.0, 1.0);
    gear.rate_radps +=
        kStep_s * (motor - drive.damping_nmspr * gear.rate_radps - friction - through) / drive.armature_kgm2;
    gear.angle_rad += kStep_s * gear.rate_radps;
    data_->qfrc_applied[rate(i)] = through;
  }
  mj_step(model_.get(), data_.get());
}

void MujocoBiped::advance(const control::WalkerOutputs& told) {
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin) {
    const double stroke = kTick_s / kPinStroke_s;
    pins_[pin] += std::clamp(static_cast<double>(told.pin_targets[pin]) - pins_[pin], -stroke, stroke);
  }
  time_s_ += kTick_s;
  if (holds_) {
    if (told.stage != control::WalkerStage::walking && told.stage != control::WalkerStage::exercising) return;
    holds_ = false;
    next_push_s_ = time_s_ + 1.0;
  }
  if (time_s_ >= next_push_s_ && disturbances_.push_n > 0.0) {
    // On the stand it is a foot that is touched.
    const std::size_t body = exercises_ ? 1 + kJoints : 1;
    const double sd_n = exercises_ ? 0.3 * disturbances_.push_n : disturbances_.push_n;
    for (std::size_t k = 0; k < 2; ++k) data_->xfrc_applied[6 * body + k] = sd_n * pushes_.gaussian();
    push_until_s_ = time_s_ + 0.1;
    next_push_s_ = time_s_ - std::log(1.0 - pushes_.uniform(0.0, 1.0));
  }
  if (time_s_ >= push_until_s_) mju_zero(data_->xfrc_applied, 6 * model_->nbody);
  on_the_way_.push_back(told.joints);
  const auto commands = on_the_way_.front();
  on_the_way_.erase(on_the_way_.begin());
  for (int k = 0; k < static_cast<int>(std::lround(kTick_s / kStep_s)); ++k) step(commands);
  if (!exercises_) measure_feet();
}

}  // namespace furcula::robot
