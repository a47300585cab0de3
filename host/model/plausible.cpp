// Units of a robot's numbers, see plausible.hpp.
//
// A body of mass m with the moments A, B, C about its centre has the radius of gyration k, k^2 = max(A, B, C) / m, and reaches at least so far
// from its centre. The size of a robot is known a second time: by where its joints and centres of mass are. The two must go together.
//
// From below: A + B + C is twice the integral of r^2 dm. Of all bodies of that mass no denser than d the ball has the least, 6/5 m r^2 with
// r^3 = 3 m / (4 pi d). No matter is denser than osmium, 22,600 kg/m^3.
#include "host/model/plausible.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/linear/linear.hpp"
#include "host/model/urdf_filter.hpp"

namespace furcula::model {
namespace {

constexpr double kOsmium_kgpm3 = 22600.0;

/// Of the largest machines with joints: cranes' booms are up to 100 m long.
constexpr double kLongest_m = 100.0;
/// Robots whose joints are further apart are machines of such a size, and their bodies are, too.
constexpr double kLong_m = 10.0;

/// Smaller ones are parts of robots: fingers, wrists, wheels that turn about their centre.
constexpr double kSmallest_m = 0.3;

struct Body {
  std::size_t link;  ///< with the largest moments of those that are one
  double mass_kg, largest_kgm2, sum_kgm2;
  double size_m;    ///< how far centre and next joints are from its joint
  double length_m;  ///< as if the centre were half-way along it, or up to the next joint

  double radius_m(double mass_scale = 1.0, double inertia_scale = 1.0) const {
    return std::sqrt(largest_kgm2 * inertia_scale / (mass_kg * mass_scale));
  }
  bool has_volume() const { return mass_kg > 0.0 && largest_kgm2 > 0.0; }
};

/// Of a ball of osmium.
double ball_radius_m(double mass_kg) {
  return std::cbrt(3.0 * mass_kg / (4.0 * std::numbers::pi * kOsmium_kgpm3));
}
bool too_dense(const Body& b, double mass_scale = 1.0, double inertia_scale = 1.0) {
  const double m = b.mass_kg * mass_scale, r = ball_radius_m(m);
  return b.sum_kgm2 * inertia_scale < 1.2 * m * r * r;
}

std::string metres(double m) {
  return m >= 1000.0 ? core::rounded(m / 1000.0, 2) + " km" : core::rounded(m, 2) + " m";
}
double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}
double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

/// A unit that somebody may have written in.
struct Unit {
  std::string_view name;
  double mass, inertia;  ///< times these it is SI
};
constexpr Unit kUnits[] = {{"kg cm^2: x 1e-4", 1.0, 1e-4},
                           {"kg mm^2: x 1e-6", 1.0, 1e-6},
                           {"g cm^2: x 1e-7", 1.0, 1e-7},
                           {"g mm^2: x 1e-9", 1.0, 1e-9},
                           {"t mm^2: x 1e-3", 1.0, 1e-3},
                           {"the masses are in g, x 1e-3", 1e-3, 1.0},
                           {"masses in g, x 1e-3, and g cm^2, x 1e-7", 1e-3, 1e-7},
                           {"masses in g, x 1e-3, and g mm^2, x 1e-9", 1e-3, 1e-9}};
struct LengthUnit {
  std::string_view name;
  double scale;
};
constexpr LengthUnit kLengths[] = {{"mm: x 0.001", 1e-3}, {"cm: x 0.01", 1e-2}, {"inches: x 0.0254", 0.0254}};

using Bodies = std::vector<const Body*>;

class Judge {
 public:
  Judge(RobotTree& tree, const Urdf& robot) : tree_(tree), robot_(robot) {
    for (std::size_t i = 0; i < tree.joints.size(); ++i) bodies_.push_back(body(i));
    for (const Body& b : bodies_) reach_m_ += b.size_m;
    reach_m_ = std::max(reach_m_, kSmallest_m);
  }

  void lengths() const {
    std::size_t worst = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (bodies_[i].size_m > bodies_[worst].size_m) worst = i;
    const double size_m = bodies_[worst].size_m;
    std::vector<double> radii;
    for (const Body& b : bodies_)
      if (b.has_volume()) radii.push_back(b.radius_m());
    // Bodies are smaller than what they are far apart, but seldom by a hundred.
    constexpr double kApart = 100.0;
    const bool small_bodies =
        !radii.empty() && *std::max_element(radii.begin(), radii.end()) < size_m / kApart;
    if (!(size_m > kLongest_m || (size_m > kLong_m && small_bodies))) return;
    // Links reach some three radii of gyration from their joint: a rod that turns about its end sqrt(12).
    std::string unit;
    if (small_bodies) {
      constexpr double kUsual = 3.0;
      const double ratio = size_m / median(radii) / kUsual;
      const auto off = [&](const LengthUnit& u) { return std::abs(std::log(ratio * u.scale)); };
      const auto* best = std::min_element(std::begin(kLengths), std::end(kLengths),
                                          [&](const auto& a, const auto& b) { return off(a) < off(b); });
      unit = " (" + std::string(best->name) + ")";
    } else {
      unit = " (mm: x 0.001; moments of inertia in kg mm^2 then x 1e-6)";
    }
    const std::string radius = small_bodies ? ", and the largest body has a radius of gyration of " +
                                                  metres(*std::max_element(radii.begin(), radii.end()))
                                            : "";
    fail(bodies_[worst].link, "link " + core::quoted(robot_.links[bodies_[worst].link].name) +
                                  ": its centre of mass or the next joint is " + metres(size_m) +
                                  " away from its joint" + radius +
                                  "; expected metres; are the lengths in another unit" + unit + "?");
  }

  void inertias(bool accept) {
    // A body ten times as large as the robot, and more of an inertia than the whole robot at full reach. Ten is half of the way, in factors, to kg cm^2,
    // the nearest of the units. Round numbers that somebody put in for all bodies come that far, too, on small robots: below a radius of ten metres it
    // is said and taken.
    constexpr double kBeyond = 10.0;
    double mass_kg = 0.0;
    for (const Body& b : bodies_) mass_kg += std::max(b.mass_kg, 0.0);
    Bodies large, dense, all;
    for (const Body& b : bodies_) {
      if (!b.has_volume()) continue;
      all.push_back(&b);
      if (too_dense(b)) dense.push_back(&b);
      if (b.radius_m() > kBeyond * reach_m_ && b.largest_kgm2 > mass_kg * reach_m_ * reach_m_)
        large.push_back(&b);
    }
    std::string unit;
    if (!large.empty()) {
      const Body& b = **std::max_element(large.begin(), large.end(), [](const Body* x, const Body* y) {
        return x->radius_m() < y->radius_m();
      });
      unit = asked(unit_of(all, true).unit);
      if (unit.empty()) unit = asked(unit_of(large, true).unit);
      if (!accept && b.radius_m() >= kLong_m)
        refuse(b, figures(b) + " asks for a body with a radius of " + metres(b.radius_m()),
               "expected kg m^2" + unit);
    }
    note_oversized(large, unit);
    if (dense.empty()) return;
    if (dense.size() == all.size()) {
      // In a unit that is nearer to what bodies are by more than half the way; else the moments are small for another reason.
      const Fitting now = unit_of(all, false, true), other = unit_of(all, false);
      if (other.unit != nullptr && other.off < 0.5 * now.off) {
        const Body& b = *dense.front();
        const double r = ball_radius_m(b.mass_kg);
        const std::string what =
            figures(b) + " asks for a body denser than any matter (a ball of osmium has " +
            core::rounded(0.4 * b.mass_kg * r * r, 3) + " kg m^2), as those of all links do";
        const std::string expected = "expected kg and kg m^2" + asked(other.unit);
        if (!accept) refuse(b, what, expected);
        tree_.notes.push_back("Taken as it is, " + who(b) + what + "; " + expected);
        return;
      }
    }
    std::vector<std::string> names;
    for (const Body* b : dense) names.push_back(core::quoted(robot_.links[b->link].name));
    tree_.notes.push_back(
        "Moments of inertia so small that they ask for a body denser than any matter: link " +
        first_names(names) + ". Each is hardly more than a point mass.");
  }

 private:
  [[noreturn]] void fail(std::size_t link, const std::string& message) const {
    const UrdfLink& at = robot_.links[link];
    throw core::DataError((at.file.empty() ? robot_.file : at.file) + ":" + std::to_string(at.line) + ": " +
                          message);
  }
  static std::string figures(const Body& b) {
    return "its <inertia> of " + core::rounded(b.largest_kgm2, 3) + " kg m^2 with " +
           core::rounded(b.mass_kg, 3) + " kg";
  }
  static std::string asked(const Unit* unit) {
    return unit == nullptr ? "" : "; are they in another unit (" + std::string(unit->name) + ")?";
  }
  std::string who(const Body& b) const { return "link " + core::quoted(robot_.links[b.link].name) + ": "; }
  [[noreturn]] void refuse(const Body& b, const std::string& what, const std::string& expected) const {
    fail(b.link, who(b) + what + "; " + expected +
                     " (--accept-inertias, or accept_inertias = true in [model], takes them as they are)");
  }
  /// Three moments that are equal are those of a ball or a cube: with a radius of gyration above the length of the whole robot it has all of the robot within it.
  /// A program that exports links without their inertias puts such numbers in.
  bool is_placeholder(const UrdfInertia& i) const {
    const auto& o = i.about_centre_kgm2;
    return i.mass_kg > 0.0 && o.xx == o.yy && o.yy == o.zz && o.xy == 0.0 && o.xz == 0.0 && o.yz == 0.0 &&
           o.xx > i.mass_kg * reach_m_ * reach_m_;
  }
  void note_oversized(const Bodies& large, const std::string& unit) {
    std::map<std::size_t, std::string> of_links;
    const auto add = [&](std::size_t link, double inertia_kgm2, double mass_kg) {
      of_links.emplace(link, core::quoted(robot_.links[link].name) + " (" + core::rounded(inertia_kgm2, 3) +
                                 " kg m^2 with " + core::rounded(mass_kg, 3) + " kg, " +
                                 metres(std::sqrt(inertia_kgm2 / mass_kg)) + ")");
    };
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (const auto& its = robot_.links[i].inertia; tree_.links[i].joint >= 0 && its && is_placeholder(*its))
        add(i, its->about_centre_kgm2.xx, its->mass_kg);
    const bool placeholders = !of_links.empty();
    for (const Body* b : large) add(b->link, b->largest_kgm2, b->mass_kg);
    if (of_links.empty()) return;
    std::vector<std::string> links;
    for (const auto& [link, text] : of_links) links.push_back(text);
    tree_.notes.push_back(
        "Moments of inertia whose radius of gyration is larger than the robot: link " + first_names(links) +
        ". Taken as they are; expected those of the links, in kg m^2" +
        (placeholders ? "; are they placeholders" +
                            (unit.empty() ? "?" : ", or" + unit.substr(std::string_view("; are they").size()))
         : unit.empty() ? "."
                        : unit));
  }
  Body body(std::size_t joint) const {
    const auto merged = tree_.model.body(joint);
    Body out{0, merged.mass_kg, 0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < tree_.links.size(); ++i)
      if (tree_.links[i].name == tree_.joints[joint].link) out.link = i;
    if (merged.mass_kg > 0.0) {
      const Vec3<double> centre = merged.moment_kgm * (1.0 / merged.mass_kg);
      out.size_m = length(centre);
      out.length_m = 2.0 * out.size_m;
      const auto s = dynamics::tree::minus_squared_cross(centre);
      const auto& o = merged.inertia_kgm2;
      const double m = merged.mass_kg;
      Eigen::Matrix3d about;
      about << o.xx - m * s.xx, o.xy - m * s.xy, o.xz - m * s.xz, o.xy - m * s.xy, o.yy - m * s.yy,
          o.yz - m * s.yz, o.xz - m * s.xz, o.yz - m * s.yz, o.zz - m * s.zz;
      const Eigen::Vector3d moments = linear::axes_values_of_three(about);
      // What cancels is zero: of a point mass nothing is left about its centre.
      constexpr double kZero = 1e-12;
      if (moments(2) > kZero * (o.xx + o.yy + o.zz)) {
        out.largest_kgm2 = moments(2);
        out.sum_kgm2 = about.trace();
      }
      double most = -1.0;
      for (std::size_t i = 0; i < tree_.links.size(); ++i) {
        if (tree_.links[i].joint != static_cast<int>(joint) || !robot_.links[i].inertia) continue;
        const auto& its = robot_.links[i].inertia->about_centre_kgm2;
        if (its.xx + its.yy + its.zz > most) {
          most = its.xx + its.yy + its.zz;
          out.link = i;
        }
      }
    }
    for (std::size_t k = joint + 1; k < tree_.joints.size(); ++k) {
      if (tree_.model.shape().parent(k) != static_cast<int>(joint)) continue;
      const double away_m = length(tree_.joints[k].placement.at);
      out.size_m = std::max(out.size_m, away_m);
      out.length_m = std::max(out.length_m, away_m);
    }
    return out;
  }

  struct Fitting {
    const Unit* unit;
    double off;  ///< logarithm of the radii of gyration over usual ones, without its sign
  };
  /// The unit in which all bodies are of a size that goes with that of the links, within a factor of ten; or how they are as they stand.
  Fitting unit_of(const Bodies& bodies, bool smaller, bool as_it_is = false) const {
    static constexpr Unit kSi{"SI", 1.0, 1.0};
    Fitting best{nullptr, std::log(10.0)};
    const auto judge = [&](const Unit& u) {
      double off = 0.0;
      bool fits = true;
      for (const Body* b : bodies) {
        const double radius_m = b->radius_m(u.mass, u.inertia);
        fits &= !too_dense(*b, u.mass, u.inertia) && radius_m < std::max(reach_m_, 1.0);
        // A rod's radius of gyration is 0.29 of its length; of a body whose length is not known, four times that of its ball of osmium, which is that of
        // a ball of a machine's mean density.
        const double usual_m =
            b->length_m > 0.0 ? 0.29 * b->length_m : 4.0 * ball_radius_m(b->mass_kg * u.mass);
        off += std::log(radius_m / usual_m) / static_cast<double>(bodies.size());
      }
      if (as_it_is || (fits && std::abs(off) < best.off)) best = {&u, std::abs(off)};
    };
    if (as_it_is) {
      judge(kSi);
      return best;
    }
    for (const Unit& u : kUnits)
      if ((u.inertia / u.mass < 1.0) == smaller) judge(u);
    return best;
  }

  RobotTree& tree_;
  const Urdf& robot_;
  std::vector<Body> bodies_;
  double reach_m_ = 0.0;
};

}  // namespace

void judge_units(RobotTree& tree, const Urdf& robot, bool accept) {
  Judge judge(tree, robot);
  judge.lengths();
  judge.inertias(accept);
}

}  // namespace furcula::model
