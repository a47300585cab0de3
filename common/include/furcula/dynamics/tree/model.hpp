// A tree of rigid bodies and joints: geometry, inertias, and the forces in each joint.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "furcula/core/status.hpp"
#include "furcula/dynamics/scalar.hpp"
#include "furcula/dynamics/tree/spatial.hpp"
#include "furcula/dynamics/tree/topology.hpp"

namespace furcula::dynamics::tree {

/// Armature, damping, springs and friction of a joint. Units of a revolute joint; for a prismatic joint read N for
/// N m, m for rad, kg for kg m^2. The torque on the joint is
///   tau - damping qd - stiffness (q - rest) - unilateral spring - drag qd |qd| - dry friction
/// Dry friction (dry_friction.hpp) is the sum of Coulomb friction, load friction and that of the binding spot. Zero
/// coefficients have no effect; none may be negative.
template <class T>
struct JointLaw {
  T armature_kgm2{};           ///< the rotor's inertia times the square of its gear ratio
  T damping_nmspr{};           ///< viscous
  T stiffness_nmprad{};        ///< of a spring between body and parent
  T rest_rad{};                ///< position at which that spring is relaxed
  T one_way_nmprad{};          ///< of a unilateral spring: torque -rate max(q - rest, 0)
  T one_way_rest_rad{};        ///< position below which the unilateral spring is slack
  bool two_sided = false;      ///< that spring is not slack below its rest: torque -rate (q - rest)
  T friction_nm{};             ///< kinetic Coulomb friction
  T static_friction_nm{};      ///< break-away torque without load; friction_nm where that is larger
  bool elastic = false;        ///< the rotor is a body of its own, coupled to the joint by a spring
  T drive_stiffness_nmprad{};  ///< of that spring
  T drive_damping_nmspr{};     ///< of a damper parallel to that spring
  T rotor_damping_nmspr{};     ///< viscous, of an elastic drive's rotor against the body that carries it
  T friction_back_nm{};        ///< where asymmetric: Coulomb friction in the negative direction
  bool asymmetric = false;     ///< friction_nm applies in the positive direction only
  /// If above zero, kinetic friction falls from static_friction_nm, Fs, to friction_nm, Fc, as
  /// Fc + (Fs - Fc) exp(-(qd / this)^2): the Stribeck curve, `stribeck_friction` of docs/contracts.md.
  T stribeck_velocity_radps{};
  T load_friction_ratio{};  ///< dry friction over |drive torque at the joint|, static and kinetic
  T binding_friction_nm{};  ///< added dry friction where |q - centre| <= width / 2
  T binding_centre_rad{};   ///< centre of the binding spot
  T binding_width_rad{};    ///< full width of the binding spot
  T drag_nms2prad2{};       ///< quadratic drag

  /// Equal in all members.
  friend bool operator==(const JointLaw&, const JointLaw&) = default;
};

/// The law with another scalar: `number` makes it of a pointer to a member of `law` that is not a flag.
template <class T, class U, class F>
JointLaw<T> joint_law_of(const JointLaw<U>& law, const F& number) {
  using Law = JointLaw<U>;
  return {.armature_kgm2 = number(&Law::armature_kgm2),
          .damping_nmspr = number(&Law::damping_nmspr),
          .stiffness_nmprad = number(&Law::stiffness_nmprad),
          .rest_rad = number(&Law::rest_rad),
          .one_way_nmprad = number(&Law::one_way_nmprad),
          .one_way_rest_rad = number(&Law::one_way_rest_rad),
          .two_sided = law.two_sided,
          .friction_nm = number(&Law::friction_nm),
          .static_friction_nm = number(&Law::static_friction_nm),
          .elastic = law.elastic,
          .drive_stiffness_nmprad = number(&Law::drive_stiffness_nmprad),
          .drive_damping_nmspr = number(&Law::drive_damping_nmspr),
          .rotor_damping_nmspr = number(&Law::rotor_damping_nmspr),
          .friction_back_nm = number(&Law::friction_back_nm),
          .asymmetric = law.asymmetric,
          .stribeck_velocity_radps = number(&Law::stribeck_velocity_radps),
          .load_friction_ratio = number(&Law::load_friction_ratio),
          .binding_friction_nm = number(&Law::binding_friction_nm),
          .binding_centre_rad = number(&Law::binding_centre_rad),
          .binding_width_rad = number(&Law::binding_width_rad),
          .drag_nms2prad2 = number(&Law::drag_nms2prad2)};
}

/// A point of a body that is fixed in the world: a stance foot that neither slips nor lifts off.
template <class V>
struct Foothold {
  int joint = -1;  ///< joint of the body; -1: no foothold
  Vec3<V> at_m{};  ///< position of the point in the body's link frame
};

/// A tree of rigid bodies, one for each joint. Geometry is in plain numbers: it is measured, not fitted. Everything else has
/// the scalar T.
///
/// A body's own frame ("link frame", as in a URDF) is fixed in the body with its origin on the joint's axis; at
/// joint position zero its pose is `placement` of add(). Internally each body has an aligned frame, rotated so that the
/// joint's axis is z: then all joints have the same equations, without products with the axis.
///
/// The base is fixed in the world. A floating base would need its own 6 x 6 system at the end of the inward pass of
/// forward_dynamics. Three prismatic and three revolute joints with massless bodies between them act as one (away from
/// +-90 degrees of the middle angle); the tests use them so.
template <class T, Topology P>
class Model {
 public:
  using Scalar = T;                                       ///< of inertias, joint coefficients and states
  using V = ValueOf<T>;                                   ///< the plain number behind T, of the geometry
  using Shape = P;                                        ///< the topology
  static constexpr std::size_t kCapacity = P::kCapacity;  ///< size of arrays over joints
  using Joints = std::array<T, kCapacity>;                ///< one number for each joint
  using Flags = std::array<bool, kCapacity>;              ///< one flag for each joint

  /// Acceleration of free fall, world axes, m/s^2.
  Vec3<T> gravity_mps2{T(V(0)), T(V(0)), T(V(-9.81))};
  std::array<JointLaw<T>, kCapacity> laws{};  ///< damping, springs and friction, by joint
  Foothold<V> foothold;                       ///< of the stance foot, if any

  Model() = default;
  /// The same tree with another scalar, or with another topology that has room for it. Conversion from dual to plain numbers keeps the
  /// values only.
  template <class U, Topology Q>
  requires(!std::is_same_v<U, T> || !std::is_same_v<P, Q>) explicit Model(const Model<U, Q>& m)
      : gravity_mps2(vec<T>(m.gravity_mps2)),
        foothold{m.foothold.joint, vec<V>(m.foothold.at_m)},
        placed_(m.count()) {
    if constexpr (std::is_same_v<P, Q>)
      shape_ = m.shape();
    else
      for (std::size_t i = 0; i < m.count(); ++i) shape_.add({m.shape().parent(i), m.shape().kind(i)});
    for (std::size_t i = 0; i < m.count(); ++i) {
      laws[i] = joint_law_of<T>(m.laws[i], [&](auto coefficient) { return as<T>(m.laws[i].*coefficient); });
      aligned_[i] = plain(m.aligned(i));
      tree_[i] = plain(m.tree(i));
      const Inertia<U>& b = m.aligned_inertia(i);
      const Sym3<U>& s = b.inertia_kgm2;
      bodies_[i] = {as<T>(b.mass_kg),
                    vec<T>(b.moment_kgm),
                    {as<T>(s.xx), as<T>(s.xy), as<T>(s.xz), as<T>(s.yy), as<T>(s.yz), as<T>(s.zz)}};
    }
  }

  /// The topology.
  const P& shape() const { return shape_; }
  /// Number of joints: of those added, or of a static topology.
  std::size_t count() const { return shape_.count(); }

  /// Adds the next joint: `placement` is the link frame in the parent's link frame (for the base: in the world) at joint
  /// position zero, `axis` is in the link frame, of any length but zero, and `body` is about the link frame's origin, in
  /// link axes. Status::invalid: capacity exceeded, parent not added yet, axis of length zero or not finite; for a static
  /// topology, parent or kind that differ from it.
  Status add(JointPlace place, const Frame<V>& placement, const Vec3<V>& axis, const Inertia<T>& body) {
    const V length = std::sqrt(dot(axis, axis));
    if (!(length > V(0)) || !std::isfinite(length)) return Status::invalid;
    if constexpr (requires { shape_.add(place); }) {
      if (!shape_.add(place)) return Status::invalid;
    } else {
      if (placed_ >= count() || shape_.parent(placed_) != place.parent || shape_.kind(placed_) != place.kind)
        return Status::invalid;
    }
    const std::size_t i = placed_++;
    aligned_[i] = {z_along(axis * (V(1) / length)), {V(0), V(0), V(0)}};
    const Frame<V> in_parent = within(placement, aligned_[i]);
    tree_[i] = in_parent;
    if (place.parent >= 0) {
      const Mat3<V>& a = aligned_[static_cast<std::size_t>(place.parent)].turn;
      tree_[i] = {in_parent.turn * transposed(a), a * in_parent.at};
    }
    set_body(i, body);
    return Status::ok;
  }

  /// Sets the inertia of body i, about its link frame's origin, in link axes.
  void set_body(std::size_t i, const Inertia<T>& body) {
    bodies_[i] = inertia_back(Frame<V>{transposed(aligned_[i].turn), {V(0), V(0), V(0)}}, body);
  }
  /// The inertia of body i, about its link frame's origin, in link axes.
  Inertia<T> body(std::size_t i) const {
    return inertia_back(Frame<V>{aligned_[i].turn, {V(0), V(0), V(0)}}, bodies_[i]);
  }

  /// Sets the inertia of body i, in its aligned frame.
  void set_aligned_inertia(std::size_t i, const Inertia<T>& body) { bodies_[i] = body; }

  /// Increases the distance of joint i from its parent's joint by `by_m`, in the same direction; no effect at distance zero.
  void extend(std::size_t i, V by_m) {
    Vec3<V>& at = tree_[i].at;
    const V length = std::sqrt(dot(at, at));
    if (length > V(0)) at = at * (V(1) + by_m / length);
  }

  /// The aligned frame of body i in its link frame.
  const Frame<V>& aligned(std::size_t i) const { return aligned_[i]; }
  /// The aligned frame of body i at joint position zero, in the parent's aligned frame.
  const Frame<V>& tree(std::size_t i) const { return tree_[i]; }
  /// The inertia of body i in its aligned frame.
  const Inertia<T>& aligned_inertia(std::size_t i) const { return bodies_[i]; }

  /// The aligned frame of body i at joint position q, in the parent's aligned frame.
  [[gnu::always_inline]] Frame<T> frame(std::size_t i, const T& q) const {
    using std::cos;
    using std::sin;
    const Mat3<V>& e = tree_[i].turn;
    const Vec3<V>& r = tree_[i].at;
    if (shape_.kind(i) == JointKind::prismatic)
      return {{vec<T>(e.x), vec<T>(e.y), vec<T>(e.z)}, {r.x + e.z.x * q, r.y + e.z.y * q, r.z + e.z.z * q}};
    const T s = sin(q), c = cos(q);
    return {{{e.x.x * c + e.y.x * s, e.x.y * c + e.y.y * s, e.x.z * c + e.y.z * s},
             {e.y.x * c - e.x.x * s, e.y.y * c - e.x.y * s, e.y.z * c - e.x.z * s},
             vec<T>(e.z)},
            vec<T>(r)};
  }

 private:
  template <class To, class From>
  static constexpr To as(const From& x) {
    if constexpr (std::is_arithmetic_v<To>)
      return static_cast<To>(value_of(x));
    else
      return To(x);
  }
  template <class To, class From>
  static constexpr Vec3<To> vec(const Vec3<From>& v) {
    return {as<To>(v.x), as<To>(v.y), as<To>(v.z)};
  }
  template <class From>
  static Frame<V> plain(const Frame<From>& f) {
    return {{vec<V>(f.turn.x), vec<V>(f.turn.y), vec<V>(f.turn.z)}, vec<V>(f.at)};
  }
  /// The shortest turn to axes whose z is `a`, of length 1; the identity for z itself.
  static Mat3<V> z_along(const Vec3<V>& a) {
    if (a.z < V(0)) {
      const Mat3<V> m = z_along(Vec3<V>{a.x, -a.y, -a.z});
      return {{m.x.x, -m.x.y, -m.x.z}, {m.y.x, -m.y.y, -m.y.z}, {m.z.x, -m.z.y, -m.z.z}};
    }
    const V k = V(1) / (V(1) + a.z);
    return {{V(1) - a.x * a.x * k, -a.x * a.y * k, -a.x}, {-a.x * a.y * k, V(1) - a.y * a.y * k, -a.y}, a};
  }

  P shape_{};
  std::size_t placed_ = 0;
  std::array<Frame<V>, kCapacity> aligned_{}, tree_{};
  std::array<Inertia<T>, kCapacity> bodies_{};
};

}  // namespace furcula::dynamics::tree
