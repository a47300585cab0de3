// The rows of the table of what breaks, see fault_table.hpp.
#include "host/safety/fault_table.hpp"

#include <algorithm>

namespace furcula::safety {
namespace {

using control::Fault;
using sim_host::RigFault;

constexpr double kForGood = 1e6;

// Where only physics can tell, the time is that of the stride: what is wrong in a flight may show as late as
// in the next stance, or, where the robot does not leave the ground any more, when it stands.
constexpr RigRow kRigRows[] = {
    {RigFault::encoder_frozen, kForGood, {Fault::stale_input}, 2, "safe state"},
    {RigFault::encoder_stuck,
     kForGood,
     {Fault::encoder_implausible, Fault::contact_implausible, Fault::parameters_implausible},
     400,
     "safe state, once the leg on the ground contradicts the height by 3.5 cm, or a flight is none"},
    {RigFault::encoder_jumping, kForGood, {Fault::encoder_jump}, 0, "safe state"},
    {RigFault::encoder_reversed,
     kForGood,
     {Fault::encoder_implausible, Fault::contact_implausible, Fault::parameters_implausible},
     400,
     "safe state, once the leg on the ground contradicts the height by 3.5 cm, or a flight is none"},
    {RigFault::encoder_backwards,
     kForGood,
     {Fault::encoder_implausible, Fault::contact_implausible, Fault::parameters_implausible},
     400,
     "safe state, once the leg on the ground contradicts the height by 3.5 cm, or a flight is none"},
    {RigFault::height_nan, kForGood, {Fault::non_finite_input}, 0, "safe state"},
    {RigFault::switch_stuck_open,
     kForGood,
     {Fault::contact_switch_lost, Fault::contact_implausible},
     1500,
     "no torque from a stance that is not seen; after 50 ms on the ground it lands without the switch (below), "
     "then safe state"},
    {RigFault::switch_stuck_closed,
     kForGood,
     {Fault::contact_switch_lost, Fault::contact_implausible, Fault::encoder_implausible},
     1500,
     "no torque high above the ground; after 20 ms of it, or when a leg that is folded in flight contradicts "
     "it, it lands without the switch (below), then safe state"},
    {RigFault::switch_chattering,
     kForGood,
     {Fault::contact_switch_lost, Fault::contact_implausible, Fault::encoder_implausible},
     1500,
     "after 20 changes it lands without the switch (below), then safe state; close above the ground, where "
     "the toe's height tells nothing, safe state at once"},
    {RigFault::late_tick, 0.005, {Fault::late_tick}, 5, "safe state on the late tick itself"},
    {RigFault::task_stuck,
     0.05,
     {Fault::late_tick},
     50,
     "the watchdog takes the torque away after 5 ms; safe state when the task comes back"},
    {RigFault::peer_lost, kForGood, {Fault::peer_lost, Fault::stale_input}, 2, "safe state"},
    {RigFault::coil_open,
     kForGood,
     {},
     0,
     "the spring stays caught: the leg waits, goes back and is not folded; after three failures tried again "
     "in every tenth flight; the robot hops on"},
    {RigFault::coil_shorted, kForGood, {}, 0, "as with an open coil"},
    {RigFault::coil_stuck_on,
     kForGood,
     {Fault::clutch_not_caught},
     4000,
     "the motor carries landings on the free spring; safe state after five of them"},
    {RigFault::key_stuck_caught, kForGood, {}, 0, "as with an open coil"},
    {RigFault::key_stuck_released,
     kForGood,
     {Fault::clutch_not_caught},
     4000,
     "as with a coil that is stuck on"},
    {RigFault::supply_sag, 1.0, {}, 0, "the release takes longer, and its delay is learned anew; hops on"},
    {RigFault::frame_lost,
     kForGood,
     {Fault::drive_silent, Fault::peer_lost, Fault::stale_input},
     3,
     "safe state; the drive, which hears nothing, stops after its own time-out of 5 ms"},
    {RigFault::frame_late,
     kForGood,
     {Fault::drive_silent, Fault::peer_lost, Fault::stale_input},
     3,
     "safe state, by the silence before the first late frame"},
    {RigFault::frame_repeated, kForGood, {}, 0, "counted, used once; the robot hops on"},
    {RigFault::frame_reordered,
     kForGood,
     {Fault::bus_unreliable},
     30,
     "one is counted and the older frame not used; safe state after ten"},
    {RigFault::frame_corrupted,
     kForGood,
     {Fault::drive_silent, Fault::peer_lost, Fault::bus_off},
     3,
     "dropped by the CAN controller and counted; safe state as with lost frames"},
    {RigFault::bus_off,
     kForGood,
     {Fault::bus_off},
     0,
     "safe state; the drive, which hears nothing, stops after its own time-out of 5 ms"},
    {RigFault::drive_silent, kForGood, {Fault::drive_silent}, 3, "safe state"},
    {RigFault::drive_error, kForGood, {Fault::drive_fault}, 1, "safe state"},
    {RigFault::drive_off,
     kForGood,
     {Fault::drive_disobeys, Fault::leg_astray},
     600,
     "safe state, once torque is wanted and none comes for 50 ms, or the leg is not moved in flight"},
    {RigFault::encoder_drifting,
     kForGood,
     {Fault::encoder_implausible, Fault::contact_implausible},
     4200,
     "as on ground that sinks or rises; safe state once it comes to 3.5 cm"},
    {RigFault::switch_vibrating,
     kForGood,
     {Fault::contact_implausible},
     600,
     "no touch-down from a closed switch high above the ground; safe state after 20 ms of it in all"},
    {RigFault::brown_out,
     0.05,
     {Fault::non_finite_input, Fault::peer_lost},
     60,
     "coil off at once, the drive stops after its own time-out of 5 ms; the board comes up idle, not homed"},
    {RigFault::drive_doubled, kForGood, {Fault::drive_doubled}, 5, "safe state"},
    {RigFault::drive_hot, kForGood, {Fault::drive_hot}, 1, "safe state"},
    {RigFault::drive_reversed,
     kForGood,
     {Fault::leg_astray, Fault::parameters_implausible},
     400,
     "safe state once the leg is moved in flight; in a stance the torque brakes, and the hops come down to 2 cm",
     true},
    {RigFault::drive_of_other_motor, kForGood, {Fault::drive_mismatch}, 1200, "safe state"},
    {RigFault::torque_offset, kForGood, {Fault::drive_disobeys}, 400, "safe state"},
    {RigFault::torque_offset_hidden,
     kForGood,
     {Fault::contact_switch_lost},
     1500,
     "hops on, or lands: the contact observer takes the offset for a force on the toe",
     true},
    {RigFault::supply_high, kForGood, {Fault::supply_too_high}, 1, "safe state"},
};

constexpr RigRow kRestRows[] = {
    {RigFault::coil_stuck_on, kForGood, {Fault::spring_loose}, 400, "safe state"},
    {RigFault::drive_doubled, kForGood, {Fault::drive_doubled}, 5, "safe state"},
    {RigFault::drive_hot, kForGood, {Fault::drive_hot}, 1, "safe state"},
    {RigFault::supply_high, kForGood, {Fault::supply_too_high}, 1, "safe state"},
};

constexpr OtherRow kOtherRows[] = {
    {"flash slot torn, at any step of a save",
     "the record before is read; with neither slot whole the parameters of the image, and the node says so",
     "tests/firmware/store/slot_store_test.cpp"},
    {"parameter out of range, or no number", "refused, the old value stays",
     "tests/common/bus/parameters_test.cpp"},
    {"parameter written while the robot is armed or runs", "refused, the old value stays",
     "tests/common/bus/node_test.cpp"},
    {"Modbus write while the robot is armed or runs", "refused, and a register says why",
     "tests/common/bus/node_registers_test.cpp"},
    {"request of an arming sequence, replayed", "does nothing a second time",
     "tests/common/bus/node_registers_test.cpp"},
    {"stream of commands falls silent", "the robot that it started stops", "tests/common/bus/node_test.cpp"},
    {"host falls silent: cable pulled, computer asleep, program ended",
     "the robot that it started over Modbus stops after `host_timeout_s`",
     "tests/common/bus/node_registers_test.cpp"},
    {"CAN command repeated, out of order, stale or of another version", "not obeyed, counted; but for a stop",
     "tests/firmware/app/can_link_test.cpp"},
    {"stop from a second host: each of 256 numbers, any version, age and length, 500 of them beside a stream of hops",
     "motor off on the next tick; the stream that goes on does not start it again",
     "tests/sil/stop_test.cpp"},
    {"the same on the emulated Cortex-M4F, by commands and by registers",
     "motor off on the next tick; the stream that goes on does not start it again",
     "tests/pil/robot_image_test.cpp"},
    {"second device with this node's id on the bus, or one that commands its drive",
     "safe state with `node_id_taken` on the tick that reads the first such frame: 0 ticks in SIL, after at most the 100 ms between two heartbeats; no reset or arming while it is there",
     "tests/sil/stop_test.cpp"},
    {"saves for ever: flash wear",
     "ten in a row, then one each ten minutes; none after 16,000; each refusal has its reason, saves are counted in the record",
     "tests/firmware/store/parameter_slots_test.cpp"},
    {"supply low before or during an erase, brown-out reset off",
     "nothing is erased, the record before stays; refused with `supply_low` or `brown_out_off`",
     "tests/firmware/chip/serial_watchdog_flash_test.cpp"},
    {"clock of microseconds wraps (71.6 minutes)",
     "nothing: every simulated run and most tests cross it; what was silent for so long is not taken for fresh",
     "tests/firmware/app/can_link_test.cpp"},
    {"number of the tick wraps (49.7 days)",
     "nothing: hops on, to the bit; a late tick at the wrap is found, a fault of the start is not reported again",
     "tests/common/bus/node_test.cpp"},
    {"Linux: link down and up, off the bus and restarted, adapter pulled out",
     "safe state with `bus_off` until a reset, however short it was, in the ticks of the row `bus_off`; the socket goes on by itself",
     "tests/hil/run"},
    {"configuration that makes no sense",
     "`bad_configuration` from the first tick on; a reset does not clear it", "tests/pil/lock_step_test.cpp"},
    {"brown-out and new start, while the host's stream still says hop",
     "idle, coil off, drive off; no request of before the start counts, and no home",
     "tests/sil/brown_out_test.cpp"},
    {"stack overflow",
     "the stack lies at the bottom of the RAM: a bus fault, the exception's handler (coil off, a line in the "
     "log) and a new start, idle, with `processor_fault`; nothing else in the RAM is touched",
     "tests/pil/robot_image_test.cpp"},
};

constexpr char kUntoldTest[] = "tests/sil/untold_faults_test.cpp";

constexpr UntoldRow kUntoldRows[] = {
    {"the height's encoder drifts by less than 3.5 cm in all",
     "the height less the leg's length is the ground's height plus the drift, in every stance: a drift of 2 mm/s "
     "is ground that rises by 1 mm in a stride",
     "the robot hops as on ground that is so much higher or lower; `encoder_implausible` at 3.5 cm, after 17 s "
     "at 2 mm/s. An encoder that drifts towards a folded leg is found in flight too: the leg's own, on its stop, "
     "by 5 mm (`leg_angle_out_of_range`)",
     kUntoldTest},
    {"the motor gives up to 1.4 N m more or less than it is told, and its current does not show it",
     "a constant torque on the leg does no work over a stance, which ends with the leg where it began; the "
     "motor's own control makes good for it in flight",
     "hops of the same height within 2 cm; what the current shows is `drive_disobeys` from 0.5 N m on",
     kUntoldTest},
    {"the motor turns the wrong way, and the leg is not moved in flight",
     "a torque that pumps with the wrong sign brakes, as friction would",
     "the hops come down to 2 cm. A leg that is pushed and folds faster than it could fall is `leg_astray`",
     kUntoldTest},
    {"the drive of an AK10-9 or AK70-10 in place of an AK80-9's",
     "the three have one range of velocity, and each unpacks and reports the torque in its own range: the "
     "frames are the same, the torque is 3.6 or 1.4 times the one that was told",
     "the AK70-10 hops to 0.41 m in place of 0.37 m. With the AK10-9 the envelope holds the hops below 0.6 m and 2.4 m/s; the toe meets the ground "
     "at 4.1 m/s, which the table below calls unsafe: try a motor that was changed with the robot held up",
     kUntoldTest},
    {"the drive of an AK80-64 in place of an AK80-9's, in its first flight",
     "its torque is 8 times the one that was told, and 2 rad of motion are needed to tell it",
     "`drive_mismatch` within 0.1 s of the first motion; the toe has then met the ground at 4.9 m/s, which the "
     "table below calls unsafe: try a motor that was changed with the robot held up",
     kUntoldTest},
    {"two drives with one node id that answer in the same bit",
     "their frames destroy each other: nothing arrives but error frames",
     "`drive_silent`, as in the row `frame_corrupted`", "tests/host/safety/fault_table_test.cpp"},
    {"the coil's output was shorted to its supply before the robot was homed",
     "the robot lies on its folded leg and is homed so: the cable has not moved since",
     "the cable comes home in the first flight, 3 mm beyond what was called home: `cable_implausible`",
     "tests/common/control/supervisor_test.cpp"},
    {"the drive's supply has too high a voltage, without a node that sends `Supply`",
     "replies of the mini-cheetah's packing have no voltage",
     "the drive's own limit: its error code 3 is `supply_too_high` as well, and a motor that is off feeds "
     "nothing back",
     "tests/firmware/app/can_link_test.cpp"},
};

}  // namespace

bool RigRow::may_find(control::Fault fault) const {
  return fault != Fault::none && std::find(finds.begin(), finds.end(), fault) != finds.end();
}

std::span<const RigRow> rig_rows() { return kRigRows; }
std::span<const RigRow> rest_rows() { return kRestRows; }
std::span<const OtherRow> other_rows() { return kOtherRows; }
std::span<const UntoldRow> untold_rows() { return kUntoldRows; }

std::vector<Tried> try_row(const RigRow& row, Rig rig, unsigned seeds, bool blind) {
  std::vector<Tried> all;
  for (unsigned seed = 1; seed <= seeds; ++seed)
    for (std::size_t m = 0; m < kMoments.size(); ++m) {
      const auto moment = static_cast<Moment>(m);
      const double at_s = instant_of(moment, seed, rig);
      sim::Scenario scenario = hopping(at_s + 1e-3 * row.found_within_ticks + 1.0);
      scenario.faults = {{at_s, row.breaks, row.duration_s}};
      all.push_back({moment, seed, run_trial(robot(), scenario, seed, rig, {}, Use::hopping, blind)});
    }
  return all;
}

std::vector<Tried> try_at_rest(const RigRow& row, Rig rig, unsigned seeds) {
  std::vector<Tried> all;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    sim::Scenario scenario = hopping(kRestsS + 1e-3 * row.found_within_ticks + 1.0);
    scenario.start_position = 0.29;
    scenario.faults = {{kRestsS, row.breaks, row.duration_s}};
    all.push_back({{}, seed, run_trial(robot(), scenario, seed, rig, {}, Use::resting)});
  }
  return all;
}

std::string_view broken_limit(const RigRow& row, const Trial& trial) {
  if (trial.false_alarm) return "a fault was found before anything broke";
  if (trial.unsafe != 0)
    for (const UnsafeInfo& u : kUnsafe)
      if (trial.is(u.outcome)) return u.name;
  if (row.is_borne()) return trial.fault == Fault::none ? "" : "a fault was found that should be borne";
  if (trial.fault == Fault::none) return row.may_come_to_rest ? "" : "not found";
  if (!row.may_find(trial.fault)) return "found by another name";
  return trial.found_tick <= row.found_within_ticks ? "" : "found too late";
}

}  // namespace furcula::safety
