#include "host/walk/walk_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/biped/points.hpp"
#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"
#include "host/walk/batched_rollout.hpp"
#include "host/walk/ensemble.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::walk {
namespace {

using namespace dynamics::biped;
using report::number;

constexpr std::array<const char*, 4> kPhaseNames{"start", "up", "down", "stop"};
constexpr int kTicksAFrame = 20;

/// What is drawn of a moment, and what is plotted.
struct Frame {
  double time_s;
  std::vector<Vec3<double>> points;  ///< as biped::Points has them
  std::array<double, 6> force_n;     ///< of the ground on each foot, world
  std::string phase;
  std::array<double, 2> normal_n;
  std::array<double, kLegJoints> power_w;  ///< of the left leg's motors
  std::array<double, 2> knee;              ///< the left one's angle and rate, rad, rad/s
  std::array<double, 2> pitch;             ///< the pelvis' and its rate
  double height_m;
};

Frame frame_of(const Description& robot, const WalkMoment<double>& m) {
  Frame f{};
  f.time_s = m.time_s;
  f.phase = m.walk.phase[0] == control::WalkPhase::up || m.walk.phase[0] == control::WalkPhase::down
                ? std::string(kPhaseNames[static_cast<std::size_t>(m.walk.phase[0])]) +
                      (m.walk.on_left[0] ? " on the left" : " on the right")
                : kPhaseNames[static_cast<std::size_t>(m.walk.phase[0])];
  f.height_m = m.state.position_m.z;
  std::array<double, kJoints> angle_rad{};
  for (std::size_t i = 0; i < kJoints; ++i) angle_rad[i] = joint<double>(m.state.q_rad, i);
  furcula::biped::Points points =
      furcula::biped::points_of(robot, m.state.position_m, rotation(m.state.attitude), angle_rad);
  f.points = std::move(points.all);
  for (const std::size_t side : {kLeft, kRight}) {
    const auto& wrench = m.report.foot[0].f;
    const Vec3<double> force =
        points.feet[side] * Vec3<double>{wrench.x[side], wrench.y[side], wrench.z[side]};
    f.force_n[3 * side] = force.x, f.force_n[3 * side + 1] = force.y, f.force_n[3 * side + 2] = force.z;
    f.normal_n[side] = m.report.contact.normal_n[0][side];
  }
  for (std::size_t j = 0; j < kLegJoints; ++j)
    f.power_w[j] = joint<double>(m.report.torque.motor_nm, j) * joint<double>(m.state.qd_radps, j);
  f.knee = {joint<double>(m.state.q_rad, kKnee), joint<double>(m.state.qd_radps, kKnee)};
  f.pitch = {roll_pitch_yaw(m.state.attitude).pitch_rad, m.state.w_radps.y};
  return f;
}

struct Filmed {
  std::vector<Frame> frames;
  std::array<JointEnergy, kJoints> joints;
};
Filmed film(const Model& model, const RolloutOptions& options, const walk::Parameters& walk) {
  Filmed out;
  BatchedRollout<double> rollouts(model.robot, model.robot, options);
  int tick = 0;
  rollouts.watch = [&](const WalkMoment<double>& m) {
    if (tick++ % kTicksAFrame == 0) out.frames.push_back(frame_of(model.robot, m));
  };
  rollouts.run_one(walk);
  out.joints = rollouts.joint_energy();
  return out;
}

std::string walk_data(const std::vector<Frame>& frames, bool passive) {
  nlohmann::json rows = nlohmann::json::array();
  const auto rounded = [](double v, double to) { return std::round(v * to) / to; };
  for (const Frame& f : frames) {
    nlohmann::json points = nlohmann::json::array(), force = nlohmann::json::array();
    for (const Vec3<double>& p : f.points)
      points.push_back({rounded(p.x, 1e4), rounded(p.y, 1e4), rounded(p.z, 1e4)});
    for (const double n : f.force_n) force.push_back(rounded(n, 10.0));
    rows.push_back(
        {{"time", rounded(f.time_s, 1e4)}, {"points", points}, {"force", force}, {"phase", f.phase}});
  }
  return nlohmann::json{{"passive", passive}, {"frames", rows}}.dump();
}

std::string plots(const std::vector<Frame>& frames, bool passive) {
  const auto line = [&](const char* label, const auto& value) {
    report::Line l{label, {}, {}};
    for (const Frame& f : frames) l.x.push_back(f.time_s), l.y.push_back(value(f));
    return l;
  };
  std::vector<report::Line> power;
  for (std::size_t j = kHipRoll; j < kLegJoints; ++j)
    if (!passive || j != kHipPitch)  // a passive hip's torque is its spring's
      power.push_back(
          line(report::in_words(kLegJointNames[j]).c_str(), [j](const Frame& f) { return f.power_w[j]; }));
  const auto plot = [](const char* title, std::vector<report::Line> lines) {
    return report::line_plot_html({title, "time, s", std::move(lines)});
  };
  const auto phase = [&](const char* title, const char* over, std::array<double, 2> Frame::*of) {
    report::Line l{"", {}, {}};
    for (const Frame& f : frames) l.x.push_back((f.*of)[0]), l.y.push_back((f.*of)[1]);
    return report::line_plot_html({title, over, {std::move(l)}});
  };
  return plot("Force of the ground, N", {line("left foot", [](const Frame& f) { return f.normal_n[0]; }),
                                         line("right foot", [](const Frame& f) { return f.normal_n[1]; })}) +
         plot("Power of the left leg's motors, W", std::move(power)) +
         plot("Height of the pelvis, m", {line("pelvis", [](const Frame& f) { return f.height_m; })}) +
         phase("Rate of the left knee over its angle, rad/s", "angle, rad", &Frame::knee) +
         phase("Rate of the pelvis' pitch over it, rad/s", "pitch, rad", &Frame::pitch);
}

std::string search_html(const std::vector<SearchPoint>& history) {
  report::Line objective{"objective", {}, {}}, cot{"cost of transport", {}, {}};
  for (const SearchPoint& p : history) {
    objective.x.push_back(p.cpu_s), objective.y.push_back(p.objective);
    if (std::isfinite(p.cot) && p.cot < 20.0 && p.objective < 1.0)
      cot.x.push_back(p.cpu_s), cot.y.push_back(p.cot);
  }
  return report::line_plot_html({"The best objective so far", "time of one processor, s", {objective}}) +
         report::line_plot_html({"Its cost of transport, where it walks", "time of one processor, s", {cot}});
}

std::string robustness_html(const Robustness& e) {
  report::Table table({{"Again in double"}, {"ends"}, {"m", true}, {"cost of transport", true}});
  for (const auto* trials : {&e.steps, &e.changed})
    for (const Trial& t : *trials) {
      const Rollout& r = t.rollout;
      const bool stands = r.ending == Ending::stands;
      table.add({report::escape(t.what),
                 stands ? r.over > 0.0 ? "stands, beyond a limit" : "stands"
                        : std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + " after " +
                              number(r.time_s, 3) + " s",
                 number(r.distance_m, 3), stands ? number(r.cot, 4) : std::string("&ndash;")});
    }
  return table.html() +
         report::paragraph("With sensor errors, drawn anew for each robot: " + std::to_string(e.noisy_stand) +
                           " of " + std::to_string(e.noisy) + " stand, " +
                           std::to_string(e.noisy_keep_limits) + " keep all limits.") +
         report::paragraph("Of " + std::to_string(e.drawn) +
                           " other robots, each pushed, with numbers within " +
                           number(100.0 * EnsembleOptions{}.deviations, 3) +
                           " % of the ranges of document 000, Tables I and II, it stands on " +
                           std::to_string(e.drawn_stand) + ".") +
         report::paragraph(e.map.found
                               ? "Walking on, it converges to a stride of " + number(e.map.stride_s, 3) +
                                     " s and " + number(e.map.stride_m, 3) + " m. Its cost of transport is " +
                                     number(e.map.cot, 3) +
                                     ". The largest Floquet multiplier of its return map is " +
                                     number(e.map.multipliers.front(), 3) + "."
                               : "Walking on: " + e.map.none + ".");
}

}  // namespace

std::string motors_html(const std::array<JointEnergy, kJoints>& joints, const Rollout& all) {
  report::Table table({{"Motor"}, {"copper, J", true}, {"work, J", true}, {"its positive parts, J", true}});
  const auto row = [&](const std::string& name, double copper_j, double work_j, double positive_j) {
    table.add({name, number(copper_j, 3), number(work_j, 3), number(positive_j, 3)});
  };
  for (std::size_t i = 0; i < kJoints; ++i) {
    std::string name(kLegJointNames[i % kLegJoints]);
    std::replace(name.begin(), name.end(), '_', ' ');
    row((i < kLegJoints ? "Left " : "Right ") + name, joints[i].copper_j, joints[i].work_j,
        joints[i].positive_work_j);
  }
  row("All", all.copper_j, all.work_j, all.positive_work_j);
  return table.html();
}

std::string mode_in_words(WalkMode mode) {
  switch (mode) {
    case WalkMode::semi_passive:
      return "Semi-passive";
    case WalkMode::knee_passive:
      return "Knee-passive";
    case WalkMode::knee_braked:
      return "Knee-braked";
    case WalkMode::active:
      break;
  }
  return "Active";
}

std::string render_walk_report(const Model& model, const RolloutOptions& options,
                               const walk::Parameters& walk, const Rollout& r,
                               const std::vector<SearchPoint>& history,
                               const std::optional<Robustness>& robustness, const std::string& command) {
  const auto [frames, joints] = film(model, options, walk);
  const bool stands = r.ending == Ending::stands;
  report::Table limits({{"Limit"}, {"largest", true}, {"allowed", true}, {"left"}});
  const auto limit = [&](const char* what, double most, double allowed, const char* unit) {
    limits.add({what, number(most, 3) + " " + unit, number(allowed, 3) + " " + unit,
                report::share_bar(1.0 - most / allowed)},
               most > allowed);
  };
  const WalkLimits& m = options.limits;
  limit("Torque of a motor, 10 ms low-pass", r.torque_nm, m.torque_nm, "N m");
  limit("Speed of a joint", r.speed_radps, m.speed_radps, "rad/s");
  limit("Moment of a foot, 10 ms low-pass", r.moment_nm, m.moment_nm, "N m");
  limits.add({"Capture point at the end, inside of the soles",
              number(100.0 * (kSoleMargin_m - r.outside_m), 3) + " cm",
              "at least " + number(100.0 * kSoleMargin_m, 2) + " cm", ""},
             r.outside_m > 0.0);

  const bool semi = options.mode == WalkMode::semi_passive;
  report::Page page;
  page.title = mode_in_words(options.mode) + " walk of " + model.name;
  page.command = command;
  page.walk_json = walk_data(frames, semi);
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Walk of a biped</p>\n<h1>" + report::escape(page.title) +
      "</h1>\n<p class=\"lead\">" +
      (stands ? "It starts, walks, stops and stands; " + std::to_string(r.landings) + " landings in " +
                    number(r.time_s, 3) + " s."
              : "It does not stand: it ends after " + number(r.time_s, 3) + " s (" +
                    std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + ").") +
      "</p>\n" +
      report::badge(r.keeps_limits() ? "keeps all limits"
                    : stands         ? "beyond a limit"
                                     : "falls",
                    r.keeps_limits() ? report::Tone::good : report::Tone::bad) +
      "\n</header>\n" +
      report::key_figures(
          {{"Cost of transport", number(r.cot, 4),
            "energy from the supply over weight times distance, start and stop included"},
           {"Distance", number(r.distance_m, 3) + " m", "of the centre of mass"},
           {"Energy", number(r.energy_j(), 4) + " J", "in " + number(r.time_s, 3) + " s"},
           {"Copper", number(r.copper_j, 4) + " J", "heat of the motors"},
           {"Work", number(r.work_j, 3) + " J",
            "with all braking energy recovered; its positive parts " + number(r.positive_work_j, 3) + " J"},
           {"Constant", number(r.constant_j, 4) + " J", "computer and drives"}}) +
      report::section(
          "walk", "The walk",
          report::biped_player_html("The biped as it walks") +
              report::paragraph(
                  std::string(
                      "The left leg is the darker one. Green: the ground's force, a metre for 1000 N. ") +
                  (semi ? "Orange: hips whose pitch is left to their springs. " : "") +
                  "Drag turns the view, the wheel comes nearer.")) +
      report::section("curves", "Curves", plots(frames, semi)) +
      report::section("limits", "Limits", limits.html()) +
      report::section("joints", "Energy by motor", motors_html(joints, r)) +
      (robustness ? report::section("robustness", "Robustness", robustness_html(*robustness)) : "") +
      (history.size() > 1 ? report::section("search", "The search", search_html(history)) : "");
  return report::render(page);
}

}  // namespace furcula::walk
