// Files of a bag, see files.hpp.
#include "host/bags/files.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "host/bags/ahead.hpp"
#include "host/bags/compression.hpp"
#include "host/bags/mcap.hpp"
#include "host/bags/sqlite.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr std::string_view kSqliteMagic = "SQLite format 3\0"sv;

bool has_bag_name(const std::string& path) {
  for (const std::string_view ending : {".mcap", ".db3", ".mcap.zstd", ".db3.zstd"})
    if (path.ends_with(ending)) return true;
  return false;
}

/// Text with numbers in it, in the order of the numbers: run_2 before run_10.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digits = [](const std::string& s, std::size_t& at) {
    while (at < s.size() && s[at] == '0') ++at;
    const std::size_t begin = at;
    while (at < s.size() && std::isdigit(static_cast<unsigned char>(s[at])) != 0) ++at;
    return s.substr(begin, at - begin);
  };
  while (i < a.size() && j < b.size()) {
    if (std::isdigit(static_cast<unsigned char>(a[i])) != 0 &&
        std::isdigit(static_cast<unsigned char>(b[j])) != 0) {
      const std::string x = digits(a, i), y = digits(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

/// What metadata.yaml lists below "relative_file_paths:". rosbag2 writes a name a line, and nothing else is needed of YAML.
std::vector<std::string> listed_files(const fs::path& metadata) {
  std::ifstream file(metadata);
  std::vector<std::string> out;
  std::string line;
  bool within = false;
  for (std::size_t lines = 0; lines < 1000000 && std::getline(file, line); ++lines) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos) continue;
    const std::string text = line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
    if (text.starts_with("relative_file_paths:")) {
      within = true;
    } else if (within && text.starts_with("- ")) {
      std::string name = text.substr(text.find_first_not_of(' ', 1));
      if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front())
        name = name.substr(1, name.size() - 2);
      out.push_back(std::move(name));
    } else if (within) {
      break;
    }
  }
  return out;
}

/// The name of a bag's file without the number of its part: run for run_0.mcap.
std::string name_of_bag(const fs::path& file) {
  std::string name = file.filename().string();
  name.erase(name.find_last_of('.'));
  if (name.ends_with(".mcap") || name.ends_with(".db3")) name.erase(name.find_last_of('.'));
  const std::size_t last = name.find_last_not_of("0123456789");
  if (last != name.npos && last + 1 < name.size() && name[last] == '_') name.erase(last);
  return name;
}

/// A file that is gone at the end.
class TemporaryFile {
 public:
  TemporaryFile() {
    std::error_code error;
    path_ = (fs::temp_directory_path(error) / "furcula-bag-XXXXXX").string();
    fd_ = error ? -1 : ::mkstemp(path_.data());
    if (fd_ < 0)
      throw core::OutputError(
          "a compressed bag cannot be unpacked: no file can be made in the folder that TMPDIR names, else in "
          "/tmp; expected a folder that can be written");
  }
  ~TemporaryFile() {
    ::close(fd_);
    ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
      if (n <= 0)
        throw core::OutputError(path_ +
                                ": cannot be written: a compressed bag is unpacked there; is the disk full? "
                                "TMPDIR names another folder");
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }

 private:
  std::string path_;
  int fd_;
};

void read_unpacked(const std::string& path, core::ByteSource& source, Sink& sink) {
  ZstdSource unpacked(source, path);
  if (path.ends_with(".mcap.zstd")) return read_mcap(unpacked, path, sink);
  const TemporaryFile file;
  std::array<char, 1 << 16> buffer;
  while (const std::size_t n = unpacked.read(buffer.data(), buffer.size())) file.write({buffer.data(), n});
  read_sqlite_bag(file.path(), path, sink);
}

}  // namespace

bool is_bag(const std::string& path, std::string_view head, bool readable) {
  if (head.starts_with(kMcapMagic.substr(0, 5))) return true;
  if (is_zstd(head)) return path.ends_with(".mcap.zstd") || path.ends_with(".db3.zstd");
  return readable && head.starts_with(kSqliteMagic) && (path.ends_with(".db3") || is_sqlite_bag(path));
}

void read_bag_file(const std::string& path, std::string_view head, core::ByteSource& source, Sink& sink) {
  if (is_zstd(head)) return read_unpacked(path, source, sink);
  if (head.starts_with(kSqliteMagic)) return read_sqlite_bag(path, path, sink);
  read_mcap(source, path, sink);
}

void read_bag_directory(const std::string& path, Sink& sink) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const std::string& name : listed_files(fs::path(path) / "metadata.yaml")) {
    // Some versions write the directory's name before the file's.
    fs::path file = fs::path(path) / name;
    if (!fs::is_regular_file(file, error)) file = fs::path(path) / fs::path(name).filename();
    // Compressed afterwards, which metadata may not say.
    if (!fs::is_regular_file(file, error) && fs::is_regular_file(file.string() + ".zstd", error))
      file += ".zstd";
    if (!fs::is_regular_file(file, error))
      throw core::DataError(
          (fs::path(path) / "metadata.yaml").string() + ": lists " + core::quoted(name) +
          ", which is not there; expected all files of the bag: copy it, or give the files by their "
          "names");
    files.push_back(std::move(file));
  }
  const bool listed = !files.empty();
  if (!listed) {
    for (fs::directory_iterator at(path, error), end; !error && at != end; at.increment(error))
      if (std::error_code ignored; has_bag_name(at->path().string()) && at->is_regular_file(ignored))
        files.push_back(at->path());
    std::sort(files.begin(), files.end(),
              [](const fs::path& a, const fs::path& b) { return comes_before(a.string(), b.string()); });
  }
  if (files.empty())
    throw core::DataError(
        path +
        ": is a directory without a bag; expected a log (CSV), or a directory with .mcap or "
        ".db3 files, as ros2 bag record writes");
  if (!listed && name_of_bag(files.front()) != name_of_bag(files.back()))
    throw core::DataError(path + ": has files of several recordings and no metadata.yaml, as " +
                          files.front().filename().string() + " and " + files.back().filename().string() +
                          "; expected the directory of one bag: give the files by their names");
  for (const fs::path& file : files) {
    Ahead source(std::make_unique<core::FileSource>(file.string(), "a bag's file"));
    const std::string head(source.head(kHead));
    if (head.empty())
      sink.note(core::printable(file.string()) + ": is empty.");
    else
      read_bag_file(file.string(), head, source, sink);
  }
}

}  // namespace furcula::bags
