// A board on the clutch's bench that answers to Modbus, or over CAN: it makes the trial by itself and keeps a
// reading every millisecond, which is read when the trial is over. A person hangs the weight.
#pragma once

#include <functional>
#include <string>

#include "host/bench/board.hpp"
#include "host/modbus/client.hpp"

namespace furcula::bench {

class BusBoard final : public Board {
 public:
  /// `hang`: called before each trial; it returns when the load hangs at rest at the top of its way.
  /// @throws core::DataError where nothing answers, or the board is not on a bench.
  BusBoard(const modbus::Port& port, int pulley_teeth, std::function<void(const Conditions&)> hang);
  /// `name` is for messages.
  BusBoard(std::string name, modbus::Client client, int pulley_teeth,
           std::function<void(const Conditions&)> hang);

  std::string name() const override { return name_; }
  Adjusts adjusts() const override { return Adjusts::window; }
  double metres_per_count() const override { return metres_per_count_; }
  double pulley_radius_m() const override { return pulley_radius_m_; }
  double tooth_pitch_m() const override { return tooth_pitch_m_; }
  double travel_m() const override { return travel_m_; }
  std::vector<Reading> run(const Conditions& conditions, const Timing& timing) override;

 private:
  void set_window(std::size_t window_ms);
  void wait_for_end(std::size_t rows);

  std::string name_;
  modbus::Client client_;
  std::function<void(const Conditions&)> hang_;
  double metres_per_count_ = 0.0, pulley_radius_m_ = 0.0, tooth_pitch_m_ = 0.0, travel_m_ = 0.0;
};

}  // namespace furcula::bench
