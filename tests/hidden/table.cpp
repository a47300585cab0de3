// furcula_hidden_table [--seed N] [--cases N] [--tier NAME]... [--threads N] [--kind NAME] [--effect NAME]
//                      [--out DIR] [--write DIR] [--size NAME] [--commit NAME] [--without RULE]... [--ablate N]
// The blind suite: draws cases from fresh seeds, lets the diagnosis find what they hide and prints how often
// it did (docs/blind_suite.md). Cases run side by side, each diagnosis on one thread; the tables do not
// depend on it.
// --out writes confusion.html and cases.csv to DIR. --write writes each case's recordings and model to
// DIR/<tier>-<seed>/. --without leaves a rule of the search out (host/diagnose/rule.hpp).
// --ablate asks again, without each rule, up to N of the cases in which it changed the chosen set. --size asks the questions of test_hidden.cpp instead: cases from `seed` on of one kind
// and effect. Exit status: 0 if every tier reaches its goal, 4 if one does not (the contract's status of a
// failed check).
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "tests/hidden/cases.hpp"
#include "tests/hidden/judge.hpp"
#include "tests/hidden/tally.hpp"

namespace furcula::hidden {
namespace {

struct Arguments {
  std::uint64_t seed = 1;
  std::size_t cases = 400;
  unsigned threads = 2;
  std::vector<Tier> tiers;
  std::string kind, effect, out, write, commit = "?";
  std::optional<Size> size;
  diagnose::WithoutRules without;
  std::size_t ablate = 0;
};

std::optional<Arguments> parsed(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; i += 2) {
    const std::string key = argv[i];
    if (i + 1 == argc) return std::nullopt;
    const std::string value = argv[i + 1];
    char* end = nullptr;
    const auto number = std::strtoull(value.c_str(), &end, 10);
    const bool is_number = !value.empty() && *end == '\0';
    const auto tier =
        std::find_if(std::begin(kTiers), std::end(kTiers), [&](Tier t) { return name(t) == value; });
    if (key == "--seed" && is_number)
      a.seed = number;
    else if (key == "--cases" && is_number)
      a.cases = number;
    else if (key == "--threads" && is_number && number > 0)
      a.threads = static_cast<unsigned>(number);
    else if (key == "--tier" && tier != std::end(kTiers))
      a.tiers.push_back(*tier);
    else if (key == "--kind" && dynamics::kind_named(value))
      a.kind = value;
    else if (key == "--effect" && law_named(value))
      a.effect = value;
    else if (key == "--size" && (value == "small" || value == "medium" || value == "large"))
      a.size = value == "small" ? Size::small : value == "medium" ? Size::medium : Size::large;
    else if (key == "--without" && diagnose::rule_named(value))
      a.without.insert(*diagnose::rule_named(value));
    else if (key == "--ablate" && is_number)
      a.ablate = number;
    else if (key == "--commit")
      a.commit = value;
    else if (key == "--out")
      a.out = value;
    else if (key == "--write")
      a.write = value;
    else
      return std::nullopt;
  }
  return a;
}

// How many of a hundred cases a tier gets when all are asked.
std::size_t weight(Tier tier) {
  switch (tier) {
    case Tier::large:
    case Tier::medium:
    case Tier::small:
      return 18;
    case Tier::pairs:
      return 12;
    case Tier::clean:
      return 24;
    case Tier::outside:
      return 10;
  }
  return 0;
}

// The questions in an order that mixes the tiers, so that a run that is cut short has asked of all.
std::vector<Answer> questions(const Arguments& a) {
  std::vector<Answer> out;
  if (a.size) {
    const Kind kind = a.kind.empty() ? Kind::hopper_linear : *dynamics::kind_named(a.kind);
    for (std::size_t i = 0; i < a.cases; ++i) {
      Answer answer;
      answer.tier = a.effect.empty()          ? Tier::clean
                    : *a.size == Size::small  ? Tier::small
                    : *a.size == Size::medium ? Tier::medium
                                              : Tier::large;
      answer.question.seed = a.seed + i;
      answer.question.kind = kind;
      answer.question.size = *a.size;
      if (!a.effect.empty()) answer.question.laws = {a.effect};
      out.push_back(answer);
    }
    return out;
  }
  std::vector<Tier> tiers = a.tiers;
  if (tiers.empty()) tiers.assign(std::begin(kTiers), std::end(kTiers));
  std::size_t weights = 0;
  for (Tier t : tiers) weights += weight(t);
  std::vector<double> due(tiers.size(), 0.0);
  std::vector<std::uint64_t> asked(tiers.size(), 0);
  while (out.size() < a.cases) {
    for (std::size_t i = 0; i < tiers.size(); ++i)
      due[i] += static_cast<double>(weight(tiers[i])) / static_cast<double>(weights);
    const auto next = static_cast<std::size_t>(std::max_element(due.begin(), due.end()) - due.begin());
    due[next] -= 1.0;
    Answer answer;
    answer.tier = tiers[next];
    answer.question = question_of(tiers[next], a.seed, asked[next]++, a.kind, a.effect);
    const bool wanted = answer.tier == Tier::clean || !answer.question.laws.empty();
    if (wanted) out.push_back(answer);
    // Nothing in any of the tiers: no effect of this name on this kind.
    if (!wanted && asked[next] > 1 && out.empty() && std::ranges::all_of(asked, [](auto n) { return n > 0; }))
      break;
  }
  return out;
}

void write_case(const Case& c, const std::string& folder) {
  std::filesystem::create_directories(folder);
  model::write_model(c.model, folder + "/model.toml");
  for (const auto* logs : {&c.training, &c.held_out})
    for (const log::Log& log : *logs) log::write_log(log, folder + "/" + log.path);
}

// Of a cause of the catalogue another machine_type is drawn until it shows beside what else disturbs that.
Case drawn(Answer& a) {
  constexpr int kDraws = 30;
  constexpr std::uint64_t kNext = 1'000'000;
  Case c = draw_case(a.question);
  if (a.tier == Tier::outside || a.tier == Tier::clean) return c;
  for (int i = 0; !shows(c); ++i) {
    a.hardly_shows = i == kDraws;
    if (a.hardly_shows) break;
    a.question.seed += kNext;
    c = draw_case(a.question);
  }
  return c;
}

void answer(Answer& a, const Arguments& asked, const diagnose::WithoutRules& without) {
  const Case c = drawn(a);
  a.description = c.description();
  if (!asked.write.empty())
    write_case(c, asked.write + "/" + std::string(name(a.tier)) + "-" + std::to_string(a.question.seed));
  const auto begin = std::chrono::steady_clock::now();
  try {
    const diagnose::Diagnosis d = diagnosed(c, 1, without);
    a.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    a.judgement = judge(c, d);
  } catch (const std::exception& e) {
    a.refused = e.what();
  }
}

// Answers all, side by side, each with these rules left out; lines are printed in the order of the questions.
void answer_all(std::vector<Answer>& answers, const Arguments& a,
                const std::vector<diagnose::WithoutRules>& without) {
  const auto begin = std::chrono::steady_clock::now();
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::vector<char> done(answers.size(), 0);
  std::size_t printed = 0, finished = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < answers.size(); i = next++) {
      answer(answers[i], a, without[i]);
      const std::lock_guard lock(mutex);
      done[i] = 1;
      ++finished;
      for (; printed < answers.size() && done[printed]; ++printed)
        std::printf("%s\n", case_line(answers[printed]).c_str());
      std::fflush(stdout);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      std::fprintf(stderr, "\r%zu of %zu cases, %.0f s ", finished, answers.size(), seconds);
    }
  };
  std::vector<std::jthread> others;
  for (unsigned t = 1; t < a.threads; ++t) others.emplace_back(work);
  work();
  others.clear();
  std::fprintf(stderr, "\n");
}

// What each rule is worth: of the cases in which it changed the chosen set, how many are as they should be
// with it and without it.
void ablate(const std::vector<Answer>& answers, const Arguments& a) {
  constexpr std::size_t kRules = diagnose::kRuleNames.size();
  std::vector<Answer> again;
  std::vector<diagnose::WithoutRules> without;
  std::vector<std::size_t> of, rule_of;
  std::array<std::size_t, kRules> acted{};
  for (std::size_t i = 0; i < answers.size(); ++i)
    for (diagnose::Rule r : answers[i].judgement.acted) {
      const auto rule = static_cast<std::size_t>(r);
      if (++acted[rule] > a.ablate) continue;
      again.push_back({answers[i].tier, answers[i].question, {}, {}, {}, 0.0, false});
      without.push_back(a.without);
      without.back().insert(r);
      of.push_back(i), rule_of.push_back(rule);
    }
  std::printf("\nwithout each rule, cases in which it acted\n");
  answer_all(again, a, without);
  std::printf("\n%-22s %6s %6s %6s %6s %6s %6s\n", "rule", "acted", "asked", "right", "right", "worse",
              "better");
  std::printf("%-22s %6s %6s %6s %6s\n", "", "", "again", "with", "out");
  for (std::size_t rule = 0; rule < kRules; ++rule) {
    std::size_t asked = 0, with_it = 0, without_it = 0, worse = 0, better = 0;
    for (std::size_t k = 0; k < again.size(); ++k) {
      if (rule_of[k] != rule) continue;
      const bool before = as_it_should_be(answers[of[k]]), now = as_it_should_be(again[k]);
      ++asked, with_it += before, without_it += now, worse += before && !now, better += now && !before;
    }
    std::printf("%-22s %6zu %6zu %6zu %6zu %6zu %6zu\n", std::string(diagnose::kRuleNames[rule]).c_str(),
                acted[rule], asked, with_it, without_it, worse, better);
  }
}

int run(const Arguments& a) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Answer> answers = questions(a);
  if (answers.empty()) {
    std::fprintf(stderr, "nothing to ask: the catalogue knows no such effect on this kind\n");
    return 2;
  }
  answer_all(answers, a, std::vector<diagnose::WithoutRules>(answers.size(), a.without));

  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Tally t = tally(answers);
  char head[160];
  std::snprintf(head, sizeof head, "commit %.40s, seed %llu, %zu cases, %u threads, %.1f minutes",
                a.commit.c_str(), static_cast<unsigned long long>(a.seed), answers.size(), a.threads,
                seconds / 60);
  std::printf("\n%s\n\n%s", head, text_of(t, answers).c_str());
  if (!a.out.empty()) {
    std::filesystem::create_directories(a.out);
    std::ofstream(a.out + "/confusion.html") << page_of(t, answers, head);
    std::ofstream(a.out + "/cases.csv") << csv_of(answers);
    std::printf("\nwritten: %s/confusion.html, %s/cases.csv\n", a.out.c_str(), a.out.c_str());
  }
  std::fflush(stdout);
  if (a.ablate > 0) ablate(answers, a);
  return t.goals_met() ? 0 : 4;
}

}  // namespace
}  // namespace furcula::hidden

int main(int argc, char** argv) {
  const auto arguments = furcula::hidden::parsed(argc, argv);
  if (!arguments) {
    std::fprintf(
        stderr,
        "usage: furcula_hidden_table [--seed N] [--cases N] [--tier "
        "large|medium|small|pairs|clean|outside]...\n"
        "                            [--threads N] [--kind NAME] [--effect NAME] [--out DIR] [--write DIR]\n"
        "                            [--size small|medium|large] [--commit NAME] [--without RULE]...\n"
        "                            [--ablate N]\n");
    return 2;
  }
  return furcula::hidden::run(*arguments);
}
