// Names of joints, see joint_names.hpp.
#include "host/trees/joint_names.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace furcula::trees {
namespace {

using Words = std::vector<std::string>;

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Where in a name a word begins: after a separator, at a capital ("leftHip", "LHip"), at digits and after them.
bool begins_word(const std::string& name, std::size_t i) {
  const char before = name[i - 1], c = name[i];
  if (is_digit(before) != is_digit(c)) return true;
  if (is_lower(before) && is_upper(c)) return true;
  return is_upper(before) && is_upper(c) && i + 1 < name.size() && is_lower(name[i + 1]);
}

/// Without the words that only say that it is a joint, if any other is left.
Words telling(const Words& words) {
  static const std::set<std::string> kSaysJoint{"joint", "jnt", "j", "q", "axis"};
  Words out;
  for (const std::string& w : words)
    if (!kSaysJoint.contains(w)) out.push_back(w);
  return out.empty() ? words : out;
}
bool is_side(const std::string& word) {
  return word == "left" || word == "right" || word == "front" || word == "rear";
}
bool is_end_of(const Words& part, const Words& whole) {
  return part.size() < whole.size() && std::equal(part.rbegin(), part.rend(), whole.rbegin());
}
/// "sh" of "shoulder". A number stands for itself alone: 1 is no 10.
bool begins(const std::string& a, const std::string& b) {
  if (is_digit(a.front()) || is_digit(b.front())) return a == b;
  return a.starts_with(b) || b.starts_with(a);
}
/// "shldr" of "shoulder": the same first letter, and all letters of one in their order in the other.
bool is_drawn_from(const std::string& a, const std::string& b) {
  if (is_digit(a.front()) || is_digit(b.front())) return a == b;
  if (a.front() != b.front()) return false;
  const std::string &less = a.size() < b.size() ? a : b, &more = a.size() < b.size() ? b : a;
  std::size_t at = 0;
  for (const char c : more)
    if (at < less.size() && less[at] == c) ++at;
  return at == less.size();
}
double letters_in_common(const std::string& a, const std::string& b) {
  if (is_digit(a.front()) || is_digit(b.front())) return a == b ? 1.0 : 0.0;
  const std::string &less = a.size() < b.size() ? a : b, &more = a.size() < b.size() ? b : a;
  const auto common = is_drawn_from(a, b)
                          ? static_cast<std::ptrdiff_t>(less.size())
                          : std::mismatch(less.begin(), less.end(), more.begin()).first - less.begin();
  return static_cast<double>(common) / static_cast<double>(more.size());
}

}  // namespace

std::vector<std::string> words_of(const std::string& name) {
  // What robots' names abbreviate; of legs the second letter is the side.
  static const std::map<std::string, Words> kMeans{
      {"l", {"left"}},           {"lft", {"left"}},          {"r", {"right"}},
      {"rgt", {"right"}},        {"fl", {"front", "left"}},  {"fr", {"front", "right"}},
      {"lf", {"front", "left"}}, {"rf", {"front", "right"}}, {"rl", {"rear", "left"}},
      {"rr", {"rear", "right"}}, {"hl", {"rear", "left"}},   {"hr", {"rear", "right"}},
      {"lh", {"rear", "left"}},  {"rh", {"rear", "right"}},  {"lr", {"rear", "left"}},
      {"bl", {"rear", "left"}},  {"br", {"rear", "right"}},  {"hind", {"rear"}},
      {"back", {"rear"}},        {"fore", {"front"}}};
  Words out;
  std::string word;
  const auto end = [&] {
    if (word.empty()) return;
    const auto means = kMeans.find(word);
    if (means == kMeans.end())
      out.push_back(word);
    else
      out.insert(out.end(), means->second.begin(), means->second.end());
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0;
    if (!letter || (i > 0 && begins_word(name, i))) end();
    if (!letter) continue;
    // "007" is 7.
    if (word == "0" && is_digit(c)) word.clear();
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  end();
  return out;
}

JointName::JointName(std::string name)
    : name_(std::move(name)), words_(words_of(name_)), telling_(telling(words_)), sorted_(telling_) {
  std::sort(sorted_.begin(), sorted_.end());
  for (const std::string& w : telling_) {
    (is_side(w) ? sides_ : bare_).push_back(w);
    // Two numbers side by side are not one.
    if (!joined_.empty() && is_digit(joined_.back()) && is_digit(w.front())) joined_ += ' ';
    joined_ += w;
  }
  std::sort(sides_.begin(), sides_.end());
}

bool Likeness::alike(std::size_t way, const JointName& a, const JointName& b) {
  switch (way) {
    case 0:
      return a.words_ == b.words_;
    case 1:
      return a.joined_ == b.joined_;
    case 2:
      return a.sorted_ == b.sorted_;
    case 3:
    case 5:
      return !a.bare_.empty() && a.sides_ == b.sides_ &&
             std::equal(a.bare_.begin(), a.bare_.end(), b.bare_.begin(), b.bare_.end(),
                        way == 3 ? begins : is_drawn_from);
    default:
      return is_end_of(a.telling_, b.telling_) || is_end_of(b.telling_, a.telling_);
  }
}

std::vector<std::string> Likeness::further_sides(const JointName& a, const JointName& b) {
  const Words &more = a.sides_.size() < b.sides_.size() ? b.sides_ : a.sides_,
              &less = a.sides_.size() < b.sides_.size() ? a.sides_ : b.sides_;
  Words out;
  std::set_difference(more.begin(), more.end(), less.begin(), less.end(), std::back_inserter(out));
  return out;
}

double similarity(const JointName& a, const JointName& b) {
  // Each word goes with one of the other name, the most alike first.
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  constexpr std::size_t kMostWords = 12;  // of longer names the end tells nothing
  const std::size_t n = std::min(kMostWords, a.telling_.size()), m = std::min(kMostWords, b.telling_.size());
  if (n + m == 0) return 0.0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < m; ++k)
      if (const double common = letters_in_common(a.telling_[i], b.telling_[k]); common > 0.0)
        pairs.emplace_back(-common, i, k);
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> of_a(n), of_b(m);
  double sum = 0.0;
  for (const auto& [common, i, k] : pairs) {
    if (of_a[i] || of_b[k]) continue;
    of_a[i] = of_b[k] = true;
    sum -= common;
  }
  return 2.0 * sum / static_cast<double>(n + m);
}

std::vector<std::optional<std::size_t>> best_assignment(const std::vector<std::vector<double>>& weights) {
  // The Hungarian method by shortest augmenting paths (Kuhn, Munkres), on costs -weight. Boost's maximum_weighted_matching does not end on some graphs (boostorg/graph, issues 223 and 399).
  // Each row has a column of its own beyond the others, of weight 0.
  // Rows and columns count from 1; column 0 is where a row begins.
  const std::size_t rows = weights.size();
  std::vector<std::optional<std::size_t>> out(rows);
  if (rows == 0) return out;
  const std::size_t given = weights.front().size(), columns = given + rows;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const auto cost = [&](std::size_t row, std::size_t column) {
    return column <= given ? -weights[row - 1][column - 1] : 0.0;
  };
  std::vector<double> of_row(rows + 1), of_column(columns + 1);
  std::vector<std::size_t> row_of(columns + 1), before(columns + 1);
  for (std::size_t row = 1; row <= rows; ++row) {
    row_of[0] = row;
    std::size_t at = 0;
    std::vector<double> least(columns + 1, kFar);
    std::vector<bool> seen(columns + 1);
    do {
      seen[at] = true;
      const std::size_t from = row_of[at];
      std::size_t next = 0;
      double step = kFar;
      for (std::size_t c = 1; c <= columns; ++c) {
        if (seen[c]) continue;
        const double reduced = cost(from, c) - of_row[from] - of_column[c];
        if (reduced < least[c]) {
          least[c] = reduced;
          before[c] = at;
        }
        if (least[c] < step) {
          step = least[c];
          next = c;
        }
      }
      for (std::size_t c = 0; c <= columns; ++c) {
        if (seen[c]) {
          of_row[row_of[c]] += step;
          of_column[c] -= step;
        } else {
          least[c] -= step;
        }
      }
      at = next;
    } while (row_of[at] != 0);
    for (; at != 0; at = before[at]) row_of[at] = row_of[before[at]];
  }
  for (std::size_t c = 1; c <= given; ++c)
    if (row_of[c] != 0 && weights[row_of[c] - 1][c - 1] > 0.0) out[row_of[c] - 1] = c - 1;
  return out;
}

}  // namespace furcula::trees
