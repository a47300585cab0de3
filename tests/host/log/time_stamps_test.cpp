// What time stamps imply: each fault is put into the stamps of a motion that is known.
#include "host/log/time_stamps.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "host/log/reader.hpp"
#include "host/log/time_order.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

constexpr double kCount_rad = 2.0 * std::numbers::pi / 8192.0;

double angle(double time_s) { return std::sin(5.0 * time_s) + 0.1 * std::sin(17.0 * time_s); }

/// A joint's angle on an encoder with 13 bits, at the true times of `count` rows, under the stamps that `stamp` makes of them.
log::Log recorded(std::size_t count, const std::function<double(std::size_t)>& time,
                  const std::function<double(std::size_t, double)>& stamp) {
  log::Log log{"a.csv", "rotary_joint", {}, {}, 0, {}, {}, {}, {}};
  std::vector<double> t, q;
  for (std::size_t i = 0; i < count; ++i) {
    t.push_back(stamp(i, time(i)));
    q.push_back(std::round(angle(time(i)) / kCount_rad) * kCount_rad);
  }
  log.columns = {{"time_s", t}, {"angle_rad", q}, {"torque_nm", std::vector<double>(count, 0.0)}};
  return log;
}

std::function<double(std::size_t)> every(double interval_s) {
  return [=](std::size_t i) { return interval_s * static_cast<double>(i); };
}

double as_it_is(std::size_t, double time_s) { return time_s; }

}  // namespace

TEST_CASE(
    "nothing is said of even rows, of irregular ones that are stamped when they were measured, of rows at 10 Hz") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> interval(1e-3, 2e-2);
  std::vector<double> irregular(3000);
  for (std::size_t i = 1; i < irregular.size(); ++i) irregular[i] = irregular[i - 1] + interval(random);
  for (const log::Log& log : {recorded(4000, every(1e-3), as_it_is), recorded(300, every(0.1), as_it_is),
                              recorded(
                                  3000, [&](std::size_t i) { return irregular[i]; }, as_it_is)}) {
    const log::TimeStamps s = log::judge(log);
    CHECK(s.notes.empty());
    CHECK(s.remarks.empty());
    CHECK(s.fatal().empty());
    CHECK(s.gaps.empty());
  }
}

TEST_CASE("a time in another unit than seconds is named, with the scale that makes seconds of it") {
  for (const auto& [unit_s, name, scale] :
       {std::tuple{1e-3, "in ms", "scale = 0.001"}, std::tuple{1e-6, "in us", "scale = 1e-6"},
        std::tuple{1e-9, "in ns", "scale = 1e-9"}})
    for (const double interval_s : {5e-4, 1e-3, 2e-3, 1e-2}) {
      const log::Log log =
          recorded(300, every(interval_s), [seconds = unit_s](std::size_t, double t) { return t / seconds; });
      const log::TimeStamps s = log::judge(log);
      CHECK_THAT(s.unit, Contains(name) && Contains(scale) && Contains("column = \"time_s\""));
    }
  // Uneven ones, too: it is no clock that is set at every row.
  std::mt19937_64 random(5);
  std::string text = "time_s,angle_rad,torque_nm\n";
  double time_s = 0.0;
  for (int i = 0; i < 300; ++i) {
    time_s += 3e-3 + 1e-3 * static_cast<double>(random() % 1000) / 1000.0;
    text += std::to_string(std::llround(1e9 * time_s)) + "," + std::to_string(angle(time_s)) + ",0\n";
  }
  CHECK_THAT(log::judge(log::parse_log(text, "a.csv", "rotary_joint")).unit,
             Contains("in ns") && Contains("scale = 1e-9"));
  // Through a map: what it should have said.
  const log::ColumnMap map =
      log::parse_column_map("time_s = { column = \"tick\", scale = 10 }\n", "map.toml");
  CHECK_THAT(log::judge(recorded(300, every(1e-3), [](std::size_t, double t) { return 1e3 * t; }), &map).unit,
             Contains("time_s = { column = \"tick\", scale = 0.01 }"));
}

TEST_CASE("rows that leave a buffer in bursts are told of, with the number of rows and both intervals") {
  for (const std::size_t rows : {2U, 3U, 8U, 16U, 62U}) {
    const log::Log log = recorded(4000, every(1e-3), [&](std::size_t i, double) {
      return 1e-3 * static_cast<double>(i - i % rows) + 1e-5 * static_cast<double>(i % rows);
    });
    const log::TimeStamps s = log::judge(log);
    INFO(s.bursts);
    CHECK_THAT(s.bursts, Contains("about " + std::to_string(rows) + " rows 0.01 ms apart") &&
                             Contains("mean interval 1 ms"));
    CHECK(s.gaps.empty());
  }
}

TEST_CASE("rows that were measured in bursts are no bursts of stamps") {
  const log::Log log = recorded(
      4000,
      [](std::size_t i) {
        return 0.1 / 16.0 * static_cast<double>(i - i % 16) + 1e-3 * static_cast<double>(i % 16);
      },
      as_it_is);
  CHECK(log::judge(log).fatal().empty());
}

TEST_CASE("bursts of a body that stands still are a note") {
  log::Log log = recorded(800, every(1e-3), [](std::size_t i, double) {
    return 1e-3 * static_cast<double>(i - i % 8) + 1e-5 * static_cast<double>(i % 8);
  });
  log.columns["angle_rad"].assign(800, 0.5);
  const log::TimeStamps s = log::judge(log);
  CHECK(s.fatal().empty());
  REQUIRE(s.notes.size() == 1);
  CHECK_THAT(s.notes[0], Contains("come in bursts") && Contains("the motion is too small to tell"));
}

TEST_CASE("an interval that contradicts the motion is named and opened to a gap") {
  for (const double step_s : {0.04, 0.012, 0.3}) {
    log::Log log =
        recorded(3000, every(1e-3), [&](std::size_t i, double t) { return i < 1010 ? t : t + step_s; });
    const log::TimeStamps s = log::judge(log);
    REQUIRE(s.gaps == std::vector<std::size_t>{1010});
    REQUIRE(s.notes.size() == 1);
    CHECK_THAT(s.notes[0], Contains("a.csv line 1011: ") && Contains("the motion is that of 1 ms"));
    log::open_gaps(log, s.gaps);
    CHECK(log.time_s()[1010] - log.time_s()[1009] == Approx(log::kUnknownInterval_s));
    CHECK(log.time_s()[1011] - log.time_s()[1010] == Approx(1e-3));
  }
}

TEST_CASE("a pause over which the body moves on is no contradiction, and rows that are missing are counted") {
  std::vector<double> times;
  for (std::size_t i = 0; i < 3000; ++i)
    if (i % 300 != 150 && i % 300 != 151 && !(i >= 1000 && i < 1030))
      times.push_back(1e-3 * static_cast<double>(i));
  const log::Log log = recorded(
      times.size(), [&](std::size_t i) { return times[i]; }, as_it_is);
  const log::TimeStamps s = log::judge(log);
  CHECK(s.notes.empty());
  CHECK(s.gaps.empty());
  REQUIRE(s.remarks.size() == 1);
  CHECK_THAT(s.remarks[0], Contains("50 rows seem to be missing in 11 places"));
}

TEST_CASE("rows that were stamped when they arrived, or rounded, are told by the motion") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> late(0.0, 1.8e-3);
  const log::TimeStamps received =
      log::judge(recorded(3000, every(2e-3), [&](std::size_t, double t) { return t + late(random); }));
  REQUIRE(received.notes.size() == 1);
  CHECK_THAT(received.notes[0], Contains("rows 2 ms apart do") && Contains("given when rows arrived"));
  const log::TimeStamps rounded = log::judge(
      recorded(3000, every(1.5e-3), [](std::size_t, double t) { return std::floor(1e3 * t + 1e-9) / 1e3; }));
  REQUIRE(rounded.notes.size() == 1);
  CHECK_THAT(rounded.notes[0], Contains("rows 1.5 ms apart do") && Contains("stamps were rounded"));
  CHECK(rounded.remarks.empty());
}

TEST_CASE("a log of many blocks is judged as one") {
  const log::Log bursts = recorded(70000, every(1e-3), [](std::size_t i, double) {
    return 1e-3 * static_cast<double>(i - i % 16) + 1e-5 * static_cast<double>(i % 16);
  });
  CHECK_THAT(log::judge(bursts).bursts, Contains("about 16 rows 0.01 ms apart"));
  const log::Log stepped =
      recorded(70000, every(1e-3), [](std::size_t i, double t) { return i < 50270 ? t : t + 0.02; });
  CHECK(log::judge(stepped).gaps == std::vector<std::size_t>{50270});
}
