// The topology of a tree, parents and kinds of joints: known at compile time or at run time.
//
// Joints are numbered so that a parent comes before its children; -1 is the base, which is fixed. Every joint carries
// one body. The algorithms use this concept:
//   kCapacity            the size of arrays over joints
//   count()              number of joints
//   parent(i), kind(i)
//   outwards(f)          f(i) for each joint, parents first
//   inwards(f)           f(i) for each joint, children first
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace furcula::dynamics::tree {

/// Kind of a joint: its position is an angle about its axis (rad), or a displacement along it (m).
enum class JointKind : std::uint8_t { revolute, prismatic };

/// Place of a joint in the tree.
struct JointPlace {
  int parent;      ///< index of the parent joint; -1: the base
  JointKind kind;  ///< revolute or prismatic
};

/// What the algorithms need of a topology; besides, outwards() and inwards().
template <class P>
concept Topology = requires(const P& p, std::size_t i) {
  { P::kCapacity } -> std::convertible_to<std::size_t>;
  { p.count() } -> std::convertible_to<std::size_t>;
  { p.parent(i) } -> std::same_as<int>;
  { p.kind(i) } -> std::same_as<JointKind>;
};

/// Known at compile time: `kPlaces` is a std::array of JointPlace. Arrays have the exact size, and where all joints are of
/// one kind the code has no branch on it. Loops over joints are not unrolled: unrolled code took twice the time
/// (benchmarks/tree_bench.cpp, GCC 12).
template <auto kPlaces>
struct StaticTopology {
  static constexpr std::size_t kCapacity = kPlaces.size();  ///< size of arrays over joints
  /// Number of joints.
  static constexpr std::size_t count() { return kCapacity; }
  /// Parent of joint i; -1: the base.
  static constexpr int parent(std::size_t i) { return kPlaces[i].parent; }
  /// Kind of joint i.
  static constexpr JointKind kind(std::size_t i) { return kOneKind ? kPlaces[0].kind : kPlaces[i].kind; }

  /// Calls f(i) for each joint, parents first.
  template <class F>
  [[gnu::always_inline]] static constexpr void outwards(F&& f) {
    for (std::size_t i = 0; i < kCapacity; ++i) f(i);
  }
  /// Calls f(i) for each joint, children first.
  template <class F>
  [[gnu::always_inline]] static constexpr void inwards(F&& f) {
    for (std::size_t i = kCapacity; i-- > 0;) f(i);
  }

 private:
  static constexpr bool parents_come_first() {
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
      if (kPlaces[i].parent < -1 || kPlaces[i].parent >= static_cast<int>(i)) return false;
    return true;
  }
  static constexpr bool kOneKind = [] {
    for (const JointPlace& p : kPlaces)
      if (p.kind != kPlaces[0].kind) return false;
    return true;
  }();
  static_assert(kPlaces.size() > 0 && parents_come_first());
};

/// Built at run time, up to kMost joints, without heap.
template <std::size_t kMost>
class DynamicTopology {
 public:
  static_assert(kMost > 0 && kMost < 32768, "parents are kept in 16 bits");
  static constexpr std::size_t kCapacity = kMost;  ///< size of arrays over joints

  /// Number of joints added.
  std::size_t count() const { return count_; }
  /// Parent of joint i < count(); -1: the base.
  int parent(std::size_t i) const { return parents_[i]; }
  /// Kind of joint i < count().
  JointKind kind(std::size_t i) const { return kinds_[i]; }

  /// Adds the next joint. False, and nothing is added, if the capacity is reached or the parent is not yet there.
  bool add(JointPlace place) {
    if (count_ == kMost || place.parent < -1 || place.parent >= static_cast<int>(count_)) return false;
    parents_[count_] = static_cast<std::int16_t>(place.parent);
    kinds_[count_++] = place.kind;
    return true;
  }

  /// Calls f(i) for each joint, parents first.
  template <class F>
  void outwards(F&& f) const {
    for (std::size_t i = 0; i < count_; ++i) f(i);
  }
  /// Calls f(i) for each joint, children first.
  template <class F>
  void inwards(F&& f) const {
    for (std::size_t i = count_; i-- > 0;) f(i);
  }

 private:
  std::array<std::int16_t, kMost> parents_{};
  std::array<JointKind, kMost> kinds_{};
  std::size_t count_ = 0;
};

}  // namespace furcula::dynamics::tree
