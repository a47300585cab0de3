#include "host/walk/energy_study.hpp"

#include <utility>

#include "host/core/message.hpp"
#include "host/walk/batched_rollout.hpp"
#include "host/walk/search.hpp"

namespace furcula::walk {

using namespace dynamics::biped;

EnergyBalance energy_of(const Description& robot, const RolloutOptions& options, const Parameters& walk) {
  EnergyBalance out;
  BatchedRollout<double> ten(robot, robot, options);
  out.ten_s = ten.run_one(walk);
  out.joints = ten.joint_energy();
  RolloutOptions longer = options;
  longer.time_s = 100.0;
  longer.walk_until_s = 100.0 - (options.time_s - options.walk_until_s);
  out.hundred_s = run_walk(robot, longer, walk);
  return out;
}

Description with_gear(Description robot, double ratio, bool charged) {
  const double squared = ratio * ratio / (robot.gear_ratio * robot.gear_ratio);
  robot.gear_ratio = ratio;
  if (!charged) return robot;
  for (auto& leg : robot.drives)
    for (auto& d : leg)
      for (double* x : {&d.armature_kgm2, &d.kp_nmprad, &d.kd_nmsprad}) *x *= squared;
  return robot;
}

namespace {

template <class F>
Description changed(Description robot, const F& f) {
  f(robot);
  return robot;
}
template <class F>
Description with_drives(const Description& robot, const F& f) {
  return changed(robot, [&](Description& r) {
    for (auto& leg : r.drives)
      for (auto& d : leg) f(d);
  });
}

std::vector<EnergyCase> cases_of(const Description& robot, WalkMode mode) {
  std::vector<EnergyCase> out;
  const auto add = [&](std::string what, Description r, WalkMode m) {
    out.push_back({std::move(what), r, m, false, {}, {}, {}});
  };
  add("as it is", robot, mode);
  add(std::string(kGear500), with_gear(robot, 500.0, false), mode);
  add(std::string(kGear500Charged), with_gear(robot, 500.0, true), mode);
  add("winding of half the resistance", changed(robot, [](Description& r) { r.resistance_ohm *= 0.5; }),
      mode);
  add("rotor of half the inertia",
      with_drives(robot,
                  [](auto& d) {
                    for (double* x : {&d.armature_kgm2, &d.kp_nmprad, &d.kd_nmsprad}) *x *= 0.5;
                  }),
      mode);
  add("gear of half the friction",
      with_drives(robot, [](auto& d) { d.friction_nm *= 0.5, d.damping_nmspr *= 0.5; }), mode);
  add("foot lighter by 0.5 kg",
      changed(robot,
              [](Description& r) {
                for (auto& leg : r.legs) {
                  LinkDescription& foot = leg[kLegJoints - 1];
                  const double share = (foot.mass_kg - 0.5) / foot.mass_kg;
                  foot.mass_kg -= 0.5;
                  auto& s = foot.about_centre_kgm2;
                  for (double* x : {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz}) *x *= share;
                }
              }),
      mode);
  add("50 W for computer and drives", changed(robot, [](Description& r) { r.constant_power_w = 50.0; }),
      mode);
  if (mode == WalkMode::semi_passive) {
    add("motors of the passive hips follow their links", robot, mode);
    out.back().hips_follow = true;
    for (const double factor : {0.5, 2.0})
      add(factor < 1.0 ? "hip spring of half the rate" : "hip spring of twice the rate",
          changed(robot,
                  [&](Description& r) {
                    for (auto& leg : r.clutches) leg[kHipClutch].spring_nmprad *= factor;
                  }),
          mode);
  }
  if (mode == WalkMode::active) {
    add("swing knee free (knee_passive)", robot, WalkMode::knee_passive);
    add("stance knee braked (knee_braked)", robot, WalkMode::knee_braked);
  }
  return out;
}

}  // namespace

std::vector<EnergyCase> study_energy(const Model& model, const Walk& walk,
                                     const EnergyStudyOptions& options) {
  std::vector<EnergyCase> cases = cases_of(model.robot, walk.mode);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EnergyCase& c = cases[i];
    const auto tell = [&](double share, const std::string& doing) {
      if (options.progress)
        options.progress((static_cast<double>(i) + share) / static_cast<double>(cases.size()), doing);
    };
    tell(0.0, c.what);
    RolloutOptions rollout;
    rollout.mode = c.mode;
    rollout.hips_follow = c.hips_follow;
    rollout.walk_until_s = walk.walk_until_s;
    rollout.limits = model.limits;
    c.walk = walk.parameters;
    c.same = energy_of(c.robot, rollout, c.walk);
    if (options.steps == 0) continue;
    SearchOptions search;
    search.rollout = rollout;
    search.seed = options.seed;
    search.steps = options.steps;
    search.threads = options.threads;
    search.start = walk.parameters;
    search.progress = [&](double share, const std::string& doing) { tell(share, c.what + ": " + doing); };
    const SearchResult found = search_walk(c.robot, search);
    if (!found.found) continue;
    c.walk = found.walk;
    c.sought = energy_of(c.robot, rollout, c.walk);
  }
  return cases;
}

}  // namespace furcula::walk
