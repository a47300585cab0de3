#include "host/modbus/tcp_server.hpp"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "host/core/error.hpp"

namespace furcula::modbus {
namespace {

// Transaction, protocol (0), length of what follows it, unit. MODBUS Messaging on TCP/IP Implementation Guide
// V1.0b, section 3.1.
constexpr std::size_t kHeaderBytes = 7, kLengthEnd = 6;
using Frame = std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH>;
static_assert(kHeaderBytes + bus::kPduBytesMax == MODBUS_TCP_MAX_ADU_LENGTH);

/// From how many bytes on poll() calls the socket readable.
void wake_at(int socket, std::size_t bytes) {
  const int low = static_cast<int>(bytes);
  ::setsockopt(socket, SOL_SOCKET, SO_RCVLOWAT, &low, sizeof low);
}

}  // namespace

std::string network_warning(const std::string& address) {
  in_addr known{};
  if (::inet_pton(AF_INET, address.c_str(), &known) != 1 || ntohl(known.s_addr) >> 24 == 127) return {};
  return "Modbus listens on " + address +
         ", not on the loopback: it knows no password, and whoever reaches the port can make the robot hop";
}

TcpServer::TcpServer(const std::string& address, int port, Answer answer) : answer_(std::move(answer)) {
  const auto fail = [&](const std::string& why) {
    if (listener_ >= 0) ::close(listener_);
    if (stop_ >= 0) ::close(stop_);
    if (modbus_ != nullptr) ::modbus_free(modbus_);
    throw core::DataError("Modbus cannot listen on " + address + ":" + std::to_string(port) + ": " + why);
  };
  in_addr known{};
  if (::inet_pton(AF_INET, address.c_str(), &known) != 1) fail("expected an address like 127.0.0.1");
  modbus_ = ::modbus_new_tcp(address.c_str(), port);
  if (modbus_ != nullptr) listener_ = ::modbus_tcp_listen(modbus_, static_cast<int>(kClients));
  if (listener_ >= 0) stop_ = ::eventfd(0, EFD_CLOEXEC);
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  if (stop_ < 0 || ::getsockname(listener_, reinterpret_cast<sockaddr*>(&bound), &size) != 0)
    fail(::modbus_strerror(errno));
  port_ = ntohs(bound.sin_port);
  // It gets whole requests alone (attend()): what it would wait for never comes.
  ::modbus_set_byte_timeout(modbus_, 0, 1000);
}

TcpServer::~TcpServer() {
  for (Client& client : clients_) leave(client);
  ::close(listener_);
  ::close(stop_);
  ::modbus_free(modbus_);
}

void TcpServer::stop() const {
  const std::uint64_t one = 1;
  static_cast<void>(::write(stop_, &one, sizeof one));
}

void TcpServer::serve() {
  for (;;) {
    std::array<pollfd, kClients + 2> waited{{{stop_, POLLIN, 0}, {listener_, POLLIN, 0}}};
    for (std::size_t i = 0; i < kClients; ++i) waited[i + 2] = {clients_[i].socket, POLLIN | POLLRDHUP, 0};
    if (::poll(waited.data(), waited.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    if (waited[0].revents != 0) return;
    for (std::size_t i = 0; i < kClients; ++i) {
      const short events = waited[i + 2].revents;
      if (events == 0) continue;
      const Attended attended = attend(clients_[i].socket);
      // The rest of a request never comes from a client that went.
      const bool gone = attended == Attended::waits && (events & ~POLLIN) != 0;
      if (attended == Attended::answered) clients_[i].attended = ++attended_;
      if (attended == Attended::lost || gone) leave(clients_[i]);
    }
    if (waited[1].revents != 0) accept_client();
  }
}

void TcpServer::accept_client() {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (socket < 0) return;
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  // A place that nobody has comes before all others.
  Client& place = *std::min_element(clients_.begin(), clients_.end(),
                                    [](const Client& a, const Client& b) { return a.attended < b.attended; });
  leave(place);
  place = {socket, ++attended_};
}

void TcpServer::leave(Client& client) {
  if (client.socket >= 0) ::close(client.socket);
  client = {};
}

TcpServer::Attended TcpServer::attend(int client) {
  Frame frame;
  // libmodbus waits for what a request lacks, and every client with it: a request is fetched when it is
  // whole.
  const ssize_t seen = ::recv(client, frame.data(), frame.size(), MSG_PEEK | MSG_DONTWAIT);
  if (seen < 0) return errno == EAGAIN || errno == EINTR ? Attended::waits : Attended::lost;
  if (seen == 0) return Attended::lost;
  const auto there = static_cast<std::size_t>(seen);
  std::size_t whole = kLengthEnd;
  if (there >= kLengthEnd) {
    const std::size_t length = bus::modbus::word_at(frame, 4);
    if (bus::modbus::word_at(frame, 2) != 0 || length < 2) return Attended::lost;
    whole += length;
    if (whole > frame.size()) return Attended::lost;
  }
  if (there < whole) {
    wake_at(client, whole);
    return Attended::waits;
  }
  wake_at(client, 1);
  ::modbus_set_socket(modbus_, client);
  const int received = ::modbus_receive(modbus_, frame.data());
  // It goes by the function's length: of functions that it does not know it leaves the rest. Where that is
  // more than the header says nobody knows where the next request begins.
  if (received < static_cast<int>(kHeaderBytes) || static_cast<std::size_t>(received) > whole)
    return Attended::lost;
  const std::size_t rest = whole - static_cast<std::size_t>(received);
  if (rest > 0 && ::recv(client, frame.data() + received, rest, MSG_DONTWAIT) != static_cast<ssize_t>(rest))
    return Attended::lost;

  const bus::Response response =
      answer_(std::span<const std::uint8_t>(frame).subspan(kHeaderBytes, whole - kHeaderBytes));
  frame[4] = 0;
  frame[5] = static_cast<std::uint8_t>(response.size + 1);
  std::copy_n(response.bytes.begin(), response.size, frame.begin() + kHeaderBytes);
  const std::size_t size = kHeaderBytes + response.size;
  // A peer that does not read what it asked for is left.
  return ::send(client, frame.data(), size, MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(size)
             ? Attended::answered
             : Attended::lost;
}

}  // namespace furcula::modbus
