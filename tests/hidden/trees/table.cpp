// furcula_hidden_trees [--seed N] [--cases N] [--tier NAME]... [--effect NAME] [--joints N] [--program PATH]
//                      [--legs] [--out DIR] [--only-write] [--brief] [--timeout SECONDS]
// The blind suite for robots of several joints: draws robots with planted causes, writes them as files, lets
// `furcula diagnose` find the causes and prints how often it did. It shares no code with the diagnosis.
// --out keeps the cases in DIR/<tier>-<number>/ with truth.json, and writes cases.csv. --only-write asks
// nothing. --brief: four logs of 4 s. --legs: a leg that hops and runs in place of robots. Exit status: 0 where the suite has run, 2 for a wrong argument.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/hidden/trees/cases.hpp"
#include "tests/hidden/trees/judge.hpp"
#include "tests/hidden/trees/program.hpp"
#include "tests/hidden/trees/questions.hpp"

namespace furcula::hidden::trees {
namespace {

struct Arguments {
  std::uint64_t seed = 1;
  std::size_t cases = 40, joints = 0;
  std::vector<Tier> tiers;
  std::string effect, program, out;
  bool only_write = false, brief = false, legs = false;
  double timeout_s = 1200;
};

std::optional<Arguments> parsed(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    if (key == "--only-write" || key == "--brief" || key == "--legs") {
      (key == "--brief" ? a.brief : key == "--legs" ? a.legs : a.only_write) = true;
      continue;
    }
    if (++i == argc) return std::nullopt;
    const std::string value = argv[i];
    char* end = nullptr;
    const auto number = std::strtoull(value.c_str(), &end, 10);
    const bool is_number = !value.empty() && *end == '\0';
    const auto tier =
        std::find_if(std::begin(kTiers), std::end(kTiers), [&](Tier t) { return name(t) == value; });
    const auto known = [&](const std::vector<std::string>& list) {
      return std::find(list.begin(), list.end(), value) != list.end();
    };
    if (key == "--seed" && is_number)
      a.seed = number;
    else if (key == "--cases" && is_number)
      a.cases = number;
    else if (key == "--joints" && is_number && number >= 2 && number <= 7)
      a.joints = number;
    else if (key == "--timeout" && is_number)
      a.timeout_s = static_cast<double>(number);
    else if (key == "--tier" && tier != std::end(kTiers))
      a.tiers.push_back(*tier);
    else if (key == "--effect" && (known(catalogue()) || known(outside_causes()) || known(leg_catalogue())))
      a.effect = value;
    else if (key == "--program")
      a.program = value;
    else if (key == "--out")
      a.out = value;
    else
      return std::nullopt;
  }
  const auto has = [](const auto& list, const auto& x) {
    return std::find(list.begin(), list.end(), x) != list.end();
  };
  const bool of_robots = has(catalogue(), a.effect) || has(outside_causes(), a.effect);
  const bool of_legs = has(leg_catalogue(), a.effect) || has(leg_outside_causes(), a.effect);
  if (!a.effect.empty() && !(a.legs ? of_legs : of_robots)) return std::nullopt;
  if (a.legs && (a.joints > 0 || has(a.tiers, Tier::tied) || has(a.tiers, Tier::triple))) return std::nullopt;
  if (a.program.empty() && !a.only_write) return std::nullopt;
  if (a.only_write && a.out.empty()) return std::nullopt;
  return a;
}

struct Answer {
  Question question;
  std::string planted, verdict, found, refused;
  std::size_t joints = 0;
  double shows = 0.0, seconds = 0.0, confidence = 0.0;
  Judgement judgement;
};

std::string csv_line(const Answer& a) {
  char numbers[200];
  std::snprintf(numbers, sizeof numbers, "%.2f,%.2f,%zu,%zu,%.3f,%.1f", a.shows, a.confidence,
                a.judgement.covered, a.judgement.parameters, a.judgement.removed, a.seconds);
  return std::string(name(a.question.tier)) + "," + std::to_string(a.question.seed) + "," +
         std::to_string(a.joints) + ",\"" + a.planted + "\",\"" + a.verdict + "\",\"" + a.found + "\"," +
         (a.judgement.right ? "1" : "0") + "," + a.judgement.how + "," + numbers + ",\"" + a.refused + "\"";
}

Answer ask(const Arguments& a, const Question& question, const std::string& folder) {
  Answer out;
  out.question = question;
  const Case c = draw_case(question);
  out.joints = c.visible();
  out.planted = label(c.planted);
  if (!c.shows.empty()) out.shows = *std::min_element(c.shows.begin(), c.shows.end());
  const std::vector<std::string> logs = write_case(c, folder);
  if (a.only_write) return out;
  const auto begin = std::chrono::steady_clock::now();
  try {
    out.refused = diagnosed(a.program, folder, logs, c.held_out, a.timeout_s);
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (out.refused.empty()) {
      const Diagnosis d = read_diagnosis(folder + "/diagnosis/diagnosis.json");
      out.verdict = d.verdict;
      std::vector<Cause> found;
      for (const Finding& f : d.findings) found.push_back(f.cause);
      out.found = label(found);
      if (!d.findings.empty()) out.confidence = d.findings.front().confidence;
      out.judgement = judge(c, d);
    }
  } catch (const std::exception& e) {
    out.refused = e.what();
  }
  return out;
}

void print_summary(const std::vector<Answer>& answers) {
  std::printf("\n%-8s %6s %6s %8s %8s %6s %6s %8s %8s %14s\n", "tier", "cases", "right", "nothing", "extra",
              "half", "wrong", "refused", "seconds", "ci95 hold");
  for (Tier tier : kTiers) {
    std::size_t cases = 0, right = 0, refused = 0, covered = 0, parameters = 0;
    double seconds = 0.0;
    std::map<std::string, std::size_t> how;
    for (const Answer& a : answers) {
      if (a.question.tier != tier) continue;
      ++cases;
      right += a.judgement.right;
      refused += !a.refused.empty();
      if (!a.judgement.right && a.refused.empty()) ++how[a.judgement.how];
      covered += a.judgement.covered;
      parameters += a.judgement.parameters;
      seconds += a.seconds;
    }
    if (cases == 0) continue;
    std::printf("%-8s %6zu %6zu %8zu %8zu %6zu %6zu %8zu %8.1f %7zu of %zu\n", name(tier).data(), cases,
                right, how["nothing"], how["extra"], how["half"], how["wrong"], refused,
                seconds / static_cast<double>(cases), covered, parameters);
  }
  std::map<std::string, std::pair<std::size_t, std::size_t>> effects;
  for (const Answer& a : answers) {
    const bool single = a.question.effects.size() == 1 && a.question.tier != Tier::outside;
    if (!single) continue;
    auto& [right, of] = effects[a.question.effects.front()];
    right += a.judgement.right;
    ++of;
  }
  if (effects.empty()) return;
  std::printf("\n%-22s right of single causes\n", "effect");
  for (const auto& [effect, counts] : effects)
    std::printf("%-22s %zu of %zu\n", effect.c_str(), counts.first, counts.second);
}

int run(const Arguments& a) {
  const bool keep = !a.out.empty();
  const std::string folder =
      keep ? a.out : (std::filesystem::temp_directory_path() / ("trees-" + std::to_string(a.seed))).string();
  std::filesystem::create_directories(folder);
  const auto questions = draw_questions(a.seed, a.cases, a.tiers, a.effect, a.joints, a.brief, a.legs);
  std::vector<Answer> answers;
  std::map<Tier, std::size_t> asked;
  for (const Question& question : questions) {
    char number[24];
    std::snprintf(number, sizeof number, "-%03zu", asked[question.tier]++);
    const std::string of_case = folder + "/" + std::string(name(question.tier)) + number;
    try {
      answers.push_back(ask(a, question, of_case));
    } catch (const std::exception& e) {
      std::printf("%-8s not drawn: %s\n", name(question.tier).data(), e.what());
      continue;
    }
    const Answer& last = answers.back();
    if (!keep) std::filesystem::remove_all(of_case);
    std::printf(
        "%-8s %zu joints  planted %s (shows %.1f)  verdict %s  found %s  %s  %.1f s%s%s\n",
        name(question.tier).data(), last.joints, last.planted.c_str(), last.shows,
        last.verdict.empty() ? "-" : last.verdict.c_str(), last.found.empty() ? "-" : last.found.c_str(),
        a.only_write ? "not asked"
                     : ((last.judgement.right ? "right, " : "NOT RIGHT, ") + last.judgement.how).c_str(),
        last.seconds, last.refused.empty() ? "" : "  refused: ", last.refused.c_str());
    std::fflush(stdout);
  }
  if (!a.only_write) print_summary(answers);
  if (keep) {
    std::ofstream csv(folder + "/cases.csv");
    csv << "tier,seed,joints,planted,verdict,found,right,how,shows,confidence,covered,parameters,removed,seconds,"
           "refused\n";
    for (const Answer& answer : answers) csv << csv_line(answer) << "\n";
  }
  return 0;
}

}  // namespace
}  // namespace furcula::hidden::trees

int main(int argc, char** argv) {
  namespace trees = furcula::hidden::trees;
  try {
    const auto arguments = trees::parsed(argc, argv);
    if (arguments) return trees::run(*arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  std::fprintf(
      stderr,
      "usage: furcula_hidden_trees --program PATH [--seed N] [--cases N]\n"
      "         [--tier clean|small|medium|large|tied|pairs|triple|outside]... [--effect NAME]\n"
      "         [--joints 2..7] [--legs] [--out DIR] [--only-write] [--brief] [--timeout SECONDS]\n");
  return 2;
}
