// The page of the table of faults, see document.hpp.
#include "host/safety/document.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "host/safety/fault_table.hpp"
#include "host/safety/hil_ticks.hpp"

namespace furcula::safety {
namespace {

constexpr unsigned kSeeds = 3;

const char* const kIntroduction =
    R"(# What breaks, and what the robot does then

This page is what `furcula safety docs` prints; the table itself is `host/safety/fault_table.cpp`, and the ticks are those of the simulated robot, which a test holds to this page
(`tests/host/safety/document_test.cpp`).

- **The safe state** is torque 0 and coil off. It is commanded on the very tick on which a fault is found, past every filter and rate limit, and stays until a person resets it. On a bus the motor is then switched off as well.
- **The spring** is caught by its own key when the coil is off: within 50 ms, by a spring and no current. Where the key or the coil is what is broken, the encoder on the cable shows a free spring as soon as the leg bears something.
- **A robot that fell silent** is stopped by others: the controller by the board's watchdog after 5 ms, the drive by its own time-out, which must be set to 5 ms, when no command comes.
- **Nothing in software stops a drive** that gives torque that nobody commanded: it is found (`drive_disobeys`), and a person must reach a switch in the drive's supply.

## Faults of the rig

Each is tried at four moments of the stride (flight, stance, released flight with the leg folded, catch), three times each, with noise, quantisation, bounce and jitter on, on the robot with its clutch that hops by 7 cm. Times are in ticks of
1 ms: from the instant that something breaks until the controller finds it (0: on the very tick), the most that is allowed and the most that was seen. *SIL* has drive and encoders behind the simulated CAN bus. *PIL* is the
Cortex-M4F without a bus, bit-equal with the host, which is where its ticks were counted (`tests/pil`). *HIL* is `furculad` on a real CAN socket and GPIO lines against a mocked robot, once at each moment, as
`scripts/hil faults` last measured it ([hil.md](hil.md)): from the same instant until the board tells its drive to be off, which is on the tick after it found the fault, and its ticks are not in step with the rig's; two more than
allowed are therefore allowed there. *Motor off* is, in SIL, from when the fault is found until the motor's torque is zero for good; "1" and more are a drive that hears nothing. `-`: not on that rig, or nothing to be found.
A motor does not change its way of turning, nor a drive its type, while it runs: `drive_reversed` and `drive_of_other_motor` are there for what tells them. `brown_out` has no run in PIL, whose protocol knows no new start, nor in HIL: after one `furculad`, whose file has
the counters' home, is idle without a fault, as after the end of `tests/hil/scenarios/board_killed.toml`. The rows from `encoder_drifting` on have not been measured in HIL yet.

| what breaks | what it is | what the robot does | found as | allowed | SIL | PIL | HIL | motor off |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
)";

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
  page += R"(
## What counts as unsafe

`furcula safety inject --runs N` draws experiments (torque, contraction, ground, sensors) and breaks one to three things in each, of any kind, at any instant, for a tick or for good, and counts what of it was unsafe. It ends with
status 4 where anything was.

| outcome | means |
| --- | --- |
)";
  for (const UnsafeInfo& u : kUnsafe)
    page += "| `" + std::string(u.name) + "`" + bar + std::string(u.meaning) + " |\n";
  return page;
}

}  // namespace furcula::safety
