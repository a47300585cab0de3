// The release/catch test with the controller on the emulated Cortex-M4F.
#include "host/bench/pil_board.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/bench/release_catch.hpp"
#include "host/bench/release_catch_json.hpp"
#include "host/core/error.hpp"
#include "host/pil/own_image.hpp"
#include "host/pil/qemu.hpp"
#include "tests/host/error_message.hpp"
#include "tests/skip.hpp"

using namespace furcula;
using namespace furcula::bench;
using Catch::Contains;

namespace {

bool cannot_run_here() {
  const std::string reason = pil::why_not_here(pil::own_image());
  if (!reason.empty()) test::skip(reason.c_str());
  return !reason.empty();
}

void check_same(const Trial& a, const Trial& b) {
  REQUIRE(a.readings.size() == b.readings.size());
  std::size_t differing = 0;
  for (std::size_t n = 0; n < a.readings.size(); ++n) {
    const Reading &x = a.readings[n], &y = b.readings[n];
    const bool current = x.current_a == y.current_a || (n == 0 && std::isnan(x.current_a));
    differing += !(x.count == y.count && current && x.voltage_v == y.voltage_v && x.coil == y.coil);
  }
  CHECK(differing == 0);
}

}  // namespace

TEST_CASE("On the emulated Cortex-M4F the test gives what it gives on the host, to the bit") {
  if (cannot_run_here()) return;
  Options options;
  options.trials = 25;
  options.seed = 5;
  SimBoard here;
  PilBoard there(pil::own_image());
  const ReleaseCatch a = run_release_catch(here, options, {});
  ReleaseCatch b = run_release_catch(there, options, {});
  CHECK(b.board == "pil");
  b.board = a.board;
  CHECK(to_json_text(a) == to_json_text(b));
  check_same(a.standard, b.standard);
  check_same(a.trials[a.worst], b.trials[b.worst]);
}

TEST_CASE("A board without an image says so") {
  CHECK_THAT(test::error_message([] { const PilBoard board("/nowhere/image.elf"); }),
             Contains("pil: ") && (Contains("no image at /nowhere/image.elf") || Contains("not installed")));
}
