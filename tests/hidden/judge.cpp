// See judge.hpp. The same law under two names (docs/contracts.md, section 3), as far as these rigs can plant
// it:
//
// - asymmetric_friction (Fc+, Fc-) is coulomb_friction (Fc+ + Fc-)/2 with force_offset (Fc- - Fc+)/2, at rest
//   too: friction then holds between -Fc+ and Fc- in both descriptions.
// - spring_preload F is rest_height_error z0 + F/k.
// - guide_tilt is force_offset m g (1 - cos(tilt)).
// - torque_gain_error g on a hopper whose mass and damping are free is stiffness_error k/g: dividing the
//   equation of motion by g leaves the commanded torque with gain one and mass, stiffness and both dampings
//   divided by g. With the mass known (Case::weighed) the two differ by what a scale would read.
// - actuator_delay is time_skew on an axis with two channels.
// - incomplete_release and auxiliary_spring on a hopper each change the rate of the released leg.
// - mass_error m' on a rail is damping_error d m / m': nothing but the rail's damper tells what it weighs.
//
// What no data of these rigs decide: Stribeck friction with a small (Fs - Fc) on the hopper. It passes
// standstill twice a hop, at apex and at the deepest point, for some 20 ms each, and the excess pulls one way
// before and the other way after. The best Coulomb friction, with mass and dampings re-fitted, then predicts
// whole strides to about 0.04 mm (computed with this folder's machine from true states): less than half a
// count of the encoder. Coulomb friction, the law's simpler case, is then the right name. Where it leaves
// more than a count, it is not.
#include "tests/hidden/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "host/diagnose/diagnose.hpp"

namespace furcula::hidden {

namespace {

using diagnose::Finding;

std::string_view effect_name(dynamics::Effect e) { return dynamics::info(e).name; }

const Finding* find(const diagnose::Diagnosis& d, std::string_view effect) {
  for (const Finding& f : d.findings)
    if (effect_name(f.effect) == effect) return &f;
  return nullptr;
}

bool has_rival(const Finding& f, std::string_view effect) {
  return std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                     [&](const auto& rival) {
                       return std::find(rival.names.begin(), rival.names.end(), effect) != rival.names.end();
                     });
}

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

// The value of a law's first parameter at which there is nothing to find.
double neutral_value(const Case& c, std::string_view law) {
  const auto held = [&](std::string_view name) { return c.model.parameter(name); };
  if (law == "mass_error") return c.model.parameters[0];
  if (law == "damping_error")
    return c.kind == Kind::hopper_linear      ? 0.0
           : is_kind(c.kind, "clutch_bench")  ? held("damping_nmspr")
           : is_kind(c.kind, "rail_carriage") ? held("damping_nspm")
                                              : c.model.parameters.back();
  if (law == "late_catch") return c.model.clutch ? c.model.clutch->catch_delay_s : held("catch_delay_s");
  if (law == "auxiliary_spring")
    return c.model.clutch ? c.model.clutch->auxiliary_stiffness_npm : held("auxiliary_stiffness_npm");
  if (law == "stiffness_error") return held("stiffness_npm");
  if (law == "rest_height_error") return held("rest_height_m");
  if (law == "touchdown_loss") return held("restitution_touchdown");
  if (law == "liftoff_loss") return held("restitution_liftoff");
  if (law == "torque_gain_error" || law == "thermal_derating" || law == "height_scale_error") return 1.0;
  return 0.0;
}

ParameterError compare(const Case& c, std::string_view law, std::size_t index, double expected,
                       const Finding& f) {
  ParameterError e;
  const Kind kind = c.kind;
  e.name = parameter_name(*law_named(law), index, kind);
  e.expected = expected;
  e.neutral = index == 0 ? neutral_value(c, law) : 0.0;
  // Where a stop begins is no size.
  e.main = law == "bump_stop" ? index == 1 : index == 0 || law == "asymmetric_friction";
  auto estimate = f.parameters.find(e.name);
  if (estimate == f.parameters.end())
    estimate = f.parameters.find(
        std::string(dynamics::name_on(dynamics::info(f.effect).parameter_table[index], kind)));
  if (estimate == f.parameters.end()) {
    e.found = e.lower = e.upper = std::nan("");
    return e;
  }
  e.found = estimate->second.value;
  e.lower = estimate->second.lower;
  e.upper = estimate->second.upper;
  if (e.name == "phase_rad") {  // the same a turn further
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const double turns = kTurn * std::round((e.found - e.expected) / kTurn);
    e.found -= turns;
    e.lower -= turns;
    e.upper -= turns;
  }
  return e;
}

// A planted law in other words.
struct OtherWords {
  std::vector<Planted> laws;
};

std::vector<OtherWords> in_other_words(const Case& c, const Planted& p) {
  const double v = p.values[0];
  std::vector<OtherWords> out;
  if (p.law == "asymmetric_friction")
    out.push_back(
        {{{"coulomb_friction", {(v + p.values[1]) / 2}}, {"force_offset", {(p.values[1] - v) / 2}}}});
  if (c.kind == Kind::hopper_linear) {
    const double rate = c.model.parameter("stiffness_npm"), rest = c.model.parameter("rest_height_m");
    const double weight = c.truth.parameters[0] * c.model.parameter("gravity_mps2");
    if (c.model.clutch) {  // both are another rate of the released leg
      const auto series = [&](double auxiliary) { return rate * auxiliary / (rate + auxiliary); };
      const double modelled = series(c.model.clutch->auxiliary_stiffness_npm);
      const double loose = p.law == "auxiliary_spring" ? series(v) : modelled + v * (rate - modelled);
      if (p.law == "auxiliary_spring")
        out.push_back({{{"incomplete_release", {(loose - modelled) / (rate - modelled)}}}});
      if (p.law == "incomplete_release")
        out.push_back({{{"auxiliary_spring", {rate * loose / (rate - loose)}}}});
    }
    if (p.law == "spring_preload") out.push_back({{{"rest_height_error", {rest + v / rate}}}});
    if (p.law == "rest_height_error") out.push_back({{{"spring_preload", {(v - rest) * rate}}}});
    if (p.law == "guide_tilt") out.push_back({{{"force_offset", {weight * (1 - std::cos(v))}}}});
    if (p.law == "force_offset" && v > 0 && v < weight)
      out.push_back({{{"guide_tilt", {std::acos(1 - v / weight)}}}});
    if (!c.weighed && p.law == "torque_gain_error") out.push_back({{{"stiffness_error", {rate / v}}}});
    if (!c.weighed && p.law == "stiffness_error") out.push_back({{{"torque_gain_error", {rate / v}}}});
  } else if (is_kind(c.kind, "rail_carriage")) {
    const double mass = c.model.parameter("mass_kg"), weight = mass * c.model.parameter("gravity_mps2");
    const double damping = c.model.parameter("damping_nspm");
    if (p.law == "guide_tilt") out.push_back({{{"force_offset", {weight * (1 - std::cos(v))}}}});
    if (p.law == "force_offset" && v > 0 && v < weight)
      out.push_back({{{"guide_tilt", {std::acos(1 - v / weight)}}}});
    if (p.law == "mass_error") out.push_back({{{"damping_error", {damping * mass / v}}}});
    if (p.law == "damping_error") out.push_back({{{"mass_error", {mass * damping / v}}}});
  } else {
    if (p.law == "actuator_delay") out.push_back({{{"time_skew", {v}}}});
    if (p.law == "time_skew") out.push_back({{{"actuator_delay", {v}}}});
  }
  return out;
}

struct TrueError {
  double squares = 0.0;
  std::size_t samples = 0;
};

// The errors of position that a model makes over the true trajectories, started anew from the
// true state at each apex (hopper) or every half second. The drive remembers the whole recording.
TrueError true_error(const Truth& believed, const std::vector<Trajectory>& trajectories) {
  constexpr double kWindow_s = 0.5;
  TrueError sum;
  for (const Trajectory& t : trajectories) {
    std::optional<Machine> m;
    Drive drive(believed.planted, t.time_s.front(), 0);
    double begun_s = 0.0;
    for (std::size_t i = 1; i < t.time_s.size(); ++i) {
      drive.command(t.time_s[i - 1], t.command[i - 1]);
      drive.settle(t.time_s[i]);
      const bool held = !t.held.empty() && t.held[i];
      if (held) m.reset();
      const bool begins = held              ? false
                          : !t.held.empty() ? !m
                          : believed.kind == Kind::hopper_linear
                              ? t.velocity[i - 1] >= 0 && t.velocity[i] < 0 && t.command[i] == 0
                              : t.time_s[i] - begun_s >= kWindow_s || !m;
      if (begins) {
        begun_s = t.time_s[i];
        m.emplace(believed, t.position[i], t.velocity[i], t.time_s[i]);
        m->take_over(drive);
      } else if (m) {
        m->advance(t.time_s[i], t.command[i - 1], 100e-6);
        const double error = m->position() - t.position[i];
        sum.squares += error * error;
        ++sum.samples;
      }
    }
  }
  return sum;
}

bool moves_the_body(const std::vector<Planted>& planted, Kind kind) {
  return std::all_of(planted.begin(), planted.end(), [&](const Planted& p) {
    const LawInfo* law = law_named(p.law);
    return law && law->on(kind) && law->acts == Acts::on_the_body;
  });
}

void judge_predictions(Judgement& j, const Case& c, const diagnose::Diagnosis& d) {
  j.removed_truly = j.remaining_rms = std::nan("");
  Truth refitted{c.kind, {}, {}}, extended{c.kind, d.extended_model.parameters, {}};
  for (const auto& row : d.parameters) refitted.parameters.push_back(row.refitted.value);
  if (refitted.parameters.size() != c.model.parameters.size() ||
      extended.parameters.size() != c.model.parameters.size())
    return;
  for (const auto& [effect, values] : d.extended_model.effects) {
    Planted p{std::string(effect_name(effect)), {}};
    std::copy_n(values.begin(), std::min(values.size(), p.values.size()), p.values.begin());
    extended.planted.push_back(p);
  }
  // No machine of this folder starts with a clutch between its states.
  if (is_kind(c.kind, "clutch_bench") || c.model.clutch) return;
  if (!moves_the_body(extended.planted, c.kind) || !moves_the_body(c.truth.planted, c.kind)) return;
  // Unfit values (a ground without a damper) are no machine.
  try {
    // What is random in the machine_type is nobody's to predict.
    Truth undisturbed = c.truth;
    undisturbed.disturbance = {};
    const TrueError before = true_error(refitted, c.held_out_truth),
                    after = true_error(extended, c.held_out_truth);
    const double random = c.truth.disturbance.any() ? true_error(undisturbed, c.held_out_truth).squares : 0.0;
    j.remaining_rms = std::sqrt(std::max(0.0, after.squares - random) / static_cast<double>(after.samples));
    j.removed_truly = 1.0 - (after.squares - random) / (before.squares - random);
  } catch (const std::invalid_argument&) {
  }
}

std::string line(const diagnose::Diagnosis& d, double removed) {
  std::string text(name(d.verdict));
  for (const Finding& f : d.findings) {
    text += "; " + std::string(effect_name(f.effect));
    for (const auto& [parameter, estimate] : f.parameters)
      text += " " + parameter + "=" + format("%.4g", estimate.value) + format(" [%.4g", estimate.lower) +
              format(", %.4g]", estimate.upper);
    text += format(" (removes %.3f", f.explainable_nmse_removed) + format(", confidence %.2f)", f.confidence);
    for (const auto& rival : f.indistinguishable_from) {
      text += " ~";
      for (const std::string& n : rival.names) text += " " + n;
    }
  }
  const auto nmse = [&](const diagnose::Errors& errors) {
    const auto channel = errors.find(d.main_channel);
    return channel == errors.end() ? std::string("?") : format("%.3g", channel->second.nmse);
  };
  return text + "; held-out nmse of " + d.main_channel + ": given " + nmse(d.baseline) + ", re-fitted " +
         nmse(d.refitted) + ", extended " + nmse(d.extended) + ", floor " + nmse(d.noise_floor) +
         format("; removed %.3f", removed) +
         (!d.remainder ? std::string()
                       : format("; left: of %.3g", d.remainder->typical_force) +
                             format(" at random %.3g", d.remainder->random_force) +
                             format(" over %.3g s,", d.remainder->correlation_s) +
                             format(" impacts %.3g,", d.remainder->impact_scatter) +
                             format(" predictable %.3g", d.remainder->predictable.force) +
                             format(" (takes off %.3f,", d.remainder->predictable.share) +
                             format(" %.1f standard errors),", d.remainder->predictable.deviations) +
                             format(" correlation of what is new %.3f", d.remainder->new_finds.correlation));
}

// A finding that nobody planted: there is none of it, and its interval should say so.
void add_extra(Judgement& j, const Case& c, const Finding& f) {
  j.extra.emplace_back(effect_name(f.effect));
  if (law_named(effect_name(f.effect)) == nullptr) return;
  ParameterError e = compare(c, effect_name(f.effect), 0, neutral_value(c, effect_name(f.effect)), f);
  e.main = false;
  if (!std::isnan(e.found)) j.parameters.push_back(e);
}

// Which of the findings are the planted laws, and what that makes of the diagnosis.
void judge_names(Judgement& j, const Case& c, const diagnose::Diagnosis& d) {
  const auto& planted = c.truth.planted;
  if (c.outside()) {
    constexpr double kDoubted = 0.5;
    const bool doubted = std::none_of(d.findings.begin(), d.findings.end(),
                                      [](const Finding& f) { return f.confidence > kDoubted; });
    const bool said =
        d.verdict == diagnose::Verdict::unexplained || d.verdict == diagnose::Verdict::partly_explained;
    j.outcome = said || (doubted && !d.findings.empty()) ? Outcome::honest
                : d.findings.empty()                     ? Outcome::nothing_named
                                                         : Outcome::wrong_name;
    for (const Finding& f : d.findings) add_extra(j, c, f);
    return;
  }
  if (d.findings.empty()) return;
  if (planted.empty()) {
    j.outcome = Outcome::wrong_name;
    for (const Finding& f : d.findings) add_extra(j, c, f);
    return;
  }

  // That are the planted laws, or a part of them in other words; and those that have one among their rivals.
  std::vector<const Finding*> right_by_name, right;
  std::size_t named = 0, rivals = 0;
  for (const Planted& p : planted) {
    const Finding* itself = find(d, p.law);
    if (itself) {
      right_by_name.push_back(itself);
      right.push_back(itself);
      ++named;
      const LawInfo& law = *law_named(p.law);
      for (std::size_t i = 0; i < kMostValues && !law.parameters[i].empty(); ++i)
        j.parameters.push_back(compare(c, p.law, i, p.values[i], *itself));
      continue;
    }
    bool found = false;
    for (const OtherWords& words : in_other_words(c, p)) {
      std::vector<const Finding*> findings;
      for (const Planted& other : words.laws) findings.push_back(find(d, other.law));
      if (std::count(findings.begin(), findings.end(), nullptr) > 0) continue;
      // The contract's other name must be said.
      if (std::none_of(findings.begin(), findings.end(),
                       [&](const Finding* f) { return has_rival(*f, p.law); }))
        continue;
      for (std::size_t i = 0; i < findings.size(); ++i) {
        j.parameters.push_back(compare(c, words.laws[i].law, 0, words.laws[i].values[0], *findings[i]));
        right_by_name.push_back(findings[i]);
        right.push_back(findings[i]);
      }
      found = j.other_name = true;
      ++named;
      break;
    }
    if (!found)
      for (const Finding& f : d.findings)
        if (has_rival(f, p.law)) {
          right.push_back(&f);
          ++rivals;
          break;
        }
  }
  for (const Finding& f : d.findings)
    if (std::find(right.begin(), right.end(), &f) == right.end()) add_extra(j, c, f);
  const bool first_is_right = std::find(right.begin(), right.end(), &d.findings.front()) != right.end();

  // Truly not to be told apart: what was named instead predicts as well.
  j.alike = std::isnan(j.removed_truly) ? j.removed >= 0.9
                                        : j.removed_truly >= 0.9 || j.remaining_rms < c.resolution;
  const bool below_resolution =
      d.findings.size() == 1 && j.removed_truly >= 0.9 && j.remaining_rms < c.resolution;
  if (planted.size() > 1) {
    if (!j.extra.empty())
      j.outcome = Outcome::wrong_name;
    else if (named == planted.size())
      j.outcome = Outcome::named;
    else if (named + rivals == planted.size())
      j.outcome = Outcome::not_separated;
    else
      j.outcome = Outcome::half_named;
  } else if (named == 1 && first_is_right && j.extra.empty()) {
    j.outcome = Outcome::named;
  } else if ((rivals == 1 && first_is_right && j.extra.empty()) ||
             (d.verdict == diagnose::Verdict::not_identifiable && named + rivals > 0)) {
    j.outcome = Outcome::not_separated;
  } else if (planted[0].law == "stribeck_friction" && j.first == "coulomb_friction" && below_resolution) {
    j.outcome = Outcome::simpler_law;
    j.extra.clear();
  } else {
    j.outcome = Outcome::wrong_name;
  }
  // A confidence is in the name, not in a group that holds the right one.
  const bool first_is_named =
      std::find(right_by_name.begin(), right_by_name.end(), &d.findings.front()) != right_by_name.end();
  j.first_right = first_is_named || j.outcome == Outcome::simpler_law;
}

}  // namespace

double ParameterError::relative() const { return std::abs(found - expected) / std::abs(expected); }

double ParameterError::relative_of_difference() const {
  return std::abs(found - expected) / std::abs(expected - neutral);
}

diagnose::Diagnosis diagnosed(const Case& c, unsigned threads, const diagnose::WithoutRules& without) {
  diagnose::Options options;
  options.without = without;
  options.threads = threads;
  return diagnose::diagnose(c.model, c.training, c.held_out, options);
}

Judgement judge(const Case& c, const diagnose::Diagnosis& d) {
  Judgement j;
  const auto nmse = [&](const diagnose::Errors& errors) {
    const auto channel = errors.find(d.main_channel);
    return channel == errors.end() ? std::nan("") : channel->second.nmse;
  };
  constexpr double kClearlyAboveFloor = 10.0;
  j.removed_is_told = nmse(d.refitted) > kClearlyAboveFloor * nmse(d.noise_floor);
  j.removed = (nmse(d.refitted) - nmse(d.extended)) / (nmse(d.refitted) - nmse(d.noise_floor));
  judge_predictions(j, c, d);
  j.verdict = d.verdict;
  j.acted = d.rules_that_acted;
  j.said = line(d, j.removed) + format(", truly %.3f", j.removed_truly) +
           format(", true rms left %.2g", j.remaining_rms) + format(" (resolution %.2g)", c.resolution);
  if (!d.findings.empty()) {
    j.first = std::string(effect_name(d.findings.front().effect));
    j.confidence = d.findings.front().confidence;
  }
  judge_names(j, c, d);
  return j;
}

bool shows(const Case& c) {
  constexpr double kCounts = 2.0;
  const double of_disturbance = c.size == Size::small ? 0.5 : 2.0;
  if (is_kind(c.kind, "clutch_bench") || c.model.clutch || !moves_the_body(c.truth.planted, c.kind))
    return true;
  Truth undisturbed = c.truth;
  undisturbed.disturbance = {};
  const TrueError at_random = true_error(undisturbed, c.held_out_truth);
  return std::all_of(c.truth.planted.begin(), c.truth.planted.end(), [&](const Planted& p) {
    Truth without = undisturbed;
    std::erase_if(without.planted, [&](const Planted& other) { return other.law == p.law; });
    const TrueError all = true_error(without, c.held_out_truth);
    const double of_cause = all.squares - at_random.squares;
    return of_cause >= of_disturbance * of_disturbance * at_random.squares &&
           of_cause >= std::pow(kCounts * c.resolution, 2) * static_cast<double>(all.samples);
  });
}

bool removes_enough(const Judgement& j) {
  return !(j.removed_truly < 0.9) && (j.removed >= 0.9 || !j.removed_is_told);
}

std::string_view name(Outcome outcome) {
  switch (outcome) {
    case Outcome::named:
      return "named";
    case Outcome::not_separated:
      return "not separated";
    case Outcome::simpler_law:
      return "simpler law";
    case Outcome::half_named:
      return "half named";
    case Outcome::nothing_named:
      return "nothing named";
    case Outcome::honest:
      return "honest";
    case Outcome::wrong_name:
      return "wrong name";
  }
  return "";
}

}  // namespace furcula::hidden
