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

const char* const kIntroduction = R"(# Faults

This page is what `furcula safety docs` prints, from `host/safety/fault_table.cpp` and `common/include/furcula/control/fault.hpp`.
Reactions, test levels and limits are explained in [fault handling](fault_handling.md).

## Fault numbers

| number | name | means | what to do |
|---|---|---|---|
)";

constexpr std::string_view kOfRig = R"(
## Faults of the rig

Ticks of 1 ms from the fault until it is found: the most allowed, and the most seen at each [test level](fault_handling.md#the-table-of-faults).

| what breaks | what it is | what the robot does | found as | allowed | SIL | PIL | HIL | motor off |
|---|---|---|---|---|---|---|---|---|
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

The worst of three tries, in ticks from the fault ([landing](fault_handling.md#landing-without-the-contact-switch)). Limp: with the contact observer switched off.

| what breaks | when | lands after | lowest hip, m | hardest impact, m/s | still after | limp: lowest hip | limp: hardest impact | limp: still after |
|---|---|---|---|---|---|---|---|---|
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
  for (const control::FaultInfo& f : control::kFaults)
    page += "| " + std::to_string(static_cast<int>(f.fault)) + " | `" + std::string(f.name) + "` | " +
            std::string(f.meaning) + " | " + std::string(f.remedy) + " |\n";
  page += kOfRig;
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
      "\n## Faults at rest\n\nOf a robot that stands and was never told to run.\n\n"
      "| what breaks | what the robot does | found as | allowed | SIL | PIL |\n|---|---|---|---|---|---|\n";
  for (const RigRow& row : rest_rows()) {
    const auto& what = sim_host::info(row.breaks);
    const auto ticks = [&](Rig rig) {
      if (rig == Rig::local && what.part == sim_host::RigPart::bus) return std::string("-");
      return std::to_string(most(try_at_rest(row, rig, kSeeds), &Trial::found_tick));
    };
    page += "| `" + std::string(what.name) + "`" + bar + std::string(row.reaction) + bar + found_as(row) +
            bar + std::to_string(row.found_within_ticks) + bar + ticks(Rig::on_bus) + bar +
            ticks(Rig::local) + " |\n";
  }
  page +=
      "\n## What the signals do not tell\n\n| what | why | what bounds it | shown by |\n|---|---|---|---|\n";
  for (const UntoldRow& row : untold_rows())
    page += "| " + std::string(row.what) + bar + std::string(row.why) + bar + std::string(row.bound) + bar +
            "`" + std::string(row.shown_by) + "` |\n";
  page += "\n## Other faults\n\n| what breaks | what the robot does | shown by |\n|---|---|---|\n";
  for (const OtherRow& row : other_rows())
    page += "| " + std::string(row.breaks) + bar + std::string(row.reaction) + bar + "`" +
            std::string(row.shown_by) + "` |\n";
  page += kLanding;
  for (const RigRow& row : rig_rows())
    if (is_of_switch(row)) page += landing_rows(row);
  page += gait::leg_fault_section();
  page += walk::walker_fault_section();
  page +=
      "\n## Largest torque amplitude\n\nA larger one is refused as `beyond_envelope`.\n\n| shape | N m |\n|---|---|\n| constant | " +
      with_one_decimal(control::amplitude_max_nm({}, control::ProfileShape::constant)) + " |\n| harmonic | " +
      with_one_decimal(control::amplitude_max_nm({}, control::ProfileShape::harmonic)) +
      " |\n\n## What counts as unsafe\n\n| outcome | means |\n|---|---|\n";
  for (const UnsafeInfo& u : kUnsafe)
    page += "| `" + std::string(u.name) + "`" + bar + std::string(u.meaning) + " |\n";
  return page;
}

}  // namespace furcula::safety
