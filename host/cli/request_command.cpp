// `furcula request`: what a robot is asked to do. Who makes it hop stays, for it hops on as long as somebody
// asks.
#include <chrono>
#include <csignal>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "furcula/bus/node_words.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/robot.hpp"
#include "host/core/message.hpp"
#include "host/modbus/monitor.hpp"

namespace furcula::cli {
namespace {

struct RequestOptions {
  RobotOptions robot;
  std::string name;
  double for_s = std::numeric_limits<double>::infinity();
};

bus::Request request_named(const std::string& name) {
  for (const bus::Word& w : bus::kRequests)
    if (w.name == name) return static_cast<bus::Request>(w.number);
  throw UsageError("no request " + core::quoted(name));
}

volatile std::sig_atomic_t ended = 0;

/// Looks until the time is over or it is interrupted, and then stops the robot. @throws Refusal where it ends
/// by itself, unless somebody else stopped it or its trial on the bench is over.
void stay(modbus::Client& robot, double for_s) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { ended = 1; });
  std::cerr << "it hops; Ctrl-C stops it\n";
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  while (ended == 0 && std::chrono::duration<double>(Clock::now() - begin).count() < for_s) {
    const bus::Snapshot s = robot.snapshot();
    if (s.state != static_cast<int>(bus::NodeState::running)) {
      if (s.reason == static_cast<int>(bus::Reason::stopped) ||
          s.reason == static_cast<int>(bus::Reason::trial_ended))
        return;
      throw Refusal("it hops no more: " + modbus::reason_text(s));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  robot.request(bus::Request::stop);
}

/// `hop` arms it first.
void run(const RequestOptions& options) {
  const bus::Request request = request_named(options.name);
  const bool hop = request == bus::Request::hop;
  modbus::Client robot = connect(options.robot);
  if (hop) robot.request(bus::Request::arm);
  robot.request(request);
  if (hop && options.for_s > 0.0) stay(robot, options.for_s);
}

}  // namespace

void add_request_command(CLI::App& app) {
  const auto options = std::make_shared<RequestOptions>();
  std::vector<std::string> names;
  for (const bus::Word& w : bus::kRequests)
    if (w.number != 0 && w.name != "arm") names.emplace_back(w.name);
  CLI::App* command =
      app.add_subcommand("request", "Ask a robot to hop (until Ctrl-C), stop, reset, home, ...");
  add_robot_options(*command, options->robot);
  command->add_option("REQUEST", options->name, "What it is to do")->required()->check(CLI::IsMember(names));
  command
      ->add_option(
          "--for", options->for_s,
          "hop: seconds until it is stopped; 0: leave it at once to who else asks, as a monitor does")
      ->check(CLI::Range(0.0, 1e6));
  command->callback(guarded([options] { run(*options); }));
}

}  // namespace furcula::cli
