#include "tests/hidden/trees/questions.hpp"

#include <algorithm>
#include <iterator>

namespace furcula::hidden::trees {
namespace {

// How many of 21 cases a tier gets when all are asked.
double weight(Tier tier) {
  switch (tier) {
    case Tier::medium:
    case Tier::large:
      return 4;
    case Tier::clean:
    case Tier::small:
    case Tier::pairs:
      return 3;
    case Tier::outside:
      return 2;
    case Tier::tied:
    case Tier::triple:
      break;
  }
  return 1;
}

std::vector<std::string> shuffled(std::vector<std::string> list, Random& random) {
  for (std::size_t i = list.size(); i-- > 1;)
    std::swap(list[i], list[static_cast<std::size_t>(random.uniform(0, static_cast<double>(i + 1)))]);
  return list;
}

// Laws that joints of one make share.
const std::vector<std::string>& tied_effects() {
  static const std::vector<std::string> kEffects = {"coulomb_friction", "damping_error", "load_friction",
                                                    "actuator_delay",   "actuator_lag",  "torque_gain_error",
                                                    "quadratic_drag"};
  return kEffects;
}

// Whether one robot can have both, told apart: not of one family, and not under different laws of the drive.
bool go_together(const std::string& a, const std::string& b) {
  const auto needs_torque = [](const std::string& e) {
    return e == "joint_elasticity" || e == "torque_gain_error";
  };
  if (a == "position_gain_error" && needs_torque(b)) return false;
  if (b == "position_gain_error" && needs_torque(a)) return false;
  // The thigh of a leg turns as its hip's rotor does.
  const auto turns = [](const std::string& e) { return e == "rotor_inertia_error" || e == "inertia_error"; };
  if (turns(a) && turns(b)) return false;
  return family(a) != family(b);
}

}  // namespace

std::vector<Question> draw_questions(std::uint64_t seed, std::size_t cases, std::vector<Tier> tiers,
                                     const std::string& effect, std::size_t joints, bool brief, bool leg) {
  Random random(seed);
  const std::vector<std::string>& all = leg ? leg_catalogue() : catalogue();
  const std::vector<std::string>& unknown = leg ? leg_outside_causes() : outside_causes();
  const auto is_outside = [&](const std::string& e) {
    return std::find(unknown.begin(), unknown.end(), e) != unknown.end();
  };
  if (tiers.empty()) {
    if (effect.empty() && leg)
      tiers = {Tier::clean, Tier::small, Tier::medium, Tier::large, Tier::pairs, Tier::outside};
    else if (effect.empty())
      tiers.assign(std::begin(kTiers), std::end(kTiers));
    else if (is_outside(effect))
      tiers = {Tier::outside};
    else
      tiers = {Tier::small, Tier::medium, Tier::large};
  }
  std::vector<std::vector<std::string>> lists;
  for (Tier t : tiers) {
    std::vector<std::string> list = t == Tier::tied ? tied_effects() : t == Tier::outside ? unknown : all;
    if (!effect.empty()) list = {effect};
    lists.push_back(shuffled(list, random));
  }
  double weights = 0.0;
  for (Tier t : tiers) weights += weight(t);
  std::vector<double> due(tiers.size(), 0.0);
  std::vector<std::size_t> asked(tiers.size(), 0);
  std::vector<Question> out;
  while (out.size() < cases) {
    for (std::size_t i = 0; i < tiers.size(); ++i) due[i] += weight(tiers[i]) / weights;
    const auto next = static_cast<std::size_t>(std::max_element(due.begin(), due.end()) - due.begin());
    due[next] -= 1.0;
    Question q;
    q.tier = tiers[next];
    q.seed = static_cast<std::uint64_t>(random.unit() * 1e9);
    q.joints = joints;
    q.brief = brief;
    q.leg = leg;
    const std::size_t count = q.tier == Tier::clean    ? 0
                              : q.tier == Tier::pairs  ? 2
                              : q.tier == Tier::triple ? 3
                                                       : 1;
    if (count > 0) q.effects = {lists[next][asked[next]++ % lists[next].size()]};
    while (q.effects.size() < count) {
      const auto& more = all[static_cast<std::size_t>(random.uniform(0, static_cast<double>(all.size())))];
      if (std::all_of(q.effects.begin(), q.effects.end(),
                      [&](const std::string& e) { return go_together(e, more); }))
        q.effects.push_back(more);
    }
    out.push_back(q);
  }
  return out;
}

}  // namespace furcula::hidden::trees
