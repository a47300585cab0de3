// See robot_picture.hpp.
#include "host/report/robot_picture.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/linear/linear.hpp"
#include "host/report/html.hpp"

namespace furcula::report {
namespace {

using dynamics::tree::Frame;
using dynamics::tree::Mat3;
using dynamics::tree::Vec3;
using nlohmann::json;
using trees::Diagnosis;
using trees::LocationType;

json numbers(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
/// By rows, from the frame's coordinates to those of its parent.
json turn_back(const Mat3<double>& m) {
  return {m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y, m.x.z, m.y.z, m.z.z};
}

/// "1 dry friction" of each finding that sits there; empty: none.
std::string blamed(const Diagnosis& d, LocationType location_type, std::size_t site) {
  std::string out;
  for (std::size_t k = 0; k < d.findings.size(); ++k) {
    const trees::Cause& c = d.findings[k].cause;
    const trees::EffectInfo& e = trees::info(c.effect);
    // Joints, their drives and their encoders are one place of the picture.
    const auto place = [](LocationType of) { return trees::is_of_joints(of) ? LocationType::joint : of; };
    const bool here = place(e.location_type) == place(location_type) &&
                      std::find(c.sites.begin(), c.sites.end(), site) != c.sites.end();
    if (here)
      out += (out.empty() ? trees::site_name(d.model, location_type, site) + ": " : "; ") +
             std::to_string(k + 1) + " " + in_words(e.name);
  }
  return out;
}

/// The box of even density with the mass and the inertia of a link, in the link frame of the joint that moves it.
json box_of(const Diagnosis& d, std::size_t link) {
  const model::RobotTree::Link& at = d.model.robot.links[link];
  const model::UrdfInertia& inertia = *d.model.urdf.links[link].inertia;
  const auto& s = inertia.about_centre_kgm2;
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const linear::Axes3 principal = linear::axes_of_three(m);
  Eigen::Matrix3d axes = principal.vectors;
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  const Eigen::Vector3d& i = principal.values;
  json half = json::array();
  // I1 = m (b^2 + c^2) / 12 with the edges a, b, c, and so on.
  for (int k = 0; k < 3; ++k)
    half.push_back(0.5 * std::sqrt(std::max(0.0, 6.0 * (i.sum() - 2.0 * i(k)) / inertia.mass_kg)));
  const Mat3<double> turn{{axes(0, 0), axes(1, 0), axes(2, 0)},
                          {axes(0, 1), axes(1, 1), axes(2, 1)},
                          {axes(0, 2), axes(1, 2), axes(2, 2)}};
  const Frame<double> frame = within(within(at.frame, inertia.frame), Frame<double>{turn, {0.0, 0.0, 0.0}});
  return {{"joint", at.joint},
          {"turn", turn_back(frame.turn)},
          {"at", numbers(frame.at)},
          {"half", half},
          {"guilty", blamed(d, LocationType::link, link)}};
}

/// Lines from each body's origin to what hangs on it: next joints, links that are fixed to it; else to its centre of mass.
json bones(const Diagnosis& d) {
  const model::RobotTree& robot = d.model.robot;
  json out = json::array();
  for (int joint = -1; joint < static_cast<int>(robot.joints.size()); ++joint) {
    std::vector<Vec3<double>> ends;
    for (std::size_t k = 0; k < robot.joints.size(); ++k)
      if (robot.model.shape().parent(k) == joint) ends.push_back(robot.joints[k].placement.at);
    bool guilty = false;
    for (std::size_t k = 0; k < robot.links.size(); ++k) {
      if (robot.links[k].joint != joint) continue;
      guilty |= joint >= 0 && !blamed(d, LocationType::link, k).empty();
      if (joint >= 0) ends.push_back(robot.links[k].frame.at);
    }
    const auto far = [](const Vec3<double>& v) { return dot(v, v) > 1e-8; };
    if (joint >= 0 && std::none_of(ends.begin(), ends.end(), far)) {
      const auto body = robot.model.body(static_cast<std::size_t>(joint));
      if (body.mass_kg != 0.0) ends = {body.moment_kgm * (1.0 / body.mass_kg)};
    }
    for (const Vec3<double>& end : ends)
      if (far(end))
        out.push_back(
            {{"joint", joint}, {"from", {0.0, 0.0, 0.0}}, {"to", numbers(end)}, {"guilty", guilty}});
  }
  return out;
}

/// At most so many numbers in all motions together.
constexpr std::size_t kMostMotionNumbers = 80000;

json motions(const Diagnosis& d) {
  std::size_t numbers_in_all = 0;
  for (const trees::Motion& m : d.motions) numbers_in_all += 2 * m.time_s.size() * d.model.joints();
  const std::size_t stride = 1 + numbers_in_all / kMostMotionNumbers;
  const auto rounded = [](double v) { return std::isfinite(v) ? json(std::round(v * 1e5) / 1e5) : json(); };
  json out = json::array();
  for (const trees::Motion& m : d.motions) {
    const auto thinned = [&](const std::vector<double>& column) {
      json values = json::array();
      for (std::size_t i = 0; i < column.size(); i += stride) values.push_back(rounded(column[i]));
      return values;
    };
    const auto all = [&](const std::vector<std::vector<double>>& columns) {
      json list = json::array();
      for (const auto& column : columns) list.push_back(thinned(column));
      return list;
    };
    if (m.time_s.size() < 2 || m.measured.size() != d.model.joints() ||
        m.simulated.size() != d.model.joints())
      continue;
    out.push_back({{"log", m.log},
                   {"time", thinned(m.time_s)},
                   {"measured", all(m.measured)},
                   {"simulated", all(m.simulated)}});
  }
  return out;
}

json robot_data(const Diagnosis& d) {
  const model::RobotTree& robot = d.model.robot;
  json joints = json::array(), boxes = json::array(), loads = json::array();
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const model::RobotTree::Joint& j = robot.joints[i];
    joints.push_back({{"name", j.name},
                      {"parent", robot.model.shape().parent(i)},
                      {"slides", d.model.prismatic(i)},
                      {"turn", turn_back(j.placement.turn)},
                      {"at", numbers(j.placement.at)},
                      {"axis", numbers(j.axis)},
                      {"guilty", blamed(d, LocationType::joint, i)}});
  }
  for (const std::size_t i : trees::sites(d.model, LocationType::link)) boxes.push_back(box_of(d, i));
  for (const trees::Cause& c : d.extended.causes)
    for (const std::size_t site : c.sites)
      if (c.effect == trees::Effect::payload)
        loads.push_back({{"joint", robot.links[site].joint},
                         {"at", numbers(robot.links[site].frame.point_back(
                                    Vec3<double>{c.values[1], c.values[2], c.values[3]}))}});
  return {{"joints", joints},
          {"boxes", boxes},
          {"bones", bones(d)},
          {"loads", loads},
          {"motions", motions(d)},
          {"base", blamed(d, LocationType::base, 0)},
          {"rest", std::vector<double>(robot.joints.size(), 0.0)}};
}

std::string robot_html(const Diagnosis& d, const json& robot) {
  const bool moves = !robot["motions"].empty();
  std::string out = "<div class=\"legend\">";
  if (moves)
    out +=
        "<span class=\"key measured-key\">measured</span><span class=\"key simulated-key\">simulated, extended model</span>";
  if (!d.findings.empty())
    out += "<span class=\"key before-key\">location of a cause, with its number below</span>";
  if (!robot["loads"].empty()) out += "<span class=\"key load-key\">payload</span>";
  out +=
      "</div>\n<div class=\"robot\"><canvas id=\"robot-canvas\" tabindex=\"0\" role=\"img\" aria-label=\"The robot, "
      "measured and simulated pose. Arrow keys turn it, plus and minus zoom, space plays.\"></canvas></div>\n";
  if (moves)
    out +=
        "<div class=\"player\"><button type=\"button\" id=\"robot-play\">Play</button>"
        "<input type=\"range\" id=\"robot-slider\" aria-label=\"time\"><output id=\"robot-time\"></output>"
        "<label>Speed <select id=\"robot-speed\"><option value=\"0.1\">0.1</option><option value=\"0.25\">0.25</option>"
        "<option value=\"0.5\">0.5</option><option value=\"1\" selected>1</option><option value=\"2\">2</option>"
        "<option value=\"5\">5</option></select></label></div>\n";
  out += "<div class=\"player\">";
  if (moves)
    out +=
        "<label id=\"robot-log-label\">Recording <select id=\"robot-log\"></select></label>"
        "<label>Show <select id=\"robot-mode\"><option value=\"over\">one over the other</option>"
        "<option value=\"beside\">side by side</option><option value=\"measured\">measured alone</option>"
        "<option value=\"simulated\">simulated alone</option></select></label>";
  out +=
      "<label><input type=\"checkbox\" id=\"robot-names\"> all names</label>"
      "<button type=\"button\" id=\"robot-nearer\" title=\"nearer\">+</button>"
      "<button type=\"button\" id=\"robot-further\" title=\"further away\">&#8722;</button>"
      "<button type=\"button\" id=\"robot-home\">Reset view</button></div>\n";
  if (moves) out += "<p class=\"hint\" id=\"robot-difference\"></p>\n";
  out +=
      "<p class=\"hint screen-only\">Drag to turn, pinch to zoom; after a click the wheel zooms, arrow keys turn, + and &#8722; zoom, "
      "space plays. Thick lines join the joints, boxes have the mass and the inertia of the links in the URDF.</p>\n";
  return out;
}

}  // namespace

RobotPicture robot_picture(const Diagnosis& d) {
  const json robot = robot_data(d);
  return {robot_html(d, robot), robot.dump(-1, ' ', false, json::error_handler_t::replace)};
}

}  // namespace furcula::report
