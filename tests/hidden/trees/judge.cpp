#include "tests/hidden/trees/judge.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <stdexcept>

namespace furcula::hidden::trees {
namespace {

using Labels = std::multiset<std::string>;

Labels labels_of(const std::vector<Cause>& causes) {
  Labels out;
  for (const Cause& c : causes) out.insert(label(c.effect, c.at));
  return out;
}

// One effect found at several joints apart is taken as one at all of them.
std::vector<Cause> joined(const std::vector<Cause>& causes) {
  std::vector<Cause> out;
  for (const Cause& c : causes) {
    const auto same =
        std::find_if(out.begin(), out.end(), [&](const Cause& o) { return o.effect == c.effect; });
    if (same == out.end())
      out.push_back(c);
    else
      same->at.insert(same->at.end(), c.at.begin(), c.at.end());
  }
  return out;
}

// Error of restarts, each joint against what it moves there, rms over the joints.
double error_of(const Restarts& restarts, const Machine& machine, const Values& scale) {
  const Values e = rms_difference(restarts.of(machine), restarts.happened);
  double sum = 0.0;
  for (std::size_t j = 0; j < restarts.c.visible(); ++j) sum += e[j] * e[j] / (scale[j] * scale[j]);
  const double rms = std::sqrt(sum / static_cast<double>(restarts.c.visible()));
  return std::isfinite(rms) ? rms : 1e9;
}

// How much of the error that the planted causes remove these remove. 0 where this machine does not know them.
double removed_by(const Case& c, const std::vector<Cause>& causes) {
  const Restarts restarts(c);
  std::vector<std::vector<Values>> still = restarts.happened;
  for (auto& window : still) std::fill(window.begin(), window.end(), Values(window.front()));
  Values scale = rms_difference(still, restarts.happened);
  for (double& x : scale) x = std::max(x, 1e-4);
  const double without = error_of(restarts, c.with({}), scale);
  const double planted = error_of(restarts, restarts.truth, scale);
  if (without <= planted) return 0.0;
  try {
    return (without - error_of(restarts, c.with(causes), scale)) / (without - planted);
  } catch (const std::exception&) {
    return 0.0;
  }
}

// What is physically one thing, so that no recording tells it apart: one set of laws for another.
bool same_physics(const std::vector<Cause>& planted, const std::vector<Cause>& found) {
  std::vector<Cause> p, f;
  const Labels of_planted = labels_of(planted), of_found = labels_of(found);
  for (const Cause& c : planted)
    if (!of_found.contains(label(c.effect, c.at))) p.push_back(c);
  for (const Cause& c : found)
    if (!of_planted.contains(label(c.effect, c.at))) f.push_back(c);
  const auto are = [](const std::vector<Cause>& a, const std::set<std::string>& effects) {
    std::set<std::string> have;
    for (const Cause& c : a) have.insert(c.effect);
    return have == effects && a.size() == effects.size() &&
           std::all_of(a.begin(), a.end(), [&](const Cause& c) { return c.at == a.front().at; });
  };
  // A position drive's own damping and the joint's are one: nothing tells kd + d from either.
  const auto less_damping = [](const std::vector<Cause>& all) {
    std::vector<Cause> out;
    for (const Cause& c : all)
      if (c.effect != "damping_error" || std::none_of(all.begin(), all.end(), [&](const Cause& o) {
            return o.effect == "position_gain_error" && o.at == c.at;
          }))
        out.push_back(c);
    return out;
  };
  if (labels_of(less_damping(planted)) == labels_of(less_damping(found))) return true;
  if (p.empty() || f.empty()) return false;
  const auto either = [&](const std::set<std::string>& a, const std::set<std::string>& b) {
    return (are(p, a) && are(f, b)) || (are(p, b) && are(f, a));
  };
  // A pendulum that hangs on a tilted base, or whose first angle is read from another zero.
  if (either({"base_tilt"}, {"encoder_offset"})) return true;
  // Of a leg's boom, which only slides, and its thigh, whose torso never turns: one mass, one inertia.
  const auto at = [](const std::vector<Cause>& causes, const char* site) {
    return causes.front().at == std::vector<std::string>{site};
  };
  const auto one_location_type = [&](const std::set<std::string>& a, const char* at_a,
                                     const std::set<std::string>& b, const char* at_b) {
    return (are(p, a) && at(p, at_a) && are(f, b) && at(f, at_b)) ||
           (are(p, b) && at(p, at_b) && are(f, a) && at(f, at_a));
  };
  if (one_location_type({"rotor_inertia_error"}, "boom_travel", {"mass_error"}, "boom") ||
      one_location_type({"rotor_inertia_error"}, "boom_travel", {"payload"}, "boom") ||
      one_location_type({"rotor_inertia_error"}, "hip", {"inertia_error"}, "thigh"))
    return true;
  if (p.front().at != f.front().at) return false;
  return either({"asymmetric_friction"}, {"coulomb_friction", "force_offset"}) ||
         either({"mass_error"}, {"payload"}) || either({"latch_delay"}, {"latch_offset"});
}

void cover(const Cause& planted, const Finding& f, Judgement& out) {
  for (const auto& [key, value] : planted.parameters) {
    const auto interval = f.ci95.find(key);
    if (interval == f.ci95.end()) continue;
    ++out.parameters;
    const auto [low, high] = interval->second;
    bool holds = low <= value && value <= high;
    if (key == "phase_rad")
      for (int turns = -2; turns <= 2; ++turns) {
        const double turned = value + 2 * std::numbers::pi * turns;
        holds = holds || (low <= turned && turned <= high);
      }
    out.covered += holds;
  }
}

}  // namespace

std::string label(const std::string& effect, std::vector<std::string> at) {
  std::sort(at.begin(), at.end());
  std::string out = effect;
  for (std::size_t i = 0; i < at.size(); ++i) out += (i == 0 ? "@" : ",") + at[i];
  return out;
}

std::string label(const std::vector<Cause>& causes) {
  std::string out;
  for (const Cause& c : causes) out += (out.empty() ? "" : " + ") + label(c.effect, c.at);
  return out.empty() ? "-" : out;
}

Diagnosis read_diagnosis(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": not there");
  try {
    const auto json = nlohmann::json::parse(file);
    Diagnosis out;
    out.verdict = json.at("verdict").get<std::string>();
    for (const auto& f : json.at("findings")) {
      Finding finding;
      finding.cause.effect = f.at("effect").get<std::string>();
      finding.cause.at = f.at("locations").get<std::vector<std::string>>();
      std::sort(finding.cause.at.begin(), finding.cause.at.end());
      finding.confidence = f.at("confidence").get<double>();
      for (const auto& [key, value] : f.at("parameters").items()) {
        if (value.at("value").is_number()) finding.cause.parameters[key] = value.at("value").get<double>();
        if (!value.contains("ci95")) continue;
        const auto& pair = value.at("ci95");
        if (pair.is_array() && pair.size() == 2 && pair[0].is_number() && pair[1].is_number())
          finding.ci95[key] = {pair[0].get<double>(), pair[1].get<double>()};
      }
      for (const auto& rival : f.at("indistinguishable_from")) {
        auto& set = finding.alike.emplace_back();
        for (const auto& cause : rival.at("causes"))
          set.push_back(label(cause.at("effect").get<std::string>(),
                              cause.at("locations").get<std::vector<std::string>>()));
      }
      out.findings.push_back(finding);
    }
    return out;
  } catch (const nlohmann::json::exception& e) {
    throw std::runtime_error(path + ": " + e.what());
  }
}

Judgement judge(const Case& c, const Diagnosis& d) {
  Judgement out;
  std::vector<Cause> found;
  for (const Finding& f : d.findings) found.push_back(f.cause);
  const Tier tier = c.question.tier;
  if (tier == Tier::clean) {
    out.right = d.verdict == "adequate" && found.empty();
    out.how = found.empty() ? "nothing" : "wrong";
    return out;
  }
  if (tier == Tier::outside) {
    const bool unsure = !found.empty() && std::all_of(d.findings.begin(), d.findings.end(),
                                                      [](const Finding& f) { return f.confidence <= 0.5; });
    out.right = d.verdict == "unexplained" || d.verdict == "partly_explained" || unsure;
    out.how = out.right ? "honest" : found.empty() ? "nothing" : "wrong";
    return out;
  }

  const Labels planted = labels_of(c.planted);
  const Labels said = labels_of(found);
  for (const Cause& p : c.planted)
    for (const Finding& f : d.findings)
      if (label(p.effect, p.at) == label(f.cause.effect, f.cause.at)) cover(p, f, out);
  if (found.empty()) {
    out.how = "nothing";
    return out;
  }
  out.removed = removed_by(c, found);
  if (said == planted) {
    out.right = true;
    out.how = "named";
    return out;
  }
  if (tier == Tier::tied && labels_of(joined(found)) == planted) {
    out.right = true;
    out.how = "split";
    return out;
  }
  const bool confirmed = out.removed >= 0.9;
  if (confirmed && same_physics(c.planted, found)) {
    out.right = true;
    out.how = "other words";
    return out;
  }
  // One of the findings, or several, replaced by a set that each cannot be told from.
  std::vector<Labels> wordings = {{}};
  for (const Finding& f : d.findings) {
    std::vector<Labels> words = {{label(f.cause.effect, f.cause.at)}};
    for (const auto& set : f.alike) words.emplace_back(set.begin(), set.end());
    std::vector<Labels> longer;
    for (const Labels& w : wordings)
      for (const Labels& more : words) {
        if (longer.size() > 5000) break;
        longer.push_back(w);
        longer.back().insert(more.begin(), more.end());
      }
    wordings = longer;
  }
  const bool listed = std::find(wordings.begin(), wordings.end(), planted) != wordings.end();
  if (listed && confirmed) {
    out.right = true;
    out.how = "alike";
    return out;
  }
  std::size_t hits = 0;
  for (const std::string& p : planted) hits += said.count(p) > 0;
  out.how = hits == planted.size() ? "extra" : hits > 0 ? "half" : "wrong";
  return out;
}

}  // namespace furcula::hidden::trees
