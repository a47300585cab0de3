// How fast the biped's equations are: accelerations, and a step with all 8 vertices on the ground, of one robot and of robots in lanes;
// beside MuJoCo's accelerations of the same robot without contact in the same run.
//
// Built twice: bench_biped for the compiler's usual processor (x86-64: vectors of 2 doubles), bench_biped_v3 for one with AVX2
// (-march=x86-64-v3 -mno-fma: of 4 doubles). Neither contracts, so that both give the same bits.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "tests/common/dynamics/biped_mjcf.hpp"
#ifdef FURCULA_MUJOCO
#include <mujoco/mujoco.h>
#endif

namespace {

using namespace furcula::dynamics::biped;
using furcula::dynamics::SimdBatch;
using furcula::dynamics::ValueOf;

template <class T>
constexpr double robots() {
  if constexpr (requires { T::kLanes; }) return T::kLanes;
  return 1.0;
}

/// Times are of a call, for all lanes.
template <class T>
std::string of_lanes() {
  return robots<T>() == 1.0 ? ""
                            : ", of " + std::to_string(static_cast<int>(robots<T>())) + " robots in lanes";
}
/// `robots` a second.
template <class T>
void count_robots(benchmark::State& state) {
  state.counters["robots"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * robots<T>(), benchmark::Counter::kIsRate);
}

/// The design, and its joints turned against their parents by angles as a URDF may have them.
template <class T>
TurnedParameters<T> turned_design() {
  furcula::dynamics::biped::JointFrames frames;
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (auto& leg : frames) leg.fill({{c, s * c, s * s}, {-s, c * c, s * c}, {0.0, -s, c}});
  return {design(), frames};
}

/// kTurned: with general frames, anywhere in their parents.
template <class T, bool kTurned>
void biped_forward(benchmark::State& state) {
  state.SetLabel((kTurned ? "the same with joints turned anyhow and anywhere in their parents"
                          : "accelerations of the biped, turns and velocities included") +
                 of_lanes<T>());
  using Topology = std::conditional_t<kTurned, AnywhereTopology, DesignTopology>;
  const std::conditional_t<kTurned, TurnedParameters<T>, Parameters<T>> p = [] {
    if constexpr (kTurned) return turned_design<T>();
    if constexpr (!kTurned) return Parameters<T>(design());
  }();
  const JointLaws<T> laws = active_laws(p);
  State<T> s;
  Actions<T> act{};
  const LegScalar<T> zero = LegScalar<T>(ValueOf<T>(0));
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    act.foot[pass] = {{zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      s.q_rad[pass][j] = LegScalar<T>(static_cast<ValueOf<T>>(0.1 * static_cast<double>(j)));
      s.qd_radps[pass][j] = LegScalar<T>(static_cast<ValueOf<T>>(0.5 - 0.1 * static_cast<double>(j)));
      act.torque_nm[pass][j] = LegScalar<T>(ValueOf<T>(2));
      act.armature_kgm2[pass][j] = laws[pass][j].armature_kgm2;
    }
  }
  act.gravity_mps2 = p.gravity_mps2;
  Kinematics<T> k;
  Accelerations<T> out;
  for (auto _ : state) {
    kinematics<Topology>(p, s, k);
    forward_dynamics<Topology>(p, s, k, act, out);
    benchmark::DoNotOptimize(out);
    s.q_rad[0][0] +=
        out.qdd_radps2[0][0] * static_cast<ValueOf<T>>(1e-9);  // so that no call is the last one's
  }
  count_robots<T>(state);
}
BENCHMARK(biped_forward<double, false>)->Name("biped_accelerations");
BENCHMARK(biped_forward<double, true>)->Name("biped_accelerations_turned");
BENCHMARK(biped_forward<SimdBatch<double, 4>, false>)->Name("biped_accelerations/4_double");
BENCHMARK(biped_forward<SimdBatch<float, 8>, false>)->Name("biped_accelerations/8_float");

/// Drives, accelerations and integration of a robot with turned joints, its 8 vertices 1 mm in the ground at the start of each step.
void biped_step_turned(benchmark::State& state) {
  state.SetLabel(
      "a step on 8 vertices with joints turned anyhow and anywhere in their parents, drives included");
  // The soles are level: what turns a joint is turned back by the next.
  furcula::dynamics::biped::JointFrames frames;
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (auto& leg : frames)
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const double t = j % 2 == 0 ? s : -s;
      leg[j] = {{1.0, 0.0, 0.0}, {0.0, c, t}, {0.0, -t, c}};
    }
  const TurnedParameters<double> p(design(), frames);
  const JointLaws<double> laws = active_laws(p);
  const Commands<double> straight;
  State<double> begin;
  Kinematics<double> k;
  kinematics<AnywhereTopology>(p, begin, k);
  begin.position_m.z = -(k.legs[0].foot_position_m.z[0] + p.vertices_m[0][0].z[0]) - 1e-3;
  StepReport<double> report;
  State<double> now = begin;
  for (auto _ : state) {
    now = begin;
    step<false, AnywhereTopology>(p, laws, straight, kStep_s, now, report);
    benchmark::DoNotOptimize(now);
  }
  if (report.contact.normal_n[0][0] < 100.0) state.SkipWithError("the feet do not carry");
  count_robots<double>(state);
}
BENCHMARK(biped_step_turned);

/// Stands: drives, 8 vertices in contact, accelerations, integration.
template <class T, bool kSwitched>
void biped_step(benchmark::State& state) {
  state.SetLabel((kSwitched ? "the same with joints that may be in any mode, motors behind clutches included"
                            : "a step of the biped on 8 vertices, drives included") +
                 of_lanes<T>());
  const Parameters<T> p(design());
  const JointLaws<T> laws = active_laws(p);
  const Commands<T> straight;
  const T h = T(static_cast<ValueOf<T>>(kStep_s));
  State<T> s;
  s.position_m.z = T(static_cast<ValueOf<T>>(0.989));
  StepReport<T> report;
  for (int n = 0; n < 4000; ++n) step<kSwitched>(p, laws, straight, h, s, report);
  for (auto _ : state) {
    step<kSwitched>(p, laws, straight, h, s, report);
    benchmark::DoNotOptimize(s);
  }
  count_robots<T>(state);
}
BENCHMARK(biped_step<double, false>)->Name("biped_step");
BENCHMARK(biped_step<double, true>)->Name("biped_step_any_mode");
BENCHMARK(biped_step<SimdBatch<double, 4>, false>)->Name("biped_step/4_double");
BENCHMARK(biped_step<SimdBatch<float, 8>, false>)->Name("biped_step/8_float");
BENCHMARK(biped_step<SimdBatch<float, 8>, true>)->Name("biped_step_any_mode/8_float");

#ifdef FURCULA_MUJOCO
/// mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation, mj_fwdAcceleration.
void mujoco_biped(benchmark::State& state) {
  state.SetLabel(
      "MuJoCo: mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation, mj_fwdAcceleration of the biped, no contact");
  const std::string text = furcula::test::biped_mjcf(design());
  mjVFS* files = new mjVFS;
  mj_defaultVFS(files);
  mj_makeEmptyFileVFS(files, "biped.xml", static_cast<int>(text.size()));
  text.copy(static_cast<char*>(files->filedata[0]), text.size());
  char error[500] = "";
  mjModel* m = mj_loadXML("biped.xml", files, error, sizeof error);
  mj_deleteVFS(files);
  delete files;
  if (m == nullptr) return state.SkipWithError(error);
  m->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_CONSTRAINT;
  mjData* d = mj_makeData(m);
  for (int i = 0; i < 12; ++i) {
    d->qpos[7 + i] = 0.1 * (i % 6);
    d->qvel[6 + i] = 0.5 - 0.1 * (i % 6);
    d->qfrc_applied[6 + i] = 2.0;
  }
  for (auto _ : state) {
    mj_fwdPosition(m, d);
    mj_fwdVelocity(m, d);
    mj_fwdActuation(m, d);
    mj_fwdAcceleration(m, d);
    benchmark::DoNotOptimize(d->qacc_smooth[0]);
    d->qpos[7] += 1e-9 * d->qacc_smooth[6];
  }
  mj_deleteData(d);
  mj_deleteModel(m);
}
BENCHMARK(mujoco_biped)->Name("mujoco_biped_accelerations");
#endif

}  // namespace
