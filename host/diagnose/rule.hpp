// The search's rules that can be left out, one by one, to see what each is worth (docs/blind_suite.md, ablation).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <string_view>

namespace furcula::diagnose {

enum class Rule {
  always_fitted,    ///< causes that one linear step judges badly are fitted whatever they promise
  swap_members,     ///< a new cause in the place of an old one that was a stand-in for it
  prune,            ///< members that others have made needless are taken out
  one_for_several,  ///< one cause in the place of several
  beam,             ///< pairs that begin with others than the best single cause
  least_agreed,  ///< a member of which there may be none, of little help to recordings that its fit has not seen, or that
                 ///< they do not agree on, is taken out
  heaviest,  ///< of the sets that were fitted the most likely one, where it is ten times as likely as the chosen one
  larger,  ///< of larger sets the most likely one, by the likelihood under disturbances, where it is ten times as likely
  rivals,            ///< sets with another cause in the place of a member, where they are better
  falling_friction,  ///< a Stribeck curve in the place of dry friction, whose sizes alone the windows do not tell apart
  friction_that_pushes,  ///< friction of two sizes, one below zero, as friction and a constant force
  early_rows,            ///< a drive's lag beside rows that are early by a whole one
  likelihood,            ///< the search by the likelihood under what disturbs the machine
  withdrawal,     ///< nothing is named where the re-fitted model leaves noise alone and help is not sure
  odd_recording,  ///< one recording that disagrees with the others is left out
};

inline constexpr std::array<std::string_view, 15> kRuleNames = {
    "always_fitted",        "swap_members", "prune",      "one_for_several", "beam",
    "least_agreed",         "heaviest",     "larger",     "rivals",          "falling_friction",
    "friction_that_pushes", "early_rows",   "likelihood", "withdrawal",      "odd_recording"};

inline constexpr std::string_view name_of(Rule r) { return kRuleNames[static_cast<std::size_t>(r)]; }

inline constexpr std::optional<Rule> rule_named(std::string_view name) {
  for (std::size_t i = 0; i < kRuleNames.size(); ++i)
    if (kRuleNames[i] == name) return static_cast<Rule>(i);
  return std::nullopt;
}

using Rules = std::set<Rule>;
/// Those that are left out: none, but where it is asked what they are worth.
using WithoutRules = Rules;

}  // namespace furcula::diagnose
