// A cart on a rail with a pole on it: a machine that is a URDF and a few lines of a model file, and no code.
#include <algorithm>

#include "host/result/diagnosis_json.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/result.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Effect;

TEST_CASE("Dry friction of a cart's rail is named there, in newtons, and none at the pole") {
  const trees::TreeModel given = test::robot("model/robots/cart_pole.urdf");
  trees::TreeModel truth = given;
  const std::size_t rail = test::joint(truth, "rail");
  REQUIRE(truth.prismatic(rail));
  truth.causes = {{Effect::coulomb_friction, {rail}, {2.5, 0, 0, 0}}};
  const trees::Diagnosis d =
      trees::diagnose(given, test::logs(truth, 3, 5.0, 40), test::logs(truth, 1, 5.0, 90));
  INFO(result::to_json_text(trees::result_of(d)).substr(0, 4000));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].cause.effect == Effect::coulomb_friction);
  CHECK(d.findings[0].at == std::vector<std::string>{"rail"});
  REQUIRE(d.findings[0].parameters.size() == 1);
  CHECK(d.findings[0].parameters[0].value == Approx(2.5).epsilon(0.1));
  CHECK(d.extended_error[rail].rmse < 0.6 * d.refitted_error[rail].rmse);
}
