// The table of faults.
#include "furcula/control/fault.hpp"

#include <catch2/catch.hpp>
#include <set>
#include <string>

using namespace furcula::control;

TEST_CASE("fault numbers are those that logs already carry") {
  CHECK(static_cast<int>(Fault::none) == 0);
  CHECK(static_cast<int>(Fault::bad_configuration) == 1);
  CHECK(static_cast<int>(Fault::late_tick) == 2);
  CHECK(static_cast<int>(Fault::peer_lost) == 3);
  CHECK(static_cast<int>(Fault::stale_input) == 4);
  CHECK(static_cast<int>(Fault::non_finite_input) == 5);
  CHECK(static_cast<int>(Fault::height_out_of_range) == 6);
  CHECK(static_cast<int>(Fault::leg_angle_out_of_range) == 7);
  CHECK(static_cast<int>(Fault::encoder_implausible) == 8);
  CHECK(static_cast<int>(Fault::contact_implausible) == 9);
  CHECK(static_cast<int>(Fault::falling) == 32);
  CHECK(static_cast<int>(Fault::clutch_not_engaged) == 33);
  CHECK(static_cast<int>(Fault::imu_implausible) == 34);
}

TEST_CASE("each fault has a name of its own, says what it means and what to do") {
  std::set<std::string> names;
  for (const FaultInfo& fault : kFaults) {
    CHECK(names.insert(std::string(fault.name)).second);
    CHECK(fault.meaning.ends_with("."));
    CHECK(fault.remedy.ends_with("."));
    CHECK(info(fault.fault).name == fault.name);
  }
  CHECK(names.size() == kFaultCount);
}
