// furculad's configuration, read strictly.
#include "boards/linux_sbc/configuration.hpp"

#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "furcula/bus/parameters.hpp"
#include "host/core/error.hpp"
#include "host/rig/rig.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
using linux_sbc::parse_configuration;

namespace {

const std::string kLeast = R"([can]
interface = "can0"
motor = "ak80_9"

[contact]
chip = "gpiochip0"
line = "contact"
)";

std::string message_of(const std::string& text) {
  try {
    parse_configuration(text, "f.toml");
  } catch (const core::DataError& e) {
    return e.what();
  }
  return "no error";
}

/// A folder that goes with the test.
struct Folder {
  Folder() : path(std::filesystem::temp_directory_path() / ("furculad-test-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

}  // namespace

TEST_CASE(
    "the least that a configuration says leaves Modbus on the loopback, no solenoid, and a height to be homed") {
  const auto c = parse_configuration(kLeast, "f.toml");
  CHECK(c.can_interface == "can0");
  CHECK(c.link.motor == bus::Motor::ak80_9);
  CHECK(c.modbus_address == "127.0.0.1");
  CHECK_FALSE(c.has_solenoid);
  CHECK(std::isnan(c.home_height_m));
  CHECK(c.controller.supervisor.sample_age_max_us == firmware::kCanSampleAgeMaxUs);
}

TEST_CASE("the example of a configuration is sound") {
  const auto c = linux_sbc::read_configuration(test::source("boards/linux_sbc/furculad.toml"));
  CHECK(c.controller.torque.amplitude_nm == 2.0f);
  CHECK(c.contact.active_low);
}

TEST_CASE("everything that a configuration can say is taken") {
  const auto c = parse_configuration(kLeast + R"(active_low = true
[solenoid]
chip = "gpiochip1"
line = "7"
[leg]
zero_rad = 0.5
reversed = true
gear = 2.0
[height]
home_count = -16
home_m = 0.28
[cable]
home_count = 5
[modbus]
address = "0.0.0.0"
port = 502
[loop]
priority = 0
[store]
file = "/var/lib/furcula/parameters"
[parameters]
torque_amplitude_nm = 3.5
clutch_fitted = 1
)",
                                     "f.toml");
  CHECK(c.contact.active_low);
  CHECK(c.has_solenoid);
  CHECK(c.solenoid.line == "7");
  CHECK(c.link.leg_sign == -1.0f);
  CHECK(c.link.gear == 2.0f);
  CHECK(c.home_count == 0xfffffff0u);
  CHECK(c.home_height_m == 0.28f);
  CHECK(c.cable_home_count == 5);
  CHECK(c.modbus_port == 502);
  CHECK(c.priority == 0);
  CHECK(c.store_file == "/var/lib/furcula/parameters");
  CHECK(c.controller.torque.amplitude_nm == 3.5f);
  CHECK(c.controller.clutch.fitted == 1);
}

TEST_CASE("what is wrong in a configuration is said with its line, its key and what was expected") {
  CHECK_THAT(message_of(kLeast + "[leg]\nzero = 1\n"),
             Contains("f.toml:9: unknown key 'zero' in [leg]") && Contains("zero_rad"));
  CHECK_THAT(message_of("[can]\ninterface = \"can0\"\nmotor = \"ak80-9\"\n"),
             Contains("f.toml:3") && Contains("can.motor = 'ak80-9'") && Contains("did you mean 'ak80_9'"));
  CHECK_THAT(message_of("[contact]\nchip = \"a\"\nline = \"b\"\n"), Contains("no section [can]"));
  CHECK_THAT(message_of("[can]\ninterface = \"can0\"\nmotor = \"ak80_9\"\n"),
             Contains("no section [contact]"));
  CHECK_THAT(message_of(kLeast + "[solenoid]\nchip = \"gpiochip0\"\n"),
             Contains("[solenoid] has no key 'line'"));
  CHECK_THAT(message_of(kLeast + "[modbus]\nport = 70000\n"),
             Contains("modbus.port = 70000") && Contains("1 to 65535"));
  CHECK_THAT(message_of(kLeast + "[modbus]\nport = 50.5\n"), Contains("expected a whole number"));
  CHECK_THAT(message_of(kLeast + "[loop]\npriority = \"high\"\n"), Contains("loop.priority is 'high'"));
  CHECK_THAT(message_of(kLeast + "[parameters]\ntorque_limit_nm = 100\n"),
             Contains("torque_limit_nm = 100") && Contains("from 0.1 to 40 N m"));
  CHECK_THAT(message_of(kLeast + "[parameters]\nclutch_fitted = 0.5\n"),
             Contains("whole number from 0 to 1"));
  CHECK_THAT(message_of(kLeast + "[parameters]\nleg_angle_max = 1\n"),
             Contains("did you mean 'leg_angle_max_rad'"));
  CHECK_THAT(message_of(kLeast + "[parameters]\nclutch_fitted = 1\nclutch_release_in_flight = "
                                 "1\ntooth_play_m = 0.02\ntooth_pitch_m = 0.001\n"),
             Contains("make no sense together"));
  CHECK_THAT(
      message_of(
          "[can]\ninterface = \"can0\"\nmotor = \"ak80_9\"\nheight_encoder_node = 3\ncable_encoder_node = 3\n"
          "[contact]\nchip = \"a\"\nline = \"b\"\n"),
      Contains("two encoders with one node id"));
  CHECK_THAT(message_of("can = 3\n"), Contains("can is 3; expected a table"));
}

TEST_CASE("the configuration that a rig writes for a controller reads back as that controller") {
  rig::RigOptions options;
  options.gpio_chip = "/dev/gpiochip0";
  control::Config config;
  config.torque.amplitude_nm = 2.7182817f;
  config.link_length_m = 0.1234567f;
  config.clutch.fitted = 1;
  const auto c =
      parse_configuration(rig::board_configuration(options, config, true, 0xfffffff0u, 0.34998f), "f.toml");
  CHECK(c.can_interface == "vcan0");
  CHECK(c.home_count == 0xfffffff0u);
  CHECK(c.home_height_m == 0.34998f);
  CHECK(c.link.cable_node == 2);
  for (const bus::Parameter& p : bus::kParameters) {
    INFO(p.name);
    if (p.name != "sample_age_max_us") CHECK(p.get(c.controller) == p.get(config));
  }
}

TEST_CASE("Modbus on more than the loopback is warned about, by --check too") {
  const auto warning = [](const std::string& modbus) {
    return linux_sbc::network_warning(parse_configuration(kLeast + "[modbus]\n" + modbus, "f.toml"));
  };
  CHECK(warning("port = 1502\n").empty());
  CHECK(warning("address = \"127.0.0.1\"\n").empty());
  CHECK(warning("address = \"127.8.9.1\"\n").empty());
  CHECK(warning("on = false\naddress = \"0.0.0.0\"\n").empty());
  for (const char* address : {"0.0.0.0", "192.168.7.2", "126.0.0.1", "128.0.0.1"}) {
    INFO(address);
    CHECK_THAT(warning("address = \"" + std::string(address) + "\"\n"),
               Contains("Modbus listens on " + std::string(address)) && Contains("no password"));
  }
  const Folder folder;
  std::ofstream(folder.path / "f.toml") << kLeast << "[modbus]\naddress = \"0.0.0.0\"\n";
  const test::Ran ran =
      test::run_program(test::program("furculad"), {"--check", (folder.path / "f.toml").string()});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.err, Contains("furculad: warning: Modbus listens on 0.0.0.0"));
}

TEST_CASE(
    "a key of fifty thousand names is refused with its line, and does not end the program by a signal") {
  const Folder folder;
  std::string text = kLeast;
  for (int i = 0; i < 50'000; ++i) text += "a.";
  std::ofstream(folder.path / "f.toml") << text << "a = 1\n";
  const test::Ran ran =
      test::run_program(test::program("furculad"), {"--check", (folder.path / "f.toml").string()});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("f.toml:8: more than 16 names joined by dots"));
}

namespace {

const std::string kWalker = R"(robot = "biped_walker"
[can]
left = "can0"
right = "can1"
body = "can2"
[walk]
file = "walk.toml"
)";

/// What furculad --check says of a walker's file beside a walk, and its status.
test::Ran checked(const Folder& folder, const std::string& text, const std::string& walk) {
  std::ofstream(folder.path / "f.toml") << text;
  std::ofstream(folder.path / "walk.toml") << walk;
  return test::run_program(test::program("furculad"), {"--check", (folder.path / "f.toml").string()});
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string found_walk() {
  std::ifstream file(test::source("tests/host/walk/active_walk.toml"));
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("a walker's configuration has a bus a leg and the body's, and the walk that it names") {
  const Folder folder;
  std::ofstream(folder.path / "f.toml")
      << kWalker
      << "[feet]\nthreshold_n = 45\n[loop]\npriority = 7\n[log]\nfolder = \"walks\"\nrate_hz = 250\n";
  std::ofstream(folder.path / "walk.toml")
      << changed(found_walk(), "walk_until_s = 5.0", "walk_until_s = 4.0");
  const auto c = linux_sbc::read_configuration((folder.path / "f.toml").string());
  REQUIRE(c.walker);
  CHECK(c.walker->can_interfaces == std::array<std::string, 3>{"can0", "can1", "can2"});
  CHECK(c.walker->controller.foot_threshold_n == 45.0f);
  CHECK(c.walker->controller.walk.walk_until_s == 4.0f);
  CHECK(c.walker->controller.walk.walk.knee_rad == 0.25f);  // posture.knee_rad of that file
  CHECK(c.walker->controller.supervisor.missed_max == 3);
  CHECK(c.walker->log_folder == (folder.path / "walks").string());
  CHECK(c.walker->log_rate_hz == 250);
  CHECK(c.priority == 7);
  CHECK(linux_sbc::network_warning(c).empty());
  CHECK(control::check(c.walker->controller) == Status::ok);
}

TEST_CASE("the example of a walker's configuration is sound") {
  std::ifstream file(test::source("boards/linux_sbc/furculad_walker.toml"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto c = parse_configuration(text, "f.toml");
  REQUIRE(c.walker);
  CHECK(c.walker->walk_file == "walk.toml");
  CHECK(c.walker->log_folder == "walks");
  CHECK(parse_configuration(kWalker, "f.toml").walker->log_folder.empty());
}

TEST_CASE("what is wrong in a walker's configuration is one error that says where and what was expected") {
  CHECK_THAT(
      message_of("robot = \"biped_walk\"\n"),
      Contains("f.toml:1: robot = 'biped_walk'; expected one of") && Contains("did you mean 'biped_walker'"));
  CHECK_THAT(message_of(kWalker + "[leg]\nzero_rad = 1\n"),
             Contains("f.toml:8: unknown key 'leg' in the file of a biped_walker"));
  CHECK_THAT(message_of(changed(kWalker, "body =", "bdy =")),
             Contains("f.toml:5: unknown key 'bdy' in [can]"));
  CHECK_THAT(message_of(changed(kWalker, "body = \"can2\"\n", "")), Contains("[can] has no key 'body'"));
  CHECK_THAT(message_of(changed(kWalker, "can1", "can0")),
             Contains("f.toml:4: can.right = 'can0' as can.left; expected another interface"));
  CHECK_THAT(message_of("robot = \"biped_walker\"\n[walk]\nfile = \"w\"\n"), Contains("no section [can]"));
  CHECK_THAT(message_of(kWalker.substr(0, kWalker.find("[walk]"))), Contains("no section [walk]"));
  CHECK_THAT(message_of(changed(kWalker, "file", "fiel")),
             Contains("f.toml:7: unknown key 'fiel' in [walk]"));
  CHECK_THAT(message_of(kWalker + "[feet]\nthreshold_n = 0\n"),
             Contains("feet.threshold_n = 0") && Contains("1 to 400"));
  CHECK_THAT(message_of(kWalker + "[log]\nrate_hz = 100\n"), Contains("[log] has no key 'folder'"));
  CHECK_THAT(
      message_of(kWalker + "[log]\nfolder = \"w\"\nrate_hz = 300\n"),
      Contains("f.toml:10: log.rate_hz = 300; expected 1000, the controller's rate, or a whole part of it"));
  CHECK_THAT(message_of("[can]\nleft = \"can0\"\n"), Contains("unknown key 'left'"));  // a hopper's
}

TEST_CASE("a walk of another robot, one with a typo and one that is not there are refused by --check") {
  const Folder folder;
  test::Ran ran = checked(folder, kWalker, found_walk());
  CHECK(ran.status == 0);
  ran = checked(folder, kWalker, changed(found_walk(), "furcula_biped", "other_biped"));
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("walk.toml: a walk of 'other_biped'; expected one of 'furcula_biped'"));
  ran = checked(folder, kWalker, changed(found_walk(), "\"active\"", "\"knee_braked\""));
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("mode = 'knee_braked'") && Contains("semi_passive"));
  ran = checked(folder, kWalker, changed(found_walk(), "knee_rad", "nee_rad"));
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("walk.toml:8: unknown key 'nee_rad' in [posture]"));
  ran = checked(folder, changed(kWalker, "walk.toml", "no_such_walk.toml"), found_walk());
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("no_such_walk.toml"));
}

TEST_CASE("a walker's bus that is not there ends furculad with status 4 and its name") {
  const Folder folder;
  static_cast<void>(checked(folder, changed(kWalker, "can0", "nocan7"), found_walk()));
  const test::Ran ran = test::run_program(test::program("furculad"), {(folder.path / "f.toml").string()});
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("nocan7") || Contains("SocketCAN"));
}
