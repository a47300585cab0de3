// Topics of a bag joined on one clock: which columns there are, and the values of each row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/bags/bag_text.hpp"
#include "host/bags/recording.hpp"

namespace furcula::bags {

class Join {
 public:
  /// `recording` lives as long as this. @throws core::DataError
  Join(const Recording& recording, const std::string& path, const Request& request);

  const std::vector<std::string>& columns() const { return columns_; }  ///< without the time
  std::size_t rows() const { return last_row_ - first_row_; }
  /// Since the epoch, or since the start of a simulation.
  std::int64_t time_ns(std::size_t row) const { return streams_.front().time_ns[first_row_ + row]; }
  /// Rows in ascending order. NaN: not known. `to` has columns().size() values.
  void values(std::size_t row, std::vector<double>& to);

  bool joint_states() const { return joints_ != nullptr; }
  const std::vector<std::string>& notes() const { return notes_; }
  std::string clock() const;
  const std::string& row_topic() const { return streams_.front().topic->channel.topic; }

 private:
  struct Column {
    std::string name;
    std::size_t stream;  ///< of streams_
    std::size_t index;   ///< of the stream's names
    bool needed;         ///< rows without it at both ends are left out
    bool held = false;
  };
  /// Messages of which columns are made.
  struct Joined {
    const Topic* topic;
    const Stream* stream;
    bool needed = false, held = false, by_stamp = false;
    std::vector<std::int64_t> time_ns = {};
    std::vector<std::size_t> messages = {};   ///< in the order of time; of the rows' own empty
    std::vector<std::int64_t> order_ns = {};  ///< their times
    std::int64_t longest_ns = 0;              ///< between two messages that are interpolated
    std::size_t at = 0;                       ///< of the last row: messages before it
  };

  std::string contents() const;
  void choose_joints(const Request& request);
  void add_joint_columns();
  void add_wished(const Request& request);
  void add_others();
  void add(const Topic& topic, const Stream& stream, std::size_t index, std::string name, bool needed);
  void choose_rows(const Request& request);
  void set_clocks();
  void order(Joined& joined);
  void leave_out_short_ones();
  void trim();
  void drop_empty_columns();
  void say();
  bool known(const Joined& joined, std::int64_t time_ns) const;
  [[noreturn]] void fail(const std::string& what) const;

  const Recording& recording_;
  std::string path_;
  const Topic* joints_ = nullptr;
  std::vector<Joined> streams_;  ///< the first gives the rows
  std::vector<Column> columns_of_;
  std::vector<std::string> columns_;
  std::vector<std::string> notes_;
  std::size_t first_row_ = 0, last_row_ = 0;
};

}  // namespace furcula::bags
