#include "boards/linux_sbc/walk_recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace furcula::linux_sbc {
namespace {

namespace fs = std::filesystem;

constexpr double kTick_s = 1e-3;
constexpr long kPauseNs = 50'000'000;
constexpr std::size_t kNumberBytes = 32;

bool logs(control::WalkerStage stage) {
  return stage == control::WalkerStage::walking || stage == control::WalkerStage::exercising;
}

bool write_text(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t wrote = ::write(file, text.data(), text.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(wrote));
  }
  return true;
}

}  // namespace

WalkRecorder::WalkRecorder(std::string folder, int rate_hz, std::function<void(const std::string&)> say)
    : folder_(std::move(folder)), say_(std::move(say)), ticks_a_row_(1000u / static_cast<unsigned>(rate_hz)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || ::access(folder_.c_str(), W_OK) != 0)
    throw std::runtime_error("[log] folder " + folder_ + ": " +
                             (error ? error.message() : std::strerror(errno)) +
                             "; expected a folder to write walks to");
}

void WalkRecorder::note(const control::WalkerState& walker, const control::WalkerOutputs& told) {
  if (logs(told.stage) && !logs(stage_)) ++walk_, tick_ = 0;
  if (!logs(told.stage) && logs(stage_)) ended_.store(walk_, std::memory_order_release);
  stage_ = told.stage;
  if (!logs(stage_) || tick_++ % ticks_a_row_ != 0) return;
  const std::uint64_t put = put_.load(std::memory_order_relaxed);
  if (put - taken_.load(std::memory_order_acquire) == kRows) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  Row& row = rows_[put % kRows];
  row.walk = walk_;
  row.values = walk::board_row(kTick_s * static_cast<double>(tick_ - 1), walker.last, walker, told);
  put_.store(put + 1, std::memory_order_release);
}

void WalkRecorder::serve() {
  for (;;) {
    const bool last = stop_.load(std::memory_order_acquire);
    write_all();
    if (last) break;
    const timespec pause{0, kPauseNs};
    ::nanosleep(&pause, nullptr);
  }
  if (open_ != 0) end();
}

void WalkRecorder::write_all() {
  // A walk that has ended has put all of its rows.
  const std::uint32_t ended = ended_.load(std::memory_order_acquire);
  const std::uint64_t put = put_.load(std::memory_order_acquire);
  for (std::uint64_t taken = taken_.load(std::memory_order_relaxed); taken != put; ++taken) {
    const Row& row = rows_[taken % kRows];
    if (row.walk != open_) {
      if (open_ != 0) end();
      begin(row.walk);
    }
    write(row);
    taken_.store(taken + 1, std::memory_order_release);
  }
  if (open_ != 0 && open_ <= ended) end();
  if (const std::uint32_t lost = lost_.load(std::memory_order_relaxed); lost != told_lost_) {
    say_("the disk is too slow: " + std::to_string(lost - told_lost_) + " rows of a log are missing");
    told_lost_ = lost;
  }
}

void WalkRecorder::begin(std::uint32_t walk) {
  open_ = walk;
  failed_ = false;
  do path_ = folder_ + "/walk_" + std::to_string(next_++) + ".csv";
  while (fs::exists(path_));
  part_ = path_ + ".part";
  file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  std::string header = "# format: furcula-log/1\n# machine_type: tree\n";
  for (const std::string& column : walk::board_columns())
    header += (header.back() == '\n' ? "" : ",") + column;
  header += '\n';
  if (file_ < 0 || !write_text(file_, header)) fail("cannot be written");
}

void WalkRecorder::write(const Row& row) {
  if (failed_) return;
  std::array<char, walk::kBoardColumns * kNumberBytes> text;
  char* at = text.data();
  for (const double value : row.values) {
    if (at != text.data()) *at++ = ',';
    at = std::to_chars(at, at + kNumberBytes - 2, static_cast<float>(value)).ptr;
  }
  *at++ = '\n';
  if (!write_text(file_, {text.data(), static_cast<std::size_t>(at - text.data())}))
    fail("cannot be written");
}

void WalkRecorder::end() {
  open_ = 0;
  const bool whole = !failed_ && ::fsync(file_) == 0;
  if (file_ >= 0 && ::close(file_) != 0 && !failed_) fail("cannot be closed");
  file_ = -1;
  if (!whole || failed_) return;
  if (::rename(part_.c_str(), path_.c_str()) != 0) return fail("cannot be renamed");
  say_(path_ + " has the walk");
}

void WalkRecorder::fail(const std::string& what) {
  if (!failed_) say_(part_ + " " + what + ": " + std::strerror(errno) + "; this walk is not logged");
  failed_ = true;
}

}  // namespace furcula::linux_sbc
