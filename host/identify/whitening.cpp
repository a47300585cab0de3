#include "host/identify/whitening.hpp"

#include <algorithm>

namespace furcula::identify {

void Whitening::apply(double* values, std::size_t count, std::size_t columns) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> all(values, static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(columns));
  const auto reached = static_cast<Eigen::Index>(std::min(rows.size(), count));
  Eigen::Matrix<double, 3, Eigen::Dynamic> state =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, static_cast<Eigen::Index>(columns));
  for (Eigen::Index i = 0; i < reached; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    all.row(i) -= state.row(0);
    state.noalias() += row.gain * all.row(i);
    state = (row.step * state).eval();
    all.row(i) *= row.scale;
  }
  all.bottomRows(all.rows() - reached).setZero();
}

}  // namespace furcula::identify
