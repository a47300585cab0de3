#include "host/walk/walker_faults.hpp"

#include <algorithm>
#include <cmath>

#include "furcula/dynamics/biped/design.hpp"

namespace furcula::walk {
namespace {

using namespace dynamics::biped;
using control::Fault;

constexpr double kFound_s = 2.5, kFalls_s = 1.5;
constexpr double kLies_m =
    0.3;  // of the pelvis: but for its feet the plant has no body that meets the ground

constexpr Fault kEncoder[] = {Fault::encoder_implausible};
constexpr Fault kJump[] = {Fault::encoder_jump};
constexpr Fault kNoNumber[] = {Fault::non_finite_input};
constexpr Fault kSilent[] = {Fault::drive_silent};
constexpr Fault kError[] = {Fault::drive_fault};
constexpr Fault kOff[] = {Fault::drive_disobeys, Fault::leg_astray};
constexpr Fault kLost[] = {Fault::peer_lost};
constexpr Fault kImu[] = {Fault::imu_implausible};
constexpr Fault kGyro[] = {Fault::imu_implausible, Fault::falling};
constexpr Fault kFoot[] = {Fault::contact_implausible, Fault::falling};
constexpr Fault kPin[] = {Fault::clutch_not_engaged};
constexpr Fault kFalls[] = {Fault::falling, Fault::leg_astray, Fault::imu_implausible};
constexpr Fault kLate[] = {Fault::late_tick};

constexpr std::size_t kNoneOfThem[] = {kKnee};
constexpr std::size_t kMoving[] = {kHipRoll, kHipPitch, kKnee, kLegJoints + kAnklePitch};
constexpr std::size_t kAny[] = {kHipYaw, kHipPitch, kKnee, kLegJoints + kAnkleRoll};

constexpr WalkerFaultRow kRows[] = {
    {WalkerFault::encoder_stuck, "encoder_stuck", "angle and rate of a joint stand still", kEncoder, 150,
     kMoving},
    {WalkerFault::encoder_jumping, "encoder_jumping", "a joint's angle jumps by 0.1 rad", kJump, 0, kAny},
    {WalkerFault::encoder_slipping, "encoder_slipping",
     "a joint's angle drifts by 0.5 rad/s, its rate does not show it", kEncoder, 30, kAny},
    {WalkerFault::encoder_lost, "encoder_lost", "a joint's angle is no number, and its drive gives no torque",
     kNoNumber, 0, kAny},
    {WalkerFault::drive_silent, "drive_silent",
     "a drive is dead: no answer, no torque; one lost answer is bridged", kSilent, 1, kAny},
    {WalkerFault::drive_error, "drive_error", "a drive reports an error and gives no torque", kError, 0,
     kAny},
    {WalkerFault::drive_off, "drive_off", "a drive answers, reports no error, and gives no torque", kOff, 100,
     kMoving},
    {WalkerFault::imu_silent, "imu_silent", "the IMU does not answer; one lost answer is bridged", kLost, 1,
     kNoneOfThem},
    {WalkerFault::imu_frozen, "imu_frozen", "the IMU answers with the same numbers for ever", kImu, 20,
     kNoneOfThem},
    {WalkerFault::imu_no_number, "imu_no_number", "an angular rate is no number", kNoNumber, 0, kNoneOfThem},
    {WalkerFault::gyro_offset, "gyro_offset", "the gyro is off by 1 rad/s about y", kGyro, 700, kNoneOfThem},
    {WalkerFault::acc_dead, "acc_dead", "the accelerometer reads 0", kImu, 100, kNoneOfThem},
    {WalkerFault::foot_stuck_on, "foot_stuck_on", "the left foot reads 300 N for ever", kFoot, 1600,
     kNoneOfThem},
    {WalkerFault::foot_stuck_off, "foot_stuck_off", "the left foot reads 0 N for ever", kFoot, 500,
     kNoneOfThem},
    {WalkerFault::feet_silent, "feet_silent", "the feet do not answer; one lost answer is bridged", kLost, 1,
     kNoneOfThem},
    {WalkerFault::pin_stays_out, "pin_stays_out", "the pin of the left knee does not enter", kPin, 750,
     kNoneOfThem, true},
    {WalkerFault::pin_comes_out, "pin_comes_out", "the pin of the left knee leaves the motor's rotator", kPin,
     15, kNoneOfThem},
    {WalkerFault::pushed, "pushed", "something pushes the pelvis to 1.2 m/s sideways", kFalls, 1000,
     kNoneOfThem},
    {WalkerFault::late_tick, "late_tick", "a tick comes 5 ms late", kLate, 0, kNoneOfThem},
};

/// The walk of docs/safety.md: tests/host/walk/active_walk.toml, which a test holds it to.
constexpr std::array<double, Parameters::kCount> kTriedWalk{0.25,
                                                            -0.0665872115388582,
                                                            -0.02267593913846063,
                                                            1.0209657979631062,
                                                            0.012253927901332007,
                                                            0.0027426155756707844,
                                                            0.19045168187347453,
                                                            0.4477994741746719,
                                                            0.4379329359263224,
                                                            0.45441459053362965,
                                                            0.2988702360672894,
                                                            0.006438074673446925,
                                                            -0.1459402840051654,
                                                            0.17541549589757727,
                                                            -0.17966408118277022,
                                                            -0.049729057179712315,
                                                            0.3,
                                                            -0.08885574085138084,
                                                            -0.1485048204265182,
                                                            -0.14202321635726622,
                                                            -0.12683367774450477,
                                                            0.18170210902877781,
                                                            0.14823083862528985,
                                                            0.1713946668063813,
                                                            -0.1106413581693703,
                                                            0.022727097795468006,
                                                            -0.09982252083105699,
                                                            0.06068211136837004,
                                                            -0.11764461554903462,
                                                            -0.026768162675848334,
                                                            0.5002644905666215,
                                                            -0.042832274965401984,
                                                            -0.4059030362852824,
                                                            0.09849851919171397,
                                                            0.48331286712642574,
                                                            0.10440109768319428,
                                                            0.42715184059920885,
                                                            0.36443133788666154,
                                                            0.1897558260277783,
                                                            -0.030560578164733433,
                                                            -0.10009884985367751,
                                                            -0.251813792289937,
                                                            0.1054439334078282,
                                                            0.3632197433656402,
                                                            -0.08007675601902331,
                                                            0.02117200207641498};

/// A configuration that finds nothing.
void make_blind(control::WalkSupervisorConfig& c) {
  for (float* limit : {&c.rate_max_radps, &c.range_rad, &c.slip_rad, &c.astray_rad, &c.torque_off_nm,
                       &c.gyro_max_radps, &c.acc_max_mps2, &c.weight_most, &c.turn_off_radps, &c.vertical_off,
                       &c.neither_s, &c.unloaded_s, &c.pin_out_s, &c.pins_max_s})
    *limit = 1e30f;
  c.weight_least = c.upright_least = c.height_least_m = -1e30f;
}

}  // namespace

std::span<const WalkerFaultRow> walker_fault_rows() { return kRows; }

std::vector<WalkerRigConfig> trials_of(const WalkerFaultRow& row, const WalkerRigConfig& rig) {
  std::vector<WalkerRigConfig> out;
  std::uint64_t seed = 0;
  for (const double at_s : kWalkerFaultTimes_s)
    for (const std::size_t joint : row.joints) {
      WalkerRigConfig one = rig;
      one.seed = ++seed;
      one.fault = row.breaks;
      one.fault_s = row.from_start ? 0.0 : at_s;
      one.joint = joint;
      out.push_back(one);
    }
  return out;
}

Parameters tried_walk() { return Parameters::of(kTriedWalk); }

std::string walker_fault_section() {
  const WalkerRigConfig rig{.robot = design(), .walk = tried_walk()};
  std::string out = R"(
## A biped that walks

Ticks of 1 ms; torque: the most that a motor gave after the fault was found ([conditions](fault_handling.md#a-biped-that-walks)).

| what breaks | what it is | found as | allowed | SIL | torque, N m |
|---|---|---|---|---|---|
)";
  for (const WalkerFaultRow& row : walker_fault_rows()) {
    std::uint32_t most = 0;
    double torque_nm = 0.0;
    std::string as;
    for (const Fault fault : row.finds)
      as += (as.empty() ? "`" : ", `") + std::string(control::info(fault).name) + "`";
    for (const WalkerRigConfig& config : trials_of(row, rig)) {
      const WalkerTrial t = try_walker_fault(config);
      most = std::max(most, t.after_ticks);
      torque_nm = std::max(torque_nm, t.torque_after_nm);
    }
    out += "| `" + std::string(row.name) + "` | " + std::string(row.meaning) + " | " + as + " | " +
           std::to_string(row.within_ticks) + " | " + std::to_string(most) + " | " +
           std::to_string(std::lround(torque_nm)) + " |\n";
  }
  return out;
}

WalkerTrial try_walker_fault(const WalkerRigConfig& config, bool supervised) {
  WalkerRig rig(config);
  control::WalkerConfig board = walker_config(config, 5.0);
  if (!supervised) make_blind(board.supervisor);
  control::WalkerState state = control::begin_walker(board);
  WalkerTrial out;
  double end_s = config.fault_s + (supervised ? kFound_s : kFalls_s), work_j = 0.0;
  std::uint32_t ticks = 0;  // before this one, that had the fault
  double before_m = rig.state().position_m.z;
  while (rig.time_s() < end_s && rig.state().position_m.z > kLies_m) {
    const control::WalkerOutputs told = control::step_walker(board, state, rig.sense(), 1e-3f);
    if (told.fault != Fault::none && out.found == Fault::none) {
      out.found = told.fault;
      out.suspect = told.suspect;
      out.after_ticks = ticks;
      work_j = rig.positive_work_j();
      end_s = rig.time_s() + kFalls_s;
    }
    if (rig.broken()) ++ticks;
    rig.advance(told);
    const bool after = supervised ? out.found != Fault::none : ticks > 0;
    if (after) {
      out.torque_after_nm = std::max(out.torque_after_nm, rig.largest_torque_nm());
      out.speed_after_radps = std::max(out.speed_after_radps, rig.largest_speed_radps());
      out.fall_mps = std::max(out.fall_mps, (before_m - rig.state().position_m.z) / WalkerRig::kTick_s);
      out.work_after_j = rig.positive_work_j() - work_j;
    }
    before_m = rig.state().position_m.z;
  }
  return out;
}

}  // namespace furcula::walk
