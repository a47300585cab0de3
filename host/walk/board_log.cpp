#include "host/walk/board_log.hpp"

#include "host/walk/board_row.hpp"

namespace furcula::walk {

void put_row(log::Log& log, double time_s, const control::WalkerSample& sample,
             const control::WalkerState& board, const control::WalkerOutputs& told) {
  static const std::vector<std::string> names = board_columns();
  const BoardRow row = board_row(time_s, sample, board, told);
  for (std::size_t i = 0; i < row.size(); ++i) log.columns[names[i]].push_back(row[i]);
}

}  // namespace furcula::walk
