// A bank of the kernel's simulated GPIO lines, in folders that look like its own.
#include "host/rig/gpio_sim.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("a bank is found by what the kernel says of it in configfs") {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() + "/bank0");
  folder.file("dev_name", "gpio-sim.0\n");
  folder.file("bank0/chip_name", "gpiochip3\n");
  const rig::GpioBank bank = rig::find_gpio_bank(folder.path());
  CHECK(bank.folder == "/sys/devices/platform/gpio-sim.0/gpiochip3");
  CHECK(bank.chip == "/dev/gpiochip3");
  CHECK_THROWS_WITH(rig::find_gpio_bank("/nowhere"), Contains("no bank of gpio-sim at /nowhere"));
}

TEST_CASE("the switch is a pull, the solenoid a value") {
  const test::TemporaryFolder folder;
  for (const char* line : {"/sim_gpio0", "/sim_gpio1"})
    std::filesystem::create_directory(folder.path() + line);
  const std::string pull = folder.file("sim_gpio0/pull", "");
  folder.file("sim_gpio1/value", "0\n");
  const auto pulled = [&] {
    std::string word;
    std::ifstream(pull) >> word;
    return word;
  };
  rig::GpioSim lines(folder.path());
  CHECK(pulled() == "pull-down");
  CHECK_FALSE(lines.solenoid());
  std::filesystem::resize_file(pull, 0);
  lines.set_contact(true);
  CHECK(pulled() == "pull-up");
  folder.file("sim_gpio1/value", "1\n");
  CHECK(lines.solenoid());
  CHECK_THROWS_WITH(rig::GpioSim("/nowhere"), Contains("/nowhere/sim_gpio0/pull"));
}
