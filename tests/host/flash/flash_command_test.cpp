// `furcula flash` with programs in PATH that play OpenOCD, st-flash and dfu-util and a board behind them.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/flash/made_image.hpp"
#include "tests/paths.hpp"

namespace {

using namespace furcula;
using Catch::Contains;

/// A folder with fake tools, which keep the "chip" in a file there.
class Host {
 public:
  Host() : image_(test::made_image("stm32f4discovery")) {
    elf_ = folder_.file("robot.elf", test::made_elf(image_));
  }

  /// A program that does what the shell's lines say, with the chip's file as $CHIP.
  void tool(const std::string& name, const std::string& lines) {
    const std::string path =
        folder_.file(name, "#!/bin/sh\nPATH=/usr/bin:/bin\nCHIP='" + folder_.path() + "/chip'\n" + lines);
    REQUIRE(::chmod(path.c_str(), 0755) == 0);
  }
  test::Ran flash(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"PATH=" + folder_.path(),
                                       test::program("furcula"),
                                       "flash",
                                       "--board",
                                       "stm32f4discovery",
                                       "--elf",
                                       elf_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program("/usr/bin/env", arguments);
  }
  std::string chip() const {
    std::ifstream file(folder_.path() + "/chip", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const std::string& image() const { return image_; }

 private:
  test::TemporaryFolder folder_;
  std::string image_, elf_;
};

constexpr const char* kGoodOpenocd = "cp image.bin \"$CHIP\"\ncp \"$CHIP\" read_back.bin\n";

}  // namespace

TEST_CASE("an image is written and read back with each of the three programs") {
  const struct {
    const char *name, *lines;
  } tools[] = {
      {"openocd", kGoodOpenocd},
      {"st-flash",
       "case $1 in write) cp \"$2\" \"$CHIP\";; read) head -c \"$4\" \"$CHIP\" > \"$2\";; esac\n"},
      {"dfu-util",
       "for word; do last=$word; done\n"
       "case \"$*\" in *-D*) cp \"$last\" \"$CHIP\";; *) cp \"$CHIP\" \"$last\";; esac\n"},
  };
  for (const auto& tool : tools) {
    INFO(tool.name);
    Host host;
    host.tool(tool.name, tool.lines);
    const test::Ran ran = host.flash();
    INFO(ran.err);
    CHECK(ran.status == 0);
    CHECK(host.chip() == host.image());
    CHECK_THAT(ran.out, Contains("stm32f4discovery, firmware 1.2.3, build 0badcafe, 1000 bytes, CRC good"));
    CHECK_THAT(ran.out, Contains("on the board: firmware 1.2.3, build 0badcafe"));
    CHECK_THAT(ran.err, Contains(tool.name));
  }
}

TEST_CASE("a dry run prints the commands and runs none") {
  Host host;
  host.tool("openocd", kGoodOpenocd);
  const test::Ran ran = host.flash({"--dry-run"});
  CHECK(ran.status == 0);
  CHECK(host.chip().empty());
  CHECK_THAT(ran.out, Contains("flash write_image erase image.bin 0x08000000 bin") &&
                          Contains("dump_image read_back.bin 0x08000000 1000"));
  // Also where there is no program yet.
  Host bare;
  CHECK(bare.flash({"--dry-run", "--tool", "dfu-util"}).status == 0);
}

TEST_CASE(
    "without a program, and without a board at its end, it says what is missing and ends with status 4") {
  Host host;
  test::Ran ran = host.flash();
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("in PATH; expected one of openocd, st-flash, dfu-util"));
  host.tool("openocd", "echo 'Error: open failed' >&2\nexit 1\n");
  ran = host.flash();
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("openocd ended with status 1") && Contains("Error: open failed") &&
                          Contains("Is the board connected") && Contains("CN1"));
  CHECK(host.chip().empty());
}

TEST_CASE("a board that holds something else afterwards is told") {
  Host host;
  host.tool("openocd", std::string(kGoodOpenocd) +
                           "printf X | dd of=read_back.bin bs=1 seek=700 conv=notrunc 2>/dev/null\n");
  test::Ran ran = host.flash();
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("another byte at 700"));
  host.tool("openocd", "head -c 10 image.bin > read_back.bin\n");
  ran = host.flash();
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("read back 10 bytes of 1000"));
}

TEST_CASE("an image of another board, a damaged one and a wrong argument never reach a program") {
  Host host;
  host.tool("openocd", kGoodOpenocd);
  test::TemporaryFolder other;
  const std::string foreign = other.file("a.elf", test::made_elf(test::made_image("feather_stm32f405")));
  std::string damaged_image = host.image();
  damaged_image[5] = 'x';
  const std::string damaged = other.file("b.elf", test::made_elf(damaged_image));
  const auto flash = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "flash");
    return test::run_furcula(arguments);
  };
  test::Ran ran = flash({"--board", "stm32f4discovery", "--elf", foreign});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("for the board 'feather_stm32f405'; expected stm32f4discovery"));
  ran = flash({"--board", "stm32f4discovery", "--elf", damaged});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("CRC-32"));
  CHECK(flash({"--board", "stm32f4discovery", "--elf", other.path() + "/none.elf"}).status == 3);
  ran = flash({"--board", "stm32f4discovry", "--elf", foreign});
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Contains("did you mean 'stm32f4discovery'?"));
  CHECK(host.flash({"--tool", "hammer"}).status == 2);
  CHECK(host.chip().empty());
}
