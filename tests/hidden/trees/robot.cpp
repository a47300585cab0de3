#include "tests/hidden/trees/robot.hpp"

#include <algorithm>
#include <cstdio>
#include <numbers>

namespace furcula::hidden::trees {
namespace {

Mat3 point_inertia(Vec3 d, double mass_kg) {
  const double s = dot(d, d);
  return mass_kg * Mat3{{s - d.x * d.x, -d.x * d.y, -d.x * d.z},
                        {-d.x * d.y, s - d.y * d.y, -d.y * d.z},
                        {-d.x * d.z, -d.y * d.z, s - d.z * d.z}};
}

Mass mass_of(const Body& b) {
  const Mat3 axes = turn_of(b.turned);
  Mat3 inertia = axes * diagonal(b.moments) * transposed(axes);
  Vec3 centre = b.centre_m;
  const double mass = b.mass_kg + b.point_kg;
  if (b.point_kg != 0.0) {
    centre = (1.0 / mass) * (b.mass_kg * b.centre_m + b.point_kg * b.point_m);
    inertia = inertia + point_inertia(b.centre_m - centre, b.mass_kg) +
              point_inertia(b.point_m - centre, b.point_kg);
  }
  const Mat3 turn = turn_of(b.rpy);
  return {static_cast<std::size_t>(b.joint), mass, b.at + turn * centre, turn * inertia * transposed(turn)};
}

}  // namespace

Dynamics::Dynamics(const Robot& robot, Vec3 gravity_mps2) : gravity_(gravity_mps2) {
  for (const Joint& j : robot.joints)
    joints_.push_back({j.parent, j.at, (1.0 / length(j.axis)) * j.axis, turn_of(j.rpy), j.prismatic});
  for (const Body& b : robot.bodies) masses_.push_back(mass_of(b));
}

std::array<Dynamics::Pose, kMost> Dynamics::poses(const Values& q, const Values& v) const {
  std::array<Pose, kMost> out;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Place& j = joints_[i];
    Pose base{};
    const Pose& p = j.parent < 0 ? base : out[static_cast<std::size_t>(j.parent)];
    Pose& o = out[i];
    const Mat3 before = p.r * j.turn;
    o.axis = before * j.axis;
    Vec3 r = p.r * j.at;
    if (j.prismatic) {
      o.r = before;
      r = r + q[i] * o.axis;
      o.w = p.w;
      o.alpha = p.alpha;
    } else {
      o.r = before * turn_about(j.axis, q[i]);
      o.w = p.w + v[i] * o.axis;
      o.alpha = p.alpha + v[i] * cross(p.w, o.axis);
    }
    o.p = p.p + r;
    o.v = p.v + cross(p.w, r);
    o.a = p.a + cross(p.alpha, r) + cross(p.w, cross(p.w, r));
    if (j.prismatic) {
      o.v = o.v + v[i] * o.axis;
      o.a = o.a + 2.0 * v[i] * cross(p.w, o.axis);
    }
  }
  return out;
}

void Dynamics::evaluate(const Values& q, const Values& v, Matrix& mass, Values& bias) const {
  const std::size_t n = joints_.size();
  const auto pose = poses(q, v);
  for (std::size_t i = 0; i < n; ++i) {
    mass[i].fill(0.0);
    bias[i] = 0.0;
  }
  std::array<Vec3, kMost> move, spin, angular;
  std::array<std::size_t, kMost> path{};
  for (const Mass& b : masses_) {
    const Pose& p = pose[b.joint];
    const Vec3 c = p.r * b.centre_m;
    const Vec3 centre = p.p + c;
    // I w = R I R' w: the body's own matrix is constant.
    const auto inertia_times = [&](Vec3 x) { return p.r * (b.inertia_kgm2 * (transposed(p.r) * x)); };
    const Vec3 acceleration = p.a + cross(p.alpha, c) + cross(p.w, cross(p.w, c));
    const Vec3 force = b.mass_kg * (acceleration - gravity_);
    const Vec3 moment = inertia_times(p.alpha) + cross(p.w, inertia_times(p.w));
    std::size_t count = 0;
    for (int j = static_cast<int>(b.joint); j >= 0; j = joints_[static_cast<std::size_t>(j)].parent) {
      const auto i = static_cast<std::size_t>(j);
      path[count] = i;
      move[count] = joints_[i].prismatic ? pose[i].axis : cross(pose[i].axis, centre - pose[i].p);
      spin[count] = joints_[i].prismatic ? Vec3{} : pose[i].axis;
      angular[count] = joints_[i].prismatic ? Vec3{} : inertia_times(pose[i].axis);
      bias[i] += dot(move[count], force) + dot(spin[count], moment);
      ++count;
    }
    // path runs inwards: path[k] >= path[l] for k <= l; the lower half is filled.
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t l = k; l < count; ++l)
        mass[path[k]][path[l]] += b.mass_kg * dot(move[k], move[l]) + dot(spin[l], angular[k]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k) mass[k][i] = mass[i][k];
}

Values Dynamics::torque(const Values& q, const Values& v, const Values& qdd) const {
  Matrix m;
  Values h{};
  evaluate(q, v, m, h);
  for (std::size_t i = 0; i < size(); ++i)
    for (std::size_t k = 0; k < size(); ++k) h[i] += m[i][k] * qdd[k];
  return h;
}

double Dynamics::energy_j(const Values& q, const Values& v) const {
  const auto pose = poses(q, v);
  double sum = 0.0;
  for (const Mass& b : masses_) {
    const Pose& p = pose[b.joint];
    const Vec3 c = p.r * b.centre_m;
    const Vec3 speed = p.v + cross(p.w, c);
    const Vec3 w = transposed(p.r) * p.w;
    sum += 0.5 * b.mass_kg * dot(speed, speed) + 0.5 * dot(w, b.inertia_kgm2 * w) -
           b.mass_kg * dot(gravity_, p.p + c);
  }
  return sum;
}

Point Dynamics::point(std::size_t joint, Vec3 in_frame, const Values& q, const Values& v) const {
  const auto pose = poses(q, v);
  const Pose& p = pose[joint];
  const Vec3 c = p.r * in_frame;
  Point out{p.p + c, p.v + cross(p.w, c), p.a + cross(p.alpha, c) + cross(p.w, cross(p.w, c)), {}};
  for (int j = static_cast<int>(joint); j >= 0; j = joints_[static_cast<std::size_t>(j)].parent) {
    const auto i = static_cast<std::size_t>(j);
    out.move[i] = joints_[i].prismatic ? pose[i].axis : cross(pose[i].axis, out.at - pose[i].p);
  }
  return out;
}

namespace {

constexpr double kPi = std::numbers::pi;

Vec3 random_direction(Random& r) {
  Vec3 d{r.normal(), r.normal(), r.normal()};
  return (1.0 / length(d)) * d;
}

Vec3 axis_of_frame(Random& r) {
  const double which = r.uniform(0, 3);
  const double s = r.sign();
  return which < 1 ? Vec3{s, 0, 0} : which < 2 ? Vec3{0, s, 0} : Vec3{0, 0, s};
}

// A thin box or cylinder from the joint along `reach`, its own axes turned at random by some degrees.
Body draw_body(Random& r, const std::string& name, int joint, Vec3 reach, double mass_kg) {
  Body b;
  b.name = name;
  b.joint = joint;
  b.mass_kg = mass_kg;
  const double l = std::max(length(reach), 0.05);
  const double wide = l * r.uniform(0.1, 0.35), thick = l * r.uniform(0.1, 0.3);
  b.centre_m = r.uniform(0.35, 0.65) * reach + r.uniform(0.0, 0.08) * l * random_direction(r);
  // The inertial frame's z lies along the reach, but for a small angle.
  const double yaw = std::atan2(reach.y, reach.x);
  const double pitch = std::atan2(std::hypot(reach.x, reach.y), reach.z);
  b.turned = {r.uniform(-0.2, 0.2), pitch + r.uniform(-0.2, 0.2), yaw + r.uniform(-0.2, 0.2)};
  if (r.chance(0.5))
    b.moments = {mass_kg / 12 * (l * l + thick * thick), mass_kg / 12 * (l * l + wide * wide),
                 mass_kg / 12 * (wide * wide + thick * thick)};
  else
    b.moments = {mass_kg / 12 * (l * l + 0.75 * wide * wide), mass_kg / 12 * (l * l + 0.75 * wide * wide),
                 mass_kg / 8 * wide * wide};
  return b;
}

struct Growth {
  Robot robot;
  double mass_kg;
};

// Appends a joint at `at` and its link, which reaches to `reach`.
int grow(Growth& g, Random& r, const std::string& joint, const std::string& link, int parent, Vec3 at,
         Vec3 rpy, Vec3 axis, Vec3 reach) {
  Joint j;
  j.name = joint;
  j.parent = parent;
  j.at = at;
  j.rpy = rpy;
  j.axis = axis;
  j.centre = r.uniform(-0.6, 0.6);
  j.range = r.uniform(0.4, 1.1);
  g.robot.joints.push_back(j);
  const int index = static_cast<int>(g.robot.joints.size()) - 1;
  g.robot.bodies.push_back(draw_body(r, link, index, reach, g.mass_kg * r.uniform(0.7, 1.3)));
  g.mass_kg *= r.uniform(0.55, 0.9);
  return index;
}

std::string numbered(const char* stem, std::size_t number) { return stem + std::to_string(number); }

Robot pendulum(Random& r, std::size_t n) {
  Growth g{{"pendulum", {}, {}, {}}, r.log_uniform(0.3, 4.0)};
  Vec3 at{0, 0, 0};
  int parent = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const double l = r.uniform(0.15, 0.45);
    parent = grow(g, r, numbered("j", i + 1), numbered("link", i + 1), parent, at, {}, {0, 1, 0}, {0, 0, -l});
    g.robot.joints.back().centre = r.uniform(-0.8, 0.8);
    at = {0, r.uniform(0.0, 0.05), -l};
  }
  return g.robot;
}

Robot arm(Random& r, std::size_t n) {
  Growth g{{"arm", {}, {}, {}}, r.log_uniform(0.6, 6.0)};
  Vec3 at{0, 0, r.uniform(0.0, 0.3)};
  int parent = -1;
  const bool skew = r.chance(0.3), slides = r.chance(0.15) && n > 2;
  const auto slider = static_cast<std::size_t>(r.uniform(1.0, static_cast<double>(n)));
  for (std::size_t i = 0; i < n; ++i) {
    const double l = r.uniform(0.1, 0.4);
    const Vec3 axis = i == 0 && r.chance(0.7) ? Vec3{0, 0, 1} : skew ? random_direction(r) : axis_of_frame(r);
    const Vec3 rpy =
        i == 0 ? Vec3{}
        : skew ? Vec3{r.uniform(-kPi, kPi), r.uniform(-1.2, 1.2), r.uniform(-kPi, kPi)}
               : Vec3{kPi / 2 * std::floor(r.uniform(-1, 2)), 0, kPi / 2 * std::floor(r.uniform(-1, 2))};
    // A link that lies along its own axis hardly shows: most reach across it.
    Vec3 reach = axis_of_frame(r);
    if (i > 0 || n <= 3) {
      for (int tries = 0; tries < 20 && std::fabs(dot(reach, axis)) > 0.6; ++tries) reach = axis_of_frame(r);
    }
    parent =
        grow(g, r, numbered("joint_", i + 1), numbered("link_", i + 1), parent, at, rpy, axis, l * reach);
    if (slides && i == slider) {
      Joint& j = g.robot.joints.back();
      j.prismatic = true;
      j.centre = r.uniform(-0.05, 0.05);
      j.range = r.uniform(0.05, 0.15);
    }
    at = l * reach;
  }
  return g.robot;
}

Robot leg(Random& r, std::size_t n) {
  Growth g{{"leg", {}, {}, {}}, r.log_uniform(0.5, 3.0)};
  static const char* const kJoints[] = {"hip_roll", "hip_pitch", "knee", "ankle"};
  static const char* const kLinks[] = {"hip", "thigh", "shank", "foot"};
  const std::size_t from = n == 2 ? 1 : 0;
  int parent = -1;
  Vec3 at{0, r.uniform(-0.1, 0.1), 0};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = from + i;
    const double l = r.uniform(0.12, 0.35);
    const Vec3 reach = k == 0   ? Vec3{0, r.uniform(0.03, 0.1), r.uniform(-0.08, -0.02)}
                       : k == 3 ? Vec3{0.6 * l, 0, -0.15 * l}
                                : Vec3{0, 0, -l};
    parent = grow(g, r, kJoints[k], kLinks[k], parent, at, {}, k == 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, reach);
    Joint& j = g.robot.joints.back();
    j.centre = k == 2 ? r.uniform(-1.4, -0.6) : r.uniform(-0.2, 0.5);
    at = reach;
  }
  return g.robot;
}

Robot branched(Random& r, std::size_t n) {
  Growth g{{"branched", {}, {}, {}}, r.log_uniform(0.8, 4.0)};
  const double l = r.uniform(0.1, 0.3);
  const int torso = grow(g, r, "torso_yaw", "torso", -1, {0, 0, 0.2}, {}, {0, 0, 1}, {0, 0, l});
  int ends[2] = {torso, torso};
  Vec3 at[2] = {{0, 0.15, l}, {0, -0.15, l}};
  const double mass = g.mass_kg;
  for (std::size_t i = 1; i < n; ++i) {
    const std::size_t side = (i - 1) % 2;
    if (i <= 2) g.mass_kg = mass;
    const double reach = r.uniform(0.1, 0.3);
    const Vec3 direction = r.chance(0.5) ? Vec3{0, 0, -1} : Vec3{1, 0, 0};
    const Vec3 axis = r.chance(0.6) ? Vec3{0, 1, 0} : direction.x != 0 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const std::string stem = side == 0 ? "left_" : "right_";
    const std::string number = std::to_string((i + 1) / 2);
    ends[side] = grow(g, r, stem + number, stem + "link_" + number, ends[side], at[side],
                      {0, 0, r.uniform(-0.3, 0.3)}, axis, reach * direction);
    at[side] = reach * direction;
  }
  return g.robot;
}

std::string text(const char* format, auto... values) {
  char line[400];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

}  // namespace

Robot draw_robot(Random& random, std::size_t joints) {
  std::size_t n = joints;
  if (n == 0) n = 2 + static_cast<std::size_t>(random.uniform(0.0, 1.0) * random.uniform(0.5, 1.0) * 6.0);
  n = std::clamp<std::size_t>(n, 2, 7);
  const double form = random.unit();
  Robot robot;
  if (n <= 3 && form < 0.45)
    robot = pendulum(random, n);
  else if (n <= 4 && form < 0.7)
    robot = leg(random, n);
  else if (n >= 3 && form > 0.8)
    robot = branched(random, n);
  else
    robot = arm(random, n);
  if (random.chance(0.25)) {
    Body tool;
    tool.name = "tool";
    tool.tool = true;
    const Body& last = robot.bodies.back();
    tool.joint = last.joint;
    tool.at = 1.8 * last.centre_m;
    tool.rpy = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    tool.mass_kg = last.mass_kg * random.uniform(0.05, 0.2);
    const double r = 0.03;
    tool.moments = {tool.mass_kg * r * r, 0.9 * tool.mass_kg * r * r, 0.6 * tool.mass_kg * r * r};
    tool.turned = {random.uniform(-1, 1), 0.3, 0.0};
    robot.bodies.push_back(tool);
  }
  return robot;
}

// The values are those of section 4.1 of the leg's design.
Robot draw_monopod(Random& r) {
  const auto near = [&](double nominal) { return nominal * r.uniform(0.8, 1.2); };
  Robot robot;
  robot.form = "monopod";
  const auto add = [&](const char* joint, const char* link, Vec3 at, Vec3 axis, bool prismatic, Body body) {
    Joint j;
    j.name = joint;
    j.parent = static_cast<int>(robot.size()) - 1;
    j.at = at;
    j.axis = axis;
    j.prismatic = prismatic;
    body.name = link;
    body.joint = static_cast<int>(robot.size());
    robot.joints.push_back(j);
    robot.bodies.push_back(body);
  };
  // Links of about the same moment all round; y is what shows.
  const auto link = [&](double mass_kg, double centre_m, double moment) {
    Body b;
    b.mass_kg = near(mass_kg);
    b.centre_m = {0, 0, -near(centre_m)};
    const double y = near(moment);
    b.moments = {y * r.uniform(0.8, 1.0), y, y * r.uniform(0.5, 0.8)};
    return b;
  };
  Body boom, torso;
  boom.mass_kg = r.uniform(0.2, 0.5);
  boom.moments = {1e-4, 1e-4, 1e-4};
  torso.mass_kg = near(3.55);
  torso.moments = {1e-5, 1e-5, 1e-5};
  const double thigh_m = near(0.320), shank_m = near(0.327);
  add("boom_travel", "boom", {}, {1, 0, 0}, true, boom);
  add("boom_height", "torso", {}, {0, 0, 1}, true, torso);
  add("hip", "thigh", {}, {0, -1, 0}, false, link(2.43, 0.092, 0.06));
  add("knee", "shank", {0, 0, -thigh_m}, {0, -1, 0}, false, link(0.73, 0.097, 0.02));
  Leg leg;
  leg.link = "shank";
  leg.hip = 2;
  leg.knee = 3;
  leg.toe_m = {0, 0, -shank_m};
  leg.spring_nmprad = near(60.67);
  leg.rest_rad = 61 * kPi / 180 * r.uniform(0.9, 1.1);
  robot.leg = leg;
  return robot;
}

std::string urdf_of(const Robot& robot, std::size_t visible) {
  const auto xyz = [](Vec3 v) { return text("%.10g %.10g %.10g", v.x, v.y, v.z); };
  std::string out = "<?xml version=\"1.0\"?>\n<robot name=\"" + robot.form + "\">\n  <link name=\"base\"/>\n";
  const auto link_name = [&](int joint) -> std::string {
    if (joint < 0) return "base";
    for (const Body& b : robot.bodies)
      if (b.joint == joint && !b.tool) return b.name;
    return "base";
  };
  for (const Body& b : robot.bodies) {
    if (static_cast<std::size_t>(b.joint) >= visible) continue;
    out += "  <link name=\"" + b.name + "\">\n    <inertial>\n      <origin xyz=\"" + xyz(b.centre_m) +
           "\" rpy=\"" + xyz(b.turned) + "\"/>\n" + text("      <mass value=\"%.10g\"/>\n", b.mass_kg) +
           text("      <inertia ixx=\"%.10g\" ixy=\"0\" ixz=\"0\" iyy=\"%.10g\" iyz=\"0\" izz=\"%.10g\"/>\n",
                b.moments.x, b.moments.y, b.moments.z) +
           "    </inertial>\n  </link>\n";
  }
  for (std::size_t i = 0; i < visible; ++i) {
    const Joint& j = robot.joints[i];
    out += "  <joint name=\"" + j.name + "\" type=\"" + (j.prismatic ? "prismatic" : "revolute") +
           "\">\n    <parent link=\"" + link_name(j.parent) + "\"/>\n    <child link=\"" +
           link_name(static_cast<int>(i)) + "\"/>\n    <origin xyz=\"" + xyz(j.at) + "\" rpy=\"" +
           xyz(j.rpy) + "\"/>\n    <axis xyz=\"" + xyz(j.axis) + "\"/>\n" +
           text("    <limit lower=\"%.6g\" upper=\"%.6g\" effort=\"%.6g\" velocity=\"%.6g\"/>\n  </joint>\n",
                j.lower, j.upper, j.effort, j.velocity);
  }
  for (const Body& b : robot.bodies)
    if (b.tool)
      out += "  <joint name=\"" + b.name + "_mount\" type=\"fixed\">\n    <parent link=\"" +
             link_name(b.joint) + "\"/>\n    <child link=\"" + b.name + "\"/>\n    <origin xyz=\"" +
             xyz(b.at) + "\" rpy=\"" + xyz(b.rpy) + "\"/>\n  </joint>\n";
  return out + "</robot>\n";
}

}  // namespace furcula::hidden::trees
