// Joined topics, see join.hpp.
#include "host/bags/join.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <span>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

using core::printable;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMillisecond = 1000000;
// Between the clock of the stamps and the one of the recorder: beyond it they are two clocks, not a delay. It is the longest pause that a
// window of a log may hold.
constexpr std::int64_t kOtherClock = 50 * kMillisecond;
constexpr std::size_t kMostColumns = 2000;

const Stream* largest(const Topic& topic) {
  const Stream* best = nullptr;
  for (const Stream& s : topic.streams)
    if (best == nullptr || s.messages() > best->messages()) best = &s;
  return best;
}

/// No signals: how an array is laid out, and how certain a driver says it is.
bool is_about_others(const std::string& name) {
  return name.starts_with("layout/") || name.find("covariance[") != name.npos;
}

/// Of a header, which is the clock.
bool is_stamp(const std::string& name) {
  return name.starts_with("header/stamp/") || name.starts_with("stamp/");
}

/// Whether its messages say what to do, by the topic's name: they act until the next one.
bool is_command(const Channel& channel) {
  std::string name = channel.topic;
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string_view word :
       {"command", "cmd", "reference", "setpoint", "set_point", "target", "desired"})
    if (name.find(word) != name.npos) return true;
  return short_type(channel.type) == "std_msgs/Float64MultiArray";
}

std::string counted(std::uint64_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::int64_t median(std::vector<std::int64_t> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string seconds(std::int64_t ns) { return core::rounded(1e-9 * static_cast<double>(ns)) + " s"; }

}  // namespace

Join::Join(const Recording& recording, const std::string& path, const Request& request)
    : recording_(recording), path_(path) {
  choose_joints(request);
  if (joints_ != nullptr) add_joint_columns();
  add_wished(request);
  if (request.all_topics) add_others();
  if (streams_.empty() || (request.joints_alone && joints_ == nullptr && request.columns.empty())) {
    for (const Topic& t : recording.topics)
      if (t.joint_states && t.unread != 0)
        fail("no message of " + core::quoted(t.channel.topic) + " can be read, of " + t.first_unread);
    fail(
        "no joint states; expected a topic of the type sensor_msgs/msg/JointState, or a map (--map) that names columns "
        "of others, as in angle_elbow_rad = { column = \"/topic/path\" }. " +
        contents());
  }
  choose_rows(request);
  set_clocks();
  drop_empty_columns();
  leave_out_short_ones();
  trim();
  say();
  for (const Column& c : columns_of_) columns_.push_back(c.name);
}

void Join::fail(const std::string& what) const { throw core::DataError(path_ + ": " + what); }

/// What is in the bag, for messages.
std::string Join::contents() const {
  if (recording_.topics.empty()) return "It has no topics";
  constexpr std::size_t kTopics = 30, kNames = 8;
  std::string out = "It has ";
  for (std::size_t i = 0; i < std::min(kTopics, recording_.topics.size()); ++i) {
    const Topic& t = recording_.topics[i];
    out += (i == 0 ? "" : "; ") + t.channel.topic + " (" +
           (t.channel.type.empty() ? t.channel.message_encoding : t.channel.type) + ", " +
           counted(t.messages, "message", "messages") + ")";
    if (!t.trouble.empty()) {
      out += ": not read, " + t.trouble;
      continue;
    }
    const Stream* stream = largest(t);
    const std::vector<std::string>& names = stream != nullptr ? stream->names : t.first_names;
    std::size_t shown = 0;
    for (const std::string& n : names) {
      if (is_stamp(n) || is_about_others(n)) continue;
      if (shown == kNames) {
        out += ", ...";
        break;
      }
      out += (shown++ == 0 ? ": " : ", ") + n;
    }
  }
  if (recording_.topics.size() > kTopics) out += "; ...";
  return printable(out);
}

void Join::choose_joints(const Request& request) {
  std::vector<const Topic*> with;
  std::vector<std::string_view> names;
  const Topic* chosen = nullptr;
  for (const Topic& t : recording_.topics) {
    names.push_back(t.channel.topic);
    if (t.joint_states && !t.streams.empty()) with.push_back(&t);
    if (t.channel.topic == request.topic && (chosen == nullptr || t.messages > chosen->messages)) chosen = &t;
  }
  if (!request.topic.empty()) {
    if (chosen == nullptr)
      fail("no topic " + core::quoted(request.topic) + core::did_you_mean(request.topic, names) + ". " +
           contents());
    if (!chosen->trouble.empty())
      fail("the topic " + core::quoted(request.topic) + " cannot be read: " + chosen->trouble);
    if (chosen->streams.empty())
      fail("the topic " + core::quoted(request.topic) + " has no message that can be read" +
           (chosen->first_unread.empty() ? "" : ", of " + chosen->first_unread) + ". " + contents());
    if (chosen->joint_states) {
      joints_ = chosen;
      return;
    }
  }
  // Commands in the form of joint states, beside what was measured.
  const auto measured =
      std::stable_partition(with.begin(), with.end(), [](const Topic* t) { return !is_command(t->channel); });
  if (measured != with.begin()) with.erase(measured, with.end());
  if (with.size() == 1) joints_ = with.front();
  if (with.size() < 2) return;
  // A map that names topics needs no choice.
  const bool by_topic =
      !request.columns.empty() &&
      std::all_of(request.columns.begin(), request.columns.end(), [&](const std::string& c) {
        return std::any_of(names.begin(), names.end(),
                           [&](std::string_view t) { return c.starts_with(std::string(t) + "/"); });
      });
  if (by_topic) return;
  std::string list;
  for (const Topic* t : with) {
    list +=
        (list.empty() ? "" : ", ") + t->channel.topic + " (" + counted(t->messages, "message", "messages");
    const std::vector<std::string>& joints = largest(*t)->joints;
    for (std::size_t i = 0; i < std::min<std::size_t>(joints.size(), 4); ++i)
      list += (i == 0 ? ": " : ", ") + joints[i];
    list += joints.size() > 4 ? ", ...)" : ")";
  }
  fail(printable(std::to_string(with.size()) + " topics of joint states: " + list) +
       "; expected one robot: choose its topic with furcula convert --topic " +
       printable(with.front()->channel.topic) + ", or with the line topic = \"" +
       printable(with.front()->channel.topic) + "\" in a map (--map)");
}

void Join::add(const Topic& topic, const Stream& stream, std::size_t index, std::string name, bool needed) {
  for (Column& c : columns_of_)
    if (c.name == name) {
      c.needed = c.needed || needed;
      return;
    }
  if (columns_of_.size() >= kMostColumns)
    fail("more than " + std::to_string(kMostColumns) +
         " columns; expected fewer: name those that are needed in a map "
         "(--map)");
  std::size_t at = 0;
  while (at < streams_.size() && streams_[at].stream != &stream) ++at;
  if (at == streams_.size()) streams_.push_back({&topic, &stream});
  streams_[at].needed = streams_[at].needed || needed;
  columns_of_.push_back({std::move(name), at, index, needed});
}

/// Of several messages with other joints each, as of an arm and its gripper, all; of those that have a joint again the ones with most messages.
void Join::add_joint_columns() {
  std::vector<const Stream*> streams;
  for (const Stream& s : joints_->streams) streams.push_back(&s);
  std::stable_sort(streams.begin(), streams.end(),
                   [](const Stream* a, const Stream* b) { return a->messages() > b->messages(); });
  std::vector<std::string> taken;
  std::uint64_t excluded = 0;
  for (const Stream* s : streams) {
    if (std::any_of(s->joints.begin(), s->joints.end(), [&](const std::string& j) {
          return std::find(taken.begin(), taken.end(), j) != taken.end();
        })) {
      excluded += s->messages();
      continue;
    }
    taken.insert(taken.end(), s->joints.begin(), s->joints.end());
    for (std::size_t j = 0; j < s->joints.size(); ++j) {
      const std::string& joint = s->joints[j];
      add(*joints_, *s, kOfJoint * j, "angle_" + joint + "_rad", true);
      add(*joints_, *s, kOfJoint * j + 1, "velocity_" + joint + "_radps", false);
      add(*joints_, *s, kOfJoint * j + 2, "torque_" + joint + "_nm", false);
    }
  }
  if (excluded != 0)
    notes_.push_back(printable(path_ + ": " + counted(excluded, "message", "messages") + " of " +
                               joints_->channel.topic + " with some of the joints of others were left out."));
}

void Join::add_wished(const Request& request) {
  std::vector<std::string_view> all;
  std::vector<std::string> names;
  for (const std::string& wanted : request.columns) {
    if (wanted == "time_s") continue;
    if (const auto direct = std::find_if(columns_of_.begin(), columns_of_.end(),
                                         [&](const Column& c) { return c.name == wanted; });
        direct != columns_of_.end()) {
      direct->needed = true;
      continue;
    }
    const Stream* found = nullptr;
    const Topic* of = nullptr;
    std::size_t index = 0;
    for (const Topic& t : recording_.topics) {
      if (!wanted.starts_with(t.channel.topic + "/")) continue;
      const std::string path = wanted.substr(t.channel.topic.size() + 1);
      for (const Stream& s : t.streams) {
        const auto name = std::find(s.names.begin(), s.names.end(), path);
        if (name == s.names.end() || (found != nullptr && found->messages() >= s.messages())) continue;
        found = &s;
        of = &t;
        index = static_cast<std::size_t>(name - s.names.begin());
      }
    }
    if (found != nullptr) {
      add(*of, *found, index, wanted, true);
      continue;
    }
    for (const Column& c : columns_of_) names.push_back(c.name);
    for (const Topic& t : recording_.topics) {
      const Stream* s = largest(t);
      for (const std::string& n : s != nullptr ? s->names : t.first_names)
        names.push_back(t.channel.topic + "/" + n);
    }
    all.assign(names.begin(), names.end());
    fail(
        "no column " + core::quoted(wanted) + ", which " + printable(request.map) + " names" +
        core::did_you_mean(wanted, all) +
        "; expected time_s (the bag's clock), a joint's angle_<joint>_rad, velocity_<joint>_radps or torque_<joint>_nm, "
        "or a topic with a path, /topic/path. " +
        contents());
  }
}

void Join::add_others() {
  for (const Topic& t : recording_.topics) {
    const Stream* s = largest(t);
    // What nodes say of themselves is no signal.
    if (&t == joints_ || s == nullptr || t.channel.type.starts_with("rcl_interfaces/")) continue;
    for (std::size_t i = 0; i < s->names.size(); ++i)
      if (!is_stamp(s->names[i]) && !is_about_others(s->names[i]))
        add(t, *s, i, t.channel.topic + "/" + s->names[i], false);
  }
}

void Join::choose_rows(const Request& request) {
  std::size_t best = 0;
  bool chosen = false;
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const bool wished = streams_[i].topic->channel.topic == request.topic;
    if (chosen && !wished) continue;
    if (wished && !chosen) {
      best = i;
      chosen = true;
      continue;
    }
    // Topics that all_topics brings in do not displace what is asked for, nor joint states one that has but few messages more.
    if (!streams_[i].needed && streams_[best].needed) continue;
    const double factor = streams_[best].topic == joints_ && streams_[i].topic != joints_ ? 0.9 : 1.0;
    if (factor * static_cast<double>(streams_[i].stream->messages()) >
        static_cast<double>(streams_[best].stream->messages()))
      best = i;
  }
  if (!request.topic.empty() && !chosen) {
    // Nothing but its times is used.
    for (const Topic& t : recording_.topics)
      if (t.channel.topic == request.topic && !t.streams.empty()) {
        best = streams_.size();
        streams_.push_back({&t, largest(t)});
        break;
      }
  }
  std::swap(streams_[0], streams_[best]);
  for (Column& c : columns_of_) c.stream = c.stream == 0 ? best : c.stream == best ? 0 : c.stream;
}

/// Stamps where nearly all messages have one; else when they were recorded.
void Join::set_clocks() {
  std::vector<std::int64_t> behind;  // the recorder's clock less the stamps
  for (Joined& j : streams_) {
    const Stream& s = *j.stream;
    // A simulation's first message has the time 0, which is none elsewhere.
    const auto without = static_cast<std::size_t>(
        std::count_if(s.stamp_ns.begin(), s.stamp_ns.end(), [](std::int64_t t) { return t <= 0; }));
    j.by_stamp = without <= 1 + s.messages() / 20 && without < s.messages();
    j.time_ns = j.by_stamp ? s.stamp_ns : s.log_ns;
    if (!j.by_stamp || !behind.empty()) continue;
    for (std::size_t i = 0; i < s.messages(); ++i) behind.push_back(s.log_ns[i] - s.stamp_ns[i]);
  }
  const std::int64_t other = median(std::move(behind));
  const bool two = std::abs(other) > kOtherClock;
  for (Joined& j : streams_) {
    if (!j.by_stamp && two)
      for (std::int64_t& t : j.time_ns) t = std::clamp(t - other, -kLatest_ns, kLatest_ns);
    j.held = is_command(j.topic->channel);
    order(j);
  }
  const auto unstamped =
      std::find_if(streams_.begin(), streams_.end(), [](const Joined& j) { return !j.by_stamp; });
  if (two && unstamped != streams_.end())
    notes_.push_back(printable(
        path_ + ": the recorder's clock is " + seconds(other) +
        " ahead of the stamps (median), which was taken off the times of messages without a stamp."));
  // A switch has nothing between its two values.
  for (Column& c : columns_of_) {
    const Joined& j = streams_[c.stream];
    c.held = j.held;
    if (c.held || c.stream == 0) continue;
    c.held = true;
    for (std::size_t i = 0; i < j.stream->messages() && c.held; ++i) {
      const double v = j.stream->at(i, c.index);
      c.held = v == 0.0 || v == 1.0 || std::isnan(v);
    }
  }
}

/// Messages in the order of time: those that are late are left out. More than a few mean that the clock was set.
void Join::order(Joined& j) {
  std::int64_t latest = INT64_MIN;
  std::size_t late = 0, first_late = 0;
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 0; i < j.time_ns.size(); ++i) {
    if (j.time_ns[i] <= latest) {
      if (late++ == 0) first_late = i;
      continue;
    }
    if (latest != INT64_MIN) intervals.push_back(j.time_ns[i] - latest);
    latest = j.time_ns[i];
    if (&j == &streams_.front()) continue;
    j.messages.push_back(i);
    j.order_ns.push_back(latest);
  }
  j.longest_ns = std::max(kOtherClock, 5 * std::min(median(std::move(intervals)), kLatest_ns / 5));
  // Rows of one topic alone the reader of logs brings in order, and says so.
  if (streams_.size() == 1 || 20 * late <= j.time_ns.size()) {
    if (late != 0 && &j != &streams_.front())
      notes_.push_back(printable(path_ + ": " + counted(late, "message", "messages") + " of " +
                                 j.topic->channel.topic +
                                 " with a time that does not increase were left out."));
    return;
  }
  const std::int64_t before = j.time_ns[first_late - 1];
  fail(
      "the clock of " + core::quoted(j.topic->channel.topic) + " (" +
      (j.by_stamp ? "header stamps" : "times of recording") + ") goes back by " +
      seconds(before - j.time_ns[first_late]) + " at its message " + std::to_string(first_late + 1) + ", " +
      seconds(j.stream->log_ns[first_late] - j.stream->log_ns.front()) +
      " after its first one was recorded, and topics cannot be joined across it; expected one clock throughout: cut the "
      "bag there (was a simulation reset, or the clock set?)");
}

bool Join::known(const Joined& j, std::int64_t t) const {
  if (j.order_ns.empty() || t < j.order_ns.front()) return false;
  return j.held || t <= j.order_ns.back();
}

/// Of all topics, those that few rows lie within.
void Join::leave_out_short_ones() {
  const std::vector<std::int64_t>& rows = streams_.front().time_ns;
  for (std::size_t s = 1; s < streams_.size(); ++s) {
    Joined& j = streams_[s];
    if (j.needed) continue;
    const auto within = static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [&](std::int64_t t) { return known(j, t); }));
    if (10 * within >= 9 * rows.size()) {
      j.needed = true;  // rows at both ends are left out for it
      continue;
    }
    notes_.push_back(printable(path_ + ": " + j.topic->channel.topic + " was left out: it has " +
                               counted(j.stream->messages(), "message", "messages") + ", within whose time " +
                               std::to_string(within) + " of " + std::to_string(rows.size()) +
                               " rows lie. A map that names its columns cuts the rows to them."));
    std::erase_if(columns_of_, [&](const Column& c) { return c.stream == s; });
  }
}

void Join::trim() {
  const std::vector<std::int64_t>& rows = streams_.front().time_ns;
  const auto fits = [&](std::size_t row) {
    for (std::size_t s = 1; s < streams_.size(); ++s)
      if (streams_[s].needed && !known(streams_[s], rows[row])) return false;
    return true;
  };
  last_row_ = rows.size();
  while (first_row_ < last_row_ && !fits(first_row_)) ++first_row_;
  while (last_row_ > first_row_ && !fits(last_row_ - 1)) --last_row_;
  if (first_row_ == last_row_) {
    std::string spans;
    for (const Joined& j : streams_)
      if (j.needed && !j.time_ns.empty())
        spans += (spans.empty() ? "" : ", ") + j.topic->channel.topic + " from " +
                 seconds(*std::min_element(j.time_ns.begin(), j.time_ns.end()) - rows.front()) + " to " +
                 seconds(*std::max_element(j.time_ns.begin(), j.time_ns.end()) - rows.front());
    fail(printable("no row has values of all topics that are joined: " + spans + " after the first row (" +
                   streams_.front().topic->channel.topic + ")") +
         "; expected topics that were recorded at the same time, with stamps of one clock");
  }
  if (const std::size_t cut = rows.size() - (last_row_ - first_row_); cut != 0)
    notes_.push_back(printable(path_ + ": " + counted(first_row_, "row", "rows") + " at the start and " +
                               std::to_string(rows.size() - last_row_) +
                               " at the end, at which not all joined topics have values, were left out."));
}

/// Columns that hold no number anywhere, as efforts of drives that do not measure them.
void Join::drop_empty_columns() {
  std::vector<bool> empty(columns_of_.size(), true);
  for (std::size_t k = 0; k < columns_of_.size(); ++k) {
    const Column& c = columns_of_[k];
    const Stream& s = *streams_[c.stream].stream;
    for (std::size_t i = 0; i < s.messages() && empty[k]; ++i) empty[k] = !std::isfinite(s.at(i, c.index));
    if (empty[k] && c.needed)
      fail("the column " + core::quoted(c.name) + " holds no number in any message of " +
           core::quoted(streams_[c.stream].topic->channel.topic) + "; expected measured values");
  }
  std::size_t k = 0;
  std::erase_if(columns_of_, [&](const Column& /*c*/) { return empty[k++]; });
}

std::string Join::clock() const { return streams_.front().by_stamp ? "header stamp" : "time of recording"; }

void Join::say() {
  const Joined& rows = streams_.front();
  notes_.push_back(printable(
      path_ + ": rows are the " + counted(rows.stream->messages(), "message", "messages") + " of " +
      rows.topic->channel.topic + " (" + rows.topic->channel.type + "), time is their " + clock() + "."));
  for (std::size_t s = 1; s < streams_.size(); ++s) {
    const Joined& j = streams_[s];
    std::size_t held = 0, all = 0;
    for (const Column& c : columns_of_)
      if (c.stream == s) {
        ++all;
        held += c.held ? 1 : 0;
      }
    if (all == 0) continue;
    notes_.push_back(printable(
        path_ + ": " + j.topic->channel.topic + " (" + counted(j.stream->messages(), "message", "messages") +
        ") was " +
        (held == all ? "held from one message to the next"
                     : "interpolated at the rows' times" +
                           (held == 0 ? std::string()
                                      : ", " + counted(held, "column", "columns") + " of 0 and 1 held")) +
        (j.by_stamp == rows.by_stamp
             ? ""
             : "; its time is the " + std::string(j.by_stamp ? "header stamp" : "time of recording")) +
        "."));
  }
  for (const Joined& j : streams_) {
    const std::uint64_t others = j.topic->messages - j.topic->unread - j.stream->messages();
    if (j.topic->joint_states || others == 0) continue;
    notes_.push_back(printable(path_ + ": " + counted(others, "message", "messages") + " of " +
                               j.topic->channel.topic +
                               " with sequences of other lengths, or other keys, were left out."));
  }
  for (const Topic& t : recording_.topics) {
    if (t.unread == 0) continue;
    const bool used =
        std::any_of(streams_.begin(), streams_.end(), [&](const Joined& j) { return j.topic == &t; });
    if (!used) continue;
    const std::string what = printable(t.channel.topic) + " cannot be read, first " + t.first_unread;
    if (20 * t.unread > t.messages)
      fail(std::to_string(t.unread) + " of " + counted(t.messages, "message", "messages") + " of " + what +
           "; expected messages of one form");
    notes_.push_back(printable(path_) + ": " + counted(t.unread, "message", "messages") + " of " + what +
                     ".");
  }
}

void Join::values(std::size_t row, std::vector<double>& to) {
  const std::int64_t t = time_ns(row);
  for (std::size_t s = 1; s < streams_.size(); ++s) {
    Joined& j = streams_[s];
    if (j.at > 0 && j.order_ns[j.at - 1] > t) j.at = 0;
    while (j.at < j.order_ns.size() && j.order_ns[j.at] <= t) ++j.at;
  }
  to.resize(columns_of_.size());
  for (std::size_t k = 0; k < columns_of_.size(); ++k) {
    const Column& c = columns_of_[k];
    const Joined& j = streams_[c.stream];
    if (c.stream == 0) {
      to[k] = j.stream->at(first_row_ + row, c.index);
      continue;
    }
    to[k] = kNotKnown;
    if (j.at == 0) continue;
    const double before = j.stream->at(j.messages[j.at - 1], c.index);
    const std::int64_t since = t - j.order_ns[j.at - 1];
    if (c.held || since == 0) {
      if (j.held || since <= j.longest_ns) to[k] = before;
      continue;
    }
    if (j.at == j.order_ns.size()) continue;
    const std::int64_t interval = j.order_ns[j.at] - j.order_ns[j.at - 1];
    if (interval > j.longest_ns) continue;
    const double after = j.stream->at(j.messages[j.at], c.index);
    to[k] = before + (after - before) * (static_cast<double>(since) / static_cast<double>(interval));
  }
}

}  // namespace furcula::bags
