// The biped's description in plain numbers, and the parameters of its equations of motion.
//
// Conventions (docs/biped.md): SI units; x forward, y left, z up; links parallel to the pelvis at q = 0. Pelvis frame P:
// origin on the mid-plane, 0.10 m above the intersection of the hip axes.
#pragma once

#include "furcula/dynamics/biped/topology.hpp"
#include "furcula/dynamics/sine_cosine.hpp"

namespace furcula::dynamics::biped {

/// A position-controlled drive in joint coordinates: with gear ratio n the rotor's inertia at the joint is n^2 Jr.
///   torque of the motor  clamp(kp (target - q) - kd qd, +-limit)
///   on the joint         the same - damping qd - friction sat(qd / creep)
template <class T>
struct Drive {
  T armature_kgm2{},    ///< rotor inertia at the joint, n^2 Jr
      damping_nmspr{},  ///< viscous friction of the gear
      friction_nm{},    ///< Coulomb friction of the gear
      kp_nmprad{},      ///< position gain
      kd_nmsprad{},     ///< rate gain
      limit_nm{};       ///< largest torque of the motor
};

/// Spring, damping and brake of a joint whose motor is not joined to the link.
template <class T>
struct Clutch {
  T spring_nmprad{},      ///< stiffness of the spring of a passive joint; 0: none
      spring_rest_rad{};  ///< joint angle at which that spring is relaxed
  T damping_nmspr{};      ///< viscous, of a passive or released link
  T brake_nmprad{},       ///< stiffness of the closed brake
      brake_nmspr{},      ///< its damping
      brake_limit_nm{};   ///< its largest torque
};

/// Contact parameters of each of the 8 sole vertices (equations in contact.hpp).
template <class T>
struct Ground {
  T stiffness_npm{},         ///< kn, along the normal
      damping_nspm{};        ///< dn, along the normal
  T full_damping_m{};        ///< d0, penetration from which the full damping acts
  T shear_stiffness_npm{},   ///< kt, between anchor and vertex
      shear_damping_nspm{},  ///< dt, tangential
      friction{};            ///< Coulomb coefficient mu
};

/// A link. Its frame has its origin at the joint.
struct LinkDescription {
  Vec3<double> offset_m;           ///< position of its joint in the parent's frame
  double mass_kg;                  ///< of the link
  Vec3<double> centre_m;           ///< centre of mass in the link's frame
  Sym3<double> about_centre_kgm2;  ///< inertia about the centre of mass, in link axes
};

/// The robot in plain numbers. Arrays over legs: [Side]; over joints: [LegJoint].
struct Description {
  LinkDescription pelvis;                                         ///< its offset is not used
  std::array<std::array<LinkDescription, kLegJoints>, 2> legs;    ///< [side][joint]: outboard link
  std::array<std::array<Vec3<double>, kVertices>, 2> vertices_m;  ///< [side][vertex], in the foot's frame
  std::array<std::array<Drive<double>, kLegJoints>, 2> drives;    ///< [side][joint]
  std::array<std::array<Clutch<double>, kClutches>, 2> clutches;  ///< [side][LegClutch]
  Ground<double> ground;                                          ///< the same for all vertices
  double gear_ratio;            ///< n, motor over joint speed, of every joint
  double torque_constant_nmpa;  ///< of the motor, before the gear
  double resistance_ohm;        ///< of the motor's winding
  /// Power that does not depend on the motion (docs/biped.md).
  double constant_power_w;
  /// Joint rate below which dry friction is proportional to the rate.
  double creep_radps;
  double gravity_mps2;  ///< magnitude
  double slope_x_rad,   ///< of the ground; ground to level coordinates: R_lg = Ry(slope_y) Rx(slope_x)
      slope_y_rad;      ///< likewise, about y

  /// Total mass of pelvis and legs.
  constexpr double mass_kg() const {
    double out = pelvis.mass_kg;
    for (const auto& leg : legs)
      for (const LinkDescription& link : leg) out += link.mass_kg;
    return out;
  }
  /// Copper loss of a motor over the square of its torque at the joint, W/(N m)^2 (document 000, eq. 1).
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

/// Parameters of the equations of motion. Every number may differ between the robots of a SIMD batch. Arrays over legs: [pass].
template <class T>
struct Parameters {
  using L = LegScalar<T>;  ///< the scalar of a leg's numbers

  Inertia<T> pelvis{};                                     ///< about the origin of P
  PerLeg<T, std::array<Inertia<L>, kLegJoints>> links{};   ///< about the links' origins
  PerLeg<T, std::array<Vec3<L>, kLegJoints>> offsets_m{};  ///< positions of the joints in their parents
  /// Sole vertices in the foot's frame: front left, front right, rear left, rear right.
  PerLeg<T, std::array<Vec3<L>, kVertices>> vertices_m{};
  PerLeg<T, std::array<Drive<L>, kLegJoints>> drives{};    ///< [pass][joint]
  PerLeg<T, std::array<Clutch<L>, kClutches>> clutches{};  ///< [pass][LegClutch]
  Ground<T> ground{};                                      ///< the same for all vertices
  T creep_radps{};         ///< joint rate below which dry friction is proportional to the rate
  Vec3<T> gravity_mps2{};  ///< acceleration of free fall, in the ground's frame (world)

  Parameters() = default;
  /// Of the described robot; the same in every robot of a SIMD batch.
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

  /// Inertia of link `j` of leg `side`, in the robot's scalar.
  Inertia<T> link(std::size_t side, std::size_t j) const {
    const auto& b = links[Legs<T>::pass(side)][j];
    const auto one = [&](const L& x) { return Legs<T>::read(x, side); };
    const auto& s = b.inertia_kgm2;
    return {one(b.mass_kg),
            {one(b.moment_kgm.x), one(b.moment_kgm.y), one(b.moment_kgm.z)},
            {one(s.xx), one(s.xy), one(s.xz), one(s.yy), one(s.yz), one(s.zz)}};
  }
  /// Sets the inertia of link `j` of leg `side`.
  void set_link(std::size_t side, std::size_t j, const Inertia<T>& body) {
    put(links[Legs<T>::pass(side)][j], side, body);
  }

 protected:
  using V = ValueOf<T>;  ///< the plain number behind the scalar T
  /// Rounds to the plain number.
  static constexpr V as(double x) { return static_cast<V>(x); }
  /// The vector in the scalar S.
  template <class S>
  static Vec3<S> vector(const Vec3<double>& v) {
    return {S(as(v.x)), S(as(v.y)), S(as(v.z))};
  }
  /// Inertia about the link's origin; computed in double, then rounded once.
  template <class S>
  static Inertia<S> inertia(const LinkDescription& d) {
    const Inertia<double> b = tree::inertia_of(d.mass_kg, d.centre_m, d.about_centre_kgm2);
    const Sym3<double>& s = b.inertia_kgm2;
    return {S(as(b.mass_kg)),
            vector<S>(b.moment_kgm),
            {S(as(s.xx)), S(as(s.xy)), S(as(s.xz)), S(as(s.yy)), S(as(s.yz)), S(as(s.zz))}};
  }
  /// Writes the number of leg `side` to `to`; so do the following for structs, member by member.
  static void put(L& to, std::size_t side, const T& x) { Legs<T>::write(to, side, x); }
  /// The same for a vector.
  static void put(Vec3<L>& to, std::size_t side, const Vec3<T>& x) {
    put(to.x, side, x.x), put(to.y, side, x.y), put(to.z, side, x.z);
  }
  /// The same for an inertia.
  static void put(Inertia<L>& to, std::size_t side, const Inertia<T>& x) {
    put(to.mass_kg, side, x.mass_kg);
    put(to.moment_kgm, side, x.moment_kgm);
    auto& s = to.inertia_kgm2;
    const auto& from = x.inertia_kgm2;
    put(s.xx, side, from.xx), put(s.xy, side, from.xy), put(s.xz, side, from.xz);
    put(s.yy, side, from.yy), put(s.yz, side, from.yz), put(s.zz, side, from.zz);
  }
  /// The same for a drive.
  static void put(Drive<L>& to, std::size_t side, const Drive<double>& x) {
    put(to.armature_kgm2, side, T(as(x.armature_kgm2))), put(to.damping_nmspr, side, T(as(x.damping_nmspr)));
    put(to.friction_nm, side, T(as(x.friction_nm))), put(to.kp_nmprad, side, T(as(x.kp_nmprad)));
    put(to.kd_nmsprad, side, T(as(x.kd_nmsprad))), put(to.limit_nm, side, T(as(x.limit_nm)));
  }
  /// The same for a clutch.
  static void put(Clutch<L>& to, std::size_t side, const Clutch<double>& x) {
    put(to.spring_nmprad, side, T(as(x.spring_nmprad))),
        put(to.spring_rest_rad, side, T(as(x.spring_rest_rad)));
    put(to.damping_nmspr, side, T(as(x.damping_nmspr))), put(to.brake_nmprad, side, T(as(x.brake_nmprad)));
    put(to.brake_nmspr, side, T(as(x.brake_nmspr))), put(to.brake_limit_nm, side, T(as(x.brake_limit_nm)));
  }
};

/// [side][joint]: rotation from parent coordinates to those of the joint at angle zero.
using JointFrames = std::array<std::array<Mat3<double>, kLegJoints>, 2>;

/// A robot whose joint frames are rotated against their parents, as by `<origin rpy="...">` in a URDF. Kinematics, accelerations and
/// steps take it in place of Parameters; inertias and vertices are in the axes of their links.
template <class T>
struct TurnedParameters : Parameters<T> {
  using typename Parameters<T>::L;

  PerLeg<T, std::array<Mat3<L>, kLegJoints>> frames{};  ///< [pass][joint]: as in JointFrames

  TurnedParameters() = default;
  /// Of the described robot with these joint frames.
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
