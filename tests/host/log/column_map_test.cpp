// Map files: what they do to a foreign log, and what is refused.
#include "host/log/column_map.hpp"

#include <catch2/catch.hpp>

#include "host/log/reader.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const std::string kMap =
    "machine_type = \"rotary_joint\"\ntime_s = { column = \"time\" }\n"
    "angle_rad = { column = \"pos\", scale = 0.5, offset = -1.0 }\ntorque_nm = { column = \"tau\", scale = -2 }\n";

std::string refused(const std::string& text) {
  return test::error_message([&] { log::parse_column_map(text, "map.toml"); });
}
std::string refused_log(const std::string& map_text, const std::string& text) {
  const log::ColumnMap map = log::parse_column_map(map_text, "map.toml");
  return test::error_message([&] { log::parse_log(text, "a.csv", "rotary_joint", &map); });
}

}  // namespace

TEST_CASE("a map turns a foreign log's columns into ours, and keeps the others") {
  const log::ColumnMap map = log::parse_column_map(kMap, "map.toml");
  const log::Log log =
      log::parse_log("tau,time,pos,temp\n1,0,4,30\n-3,0.5,5,31\n", "a.csv", "rotary_joint", &map);
  CHECK(log.time_s() == std::vector<double>{0.0, 0.5});
  CHECK(log.at("angle_rad") == std::vector<double>{1.0, 1.5});
  CHECK(log.at("torque_nm") == std::vector<double>{-2.0, 6.0});
  CHECK(log.at("temp") == std::vector<double>{30.0, 31.0});
  CHECK_FALSE(log.has("pos"));
}

TEST_CASE("one foreign column may serve two of ours, and a namesake of a mapped column is not ours") {
  const log::ColumnMap map =
      log::parse_column_map(kMap + "torque_cmd_nm = { column = \"tau\" }\n", "map.toml");
  const log::Log log = log::parse_log("tau,time,pos,angle_rad\n1,0,4,99\n", "a.csv", "rotary_joint", &map);
  CHECK(log.at("torque_cmd_nm") == std::vector<double>{1.0});
  CHECK(log.at("torque_nm") == std::vector<double>{-2.0});
  CHECK(log.at("angle_rad") == std::vector<double>{1.0});
}

TEST_CASE("a foreign log that does not suit the map is refused") {
  CHECK_THAT(refused_log(kMap, "time,tau\n0,1\n"),
             Contains("a.csv:1: no column 'pos', which map.toml maps to 'angle_rad'"));
  CHECK_THAT(refused_log(kMap, "time,pos,tau\n0,1,x\n"),
             Contains("a.csv:2: column 'tau' (mapped to 'torque_nm'): 'x' is not a number"));
  CHECK_THAT(refused_log(kMap, "time,pos,tau\n0,1,1e308\n"),
             Contains("column 'tau' (mapped to 'torque_nm'): not finite after the map"));
  CHECK_THAT(refused_log("machine_type = \"rotary_joint\"\ntime_s = { column = \"t\", scale = -1 }\n",
                         "t,angle_rad,torque_nm\n0,1,1\n1,1,1\n"),
             Contains("a.csv:3: column 't' (mapped to 'time_s'): -1 s after 0 s"));
  CHECK_THAT(refused_log("machine_type = \"hopper\"\ntime_s = { column = \"t\" }\n", "t\n0\n"),
             Contains("map.toml: machine_type is 'hopper'; expected rotary_joint"));
}

TEST_CASE("a map file that is not strict is refused with its line") {
  CHECK_THAT(refused("machine_type = \"hoper\"\n"),
             Contains("map.toml:1: unknown machine type 'hoper'; expected one of hopper") &&
                 Contains("did you mean 'hopper'?"));
  CHECK_THAT(refused("machine_type = 3\n"), Contains("map.toml:1: machine_type is 3; expected a string"));
  CHECK_THAT(refused("machine_type = \"hopper\"\n"), Contains("map.toml:1: no column is mapped"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheigth_m = { column = \"z\" }\n"),
             Contains("map.toml:2: unknown key 'heigth_m'") && Contains("did you mean 'height_m'?"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = \"z\"\n"),
             Contains("map.toml:2: height_m is 'z'; expected a table"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = { scale = 2 }\n"),
             Contains("map.toml:2: height_m has no key 'column'"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = { column = \"z\", scal = 2 }\n"),
             Contains("unknown key 'scal' in height_m") && Contains("did you mean 'scale'?"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = { column = \"z\", scale = 0 }\n"),
             Contains("map.toml:2: height_m.scale = 0; expected another number than zero"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = { column = \"z\", offset = nan }\n"),
             Contains("map.toml:2: height_m.offset = nan; expected a number"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = { column = \"z\", scale = \"2\" }\n"),
             Contains("height_m.scale is '2'; expected a number"));
  CHECK_THAT(refused("machine_type = \"hopper\"\nheight_m = {\n"), Contains("map.toml:2: no valid TOML"));
}

TEST_CASE("a key with control characters does not reach the message as it is") {
  CHECK_THAT(
      refused(
          "machine_type = \"tree\"\ntime_s = { column = \"t\" }\n\"angle_\\u001b[2J\\n_rad\" = { column = 1 }\n"),
      Contains("\\x1b[2J\\x0a_rad") && !Contains("\x1b") && !Contains("\n"));
  const log::ColumnMap map = log::parse_column_map(
      "machine_type = \"tree\"\ntime_s = { column = \"t\" }\n\"angle_\\n_rad\" = { column = \"gone\" }\n",
      "map.toml");
  CHECK_THAT(test::error_message([&] { log::parse_log("t,q\n0,1\n1,2\n", "a.csv", "tree", &map); }),
             Contains("'angle_\\x0a_rad'") && !Contains("\n"));
}

TEST_CASE("a map reads decimal commas between semicolons, and a constant in place of a column") {
  const log::ColumnMap map = log::parse_column_map(
      "machine_type = \"rotary_joint\"\nseparator = \";\"\ndecimal = \",\"\ntime_s = { column = \"t\" }\n"
      "angle_rad = { column = \"q\", scale = 2 }\ntorque_nm = { value = -0.5 }\n",
      "map.toml");
  const log::Log log =
      log::parse_log("t;q;name\n0,5;1,25;\"a;b\"\n1;-2,5e1;c\n1,5;3;d\n", "a.csv", "rotary_joint", &map);
  CHECK(log.time_s() == std::vector<double>{0.5, 1.0, 1.5});
  CHECK(log.at("angle_rad") == std::vector<double>{2.5, -50.0, 6.0});
  CHECK(log.at("torque_nm") == std::vector<double>{-0.5, -0.5, -0.5});
  CHECK_THAT(test::error_message([&] { log::parse_log("t;q\n0,5;1.2.5\n", "a.csv", "rotary_joint", &map); }),
             Contains("a.csv:2: column 'q' (mapped to 'angle_rad')"));
}

TEST_CASE("a foreign log with semicolons or decimal commas is told what the map may say") {
  CHECK_THAT(refused_log(kMap, "time;pos;tau\n0;1,5;2\n"), Contains("in map.toml the line decimal = \",\""));
  CHECK_THAT(refused_log("separator = \",\"\n" + kMap, "time;pos;tau\n0;1;2\n"),
             Contains("separator = \";\""));
  CHECK_THAT(refused_log(kMap, "time,pos,tau\n0,\"1,5\",2\n"), Contains("decimal = \",\""));
}

TEST_CASE("a map that contradicts itself is refused") {
  const std::string rig = "machine_type = \"hopper\"\n";
  CHECK_THAT(refused(rig + "separator = \",\"\ndecimal = \",\"\nheight_m = { column = \"z\" }\n"),
             Contains("expected separator"));
  CHECK_THAT(refused(rig + "separator = \"x\"\nheight_m = { column = \"z\" }\n"), Contains("separator = "));
  CHECK_THAT(refused(rig + "height_m = { value = 0, column = \"z\" }\n"), Contains("a constant alone"));
  CHECK_THAT(refused(rig + "time_s = { value = 0 }\n"), Contains("time_s is a constant"));
  CHECK_THAT(refused(rig + "contact = { value = 0.5 }\n"), Contains("expected 0 or 1"));
}

TEST_CASE("a map may call the machine type by its earlier name, rig") {
  CHECK(log::parse_column_map("rig = \"rail_carriage\"\nheight_m = { column = \"z\" }\n", "map.toml").rig ==
        "rail_carriage");
}

TEST_CASE("a map without a rig, or with a separator alone, is complete") {
  const log::ColumnMap map = log::parse_column_map("angle_rad = { column = \"q\" }\n", "map.toml");
  CHECK(map.rig.empty());
  CHECK(log::parse_log("time_s,q,torque_nm\n0,4,1\n", "a.csv", "rotary_joint", &map).at("angle_rad") ==
        std::vector<double>{4.0});
  CHECK_THAT(
      test::error_message([&] { log::parse_log("t,height_m\n0,4\n", "a.csv", "rail_carriage", &map); }),
      Contains(
          "map.toml:1: machine type rail_carriage has no column 'angle_rad'; expected one of time_s, height_m"));
  const log::ColumnMap alone =
      log::parse_column_map("machine_type = \"rail_carriage\"\nseparator = \" \"\n", "map.toml");
  CHECK(
      log::parse_log("  time_s   height_m\n  0 \t  4 \n", "a.csv", "rail_carriage", &alone).at("height_m") ==
      std::vector<double>{4.0});
}

TEST_CASE("several columns are added, each with its scale, and the offset once") {
  const log::ColumnMap map = log::parse_column_map(
      "torque_nm = { columns = [\"a\", \"b\", \"c\"], scales = [2, -1, 0.5], offset = 10 }\n"
      "time_s = { columns = [\"sec\", \"nsec\"], scales = [1, 1e-9] }\n",
      "map.toml");
  const log::Log log = log::parse_log("sec,nsec,angle_rad,a,b,c\n3,500000000,1,1,2,4\n4,0,1,0,1,0\n", "a.csv",
                                      "rotary_joint", &map);
  CHECK(log.at("torque_nm") == std::vector<double>{2.0 - 2.0 + 2.0 + 10.0, -1.0 + 10.0});
  CHECK(log.time_s() == std::vector<double>{3.5, 4.0});
}

TEST_CASE("time in two columns is answered with the line that adds them") {
  const std::string line = "time_s = { columns = [\"stamp.secs\", \"stamp.nsecs\"], scales = [1, 1e-9] }";
  std::string text = "stamp.secs,stamp.nsecs,angle_rad,torque_nm\n";
  for (int i = 0; i < 30; ++i) text += "1732672000," + std::to_string(1000000 * i) + ",0,0\n";
  CHECK_THAT(refused_log("time_s = { column = \"stamp.secs\" }\n", text),
             Contains("a.csv:3: ") && Contains("in map.toml the line " + line));
  CHECK_THAT(test::error_message([&] { log::parse_log(text, "a.csv", "rotary_joint"); }),
             Contains("no column 'time_s'") && Contains("a --map file with the line " + line));
}

TEST_CASE("columns to add that do not fit together are refused") {
  CHECK_THAT(refused("time_s = { columns = [\"a\", \"b\"], scales = [1] }\n"),
             Contains("map.toml:1: time_s has 2 columns and 1 scales"));
  CHECK_THAT(refused("time_s = { columns = [\"a\"], scale = 2 }\n"), Contains("'scale' beside 'columns'"));
  CHECK_THAT(refused("time_s = { columns = [\"a\"], column = \"b\" }\n"),
             Contains("'column' beside 'columns'"));
  CHECK_THAT(refused("time_s = { column = \"a\", scales = [1] }\n"),
             Contains("'scales' beside 'column'; expected 'scale'"));
  CHECK_THAT(refused("time_s = { columns = [] }\n"), Contains("time_s.columns is an array; expected names"));
  CHECK_THAT(refused("time_s = { columns = [\"a\", \"a\"] }\n"), Contains("has 'a' twice"));
  CHECK_THAT(refused("time_s = { columns = [\"a\", \"b\"], scales = [1, 0] }\n"),
             Contains("expected another number than zero"));
  CHECK_THAT(refused("time_s = { columns = \"a\" }\n"), Contains("time_s.columns is 'a'; expected names"));
}
