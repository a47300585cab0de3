// furcula_convention_table --program PATH [--seed N] [--machines N] [--robots N] [--kind NAME] [--threads N] [--out DIR] [--timeout SECONDS] [--alarms N]
// The conventions' table: recordings of virtual machines and robots without any hidden cause get one wrong convention each (fault.hpp), and
// the program is asked for a diagnosis. Printed is how often it named the convention, listed it, named another one, named a cause, or nothing.
// With --alarms N in its place: the trial of conventions is asked about N machines, N / 3 robots and N / 10 legs with and without causes of
// the catalogue, whose columns are right; each that it refuses is printed.
// Exit status: 0 where the table was made.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/identify/conventions.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/model.hpp"
#include "tests/hidden/cases.hpp"
#include "tests/hidden/conventions/fault.hpp"
#include "tests/hidden/random.hpp"
#include "tests/hidden/trees/cases.hpp"
#include "tests/hidden/trees/program.hpp"
#include "tests/hidden/trees/questions.hpp"

namespace furcula::hidden::conventions {
namespace {

struct Arguments {
  std::string program, out, kind;
  std::uint64_t seed = 1;
  std::size_t machines = 1, robots = 2, alarms = 0;
  unsigned threads = 2;
  double timeout_s = 600.0;
};

struct Subject {
  std::string name, kind, model;  ///< the model file's text
  std::vector<log::Log> logs;     ///< the held-out ones last
  std::size_t held_out = 0;
  std::string folder;  ///< with the files that the model names
};

struct Row {
  std::size_t subject = 0;
  Fault fault;
  std::string answer, said;
  double seconds = 0.0;
};

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Kinds that this folder has no machine of are simulated by the program itself, as their models say.
struct OfProgram {
  std::string_view kind, model;
};
constexpr OfProgram kOfProgram[]{
    {"torsion_pendulum",
     "[parameters]\ninertia_kgm2 = 0.02\nstiffness_nmprad = 3.0\ndamping_nmspr = 0.02\n\n[free]\ndamping_nmspr = [0.0, 0.1]\n"},
    {"hopper_nonlinear",
     "[parameters]\nmass_kg = 1.554\nstiffness_npm = 605.0\nrest_height_m = 0.282\ndamping_stance_nspm = 5.0\n"
     "damping_flight_nspm = 1.0\nrestitution_touchdown = 0.95\nrestitution_liftoff = 0.98\nlink_length_m = 0.15\n"
     "touchdown_angle_rad = 0.349\ngravity_mps2 = 9.81\ninertia_a_kgm2 = 42e-4\ninertia_b_kgm = 1e-2\ninertia_e_kgm = 2e-2\n\n"
     "[free]\nmass_kg = [1.2, 2.0]\n"}};

/// Encoders of 16384 steps a turn, or of 0.1 mm, and drives that give 1 % more or less.
void blur(log::Log& log, std::uint64_t seed) {
  Random random(seed);
  for (auto& [name, values] : log.columns) {
    const double step = name == "angle_rad" || name == "leg_angle_rad" ? 2.0 * std::numbers::pi / 16384.0
                        : name == "height_m"                           ? 1e-4
                                                                       : 0.0;
    double most = 0.0;
    for (const double x : values) most = std::max(most, std::abs(x));
    for (double& x : values) {
      if (step > 0.0) x = step * std::round(x / step);
      if (name.starts_with("torque")) x += 0.01 * most * random.normal();
    }
  }
}

bool simulated(Subject& s, const Arguments& a, std::uint64_t seed) {
  const auto of = std::find_if(std::begin(kOfProgram), std::end(kOfProgram),
                               [&](const OfProgram& p) { return p.kind == s.kind; });
  if (of == std::end(kOfProgram)) return false;
  std::filesystem::create_directories(s.folder);
  const std::string model = s.folder + "/model.toml";
  std::ofstream(model) << "[model]\nkind = \"" << s.kind << "\"\nschema = 1\n\n" << of->model;
  constexpr int kLogs = 4;
  for (int k = 0; k < kLogs; ++k) {
    const std::string log = s.folder + "/simulated_" + std::to_string(k) + ".csv";
    const std::string command = core::shell_word(a.program) + " sim --model " + core::shell_word(model) +
                                " --seed " + std::to_string(seed + 100 * static_cast<std::uint64_t>(k)) +
                                " --out " + core::shell_word(log) + " > " +
                                core::shell_word(s.folder + "/sim.txt") + " 2>&1";
    if (std::system(command.c_str()) != 0) return false;  // NOLINT(concurrency-mt-unsafe)
    s.logs.push_back(log::read_log(log, std::string(dynamics::info(*dynamics::kind_named(s.kind)).rig)));
    blur(s.logs.back(), seed + 100 * static_cast<std::uint64_t>(k));
  }
  s.held_out = 1;
  return true;
}

std::vector<Subject> subjects(const Arguments& a) {
  std::vector<Subject> out;
  for (const auto& machine : dynamics::kMachines)
    for (std::size_t i = 0; i < a.machines; ++i) {
      if (!a.kind.empty() && a.kind != machine.name) continue;
      Question q;
      q.seed = a.seed + i;
      q.kind = machine.kind;
      q.disturbed = true;
      Subject s;
      s.kind = machine.name;
      s.name = s.kind + "-" + std::to_string(i);
      s.folder = a.out + "/" + s.name;
      Case c;
      try {
        c = hidden::draw_case(q);
      } catch (const std::exception& e) {
        if (simulated(s, a, q.seed)) {
          out.push_back(s);
          continue;
        }
        std::printf("%s: no case: %s\n", s.name.c_str(), e.what());
        break;
      }
      std::filesystem::create_directories(s.folder);
      model::write_model(c.model, s.folder + "/model.toml");
      for (auto* logs : {&c.training, &c.held_out}) s.logs.insert(s.logs.end(), logs->begin(), logs->end());
      s.held_out = c.held_out.size();
      out.push_back(s);
    }
  const auto questions = trees::draw_questions(a.seed, a.robots, {trees::Tier::clean}, "", 0, true);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (!a.kind.empty() && a.kind != "tree") break;
    const trees::Case c = trees::draw_case(questions[i]);
    Subject s;
    s.kind = "tree";
    s.name = "tree-" + std::to_string(i) + "-" + c.robot.form + "-" + std::to_string(c.visible());
    s.folder = a.out + "/" + s.name;
    for (const std::string& log : trees::write_case(c, s.folder))
      s.logs.push_back(log::read_log(s.folder + "/" + log, "tree"));
    s.held_out = c.held_out;
    out.push_back(s);
  }
  for (Subject& s : out) s.model = text_of(s.folder + "/model.toml");
  return out;
}

bool near(double a, double b) { return std::abs(a - b) <= 0.05 * std::abs(b); }

/// Whether the lines of a map file in `text` undo the fault, and nothing else.
bool undoes(const Fault& fault, const std::string& text) {
  static const std::regex line(
      R"re((\w+) = \{ column = "([^"]+)"(?:, scale = ([-+\d.e]+))?(?:, offset = ([-+\d.e]+))? \})re");
  std::map<std::string, Change> written;
  for (std::sregex_iterator m(text.begin(), text.end(), line), end; m != end; ++m) {
    const std::string ours = (*m)[1], theirs = (*m)[2];
    Change c{(*m)[3].matched ? std::stod((*m)[3]) : 1.0, (*m)[4].matched ? std::stod((*m)[4]) : 0.0};
    if (theirs != ours) c.from = theirs;
    written[ours] = c;
  }
  if (written.empty()) return false;
  for (const auto& [name, c] : written) {
    const auto right = fault.undone.find(name);
    if (right == fault.undone.end() || right->second.from != c.from || !near(c.scale, right->second.scale))
      return false;
    const double off = std::remainder(c.offset - right->second.offset, 2.0 * std::numbers::pi);
    if (std::abs(off) > 0.1) return false;
  }
  // Of several inputs that are logged of one joint those are named that are used.
  std::size_t positions = 0, named = 0;
  for (const auto& [name, c] : fault.undone)
    if (name.find("cmd") == name.npos) ++positions, named += written.contains(name);
  return named == positions || written.size() >= fault.undone.size() / 2;
}

/// One reading and its equal in every recording: of one joint the other sign of position and input, and, where nothing else has a scale,
/// a position times x and an input times 1 / x.
std::optional<Fault> equal(const Fault& f, const log::Log& log, const std::string& kind) {
  if (log.rig == "tree" || f.undone.size() > 2 || f.group == "exchange" || f.group == "zero")
    return std::nullopt;
  Fault out = f;
  out.undone.clear();
  const bool of_position = f.undone.begin()->first.find("torque") == std::string::npos &&
                           f.undone.begin()->first.find("force") == std::string::npos;
  const double scale = f.undone.begin()->second.scale;
  // Of a linear machine the scale of the input is one over that of the position.
  const bool linear = kind == "motor_axis" || kind == "torsion_pendulum";
  if (f.group != "sign" && !linear) return std::nullopt;
  for (const char* name : {"angle_rad", "position_m", "torque_nm", "torque_cmd_nm", "force_n"}) {
    const bool position =
        std::string_view(name).starts_with("angle") || std::string_view(name).starts_with("position");
    if (log.has(name) && position != of_position) out.undone[name] = {1.0 / scale};
  }
  if (out.undone.empty()) return std::nullopt;
  return out;
}

void ask(Row& row, const Subject& s, const Arguments& a, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& file : std::filesystem::directory_iterator(s.folder))
    if (file.path().extension() == ".urdf")
      std::filesystem::copy(file.path(), folder, std::filesystem::copy_options::overwrite_existing);
  std::string model = s.model;
  if (!row.fault.model_from.empty())
    model.replace(model.find(row.fault.model_from), row.fault.model_from.size(), row.fault.model_to);
  std::ofstream(folder + "/model.toml") << model;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < s.logs.size(); ++i) {
    names.push_back("log_" + std::to_string(i) + ".csv");
    log::write_log(faulty(s.logs[i], row.fault), folder + "/" + names.back());
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::string refused = trees::diagnosed(a.program, folder, names, s.held_out, a.timeout_s);
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (refused.empty()) {
    const auto json = nlohmann::json::parse(text_of(folder + "/diagnosis/diagnosis.json"));
    row.answer = "nothing";
    row.said = json.at("verdict");
    for (const auto& f : json.at("findings")) {
      const double confidence = f.at("confidence");
      row.said += " " + f.at("effect").get<std::string>() + " " + std::to_string(confidence).substr(0, 4);
      if (confidence > 0.5) row.answer = "cause";
    }
    // A zero that moves the recordings exactly as the cause does, listed beside it: of one machine's encoder, or of a robot's.
    const auto& findings = json.at("findings");
    if (row.fault.group == "zero" && findings.size() == 1)
      for (const auto& rival : findings.front().at("indistinguishable_from")) {
        const auto& causes = rival.at("causes");
        if (causes.size() == 1 && causes.front().value("effect", "") == "encoder_offset")
          row.answer = "equal";
      }
    return;
  }
  row.said = refused;
  const auto rest = std::min(refused.find(". So read"), refused.size());
  const bool listed = std::any_of(row.fault.words.begin(), row.fault.words.end(), [&](const std::string& w) {
    return refused.find(w) != refused.npos;  // also among the questions about an estimated scale
  });
  const bool in_words =
      row.fault.undone.empty() &&
      std::any_of(row.fault.words.begin(), row.fault.words.end(),
                  [&](const std::string& w) { return refused.substr(0, rest).find(w) != refused.npos; });
  const auto same = row.fault.undone.empty() ? std::nullopt : equal(row.fault, s.logs.front(), s.kind);
  if (refused.find("timed out") != refused.npos || refused.starts_with("status 124"))
    row.answer = "time";
  else if (in_words || undoes(row.fault, refused))
    row.answer = "named";
  else if (same && undoes(*same, refused))
    row.answer = "equal";
  else if (listed)
    row.answer = "listed";
  else if (refused.find("it seems that") != refused.npos)
    row.answer = "other";
  else
    row.answer = "refused";
}

constexpr const char* kAnswers[] = {"named", "equal",   "listed",  "other",
                                    "cause", "nothing", "refused", "time"};

void print_table(const std::vector<Subject>& subjects, const std::vector<Row>& rows) {
  std::map<std::pair<std::string, std::string>, std::map<std::string, int>> counts;
  for (const Row& r : rows)
    for (const std::string& kind : {subjects[r.subject].kind, std::string("all")})
      ++counts[{kind, r.fault.group}][r.answer];
  std::printf("\n%-18s %-9s", "kind", "fault");
  for (const char* answer : kAnswers) std::printf(" %8s", answer);
  std::printf("\n");
  for (const auto& [of, by] : counts) {
    std::printf("%-18s %-9s", of.first.c_str(), of.second.c_str());
    for (const char* answer : kAnswers) std::printf(" %8d", by.contains(answer) ? by.at(answer) : 0);
    std::printf("\n");
  }
}

/// One whose columns are right.
struct Right {
  std::string name;
  std::function<void()> ask;  ///< throws core::DataError where the trial refuses it
};

void ask_robot(const trees::Question& question, const std::string& folder) {
  const trees::Case c = trees::draw_case(question);
  const std::vector<std::string> names = trees::write_case(c, folder);
  const auto model = furcula::trees::parse_tree_model(text_of(folder + "/model.toml"), folder + "/model.toml",
                                                      furcula::trees::TreeContext{});
  std::vector<furcula::trees::Recording> recordings;
  for (std::size_t i = 0; i + c.held_out < names.size(); ++i)
    recordings.push_back(furcula::trees::recording_of(model, log::read_log(folder + "/" + names[i], "tree")));
  std::filesystem::remove_all(folder);
  furcula::trees::require_conventions(model, recordings, 0.3);
}

void ask_right(const Arguments& a) {
  std::vector<Right> all;
  constexpr std::size_t kTierCount = std::size(kTiers);
  for (std::size_t i = 0; i < a.alarms; ++i) {
    const Question q = question_of(kTiers[i % kTierCount], a.seed, i / kTierCount, a.kind);
    all.push_back({"machine " + std::string(name(kTiers[i % kTierCount])) + " " + std::to_string(i), [q] {
                     Case c = draw_case(q);
                     const auto recordings = identify::make_recordings(c.training, c.kind);
                     try {
                       identify::require_conventions(c.model, recordings);
                     } catch (const core::DataError& e) {
                       throw core::DataError(c.description() + ": " + e.what());
                     }
                   }});
  }
  for (const bool legs : {false, true})
    for (const trees::Question& q :
         trees::draw_questions(a.seed, a.alarms / (legs ? 10 : 3), {}, "", 0, !legs, legs))
      all.push_back({std::string(legs ? "leg " : "robot ") + std::string(trees::name(q.tier)) + " " +
                         std::to_string(all.size()),
                     [q, folder = a.out + "/right-" + std::to_string(all.size())] { ask_robot(q, folder); }});
  std::atomic<std::size_t> refused = 0, not_drawn = 0;
  std::mutex mutex;
  core::parallel_for(all.size(), a.threads, [&](std::size_t i) {
    std::string said;
    try {
      all[i].ask();
    } catch (const core::DataError& e) {
      ++refused, said = std::string("REFUSED ") + e.what();
    } catch (const std::exception& e) {
      ++not_drawn, said = std::string("not drawn: ") + e.what();
    }
    const std::lock_guard lock(mutex);
    if (!said.empty()) std::printf("%s: %s\n", all[i].name.c_str(), said.c_str());
    std::fflush(stdout);
  });
  std::printf("%zu with right columns, %zu refused, %zu not drawn\n", all.size(), refused.load(),
              not_drawn.load());
}

void ask_wrong(const Arguments& a) {
  const std::vector<Subject> all = subjects(a);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (Fault& f : faults_of(all[i].logs.front(), all[i].model)) rows.push_back({i, std::move(f), {}, {}});
  std::mutex mutex;
  std::size_t finished = 0;
  core::parallel_for(rows.size(), a.threads, [&](std::size_t i) {
    const Subject& s = all[rows[i].subject];
    try {
      ask(rows[i], s, a, s.folder + "/" + std::to_string(i));
    } catch (const std::exception& e) {
      rows[i].answer = "refused", rows[i].said = e.what();
    }
    const std::lock_guard lock(mutex);
    std::printf("%-22s %-9s %-28s %-8s %5.1f s  %s\n", s.name.c_str(), rows[i].fault.group.c_str(),
                rows[i].fault.name.c_str(), rows[i].answer.c_str(), rows[i].seconds,
                rows[i].said.substr(0, 400).c_str());
    std::fflush(stdout);
    std::fprintf(stderr, "\r%zu of %zu ", ++finished, rows.size());
  });
  print_table(all, rows);
}

}  // namespace
}  // namespace furcula::hidden::conventions

int main(int argc, char** argv) {
  namespace conventions = furcula::hidden::conventions;
  conventions::Arguments a;
  CLI::App app("What a diagnosis says of wrong conventions in recordings");
  auto* program = app.add_option("--program", a.program, "furcula");
  auto* alarms =
      app.add_option("--alarms", a.alarms, "Ask the trial about so many machines whose columns are right");
  program->excludes(alarms);
  app.add_option("--out", a.out, "Folder of the cases")->required();
  app.add_option("--kind", a.kind, "Of one kind alone");
  app.add_option("--seed", a.seed);
  app.add_option("--machines", a.machines, "Of each kind");
  app.add_option("--robots", a.robots, "Of several joints");
  app.add_option("--threads", a.threads);
  app.add_option("--timeout", a.timeout_s, "Of a diagnosis, s");
  CLI11_PARSE(app, argc, argv);
  if (a.program.empty() && a.alarms == 0) {
    std::fprintf(stderr, "--program or --alarms is required\n");
    return 2;
  }
  try {
    if (a.alarms > 0)
      conventions::ask_right(a);
    else
      conventions::ask_wrong(a);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
