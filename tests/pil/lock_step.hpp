// What tests of a board in lock step share: its image, its budget, and replies bit by bit.
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "host/pil/own_image.hpp"
#include "host/pil/qemu.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

namespace furcula::test {

/// Beside the application's own.
inline std::string lock_step_image(const std::string& board) {
  return (std::filesystem::path(pil::own_image()).parent_path() / (board + ".elf")).string();
}

/// Skips the test, and says why, where this image cannot run.
inline bool cannot_lock_step(const std::string& image) {
  const std::string reason = pil::why_not_here(image);
  if (!reason.empty()) skip(reason.c_str());
  return !reason.empty();
}

/// The lines of a board's budget.txt: name and most.
inline std::map<std::string, double> budget_of(const std::string& board) {
  std::ifstream file(source("boards/" + board + "/budget.txt"));
  REQUIRE(file);
  std::map<std::string, double> budget;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    double most = 0.0;
    if (words >> name >> most) budget[name] = most;
  }
  return budget;
}

/// A reply as it is in memory, but for its last word, what the tick took: 0 and -0 differ, and a NaN equals itself.
template <class Reply>
auto bits(const Reply& reply) {
  std::array<std::uint32_t, sizeof(Reply) / 4 - 1> out;
  static_assert(sizeof(Reply) % 4 == 0);
  std::memcpy(out.data(), &reply, sizeof(out));
  return out;
}

}  // namespace furcula::test
