// The biped's URDF beside the constants of the core, and robots that are no such biped.
#include "host/biped/robot.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/host/error_message.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
using dynamics::biped::LinkDescription;

namespace {

const std::string kPath = test::source("models/biped/furcula_biped.urdf");

std::string urdf() {
  std::ifstream in(kPath);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The URDF with a text in it replaced, everywhere.
std::string refused(const std::string& what, const std::string& by) {
  std::string text = urdf();
  std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  for (; at != std::string::npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
  return test::error_message([&] { biped::biped_of(model::parse_urdf(text, "b.urdf")); });
}

void check_same(const LinkDescription& a, const LinkDescription& b) {
  const double of_a[] = {a.offset_m.x, a.offset_m.y, a.offset_m.z, a.mass_kg,
                         a.centre_m.x, a.centre_m.y, a.centre_m.z};
  const double of_b[] = {b.offset_m.x, b.offset_m.y, b.offset_m.z, b.mass_kg,
                         b.centre_m.x, b.centre_m.y, b.centre_m.z};
  for (int i = 0; i < 7; ++i) CHECK(of_a[i] == of_b[i]);
  const auto &s = a.about_centre_kgm2, &t = b.about_centre_kgm2;
  CHECK(s.xx == t.xx);
  CHECK(s.xy == t.xy);
  CHECK(s.xz == t.xz);
  CHECK(s.yy == t.yy);
  CHECK(s.yz == t.yz);
  CHECK(s.zz == t.zz);
}

}  // namespace

TEST_CASE("The core's constants are the URDF's") {
  const auto read = biped::read_biped(kPath);
  const auto design = dynamics::biped::design();
  check_same(read.pelvis, design.pelvis);
  double mass_kg = read.pelvis.mass_kg;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t j = 0; j < dynamics::biped::kLegJoints; ++j) {
      CAPTURE(side, j);
      check_same(read.legs[side][j], design.legs[side][j]);
      CHECK(read.drives[side][j].limit_nm == design.drives[side][j].limit_nm);
      mass_kg += read.legs[side][j].mass_kg;
    }
  CHECK(mass_kg == Approx(49.8).epsilon(1e-12));  // document 000
  CHECK(model::parse_urdf(urdf(), "b.urdf").name == dynamics::biped::kDesignName);
}

TEST_CASE("A drive's largest torque is the URDF's effort") {
  std::string text = urdf();
  const std::size_t at = text.find("effort=\"220\"", text.find("<joint name=\"right_knee\""));
  REQUIRE(at != std::string::npos);
  text.replace(at, 12, "effort=\"150\"");
  const auto read = biped::biped_of(model::parse_urdf(text, "b.urdf"));
  CHECK(read.drives[1][dynamics::biped::kKnee].limit_nm == 150.0);
  CHECK(read.drives[0][dynamics::biped::kKnee].limit_nm == 220.0);  // document 000
}

TEST_CASE("The vertices are the lower corners of the URDF's soles") {
  const std::string text = urdf();
  const std::size_t at = text.find("<collision name=\"sole\">");
  REQUIRE(at != std::string::npos);
  const auto three = [&](const std::string& before) {
    std::istringstream in(text.substr(text.find(before, at) + before.size()));
    model::Vec3<double> v{};
    in >> v.x >> v.y >> v.z;
    return v;
  };
  const auto centre = three("xyz=\""), size = three("size=\"");
  const auto design = dynamics::biped::design();
  for (const auto& foot : design.vertices_m)
    for (std::size_t i = 0; i < dynamics::biped::kVertices; ++i) {
      CHECK(foot[i].x == Approx(centre.x + (i < 2 ? 0.5 : -0.5) * size.x));
      CHECK(foot[i].y == Approx(centre.y + (i % 2 == 0 ? 0.5 : -0.5) * size.y));
      CHECK(foot[i].z == Approx(centre.z - 0.5 * size.z));
    }
}

TEST_CASE("A robot that is no such biped is refused, and what is expected is said") {
  CHECK_THAT(refused("left_knee", "left_ellbow"),
             Contains("b.urdf: no joint 'left_knee'; expected the biped's 12 joints"));
  CHECK_THAT(refused("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 -1\"/>"),
             Contains("joint 'left_hip_yaw' is about 0 0 -1; expected 0 0 1"));
  CHECK_THAT(refused("0 0.09 -0.06\" rpy=\"0 0 0", "0 0.09 -0.06\" rpy=\"0 0 0.1"),
             Contains("turned against its parent"));
  CHECK_THAT(refused("0 0.09 -0.06", "0.01 0.09 -0.06"),
             Contains("'left_hip_yaw' is at 0.01 0.09 -0.06 in its parent; expected 0 for x"));
  CHECK_THAT(refused("<child link=\"left_shank\"/>", "<child link=\"left_ankle_link\"/>"),
             Contains("left_ankle_link"));
  CHECK_THAT(refused("<joint name=\"left_knee\" type=\"revolute\">",
                     "<joint name=\"left_knee\" type=\"prismatic\">"),
             Contains("not revolute"));
  CHECK_THAT(refused("<mass value=\"16.2\"/>", "<mass value=\"0\"/>"), Contains("link 'pelvis' has no mass"));
  CHECK_THAT(refused("</joint>", "<dynamics damping=\"1\"/></joint>"),
             Contains("joint 'left_hip_yaw' has damping or friction; expected none"));
  CHECK_THAT(refused("effort=\"220\"", "effort=\"0\""),
             Contains("joint 'left_hip_yaw' has no effort; expected the drive's largest torque"));
  CHECK_THAT(refused("<child link=\"right_foot\"/>",
                     "<child link=\"right_foot\"/><mimic joint=\"left_ankle_roll\"/>"),
             Contains("mimics 'left_ankle_roll'"));
  CHECK_THAT(refused("<parent link=\"right_thigh\"/>", "<parent link=\"left_thigh\"/>"),
             Contains("joint 'right_knee' is on link 'left_thigh'; expected it on 'right_thigh'"));
  // A toe: the foot is no leaf.
  CHECK_THAT(
      refused(
          "</robot>",
          "<link name=\"toe\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" "
          "izz=\"1e-4\"/></inertial></link><joint name=\"toe\" type=\"revolute\"><parent link=\"left_foot\"/><child link=\"toe\"/><axis "
          "xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>"),
      Contains("there are 13 joints; expected the biped's 12 and no other, with the feet as leaves"));
}
