// See tally.hpp.
#include "tests/hidden/tally.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <set>

namespace furcula::hidden {

namespace {

std::string printed(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
std::string printed(const char* pattern, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

// What part 6 of the suite's purpose asks for: the right cause, nothing where nothing is, honesty.
double goal(Tier tier) {
  switch (tier) {
    case Tier::large:
    case Tier::medium:
      return 0.95;
    case Tier::small:
      return 0.70;
    case Tier::pairs:
      return 0.85;
    case Tier::clean:
      return 0.95;
    case Tier::outside:
      return 0.90;
  }
  return 1.0;
}

constexpr diagnose::Verdict kVerdicts[] = {
    diagnose::Verdict::adequate, diagnose::Verdict::explained, diagnose::Verdict::partly_explained,
    diagnose::Verdict::unexplained, diagnose::Verdict::not_identifiable};

// A column where nothing stands first.
std::string unnamed(const Judgement& j) { return "(" + std::string(name(j.verdict)) + ")"; }

std::string planted_label(const Answer& a) {
  std::string label;
  for (const std::string& law : a.question.laws) label += (label.empty() ? "" : " + ") + law;
  return label.empty() ? "(nothing)" : label;
}

std::string said_label(const Answer& a) {
  if (!a.refused.empty()) return "(refused)";
  return a.judgement.first.empty() ? unnamed(a.judgement) : a.judgement.first;
}

// As in the matrix: what is right by other words or as a true group stands on the diagonal, and a name that
// was not said with confidence of a cause outside of the catalogue under the verdict.
std::string matrix_label(const Answer& a) {
  if (a.refused.empty() && !a.question.laws.empty() && a.judgement.right()) return a.question.laws.front();
  if (a.refused.empty() && a.judgement.outcome == Outcome::honest) return unnamed(a.judgement);
  return said_label(a);
}

// Laws in the order of the contract, then what stands in brackets.
std::vector<std::string> ordered(const std::set<std::string>& labels) {
  std::vector<std::string> out;
  for (const LawInfo& law : laws())
    if (labels.contains(std::string(law.name))) out.emplace_back(law.name);
  for (const std::string& label : labels)
    if (label.starts_with("(")) out.push_back(label);
  return out;
}

std::string percent(const Share& s) {
  return s.of == 0 ? "-" : printed("%.0f %% (%zu/%zu)", 100 * s.value(), s.are, s.of);
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(q * static_cast<double>(values.size() - 1)))];
}

bool as_it_should_be(const Answer& a) {
  const Judgement& j = a.judgement;
  if (!a.refused.empty()) return false;
  switch (a.tier) {
    case Tier::clean:
      return j.outcome == Outcome::nothing_named && j.verdict == diagnose::Verdict::adequate;
    case Tier::outside:
      return j.outcome == Outcome::honest;
    case Tier::small:
      return j.outcome != Outcome::wrong_name && j.extra.empty();
    default:
      return j.right() && j.extra.empty();
  }
}

bool Tally::goals_met() const {
  return std::all_of(tiers.begin(), tiers.end(),
                     [](const TierTally& t) { return t.right.value() >= t.goal; });
}

Tally tally(const std::vector<Answer>& answers) {
  Tally out;
  out.reliability = {{0.0, 0.5, {}, 0},  {0.5, 0.7, {}, 0},   {0.7, 0.8, {}, 0},  {0.8, 0.9, {}, 0},
                     {0.9, 0.95, {}, 0}, {0.95, 0.99, {}, 0}, {0.99, 1.01, {}, 0}};
  for (Tier tier : kTiers) {
    TierTally t;
    t.tier = tier;
    t.goal = goal(tier);
    for (const Answer& a : answers) {
      if (a.tier != tier) continue;
      const Judgement& j = a.judgement;
      ++t.cases;
      t.seconds.push_back(a.seconds);
      t.refused += !a.refused.empty();
      if (a.refused.empty()) {
        t.named += j.outcome == Outcome::named;
        t.not_separated += j.outcome == Outcome::not_separated;
        t.alike += j.outcome == Outcome::not_separated && j.alike;
        t.simpler += j.outcome == Outcome::simpler_law;
        t.half += j.outcome == Outcome::half_named;
        t.nothing += j.outcome == Outcome::nothing_named;
        t.honest += j.outcome == Outcome::honest;
        t.wrong += j.outcome == Outcome::wrong_name;
        t.wrong_but_undecided +=
            j.outcome == Outcome::wrong_name && j.verdict == diagnose::Verdict::not_identifiable;
        t.extra += !j.extra.empty() && j.outcome != Outcome::wrong_name && tier != Tier::outside;
      }
      // A false alarm is a finding; a clean recording that is called unexplained is one as well.
      t.right.count(tier == Tier::clean || tier == Tier::outside ? as_it_should_be(a)
                                                                 : a.refused.empty() && j.right());
      for (const ParameterError& p : j.parameters) {
        t.covered.count(p.within_interval());
        if (!p.main) continue;
        t.errors.push_back(p.relative_of_difference());
        t.within_tenth.count(p.relative() <= 0.10);
        t.difference_in_tenth.count(p.relative_of_difference() <= 0.10);
      }
      if (j.outcome == Outcome::named) {
        t.removes_enough.count(removes_enough(j));
        t.removed.push_back(std::isnan(j.removed_truly) ? j.removed : j.removed_truly);
      }
      if (!j.first.empty())
        for (Reliability& bin : out.reliability)
          if (j.confidence >= bin.from && j.confidence < bin.to) {
            bin.right.count(j.first_right);
            bin.confidence_sum += j.confidence;
          }
    }
    if (t.cases > 0) out.tiers.push_back(t);
  }
  return out;
}

Confusion confusion(const std::vector<Answer>& answers, const std::vector<Tier>& tiers) {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  std::set<std::string> planted, said;
  for (const Answer& a : answers) {
    if (std::find(tiers.begin(), tiers.end(), a.tier) == tiers.end() || a.question.laws.size() > 1) continue;
    ++counts[{planted_label(a), matrix_label(a)}];
    planted.insert(planted_label(a));
    said.insert(matrix_label(a));
  }
  Confusion out;
  out.planted = ordered(planted);
  // The diagonal is there even where nobody said it.
  for (const std::string& p : planted)
    if (const LawInfo* law = law_named(p); law && law->acts != Acts::outside_catalogue) said.insert(p);
  out.said = ordered(said);
  for (const std::string& p : out.planted) {
    out.counts.emplace_back();
    for (const std::string& s : out.said) {
      const auto count = counts.find({p, s});
      out.counts.back().push_back(count == counts.end() ? 0 : count->second);
    }
  }
  return out;
}

std::string case_line(const Answer& a) {
  std::string line = as_it_should_be(a) ? "ok   " : "FAIL ";
  line += std::string(name(a.tier)) + " " + a.description + "\n     ";
  if (!a.refused.empty()) return line + "refused: " + a.refused;
  return line + std::string(name(a.judgement.outcome)) + printed(", %.1f s: ", a.seconds) + a.judgement.said;
}

std::string text_of(const Tally& t, const std::vector<Answer>& answers) {
  std::string out = printed("%-8s %5s %-14s %5s %5s %8s %7s %5s %7s %6s %5s %5s %7s\n", "tier", "cases",
                            "right (goal)", "named", "group", "of these", "simpler", "half", "nothing",
                            "honest", "wrong", "extra", "refused");
  for (const TierTally& r : t.tiers)
    out += printed("%-8s %5zu %5.1f %% (%2.0f)%s %5zu %5zu %8zu %7zu %5zu %7zu %6zu %5zu %5zu %7zu\n",
                   std::string(name(r.tier)).c_str(), r.cases, 100 * r.right.value(), 100 * r.goal,
                   r.right.value() >= r.goal ? "   " : " !!", r.named, r.not_separated, r.alike, r.simpler,
                   r.half, r.nothing, r.honest, r.wrong, r.extra, r.refused);
  out +=
      "right: the planted cause first, or in a group whose first one truly predicts as well (of these); pairs: both "
      "and\nnothing else; clean: no finding and adequate; outside: unexplained, partly explained, or names of 0.5 at most.\n";
  const auto hardly =
      std::count_if(answers.begin(), answers.end(), [](const Answer& a) { return a.hardly_shows; });
  if (hardly > 0)
    out += printed("%zd causes hardly show on any machine that was drawn for them: asked all the same.\n",
                   hardly);
  for (const TierTally& r : t.tiers)
    if (r.wrong_but_undecided > 0)
      out += printed("%s: %zu of the wrong names under the verdict not_identifiable.\n",
                     std::string(name(r.tier)).c_str(), r.wrong_but_undecided);

  out += printed("\n%-8s %-17s %-17s %6s %6s %-17s %-17s %7s %7s\n", "tier", "within 10 %", "10 % of change",
                 "err50", "err90", "in 95 % interval", "removes 90 %", "s med", "s max");
  for (const TierTally& r : t.tiers)
    out +=
        printed("%-8s %-17s %-17s %6.1f %6.1f %-17s %-17s %7.1f %7.1f\n", std::string(name(r.tier)).c_str(),
                percent(r.within_tenth).c_str(), percent(r.difference_in_tenth).c_str(),
                100 * quantile(r.errors, 0.5), 100 * quantile(r.errors, 0.9), percent(r.covered).c_str(),
                percent(r.removes_enough).c_str(), quantile(r.seconds, 0.5), quantile(r.seconds, 1.0));
  out += "err: of the main parameters, in % of their difference from a machine without the effect.\n";

  out += printed("\n%-8s", "tier");
  for (const auto verdict : kVerdicts) out += printed(" %16s", std::string(furcula::name(verdict)).c_str());
  out += "\n";
  for (const TierTally& r : t.tiers) {
    out += printed("%-8s", std::string(name(r.tier)).c_str());
    for (const auto verdict : kVerdicts)
      out += printed(" %16zd", std::count_if(answers.begin(), answers.end(), [&](const Answer& a) {
                       return a.tier == r.tier && a.refused.empty() && a.judgement.verdict == verdict;
                     }));
    out += "\n";
  }

  out += printed("\n%-14s %6s %6s %6s\n", "confidence", "first", "mean", "right");
  for (const Reliability& bin : t.reliability)
    if (bin.right.of > 0)
      out += printed("%.2f to %.2f   %6zu %6.2f %6.2f\n", bin.from, std::min(1.0, bin.to), bin.right.of,
                     bin.mean(), bin.right.value());

  for (const auto& [title, tiers] :
       {std::pair<const char*, std::vector<Tier>>{"large and medium", {Tier::large, Tier::medium}},
        {"small", {Tier::small}},
        {"clean and outside of the catalogue", {Tier::clean, Tier::outside}}}) {
    const Confusion c = confusion(answers, tiers);
    if (c.planted.empty()) continue;
    out += printed("\nconfusion, %s: planted (rows) and what stands first (columns)\n%28s", title, "");
    for (std::size_t i = 0; i < c.said.size(); ++i) out += printed(" %2zu", i + 1);
    out += "\n";
    for (std::size_t row = 0; row < c.planted.size(); ++row) {
      const auto self = std::find(c.said.begin(), c.said.end(), c.planted[row]);
      out += printed("%-24s %2s ", c.planted[row].c_str(),
                     self == c.said.end() ? "" : std::to_string(self - c.said.begin() + 1).c_str());
      for (std::size_t n : c.counts[row]) out += n == 0 ? "  ." : printed(" %2zu", n);
      out += "\n";
    }
    for (std::size_t i = 0; i < c.said.size(); ++i)
      if (std::find(c.planted.begin(), c.planted.end(), c.said[i]) == c.planted.end() ||
          c.said[i].starts_with("("))
        out += printed("%28zu %s\n", i + 1, c.said[i].c_str());
  }

  bool any = false;
  for (const Answer& a : answers) {
    if (a.tier != Tier::pairs || as_it_should_be(a)) continue;
    if (!any) out += "\npairs that were not found\n";
    any = true;
    out +=
        "  " + planted_label(a) + ": " + std::string(name(a.judgement.outcome)) + ", first " + said_label(a);
    for (const std::string& e : a.judgement.extra) out += ", extra " + e;
    out += printed(" (seed %llu)\n", static_cast<unsigned long long>(a.question.seed));
  }
  return out;
}

std::string csv_of(const std::vector<Answer>& answers) {
  std::string out =
      "seed,tier,kind,planted,nominal,outcome,right,verdict,first,first_right,confidence,extra,removed,"
      "removed_truly,remaining_rms,seconds,rules_that_acted\n";
  for (const Answer& a : answers) {
    const Judgement& j = a.judgement;
    std::string extra;
    for (const std::string& e : j.extra) extra += (extra.empty() ? "" : " + ") + e;
    std::string rules;
    for (diagnose::Rule r : j.acted) rules += (rules.empty() ? "" : " ") + std::string(diagnose::name_of(r));
    out += printed("%llu,%s,%s,%s,%s,%s,%d,%s,%s,%d,%.3f,%s,%.4f,%.4f,%.3g,%.2f,%s\n",
                   static_cast<unsigned long long>(a.question.seed), std::string(name(a.tier)).c_str(),
                   std::string(dynamics::info(a.question.kind).name).c_str(), planted_label(a).c_str(),
                   std::string(name(a.question.nominal)).c_str(),
                   a.refused.empty() ? std::string(name(j.outcome)).c_str() : "refused", j.right(),
                   std::string(name(j.verdict)).c_str(), j.first.c_str(), j.first_right, j.confidence,
                   extra.c_str(), j.removed, j.removed_truly, j.remaining_rms, a.seconds, rules.c_str());
  }
  return out;
}

}  // namespace furcula::hidden
