// Kinds of files, see file_kind.hpp.
#include "host/log/file_kind.hpp"

#include <cctype>
#include <string>

#include "host/core/commands.hpp"
#include "host/core/message.hpp"

namespace furcula::log {
namespace {

using namespace std::string_view_literals;

/// In a command FILE, "FILE", CSV and "CSV" become the paths of the file and of the log to be made of it. A command that begins with
/// "py " is Python.
std::string command(std::string_view form, const std::string& path) {
  const bool python = form.starts_with("py ");
  if (python) form.remove_prefix(3);
  const std::string csv = core::with_ending(path, ".csv");
  std::string out;
  for (std::size_t i = 0; i < form.size();) {
    const std::string_view rest = form.substr(i);
    const bool file = rest.starts_with("FILE");
    if (file || rest.starts_with("CSV")) {
      const std::string& name = file ? path : csv;
      out += python ? core::python_string(name) : core::shell_word(name);
      i += file ? 4 : 3;
    } else {
      out += form[i++];
    }
  }
  return core::printable(python ? core::python_command(out) : out);
}

/// How a file begins, what it is, and how a log is made of it.
struct Kind {
  std::string_view start;
  std::string_view what;
  std::string_view next;      ///< what to do
  std::string_view how = {};  ///< by which command; may be empty
  bool binary =
      false;  ///< letters that a column's name could have: only where the first bytes have a NUL, too
};

constexpr std::string_view kUnpack = "unpack it";
constexpr std::string_view kConvert = "convert it";
constexpr std::string_view kExport = "export the rows as CSV from the program that recorded them";
constexpr std::string_view kBus = "give the recording to furcula bus log, which makes a log of it";
constexpr std::string_view kExcel = "save the sheet as CSV";
constexpr std::string_view kExcelBy = "soffice --headless --convert-to csv FILE";
constexpr std::string_view kMatlab =
    "convert it (in MATLAB: T = table(t, q, tau, 'VariableNames', {'time_s', ...}) of its variables, then "
    "writetable(T, 'run.csv'))";

// In the order of trial. Sources: RFC 1952 (gzip), the formats' own documents, and the `magic` files of file(1).
constexpr Kind kFiles[]{
    // Compressed.
    {"\x1f\x8b"sv, "compressed (gzip)", kUnpack, "gunzip -k FILE"},
    {"BZh91AY&SY"sv, "compressed (bzip2)", kUnpack, "bunzip2 -k FILE"},
    {"\xfd"
     "7zXZ\0"sv,
     "compressed (xz)", kUnpack, "unxz -k FILE"},
    {"\x28\xb5\x2f\xfd"sv, "compressed (zstd)", kUnpack, "unzstd FILE"},
    {"\x04\x22\x4d\x18"sv, "compressed (lz4)", kUnpack, "unlz4 FILE"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7-Zip archive", kUnpack, "7z x FILE"},
    {"Rar!\x1a\x07"sv, "a RAR archive", kUnpack, "unrar x FILE"},
    // Tables and arrays.
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, "an Excel workbook (.xls)", kExcel, kExcelBy},
    {"MATLAB 5.0 MAT-file"sv, "a MATLAB file (.mat)", kMatlab},
    {"MATLAB 7.3 MAT-file"sv, "a MATLAB file (.mat, version 7.3)", kMatlab},
    {"\x93NUMPY"sv, "a NumPy array (.npy)", "convert it, with the names of its columns",
     R"(py import numpy as np; np.savetxt(CSV, np.load(FILE), delimiter=",", header="time_s,..."))"},
    {"PAR1"sv, "a Parquet file", kConvert,
     "py import pandas as pd; pd.read_parquet(FILE).to_csv(CSV, index=False)", true},
    {"ARROW1"sv, "a Feather (Arrow) file", kConvert,
     "py import pandas as pd; pd.read_feather(FILE).to_csv(CSV, index=False)", true},
    {"FEA1"sv, "a Feather (Arrow) file", kConvert,
     "py import pandas as pd; pd.read_feather(FILE).to_csv(CSV, index=False)", true},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file", "convert it (h5ls -r lists its arrays; write their names here)",
     R"(py import h5py, pandas as pd; f = h5py.File(FILE); pd.DataFrame({c: f[c][:] for c in ["time_s", "..."]}).to_csv(CSV, index=False))"},
    {"TDSm"sv, "a LabVIEW file (.tdms)", kConvert,
     "py from nptdms import TdmsFile; TdmsFile.read(FILE).as_dataframe(time_index=True).to_csv(CSV)", true},
    {"MDF     "sv, "an ASAM MDF file (.mf4)", kConvert,
     "py from asammdf import MDF; MDF(FILE).to_dataframe().to_csv(CSV)", true},
    // Recordings of robots.
    {"#ROSBAG V"sv, "a ROS bag", "write a topic as CSV", "rostopic echo -b FILE -p /joint_states > CSV"},
    {"ULog\x01\x12\x35"sv, "a log of PX4 (.ulg)", "convert it, with pyulog", "ulog2csv FILE"},
    {"\xa3\x95\x80"sv, "a log of ArduPilot (.bin)", "convert it, with pymavlink",
     "mavlogdump.py --format csv --types ATT FILE > CSV"},
    {"LOGG"sv, "a recording of a bus (Vector's .blf)", kBus, {}, true},
    {"\x0a\x0d\x0d\x0a"sv, "a capture of packets (.pcapng)", kExport},
    {"\xd4\xc3\xb2\xa1"sv, "a capture of packets (.pcap)", kExport},
    {"time_s,interface,message,signal"sv, "a table of furcula bus decode, with a signal in each row", kBus},
    {"timestamp,arbitration_id"sv, "a recording of a bus (python-can's CSV)", kBus},
    // Pages and pictures.
    {"%PDF-"sv, "a PDF document", kExport},
    {"{\\rtf"sv, "a text with formats (RTF)", "save it as plain text"},
    {"\x89PNG\r\n\x1a\n"sv, "a picture (PNG)", kExport},
    {"\xff\xd8\xff"sv, "a picture (JPEG)", kExport},
    {"GIF8"sv, "a picture (GIF)", kExport, {}, true},
    {"\x7f"
     "ELF"sv,
     "a program", "give a log"},
};

bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

std::string sentence(std::string_view what, std::string_view next, std::string_view how,
                     const std::string& path) {
  return "is " + std::string(what) + "; expected a log (CSV): " + std::string(next) +
         (how.empty() ? "" : ", " + command(how, path));
}

/// Zip archives are the covers of other files: the names within say which.
std::string zip_file(std::string_view head, const std::string& path) {
  if (contains(head, "opendocument.spreadsheet"))
    return sentence("a spreadsheet (.ods)", kExcel, kExcelBy, path);
  if (contains(head, "word/") || contains(head, "opendocument.text"))
    return sentence("a text document", "save its table as CSV", {}, path);
  if (contains(head, "[Content_Types].xml") || contains(head, "xl/") || contains(head, "docProps/"))
    return sentence("an Excel workbook (.xlsx)", kExcel, kExcelBy, path);
  if (contains(head, ".npy"))
    return sentence(
        "a file of NumPy arrays (.npz)", kConvert,
        "py import numpy as np, pandas as pd; pd.DataFrame(dict(np.load(FILE))).to_csv(CSV, index=False)",
        path);
  return sentence("a zip archive", kUnpack, "unzip FILE", path);
}

/// Text in small letters without what stands before its first sign.
std::string small(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  std::string out(text.substr(first == text.npos ? text.size() : first));
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

std::string other_file(std::string_view head, const std::string& path) {
  const bool binary = contains(head, "\0"sv);
  for (const Kind& k : kFiles)
    if (head.starts_with(k.start) && (!k.binary || binary)) return sentence(k.what, k.next, k.how, path);
  if (head.starts_with("PK\x03\x04"sv)) return zip_file(head, path);
  if (head.starts_with("SQLite format 3\0"sv)) {
    if (contains(head, "CREATE TABLE messages"))
      return sentence("a ROS 2 bag (.db3)", "give the path of its file or directory, not a pipe", {}, path);
    return sentence("a database (SQLite)", "write a table of it as CSV, with its name in place of TABLE",
                    "sqlite3 -header -csv FILE \"select * from TABLE\" > CSV", path);
  }
  // PROTO and the number of the protocol, 2 to 5 (PEP 307, 3154, 574); the stop code of 0 and 1 is at the end only.
  if (head.size() > 2 && head[0] == '\x80' && head[1] >= 2 && head[1] <= 5)
    return sentence("a Python pickle", "convert it, if you trust who wrote it",
                    "py import pandas as pd; pd.DataFrame(pd.read_pickle(FILE)).to_csv(CSV, index=False)",
                    path);
  // POSIX.1-1988: the header of an archive's first file has its magic at 257.
  if (head.size() > 262 && head.substr(257, 5) == "ustar")
    return sentence("an archive (tar)", kUnpack, "tar xf FILE", path);
  return {};
}

std::string other_text(std::string_view head, const std::string& path) {
  const std::string text = small(head);
  const auto begins = [&](std::string_view start) { return text.starts_with(start); };
  if (begins("<")) {
    if (contains(text, "<robot"))
      return sentence("a robot (URDF)",
                      "give it as urdf in a model file, --model, and a recording of the robot as the log", {},
                      path);
    if (contains(text, "<mujoco") || contains(text, "<sdf"))
      return sentence("a robot (MJCF or SDF)", "give a recording of the robot as the log", {}, path);
    if (begins("<!doctype html") || contains(text, "<html"))
      return sentence("a web page (HTML)", "download the file itself (on GitHub: \"Raw\")", {}, path);
    if (contains(text, "<workbook")) return sentence("a workbook (XML)", kExcel, kExcelBy, path);
    if (begins("<?xml") || begins("<!--") || begins("<!doctype"))
      return sentence("an XML file", kExport, {}, path);
    return {};
  }
  const std::size_t second = text.find_first_not_of(" \t\r\n", 1);
  const char next = second == text.npos ? '\0' : text[second];
  if ((begins("{") && (next == '"' || next == '}')) || (begins("[") && (next == '{' || next == '['))) {
    // Several objects, one a line, are JSON Lines.
    const std::size_t end = text.find('\n');
    const bool lines =
        begins("{") && end != text.npos && text.find_last_not_of(" \t\r", end - 1) != text.npos &&
        text[text.find_last_not_of(" \t\r", end - 1)] == '}' && text.compare(end + 1, 1, "{") == 0;
    return sentence("a JSON file", kConvert,
                    lines ? "py import pandas as pd; pd.read_json(FILE, lines=True).to_csv(CSV, index=False)"
                          : "py import pandas as pd; pd.read_json(FILE).to_csv(CSV, index=False)",
                    path);
  }
  for (const std::string_view section : {"[model]", "[parameters]", "[experiment]", "[free]"})
    if (begins(section)) return sentence("a model or a scenario (TOML)", "give it with --model", {}, path);
  for (const std::string_view key : {"machine_type", "rig", "time_s", "separator", "decimal"})
    if (begins(key) && second != text.npos) {
      const std::size_t equals = text.find_first_not_of(" \t", key.size());
      if (equals != text.npos && text[equals] == '=')
        return sentence("a map file (TOML)", "give it with --map, and the log beside it", {}, path);
    }
  if (begins("header:\n") || begins("header:\r\n") || begins("---\nheader:"))
    return sentence("a print of ros2 topic echo (YAML)",
                    "print the messages with --csv (ROS 1: rostopic echo -p)", {}, path);
  // "(1732672000.123456) can0 123#0011", of candump -L and -ta; " can0  123   [8]  11 22", of candump.
  const bool stamp = begins("(") && text.size() > 1 &&
                     std::isdigit(static_cast<unsigned char>(text[1])) != 0 &&
                     contains(std::string_view(text).substr(0, 32), ") ");
  if (stamp || begins("can0 ") || begins("can1 ") || begins("vcan0 ") || begins("date ") ||
      begins(";$fileversion"))
    return sentence("a recording of a bus", kBus, {}, path);
  return {};
}

std::string unknown_file_hint(const std::string& path) {
  return " (if it is no text: `" + command("file FILE", path) + "` may say what it is; " +
         std::string(kExport) + ")";
}

}  // namespace furcula::log
