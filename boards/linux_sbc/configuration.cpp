// Reading furculad's files, see configuration.hpp.
#include "boards/linux_sbc/configuration.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include "furcula/bus/motors.hpp"
#include "furcula/bus/parameters.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/modbus/tcp_server.hpp"
#include "host/walk/walk_toml.hpp"
#include "host/walk/walker_config.hpp"

namespace furcula::linux_sbc {
namespace {

/// One key of a section: how its value is taken.
using Take = std::function<void(const toml::node&, const std::string& key)>;

/// The keys of a section; those that are there are taken, others refused, and missing ones that must be there
/// named.
class Section {
 public:
  Section(const toml::table& file, std::string name, std::string title)
      : table_(file[title].as_table()), name_(std::move(name)), title_(std::move(title)) {
    if (file.contains(title_)) table_ = &core::table(*file.get(title_), name_, title_);
  }

  bool is_there() const { return table_ != nullptr; }

  void whole(const std::string& key, int least, int most, const std::function<void(int)>& put) {
    keys_[key] = [=, this](const toml::node& node, const std::string& k) {
      const double value = core::number(node, name_, k, least, most);
      if (value != std::floor(value))
        core::fail(name_, node.source(), k + " = " + core::value_text(node) + "; expected a whole number");
      put(static_cast<int>(value));
    };
  }
  void real(const std::string& key, double least, double most, const char* unit, float& out) {
    keys_[key] = [=, this, &out](const toml::node& node, const std::string& k) {
      out = static_cast<float>(core::number(node, name_, k, least, most, unit));
    };
  }
  /// Of an encoder: what a 32-bit counter can read, with a sign or without.
  void count(const std::string& key, std::uint32_t& out) {
    keys_[key] = [this, &out](const toml::node& node, const std::string& k) {
      const double value = core::number(node, name_, k, -2147483648.0, 4294967295.0);
      if (value != std::floor(value))
        core::fail(name_, node.source(), k + " = " + core::value_text(node) + "; expected a whole number");
      out = static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
    };
  }
  void text(const std::string& key, std::string& out) {
    keys_[key] = [this, &out](const toml::node& node, const std::string& k) {
      out = core::text(node, name_, k);
      if (out.empty()) core::fail(name_, node.source(), k + " is empty");
    };
  }
  void flag(const std::string& key, bool& out) {
    keys_[key] = [this, &out](const toml::node& node, const std::string& k) {
      if (!node.is_boolean())
        core::fail(name_, node.source(), k + " is " + core::value_text(node) + "; expected true or false");
      out = *node.value<bool>();
    };
  }
  void any(const std::string& key, Take take) { keys_[key] = std::move(take); }

  /// `needed`: keys that must be there, if the section is.
  void read(std::initializer_list<const char*> needed = {}) {
    if (table_ == nullptr) return;
    std::vector<std::string_view> known;
    for (const auto& [key, take] : keys_) known.push_back(key);
    core::refuse_unknown_keys(*table_, name_, "[" + title_ + "]", known);
    for (const char* key : needed)
      if (!table_->contains(key))
        core::fail(name_, table_->source(), "[" + title_ + "] has no key " + core::quoted(key));
    for (const auto& [key, take] : keys_)
      if (const toml::node* node = table_->get(key)) take(*node, title_ + "." + key);
  }

 private:
  const toml::table* table_;
  std::string name_, title_;
  std::map<std::string, Take> keys_;
};

void take_line(Section& section, GpioLine& line) {
  section.text("chip", line.chip);
  section.text("line", line.line);
  section.flag("active_low", line.active_low);
  section.read({"chip", "line"});
}

/// The controller's parameters, by the names of their table.
void take_parameters(const toml::table& table, const std::string& name, control::Config& config) {
  std::vector<std::string_view> names;
  for (const bus::Parameter& p : bus::kParameters) names.push_back(p.name);
  core::refuse_unknown_keys(table, name, "[parameters]", names);
  for (const bus::Parameter& p : bus::kParameters) {
    const toml::node* node = table.get(p.name);
    if (node == nullptr) continue;
    const std::string key(p.name);
    // Judged as the float that it becomes: a bound is one too.
    const auto value = static_cast<float>(core::number(*node, name, key, -1e9, 1e9, p.unit));
    if (!bus::allows(p, value))
      core::fail(name, node->source(),
                 key + " = " + core::value_text(*node) + "; expected a " + (p.whole ? "whole " : "") +
                     "number from " + core::rounded(static_cast<double>(p.least)) + " to " +
                     core::rounded(static_cast<double>(p.most)) +
                     (p.unit.empty() ? "" : " " + std::string(p.unit)));
    p.put(config, value);
  }
  if (!control::fits(config.envelope, config.torque, config.limits.torque_nm))
    core::fail(name, table.source(),
               "[parameters] torque_amplitude_nm = " +
                   core::rounded(static_cast<double>(config.torque.amplitude_nm)) +
                   " takes the robot higher or faster than it may; expected at most " +
                   core::rounded(
                       static_cast<double>(control::amplitude_max_nm(config.envelope, config.torque.shape))) +
                   " N m with this torque_shape, or such a torque_limit_nm");
  if (control::check(config) != Status::ok)
    core::fail(
        name, table.source(),
        "[parameters] make no sense together (as a clutch whose tooth_play_m is more than its tooth_pitch_m)");
}

void take_node(Section& section, const char* key, int least, std::uint8_t& out) {
  section.whole(key, least, bus::kLastNode, [&out](int n) { out = static_cast<std::uint8_t>(n); });
}

void take_loop(const toml::table& file, const std::string& name, int& priority) {
  Section loop(file, name, "loop");
  loop.whole("priority", 0, 99, [&priority](int given) { priority = given; });
  loop.read();
}

/// Whether it is a walker's file; a hopper's has no such key, or says so.
bool is_walker(const toml::table& file, const std::string& name) {
  static constexpr std::array<std::string_view, 2> kRobots{"hopper", "biped_walker"};
  const toml::node* node = file.get("robot");
  if (node == nullptr) return false;
  const std::string robot = core::text(*node, name, "robot");
  if (std::find(kRobots.begin(), kRobots.end(), robot) == kRobots.end())
    core::fail(name, node->source(),
               "robot = " + core::quoted(robot) + "; expected one of " + core::listed(kRobots) +
                   core::did_you_mean(robot, kRobots));
  return robot == kRobots[1];
}

Configuration parse_walker(const toml::table& file, const std::string& name) {
  static constexpr std::string_view kSections[] = {"robot", "can", "walk", "feet", "log", "loop"};
  core::refuse_unknown_keys(file, name, "the file of a biped_walker", kSections);
  Configuration c;
  WalkerConfiguration& w = c.walker.emplace();

  static constexpr std::array<const char*, kMostBuses> kBuses{"left", "right", "body"};
  Section can(file, name, "can");
  if (!can.is_there())
    throw core::DataError(name + ": no section [can]; expected the interfaces left, right and body");
  for (std::size_t i = 0; i < kMostBuses; ++i) can.text(kBuses[i], w.can_interfaces[i]);
  take_node(can, "own_node", bus::kFirstNode, w.link.self_node);
  take_node(can, "body_node", bus::kFirstNode, w.link.body_node);
  can.real("temperature_max_c", 1.0, 127.0, "degC", w.link.temperature_max_c);
  can.read({"left", "right", "body"});
  for (std::size_t i = 0; i < kMostBuses; ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (w.can_interfaces[i] == w.can_interfaces[k])
        core::fail(name, file.get_as<toml::table>("can")->get(kBuses[i])->source(),
                   std::string("can.") + kBuses[i] + " = " + core::quoted(w.can_interfaces[i]) + " as can." +
                       kBuses[k] + "; expected another interface: one bus does not hold both");

  Section walk(file, name, "walk");
  if (!walk.is_there()) throw core::DataError(name + ": no section [walk]; expected its file, a walk.toml");
  walk.text("file", w.walk_file);
  walk.read({"file"});

  Section feet(file, name, "feet");
  float threshold_n = static_cast<float>(w.foot_threshold_n);
  feet.real("threshold_n", 1.0, 400.0, "N", threshold_n);
  feet.read();
  w.foot_threshold_n = static_cast<double>(threshold_n);

  Section log(file, name, "log");
  log.text("folder", w.log_folder);
  log.any("rate_hz", [&](const toml::node& n, const std::string& key) {
    const double rate_hz = core::number(n, name, key, 1.0, 1000.0, "Hz");
    if (std::fmod(1000.0, rate_hz) != 0.0)
      core::fail(name, n.source(),
                 key + " = " + core::value_text(n) +
                     "; expected 1000, the controller's rate, or a whole part of it");
    w.log_rate_hz = static_cast<int>(std::lround(rate_hz));
  });
  if (log.is_there()) log.read({"folder"});

  take_loop(file, name, c.priority);
  return c;
}

/// The walk that a walker's file names.
void read_walk_of(WalkerConfiguration& walker, const std::string& path) {
  namespace biped = dynamics::biped;
  const std::string file = (std::filesystem::path(path).parent_path() / walker.walk_file).string();
  const walk::Walk found = walk::read_walk(file);
  if (found.robot != biped::kDesignName)
    throw core::DataError(file + ": a walk of " + core::quoted(found.robot) + "; expected one of " +
                          core::quoted(biped::kDesignName) + ", the robot that furculad walks");
  if (found.mode != walk::WalkMode::active && found.mode != walk::WalkMode::semi_passive)
    throw core::DataError(
        file + ": mode = " + core::quoted(walk::kModeNames[static_cast<std::size_t>(found.mode)]) +
        "; expected \"active\" or \"semi_passive\": furculad switches no clutch during a walk");
  walker.controller =
      walk::walker_config(biped::design(), found, walker.foot_threshold_n, walk::DriveTurns::over_buses);
  if (control::check(walker.controller) != Status::ok)
    throw core::DataError(file + ": numbers that make no walk");
}

}  // namespace

Configuration parse_configuration(std::string_view text, const std::string& name) {
  const toml::table file = core::parse_toml(text, name);
  if (is_walker(file, name)) return parse_walker(file, name);
  static constexpr std::string_view kSections[] = {"robot", "can",     "leg",       "height",
                                                   "cable", "contact", "solenoid",  "modbus",
                                                   "loop",  "store",   "parameters"};
  core::refuse_unknown_keys(file, name, "the file", kSections);
  Configuration c;

  Section can(file, name, "can");
  can.text("interface", c.can_interface);
  take_node(can, "drive_node", bus::kFirstNode, c.link.drive_node);
  take_node(can, "height_encoder_node", bus::kFirstNode, c.link.height_node);
  take_node(can, "cable_encoder_node", 0, c.link.cable_node);
  take_node(can, "supply_node", 0, c.link.supply_node);
  take_node(can, "own_node", bus::kFirstNode, c.link.self_node);
  can.real("supply_max_v", 1.0, 600.0, "V", c.link.supply_max_v);
  can.real("temperature_max_c", 1.0, 127.0, "degC", c.link.temperature_max_c);
  can.any("motor", [&](const toml::node& n, const std::string& key) {
    const std::string wanted = core::text(n, name, key);
    std::vector<std::string_view> motors;
    for (const bus::MotorInfo& m : bus::kMotors) {
      motors.push_back(m.name);
      if (m.name == wanted) {
        c.link.motor = m.motor;
        return;
      }
    }
    core::fail(name, n.source(),
               key + " = " + core::quoted(wanted) + "; expected one of " + core::listed(motors) +
                   core::did_you_mean(wanted, motors));
  });
  if (!can.is_there()) throw core::DataError(name + ": no section [can]");
  can.read({"interface", "motor"});

  Section leg(file, name, "leg");
  leg.real("zero_rad", -3.2, 3.2, "rad", c.link.leg_zero_rad);
  leg.real("gear", 0.01, 100.0, "", c.link.gear);
  bool reversed = false;
  leg.flag("reversed", reversed);
  leg.read();
  c.link.leg_sign = reversed ? -1.0f : 1.0f;

  Section height(file, name, "height");
  height.count("home_count", c.home_count);
  height.real("home_m", 0.0, 5.0, "m", c.home_height_m);
  height.read({"home_count", "home_m"});
  Section cable(file, name, "cable");
  cable.count("home_count", c.cable_home_count);
  cable.read({"home_count"});

  Section contact(file, name, "contact");
  if (!contact.is_there())
    throw core::DataError(name + ": no section [contact]; expected chip and line of the switch");
  take_line(contact, c.contact);
  Section solenoid(file, name, "solenoid");
  c.has_solenoid = solenoid.is_there();
  take_line(solenoid, c.solenoid);

  Section modbus(file, name, "modbus");
  modbus.flag("on", c.modbus);
  modbus.text("address", c.modbus_address);
  modbus.whole("port", 1, 65535, [&c](int port) { c.modbus_port = port; });
  modbus.read();

  take_loop(file, name, c.priority);

  Section store(file, name, "store");
  store.text("file", c.store_file);
  store.read({"file"});

  // Sensors on a bus are older than those that the board reads itself.
  c.controller.supervisor.sample_age_max_us = firmware::kCanSampleAgeMaxUs;
  if (const toml::node* parameters = file.get("parameters"))
    take_parameters(core::table(*parameters, name, "parameters"), name, c.controller);

  if (firmware::check(c.link) != Status::ok)
    throw core::DataError(name + ": [can] two encoders with one node id; expected different ones");
  return c;
}

std::string network_warning(const Configuration& configuration) {
  return configuration.modbus && !configuration.walker ? modbus::network_warning(configuration.modbus_address)
                                                       : "";
}

Configuration read_configuration(const std::string& path) {
  Configuration c = parse_configuration(core::read_small_file(path, "a configuration file"), path);
  if (c.walker) {
    read_walk_of(*c.walker, path);
    std::string& folder = c.walker->log_folder;
    if (!folder.empty()) folder = (std::filesystem::path(path).parent_path() / folder).string();
  }
  return c;
}

}  // namespace furcula::linux_sbc
