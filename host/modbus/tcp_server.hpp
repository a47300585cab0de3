// A Modbus/TCP server: libmodbus listens and receives, a callable answers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <thread>

#include "furcula/bus/modbus_pdu.hpp"

struct _modbus;  // NOLINT(clang-diagnostic-reserved-identifier): libmodbus's own name

namespace furcula::modbus {

/// Modbus knows no password: what to warn of where a server listens on `address`; empty for the loopback
/// (127.0.0.0/8), and for what is no IPv4 address.
std::string network_warning(const std::string& address);

class TcpServer {
 public:
  /// At the same time. One more takes the place of the one that has been silent for longest: a computer that
  /// was unplugged never says that it went.
  static constexpr std::size_t kClients = 8;

  /// Answers one request (function code and its data) of whatever unit: a connection has one. Called on the
  /// thread that serves.
  using Answer = std::function<bus::Response(std::span<const std::uint8_t> request)>;

  /// Listens at once, on an IPv4 address; port 0: one that is not used. @throws core::DataError where it
  /// cannot, naming address, port and reason.
  TcpServer(const std::string& address, int port, Answer answer);
  ~TcpServer();
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  int port() const { return port_; }
  /// Serves until stop(). To be called from its own thread. Takes no memory.
  void serve();
  /// From any thread, and for good.
  void stop() const;

  enum class Attended : std::uint8_t {
    answered,
    waits,  ///< for the rest of a request
    lost,   ///< gone, or what it says is no Modbus/TCP: to be closed
  };
  /// Answers the next request of a client's socket, which serve() does where there is something to read.
  Attended attend(int client);

 private:
  struct Client {
    int socket = -1;
    std::uint64_t attended = 0;  ///< the number of its last request, over all clients
  };
  void accept_client();
  static void leave(Client& client);

  Answer answer_;
  _modbus* modbus_ = nullptr;
  int listener_ = -1, stop_ = -1;
  int port_ = 0;
  std::array<Client, kClients> clients_;
  std::uint64_t attended_ = 0;
};

/// The server on a thread of its own, as long as this lives.
class TcpService {
 public:
  TcpService(const std::string& address, int port, TcpServer::Answer answer)
      : server_(address, port, std::move(answer)), thread_([this] { server_.serve(); }) {}
  ~TcpService() {
    server_.stop();
    thread_.join();
  }
  TcpService(const TcpService&) = delete;
  TcpService& operator=(const TcpService&) = delete;

  int port() const { return server_.port(); }

 private:
  TcpServer server_;
  std::thread thread_;
};

}  // namespace furcula::modbus
