// How fast the accelerations of a tree are, beside MuJoCo's without contact in the same run: chains of
// revolute joints on skew axes.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "furcula/dynamics/tree/plant.hpp"
#include "host/identify/dual.hpp"
#include "host/trees/run.hpp"
#ifdef FURCULA_MUJOCO
#include <mujoco/mujoco.h>
#endif

namespace {

using namespace furcula::dynamics::tree;

/// In which the joints' axes, offsets and bodies all differ; no zeros that a compiler could use.
template <class M>
M chain(std::size_t joints) {
  using T = typename M::Scalar;
  M m;
  for (std::size_t i = 0; i < joints; ++i) {
    const double k = static_cast<double>(i);
    const Vec3<double> axis{std::sin(1.0 + k), std::cos(2.0 * k), 0.3 + 0.1 * k};
    const Frame<double> place{identity<double>(), {0.1, 0.05 * std::cos(k), 0.2}};
    const Inertia<T> body = inertia_of(T(1.0 + 0.1 * k), Vec3<T>{T(0.02), T(0.03), T(0.1)},
                                       Sym3<T>{T(0.02), T(0.001), T(0.002), T(0.03), T(0.001), T(0.025)});
    if (m.add({static_cast<int>(i) - 1, JointKind::revolute}, place, axis, body) != furcula::Status::ok)
      return {};
    m.laws[i].armature_kgm2 = T(0.01);
    m.laws[i].damping_nmspr = T(0.1);
  }
  return m;
}

template <std::size_t kJoints>
constexpr std::array<JointPlace, kJoints> in_series() {
  std::array<JointPlace, kJoints> out{};
  for (std::size_t i = 0; i < kJoints; ++i) out[i] = {static_cast<int>(i) - 1, JointKind::revolute};
  return out;
}

template <class M>
void accelerate(benchmark::State& state, std::size_t joints, const std::string& what) {
  using T = typename M::Scalar;
  state.SetLabel(what);
  const M m = chain<M>(joints);
  typename M::Joints q{}, qd{}, tau{};
  for (std::size_t i = 0; i < joints; ++i) {
    q[i] = T(0.3 + 0.2 * static_cast<double>(i));
    qd[i] = T(0.5 - 0.1 * static_cast<double>(i));
    tau[i] = T(0.2);
  }
  Accelerations<M> out;
  for (auto _ : state) {
    forward_dynamics(m, q, qd, tau, {}, out);
    benchmark::DoNotOptimize(out);
    q[0] += 1e-9 * out.joint_radps2[0];  // so that no call is the last one's
  }
}

void tree_forward_dynamic(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  accelerate<Model<double, DynamicTopology<12>>>(
      state, n, "accelerations of a tree of so many joints, known at run time");
}
BENCHMARK(tree_forward_dynamic)->Arg(2)->Arg(6)->Arg(12);

template <std::size_t kJoints>
void tree_forward_static(benchmark::State& state) {
  static constexpr auto kPlaces = in_series<kJoints>();
  accelerate<Model<double, StaticTopology<kPlaces>>>(state, kJoints, "the same, known when compiled");
}
BENCHMARK(tree_forward_static<2>);
BENCHMARK(tree_forward_static<6>);
BENCHMARK(tree_forward_static<12>);

void tree_forward_with_derivatives(benchmark::State& state) {
  accelerate<Model<furcula::identify::Dual<8>, DynamicTopology<12>>>(
      state, static_cast<std::size_t>(state.range(0)), "the same at run time, with eight derivatives");
}
BENCHMARK(tree_forward_with_derivatives)->Arg(2)->Arg(6);

void step(benchmark::State& state, const JointLaw<double>& friction) {
  auto m = chain<Model<double, DynamicTopology<12>>>(6);
  for (auto& law : m.laws) {
    const double armature = law.armature_kgm2, damping = law.damping_nmspr;
    law = friction;
    law.armature_kgm2 = armature;
    law.damping_nmspr = damping;
  }
  Plant<double, DynamicTopology<12>> plant(m);
  plant.reset({0.3, 0.5, 0.7, 0.9, 1.1, 1.3}, {});
  double sign = 1.0;
  for (auto _ : state) {
    plant.advance({sign, sign, sign, sign, sign, sign}, 1e-3);
    if (plant.velocities()[0] * sign > 1.0) sign = -sign;
    benchmark::DoNotOptimize(plant.positions());
  }
}
void tree_step(benchmark::State& state) {
  state.SetLabel("1 ms of six joints in dry friction");
  step(state, {.friction_nm = 0.1});
}
BENCHMARK(tree_step);
void tree_step_with_all_laws(benchmark::State& state) {
  state.SetLabel("the same with every law of friction, and drag");
  step(state, {.friction_nm = 0.08,
               .static_friction_nm = 0.12,
               .friction_back_nm = 0.1,
               .asymmetric = true,
               .stribeck_velocity_radps = 0.3,
               .load_friction_ratio = 0.05,
               .binding_friction_nm = 0.05,
               .binding_centre_rad = 0.5,
               .binding_width_rad = 0.2,
               .drag_nms2prad2 = 0.01});
}
BENCHMARK(tree_step_with_all_laws);

/// A run of 0.4 s in dry friction and seven of nearly the same tree, as a fit's derivatives are.
void tree_nearly_equal_runs(benchmark::State& state, bool in_lanes) {
  using namespace furcula::trees;
  const auto joints = static_cast<std::size_t>(state.range(0));
  Recording r;
  r.interval_s = 0.004;
  r.input.resize(joints);
  for (std::size_t k = 0; k <= 100; ++k) {
    r.time_s.push_back(r.interval_s * static_cast<double>(k));
    for (auto& input : r.input) input.push_back(std::sin(9.0 * r.time_s.back()));
  }
  std::vector<Setup> setups(8);
  const std::vector<double> angle(joints, 0.3), velocity(joints, 0.5);
  std::vector<Run> runs;
  for (std::size_t k = 0; k < setups.size(); ++k) {
    setups[k].model = chain<furcula::model::RobotModel>(joints);
    for (std::size_t i = 0; i < joints; ++i)
      setups[k].model.laws[i].friction_nm = 0.1 + 1e-6 * static_cast<double>(k);
    setups[k].joints.resize(joints);
    runs.push_back({&setups[k], angle, velocity});
  }
  std::vector<double> out(runs.size() * r.time_s.size() * joints);
  for (auto _ : state) {
    if (in_lanes)
      run(runs, r, 0, r.time_s.size() - 1, out);
    else
      for (const Run& one : runs) run(std::span(&one, 1), r, 0, r.time_s.size() - 1, out);
    benchmark::DoNotOptimize(out.data());
  }
}
void tree_runs_one_by_one(benchmark::State& state) {
  state.SetLabel("eight runs of 0.4 s, nearly equal, of so many joints in dry friction");
  tree_nearly_equal_runs(state, false);
}
BENCHMARK(tree_runs_one_by_one)->Arg(2)->Arg(6)->Unit(benchmark::kMicrosecond);
void tree_runs_in_lanes(benchmark::State& state) {
  state.SetLabel("the same in lanes");
  tree_nearly_equal_runs(state, true);
}
BENCHMARK(tree_runs_in_lanes)->Arg(2)->Arg(6)->Unit(benchmark::kMicrosecond);

/// Six joints of which the outermost's tip stands.
void tree_step_on_a_foot(benchmark::State& state) {
  const bool stands = state.range(0) != 0;
  state.SetLabel(stands ? "1 ms of six joints, the last one's tip on the ground" : "the same in the air");
  auto m = chain<Model<double, DynamicTopology<12>>>(6);
  if (stands) m.foothold = {5, {0.05, 0.1, 0.2}};
  Plant<double, DynamicTopology<12>> plant(m);
  double torque = 0.5;
  plant.reset({0.3, 0.5, 0.7, 0.9, 1.1, 1.3}, {});
  const auto start = plant.place();
  std::size_t steps = 0;
  for (auto _ : state) {
    plant.advance({torque, torque, torque, torque, torque, torque}, 1e-3);
    if (++steps % 200 == 0) plant.go_to(start);
    benchmark::DoNotOptimize(plant.positions());
  }
}
BENCHMARK(tree_step_on_a_foot)->Arg(0)->Arg(1);

#ifdef FURCULA_MUJOCO
/// The same chain as MJCF: child frames parallel to their parents', as placed above.
std::string as_mjcf(std::size_t joints) {
  std::string open, close;
  const auto number = [](double x) { return std::to_string(x) + " "; };
  for (std::size_t i = 0; i < joints; ++i) {
    const double k = static_cast<double>(i);
    open += "<body pos=\"" + number(0.1) + number(0.05 * std::cos(k)) + number(0.2) +
            "\"><inertial pos=\"0.02 0.03 0.1\" mass=\"" + number(1.0 + 0.1 * k) +
            "\" fullinertia=\"0.02 0.03 0.025 0.001 0.002 0.001\"/><joint axis=\"" +
            number(std::sin(1.0 + k)) + number(std::cos(2.0 * k)) + number(0.3 + 0.1 * k) +
            "\" armature=\"0.01\" damping=\"0.1\"/>";
    close += "</body>";
  }
  return "<mujoco><option><flag contact=\"disable\" constraint=\"disable\"/></option><worldbody>" + open +
         close + "</worldbody></mujoco>";
}

/// mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation and mj_fwdAcceleration; `whole`: mj_forward, which adds
/// sensors and the (empty) constraint solver.
void mujoco_forward(benchmark::State& state, bool whole) {
  const std::string text = as_mjcf(static_cast<std::size_t>(state.range(0)));
  mjVFS* files = new mjVFS;
  mj_defaultVFS(files);
  mj_makeEmptyFileVFS(files, "chain.xml", static_cast<int>(text.size()));
  text.copy(static_cast<char*>(files->filedata[0]), text.size());
  char error[500] = "";
  mjModel* m = mj_loadXML("chain.xml", files, error, sizeof error);
  mj_deleteVFS(files);
  delete files;
  if (m == nullptr) return state.SkipWithError(error);
  mjData* d = mj_makeData(m);
  for (int i = 0; i < m->nv; ++i) {
    d->qpos[i] = 0.3 + 0.2 * i;
    d->qvel[i] = 0.5 - 0.1 * i;
    d->qfrc_applied[i] = 0.2;
  }
  for (auto _ : state) {
    if (whole) {
      mj_forward(m, d);
    } else {
      mj_fwdPosition(m, d);
      mj_fwdVelocity(m, d);
      mj_fwdActuation(m, d);
      mj_fwdAcceleration(m, d);
    }
    benchmark::DoNotOptimize(d->qacc_smooth[0]);
    d->qpos[0] += 1e-9 * d->qacc_smooth[0];
  }
  mj_deleteData(d);
  mj_deleteModel(m);
}
void mujoco_accelerations(benchmark::State& state) {
  state.SetLabel(
      "MuJoCo: mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation, mj_fwdAcceleration of that chain, no contact");
  mujoco_forward(state, false);
}
BENCHMARK(mujoco_accelerations)->Arg(2)->Arg(6)->Arg(12);
void mujoco_mj_forward(benchmark::State& state) {
  state.SetLabel("MuJoCo: mj_forward of that chain, no contact, no constraints");
  mujoco_forward(state, true);
}
BENCHMARK(mujoco_mj_forward)->Arg(2)->Arg(6)->Arg(12);
#endif

}  // namespace
