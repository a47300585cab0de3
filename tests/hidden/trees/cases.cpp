#include "tests/hidden/trees/cases.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/hidden/trees/planter.hpp"
#include "tests/hidden/trees/stage.hpp"

namespace furcula::hidden::trees {
namespace {

constexpr double kWindow_s = 0.3;
constexpr std::size_t kWindowsOfALog = 8;
// A leg's stance is hardly longer; one that is shorter than half of it has no window.
constexpr double kLegWindow_s = 0.15, kLeastLegWindow_s = 0.075;
constexpr std::size_t kPhasesOfALog = 10;

// What each cause changes, over what the disturbance does, at the joint where that is most.
std::vector<double> shown(const Case& c) {
  const Restarts restarts(c);
  const auto full = restarts.of(restarts.truth);
  const Values noise = rms_difference(full, restarts.happened);
  std::vector<double> out;
  for (std::size_t i = 0; i < c.planted.size(); ++i) {
    std::vector<Cause> others = c.planted;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Values changed = rms_difference(restarts.of(c.with(others)), full);
    double most = 0.0;
    for (std::size_t j = 0; j < c.visible(); ++j)
      most = std::max(most, changed[j] / std::max(noise[j], c.lab.resolution[j]));
    out.push_back(most);
  }
  return out;
}

// Limits that the robot keeps.
void set_limits(Case& c) {
  for (std::size_t j = 0; j < c.visible(); ++j) {
    Joint& joint = c.robot.joints[j];
    double low = joint.centre - joint.range, high = joint.centre + joint.range, speed = 0.0, torque = 0.0;
    for (const Recording& log : c.logs)
      for (std::size_t row = 0; row < log.state.size(); ++row) {
        low = std::min(low, log.state[row].q[j]);
        high = std::max(high, log.state[row].q[j]);
        speed = std::max(speed, std::fabs(log.state[row].v[j]));
        torque = std::max(torque, std::fabs(log.torque_nm[row][j]));
        if (!c.lab.position_control) torque = std::max(torque, std::fabs(log.input[row][j]));
      }
    if (c.robot.leg && joint.prismatic) torque = 100.0;  // the boom has no drive
    const double beside = joint.prismatic ? 0.1 : 0.6;
    joint.lower = low - beside;
    joint.upper = high + beside;
    joint.velocity = std::ceil(2 * speed);
    joint.effort = std::ceil(2000 * torque) / 1000;
  }
}

}  // namespace

std::string_view name(Tier tier) {
  switch (tier) {
    case Tier::clean:
      return "clean";
    case Tier::small:
      return "small";
    case Tier::medium:
      return "medium";
    case Tier::large:
      return "large";
    case Tier::tied:
      return "tied";
    case Tier::pairs:
      return "pairs";
    case Tier::triple:
      return "triple";
    case Tier::outside:
      break;
  }
  return "outside";
}

const std::vector<std::string>& catalogue() {
  static const std::vector<std::string> kEffects = {"coulomb_friction",
                                                    "stribeck_friction",
                                                    "asymmetric_friction",
                                                    "damping_error",
                                                    "quadratic_drag",
                                                    "binding_spot",
                                                    "load_friction",
                                                    "force_offset",
                                                    "rotor_inertia_error",
                                                    "torque_gain_error",
                                                    "actuator_delay",
                                                    "actuator_lag",
                                                    "torque_saturation",
                                                    "position_gain_error",
                                                    "joint_elasticity",
                                                    "torque_ripple",
                                                    "encoder_offset",
                                                    "mass_error",
                                                    "com_error",
                                                    "payload",
                                                    "base_tilt"};
  return kEffects;
}

const std::vector<std::string>& leg_catalogue() {
  static const std::vector<std::string> kEffects = {
      "coulomb_friction",    "stribeck_friction", "asymmetric_friction", "damping_error",
      "quadratic_drag",      "binding_spot",      "load_friction",       "force_offset",
      "rotor_inertia_error", "torque_gain_error", "actuator_delay",      "actuator_lag",
      "torque_saturation",   "encoder_offset",    "mass_error",          "com_error",
      "inertia_error",       "payload",           "spring_rate_error",   "latch_delay",
      "latch_offset",        "second_spring",     "length_error"};
  return kEffects;
}

const std::vector<std::string>& leg_outside_causes() {
  static const std::vector<std::string> kCauses = {"cable_spring", "growing_friction", "coupled_friction",
                                                   "torque_crosstalk", "periodic_torque"};
  return kCauses;
}

const std::vector<std::string>& outside_causes() {
  static const std::vector<std::string> kCauses = {"cable_spring",     "growing_friction", "coupled_friction",
                                                   "torque_crosstalk", "periodic_torque",  "resonator"};
  return kCauses;
}

std::string family(const std::string& effect) {
  if (effect.find("friction") != std::string::npos || effect == "binding_spot") return "friction";
  if (effect == "damping_error" || effect == "quadratic_drag") return "viscous";
  if (effect == "actuator_delay" || effect == "actuator_lag") return "timing";
  if (effect == "mass_error" || effect == "com_error" || effect == "payload" || effect == "inertia_error")
    return "mass";
  if (effect == "spring_rate_error") return "spring";
  if (effect == "latch_delay" || effect == "latch_offset") return "latch";
  if (effect == "force_offset" || effect == "encoder_offset" || effect == "base_tilt") return "offset";
  return effect;
}

void Restarts::add(const Window& w) {
  windows.push_back(w);
  std::vector<Values> seen;
  for (std::size_t row = w.begin + 1; row <= w.end; ++row) {
    Values q = c.logs[w.log].state[row].q;
    for (std::size_t j = 0; j < c.visible(); ++j) q[j] += truth.act(j).encoder_rad;
    seen.push_back(q);
  }
  happened.push_back(seen);
}

void Restarts::windows_of_a_leg(std::size_t of_log) {
  const Recording& log = c.logs[of_log];
  // From the second change of contact on: the first rows have no past that a delay could reach for.
  std::vector<Window> phases;
  for (std::size_t i = 1; i + 1 < log.contacts.size(); ++i) {
    // A command that lets the toe leave does so from its row on: that row still stands.
    const auto row_after = [&](const Contact& change) {
      const auto at = std::lower_bound(log.time_s.begin(), log.time_s.end(), change.time_s);
      auto row = static_cast<std::size_t>(at - log.time_s.begin());
      while (row < log.state.size() && log.state[row].stance != change.down) ++row;
      return row;
    };
    const std::size_t begin = row_after(log.contacts[i]), end = row_after(log.contacts[i + 1]) - 1;
    const auto longest = static_cast<std::size_t>(kLegWindow_s * c.lab.rate_hz);
    const auto least = static_cast<std::size_t>(kLeastLegWindow_s * c.lab.rate_hz);
    if (end < begin + least) continue;
    phases.push_back({of_log, begin, std::min(end, begin + longest)});
  }
  // Flights and stances take turns: pairs of them are left out.
  const std::size_t stride = std::max<std::size_t>(phases.size() / kPhasesOfALog, 1);
  for (std::size_t i = 0; i < phases.size(); ++i)
    if ((i / 2) % stride == 0) add(phases[i]);
}

Restarts::Restarts(const Case& of_case) : c(of_case), truth(of_case.truth()) {
  const auto length = static_cast<std::size_t>(kWindow_s * c.lab.rate_hz);
  for (std::size_t i = c.logs.size() - c.held_out; i < c.logs.size(); ++i) {
    if (c.robot.leg) {
      windows_of_a_leg(i);
      continue;
    }
    const Recording& log = c.logs[i];
    const std::size_t rows = log.time_s.size() - 1, stride = std::max(length, rows / kWindowsOfALog);
    // The first rows have no past that a delay could reach for.
    for (std::size_t begin = length / 2; begin + length <= rows; begin += stride) {
      add({i, begin, begin + length});
    }
  }
}

std::vector<std::vector<Values>> Restarts::of(const Machine& machine) const {
  std::vector<std::vector<Values>> out;
  for (const Window& w : windows) out.push_back(restarted(machine, truth, c.logs[w.log], w.begin, w.end));
  return out;
}

Values rms_difference(const std::vector<std::vector<Values>>& a, const std::vector<std::vector<Values>>& b) {
  std::vector<Values> differences;
  for (std::size_t w = 0; w < a.size(); ++w)
    for (std::size_t row = 0; row < a[w].size(); ++row) {
      Values d{};
      for (std::size_t j = 0; j < kMost; ++j) d[j] = a[w][row][j] - b[w][row][j];
      differences.push_back(d);
    }
  return rms_of(differences);
}

Case draw_case(const Question& question) {
  std::size_t vain = 0, fell = 0;
  for (std::uint64_t attempt = 0; attempt < (question.leg ? 25 : 60); ++attempt) {
    Random random(question.seed * 0x9E3779B97F4A7C15U + attempt * 0x632BE59BD9B4E019U +
                  static_cast<std::uint64_t>(question.tier));
    auto stage = question.leg ? draw_leg_stage(question, random) : draw_stage(question, random);
    ++vain;
    if (!stage) continue;
    stage->c.redrawn_logs += fell;
    const auto [least, most] = shares(question.tier);
    const double must_show = question.tier == Tier::small ? 0.5 : 2.0;
    // Other seats and larger shares, until each cause shows.
    double boost = 1.0;
    for (int tries = 0; tries < 6; ++tries) {
      stage->c.planted.clear();
      Planter planter(*stage, random);
      bool complete = true;
      for (const std::string& effect : question.effects) {
        const double share = std::min(boost * random.log_uniform(least, most), most);
        auto cause = planter.propose(effect, share, question.tier == Tier::tied, stage->c.planted);
        complete = complete && cause.has_value();
        if (cause) stage->c.planted.push_back(*cause);
      }
      ++vain;
      if (!complete || !record_all(*stage, random)) continue;
      Case& c = stage->c;
      c.shows = shown(c);
      boost *= 1.6;
      if (std::any_of(c.shows.begin(), c.shows.end(), [&](double x) { return x < must_show; })) continue;
      set_limits(c);
      c.model = c.drives;
      if (c.free_damping)
        for (std::size_t j = c.robot.leg ? c.robot.leg->hip : 0; j < c.visible(); ++j)
          c.model[j].damping_nmspr *= random.uniform(0.5, 1.5);
      c.redrawn = vain - 2;
      return c;
    }
    fell = stage->c.redrawn_logs;
  }
  throw std::runtime_error("no robot on which this shows");
}

}  // namespace furcula::hidden::trees
