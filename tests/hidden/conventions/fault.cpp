// The faults, see fault.hpp.
#include "tests/hidden/conventions/fault.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

namespace furcula::hidden::conventions {
namespace {

constexpr double kPi = std::numbers::pi;

/// One joint's columns. Velocities and set points have the unit of the position.
struct Axis {
  std::string position;
  std::vector<std::string> with_position, inputs;
  bool angular = false;
  bool set_points = false;
};

bool ends_with(const std::string& text, std::string_view end) {
  return std::string_view(text).ends_with(end);
}

std::vector<Axis> axes_of(const log::Log& log) {
  std::vector<Axis> out;
  if (log.rig != "tree") {
    Axis axis;
    for (const char* name : {"angle_rad", "pulley_angle_rad", "position_m", "height_m"})
      if (log.has(name)) axis.position = name, axis.angular = ends_with(name, "_rad");
    for (const char* name : {"velocity_radps", "velocity_mps", "reference_m", "reference_rad"})
      if (log.has(name)) axis.with_position.emplace_back(name);
    for (const char* name : {"torque_nm", "torque_cmd_nm", "force_n", "force_cmd_n"})
      if (log.has(name)) axis.inputs.emplace_back(name);
    out.push_back(axis);
    return out;
  }
  const std::regex position("(angle|position)_(.+)_(rad|m)");
  for (const auto& [name, values] : log.columns) {
    std::smatch m;
    if (!std::regex_match(name, m, position) || name.find("_cmd_") != name.npos) continue;
    Axis axis{name, {}, {}, m[1] == "angle"};
    const std::string joint = m[2];
    for (const auto& [other, unused] : log.columns) {
      if (other == "velocity_" + joint + (axis.angular ? "_radps" : "_mps"))
        axis.with_position.push_back(other);
      if (other == m[1].str() + "_cmd_" + joint + "_" + m[3].str())
        axis.with_position.push_back(other), axis.set_points = true;
      for (const std::string of : {"torque_", "torque_cmd_", "force_", "force_cmd_"})
        if (other == of + joint + (of.starts_with("torque") ? "_nm" : "_n")) axis.inputs.push_back(other);
    }
    out.push_back(axis);
  }
  return out;
}

class Faults {
 public:
  Faults(const log::Log& log, const std::string& model) : log_(log), model_(model), axes_(axes_of(log)) {
    std::copy_if(axes_.begin(), axes_.end(), std::back_inserter(angular_),
                 [](const Axis& a) { return a.angular; });
    std::copy_if(axes_.begin(), axes_.end(), std::back_inserter(driven_),
                 [](const Axis& a) { return !a.inputs.empty(); });
  }

  std::vector<Fault> all() {
    out_.push_back({"none", "none", {}});
    scales();
    zeros();
    signs();
    exchanges();
    gravity();
    return out_;
  }

 private:
  using Axes = std::vector<Axis>;

  void positions(const std::string& name, const std::string& group, const Axes& axes, const Change& change,
                 std::vector<std::string> words) {
    Fault f{name, group, {}};
    for (const Axis& a : axes) {
      f.changes[a.position] = change;
      Change rate{change.scale};
      f.undone[a.position] = {1.0 / change.scale, -change.offset / change.scale};
      for (const std::string& c : a.with_position) {
        f.changes[c] = c.find("velocity") == 0 ? rate : change;
        if (c.find("_cmd_") != c.npos) f.undone[c] = f.undone[a.position];
      }
    }
    f.words = std::move(words);
    if (!axes.empty()) out_.push_back(f);
  }
  void inputs(const std::string& name, const std::string& group, const Axes& axes, double scale,
              std::vector<std::string> words) {
    Fault f{name, group, {}};
    for (const Axis& a : axes)
      for (const std::string& c : a.inputs) f.changes[c] = {scale}, f.undone[c] = {1.0 / scale};
    f.words = std::move(words);
    if (!f.changes.empty()) out_.push_back(f);
  }

  void scales() {
    Axes linear;
    std::copy_if(axes_.begin(), axes_.end(), std::back_inserter(linear),
                 [](const Axis& a) { return !a.angular; });
    const double counts = 4096 / (2 * kPi);
    positions("degrees", "scale", angular_, {180 / kPi}, {"degrees"});
    positions("turns", "scale", angular_, {0.5 / kPi}, {"turns"});
    positions("millidegrees", "scale", angular_, {180e3 / kPi}, {"millidegrees"});
    positions("counts of 4096", "scale", angular_, {counts, 0.0, true}, {"encoder counts"});
    positions("motor's side, gear 6", "scale", angular_, {6.0}, {"6"});
    positions("mm", "scale", linear, {1e3}, {"millimetres"});
    positions("cm", "scale", linear, {1e2}, {"centimetres"});
    positions("um", "scale", linear, {1e6}, {"micrometres"});
    positions("counts of 5 um", "scale", linear, {2e5, 0.0, true}, {"encoder counts"});
    positions("motor's side, gear 6", "scale", linear, {6.0}, {"6"});
    if (axes_.size() > 1)
      positions("degrees, one joint", "scale", {angular_.empty() ? Axes{} : Axes{angular_.back()}},
                {180 / kPi}, {"degrees"});
    const bool torque = !driven_.empty() && ends_with(driven_.front().inputs.front(), "_nm");
    inputs(torque ? "N mm" : "mN", "scale", driven_, 1e3, {torque ? "N mm" : "mN"});
    inputs(torque ? "kgf cm" : "kgf", "scale", driven_, torque ? 100 / 9.80665 : 1 / 9.80665, {"kgf"});
    inputs("current", "scale", driven_, torque ? 1 / 0.105 : 1 / 35.15, {"current"});
    double rated = 0.0;
    for (const Axis& a : driven_)
      for (const double x : log_.at(a.inputs.front())) rated = std::max(rated, 1.2 * std::abs(x));
    if (rated > 0.0) inputs("per mille of rated", "scale", driven_, 1000 / rated, {"per mille"});
    if (driven_.size() > 1) inputs("N mm, one joint", "scale", {driven_.back()}, 1e3, {"N mm"});
    for (const auto& [name, scale] : {std::pair{"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}) {
      Fault f{std::string("time in ") + name, "scale", {{"time_s", {scale}}}};
      f.undone["time_s"] = {1 / scale};
      f.words = {scale == 1e3 ? "milliseconds" : scale == 1e6 ? "microseconds" : "nanoseconds"};
      out_.push_back(f);
    }
  }

  void zeros() {
    if (angular_.empty() || log_.rig == "clutch_bench") return;  // a pulley's zero is anywhere
    for (const auto& [name, offset] : {std::pair{"quarter turn", kPi / 2},
                                       {"minus a quarter", -kPi / 2},
                                       {"half a turn", kPi},
                                       {"60 degrees", kPi / 3}})
      for (const bool last : {false, true}) {
        if (last && angular_.size() == 1) continue;
        const Axis& a = last ? angular_.back() : angular_.front();
        positions(std::string(name) + (angular_.size() == 1 ? ""
                                       : last               ? ", last joint"
                                                            : ", first joint"),
                  "zero", {a}, {1.0, offset}, {"the zero of " + a.position});
      }
  }

  void signs() {
    positions("position", "sign", axes_, {-1.0}, {"other sign"});
    inputs("input", "sign", driven_, -1.0, {"other sign"});
    if (axes_.size() > 1) positions("position, one joint", "sign", {axes_.back()}, {-1.0}, {"other sign"});
    if (driven_.size() > 1) inputs("input, one joint", "sign", {driven_.back()}, -1.0, {"other sign"});
  }

  void exchange(const std::string& name, const std::vector<std::pair<std::string, std::string>>& pairs) {
    Fault f{name, "exchange", {}};
    for (const auto& [a, b] : pairs)
      f.changes[a] = f.undone[a] = {1.0, 0.0, false, b}, f.changes[b] = f.undone[b] = {1.0, 0.0, false, a};
    f.words = {"exchanged"};
    out_.push_back(f);
  }
  void exchanges() {
    if (!driven_.empty())
      exchange("position and input", {{driven_.front().position, driven_.front().inputs.front()}});
    if (angular_.size() < 2) return;
    const Axis &a = angular_.front(), &b = angular_.back();
    std::vector<std::pair<std::string, std::string>> all{{a.position, b.position}};
    exchange("two joints' positions", all);
    if (a.inputs.size() != b.inputs.size() || a.inputs.empty()) return;
    std::vector<std::pair<std::string, std::string>> of_inputs;
    for (std::size_t i = 0; i < a.inputs.size(); ++i) of_inputs.emplace_back(a.inputs[i], b.inputs[i]);
    exchange("two joints' inputs", of_inputs);
  }

  void gravity() {
    std::smatch m;
    const auto replaced = [&](const std::string& name, const std::string& to, const std::string& word) {
      Fault f{name, "gravity", {}};
      f.model_from = m[0], f.model_to = to;
      f.words = {word};
      out_.push_back(f);
    };
    if (std::regex_search(model_, m, std::regex(R"(gravity_mps2 = \[([^\]]*)\])"))) {
      const std::string now = m[1];
      for (const char* to : {"9.81, 0, 0", "-9.81, 0, 0", "0, 9.81, 0", "0, -9.81, 0", "0, 0, 9.81"})
        replaced(std::string("along ") + to, std::string("gravity_mps2 = [") + to + "]",
                 "gravity_mps2 = [0, 0, -9.81]");
      return;
    }
    // A rail that stands, of which the model says that it lies.
    if (log_.rig == "rail_carriage" && std::regex_search(model_, m, std::regex(R"(gravity_mps2 = 9\.8\d*)")))
      replaced("the model's rail lies", "gravity_mps2 = 0.0", "gravity_mps2 = 9.81");
  }

  const log::Log& log_;
  const std::string& model_;
  Axes axes_, angular_, driven_;
  std::vector<Fault> out_;
};

}  // namespace

std::vector<Fault> faults_of(const log::Log& log, const std::string& model) {
  return Faults(log, model).all();
}

log::Log faulty(const log::Log& log, const Fault& fault) {
  log::Log out = log;
  for (const auto& [name, change] : fault.changes) {
    const auto& from = log.at(change.from.empty() ? name : change.from);
    auto& to = out.columns.at(name);
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = change.scale * from[i] + change.offset;
      if (change.whole) to[i] = std::round(to[i]);
    }
  }
  return out;
}

}  // namespace furcula::hidden::conventions
