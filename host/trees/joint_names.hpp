// How alike two names of joints are: of a URDF and of a log, which abbreviate, order and write words otherwise.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace furcula::trees {

/// A name's words in lower case: "LHipPitch" is "left", "hip", "pitch"; "joint_07" is "joint", "7".
std::vector<std::string> words_of(const std::string& name);

/// A name, ready to be compared with many.
class JointName {
 public:
  explicit JointName(std::string name);
  const std::string& name() const { return name_; }

 private:
  friend class Likeness;
  friend double similarity(const JointName& a, const JointName& b);
  std::string name_, joined_;
  std::vector<std::string> words_, telling_, sorted_;
  std::vector<std::string> sides_, bare_;  ///< the telling ones that are a side, in order; the others
};

/// Ways in which two names are taken for one joint's, the surest first.
class Likeness {
 public:
  static constexpr std::size_t kWays = 6;
  /// From here on one name says less than the other, so that a third may be meant: they are taken only where no other name is as alike.
  static constexpr std::size_t kLessSaid = 3;
  /// These say too little to take one name for the other unasked.
  static constexpr std::size_t kAsked = 5;

  /// 0: the same words. 1: without "joint" and the like, also where words are written together. 2: in another order. 3: each word of one begins that
  /// of the other, "sh_p" and "shoulder_pitch". 4: one has further words in front, "robot/elbow" and "elbow".
  /// 5: each word of one has the other's letters in their order, "shldr" and "shoulder".
  static bool alike(std::size_t way, const JointName& a, const JointName& b);
  /// The sides (left, right, front, rear) that one of two names alike by way 4 has and the other lacks.
  static std::vector<std::string> further_sides(const JointName& a, const JointName& b);
};

/// From 0, nothing in common, to 1. Of each word the share of its letters that it has in common with one of the other name; of numbers all or nothing.
double similarity(const JointName& a, const JointName& b);

/// One-to-one pairs of rows and columns of the largest sum; a pair of weight 0 is none. `weights[row][column]` are not below 0.
std::vector<std::optional<std::size_t>> best_assignment(const std::vector<std::vector<double>>& weights);

}  // namespace furcula::trees
