// `furcula serve`: the simulated rig in real time behind Modbus/TCP, to try the other commands on.
#include <chrono>
#include <csignal>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "host/bench/live_stand.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/core/own_build.hpp"
#include "host/modbus/tcp_server.hpp"
#include "host/model/reader.hpp"
#include "host/sim/live_rig.hpp"

namespace furcula::cli {
namespace {

struct ServeOptions {
  std::string model, scenario, store;
  std::string address = "127.0.0.1";
  int port = 1502;
  std::uint64_t seed = 0;
  double duration_s = 0.0;
  bool bench = false;
};

volatile std::sig_atomic_t serving_ended = 0;

/// Until it is interrupted, or for as long as it was told.
void live(const ServeOptions& options, const char* what, const std::function<void(int)>& advance,
          modbus::TcpServer::Answer answer) {
  if (const std::string warning = modbus::network_warning(options.address); !warning.empty())
    std::cerr << "furcula: warning: " << warning << "\n";
  const modbus::TcpService server(options.address, options.port, std::move(answer));
  std::signal(SIGINT, [](int) { serving_ended = 1; });
  std::signal(SIGTERM, [](int) { serving_ended = 1; });
  std::cout << what << " answers at modbus:" << options.address << ":" << server.port() << ", build "
            << core::hexadecimal(core::own_build_id()) << "\n"
            << std::flush;
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  for (std::int64_t done_ms = 0; serving_ended == 0;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto due_ms = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin).count();
    advance(static_cast<int>(due_ms - done_ms));
    done_ms = due_ms;
    if (options.duration_s > 0.0 && static_cast<double>(due_ms) >= options.duration_s * 1000.0) break;
  }
}

void run(const ServeOptions& options) {
  const std::uint32_t build_id = core::own_build_id();
  const std::string text = FURCULA_VERSION " build " + core::hexadecimal(build_id);
  const bus::Identity identity{
      .board = "sim_host", .text = text, .firmware_version = FURCULA_VERSION_NUMBER, .build_id = build_id};
  const auto session = static_cast<std::uint16_t>(std::random_device{}());
  if (options.bench) {
    bench::LiveStand stand({}, identity, session);
    live(
        options, "a simulated bench", [&stand](int ticks) { stand.advance(ticks); },
        [&stand](std::span<const std::uint8_t> request) { return stand.answer(request); });
    return;
  }
  const model::Model model = options.model.empty() ? sim::example_hopper() : model::read_model(options.model);
  if (!dynamics::has(model.kind, dynamics::LocationType::leg))
    throw UsageError("--model: furcula serve needs a hopper");
  const sim::Scenario scenario =
      options.scenario.empty() ? sim::default_scenario(model) : sim::read_scenario(options.scenario, model);
  sim::LiveRig rig(model, scenario, options.seed, options.store, identity, session);
  live(
      options, "a simulated robot", [&rig](int ticks) { rig.advance(ticks); },
      [&rig](std::span<const std::uint8_t> request) { return rig.answer(request); });
}

}  // namespace

void add_serve_command(CLI::App& app) {
  const auto options = std::make_shared<ServeOptions>();
  CLI::App* command =
      app.add_subcommand("serve", "A simulated robot in real time behind Modbus/TCP, for monitor and param");
  CLI::Option* bench = command->add_flag("--bench", options->bench,
                                         "The simulated bench of the release/catch test in place of a robot");
  command->add_option("--model", options->model, "Hopper model (TOML); without it the example's")
      ->excludes(bench);
  command->add_option("--scenario", options->scenario, "Scenario file (TOML): start, torque, sensors, faults")
      ->excludes(bench);
  command->add_option("--store", options->store, "File that keeps its parameters; without it none does")
      ->excludes(bench);
  command->add_option("--address", options->address, "IPv4 address to listen on")->capture_default_str();
  command->add_option("--tcp-port", options->port, "Port to listen on; 0: any that is not used")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the sensors' errors")->capture_default_str();
  command->add_option("--duration", options->duration_s, "Seconds until it ends; 0: until it is interrupted")
      ->check(CLI::Range(0.0, 4e6))
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
