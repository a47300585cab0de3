#include "host/modbus/tcp_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <vector>

#include "host/log/error.hpp"

namespace furcula::modbus {
namespace {

constexpr std::size_t kConnectionsMax = 8;

struct Connection {
  int fd;
  bus::TcpConnection stream;
};

/// Reads what is there and answers it. @returns whether the connection lives on.
bool attend(Connection& connection, const TcpServer::Answer& answer) {
  std::array<std::uint8_t, 1024> bytes;
  const ssize_t n = ::recv(connection.fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  if (n == 0) return false;
  std::span<const std::uint8_t> rest(bytes.data(), static_cast<std::size_t>(n));
  while (!rest.empty()) {
    rest = rest.subspan(connection.stream.take(rest));
    if (connection.stream.broken()) return false;
    if (!connection.stream.complete()) continue;
    const std::span<const std::uint8_t> out = answer(connection.stream);
    // A peer that does not read what it asked for is left.
    if (::send(connection.fd, out.data(), out.size(), MSG_NOSIGNAL | MSG_DONTWAIT) !=
        static_cast<ssize_t>(out.size()))
      return false;
  }
  return true;
}

}  // namespace

TcpServer::TcpServer(const std::string& address, int port, Answer answer) : answer_(std::move(answer)) {
  const std::string where = address + ":" + std::to_string(port);
  const auto fail = [&](const char* doing) {
    const std::string reason = std::generic_category().message(errno);
    if (listener_ >= 0) ::close(listener_);
    if (stop_ >= 0) ::close(stop_);
    throw log::DataError(where + ": " + doing + ": " + reason);
  };
  sockaddr_in bound{};
  bound.sin_family = AF_INET;
  bound.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, address.c_str(), &bound.sin_addr) != 1)
    throw log::DataError(where + ": no address to listen on; expected one like 127.0.0.1");
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  stop_ = ::eventfd(0, EFD_CLOEXEC);
  if (listener_ < 0 || stop_ < 0) fail("no socket");
  const int on = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof bound;
  if (::bind(listener_, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) != 0 ||
      ::listen(listener_, 4) != 0 ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&bound), &size) != 0)
    fail("listening");
  port_ = ntohs(bound.sin_port);
  thread_ = std::thread([this] { serve(); });
}

TcpServer::~TcpServer() {
  const std::uint64_t one = 1;
  static_cast<void>(::write(stop_, &one, sizeof one));
  thread_.join();
  ::close(listener_);
  ::close(stop_);
}

void TcpServer::serve() {
  std::vector<Connection> connections;
  for (;;) {
    std::vector<pollfd> waited{{stop_, POLLIN, 0}, {listener_, POLLIN, 0}};
    for (const Connection& c : connections) waited.push_back({c.fd, POLLIN, 0});
    if (::poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) break;
    if (waited[0].revents != 0) break;
    for (std::size_t i = connections.size(); i-- > 0;) {
      if (waited[i + 2].revents == 0 || attend(connections[i], answer_)) continue;
      ::close(connections[i].fd);
      connections.erase(connections.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (waited[1].revents == 0) continue;
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (fd < 0) continue;
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (connections.size() < kConnectionsMax)
      connections.push_back({fd, {}});
    else
      ::close(fd);
  }
  for (const Connection& c : connections) ::close(c.fd);
}

}  // namespace furcula::modbus
