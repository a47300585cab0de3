// Written models read back the same, to the bit.
#include "host/model/writer.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/model/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;

namespace {

void check_same(const model::Model& a, const model::Model& b) {
  CHECK(a.kind == b.kind);
  CHECK(a.parameters == b.parameters);
  CHECK(a.effects == b.effects);
  REQUIRE(a.free.size() == b.free.size());
  for (const auto& [index, bounds] : a.free) {
    CHECK(b.free.at(index).lower == bounds.lower);
    CHECK(b.free.at(index).upper == bounds.upper);
  }
}

}  // namespace

TEST_CASE("a model is written as a person would write it") {
  model::Model m = model::parse_model(test::kJointModel, "m.toml");
  m.free.emplace(0, model::Bounds{0.1, 1});
  m.effects[dynamics::Effect::coulomb_friction] = {0.25};
  CHECK(model::format_model(m) ==
        "[model]\nkind = \"rotary_joint\"\nschema = 1\n\n[parameters]\ninertia_kgm2 = 0.15\n"
        "gravity_torque_nm = 2.6\ndamping_nmspr = 0.1\n\n[free]\ninertia_kgm2 = [0.1, 1.0]\n\n"
        "[effect.coulomb_friction]\ntorque_nm = 0.25\n");
}

TEST_CASE("any model of any kind with all its effects reads back to the bit") {
  std::mt19937_64 random(11);
  const auto between = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  for (const auto& kind : dynamics::kMachines)
    for (int draw = 0; draw < 50; ++draw) {
      model::Model m;
      m.kind = kind.kind;
      for (const auto& p : kind.parameters) {
        // Over the orders of magnitude as well: 1e-300 to the bound.
        const double value =
            between(p.lower, p.upper) * (p.lower <= 0.0 ? std::pow(10.0, between(-300.0, 0.0)) : 1.0);
        if (draw % 2 == 0) m.free[m.parameters.size()] = {p.lower, p.upper};
        m.parameters.push_back(value);
      }
      if (dynamics::has(kind.kind, dynamics::LocationType::leg))
        m.clutch = model::Clutch{between(0.0, 1.0), between(0.0, 1.0), between(0.0, 1e4), between(1e-3, 0.1)};
      for (const auto& e : dynamics::kCatalogue)
        if (dynamics::applies(e.effect, kind.kind))
          for (std::size_t i = 0; i < e.parameter_count; ++i)
            m.effects[e.effect][i] = between(e.parameters()[i].lower, e.parameters()[i].upper);
      check_same(m, model::parse_model(model::format_model(m), "m.toml"));
    }
}

TEST_CASE("a model file goes through the disk unchanged") {
  test::TemporaryFolder folder;
  const model::Model m = model::parse_model(test::kHopperModel, "m.toml");
  model::write_model(m, folder.path() + "/m.toml");
  check_same(m, model::read_model(folder.path() + "/m.toml"));
  CHECK(folder.names() == std::vector<std::string>{"m.toml"});
}
