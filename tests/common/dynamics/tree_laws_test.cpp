// What acts in a joint besides damping, springs and Coulomb friction, against closed forms.
#include <catch2/catch.hpp>

#include "furcula/dynamics/tree/plant.hpp"
#include "host/identify/dual.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

using Shape = DynamicTopology<8>;
using Tree = Model<double, Shape>;
using Joints = Tree::Joints;

constexpr double kInertia = 0.5;  // kg m^2

/// A disc on an axis through its centre; gravity does nothing to it.
template <class T = double>
Model<T, Shape> rotor(const JointLaw<T>& law) {
  Model<T, Shape> m;
  add(m, -1, JointKind::revolute, at(0, 0, 0), {0, 0, 1},
      inertia_of(T(1.0), Vec3<T>{T(0.0), T(0.0), T(0.0)},
                 Sym3<T>{T(kInertia), T(0.0), T(0.0), T(kInertia), T(0.0), T(kInertia)}));
  m.laws[0] = law;
  return m;
}

}  // namespace

TEST_CASE("Drag slows a rotor as v0 / (1 + c v0 t / J), both ways") {
  const double drag = 0.2, v0 = 3.0, t = 2.0;
  for (const double way : {1.0, -1.0}) {
    Plant<double, Shape> plant(rotor({.drag_nms2prad2 = drag}), 1e-2);
    plant.reset({}, {way * v0});
    plant.advance({}, t);
    CHECK(plant.velocities()[0] == Approx(way * v0 / (1.0 + drag * v0 * t / kInertia)).epsilon(1e-8));
    CHECK(plant.positions()[0] ==
          Approx(way * kInertia / drag * std::log(1.0 + drag * v0 * t / kInertia)).epsilon(1e-8));
  }
}

TEST_CASE("A rotor coasts J v^2 / 2F, with another F forth than back") {
  const double forth = 0.8, back = 0.3, v0 = 1.5;
  for (const double way : {1.0, -1.0}) {
    Plant<double, Shape> plant(rotor({.friction_nm = forth, .friction_back_nm = back, .asymmetric = true}),
                               1e-2);
    plant.reset({}, {way * v0});
    plant.advance({}, 5.0);
    CHECK(plant.held(0));
    CHECK(plant.positions()[0] ==
          Approx(way * kInertia * v0 * v0 / (2.0 * (way > 0 ? forth : back))).epsilon(1e-12));
    // At rest it takes as much to set out.
    const double stopped = plant.positions()[0];
    plant.advance({0.999 * forth}, 0.1);
    plant.advance({-0.999 * back}, 0.1);
    CHECK(plant.positions()[0] == stopped);
    plant.advance({-1.5 * back}, 0.1);
    CHECK(plant.velocities()[0] == Approx(-0.5 * back / kInertia * 0.1));
  }
}

TEST_CASE("Friction of the load takes its share of the drive's torque") {
  const double ratio = 0.2, torque = 0.7;
  Plant<double, Shape> plant(rotor({.load_friction_ratio = ratio}), 1e-2);
  plant.reset({}, {});
  plant.advance({torque}, 0.5);  // sets out against its own friction
  CHECK(plant.velocities()[0] == Approx((1.0 - ratio) * torque / kInertia * 0.5).epsilon(1e-12));
  plant.advance({}, 0.5);  // no torque, no friction
  CHECK(plant.velocities()[0] == Approx((1.0 - ratio) * torque / kInertia * 0.5).epsilon(1e-12));
  plant.advance({-torque}, 0.2);  // brakes with the drive
  CHECK(plant.velocities()[0] ==
        Approx(torque / kInertia * ((1.0 - ratio) * 0.5 - (1.0 + ratio) * 0.2)).epsilon(1e-12));
}
