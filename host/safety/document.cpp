// The page of the table of faults, see document.hpp.
#include "host/safety/document.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

#include "furcula/control/envelope.hpp"
#include "host/gait/leg_faults.hpp"
#include "host/safety/fault_table.hpp"
#include "host/safety/hil_ticks.hpp"
#include "host/walk/walker_faults.hpp"

namespace furcula::safety {
namespace {

constexpr unsigned kSeeds = 3;

const char* const kIntroduction =
    R"(# What breaks, and what the robot does then

This page is what `furcula safety docs` prints; the table itself is `host/safety/fault_table.cpp`, and the ticks are those of the simulated robot, which a test holds to this page
(`tests/host/safety/document_test.cpp`).

- **The safe state** is torque 0 and coil off (a biped's drives [brake](#a-biped-that-walks)). It is commanded on the very tick on which a fault is found, past every filter and rate limit, and stays until a person resets it. On a bus the motor is then switched off as well.
- **The spring** is caught by its own key when the coil is off: within 50 ms, by a spring and no current. Where the key or the coil is what is broken, the encoder on the cable shows a free spring as soon as the leg bears something.
- **A robot that fell silent** is stopped by others: the controller by the board's watchdog after 5 ms, the drive by its own time-out, which must be set to 5 ms, when no command comes.
- **Nothing in software stops a drive** that gives torque that nobody commanded: it is found (`drive_disobeys`), and a person must reach a switch in the drive's supply.

## Faults of the rig

Each is tried at four moments of the stride (flight, stance, released flight with the leg folded, catch), three times each, with noise, quantisation, bounce and jitter on, on the robot with its clutch that hops by 7 cm. Times are in ticks of
1 ms: from the instant that something breaks until the controller finds it (0: on the very tick), the most that is allowed and the most that was seen. *SIL* has drive and encoders behind the simulated CAN bus. *PIL* is the
Cortex-M4F without a bus, bit-equal with the host, which is where its ticks were counted (`tests/pil`). *HIL* is `furculad` on a real CAN socket and GPIO lines against a mocked robot, once at each moment, as
`scripts/hil faults` last measured it ([hil.md](hil.md)): from the same instant until the board tells its drive to be off, which is on the tick after it found the fault, and its ticks are not in step with the rig's; two more than
allowed are therefore allowed there. *Motor off* is, in SIL, from when the fault is found until the motor's torque is zero for good; "1" and more are a drive that hears nothing. `-`: not on that rig, or nothing to be found.
A motor does not change its way of turning, nor a drive its type, while it runs: `drive_reversed` and `drive_of_other_motor` are there for what tells them. This robot has one motor: they are also what two swapped drives make of it. `brown_out` has no run in PIL, whose protocol knows no new start, nor in HIL: after one `furculad`, whose file has
the counters' home, is idle without a fault, as after the end of `tests/hil/scenarios/board_killed.toml`. In HIL `torque_offset_hidden` was borne at all four moments.

| what breaks | what it is | what the robot does | found as | allowed | SIL | PIL | HIL | motor off |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
)";

std::string with_one_decimal(float x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", static_cast<double>(x));
  return text;
}

std::string found_as(const RigRow& row) {
  std::string text;
  for (const control::Fault fault : row.finds)
    if (fault != control::Fault::none)
      text += (text.empty() ? "`" : ", `") + std::string(control::info(fault).name) + "`";
  return text.empty() ? "none: it hops on" : text;
}

std::uint32_t most(const std::vector<Tried>& all, std::uint32_t Trial::*figure) {
  std::uint32_t most = 0;
  for (const Tried& t : all) most = std::max(most, t.trial.*figure);
  return most;
}

bool is_of_switch(const RigRow& row) {
  return row.breaks == sim_host::RigFault::switch_stuck_open ||
         row.breaks == sim_host::RigFault::switch_stuck_closed ||
         row.breaks == sim_host::RigFault::switch_chattering;
}

constexpr std::string_view kLanding = R"(
## Without the contact switch

The switch is one of three witnesses of the ground. The force on the toe is told from leg angle, torque and cable ([the contact observer](firmware.md#the-contact-observer)); the toe's height is that of the body less that of the leg.
Where these two agree against the switch for 20 ms, and the force had agreed with the switch in the two strides before, the switch is taken to be lost. Where they do not agree, nobody knows who is wrong: safe state at once, as before.

The robot then lands: no torque that pushes, but one that brakes the leg while it is on the ground; what the clutch has let go is brought home and caught, and nothing is let go any more; the observer takes the switch's place, and is watched
as the switch was. Once it stands still for 100 ms, and after 2 s in any case, it is in the safe state with `contact_switch_lost`. A stop, and any other fault, ends the landing at once.
The last columns are a robot whose observer is switched off, which goes limp. Each is the worst of three tries on the bus: ticks of 1 ms from the instant that the switch breaks; hip and impact from the reaction on.

| what breaks | when | lands after | lowest hip, m | hardest impact, m/s | still after | limp: lowest hip | limp: hardest impact | limp: still after |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
)";

/// The worst of several tries at one moment.
struct Worst {
  std::uint32_t landing_tick = 0, moving_ticks = 0;
  double lowest_m = 1e9, hardest_mps = 0.0;
  bool lands = true;
};
Worst worst_of(const std::vector<Tried>& all, Moment moment) {
  Worst worst;
  for (const Tried& t : all) {
    if (t.moment != moment) continue;
    worst.lands = worst.lands && t.trial.lands;
    worst.landing_tick = std::max(worst.landing_tick, t.trial.landing_tick);
    worst.moving_ticks = std::max(worst.moving_ticks, t.trial.moving_ticks);
    worst.lowest_m = std::min(worst.lowest_m, t.trial.lowest_after_m);
    worst.hardest_mps = std::max(worst.hardest_mps, t.trial.hardest_after_mps);
  }
  return worst;
}

std::string landing_rows(const RigRow& row) {
  const auto landing = try_row(row, Rig::on_bus, kSeeds), limp = try_row(row, Rig::on_bus, kSeeds, true);
  std::string text;
  char cells[200];
  for (std::size_t m = 0; m < kMoments.size(); ++m) {
    const auto moment = static_cast<Moment>(m);
    const Worst one = worst_of(landing, moment), other = worst_of(limp, moment);
    const std::string after = one.lands ? std::to_string(one.landing_tick) : std::string("-: limp at once");
    std::snprintf(cells, sizeof cells, "| %s | %.2f | %.1f | %u | %.2f | %.1f | %u |\n", after.c_str(),
                  one.lowest_m, one.hardest_mps, one.moving_ticks, other.lowest_m, other.hardest_mps,
                  other.moving_ticks);
    text += "| `" + std::string(sim_host::info(row.breaks).name) + "` | " + std::string(kMoments[m]) + " " +
            cells;
  }
  return text;
}

}  // namespace

std::string to_markdown() {
  std::string page = kIntroduction;
  const std::string bar = " | ";
  for (const RigRow& row : rig_rows()) {
    const auto& what = sim_host::info(row.breaks);
    const auto on_bus = try_row(row, Rig::on_bus, kSeeds);
    const bool needs_bus = what.part == sim_host::RigPart::bus;
    const bool in_pil = !needs_bus && row.breaks != sim_host::RigFault::brown_out;
    const auto local = !in_pil ? std::vector<Tried>{} : try_row(row, Rig::local, kSeeds);
    const std::optional<std::uint32_t> hil = hil_ticks(row.breaks);
    const auto ticks = [&](const std::vector<Tried>& all) {
      return row.is_borne() || all.empty() ? std::string("-") : std::to_string(most(all, &Trial::found_tick));
    };
    page += "| `" + std::string(what.name) + "`" + bar + std::string(what.meaning) + bar +
            std::string(row.reaction) + bar + found_as(row) + bar +
            (row.is_borne() ? "-" : std::to_string(row.found_within_ticks)) + bar + ticks(on_bus) + bar +
            ticks(local) + bar + (hil ? std::to_string(*hil) : "-") + bar +
            (row.is_borne() ? "-" : std::to_string(most(on_bus, &Trial::torque_off_ticks))) + " |\n";
  }
  page +=
      "\n## Faults at rest\n\nThe same robot stands, was never told to run, and the faults begin after 4 s; three "
      "times each. HIL tries its faults on a robot that hops.\n\n"
      "| what breaks | what the robot does | found as | allowed | SIL | PIL | HIL |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const RigRow& row : rest_rows()) {
    const auto& what = sim_host::info(row.breaks);
    const auto ticks = [&](Rig rig) {
      if (rig == Rig::local && what.part == sim_host::RigPart::bus) return std::string("-");
      return std::to_string(most(try_at_rest(row, rig, kSeeds), &Trial::found_tick));
    };
    page += "| `" + std::string(what.name) + "`" + bar + std::string(row.reaction) + bar + found_as(row) +
            bar + std::to_string(row.found_within_ticks) + bar + ticks(Rig::on_bus) + bar +
            ticks(Rig::local) + bar + "- |\n";
  }
  page +=
      "\n## What the signals do not tell\n\n| what | why | what bounds it | shown by |\n| --- | --- | --- | --- |\n";
  for (const UntoldRow& row : untold_rows())
    page += "| " + std::string(row.what) + bar + std::string(row.why) + bar + std::string(row.bound) + bar +
            "`" + std::string(row.shown_by) + "` |\n";
  page += "\n## Other faults\n\n| what breaks | what the robot does | shown by |\n| --- | --- | --- |\n";
  for (const OtherRow& row : other_rows())
    page += "| " + std::string(row.breaks) + bar + std::string(row.reaction) + bar + "`" +
            std::string(row.shown_by) + "` |\n";
  page += kLanding;
  for (const RigRow& row : rig_rows())
    if (is_of_switch(row)) page += landing_rows(row);
  page += gait::leg_fault_section();
  page += walk::walker_fault_section();
  page += R"(
## Parameters

No parameter within its bounds is meant to make the robot unsafe, and none did in the last 100,000 injections of each of two seeds (20261123, 202), whatever else was broken. What holds whatever they are is the envelope (`control/envelope.hpp`): its figures are the image's, and no parameter moves them. The robot's mass and the angle of its straight leg are among them: an image for
another robot needs its own.

- **The torque is held back** so that the apex stays below 0.70 m and the body lands with at most 2.6 m/s. The predicted apex is the last one and the motor's work since then (torque times the leg's turning) over the weight, with nothing lost, or what height and velocity say, whichever is higher: what the spring holds is
  in that work. Torque that adds energy fades over the last 5 cm; torque that takes energy out is always given. Losses are not counted, so that the robot stays below: by 10 to 20 cm with the largest torques.
- **Behind it is a fault**, `beyond_envelope`: height and velocity say that the body will be at 0.73 m or land with 2.85 m/s.
- **A torque that must exceed it is refused** when it is written (`beyond_envelope`): one that in half of a stance gives more than the highest hop has, )" +
          with_one_decimal(control::amplitude_max_nm({}, control::ProfileShape::constant)) +
          " N m constant or " +
          with_one_decimal(control::amplitude_max_nm({}, control::ProfileShape::harmonic)) +
          R"( N m harmonic with the image's mass (`furcula serve` has its model's).
- **A spring that cannot be this robot's is refused** (`makes_no_sense`): one that is not nearly relaxed in the straight leg (15 % of the touch-down height), or that the weight would bend by less than 5 mm.
- **Ceilings**: 20 N m; the leg no further folded than 1.17 rad (the hip at 0.117 m, some ticks of a fall above 0.10 m), and less pulled from 0.15 rad before; 4 N m with a switch that is open for longer than it bounces, unless the leg is moved along its path; a leg in flight that turns with 16 rad/s, or whose toe comes down with 2.5 m/s, is not driven faster.
  The bounds of the supervisor's own limits are in the table of parameters ([modbus.md](modbus.md)).
- **Parameters of another robot** are found as `parameters_implausible`. At rest: a leg that is longer than at touch-down (`link_length_m`, `touchdown_height_m` too small). In the first flight of 0.18 s or more: a deceleration that differs from gravity by more than a quarter (`height_metres_per_count`, and all lengths wrong alike). In
  the first stance from a straight leg: a spring that holds less than half or more than twice of the energy of the landing (`spring_npm`, `spring_rest_m`). While the leg is on the ground: height and leg apart, as before (`encoder_implausible`). Before a flight has shown the scale a hop gets 2.5 J. On a bench
  (`on_bench`): a leg, a rail or a switch that moves.
- **What cannot be known**: a scale of the height that is wrong by less than a quarter, with link length and touch-down height wrong alike; a spring wrong by less than a factor of two; the body's mass (it is not a parameter; a heavier robot is held back too early); a touch-down height too large by less than 3 cm;
  what the drive makes of a torque if it lies about it (`drive_disobeys` compares what it says). Before the first flight nothing but the leg's angle is known.

## What counts as unsafe

`furcula safety inject --runs N` draws experiments (torque, contraction, ground, sensors) and breaks one to three things in each, of any kind, at any instant, for a tick or for good, and counts what of it was unsafe. A robot that was put together wrongly (a motor reversed, another motor's drive) is that alone. In three of four it draws parameters too, one, two to four, or all of the table, over the whole of their bounds
(all: every second time within a quarter of the robot's own); a configuration that a node refuses is counted as refused. Early is a fault that such parameters raise before anything is broken; with the robot's own parameters it is a false alarm. It ends with
status 4 where anything was unsafe or a false alarm.

| outcome | means |
| --- | --- |
)";
  for (const UnsafeInfo& u : kUnsafe)
    page += "| `" + std::string(u.name) + "`" + bar + std::string(u.meaning) + " |\n";
  return page;
}

}  // namespace furcula::safety
