// `furcula param`: a robot's parameters.
#include <charconv>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/robot.hpp"
#include "host/core/message.hpp"

namespace furcula::cli {
namespace {

struct ParamOptions {
  RobotOptions robot;
  std::string name, value;
  bool json = false;
};

const bus::Parameter& parameter(const std::string& name) {
  if (const bus::Parameter* p = bus::parameter_named(name)) return *p;
  std::vector<std::string_view> names;
  for (const bus::Parameter& p : bus::kParameters) names.push_back(p.name);
  throw UsageError("no parameter " + core::quoted(name) + core::did_you_mean(name, names) +
                   "; furcula param list shows them");
}

/// In decimal, as short as it reads back to the same float.
std::string text(float value) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end};
}

float number(const bus::Parameter& p, const std::string& value) {
  float x = 0.0f;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), x);
  const bool read = error == std::errc{} && end == value.data() + value.size();
  if (read && bus::allows(p, x)) return x;
  throw UsageError(std::string(p.name) + " cannot be " + core::quoted(value) + "; expected " +
                   (p.whole ? "a whole number" : "a number") + " from " + text(p.least) + " to " +
                   text(p.most) + (p.unit.empty() ? "" : " " + std::string(p.unit)));
}

void list(const ParamOptions& options) {
  const std::vector<float> values = connect(options.robot).parameters();
  if (options.json) {
    nlohmann::ordered_json out;
    for (std::size_t i = 0; i < values.size(); ++i)
      out[std::string(bus::kParameters[i].name)] = static_cast<double>(values[i]);
    std::cout << out.dump(2) << "\n";
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bus::Parameter& p = bus::kParameters[i];
    char line[200];
    std::snprintf(line, sizeof line, "%-26s %12s %-10s %s to %s", std::string(p.name).c_str(),
                  text(values[i]).c_str(), std::string(p.unit).c_str(), text(p.least).c_str(),
                  text(p.most).c_str());
    std::cout << line << "  " << p.meaning << "\n";
  }
}

void get(const ParamOptions& options) {
  const bus::Parameter& p = parameter(options.name);
  std::cout << text(connect(options.robot).parameters()[p.number - 1u]) << "\n";
}

void set(const ParamOptions& options) {
  const bus::Parameter& p = parameter(options.name);
  const float value = number(p, options.value);
  connect(options.robot).write(p, value);
}

void save(const ParamOptions& options) { connect(options.robot).request(bus::Request::save); }

}  // namespace

void add_param_command(CLI::App& app) {
  const auto options = std::make_shared<ParamOptions>();
  CLI::App* group = app.add_subcommand("param", "A robot's parameters: list, get, set, save");
  group->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, auto run) {
    CLI::App* command = group->add_subcommand(name, what);
    add_robot_options(*command, options->robot);
    command->callback(guarded([options, run] { run(*options); }));
    return command;
  };
  add("list", "Print all parameters with their bounds", list)
      ->add_flag("--json", options->json, "Names and values as JSON");
  add("get", "Print one parameter", get)->add_option("NAME", options->name, "Its name")->required();
  CLI::App* setting = add("set", "Write one parameter; not while it is armed or runs", set);
  setting->add_option("NAME", options->name, "Its name")->required();
  setting->add_option("VALUE", options->value, "A number within its bounds")->required();
  add("save", "Keep the parameters over a restart", save);
}

}  // namespace furcula::cli
