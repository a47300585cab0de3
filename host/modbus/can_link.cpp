// Registers over CAN, see can_link.hpp.
#include "host/modbus/can_link.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <deque>

#include "host/core/error.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::modbus {
namespace {

using bus::RegisterOperation;

std::string text_of(bus::ModbusException exception) {
  switch (exception) {
    case bus::ModbusException::none:
      return "";
    case bus::ModbusException::illegal_function:
      return "Illegal function";
    case bus::ModbusException::illegal_address:
      return "Illegal data address";
    case bus::ModbusException::illegal_value:
      return "Illegal data value";
    case bus::ModbusException::device_failure:
      return "Slave device or server failure";
    case bus::ModbusException::acknowledge:
      return "Acknowledge";
  }
  return "Exception " + std::to_string(static_cast<int>(exception));
}

class SocketPort final : public FramePort {
 public:
  SocketPort(const std::string& interface, std::uint8_t node)
      : socket_(interface, std::array{bus::id_of(bus::message::kRegisterAnswer, node)}) {}

  bool send(const bus::Frame& frame) override { return socket_.send({&frame, 1}); }

  std::optional<bus::Frame> receive(std::chrono::milliseconds most,
                                    const std::function<bool(const bus::Frame&)>& wanted) override {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + most;
    for (;;) {
      for (; !come_.empty(); come_.pop_front()) {
        if (!wanted(come_.front())) continue;
        const bus::Frame frame = come_.front();
        come_.pop_front();
        return frame;
      }
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
      pollfd waited{socket_.fd(), POLLIN, 0};
      if (left.count() <= 0 || ::poll(&waited, 1, static_cast<int>(left.count())) <= 0) return std::nullopt;
      const auto received = socket_.receive();
      for (const socketcan::Received& r : received) come_.push_back(r.frame);
      // An interface that went down makes its socket readable, with nothing to read.
      if ((waited.revents & (POLLERR | POLLHUP)) != 0 && received.empty()) return std::nullopt;
    }
  }

 private:
  socketcan::CanSocket socket_;
  std::deque<bus::Frame> come_;
};

bool has_end(std::uint32_t four_characters) {
  for (int shift = 24; shift >= 0; shift -= 8)
    if ((four_characters >> shift & 0xffu) == 0) return true;
  return false;
}

}  // namespace

CanLink::CanLink(std::string name, std::uint8_t node, std::uint8_t sequence, std::unique_ptr<FramePort> port)
    : name_(std::move(name)), node_(node), sequence_(sequence), port_(std::move(port)) {}

/// What changes something is said again as it was, so that a node which has done it tells so; what reads is
/// another request each time, so that frames of one answer are not taken for those of the next.
Answer CanLink::ask(bus::RegisterRequest request, const char* doing, Values& values,
                    const std::function<bool(const Values&)>& complete) {
  const bool reads =
      request.operation != RegisterOperation::write && request.operation != RegisterOperation::request;
  bool taken = false;
  for (int i = 0; i < kTries; ++i) {
    if (reads || i == 0) request.sequence = sequence_++;
    values.clear();
    if (!port_->send(bus::pack(request, node_))) continue;
    taken = true;
    const auto ours = [&](const bus::Frame& frame) {
      const Result<bus::RegisterAnswer> answer = bus::unpack_register_answer(frame, node_);
      return answer.ok() && answer.value().sequence == request.sequence;
    };
    std::uint16_t next = request.operation == RegisterOperation::read_text ? 0 : request.address;
    for (;;) {
      const std::optional<bus::Frame> frame = port_->receive(reads ? kReadMost : kWriteMost, ours);
      if (!frame) break;
      const bus::RegisterAnswer answer = bus::unpack_register_answer(*frame, node_).value();
      if (answer.version != bus::kProtocolVersion)
        throw core::DataError(name_ + ": node " + std::to_string(node_) + " speaks version " +
                              std::to_string(answer.version) + " of the protocol; expected " +
                              std::to_string(bus::kProtocolVersion));
      if (answer.status != bus::ModbusException::none) return {answer.status, text_of(answer.status)};
      if (answer.address != next) break;  // one is lost
      next = static_cast<std::uint16_t>(next + 2);
      values.push_back(answer.value);
      if (complete(values)) return {};
    }
  }
  throw core::DataError(name_ + ": " + doing +
                        (taken ? ": node " + std::to_string(node_) + " does not answer"
                               : ": nothing can be sent; the interface is down, or nobody is on the bus"));
}

Answer CanLink::read(Table table, std::uint16_t first, std::span<std::uint16_t> out) {
  Values values;
  const Answer answer = ask(
      {.operation = table == Table::input ? RegisterOperation::read_input : RegisterOperation::read_holding,
       .address = first,
       .value = static_cast<std::uint32_t>(out.size())},
      "reading its registers", values, [&](const Values& v) { return 2 * v.size() >= out.size(); });
  if (answer.exception != bus::ModbusException::none) return answer;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = i % 2 == 0 ? bus::high_word(values[i / 2]) : bus::low_word(values[i / 2]);
  return answer;
}

Answer CanLink::write(std::uint16_t first, std::uint32_t bits) {
  Values values;
  return ask({.operation = RegisterOperation::write, .address = first, .value = bits}, "writing a parameter",
             values, [](const Values&) { return true; });
}

Answer CanLink::request(std::uint16_t session, bus::Request request) {
  Values values;
  const bool stop = request == bus::Request::stop;
  return ask({.operation = RegisterOperation::request,
              .address = bus::kRequestKey,
              .value = bus::bits_of(stop ? std::uint16_t{0} : session, static_cast<std::uint16_t>(request))},
             "sending a request", values, [](const Values&) { return true; });
}

std::string CanLink::text(std::uint8_t object) {
  constexpr std::size_t kMost = 64;  // frames; a text has 60 characters
  Values values;
  const Answer answer = ask({.operation = RegisterOperation::read_text, .value = object}, "asking who it is",
                            values, [](const Values& v) { return has_end(v.back()) || v.size() >= kMost; });
  if (answer.exception != bus::ModbusException::none)
    throw core::DataError(name_ + ": asking who it is: " + answer.text);
  std::string text;
  for (const std::uint32_t value : values)
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xffu);
  return text.substr(0, text.find('\0'));
}

std::unique_ptr<Link> open_can(const Port& port) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  try {
    return std::make_unique<CanLink>(port.text, port.can_node,
                                     static_cast<std::uint8_t>(now / std::chrono::microseconds(1)),
                                     std::make_unique<SocketPort>(port.can_interface, port.can_node));
  } catch (const socketcan::CanError& e) {
    throw core::DataError(port.text + ": " + e.what());
  }
}

}  // namespace furcula::modbus
