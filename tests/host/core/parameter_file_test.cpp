// The file of parameters on a computer: what is damaged in it is not believed.
#include "host/core/parameter_file.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;

TEST_CASE("what a store saves it loads, and nothing that was cut or changed at any byte") {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/parameters";
  core::ParameterFile store(path);
  std::array<std::uint8_t, 64> into{};
  CHECK(store.load(into).value() == 0);  // never saved
  const std::array<std::uint8_t, 10> image{1, 2, 3, 0, 255, 10, 13, 7, 8, 9};
  REQUIRE(store.save(image) == Status::ok);
  REQUIRE(store.load(into).ok());
  CHECK(store.load(into).value() == image.size());
  CHECK(std::equal(image.begin(), image.end(), into.begin()));

  std::ifstream file(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  const auto write = [&](const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    write(whole.substr(0, i));
    CHECK(store.load(into).status() == Status::invalid);
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    write(changed);
    CHECK(store.load(into).status() == Status::invalid);
  }
  write(whole + "x");
  CHECK(store.load(into).status() == Status::invalid);
  write(whole);
  std::array<std::uint8_t, 9> too_small{};
  CHECK(store.load(too_small).status() == Status::invalid);
}

TEST_CASE("a store that cannot be written says so and leaves no part") {
  const test::TemporaryFolder folder;
  core::ParameterFile store(folder.path() + "/no/such/folder");
  const std::array<std::uint8_t, 4> image{};
  CHECK(store.save(image) == Status::disconnected);
  CHECK(std::filesystem::is_empty(folder.path()));
  core::ParameterFile none("");
  CHECK(none.save(image) == Status::disconnected);
}

TEST_CASE("only a file that is not there was never saved") {
  const test::TemporaryFolder folder;
  std::array<std::uint8_t, 64> into{};
  const auto load = [&](const std::string& path) { return core::ParameterFile(path).load(into); };
  CHECK(load(folder.path() + "/none").value() == 0);
  CHECK(load(folder.path() + "/none").ok());
  // Of all others the reason cannot be that nobody saved: a file in the place of a folder, a folder, links
  // that name each other, a pipe, a name that is too long.
  const std::string file = folder.file("file", "x");
  CHECK(load(file + "/x").status() == Status::invalid);
  CHECK(load(folder.path()).status() == Status::invalid);
  std::filesystem::create_symlink(folder.path() + "/b", folder.path() + "/a");
  std::filesystem::create_symlink(folder.path() + "/a", folder.path() + "/b");
  CHECK(load(folder.path() + "/a").status() == Status::invalid);
  REQUIRE(::mkfifo((folder.path() + "/fifo").c_str(), 0600) == 0);
  CHECK(load(folder.path() + "/fifo").status() == Status::invalid);
  CHECK(load(folder.path() + "/" + std::string(300, 'n')).status() == Status::invalid);
  CHECK(load(folder.file("empty", "")).status() == Status::invalid);
  // Nor can a folder be saved to, or what is below a file: that is told.
  const std::array<std::uint8_t, 4> image{};
  CHECK(core::ParameterFile(folder.path()).save(image) == Status::disconnected);
  CHECK(core::ParameterFile(file + "/x").save(image) == Status::disconnected);
}
