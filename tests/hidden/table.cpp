// furcula_hidden_table [--seed N] [--cases N] [--threads N] [--kind NAME] [--effect NAME] [--size NAME]
//                      [--write DIR]
// Draws hidden-effect cases from fresh seeds (seed, seed + 1, ...), lets the diagnosis find them and prints
// how often it did. With --write the recordings and model of each case go to DIR/<seed>/ as well. Exit
// status: 0 all as it should be, 4 if a case was not (the contract's status of a failed check).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "tests/hidden/cases.hpp"
#include "tests/hidden/judge.hpp"
#include "tests/hidden/random.hpp"

namespace furcula::hidden {
namespace {

struct Arguments {
  std::uint64_t seed = 1;
  int cases = 60;
  unsigned threads = 2;
  std::string kind, effect, size, write;
};

struct Row {
  int cases = 0, named = 0, simpler = 0, not_separated = 0, nothing = 0, wrong = 0, extra = 0, failed = 0;
  std::vector<double> errors, removed, seconds;
  int parameters = 0, covered = 0;
};

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(q * static_cast<double>(values.size() - 1)))];
}

std::optional<Arguments> parsed(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; i += 2) {
    const std::string key = argv[i];
    if (i + 1 == argc) return std::nullopt;
    const std::string value = argv[i + 1];
    char* end = nullptr;
    const auto number = std::strtoull(value.c_str(), &end, 10);
    const bool is_number = !value.empty() && *end == '\0';
    if (key == "--seed" && is_number)
      a.seed = number;
    else if (key == "--cases" && is_number)
      a.cases = static_cast<int>(number);
    else if (key == "--threads" && is_number)
      a.threads = static_cast<unsigned>(number);
    else if (key == "--kind" && dynamics::kind_named(value))
      a.kind = value;
    else if (key == "--effect" && law_named(value))
      a.effect = value;
    else if (key == "--size" && (value == "small" || value == "medium" || value == "large"))
      a.size = value;
    else if (key == "--write")
      a.write = value;
    else
      return std::nullopt;
  }
  return a;
}

// One case in six is clean; the kinds, effects and sizes that no argument fixes come round.
Case drawn(const Arguments& a, std::uint64_t seed) {
  Random random(seed ^ 0x5DEECE66Du);
  const bool clean = a.effect.empty() && random.chance(1.0 / 6.0);
  const auto any_size = static_cast<Size>(std::min(2.0, 3 * random.unit()));
  Question q = question_of(clean ? Tier::clean : Tier::medium, a.seed, seed - a.seed, a.kind, a.effect);
  q.nominal = Nominal::scattered;
  q.more_columns = false;
  q.size = a.size == "small"    ? Size::small
           : a.size == "medium" ? Size::medium
           : a.size == "large"  ? Size::large
                                : any_size;
  return draw_case(q);
}

void write_case(const Case& c, const std::string& directory) {
  const std::string folder = directory + "/" + std::to_string(c.question.seed);
  std::filesystem::create_directories(folder);
  model::write_model(c.model, folder + "/model.toml");
  for (const auto* logs : {&c.training, &c.held_out})
    for (const log::Log& log : *logs) log::write_log(log, folder + "/" + log.path);
}

bool as_it_should_be(const Case& c, const Judgement& j, const diagnose::Diagnosis& d) {
  if (c.truth.planted.empty()) return d.findings.empty() && d.verdict == diagnose::Verdict::adequate;
  if (c.size == Size::small) return j.outcome != Outcome::wrong_name && j.extra.empty();
  return j.outcome == Outcome::named && j.extra.empty() && removes_enough(j) &&
         std::all_of(j.parameters.begin(), j.parameters.end(), [](const auto& p) { return p.acceptable(); });
}

void print(const std::string& label, const Row& r) {
  std::printf("%-46s %5d %5d %7d %8d %8d %6d %6d %7.1f %7.1f %5d/%-4d %8.3f %7.1f %7.1f %7d\n", label.c_str(),
              r.cases, r.named, r.simpler, r.not_separated, r.nothing, r.wrong, r.extra,
              100 * quantile(r.errors, 0.5), 100 * quantile(r.errors, 0.9), r.covered, r.parameters,
              quantile(r.removed, 0.5), quantile(r.seconds, 0.5), quantile(r.seconds, 1.0), r.failed);
}

int run(const Arguments& a) {
  std::map<std::string, Row> rows;
  Row all, clean;
  for (int i = 0; i < a.cases; ++i) {
    const Case c = drawn(a, a.seed + static_cast<std::uint64_t>(i));
    if (!a.write.empty()) write_case(c, a.write);
    const auto begin = std::chrono::steady_clock::now();
    const diagnose::Diagnosis d = diagnosed(c, a.threads);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const Judgement j = judge(c, d);
    const bool right = as_it_should_be(c, j, d);
    std::printf("%s %s\n     %s, %.1f s: %s\n", right ? "ok  " : "FAIL", c.description().c_str(),
                std::string(name(j.outcome)).c_str(), seconds, j.said.c_str());
    std::fflush(stdout);

    std::string label(dynamics::info(c.kind).name);
    if (c.truth.planted.empty())
      label += " clean";
    else
      label += " " + std::string(name(c.size)) + " " + c.truth.planted.front().law;
    for (Row* r : {&rows[label], c.truth.planted.empty() ? &clean : &all}) {
      ++r->cases;
      r->named += j.outcome == Outcome::named;
      r->not_separated += j.outcome == Outcome::not_separated;
      r->simpler += j.outcome == Outcome::simpler_law;
      r->nothing += j.outcome == Outcome::nothing_named;
      r->wrong += j.outcome == Outcome::wrong_name;
      r->extra += !j.extra.empty();
      r->failed += !right;
      for (const ParameterError& p : j.parameters) {
        r->errors.push_back(p.relative());
        ++r->parameters;
        r->covered += p.within_interval();
      }
      if (j.outcome == Outcome::named) r->removed.push_back(j.removed_truly);
      r->seconds.push_back(seconds);
    }
  }
  std::printf("\n%-46s %5s %5s %7s %8s %8s %6s %6s %7s %7s %10s %8s %7s %7s %7s\n", "", "cases", "named",
              "simpler", "not sep.", "nothing", "wrong", "extra", "err50 %", "err90 %", "in int.", "removed",
              "s med", "s max", "failed");
  for (const auto& [label, row] : rows) print(label, row);
  print("all with an effect", all);
  print("all clean (wrong = false alarm)", clean);
  return all.failed + clean.failed == 0 ? 0 : 4;
}

}  // namespace
}  // namespace furcula::hidden

int main(int argc, char** argv) {
  const auto arguments = furcula::hidden::parsed(argc, argv);
  if (!arguments) {
    std::fprintf(stderr,
                 "usage: furcula_hidden_table [--seed N] [--cases N] [--threads N] [--kind NAME] "
                 "[--effect NAME] [--size small|medium|large] [--write DIR]\n");
    return 2;
  }
  return furcula::hidden::run(*arguments);
}
