// The server on the sockets of clients that do not behave.
#include "host/modbus/tcp_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "tests/host/error_message.hpp"

using namespace furcula;
using Bytes = std::vector<std::uint8_t>;
using Catch::Contains;
using Attended = modbus::TcpServer::Attended;

namespace {

/// Answers with the request's own bytes and, where it fits, one more.
bus::Response echo(std::span<const std::uint8_t> request) {
  bus::Response response;
  for (const std::uint8_t byte : request) response.put(byte);
  if (response.size < response.bytes.size()) response.put(0xee);
  return response;
}

// Reads registers 8 and then 9.
const Bytes kFirst{0x15, 0x01, 0, 0, 0, 6, 0xff, 4, 0, 8, 0, 1};
const Bytes kSecond{0x15, 0x02, 0, 0, 0, 6, 7, 4, 0, 9, 0, 1};
const Bytes kFirstAnswer{0x15, 0x01, 0, 0, 0, 7, 0xff, 4, 0, 8, 0, 1, 0xee};
const Bytes kSecondAnswer{0x15, 0x02, 0, 0, 0, 7, 7, 4, 0, 9, 0, 1, 0xee};

/// A server that nobody serves but the test, and a client's socket.
struct Pair {
  modbus::TcpServer server{"127.0.0.1", 0, echo};
  int sockets[2] = {-1, -1};
  Pair() { REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets) == 0); }
  ~Pair() {
    for (const int s : sockets) ::close(s);
  }
  void say(const Bytes& bytes) const {
    REQUIRE(::send(sockets[0], bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  }
  Attended attend() { return server.attend(sockets[1]); }
  Bytes heard() const {
    Bytes bytes(1000);
    const ssize_t n = ::recv(sockets[0], bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
    return bytes;
  }
};

/// A client of a running server.
class Peer {
 public:
  explicit Peer(const modbus::TcpService& service) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(service.port()));
    ::inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
    REQUIRE(::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  }
  ~Peer() { ::close(fd_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void say(const Bytes& bytes) const {
    REQUIRE(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
  }
  /// Waits for so many bytes; fewer where the server closes.
  Bytes hear(std::size_t size) const {
    Bytes bytes(size);
    pollfd waited{fd_, POLLIN, 0};
    std::size_t have = 0;
    while (have<size&& ::poll(&waited, 1, 10000)> 0) {
      const ssize_t n = ::recv(fd_, bytes.data() + have, size - have, 0);
      if (n <= 0) break;
      have += static_cast<std::size_t>(n);
    }
    bytes.resize(have);
    return bytes;
  }
  bool closed() const { return hear(1).empty(); }
  void end() const { ::shutdown(fd_, SHUT_WR); }

 private:
  int fd_;
};

}  // namespace

TEST_CASE(
    "Requests that are cut anywhere are answered when they are whole, with their transaction and unit") {
  Bytes stream = kFirst;
  stream.insert(stream.end(), kSecond.begin(), kSecond.end());
  Bytes expected = kFirstAnswer;
  expected.insert(expected.end(), kSecondAnswer.begin(), kSecondAnswer.end());
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    Pair pair;
    const auto at = stream.begin() + static_cast<std::ptrdiff_t>(cut);
    std::size_t answered = 0;
    for (const Bytes& part : {Bytes(stream.begin(), at), Bytes(at, stream.end())}) {
      pair.say(part);
      while (pair.attend() == Attended::answered) ++answered;
    }
    CHECK(answered == 2);
    CHECK(pair.heard() == expected);
  }
}

TEST_CASE("A function that libmodbus does not know is answered like any other, up to the longest request") {
  for (const std::size_t data : {0u, 3u, 100u, 252u}) {
    Pair pair;
    Bytes request{0, 1, 0, 0, 0, static_cast<std::uint8_t>(2 + data), 1, 43};
    request.resize(8 + data, 0x0e);
    pair.say(request);
    REQUIRE(pair.attend() == Attended::answered);
    const Bytes answer = pair.heard();
    REQUIRE(answer.size() >= request.size());
    CHECK(Bytes(answer.begin() + 6, answer.begin() + static_cast<std::ptrdiff_t>(request.size())) ==
          Bytes(request.begin() + 6, request.end()));
  }
}

TEST_CASE("What is no Modbus over TCP, or says two lengths, is lost without an answer") {
  const std::vector<Bytes> wrong{
      {'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P'},
      {0, 1, 0, 1, 0, 6, 1, 4, 0, 8, 0, 1},     // another protocol
      {0, 1, 0, 0, 0, 1, 1, 4, 0, 8, 0, 1},     // no function
      {0, 1, 0, 0, 0, 255, 1, 4, 0, 8, 0, 1},   // longer than any request
      {0, 1, 0, 0, 1, 0, 1, 4, 0, 8, 0, 1},     //
      {0, 1, 0, 0, 0, 3, 1, 4, 0, 0, 2, 0, 0},  // shorter than its function, with what follows
      {0, 1, 0, 0, 0, 2, 1, 4},                 // the same, with nothing behind it
  };
  for (const Bytes& bytes : wrong) {
    Pair pair;
    pair.say(bytes);
    CHECK(pair.attend() == Attended::lost);
    CHECK(pair.heard().empty());
  }
  Pair gone;
  ::shutdown(gone.sockets[0], SHUT_WR);
  CHECK(gone.attend() == Attended::lost);
}

TEST_CASE("A client that stops in the middle of a request holds up nobody, and may go on") {
  const modbus::TcpService service("127.0.0.1", 0, echo);
  const Peer slow(service), other(service);
  slow.say(Bytes(kFirst.begin(), kFirst.begin() + 3));
  for (int i = 0; i < 20; ++i) {
    other.say(kSecond);
    REQUIRE(other.hear(kSecondAnswer.size()) == kSecondAnswer);
    if (i == 10) slow.say(Bytes(kFirst.begin() + 3, kFirst.begin() + 9));
  }
  slow.say(Bytes(kFirst.begin() + 9, kFirst.end()));
  CHECK(slow.hear(kFirstAnswer.size()) == kFirstAnswer);
}

TEST_CASE("A client that goes in the middle of a request is left") {
  const modbus::TcpService service("127.0.0.1", 0, echo);
  const Peer peer(service);
  peer.say(Bytes(kFirst.begin(), kFirst.begin() + 3));
  // ... and says no more: the server closes its end.
  peer.end();
  CHECK(peer.closed());
}

TEST_CASE("One client more than there are places takes that of the most silent one") {
  const modbus::TcpService service("127.0.0.1", 0, echo);
  std::vector<std::unique_ptr<Peer>> peers;
  const auto ask = [](const Peer& peer) {
    peer.say(kFirst);
    return peer.hear(kFirstAnswer.size()) == kFirstAnswer;
  };
  for (std::size_t i = 0; i < modbus::TcpServer::kClients; ++i) {
    peers.push_back(std::make_unique<Peer>(service));
    REQUIRE(ask(*peers.back()));
  }
  REQUIRE(ask(*peers[0]));  // the second one is the most silent now
  const Peer more(service);
  CHECK(ask(more));
  CHECK(peers[1]->closed());
  CHECK(ask(*peers[0]));
  CHECK(ask(*peers[2]));
}

TEST_CASE("The end of the server closes its clients' connections") {
  auto service = std::make_unique<modbus::TcpService>("127.0.0.1", 0, echo);
  const Peer peer(*service);
  peer.say(kFirst);
  CHECK(peer.hear(kFirstAnswer.size()) == kFirstAnswer);
  service.reset();
  CHECK(peer.closed());
}

TEST_CASE("An address or a port that cannot be listened on is named, with the reason") {
  CHECK_THAT(test::error_message([] { modbus::TcpServer("somewhere", 1502, echo); }),
             Contains("Modbus cannot listen on somewhere:1502: expected an address like 127.0.0.1"));
  const modbus::TcpServer first("127.0.0.1", 0, echo);
  const std::string place = "127.0.0.1:" + std::to_string(first.port());
  CHECK_THAT(test::error_message([&] { modbus::TcpServer("127.0.0.1", first.port(), echo); }),
             Contains(place) && Contains("in use"));
  CHECK_THAT(test::error_message([] { modbus::TcpServer("192.0.2.1", 1502, echo); }),
             Contains("192.0.2.1:1502"));
}
