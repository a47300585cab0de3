// What is taken out of a log before anything is learnt from it, and how it is named.
#include "host/log/clean.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/log/reader.hpp"

using namespace furcula;

namespace {

const std::vector<log::Watched> kWatched{{"angle_rad", true, 2.0 * std::numbers::pi}, {"torque_nm", false}};

std::string text_of(double (*angle)(int), double (*torque)(int), int rows = 400) {
  std::string text = "# machine_type: rotary_joint\ntime_s,angle_rad,torque_nm\n";
  for (int i = 0; i < rows; ++i)
    text +=
        std::to_string(0.001 * i) + "," + std::to_string(angle(i)) + "," + std::to_string(torque(i)) + "\n";
  return text;
}

double swing(int i) { return 0.5 * std::sin(0.01 * i); }
double push(int i) { return std::cos(0.01 * i); }

}  // namespace

TEST_CASE("Refused rows are gone from every column and named with row, line, column and value") {
  const std::string text = text_of([](int i) { return i == 100 ? 9.5 : swing(i); },
                                   [](int i) { return i == 200 ? 1e6 : push(i); });
  const log::Log given = log::parse_log(text, "a.csv", "rotary_joint");
  const log::Clean c = log::clean(given, kWatched, {{300, "angle_rad", "a run refutes it"}});
  CHECK(c.log.rows() == 397);
  CHECK(c.row[100] == 101);
  CHECK(c.log.at("torque_nm")[100] == Approx(push(101)).epsilon(1e-5));
  REQUIRE(c.log.refused.size() == 3);
  CHECK(c.log.refused[0].row == 101);
  CHECK(c.log.refused[0].line == 103);
  CHECK(c.log.refused[0].value == 9.5);
  CHECK(c.log.refused[1].column == "torque_nm");
  CHECK(c.log.refused[1].line == 203);
  CHECK(c.log.refused[2].why == "a run refutes it");
  CHECK(log::in_words(c.log.refused) ==
        "3 rows refused: a.csv row 101 (line 103) angle_rad 9.5: steps out of the rows around and back; "
        "a.csv row 201 (line 203) torque_nm 1e+06: is beyond all other rows by far; "
        "a.csv row 301 (line 303) angle_rad 0.07056: a run refutes it");
}

TEST_CASE("A clean log stays as it is") {
  const log::Log given = log::parse_log(text_of(swing, push), "a.csv", "rotary_joint");
  const log::Clean c = log::clean(given, kWatched);
  CHECK(c.log.columns == given.columns);
  CHECK(c.log.refused.empty());
  CHECK(c.log.notes.empty());
}

TEST_CASE("Of a column in which a tenth is out of line nothing is refused, and a note says so") {
  const std::string text = text_of([](int i) { return i % 10 == 5 ? 9.5 : swing(i); }, push);
  const log::Clean c = log::clean(log::parse_log(text, "a.csv", "rotary_joint"), kWatched);
  CHECK(c.log.rows() == 400);
  REQUIRE(c.log.notes.size() == 1);
  CHECK_THAT(c.log.notes[0], Catch::Contains("a.csv: 40 of 400 rows of angle_rad"));
}

TEST_CASE("An angle that wraps goes on, with a wrong row in it, and a note says so") {
  const auto wrapped = [](int i) {
    const double turn = 2.0 * std::numbers::pi, x = 0.02 * i;
    return i == 60 ? 40.0 : x - turn * std::floor((x + 1.0) / turn);
  };
  const log::Clean c = log::clean(log::parse_log(text_of(wrapped, push), "a.csv", "rotary_joint"), kWatched);
  REQUIRE(c.log.rows() == 399);
  for (std::size_t i = 0; i < 399; ++i)
    CHECK(c.log.at("angle_rad")[i] == Approx(0.02 * static_cast<double>(c.row[i])).margin(1e-5));
  REQUIRE(c.log.notes.size() == 1);
  CHECK_THAT(c.log.notes[0], Catch::Contains("angle_rad jumps to and fro by 6.28319, a turn"));
}
