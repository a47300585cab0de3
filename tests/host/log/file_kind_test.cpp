// Files that are no log: each is called what it is, with the way to make a log of it.
#include "host/log/file_kind.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "host/log/reader.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace std::string_literals;
using Catch::Contains;

namespace {

std::string refused(const std::string& bytes, const std::string& path = "run.x") {
  return test::error_message([&] { log::parse_log(bytes, path, "rotary_joint"); });
}

}  // namespace

TEST_CASE("a file of another kind is called what it is, with what makes a log of it") {
  const struct {
    std::string bytes, what, next;
  } kFiles[]{
      {"\x1f\x8b\x08\0\0\0\0\0\0\x03"s, "compressed (gzip)", "gunzip -k run.x"},
      {"BZh91AY&SYabc", "compressed (bzip2)", "bunzip2 -k run.x"},
      {"\xfd"
       "7zXZ\0"s,
       "compressed (xz)", "unxz -k run.x"},
      {"\x28\xb5\x2f\xfd\x04", "compressed (zstd)", "unzstd run.x"},
      {"PK\x03\x04\x14\0\x06\0[Content_Types].xml"s, "an Excel workbook (.xlsx)",
       "soffice --headless --convert-to csv run.x"},
      {"PK\x03\x04mimetypeapplication/vnd.oasis.opendocument.spreadsheet", "a spreadsheet (.ods)",
       "save the sheet as CSV"},
      {"PK\x03\x04\0\0angle.npy"s, "NumPy arrays (.npz)", "dict(np.load(\"run.x\"))"},
      {"PK\x03\x04\0\0run.csv"s, "a zip archive", "unzip run.x"},
      {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0"s, "an Excel workbook (.xls)", "save the sheet as CSV"},
      {"MATLAB 5.0 MAT-file, Platform: GLNXA64\0\1IM"s, "a MATLAB file", "writetable"},
      {"\x93NUMPY\1\0"s, "a NumPy array (.npy)", "np.savetxt(\"run.csv\", np.load(\"run.x\")"},
      {"\x80\x04\x95\0\0"s, "a Python pickle", "read_pickle"},
      {"PAR1\x15\0"s, "a Parquet file", "read_parquet(\"run.x\").to_csv(\"run.csv\""},
      {"\x89HDF\r\n\x1a\n\0"s, "an HDF5 file", "h5py"},
      {"SQLite format 3\0\x10"s, "a database (SQLite)", "sqlite3 -header -csv run.x"},
      {"SQLite format 3\0\x10 CREATE TABLE messages(id"s, "a ROS 2 bag (.db3)", "not a pipe"},
      {"#ROSBAG V2.0\n\0"s, "a ROS bag", "rostopic echo -b run.x -p"},
      {"ULog\x01\x12\x35\x01", "a log of PX4", "ulog2csv run.x"},
      {"%PDF-1.5\n", "a PDF document", "export the rows as CSV"},
      {std::string(257, 'a') + "ustar\0"s, "an archive (tar)", "tar xf run.x"},
      {"LOGG\x90\0"s, "a recording of a bus", "furcula bus log"},
      {"(1732672000.1) can0 123#0011\n", "a recording of a bus", "furcula bus log"},
      {"time_s,interface,message,signal,value\n0,can0,a,b,1\n", "a table of furcula bus decode",
       "furcula bus log"},
      {"<?xml version=\"1.0\"?>\n<robot name=\"arm\">", "a robot (URDF)", "--model"},
      {"\n<!DOCTYPE html>\n<html>", "a web page (HTML)", "download the file itself"},
      {"[\n {\"t\": 0}]", "a JSON file", "read_json(\"run.x\")"},
      {"{\"t\": 0}\n{\"t\": 1}\n", "a JSON file", "lines=True"},
      {"[model]\nkind = \"tree\"\n", "a model or a scenario", "--model"},
      {"machine_type = \"hopper\"\n", "a map file", "--map"},
  };
  for (const auto& file : kFiles) {
    const std::string message = refused(file.bytes);
    INFO(file.what);
    CHECK_THAT(message, Catch::StartsWith("run.x: is ") && Contains(file.what) &&
                            Contains("; expected a log (CSV): ") && Contains(file.next));
    CHECK(message.find('\n') == std::string::npos);
  }
}

TEST_CASE("a command in a message takes the file's name as a shell and Python do") {
  CHECK_THAT(refused("\x1f\x8b\x08", "my run's.csv.gz"), Contains("gunzip -k 'my run'\\''s.csv.gz'"));
  CHECK_THAT(refused("PAR1\0"s, "d.1/a\"b"),
             Contains("read_parquet(\"d.1/a\\\"b\").to_csv(\"d.1/a\\\"b.csv\""));
}

TEST_CASE("a log whose first column or title has the letters of another kind of file is read") {
  const std::string rows = "time_s,angle_rad,torque_nm\n0,1,2\n0.001,1,2\n";
  CHECK(log::parse_log("PAR1,time_s,angle_rad,torque_nm\n7,0,1,2\n7,0.001,1,2\n", "a.csv", "rotary_joint")
            .rows() == 2);
  for (const std::string title : {"[{\"run\": 5}]\n", "<?xml?>\n", "[model]\n", "machine_type = 5\n"})
    CHECK(log::parse_log(title + rows, "a.csv", "rotary_joint").rows() == 2);
}

TEST_CASE("a file that is no text and of no known kind is refused with how to find what it is") {
  CHECK_THAT(refused("abc\0def\n"s),
             Contains("run.x:1: a NUL byte; expected the text of a CSV log") && Contains("`file run.x`"));
}
