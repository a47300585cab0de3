// The Modbus/TCP server on a client's socket, under bytes that nobody wrote. The input: after how many bytes
// the client pauses, then what it says.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "host/modbus/tcp_server.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Attended = modbus::TcpServer::Attended;

Bytes asked;

/// One server for all inputs: it keeps nothing of a client whose connection it does not serve.
modbus::TcpServer& server() {
  static modbus::TcpServer only("127.0.0.1", 0, [](std::span<const std::uint8_t> request) {
    asked.assign(request.begin(), request.end());
    bus::Response response;
    for (const std::uint8_t byte : request) response.put(byte);
    return response;
  });
  return only;
}

struct Pair {
  std::array<int, 2> sockets{-1, -1};
  Pair() { require(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()) == 0, "there are sockets"); }
  ~Pair() {
    for (const int socket : sockets) ::close(socket);
  }
};

}  // namespace

bool accepts(std::string_view input) {
  if (input.empty() || input.size() > 4096) return false;
  const Pair pair;
  const Bytes said(input.begin() + 1, input.end());
  const std::size_t pause = std::min<std::size_t>(static_cast<std::uint8_t>(input[0]), said.size());
  bool answered = false;
  std::size_t done = 0;
  for (std::size_t there = pause;; there = said.size()) {
    const std::size_t from = there == pause ? 0 : pause;
    if (there > from) ::send(pair.sockets[0], said.data() + from, there - from, 0);
    for (;;) {
      const Attended attended = server().attend(pair.sockets[1]);
      if (attended == Attended::lost) return answered;
      const std::size_t left = there - done;
      // Of whole requests each is answered, with what its header says that it is.
      const std::size_t length = left < 6 ? 0 : said[done + 4] * 256u + said[done + 5];
      if (attended == Attended::waits) {
        require(left < 6 || left < 6 + length, "a whole request is answered");
        break;
      }
      require(length >= 2 && left >= 6 + length, "what is answered is whole");
      const Bytes request(said.begin() + static_cast<std::ptrdiff_t>(done + 7),
                          said.begin() + static_cast<std::ptrdiff_t>(done + 6 + length));
      require(asked == request, "what is answered is what came");
      std::array<std::uint8_t, 300> heard{};
      require(::recv(pair.sockets[0], heard.data(), heard.size(), 0) == static_cast<ssize_t>(6 + length) &&
                  std::equal(heard.begin(), heard.begin() + 6 + length,
                             said.begin() + static_cast<std::ptrdiff_t>(done)),
              "the answer has the request's header");
      done += 6 + length;
      answered = true;
    }
    if (there == said.size()) return answered;
  }
}

}  // namespace furcula::fuzz
