// Compares a diagnosis.json with what was planted.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/hidden/trees/cases.hpp"

namespace furcula::hidden::trees {

struct Finding {
  Cause cause;
  std::map<std::string, std::pair<double, double>> ci95;
  double confidence = 0.0;
  std::vector<std::vector<std::string>> alike;  ///< sets of "effect@site,site"
};

struct Diagnosis {
  std::string verdict;
  std::vector<Finding> findings;
};

struct Judgement {
  bool right = false;
  /// "named": law and place; "alike": in a group that cannot be told apart; "other words": a physical
  /// equivalent; "split": one tied law named joint by joint; "extra": the planted ones and others; "half": some
  /// of the planted ones; "nothing": no finding; "wrong"; clean: "nothing" is right; outside: "honest".
  std::string how;
  double removed = 0.0;  ///< share of the planted causes' restart error that the findings remove
  std::size_t covered = 0, parameters = 0;  ///< of law and place named right: 95 % intervals that hold
};

/// "effect@site,site" with the sites in alphabetical order.
std::string label(const std::string& effect, std::vector<std::string> at);
std::string label(const std::vector<Cause>& causes);

/// Reads DIR/diagnosis.json. Throws std::runtime_error where it is not as the contract says.
Diagnosis read_diagnosis(const std::string& path);

Judgement judge(const Case& c, const Diagnosis& d);

}  // namespace furcula::hidden::trees
