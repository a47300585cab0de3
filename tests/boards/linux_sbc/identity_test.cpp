// Which build furculad says that it is, against what the linker wrote into its file.
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "boards/linux_sbc/daemon.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"
#include "host/core/parameter_file.hpp"
#include "tests/boards/linux_sbc/doubles.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;

namespace {

/// The first four bytes of the GNU build id, in hexadecimal: 20 bytes behind the header of a note of type 3,
/// least significant byte first. LSB Core, "Note Section".
std::string build_in_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string head("\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0", 16);
  const std::size_t at = bytes.find(head);
  REQUIRE(at != std::string::npos);
  REQUIRE(at + head.size() + 20 <= bytes.size());
  std::string digits;
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<char, 3> two{};
    std::snprintf(two.data(), two.size(), "%02x", static_cast<unsigned char>(bytes[at + head.size() + i]));
    digits += two.data();
  }
  return digits;
}

}  // namespace

TEST_CASE("furculad says the build that the linker wrote into its file") {
  const test::Ran ran = test::run_program(test::program("furculad"), {"--version"});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Catch::Matches("furculad [0-9]+\\.[0-9]+\\.[0-9]+ build " +
                                     build_in_file(test::program("furculad")) + "\n"));
}

TEST_CASE("furculad's registers have version and build of the program that it is in") {
  std::string text;
  const bus::Identity identity = linux_sbc::own_identity(text);
  const std::string build = build_in_file("/proc/self/exe");
  CHECK(identity.board == "linux_sbc");
  CHECK(identity.build_id == std::stoul(build, nullptr, 16));

  test::QuietBus can;
  test::QuietLines lines;
  const std::atomic<bool> stop{false};
  linux_sbc::LoopFigures figures;
  linux_sbc::Configuration configuration;
  test::QuietBoard board(configuration, can, lines, stop, figures);
  core::ParameterFile store("");
  firmware::FaultLog faults{};
  firmware::Node node(board, store, control::Config{}, identity, 1, faults);
  const firmware::NodeRegisters registers(node);
  CHECK(node.snapshot().build_id == identity.build_id);
  CHECK(node.snapshot().firmware_version == identity.firmware_version);
  CHECK(std::string(registers.identification(2)) == text);
  CHECK_THAT(text, Catch::EndsWith("build " + build));
}
