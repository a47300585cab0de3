// The simulated drive over long runs: it forgets what it does not look back on, and nothing else.
#include "boards/sim_host/drive.hpp"

#include <malloc.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "host/sim/live_rig.hpp"

using namespace furcula;
using dynamics::Effect;

namespace {

constexpr double kStepS = 0.001;

double command_at(int tick) { return std::sin(0.05 * tick) + 0.3 * std::sin(1.7 * tick); }

}  // namespace

TEST_CASE("a drive keeps as many commands as its delay needs, however long it runs") {
  for (const double delay_s : {0.0, 0.003, 1.5}) {
    dynamics::Effects<double> effects;
    if (delay_s > 0.0) effects.set(Effect::actuator_delay, {delay_s});
    sim_host::Drive drive(effects);
    const int delay_ticks = static_cast<int>(std::lround(delay_s / kStepS));
    double worst = 0.0;
    std::size_t most = 0;
    for (int tick = 0; tick < 50'000; ++tick) {
      const double torque_nm = drive.step(command_at(tick), kStepS);
      most = std::max(most, drive.kept());
      // A delay of whole steps gives the command of so many steps before.
      if (tick > delay_ticks + 1)
        worst = std::max(worst, std::abs(torque_nm - command_at(tick - delay_ticks)));
    }
    INFO(delay_s << " s");
    CHECK(worst < 1e-6);
    CHECK(most <= 2 * static_cast<std::size_t>(delay_ticks) + 2048);
  }
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("a robot that is served takes no more memory the longer it runs") {
  sim::LiveRig rig(sim::example_hopper(), sim::default_scenario(sim::example_hopper()), 1, "", {}, 7);
  rig.advance(10'000);
  const std::size_t before = ::mallinfo2().uordblks;
  rig.advance(100'000);
  // 32 bytes a tick were 3.2 MB.
  CHECK(::mallinfo2().uordblks < before + 1024);
}
#endif
