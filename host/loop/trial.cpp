#include "host/loop/trial.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <thread>
#include <utility>

#include "host/core/atomic_file.hpp"
#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/accept_stamps.hpp"
#include "host/log/reader.hpp"
#include "host/loop/way.hpp"

namespace furcula::loop {
namespace {

namespace fs = std::filesystem;
using core::DataError;

constexpr const char* kGoOn = "; the same command goes on with this trial";

std::string absolute_word(const std::string& path) {
  return core::shell_word(fs::absolute(path).lexically_normal().string());
}

void run(const Request& r) {
  const std::string command = command_of(r), log = incoming(r.log);
  std::error_code none;
  fs::remove(log, none);  // of a trial that was interrupted
  r.say("trial " + std::to_string(r.repetition) + ": " + core::printable(command));
  // The terminal's Ctrl-C ends the command alone, and its status is told here.
  const int status = std::system(command.c_str());
  std::string how;
  if (status == -1)
    how = "cannot be started";
  else if (WIFSIGNALED(status))
    how = "ended by signal " + std::to_string(WTERMSIG(status));
  else if (WEXITSTATUS(status) > 128)
    how = "ended with status " + std::to_string(WEXITSTATUS(status)) + ", as by signal " +
          std::to_string(WEXITSTATUS(status) - 128);
  else if (WEXITSTATUS(status) != 0)
    how = "ended with status " + std::to_string(WEXITSTATUS(status));
  if (!how.empty())
    throw DataError("the robot's command " + how + ": " + command +
                    "\nexpected: status 0 after a trial, also after one in which the robot falls" + kGoOn);
  if (!fs::is_regular_file(log))
    throw DataError("the robot's command wrote no log: " + command + "\nexpected: " + log +
                    ", which {log} stands for" + kGoOn);
}

/// Waits for a file that a person copies: for Enter on a terminal, else until it does not grow for a second.
void wait_for(const Request& r) {
  const std::string log = incoming(r.log);
  r.say("trial " + std::to_string(r.repetition) + ": copy " + core::printable(r.walk) +
        (r.round == 0
             ? " to the robot, let it move its legs on its stand, no foot on the ground, and put its log at "
             : " to the robot, let it walk, and put its log at ") +
        core::printable(log));
  if (::isatty(STDIN_FILENO) == 1) {
    do {
      r.say("press Enter when it is there");
      for (int c = std::getchar(); c != '\n';) {
        if (c == EOF) throw DataError("no log yet: " + log + "; expected the robot's log" + kGoOn);
        c = std::getchar();
      }
    } while (!fs::is_regular_file(log));
    return;
  }
  constexpr auto kLook = std::chrono::milliseconds(200);
  constexpr int kSteady = 5;
  std::uintmax_t size = 0;
  for (int steady = 0; steady < kSteady; std::this_thread::sleep_for(kLook)) {
    std::error_code none;
    const std::uintmax_t now = fs::file_size(log, none);
    steady = !none && now > 0 && now == size ? steady + 1 : 0;
    size = none ? 0 : now;
  }
}

}  // namespace

std::string incoming(const std::string& log) {
  const fs::path path(log);
  return (path.parent_path() / ("new_" + path.filename().string())).string();
}

std::string command_of(const Request& r) {
  const std::array<std::pair<std::string_view, std::string>, 4> words{
      {{"{walk}", absolute_word(r.walk)},
       {"{log}", absolute_word(incoming(r.log))},
       {"{repetition}", std::to_string(r.repetition)},
       {"{round}", std::to_string(r.round)}}};
  for (const std::string_view name : {"{walk}", "{log}"})
    if (r.robot.find(name) == std::string::npos)
      throw DataError("--robot " + core::quoted(r.robot) + ": no " + std::string(name) +
                      "; expected a command with {walk} and {log}, or manual");
  std::string out;
  for (std::string_view rest = r.robot; !rest.empty();) {
    const auto word =
        std::find_if(words.begin(), words.end(), [&](const auto& w) { return rest.starts_with(w.first); });
    const bool found = word != words.end();
    out += found ? word->second : std::string(rest.substr(0, 1));
    rest.remove_prefix(found ? word->first.size() : 1);
  }
  return out;
}

floating::Recording read_recording(const std::string& path, const Request& r) {
  const bool on_stand = r.round == 0;
  log::Log log = log::read_log(path, "tree");
  log::accept_stamps(log, nullptr, r.window_s);
  floating::Recording out = floating::recording_of(log);
  const std::string expected =
      on_stand
          ? "a robot that moves its legs on its stand, no foot loaded; without a stand --exercise-s 0, in another folder"
          : "a robot that stands or walks, a foot loaded";
  if (out.held != on_stand)
    throw DataError(path +
                    (on_stand ? ": a foot is loaded or the pelvis turns" : ": no foot is ever loaded") +
                    "; expected " + expected);
  if (floating::windows_of(out, 0, r.window_s).empty())
    throw DataError(path + ": no window of " + core::rounded(0.5 * r.window_s, 3) +
                    " s without a landing; expected " + expected);
  return out;
}

void get_log(const Request& r) {
  if (fs::exists(r.log)) return;
  if (r.robot == kManual)
    wait_for(r);
  else
    run(r);
  const std::string log = incoming(r.log);
  try {
    read_recording(log, r);
  } catch (const DataError& e) {
    throw DataError("the robot's log cannot be used: " + std::string(e.what()) + kGoOn);
  }
  std::ifstream file(log, std::ios::binary);
  core::write_file_atomically(r.log, std::string(std::istreambuf_iterator<char>(file), {}));
  std::error_code none;
  fs::remove(log, none);
}

Outcome outcome_of(const floating::Recording& recording, const floating::Machine& machine, double asked_s) {
  constexpr double kWhole = 0.95;
  Outcome out;
  out.fall_s = recording.fall_s;
  if (recording.rows.empty()) return out;
  out.time_s = recording.rows.back().time_s - recording.rows.front().time_s;
  out.way_m = way_of(recording, machine).back().x_m;
  out.stands = !out.fall_s && out.time_s >= kWhole * asked_s;
  return out;
}

}  // namespace furcula::loop
