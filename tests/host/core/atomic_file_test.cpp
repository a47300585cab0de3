// Files are written whole or not at all.
#include "host/core/atomic_file.hpp"

#include <signal.h>
#include <sys/resource.h>
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
  core::write_file_atomically(path, "new");
  CHECK(content(path) == "new");
  CHECK(folder.names() == std::vector<std::string>{"out.json"});
}

TEST_CASE("a new file may be read by those whom the user's mask lets") {
  test::TemporaryFolder folder;
  const mode_t before = ::umask(027);
  core::write_file_atomically(folder.path() + "/a", "x");
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
  core::write_file_atomically(link, "new");
  CHECK(std::filesystem::is_symlink(link));
  CHECK(content(file) == "new");
}

TEST_CASE("a place that cannot be written to is told, and left as it was") {
  test::TemporaryFolder folder;
  CHECK_THROWS_AS(core::write_file_atomically(folder.path(), "x"), core::OutputError);
  CHECK_THROWS_AS(core::write_file_atomically(folder.path() + "/none/out", "x"), core::OutputError);
  CHECK_THROWS_AS(core::write_file_atomically("/dev/full", "x"), core::OutputError);
  CHECK_NOTHROW(core::write_file_atomically("/dev/null", "x"));
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK(folder.names().empty());
}

namespace {

/// The set of an earlier run.
struct OldSet {
  OldSet() {
    for (const char* name : {"a.json", "b.toml", "c.html"}) folder.file(name, std::string("old ") + name);
  }
  std::string path(const std::string& name) const { return folder.path() + "/" + name; }
  std::vector<core::NewFile> next() const {
    return {{path("a.json"), "new a"}, {path("b.toml"), "new b"}, {path("c.html"), std::string(20'000, 'c')}};
  }
  bool is_whole() const {
    return content(path("a.json")) == "old a.json" && content(path("b.toml")) == "old b.toml" &&
           content(path("c.html")) == "old c.html";
  }
  test::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("files of one result appear together, and what is obsolete goes with the old ones") {
  const OldSet set;
  set.folder.file("old.toml", "x");
  const std::vector<std::string> obsolete{set.path("old.toml"), set.path("never.toml")};
  core::write_files_together(set.next(), obsolete);
  CHECK(content(set.path("a.json")) == "new a");
  CHECK(content(set.path("b.toml")) == "new b");
  CHECK(content(set.path("c.html")) == std::string(20'000, 'c'));
  CHECK(set.folder.names() == std::vector<std::string>{"a.json", "b.toml", "c.html"});
  // Where nothing was before.
  const test::TemporaryFolder empty;
  core::write_files_together(
      std::vector<core::NewFile>{{empty.path() + "/x", "1"}, {empty.path() + "/y", "2"}});
  CHECK(content(empty.path() + "/x") + content(empty.path() + "/y") == "12");
  CHECK(empty.names().size() == 2);
}

TEST_CASE("a folder in the way of one file leaves the old set whole, and nothing besides") {
  for (const char* name : {"a.json", "b.toml", "c.html"}) {
    const OldSet set;
    auto next = set.next();
    std::filesystem::create_directories(set.path("in the way"));
    for (core::NewFile& file : next)
      if (file.path == set.path(name)) file.path = set.path("in the way");
    CHECK_THROWS_WITH(core::write_files_together(next),
                      Catch::Contains("in the way: cannot be written: Is a dir"));
    CHECK(set.is_whole());
    CHECK(set.folder.names() == std::vector<std::string>{"a.json", "b.toml", "c.html", "in the way"});
  }
}

TEST_CASE("a disk that is full for one file leaves the old set whole") {
  const OldSet set;
  // A file may not become longer than 8 kB: the third one ends as on a full disk.
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const rlimit small{8192, before.rlim_max};
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  CHECK_THROWS_AS(core::write_files_together(set.next()), core::OutputError);
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, SIG_DFL);
  CHECK(set.is_whole());
  CHECK(set.folder.names().size() == 3);
}

TEST_CASE("what fails after the first file has its new name puts the old ones back") {
  // A folder cannot be put aside as a file is: the last step fails, all others were done.
  for (const bool were_there : {true, false}) {
    const OldSet set;
    if (!were_there)
      for (const char* name : {"a.json", "b.toml", "c.html"}) std::filesystem::remove(set.path(name));
    std::filesystem::create_directories(set.path("obsolete"));
    const std::vector<std::string> obsolete{set.path("obsolete")};
    CHECK_THROWS_WITH(core::write_files_together(set.next(), obsolete), Catch::Contains("obsolete: cannot"));
    CHECK(set.is_whole() == were_there);
    CHECK(set.folder.names().size() == (were_there ? 4 : 1));
  }
}

TEST_CASE("a pipe that no program reads from is told, not waited for") {
  const test::TemporaryFolder folder;
  const std::string fifo = folder.path() + "/fifo";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(core::write_file_atomically(fifo, "x"),
                    Catch::Contains("no program reads from this pipe"));
}
