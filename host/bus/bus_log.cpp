// Logs of a bus, see bus_log.hpp.
#include "host/bus/bus_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "host/bus/candump_text.hpp"
#include "host/bus/numbers.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::DataError;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// bus/stream.hpp: a sender that was silent for longer has started anew.
constexpr std::int64_t kSilenceNs = 100'000'000;
// docs/contracts.md: a gap of so many intervals is one that nothing is said about.
constexpr std::int64_t kGapIntervals = 5;
// Of a scale, relative: 0.3 mm on a hop of 0.3 m, which is what an encoder of such a rail resolves three times over.
constexpr double kScaleError = 1e-3;

const Signal* signal_of(const NodeMessage& m, std::string_view name) {
  for (const Signal& s : m.signals)
    if (s.name == name) return &s;
  return nullptr;
}

/// NaN where the frame is too short for it, or it holds none.
double value_of(const Frame& frame, const Signal& s) {
  const Result<std::uint32_t> raw = get_raw(frame, s);
  if (!raw.ok()) return kNone;
  if (s.encoding != Encoding::real) return physical(s, raw.value());
  const auto value = static_cast<double>(get(frame, s).value());
  return std::isfinite(value) ? value : kNone;
}

/// Whether it begins with version, sequence number and age.
bool is_stamped(const NodeMessage& m) {
  return signal_of(m, "Protocol_Version") != nullptr && signal_of(m, "Sequence") != nullptr &&
         signal_of(m, "Age") != nullptr;
}

std::string name_and_id(const NodeMessage& m) {
  char text[64];
  std::snprintf(text, sizeof text, " (id 0x%03X)", static_cast<unsigned>(m.id));
  return m.name + text;
}

std::string digits(double value) { return core::rounded(value, 6); }

std::string times(std::uint64_t n, std::string_view what) {
  return std::to_string(n) + " " + std::string(what) + (n == 1 ? "" : "s");
}

}  // namespace

MessageFinder::MessageFinder(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
  check_nodes(nodes_);
  messages_ = messages_of(nodes_);
}

const NodeMessage* MessageFinder::find(const LogFrame& frame) const {
  if (frame.error || frame.longer) return nullptr;
  for (const NodeMessage& m : messages_)
    if (is(frame.frame, *m.message, m.node->id)) return &m;
  return nullptr;
}

const NodeMessage& MessageFinder::named(const std::string& node, const std::string& message) const {
  for (const NodeMessage& m : messages_)
    if (m.node->name == node && m.message->name == message) return m;
  throw DataError("node " + core::quoted(node) + " has no message " + core::quoted(message) +
                  "; expected a node with its protocol, see --node");
}

Survey::Survey(const MessageFinder& finder, const ChannelPermutation& permutation)
    : finder_(finder), permutation_(permutation), counts_(finder.messages().size()) {
  for (const Column& c : permutation.columns)
    if (signal_of(finder.named(c.node, c.message), c.signal) == nullptr)
      throw DataError(c.node + "_" + c.message + " has no signal " + core::quoted(c.signal));
  for (const Column& c : permutation.columns) {
    const NodeMessage& m = finder.named(c.node, c.message);
    // What has an age tells by it when it was measured.
    const bool measured =
        c.join == Join::between || (c.node == permutation.tick_node && c.message == permutation.tick_message);
    if (measured && !is_stamped(m) &&
        std::none_of(answers_.begin(), answers_.end(), [&](const AnswerFinder& a) { return &a.of() == &m; }))
      answers_.emplace_back(m);
  }
  for (const Calibration& told : permutation.calibrations) {
    const auto column = std::find_if(permutation.columns.begin(), permutation.columns.end(),
                                     [&](const Column& c) { return c.name == told.column; });
    if (column == permutation.columns.end()) continue;
    const NodeMessage &of = finder.named(column->node, column->message),
                      &from = finder.named(told.node, told.message);
    calibrations_.push_back(
        {&told, &of, &from, *signal_of(of, column->signal), *signal_of(from, told.signal), {}, {}, true, {}});
  }
}

void Survey::take_pairs(const LogFrame& frame, const NodeMessage& message) {
  for (CalibrationPair& p : calibrations_) {
    const bool told = &message == p.from;
    if (!told && &message != p.of) continue;
    if (!told) {
      // A node that is not homed, or has no signal, says so.
      const Signal* status = signal_of(message, "Status");
      p.usable = status == nullptr || value_of(frame.frame, *status) == 0.0;
      p.before = p.last;
      p.last = value_of(frame.frame, p.value);
    } else if (p.last && p.before && p.usable) {
      const double y = value_of(frame.frame, p.paired_value);
      // Of which of two ticks the board tells is not known: the value may be off by a step and what it moved between them.
      const double moved = *p.last - *p.before;
      if (std::isfinite(moved) && std::isfinite(y))
        p.sample.add({*p.last, y, std::hypot(factor(p.value), moved)});
    }
  }
}

void Survey::add(const LogFrame& frame) {
  const NodeMessage* message = finder_.find(frame);
  for (AnswerFinder& a : answers_) a.add(frame, message);
  if (message == nullptr) return;
  ++counts_[static_cast<std::size_t>(message - finder_.messages().data())];
  take_pairs(frame, *message);
}

void Survey::calibrate(const CalibrationPair& t, ChannelPermutation& out,
                       std::vector<std::string>& notes) const {
  const auto column = std::find_if(out.columns.begin(), out.columns.end(),
                                   [&](const Column& c) { return c.name == t.calibration->column; });
  if (column == out.columns.end()) return;
  const std::vector<std::string>& torques = t.calibration->torques;
  const std::string of = t.of->name + "." + std::string(t.value.name),
                    from = t.from->name + "." + std::string(t.paired_value.name);
  const double step = factor(t.paired_value);
  const std::optional<Line> line = fit_line(t.sample.pairs(), step);
  if (!line || !(line->slope_error < kScaleError * std::abs(line->slope))) {
    if (!column->required) {
      notes.push_back(column->name + " is " + of + " as it stands: " + from +
                      " does not move enough to tell zero and gear");
      return;
    }
    throw DataError(column->name + ": what " + of +
                    " means is not told: " + times(t.sample.pairs().size(), "value") + " of " + from +
                    ", too few, over too small a range or on no line; record a hop, or add --column " +
                    column->name + "=" + column->node + "." + column->message + "." + column->signal +
                    "*METRES_PER_COUNT+HEIGHT_AT_0");
  }
  double slope = line->slope;
  // The drive turns with the leg, or against it: nearer than what counts it is exactly so.
  if (!torques.empty() && std::abs(std::abs(slope) - 1.0) < std::max(kScaleError, 3.0 * line->slope_error))
    slope = slope > 0.0 ? 1.0 : -1.0;
  column->scale = slope;
  column->offset = line->offset_at(slope);
  // Nor is a zero told that is nearer to none than a step of either.
  if (!torques.empty() && std::abs(column->offset) < std::max(step, factor(t.value))) column->offset = 0.0;
  for (Column& c : out.columns)
    if (std::find(torques.begin(), torques.end(), c.name) != torques.end()) c.scale /= slope;
  notes.push_back(
      column->name + " = " + digits(slope) + " x " + of + (column->offset < 0.0 ? " - " : " + ") +
      digits(std::abs(column->offset)) + ", from " + times(line->pairs, "value") + " of " + from +
      (line->excluded == 0 ? "" : "; " + std::to_string(line->excluded) + " off this line left out"));
}

/// What else the recording has of which a torque can be made, as the option to write; empty: nothing.
std::string Survey::instead_of(const Column& column, const NodeMessage& missing) const {
  if (signal_of(missing, column.signal)->unit != "N m") return {};
  const std::string scale = column.scale == 1.0 ? "" : "*" + digits(column.scale);
  std::string out;
  const auto propose = [&](const NodeMessage& m, const Signal& s, std::string_view kind,
                           const std::string& times) {
    const std::string path = column.node + "." + std::string(m.message->name) + "." + std::string(s.name);
    out += (out.empty() ? "; it has " : ", and ") + std::string(kind) + ": --column " + column.name + "=" +
           path + times;
  };
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const NodeMessage& m = finder_.messages()[i];
    if (counts_[i] == 0 || m.node != missing.node) continue;
    for (const Signal& s : m.signals) {
      const bool is_column =
          std::any_of(permutation_.columns.begin(), permutation_.columns.end(), [&](const Column& c) {
            return !column.required && c.node == column.node && c.message == m.message->name &&
                   c.signal == s.name;
          });
      if (is_column) continue;
      // Beside other set points a torque is their feed-forward.
      if (s.unit == "N m" && m.message->sender == Sender::node)
        propose(m, s, "another measurement", scale);
      else if (s.unit == "N m" && m.signals.size() == 1)
        propose(m, s, "the set point, with which what the drive does wrong counts as the robot's", scale);
      else if (s.name == "Iq_Measured")
        propose(m, s, "the current (TORQUE_CONSTANT is in N m/A)", "*TORQUE_CONSTANT" + scale);
    }
  }
  return out;
}

ChannelPermutation Survey::finish(std::vector<std::string>& notes) const {
  ChannelPermutation out = permutation_;
  out.columns.clear();
  for (const Column& c : permutation_.columns) {
    const NodeMessage& m = finder_.named(c.node, c.message);
    if (counts_[static_cast<std::size_t>(&m - finder_.messages().data())] != 0) {
      out.columns.push_back(c);
      continue;
    }
    const std::string instead = instead_of(c, m);
    if (c.required && !instead.empty())
      throw DataError("no frame of " + name_and_id(m) + " in it, of which " + c.name + " is made" + instead +
                      "; or have the drive send " + m.name + ", and record again");
    if (c.required)
      throw DataError(
          "no frame of " + name_and_id(m) + " in it, of which " + c.name +
          " is made; record all of the bus (candump -L can0 > can.log), or name its node with --node or the "
          "signal with --column " +
          c.name + "=NODE.MESSAGE.SIGNAL");
    notes.push_back(c.name + " is left out: no frame of " + name_and_id(m) + " in it" + instead);
  }
  for (const AnswerFinder& a : answers_) {
    const std::optional<Answer> answer = a.found();
    if (!answer) continue;
    out.answers.push_back(*answer);
    notes.push_back(a.of().name + " answers " +
                    (answer->asked_by == nullptr
                         ? "remote frames"
                         : a.of().node->name + "_" + std::string(answer->asked_by->name)) +
                    " after " + core::rounded(static_cast<double>(answer->gap_ns) * 1e-6, 3) +
                    " ms: what it says was measured when that came");
  }
  for (const CalibrationPair& t : calibrations_) calibrate(t, out, notes);
  for (const Column& c : out.columns)
    if (c.join == Join::step)
      notes.push_back(c.name + " is told by " + c.node + "_" + c.message +
                      " alone: a change is taken in the middle between two frames");
  return out;
}

RowMaker::RowMaker(const MessageFinder& finder, const ChannelPermutation& permutation, Write write)
    : finder_(finder),
      permutation_(permutation),
      write_(std::move(write)),
      tick_(&finder.named(permutation.tick_node, permutation.tick_message)) {
  for (const Column& c : permutation_.columns) {
    const NodeMessage& m = finder.named(c.node, c.message);
    Cell& cell = cells_.emplace_back();
    cell.message = &m;
    cell.signal = *signal_of(m, c.signal);
    cell.scale = c.scale;
    cell.offset = c.offset;
    cell.join = c.join;
  }
  for (const Answer& a : permutation_.answers) asked_.push_back({a, {}});
}

/// When the content of a frame without an age was measured: when it was asked for, or else when it was sent.
std::int64_t RowMaker::instant_of(const NodeMessage& message, const LogFrame& in) {
  for (Asked& a : asked_) {
    if (a.answer.of != &message) continue;
    const std::int64_t gap_ns = a.at_ns ? in.time_ns - *a.at_ns : -1;
    a.at_ns.reset();
    // The frame that asked is lost: it came as long before as the others do.
    const bool seen = gap_ns >= 0 && gap_ns <= kLatestAnswerNs;
    return in.time_ns + shift_ns_ - (seen ? gap_ns : a.answer.gap_ns);
  }
  return in.time_ns + shift_ns_;
}

void RowMaker::note_sent(Cell& c, double value, std::int64_t time_ns) {
  // Two interfaces in one recording cross; a clock that is set back counts anew.
  while (!c.sent.empty() && c.sent.back().time_ns - time_ns >= kSilenceNs) c.sent.pop_back();
  if (!c.sent.empty()) time_ns = std::max(time_ns, c.sent.back().time_ns);
  // No row comes any more, or none yet: what acted long ago is no longer needed.
  if (time_ns - last_row_ns_ > 2 * kSilenceNs) {
    complete_row(last_row_ns_ + 2 * kSilenceNs);
    while (c.sent.size() > 1 && c.sent[1].time_ns < time_ns - kSilenceNs) c.sent.pop_front();
  }
  c.sent.push_back({time_ns, value});
}

/// What was commanded between two instants, as one value that gives the same impulse; NaN: not known from the first one on.
double RowMaker::acting(const Cell& c, std::int64_t from_ns, std::int64_t to_ns) {
  std::map<double, double> shares;  // of the values, in ns
  double sum = 0.0, whole_ns = 0.0;
  for (std::size_t i = 0; i < c.sent.size(); ++i) {
    const std::int64_t begin_ns = std::max(c.sent[i].time_ns, from_ns),
                       end_ns = i + 1 < c.sent.size() ? std::min(c.sent[i + 1].time_ns, to_ns) : to_ns;
    if (i == 0 && begin_ns > from_ns) return kNone;
    if (end_ns <= begin_ns) continue;
    const auto share_ns = static_cast<double>(end_ns - begin_ns);
    if (c.signal.encoding != Encoding::real && c.signal.span == c.signal.counts)
      shares[c.sent[i].value] += share_ns;
    sum += share_ns * c.sent[i].value;
    whole_ns += share_ns;
  }
  if (shares.empty()) return whole_ns > 0.0 ? sum / whole_ns : kNone;
  return std::max_element(shares.begin(), shares.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// Gives the last row what acted from it to `end_ns`, which is where the next one begins.
void RowMaker::complete_row(std::int64_t end_ns) {
  if (waiting_.empty() || waiting_.back().time_ns != last_row_ns_) return;
  Row& row = waiting_.back();
  // A row in front of a gap stands for as long as the one before.
  if (end_ns - row.time_ns >= kSilenceNs) end_ns = row.time_ns + std::max<std::int64_t>(interval_ns_, 1);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& c = cells_[i];
    if (c.join != Join::acting || !std::isnan(row.values[i])) continue;
    row.values[i] = acting(c, row.time_ns, end_ns);
    if (!std::isnan(row.values[i]) && std::none_of(c.sent.begin(), c.sent.end(), [&](const Sent& s) {
          return s.time_ns >= row.time_ns && s.time_ns < end_ns;
        }))
      ++c.held;
    while (c.sent.size() > 1 && c.sent[1].time_ns <= end_ns) c.sent.pop_front();
  }
}

/// Whether the frame is the next of the tick's message, and of when its content is.
bool RowMaker::tick_of(const LogFrame& in, std::int64_t& time_ns) {
  if (!is_stamped(*tick_)) {
    time_ns = instant_of(*tick_, in);
    return true;
  }
  time_ns = in.time_ns + shift_ns_;
  const auto stamp = get_stamp(in.frame).value();
  const double since_s = any_tick_ ? static_cast<double>(time_ns - last_tick_ns_) * 1e-9 : 1.0;
  any_tick_ = true;
  last_tick_ns_ = time_ns;
  if (!usable(arrive(stream_, StreamLimits{}, stamp, static_cast<float>(since_s)))) {
    ++repeated_;
    return false;
  }
  time_ns -= std::int64_t{100'000} * std::lround(stamp.age_s * 1e4f);
  if (const Signal* status = signal_of(*tick_, "Status");
      status != nullptr && value_of(in.frame, *status) != 0.0) {
    ++not_good_;
    return false;
  }
  return true;
}

void RowMaker::open_row(const LogFrame& in, std::int64_t time_ns) {
  const bool any = interval_ns_ != 0 || last_row_ns_ != 0;
  if (any && time_ns <= last_row_ns_) {
    if (last_row_ns_ - time_ns < kSilenceNs) {
      ++repeated_;
      return;
    }
    // The clock was set back: time goes on from here.
    const std::int64_t back_ns = last_row_ns_ + std::max<std::int64_t>(interval_ns_, 1'000'000) - time_ns;
    if (back_ns > text::kLatestNs - shift_ns_)
      throw DataError("its time goes back and forth by years; " + std::string(kRecordWith));
    shift_ns_ += back_ns;
    last_tick_ns_ += back_ns;
    time_ns += back_ns;
    ++set_back_;
  }
  if (any && time_ns - last_row_ns_ < kSilenceNs) interval_ns_ = time_ns - last_row_ns_;
  if (any && time_ns - last_row_ns_ >= kSilenceNs) break_ = true;
  if (any) complete_row(time_ns);
  last_row_ns_ = time_ns;
  Row& row = waiting_.emplace_back(Row{time_ns, std::vector<double>(cells_.size(), kNone), break_});
  break_ = false;
  row_open_ = true;
  switched_on_ = false;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& c = cells_[i];
    c.in_row = false;
    if (c.join == Join::hold && c.last) row.values[i] = *c.last;
    // An answer comes behind others that were asked for later.
    if ((c.join == Join::between || c.join == Join::step) && c.last && time_ns <= c.last_ns)
      row.values[i] = between(c, time_ns);
    if (c.message == tick_) row.values[i] = c.scale * value_of(in.frame, c.signal) + c.offset;
  }
}

void RowMaker::close_row() {
  if (!row_open_) return;
  row_open_ = false;
  const Row& row = waiting_.back();
  const bool on = drive_on_ && !switched_on_ && row.time_ns - last_command_ns_ < kSilenceNs;
  if (permutation_.only_while_on && !on) {
    ++off_;
    break_ = true;
    waiting_.pop_back();
    return;
  }
  for (Cell& c : cells_)
    if (c.join == Join::hold && !c.in_row) ++c.held;
}

/// On the line between the last two measurements, or of a switch the nearer one; NaN: not between them, or a gap is.
double RowMaker::between(const Cell& c, std::int64_t time_ns) {
  if (time_ns == c.last_ns) return *c.last;
  if (!c.before || time_ns <= c.before_ns || time_ns > c.last_ns) return kNone;
  const double share =
      static_cast<double>(time_ns - c.before_ns) / static_cast<double>(c.last_ns - c.before_ns);
  if (c.join == Join::step) return share < 0.5 ? *c.before : *c.last;
  return *c.before + share * (*c.last - *c.before);
}

/// A measurement: gives the rows since the one before their values.
void RowMaker::take(Cell& c, double value, std::int64_t time_ns) {
  const auto index = static_cast<std::size_t>(&c - cells_.data());
  const std::int64_t gap_ns = time_ns - c.last_ns;
  const bool gap = c.join == Join::step ? gap_ns > kSilenceNs
                                        : c.interval_ns != 0 && gap_ns / kGapIntervals > c.interval_ns;
  if (gap_ns > 0 && !gap) c.interval_ns = gap_ns;
  c.before = gap ? std::nullopt : c.last;
  c.before_ns = c.last_ns;
  c.last = value;
  c.last_ns = time_ns;
  for (auto row = waiting_.rbegin(); row != waiting_.rend(); ++row) {
    if (row->time_ns > time_ns) continue;
    if (row->time_ns < time_ns && (!c.before || row->time_ns <= c.before_ns)) break;
    row->values[index] = between(c, row->time_ns);
    if (c.join == Join::tick && row->time_ns < time_ns) ++c.filled;
  }
}

void RowMaker::note_drive(const Message& message) {
  const bool enter = &message == &message::kMotorEnter;
  if (enter || &message == &message::kMotorExit) {
    switched_on_ = switched_on_ || enter;
    drive_on_ = enter;
  } else if (&message == &message::kMotorCommand) {
    drive_on_ = true;
    last_command_ns_ = row_open_ ? last_row_ns_ : last_command_ns_;
  }
}

void RowMaker::add(const LogFrame& in) {
  const NodeMessage* message = finder_.find(in);
  for (Asked& a : asked_)
    if (const Message* by = nullptr; asks(in, message, *a.answer.of, by) && by == a.answer.asked_by)
      a.at_ns = in.time_ns;
  if (message == nullptr) return;
  std::int64_t time_ns = in.time_ns + shift_ns_;
  if (message == tick_) {
    if (!tick_of(in, time_ns)) return;
    close_row();
    flush(false);
    open_row(in, time_ns);
    return;
  }
  if (std::any_of(cells_.begin(), cells_.end(),
                  [&](const Cell& c) { return c.message == message && c.join == Join::between; }))
    time_ns = instant_of(*message, in);
  if (message->node->name == permutation_.drive_node) note_drive(*message->message);
  const bool off = message->message == &message::kMotorEnter || message->message == &message::kMotorExit;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& c = cells_[i];
    // A drive that is switched on or off gives no torque, whatever it was told before.
    const bool zero =
        off && (c.join == Join::hold || c.join == Join::acting) && c.message->node == message->node;
    if (c.message != message && !zero) continue;
    const double raw = zero ? 0.0 : value_of(in.frame, c.signal);
    if (!std::isfinite(raw)) continue;
    const double value = zero ? 0.0 : c.scale * raw + c.offset;
    if (c.join == Join::hold) {
      c.last = value;
      c.in_row = true;
      if (row_open_) waiting_.back().values[i] = value;
    } else if (c.join == Join::acting) {
      note_sent(c, value, time_ns);
    } else {
      take(c, value, c.join == Join::tick && row_open_ ? waiting_.back().time_ns : time_ns);
    }
  }
}

void RowMaker::write_row(Row& row) {
  break_before_write_ = break_before_write_ || row.breaks;
  if (std::any_of(row.values.begin(), row.values.end(), [](double v) { return std::isnan(v); })) {
    ++incomplete_;
    return;
  }
  if (runs_ == 0) start_ns_ = row.time_ns;
  if (runs_ == 0 || break_before_write_ || row.time_ns - last_written_ns_ >= kSilenceNs) ++runs_;
  break_before_write_ = false;
  last_written_ns_ = row.time_ns;
  out_.assign(1, static_cast<double>(row.time_ns - start_ns_) * 1e-9);
  out_.insert(out_.end(), row.values.begin(), row.values.end());
  ++rows_;
  write_(runs_, out_);
}

void RowMaker::flush(bool at_end) {
  while (!waiting_.empty()) {
    Row& row = waiting_.front();
    for (std::size_t i = 0; i < cells_.size() && at_end; ++i)
      // Behind the last frame of a switch it is as that said.
      if (const Cell& c = cells_[i]; c.join == Join::step && c.last && std::isnan(row.values[i]) &&
                                     row.time_ns > c.last_ns && row.time_ns - c.last_ns < kSilenceNs)
        row.values[i] = *c.last;
    const bool whole =
        std::none_of(row.values.begin(), row.values.end(), [](double v) { return std::isnan(v); });
    if (!whole && !at_end && last_row_ns_ - row.time_ns < 2 * kSilenceNs) return;
    write_row(row);
    waiting_.pop_front();
  }
}

void RowMaker::finish() {
  close_row();
  complete_row(last_row_ns_ + kSilenceNs);
  flush(true);
}

std::vector<std::string> RowMaker::notes() const {
  std::vector<std::string> out;
  const std::string tick = tick_->name;
  if (stream_.lost != 0)
    out.push_back(times(stream_.lost, "frame") + " of " + tick +
                  " did not come, and their rows are left out");
  if (repeated_ != 0)
    out.push_back(times(repeated_, "frame") + " of " + tick +
                  " came again, late, out of order or of another version, and gave no row");
  if (not_good_ != 0)
    out.push_back(times(not_good_, "frame") + " of " + tick +
                  " said that the count is not good, and gave no row");
  if (set_back_ != 0)
    out.push_back("the clock of the stamps was set back " + times(set_back_, "time") +
                  ": time goes on from there");
  if (off_ != 0)
    out.push_back(times(off_, "row") + " with the drive off or just being switched on " +
                  (off_ == 1 ? "is" : "are") + " left out");
  if (incomplete_ != 0)
    out.push_back(times(incomplete_, "row") + " without a value for each column, at the ends or in gaps, " +
                  (incomplete_ == 1 ? "is" : "are") + " left out");
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const std::string& name = permutation_.columns[i].name;
    if (cells_[i].held != 0)
      out.push_back(times(cells_[i].held, "row") + " without a frame of " + cells_[i].message->name + ": " +
                    name + " holds the value of the row before");
    if (cells_[i].filled != 0)
      out.push_back(times(cells_[i].filled, "row") + " without a frame of " + cells_[i].message->name + ": " +
                    name + " is on the line between its neighbours");
  }
  return out;
}

}  // namespace furcula::bus
