// Frames of a walk for walk_script: a recording has no position, so that the stance foot is where the picture's robot has put it.
#include "host/floating/walk_picture.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host/biped/points.hpp"
#include "host/floating/predicted.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::floating {
namespace {

using dynamics::tree::Mat3;
using dynamics::tree::Vec3;
using Points = std::vector<Vec3<double>>;

constexpr double kLength_s = 10.0;
constexpr std::size_t kMostFrames = 500, kMarked = 3;

double cost(const Predicted& p) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < p.residual.size(); ++k) {
    const double e = p.residual[k] / noise_sd(static_cast<std::size_t>(k) % kRowSize);
    sum += e * e;
  }
  return sum;
}

/// Windows [first, last) of `errors`, of one recording and not longer than kLength_s.
struct Stretch {
  std::size_t first = 0, last = 0;
  double cost = -1.0;
};
Stretch worst_stretch(const std::vector<Recording>& recordings, const WindowErrors& errors) {
  Stretch best;
  for (std::size_t i = 0; i < errors.predicted.size(); ++i) {
    const Window& from = errors.predicted[i].window;
    const auto& rows = recordings[from.recording].rows;
    Stretch s{i, i, 0.0};
    for (; s.last < errors.predicted.size(); ++s.last) {
      const Window& w = errors.predicted[s.last].window;
      if (w.recording != from.recording ||
          rows[w.first + w.count - 1].time_s - rows[from.first].time_s > kLength_s)
        break;
      s.cost += cost(errors.predicted[s.last]);
    }
    if (s.cost > best.cost) best = s;
  }
  return best;
}

/// The stance foot's middle is at `at`, or a stand holds the pelvis; the first row's heading is along x.
class Placed {
 public:
  Placed(const Machine& model, const Row& first, bool held) : model_(model), held_(held) {
    const double yaw = walk::roll_pitch_yaw(first.attitude).yaw_rad;
    level_ = {{std::cos(yaw), std::sin(yaw), 0.0}, {-std::sin(yaw), std::cos(yaw), 0.0}, {0.0, 0.0, 1.0}};
    foot_ = first.contact[0] ? 0 : 1;
    at_ = {0.0, foot_ == 0 ? 0.1 : -0.1, 0.0};
  }
  Points points(const Row& row) const {
    const Mat3<double> r = rotation(row.attitude);
    const auto column = [&](double Vec3<double>::*k) {
      return level_ * Vec3<double>{r.x.*k, r.y.*k, r.z.*k};
    };
    const Vec3<double> x = column(&Vec3<double>::x), y = column(&Vec3<double>::y),
                       z = column(&Vec3<double>::z);
    Points p = biped::points_of(model_.robot, {0.0, 0.0, 0.0},
                                {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, row.angle_rad)
                   .all;
    const Vec3<double> move = held_ ? Vec3<double>{0.0, 0.0, 1.0} : at_ - middle(p, foot_);
    for (Vec3<double>& v : p) v += move;
    return p;
  }
  /// The next row is measured: the foot that carries is kept until it leaves the ground.
  void advance(const Row& row) {
    if (held_ || row.contact[foot_] || !row.contact[1 - foot_]) return;
    const Vec3<double> other = middle(points(row), 1 - foot_);
    foot_ = 1 - foot_;
    at_ = {other.x, other.y, 0.0};
  }

 private:
  static Vec3<double> middle(const Points& p, std::size_t side) {
    const std::size_t corner = biped::first_point(side) + biped::kFirstCorner;
    Vec3<double> sum{0.0, 0.0, 0.0};
    for (std::size_t k = corner; k < corner + 4; ++k) sum += p[k];
    return sum * 0.25;
  }
  const Machine& model_;
  const bool held_;
  Mat3<double> level_;
  std::size_t foot_;
  Vec3<double> at_;
};

nlohmann::json numbers(const Points& points, const Points* less) {
  nlohmann::json out = nlohmann::json::array();
  const auto rounded = [](double v) { return std::round(v * 1e4) / 1e4; };
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3<double> v = less == nullptr ? points[k] : points[k] - (*less)[k];
    out.push_back({rounded(v.x), rounded(v.y), rounded(v.z)});
  }
  return out;
}

/// [point, "left knee 1.2 mrad"] of the joints with the largest errors.
nlohmann::json marked(const WindowErrors& errors) {
  nlohmann::json out = nlohmann::json::array();
  for (const std::size_t channel : worst_first(errors))
    if (channel < kJoints && out.size() < kMarked)
      out.push_back({biped::point_of_joint(channel),
                     channel_name(channel) + " " + report::number(1e3 * errors.channels[channel]) + " mrad"});
  return out;
}

}  // namespace

std::vector<std::size_t> worst_first(const WindowErrors& errors) {
  std::vector<std::size_t> out(kRowSize);
  std::iota(out.begin(), out.end(), std::size_t{0});
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    return errors.channels[a] / noise_sd(a) > errors.channels[b] / noise_sd(b);
  });
  return out;
}

WalkPicture walk_picture(const Machine& model, const std::vector<Recording>& recordings,
                         const WindowErrors& given, const WindowErrors& identified) {
  if (identified.predicted.empty()) return {};
  const Stretch stretch = worst_stretch(recordings, identified);
  const Window &begin = identified.predicted[stretch.first].window,
               &end = identified.predicted[stretch.last - 1].window;
  const Recording& recording = recordings[begin.recording];
  const std::size_t rows = end.first + end.count - begin.first, stride = 1 + rows / kMostFrames;
  // Shown at first: the last row of the window with the largest error.
  const auto worst =
      std::max_element(identified.predicted.begin() + static_cast<std::ptrdiff_t>(stretch.first),
                       identified.predicted.begin() + static_cast<std::ptrdiff_t>(stretch.last),
                       [](const Predicted& a, const Predicted& b) { return cost(a) < cost(b); });
  const auto time_at = [&](std::size_t row) {
    return std::round(1e4 * (recording.rows[row].time_s - recording.rows.front().time_s)) / 1e4;
  };
  nlohmann::json frames = nlohmann::json::array();
  Placed placed(model, recording.rows[begin.first], recording.held);
  std::size_t w = stretch.first, read = stretch.last;
  std::vector<Row> by_given, by_identified;
  for (std::size_t k = 0; k < rows; ++k) {
    const Row& row = recording.rows[begin.first + k];
    placed.advance(row);
    while (w + 1 < stretch.last &&
           begin.first + k > identified.predicted[w].window.first + identified.predicted[w].window.count - 1)
      ++w;
    if (k % stride != 0) continue;
    const Window& window = identified.predicted[w].window;
    const std::size_t in_window = begin.first + k - window.first;
    const bool predicted = begin.first + k > window.first && in_window < window.count;
    const Points measured = placed.points(row);
    nlohmann::json frame{{"time", time_at(begin.first + k)},
                         {"points", numbers(measured, nullptr)},
                         {"force", {0, 0, 0, 0, 0, 0}},
                         {"phase", "between windows"}};
    if (predicted) {
      if (read != w) {
        by_given = predicted_rows(recording, given.predicted[w]);
        by_identified = predicted_rows(recording, identified.predicted[w]);
        read = w;
      }
      frame["phase"] = "window " + std::to_string(w - stretch.first + 1);
      frame["off"] = {numbers(placed.points(by_given[in_window - 1]), &measured),
                      numbers(placed.points(by_identified[in_window - 1]), &measured)};
    }
    frames.push_back(std::move(frame));
  }
  const nlohmann::json data{{"passive", false},
                            {"start", time_at(worst->window.first + worst->window.count - 1)},
                            {"models", {"as given", "identified"}},
                            {"marked", marked(identified)},
                            {"frames", std::move(frames)}};
  return {
      "<div class=\"legend\"><span class=\"key recorded-key\">measured</span>"
      "<span class=\"key given-key\">predicted, as given</span>"
      "<span class=\"key simulated-key\">predicted, identified</span>"
      "<span class=\"key before-key\">joints with the largest remaining errors</span></div>\n" +
          report::biped_player_html("The biped as it walks, measured and predicted") +
          "<div class=\"player\"><label>Differences drawn <select id=\"walk-scale\"><option value=\"1\">as they "
          "are</option><option value=\"5\">5 times as large</option><option value=\"10\" selected>10 times as "
          "large</option><option value=\"30\">30 times as large</option></select></label></div>\n" +
          report::paragraph(
              "Recording " + recording.file +
              ". In each window the models start at its beginning and run with the logged targets; their "
              "differences to the measured robot are drawn enlarged. Between windows, at landings, there is no "
              "prediction. A recording has no position of the base: the stance foot is drawn where it has been "
              "put, with the lengths of the model as given. Drag turns the view, the wheel comes nearer."),
      data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace furcula::floating
