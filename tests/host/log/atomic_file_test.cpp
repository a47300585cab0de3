// Files are written whole or not at all.
#include "host/log/atomic_file.hpp"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;

namespace {
std::string content(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}
}  // namespace

TEST_CASE("a file is replaced as a whole, and nothing else is left in the folder") {
  test::TemporaryFolder folder;
  const std::string path = folder.file("out.json", "the old one, longer than the new one");
  log::write_file_atomically(path, "new");
  CHECK(content(path) == "new");
  CHECK(folder.names() == std::vector<std::string>{"out.json"});
}

TEST_CASE("a new file may be read by those whom the user's mask lets") {
  test::TemporaryFolder folder;
  const mode_t before = ::umask(027);
  log::write_file_atomically(folder.path() + "/a", "x");
  ::umask(before);
  struct stat status {};
  REQUIRE(::stat((folder.path() + "/a").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("a link stays a link: the file that it names is replaced") {
  test::TemporaryFolder folder;
  const std::string file = folder.file("file", "old");
  const std::string link = folder.path() + "/link";
  std::filesystem::create_symlink(file, link);
  log::write_file_atomically(link, "new");
  CHECK(std::filesystem::is_symlink(link));
  CHECK(content(file) == "new");
}

TEST_CASE("a place that cannot be written to is told, and left as it was") {
  test::TemporaryFolder folder;
  CHECK_THROWS_AS(log::write_file_atomically(folder.path(), "x"), log::OutputError);
  CHECK_THROWS_AS(log::write_file_atomically(folder.path() + "/none/out", "x"), log::OutputError);
  CHECK_THROWS_AS(log::write_file_atomically("/dev/full", "x"), log::OutputError);
  CHECK_NOTHROW(log::write_file_atomically("/dev/null", "x"));
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK(folder.names().empty());
}
