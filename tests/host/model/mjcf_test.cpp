// The MJCF that is written: what stands in it, and what is only named.
#include "host/model/mjcf.hpp"

#include <catch2/catch.hpp>

#include "host/model/xml_check.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("An MJCF has a body, a joint and an actuator for each joint, and a site for what is fixed") {
  auto tree = model::tree_of(model::read_urdf(test::source("tests/host/model/robots/double_pendulum.urdf")));
  tree.model.laws[1].armature_kgm2 = 0.0125;
  const std::string text = model::format_mjcf(tree, {{"elbow", 20.0, 1.5}});
  CHECK_NOTHROW(model::check_xml(text, "mjcf"));
  CHECK_THAT(text, Contains("<body name=\"upper\""));
  CHECK_THAT(
      text,
      Contains(
          "<joint name=\"shoulder\" type=\"hinge\" axis=\"0 -1 0\" armature=\"0\" damping=\"0.01\" frictionloss=\"0.1\" limited=\"true\" range=\"-3 3\"/>"));
  CHECK_THAT(text, Contains("armature=\"0.0125\""));
  CHECK_THAT(text, Contains("<site name=\"weight\" pos=\"0 0 -0.38\""));
  CHECK_THAT(text, Contains("mass=\"0.65\""));  // the weight is merged into the lower rod
  CHECK_THAT(text, Contains("<motor name=\"shoulder\" joint=\"shoulder\"/>"));
  CHECK_THAT(
      text,
      Contains(
          "<general name=\"elbow\" joint=\"elbow\" biastype=\"affine\" gainprm=\"20\" biasprm=\"0 -20 -1.5\"/>"));
  CHECK_THAT(text, !Contains("<!--"));
}

TEST_CASE("What MJCF cannot hold is named in a comment, and names are escaped") {
  auto tree = model::tree_of(model::read_urdf(test::source("tests/host/model/robots/pendulum.urdf")));
  tree.joints[0].name = "a<b>--&\"c\x1b";
  tree.model.laws[0].friction_nm = 0.2;
  tree.model.laws[0].static_friction_nm = 0.3;
  tree.model.laws[0].elastic = true;
  tree.model.laws[0].drive_stiffness_nmprad = 80.0;
  const std::string text = model::format_mjcf(tree);
  CHECK_NOTHROW(model::check_xml(text, "mjcf"));
  CHECK_THAT(text, Contains("static friction 0.3 is more than MJCF holds"));
  CHECK_THAT(text, Contains("the drive's stiffness 80 is left out"));
  CHECK_THAT(text, Contains("<joint name=\"a&lt;b&gt;--&amp;&quot;c\\x1b\""));
}
