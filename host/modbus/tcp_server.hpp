// A Modbus/TCP server on a thread of its own.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <thread>

#include "furcula/bus/modbus_tcp.hpp"

namespace furcula::modbus {

class TcpServer {
 public:
  /// Answers a connection's complete request with the bytes to send. Called on the server's thread.
  using Answer = std::function<std::span<const std::uint8_t>(bus::TcpConnection&)>;

  /// Listens from now on; port 0: one that is not used. @throws log::DataError where it cannot, naming
  /// address and reason.
  TcpServer(const std::string& address, int port, Answer answer);
  /// Closes every connection and joins the thread.
  ~TcpServer();
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  int port() const { return port_; }

 private:
  void serve();

  Answer answer_;
  int listener_ = -1, stop_ = -1;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace furcula::modbus
