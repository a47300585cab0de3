#include "host/gait/path_pieces.hpp"

namespace furcula::gait {

void PathPieces::add(const JointPath& path, double from) {
  const std::size_t n = path.spline().intervals();
  for (std::size_t i = 0; i < n; ++i) {
    const double begin = path.duration_s * static_cast<double>(i) / static_cast<double>(n);
    const double end = path.duration_s * static_cast<double>(i + 1) / static_cast<double>(n);
    if (from + end <= 0.0) continue;
    Piece piece;
    piece.begin_s = from + begin;
    piece.end_s = from + end;
    double factorial = 1.0;
    for (std::size_t d = 0; d < Spline::kOrder; ++d) {
      if (d > 0) factorial *= static_cast<double>(d);
      const Joints2<double> v = path.derivative(begin, d, i);
      piece.hip[0][d] = v.hip / factorial;
      piece.knee[0][d] = v.knee / factorial;
    }
    for (std::size_t k = 1; k < piece.hip.size(); ++k)
      for (std::size_t d = 0; d + 1 < Spline::kOrder; ++d) {
        piece.hip[k][d] = static_cast<double>(d + 1) * piece.hip[k - 1][d + 1];
        piece.knee[k][d] = static_cast<double>(d + 1) * piece.knee[k - 1][d + 1];
      }
    pieces_.push_back(piece);
  }
}

}  // namespace furcula::gait
