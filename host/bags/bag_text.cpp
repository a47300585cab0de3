// Bags as logs, see bag_text.hpp.
#include "host/bags/bag_text.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "host/bags/ahead.hpp"
#include "host/bags/files.hpp"
#include "host/bags/join.hpp"
#include "host/bags/recording.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

/// A name as a field of a CSV file.
std::string field_of(const std::string& name) {
  const std::string shown = core::printable(name);
  if (shown.find_first_of(",;\"|\t #%") == shown.npos) return shown;
  std::string out = "\"";
  for (const char c : shown) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

/// The rows as they are asked for.
class BagText final : public core::ByteSource {
 public:
  BagText(std::unique_ptr<Recording> recording, const std::string& path, const Request& request)
      : recording_(std::move(recording)), join_(*recording_, path, request) {
    // As many lines above the rows as where the log is written, with its rig.
    text_ = "# format: furcula-log/1\n# of a ROS 2 bag\n# topic: " + core::printable(join_.row_topic()) +
            "\n# clock: " + join_.clock() + "\ntime_s";
    for (const std::string& c : join_.columns()) text_ += "," + field_of(c);
    text_ += '\n';
  }
  const Join& join() const { return join_; }

  std::size_t read(char* to, std::size_t size) override {
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    if (given_ == text_.size()) {
      text_.clear();
      given_ = 0;
      while (text_.size() < kBlock && row_ < join_.rows()) add_row();
    }
    const std::size_t n = std::min(size, text_.size() - given_);
    std::memcpy(to, text_.data() + given_, n);
    given_ += n;
    return n;
  }

 private:
  void add_row() {
    char number[40];
    const std::int64_t t = join_.time_ns(row_);
    const auto magnitude = t < 0 ? 0 - static_cast<std::uint64_t>(t) : static_cast<std::uint64_t>(t);
    if (t < 0) text_ += '-';
    text_.append(number, std::to_chars(number, number + sizeof number, magnitude / 1000000000).ptr);
    char* end = std::to_chars(number, number + sizeof number, 1000000000 + magnitude % 1000000000).ptr;
    number[0] = '.';
    text_.append(number, end);
    join_.values(row_++, values_);
    for (const double v : values_) {
      text_ += ',';
      if (std::isfinite(v)) text_.append(number, std::to_chars(number, number + sizeof number, v).ptr);
    }
    text_ += '\n';
  }

  std::unique_ptr<Recording> recording_;
  Join join_;
  std::string text_;
  std::size_t given_ = 0, row_ = 0;
  std::vector<double> values_;
};

std::unique_ptr<Recording> empty_recording(const std::string& path, const Request& request) {
  return std::make_unique<Recording>(path, [request](const Channel& c) {
    if (request.all_topics || is_joint_state(c) || c.topic == request.topic) return true;
    return std::any_of(request.columns.begin(), request.columns.end(),
                       [&](const std::string& name) { return name.starts_with(c.topic + "/"); });
  });
}

Opened opened(std::unique_ptr<Recording> recording, const std::string& path, const Request& request) {
  Opened out;
  out.bag = true;
  out.notes = std::move(recording->notes);
  std::unique_ptr<BagText> text;
  try {
    text = std::make_unique<BagText>(std::move(recording), path, request);
  } catch (const core::DataError& e) {
    // What is missing may stand behind the place at which the file ends.
    if (out.notes.empty()) throw;
    throw core::DataError(std::string(e.what()) + " (" + out.notes.back() + ")");
  }
  out.joint_states = text->join().joint_states();
  for (const std::string& note : text->join().notes()) out.notes.push_back(note);
  out.text = std::move(text);
  return out;
}

Opened open_source(std::unique_ptr<Ahead> source, const std::string& path, bool readable,
                   const Request& request) {
  const std::string head(source->head(kHead));
  if (!is_bag(path, head, readable)) {
    Opened out;
    out.text = std::move(source);
    return out;
  }
  auto recording = empty_recording(path, request);
  read_bag_file(path, head, *source, *recording);
  return opened(std::move(recording), path, request);
}

}  // namespace

Opened open_log(const std::string& path, std::string_view what, const Request& request) {
  // Who gives the description of a bag means the bag.
  if (const std::filesystem::path given(path); given.filename() == "metadata.yaml")
    return open_log(given.has_parent_path() ? given.parent_path().string() : ".", what, request);
  struct stat status {};
  const bool there = ::stat(path.c_str(), &status) == 0;
  if (there && S_ISDIR(status.st_mode)) {
    auto recording = empty_recording(path, request);
    read_bag_directory(path, *recording);
    return opened(std::move(recording), path, request);
  }
  return open_source(std::make_unique<Ahead>(std::make_unique<core::FileSource>(path, what)), path,
                     there && S_ISREG(status.st_mode), request);
}

Opened open_log(core::ByteSource& source, const std::string& name, const Request& request) {
  return open_source(std::make_unique<Ahead>(std::string(), source), name, false, request);
}

}  // namespace furcula::bags
