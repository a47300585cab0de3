// What the suite's answers come to: rates per tier, the confusion matrix, coverage, reliability.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/hidden/cases.hpp"
#include "tests/hidden/judge.hpp"

namespace furcula::hidden {

struct Answer {
  Tier tier = Tier::medium;
  Question question;
  std::string description;
  Judgement judgement;
  std::string refused;  ///< what the diagnosis threw; empty: it answered
  double seconds = 0.0;
  bool hardly_shows =
      false;  ///< on none of the machines drawn the cause shows beside the disturbance; asked all the same
};

struct Share {
  std::size_t of = 0, are = 0;
  void count(bool is) {
    ++of;
    are += is;
  }
  double value() const { return of == 0 ? 0.0 : static_cast<double>(are) / static_cast<double>(of); }
};

struct TierTally {
  Tier tier;
  std::size_t cases = 0, named = 0, not_separated = 0, alike = 0, simpler = 0, half = 0, nothing = 0,
              honest = 0, wrong = 0, wrong_but_undecided = 0, refused = 0, extra = 0;
  Share right;         ///< effects and pairs: the right cause first; clean: nothing found; outside: honest
  Share within_tenth;  ///< main parameters, of the value
  Share difference_in_tenth;  ///< main parameters, of the difference from nothing
  Share covered;              ///< 95 % intervals that hold the truth, all parameters
  Share removes_enough;       ///< of the named ones
  std::vector<double> errors, removed, seconds;
  double goal = 0.0;  ///< of `right`
};

/// One bin of the reliability curve, of all findings that stand first.
struct Reliability {
  double from, to;
  Share right;
  double confidence_sum = 0.0;
  double mean() const { return confidence_sum / static_cast<double>(right.of); }
};

struct Confusion {
  std::vector<std::string> planted, said;        ///< labels of rows and columns
  std::vector<std::vector<std::size_t>> counts;  ///< [planted][said]
};

struct Tally {
  std::vector<TierTally> tiers;  ///< in the order of Tier, those that were asked
  std::vector<Reliability> reliability;
  bool goals_met() const;
};

Tally tally(const std::vector<Answer>& answers);

/// Rows: single laws of these tiers, those outside, "(nothing)"; columns: what stands first, or the verdict
/// where nothing does.
Confusion confusion(const std::vector<Answer>& answers, const std::vector<Tier>& tiers);

/// One line of a case: what it was and what was said.
std::string case_line(const Answer& a);
bool as_it_should_be(const Answer& a);

double quantile(std::vector<double> values, double q);

/// All tables for a terminal.
std::string text_of(const Tally& t, const std::vector<Answer>& answers);
/// The same as a page without references; `head` is a line of what was run.
std::string page_of(const Tally& t, const std::vector<Answer>& answers, const std::string& head);
/// One row a case, RFC 4180.
std::string csv_of(const std::vector<Answer>& answers);

}  // namespace furcula::hidden
