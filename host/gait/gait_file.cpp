#include "host/gait/gait_file.hpp"

#include <toml++/toml.h>

#include <array>
#include <sstream>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/gait/machine_file.hpp"

namespace furcula::gait {
namespace {

using core::fail;

constexpr std::array<const char*, 3> kFreePhases{"stance", "flight_1", "flight_2"};
constexpr std::array<std::string_view, 2> kTorques{"free", "fourier"};

template <class Values>
std::string list(const char* key, const Values& values) {
  std::string out = std::string(key) + " = [";
  bool first = true;
  for (const double v : values) {
    out += (first ? "" : ", ") + core::toml_float(v);
    first = false;
  }
  return out + "]\n";
}
std::string line(const char* key, double value) {
  return std::string(key) + " = " + core::toml_float(value) + "\n";
}

/// Reads sections of numbers, each of which has to be there.
class Sections {
 public:
  Sections(const toml::table& file, const std::string& name) : file_(file), name_(name) {}

  const toml::table& section(const std::string& which, std::span<const std::string_view> keys) const {
    const toml::node* node = file_.get(which);
    if (node == nullptr) fail(name_, file_.source(), "no section [" + which + "]; expected one");
    const toml::table& table = core::table(*node, name_, "[" + which + "]");
    core::refuse_unknown_keys(table, name_, "[" + which + "]", keys);
    return table;
  }
  double number(const toml::table& table, const char* key, double low, double high) const {
    return core::number(entry(table, key), name_, key, low, high);
  }
  std::vector<double> numbers(const toml::table& table, const char* key, std::size_t least, std::size_t most,
                              double high) const {
    const toml::node& node = entry(table, key);
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() < least || array->size() > most)
      fail(name_, node.source(),
           std::string(key) + " is " +
               (array == nullptr ? core::value_text(node)
                                 : "of " + std::to_string(array->size()) + " numbers") +
               "; expected " + (least == most ? "" : "from " + std::to_string(least) + " to ") +
               std::to_string(most) + " numbers");
    std::vector<double> out;
    for (const toml::node& v : *array) out.push_back(core::number(v, name_, key, -high, high));
    return out;
  }
  const toml::node& entry(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(name_, table.source(), "no key '" + std::string(key) + "'; expected one");
    return *node;
  }

 private:
  const toml::table& file_;
  const std::string& name_;
};

template <std::size_t N>
std::size_t one_of(const toml::node& node, const std::string& name, const char* key,
                   const std::array<std::string_view, N>& names) {
  const std::string which = core::text(node, name, key);
  for (std::size_t i = 0; i < N; ++i)
    if (names[i] == which) return i;
  fail(name, node.source(),
       std::string(key) + " = " + core::quoted(which) + "; expected one of " + core::listed(names) +
           core::did_you_mean(which, names));
}

}  // namespace

std::string format_gait(const Gait& gait) {
  std::string out = "[gait]\nschema = 1\ntorque = \"" + std::string(kTorques[gait.is_fourier() ? 1 : 0]) +
                    "\"\nlift_off = \"" +
                    std::string(dynamics::kLegLiftOffNames[static_cast<std::size_t>(gait.task.lift_off)]) +
                    "\"\n";
  if (gait.task.clearance_m) out += line("clearance_m", *gait.task.clearance_m);
  if (gait.task.speed_mps) out += line("speed_mps", *gait.task.speed_mps);
  if (gait.task.friction) out += line("friction", *gait.task.friction);
  if (gait.task.touchdown_knee_rad) out += line("touchdown_knee_rad", *gait.task.touchdown_knee_rad);
  if (gait.task.landing_speed_mps > 0.0) out += line("landing_speed_mps", gait.task.landing_speed_mps);
  if (const auto* free = std::get_if<FreeGait>(&gait.motion)) {
    for (std::size_t k = 0; k < 3; ++k)
      out += "\n[" + std::string(kFreePhases[k]) + "]\n" + line("duration_s", free->phases[k].duration_s) +
             list("hip_rad", free->phases[k].hip) + list("knee_rad", free->phases[k].knee);
  } else {
    const FourierGait& g = std::get<FourierGait>(gait.motion);
    out += "\n[stance]\n" + line("omega_radps", g.law.omega_radps) + line("hip_mean_nm", g.law.hip.mean) +
           list("hip_sine_nm", g.law.hip.sine) + list("hip_cosine_nm", g.law.hip.cosine) +
           line("knee_mean_nm", g.law.knee.mean) + list("knee_sine_nm", g.law.knee.sine) +
           list("knee_cosine_nm", g.law.knee.cosine);
    out += "\n[rise]\n" + line("duration_s", g.law.rise_s) + list("hip_rad", g.law.rise_hip) +
           list("knee_rad", g.law.rise_knee);
    out += "\n[fall]\n" + line("duration_s", g.law.fall_s) + list("hip_rad", g.law.fall_hip) +
           list("knee_rad", g.law.fall_knee);
    const auto apex = g.apex;
    out += "\n[apex]\n" + line("height_m", apex.height) + line("speed_mps", apex.speed) +
           line("hip_rad", apex.angle.hip) + line("knee_rad", apex.angle.knee) +
           line("hip_radps", apex.rate.hip) + line("knee_radps", apex.rate.knee);
  }
  // The robot, as its model file says it.
  std::istringstream machine(format_machine(gait.machine));
  for (std::string text; std::getline(machine, text);) {
    if (!text.empty() && text.front() == '[') text = "[robot." + text.substr(1);
    out += (text.rfind("[robot.model]", 0) == 0 ? "\n" : "") + text + "\n";
  }
  return out;
}

Gait parse_gait(std::string_view text, const std::string& path) {
  static constexpr std::array<std::string_view, 8> kKeys{
      "schema",    "torque",   "lift_off",           "clearance_m",
      "speed_mps", "friction", "touchdown_knee_rad", "landing_speed_mps"};
  static constexpr std::array<std::string_view, 8> kSections{"gait", "stance", "flight_1", "flight_2",
                                                             "rise", "fall",   "apex",     "robot"};
  const toml::table file = core::parse_toml(text, path);
  core::refuse_unknown_keys(file, path, "a gait file", kSections);
  const Sections sections(file, path);
  const toml::table& head = sections.section("gait", kKeys);
  if (const toml::node& schema = sections.entry(head, "schema");
      !schema.is_integer() || schema.value<std::int64_t>() != 1)
    fail(path, schema.source(), "schema = " + core::value_text(schema) + "; expected 1");
  Gait gait;
  const bool fourier = one_of(sections.entry(head, "torque"), path, "torque", kTorques) == 1;
  gait.task.lift_off = static_cast<LegLiftOff>(
      one_of(sections.entry(head, "lift_off"), path, "lift_off", dynamics::kLegLiftOffNames));
  const auto optional = [&](const char* key, double low, double high, std::optional<double>& value) {
    if (head.contains(key)) value = sections.number(head, key, low, high);
  };
  optional("clearance_m", 0.0, 100.0, gait.task.clearance_m);
  optional("speed_mps", -100.0, 100.0, gait.task.speed_mps);
  optional("friction", 0.0, 100.0, gait.task.friction);
  optional("touchdown_knee_rad", 0.0, 4.0, gait.task.touchdown_knee_rad);
  if (head.contains("landing_speed_mps"))
    gait.task.landing_speed_mps = sections.number(head, "landing_speed_mps", 0.0, 100.0);
  if (gait.task.clearance_m.has_value() == gait.task.speed_mps.has_value())
    fail(path, head.source(), "expected one of clearance_m and speed_mps in [gait]");

  if (fourier) {
    static constexpr std::array<std::string_view, 7> kStance{"omega_radps",   "hip_mean_nm",  "hip_sine_nm",
                                                             "hip_cosine_nm", "knee_mean_nm", "knee_sine_nm",
                                                             "knee_cosine_nm"};
    static constexpr std::array<std::string_view, 3> kFlight{"duration_s", "hip_rad", "knee_rad"};
    static constexpr std::array<std::string_view, 6> kApex{"height_m", "speed_mps", "hip_rad",
                                                           "knee_rad", "hip_radps", "knee_radps"};
    FourierGait g;
    const auto fill = [&](const toml::table& t, const char* key, auto& to) {
      const std::vector<double> values = sections.numbers(t, key, to.size(), to.size(), 1e6);
      std::copy(values.begin(), values.end(), to.begin());
    };
    const toml::table& stance = sections.section("stance", kStance);
    g.law.omega_radps = sections.number(stance, "omega_radps", 0.1, 1000.0);
    g.law.hip.mean = sections.number(stance, "hip_mean_nm", -1e6, 1e6);
    fill(stance, "hip_sine_nm", g.law.hip.sine);
    fill(stance, "hip_cosine_nm", g.law.hip.cosine);
    g.law.knee.mean = sections.number(stance, "knee_mean_nm", -1e6, 1e6);
    fill(stance, "knee_sine_nm", g.law.knee.sine);
    fill(stance, "knee_cosine_nm", g.law.knee.cosine);
    for (const bool rises : {true, false}) {
      const toml::table& t = sections.section(rises ? "rise" : "fall", kFlight);
      (rises ? g.law.rise_s : g.law.fall_s) = sections.number(t, "duration_s", 1e-3, 10.0);
      fill(t, "hip_rad", rises ? g.law.rise_hip : g.law.fall_hip);
      fill(t, "knee_rad", rises ? g.law.rise_knee : g.law.fall_knee);
    }
    const toml::table& apex = sections.section("apex", kApex);
    g.apex = {
        sections.number(apex, "height_m", 0.0, 100.0),
        sections.number(apex, "speed_mps", -100.0, 100.0),
        {sections.number(apex, "hip_rad", -10.0, 10.0), sections.number(apex, "knee_rad", -10.0, 10.0)},
        {sections.number(apex, "hip_radps", -1e3, 1e3), sections.number(apex, "knee_radps", -1e3, 1e3)}};
    gait.motion = g;
  } else {
    static constexpr std::array<std::string_view, 3> kPhase{"duration_s", "hip_rad", "knee_rad"};
    FreeGait g;
    for (std::size_t k = 0; k < 3; ++k) {
      const toml::table& t = sections.section(kFreePhases[k], kPhase);
      JointPath& p = g.phases[k];
      p.duration_s = sections.number(t, "duration_s", 1e-3, 10.0);
      p.hip = sections.numbers(t, "hip_rad", Spline::kDegree + 1, 500, 100.0);
      p.knee = sections.numbers(t, "knee_rad", p.hip.size(), p.hip.size(), 100.0);
    }
    gait.motion = g;
  }
  const toml::node* robot = file.get("robot");
  if (robot == nullptr)
    fail(path, file.source(), "no section [robot]; expected the robot that the gait is of");
  std::ostringstream own;
  own << core::table(*robot, path, "[robot]");
  gait.machine = parse_machine(own.str(), path);
  return gait;
}

Gait read_gait(const std::string& path) {
  return parse_gait(core::read_small_file(path, "a gait file (TOML)"), path);
}

void require_same_robot(const Gait& gait, const Machine& machine, const std::string& path) {
  for (const auto keys : {parameter_keys(), motor_keys()})
    for (const MachineKey& k : keys) {
      // The rest angle is that of one spring alone, and limits are the supply's.
      if (k.name == "rest_angle_rad" || !k.needed) continue;
      if (k.value(gait.machine) != k.value(machine))
        throw core::DataError(
            core::printable(path) + ": the gait is of another robot: " + std::string(k.name) + " = " +
            core::shortest(k.value(gait.machine)) + " there, " + core::shortest(k.value(machine)) + " in " +
            core::printable(machine.file) + "; expected a gait of the same robot");
    }
}

}  // namespace furcula::gait
