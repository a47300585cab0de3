// What the biped is made of: as a description in plain numbers, and as the parameters that the equations run on.
//
// Conventions (docs/biped.md): SI units; x forward, y left, z up; links parallel to the pelvis at q = 0. Pelvis frame P:
// origin on the mid-plane, 0.10 m above the crossing of the hips' axes.
#pragma once

#include "furcula/dynamics/biped/topology.hpp"
#include "furcula/dynamics/sine_cosine.hpp"

namespace furcula::dynamics::biped {

/// A position-controlled drive as the joint sees it: behind its gear of ratio n the rotor's inertia is n^2 Jr.
///   torque of the motor  clamp(kp (target - q) - kd qd, +-limit)
///   on the joint         that - damping qd - friction sat(qd / creep)
template <class T>
struct Drive {
  T armature_kgm2{}, damping_nmspr{}, friction_nm{}, kp_nmprad{}, kd_nmsprad{}, limit_nm{};
};

/// What a joint's clutch and brake do when the motor is not joined to the link.
template <class T>
struct Clutch {
  T spring_nmprad{}, spring_rest_rad{};  ///< of a passive hip
  T damping_nmspr{};                     ///< of a released link
  T brake_nmprad{}, brake_nmspr{}, brake_limit_nm{};
};

/// Of all 8 vertices. Force and sink: contact.hpp.
template <class T>
struct Ground {
  T stiffness_npm{}, damping_nspm{};                          ///< along the normal
  T full_damping_m{};                                         ///< sink from which the damping is whole
  T shear_stiffness_npm{}, shear_damping_nspm{}, friction{};  ///< between anchor and vertex; friction: mu
};

/// A link: where its joint is in the parent, its mass, its centre, its inertia about the centre in link axes.
struct LinkDescription {
  Vec3<double> offset_m;
  double mass_kg;
  Vec3<double> centre_m;
  Sym3<double> about_centre_kgm2;
};

/// The robot in plain numbers.
struct Description {
  LinkDescription pelvis;
  std::array<std::array<LinkDescription, kLegJoints>, 2> legs;    ///< left, right
  std::array<std::array<Vec3<double>, kVertices>, 2> vertices_m;  ///< in the foot's frame
  std::array<std::array<Drive<double>, kLegJoints>, 2> drives;
  std::array<std::array<Clutch<double>, kClutches>, 2> clutches;  ///< of hip pitch and knee
  Ground<double> ground;
  double gear_ratio;
  double torque_constant_nmpa;  ///< of the motor, before the gear
  double resistance_ohm;
  double constant_power_w;
  double creep_radps;  ///< below which gear friction is a damper
  double gravity_mps2;
  double slope_x_rad, slope_y_rad;  ///< ground against the level: R_lg = Ry(slope_y) Rx(slope_x)

  constexpr double mass_kg() const {
    double out = pelvis.mass_kg;
    for (const auto& leg : legs)
      for (const LinkDescription& link : leg) out += link.mass_kg;
    return out;
  }
  /// Heat of a motor's winding over the square of its torque at the joint, W/(N m)^2 (document 000, eq. 1).
  constexpr double copper_w_pnm2() const {
    const double nm_a_ampere = gear_ratio * torque_constant_nmpa;
    return resistance_ohm / (nm_a_ampere * nm_a_ampere);
  }
};

/// Acceleration of free fall in the ground's frame: R_lg' (0, 0, -g).
template <class T>
Vec3<T> gravity_on_slope(const T& gravity_mps2, const T& slope_x_rad, const T& slope_y_rad) {
  const auto x = sine_cosine(slope_x_rad), y = sine_cosine(slope_y_rad);
  return {gravity_mps2 * y.sine, -(gravity_mps2 * x.sine * y.cosine), -(gravity_mps2 * x.cosine * y.cosine)};
}

/// What the equations run on. Every number may differ from lane to lane.
template <class T>
struct Parameters {
  using L = LegScalar<T>;

  Inertia<T> pelvis{};                                    ///< about P's origin
  PerLeg<T, std::array<Inertia<L>, kLegJoints>> links{};  ///< about the links' origins
  PerLeg<T, std::array<Vec3<L>, kLegJoints>> offsets_m{};
  PerLeg<T, std::array<Vec3<L>, kVertices>> vertices_m{};  ///< front left, front right, rear left, rear right
  PerLeg<T, std::array<Drive<L>, kLegJoints>> drives{};
  PerLeg<T, std::array<Clutch<L>, kClutches>> clutches{};
  Ground<T> ground{};
  T creep_radps{};
  Vec3<T> gravity_mps2{};  ///< in the ground's frame

  Parameters() = default;
  explicit Parameters(const Description& d)
      : pelvis(inertia<T>(d.pelvis)),
        ground{T(as(d.ground.stiffness_npm)),      T(as(d.ground.damping_nspm)),
               T(as(d.ground.full_damping_m)),     T(as(d.ground.shear_stiffness_npm)),
               T(as(d.ground.shear_damping_nspm)), T(as(d.ground.friction))},
        creep_radps(T(as(d.creep_radps))),
        gravity_mps2(vector<T>(gravity_on_slope(d.gravity_mps2, d.slope_x_rad, d.slope_y_rad))) {
    for (const std::size_t side : {kLeft, kRight}) {
      const std::size_t k = Legs<T>::pass(side);
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        put(links[k][j], side, inertia<T>(d.legs[side][j]));
        put(offsets_m[k][j], side, vector<T>(d.legs[side][j].offset_m));
        put(drives[k][j], side, d.drives[side][j]);
      }
      for (std::size_t i = 0; i < kVertices; ++i)
        put(vertices_m[k][i], side, vector<T>(d.vertices_m[side][i]));
      for (std::size_t i = 0; i < kClutches; ++i) put(clutches[k][i], side, d.clutches[side][i]);
    }
  }

  /// Of one leg: reads and writes as numbers of the robot's scalar.
  Inertia<T> link(std::size_t side, std::size_t j) const {
    const auto& b = links[Legs<T>::pass(side)][j];
    const auto one = [&](const L& x) { return Legs<T>::read(x, side); };
    const auto& s = b.inertia_kgm2;
    return {one(b.mass_kg),
            {one(b.moment_kgm.x), one(b.moment_kgm.y), one(b.moment_kgm.z)},
            {one(s.xx), one(s.xy), one(s.xz), one(s.yy), one(s.yz), one(s.zz)}};
  }
  void set_link(std::size_t side, std::size_t j, const Inertia<T>& body) {
    put(links[Legs<T>::pass(side)][j], side, body);
  }

 protected:
  using V = ValueOf<T>;
  static constexpr V as(double x) { return static_cast<V>(x); }
  template <class S>
  static Vec3<S> vector(const Vec3<double>& v) {
    return {S(as(v.x)), S(as(v.y)), S(as(v.z))};
  }
  /// In double, then rounded once.
  template <class S>
  static Inertia<S> inertia(const LinkDescription& d) {
    const Inertia<double> b = tree::inertia_of(d.mass_kg, d.centre_m, d.about_centre_kgm2);
    const Sym3<double>& s = b.inertia_kgm2;
    return {S(as(b.mass_kg)),
            vector<S>(b.moment_kgm),
            {S(as(s.xx)), S(as(s.xy)), S(as(s.xz)), S(as(s.yy)), S(as(s.yz)), S(as(s.zz))}};
  }
  static void put(L& to, std::size_t side, const T& x) { Legs<T>::write(to, side, x); }
  static void put(Vec3<L>& to, std::size_t side, const Vec3<T>& x) {
    put(to.x, side, x.x), put(to.y, side, x.y), put(to.z, side, x.z);
  }
  static void put(Inertia<L>& to, std::size_t side, const Inertia<T>& x) {
    put(to.mass_kg, side, x.mass_kg);
    put(to.moment_kgm, side, x.moment_kgm);
    auto& s = to.inertia_kgm2;
    const auto& from = x.inertia_kgm2;
    put(s.xx, side, from.xx), put(s.xy, side, from.xy), put(s.xz, side, from.xz);
    put(s.yy, side, from.yy), put(s.yz, side, from.yz), put(s.zz, side, from.zz);
  }
  static void put(Drive<L>& to, std::size_t side, const Drive<double>& x) {
    put(to.armature_kgm2, side, T(as(x.armature_kgm2))), put(to.damping_nmspr, side, T(as(x.damping_nmspr)));
    put(to.friction_nm, side, T(as(x.friction_nm))), put(to.kp_nmprad, side, T(as(x.kp_nmprad)));
    put(to.kd_nmsprad, side, T(as(x.kd_nmsprad))), put(to.limit_nm, side, T(as(x.limit_nm)));
  }
  static void put(Clutch<L>& to, std::size_t side, const Clutch<double>& x) {
    put(to.spring_nmprad, side, T(as(x.spring_nmprad))),
        put(to.spring_rest_rad, side, T(as(x.spring_rest_rad)));
    put(to.damping_nmspr, side, T(as(x.damping_nmspr))), put(to.brake_nmprad, side, T(as(x.brake_nmprad)));
    put(to.brake_nmspr, side, T(as(x.brake_nmspr))), put(to.brake_limit_nm, side, T(as(x.brake_limit_nm)));
  }
};

/// Rotations of a leg's joints, parent's coordinates to the joint's at angle zero; left, right.
using JointFrames = std::array<std::array<Mat3<double>, kLegJoints>, 2>;

/// A robot whose joints are turned against their parents, as a URDF's <origin rpy="..."> turns them. Kinematics, accelerations and steps
/// take it in place of Parameters; what is of a link is in that link's axes.
template <class T>
struct TurnedParameters : Parameters<T> {
  using typename Parameters<T>::L;

  PerLeg<T, std::array<Mat3<L>, kLegJoints>> frames{};

  TurnedParameters() = default;
  TurnedParameters(const Description& d, const JointFrames& of) : Parameters<T>(d) {
    for (const std::size_t side : {kLeft, kRight})
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        Mat3<L>& to = frames[Legs<T>::pass(side)][j];
        const Mat3<double>& from = of[side][j];
        this->put(to.x, side, this->template vector<T>(from.x));
        this->put(to.y, side, this->template vector<T>(from.y));
        this->put(to.z, side, this->template vector<T>(from.z));
      }
  }
};

}  // namespace furcula::dynamics::biped
