// Modbus TCP for people and tools, on a thread of its own: libmodbus receives, the loop answers through a
// hatch.
#pragma once

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>

#include "boards/linux_sbc/hatch.hpp"

struct _modbus;  // NOLINT(clang-diagnostic-reserved-identifier): libmodbus's own name

namespace furcula::linux_sbc {

/// An address that cannot be listened on.
struct ServerError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class ModbusServer {
 public:
  static constexpr std::size_t kClients = 4;  ///< at the same time; more wait until one goes

  /// Listens at once. @throws ServerError.
  ModbusServer(const std::string& address, int port, Hatch& hatch);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  /// Serves until `stop`. To be called from its own thread. Takes no memory.
  void serve(const std::atomic<bool>& stop);

 private:
  void accept_client();
  /// false: the connection is to be closed.
  bool answer(int client);
  bool ask_loop(Pdu& pdu);

  Hatch& hatch_;
  _modbus* modbus_ = nullptr;
  int listener_ = -1;
  std::array<int, kClients> clients_;
  std::uint32_t number_ = 0;
};

}  // namespace furcula::linux_sbc
