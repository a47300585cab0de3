// Rows of a picture in units of the priors' standard deviations, one SVG for each kind of number.
#include "host/floating/parameter_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "host/report/html.hpp"
#include "host/report/page.hpp"

namespace furcula::floating {
namespace {

using report::escape;
using report::number;

/// Kinds that are one group differ by what follows.
constexpr std::string_view kGroups[][2] = {{"centre", "Centre of mass"},
                                           {"inertia", "Moments of inertia"},
                                           {"position", "Position of the joint"},
                                           {"attitude", "Orientation of the joint's axis"},
                                           {"gain_kp", "Position gain kp"},
                                           {"gain_kd", "Velocity gain kd"},
                                           {"contact_friction", "Friction of the ground"},
                                           {"slope", "Slope of the ground"},
                                           {"imu_mounting", "Mounting of the IMU"},
                                           {"gyro_bias", "Bias of the gyro"},
                                           {"sole", "Corners of the soles"}};

struct Row {
  std::string label;
  std::size_t index;
  double theta, sd;
};
struct Group {
  std::string title;
  std::vector<Row> rows;
};

std::string in_lower_words(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// The group's title, and what the number is called in it.
std::pair<std::string, std::string> place_of(const Unknown& u) {
  if (u.location == "simulator")
    return {"Contact and dry friction of the simulation", in_lower_words(u.kind)};
  for (const auto& [prefix, title] : kGroups)
    if (u.kind.starts_with(prefix)) {
      const std::string part = in_lower_words(u.kind.substr(std::min(u.kind.size(), prefix.size() + 1)));
      return {std::string(title), in_lower_words(u.location) + (part.empty() ? "" : ", " + part)};
    }
  return {report::in_words(u.kind), in_lower_words(u.location)};
}

/// Groups and their rows by the smallest posterior deviation.
std::vector<Group> groups_of(const Identified& found, bool narrow) {
  std::vector<Group> out;
  for (std::size_t i = 0; i < found.unknowns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if ((found.sd[k] < kNarrowed) != narrow) continue;
    const std::pair<std::string, std::string> place = place_of(found.unknowns[i]);
    auto at = std::find_if(out.begin(), out.end(), [&](const Group& g) { return g.title == place.first; });
    if (at == out.end()) at = out.insert(out.end(), {place.first, {}});
    at->rows.push_back({place.second, i, found.theta[k], found.sd[k]});
  }
  const auto less = [](const Row& a, const Row& b) { return a.sd < b.sd; };
  for (Group& g : out) std::stable_sort(g.rows.begin(), g.rows.end(), less);
  std::stable_sort(out.begin(), out.end(),
                   [&](const Group& a, const Group& b) { return less(a.rows.front(), b.rows.front()); });
  return out;
}

constexpr double kWidth = 330.0, kLabels = 158.0, kRow = 17.0, kFoot = 18.0;

/// The axis' end: what is farther out is drawn at it.
double most_of(const Identified& found) {
  return std::clamp((found.theta.cwiseAbs() + found.sd).maxCoeff(), 1.2, 2.4);
}

double across(double theta, double most) {
  const double half = 0.5 * (kWidth - kLabels - 8.0);
  return kLabels + half + half / most * std::clamp(theta, -most, most);
}

std::string bar(const char* of, double from, double to, double top, double height) {
  return "<rect class=\"" + std::string(of) + "\" x=\"" + number(from, 5) + "\" width=\"" +
         number(std::max(1.0, to - from), 5) + "\" y=\"" + number(top, 5) + "\" height=\"" +
         number(height, 3) + "\"/>";
}

std::string svg(const Identified& found, const Group& group) {
  const double most = most_of(found);
  const auto x = [most](double theta) { return number(across(theta, most), 5); };
  const double height = kRow * static_cast<double>(group.rows.size()) + kFoot, foot = height - kFoot;
  std::string out = "<svg viewBox=\"0 0 330 " + number(height, 5) + "\" role=\"img\" aria-label=\"" +
                    escape(group.title) + ": prior and posterior\">\n";
  for (int tick = -static_cast<int>(most); tick <= static_cast<int>(most); ++tick)
    out += "<line class=\"" + std::string(tick == 0 ? "zero" : "grid") + "\" x1=\"" + x(tick) + "\" x2=\"" +
           x(tick) + "\" y1=\"0\" y2=\"" + number(foot, 5) + "\"/><text x=\"" + x(tick) + "\" y=\"" +
           number(height - 5.0, 5) + "\" text-anchor=\"middle\">" + std::to_string(tick) + "</text>";
  double top = 0.0;
  for (const Row& r : group.rows) {
    const Unknown& u = found.unknowns[r.index];
    const std::string unit = u.unit.empty() ? "" : " " + u.unit;
    out += "\n<g><title>" + escape(u.name()) + ": given " + number(u.value(found.given), 4) + escape(unit) +
           ", identified " + number(u.value(found.machine), 4) + escape(unit) + "; standard deviation " +
           number(u.prior_sd) + " before, " + number(r.sd * u.prior_sd) + escape(unit) +
           " after</title><text x=\"" + number(kLabels - 8.0, 5) + "\" y=\"" + number(top + 12.5, 5) +
           "\" text-anchor=\"end\">" + escape(r.label) + "</text>" +
           bar("prior", across(-1.0, most), across(1.0, most), top + 2.0, 13.0) +
           bar(r.sd < kNarrowed ? "posterior narrow" : "posterior", across(r.theta - r.sd, most),
               across(r.theta + r.sd, most), top + 5.0, 7.0) +
           "<circle cx=\"" + x(r.theta) + "\" cy=\"" + number(top + 8.5, 5) + "\" r=\"3\"/></g>";
    top += kRow;
  }
  return out + "\n</svg>\n";
}

std::string pictures(const Identified& found, const std::vector<Group>& groups) {
  std::string out = "<div class=\"priors\">\n";
  for (const Group& g : groups)
    out += "<figure><h4>" + escape(g.title) + "</h4>" + svg(found, g) + "</figure>\n";
  return out + "</div>\n";
}

std::string table(const Identified& found) {
  report::Table table({{"Number"},
                       {"As given", true},
                       {"Identified", true},
                       {"Prior standard deviation", true},
                       {"Posterior standard deviation", true},
                       {"Unit"}});
  for (std::size_t i = 0; i < found.unknowns.size(); ++i) {
    const Unknown& u = found.unknowns[i];
    const double sd = found.sd[static_cast<Eigen::Index>(i)];
    table.add({"<code>" + escape(u.name()) + "</code>", number(u.value(found.given), 4),
               number(u.value(found.machine), 4), number(u.prior_sd), number(sd * u.prior_sd),
               u.location == "simulator" ? "of the logarithm" : escape(u.unit)});
  }
  return table.html();
}

}  // namespace

std::size_t narrowed(const Identified& found) {
  return static_cast<std::size_t>((found.sd.array() < kNarrowed).count());
}

std::string parameters_html(const Identified& found) {
  const std::size_t told = narrowed(found), all = found.unknowns.size();
  std::string out =
      "<div class=\"aside\"><p>A single number is no finding. Its prior draws each number to the model, and other numbers "
      "take up a part of its deviation. What the model lacks, the real ground too, is spread over all numbers; the posterior "
      "standard deviations do not contain it. Judge the model by its errors on held-out windows.</p></div>\n";
  out += report::paragraph(
      "The recordings narrow " + std::to_string(told) + " of " + std::to_string(all) +
      " numbers to less than half of their prior's standard deviation. Axes: difference to the prior's mean in "
      "prior standard deviations. The prior's mean is the model as given; of contact and dry friction of the simulation, what is "
      "chosen before the fit. A blue bar much shorter than the light one: the recordings determine the number "
      "well. As long as the light one: they tell nothing of it. What lies farther out than the axis is drawn at its end.");
  out +=
      "<div class=\"legend\"><span class=\"key prior-key\">prior, &plusmn;1 standard deviation</span>"
      "<span class=\"key after-key\">posterior, &plusmn;1 standard deviation</span>"
      "<span class=\"key dot\">posterior mode</span></div>\n";
  if (told > 0) out += pictures(found, groups_of(found, true));
  if (told < all)
    out += "<details><summary>" + std::to_string(all - told) +
           " numbers that keep more than half of their prior's standard deviation</summary>\n" +
           pictures(found, groups_of(found, false)) + "</details>\n";
  return out + "<details><summary>All numbers as a table</summary>\n" + table(found) + "</details>\n";
}

}  // namespace furcula::floating
