// A board over Modbus or CAN, see bus_board.hpp.
#include "host/bench/bus_board.hpp"

#include <chrono>
#include <thread>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/modbus/monitor.hpp"

namespace furcula::bench {
namespace {

using namespace std::chrono_literals;

float value(const std::vector<float>& parameters, std::string_view name) {
  return parameters[bus::parameter_named(name)->number - 1u];
}

}  // namespace

BusBoard::BusBoard(const modbus::Port& port, int pulley_teeth, std::function<void(const Conditions&)> hang)
    : BusBoard(port.text, modbus::Client(port), pulley_teeth, std::move(hang)) {}

BusBoard::BusBoard(std::string name, modbus::Client client, int pulley_teeth,
                   std::function<void(const Conditions&)> hang)
    : name_(std::move(name)), client_(std::move(client)), hang_(std::move(hang)) {
  const std::vector<float> p = client_.parameters();
  if (value(p, "on_bench") != 1.0f)
    throw core::DataError(name_ +
                          ": the board is not on a bench: its parameter on_bench is 0 (furcula param " +
                          "set on_bench 1 --port " + name_ + ")");
  metres_per_count_ = static_cast<double>(value(p, "cable_metres_per_count"));
  tooth_pitch_m_ = static_cast<double>(value(p, "tooth_pitch_m"));
  travel_m_ = static_cast<double>(value(p, "cable_travel_max_m"));
  pulley_radius_m_ = pulley_teeth * tooth_pitch_m_ / (2.0 * 3.14159265358979323846);
}

void BusBoard::set_window(std::size_t window_ms) {
  const bus::Parameter& p = *bus::parameter_named("bench_window_ms");
  const auto wanted = static_cast<float>(window_ms);
  if (!bus::allows(p, wanted))
    throw core::DataError(name_ + ": a window of " + std::to_string(window_ms) + " ms; this board makes " +
                          core::rounded(static_cast<double>(p.least)) + " to " +
                          core::rounded(static_cast<double>(p.most)));
  client_.write(p, wanted);
}

void BusBoard::wait_for_end(std::size_t rows) {
  // A serial line may take a second for each look at it.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(2 * rows) + 30s;
  for (;;) {
    const bus::Snapshot s = client_.snapshot();
    if (s.reason == static_cast<int>(bus::Reason::trial_ended)) return;
    if (s.state != static_cast<int>(bus::NodeState::running))
      throw core::DataError(name_ + ": the trial did not come to its end: " + modbus::reason_text(s));
    if (std::chrono::steady_clock::now() > deadline)
      throw core::DataError(name_ + ": the trial does not come to its end");
    std::this_thread::sleep_for(20ms);
  }
}

std::vector<Reading> BusBoard::run(const Conditions& conditions, const Timing& timing) {
  hang_(conditions);
  modbus::Trial trial;
  try {
    set_window(timing.window);
    client_.request(bus::Request::home);
    const std::uint16_t before = client_.trial_number();
    client_.request(bus::Request::arm);
    client_.request(bus::Request::hop);
    wait_for_end(timing.rows());
    trial = client_.trial();
    if (trial.number != static_cast<std::uint16_t>(before + 1))
      throw core::DataError(name_ + ": trial " + std::to_string(trial.number) + " was read; expected trial " +
                            std::to_string(before + 1) + " (does another program talk to the board?)");
  } catch (const modbus::Refused& e) {
    throw core::DataError(name_ + ": " + e.what() + " " + modbus::reason_text(client_.snapshot()));
  }
  std::vector<Reading> rows;
  rows.reserve(trial.rows.size());
  for (const modbus::Trial::Row& row : trial.rows)
    rows.push_back({.count = row.count,
                    .voltage_v = std::numeric_limits<double>::quiet_NaN(),  // not measured
                    .coil = row.coil_percent / 100.0});
  return rows;
}

}  // namespace furcula::bench
