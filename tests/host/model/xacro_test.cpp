// Templates of URDF: what xacro writes is read, what it refuses is said, and without it the reader says what to do.
#include "host/model/xacro.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "host/core/error.hpp"
#include "host/model/robot_file.hpp"
#include "tests/folder.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// A folder with a program `xacro`, which alone PATH then has beside the system's. Its name has a blank and a semicolon.
class Stand {
 public:
  explicit Stand(const std::string& program) {
    fs::create_directories(folder_.file("of xacro; test/bin"));
    if (!program.empty()) {
      const std::string xacro = folder_.file("of xacro; test/bin/xacro");
      std::ofstream(xacro) << "#!/bin/sh\n" << program;
      fs::permissions(xacro, fs::perms::owner_all);
    }
    ::setenv("PATH", (folder_.file("of xacro; test/bin") + ":/usr/bin:/bin").c_str(), 1);
  }
  ~Stand() { ::setenv("PATH", before_.c_str(), 1); }
  Stand(const Stand&) = delete;
  Stand& operator=(const Stand&) = delete;
  std::string file(const std::string& name, const std::string& text) const {
    folder_.write("of xacro; test/" + name, text);
    return folder_.file("of xacro; test/" + name);
  }

 private:
  std::string before_ = std::getenv("PATH");
  test::Folder folder_;
};

std::string said(const std::string& path) {
  try {
    return model::read_robot(path).notes.at(0);
  } catch (const core::DataError& e) {
    return e.what();
  }
}

constexpr const char* kTemplate =
    "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:property name=\"m\" value=\"1\"/></robot>";

}  // namespace

TEST_CASE("A xacro file is what xacro makes of it") {
  const Stand stand("cat '" + test::source("tests/host/model/robots/pendulum.urdf") + "'; echo noise >&2");
  const std::string path = stand.file("a b; touch $(x).xacro", kTemplate);
  const model::Urdf robot = model::read_robot(path);
  CHECK(robot.is_expanded);
  CHECK_FALSE(robot.joints.empty());
  CHECK_THAT(robot.notes.at(0), Contains("Expanded by xacro"));
  CHECK(model::read_robot(stand.file("named.urdf", kTemplate)).is_expanded);
}

TEST_CASE("xacro gets the file's name as one argument, and no shell") {
  const Stand stand("printf '%s|%s' \"$#\" \"$1\"");
  CHECK(model::expand_xacro("a b;`c`$(d).xacro") == "1|a b;`c`$(d).xacro");
  CHECK(model::expand_xacro("--help") == "1|./--help");
}

TEST_CASE("What xacro refuses, never ends or floods is one message") {
  {
    const Stand stand("echo 'undefined macro box' >&2\necho more >&2\nexit 3");
    CHECK_THAT(said(stand.file("r.xacro", kTemplate)),
               Contains("xacro ended with status 3, \"undefined macro box more\"") &&
                   Contains("see what it says: xacro"));
  }
  {
    const Stand stand("sleep 100");
    CHECK_THROWS_WITH(model::expand_xacro("r.xacro", std::chrono::milliseconds(200)),
                      Contains("r.xacro: xacro has not ended in 0.2 s"));
  }
  {
    const Stand stand("cat /dev/zero");
    CHECK_THROWS_WITH(model::expand_xacro("r.xacro"), Contains("more than 1 MiB"));
  }
  {
    const Stand stand("exit 0");
    CHECK_THROWS_WITH(model::expand_xacro("r.xacro"), Contains("writes nothing"));
  }
}

TEST_CASE("Without xacro its file is refused with the command that expands it") {
  const Stand stand("");
  if (model::expand_xacro("/dev/null").has_value()) return;  // it is installed among the system's
  CHECK_THAT(said(stand.file("r.xacro", kTemplate)),
             Contains("this is a xacro file") && Contains("expand it: xacro"));
}
