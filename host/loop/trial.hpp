// A walk on the robot: how its log comes to be, and what it says.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "host/floating/recording.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::loop {

/// Of `--robot`: a person takes the walk to the robot, and brings the log.
inline constexpr std::string_view kManual = "manual";

struct Request {
  std::string
      robot;  ///< a command for the shell with {walk}, {log} and perhaps {repetition}, {round}; or kManual
  std::string walk;                    ///< its file
  std::string log;                     ///< where the log is to be, when all of it is there
  unsigned round = 1, repetition = 1;  ///< round 0: an exercise on the stand
  double window_s = 0.3;
  std::function<void(const std::string& line)> say;
};

/// The robot's command with its placeholders replaced by words of a shell, with absolute paths.
/// @throws core::DataError: no {walk} or no {log}.
std::string command_of(const Request& request);

/// Where the robot or the person puts the log, beside `log`: it is renamed when it is whole and can be used.
std::string incoming(const std::string& log);

/// Gets the log of a trial, unless it is there already. @throws core::DataError with what was expected and how to go on: the command
/// fails, there is no log, it cannot be read, no window of it can be used.
void get_log(const Request& request);

/// A log of the request's trial. @throws core::DataError: it cannot be read, no window of it can be used, it is of a robot on the stand and is to be of
/// a walk, or the other way round.
floating::Recording read_recording(const std::string& log, const Request& request);

/// How a trial ended.
struct Outcome {
  std::optional<double> fall_s;      ///< after the log's first row (floating::recording_of)
  double time_s = 0.0, way_m = 0.0;  ///< of the log's rows before a fall; forward (way.hpp)
  bool stands = false;               ///< no fall, and the log is as long as the walk
};
/// `asked_s`: how long a walk lasts.
Outcome outcome_of(const floating::Recording& recording, const floating::Machine& machine, double asked_s);

}  // namespace furcula::loop
