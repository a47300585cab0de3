// Modbus TCP, see modbus_server.hpp.
#include "boards/linux_sbc/modbus_server.hpp"

#include <modbus/modbus.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

namespace furcula::linux_sbc {
namespace {

constexpr std::size_t kHeader = 7;  // transaction, protocol, length, unit
constexpr int kSliceMs = 100;
constexpr std::uint8_t kServerFailure = 4;  // Modbus Application Protocol V1.1b3, section 7

}  // namespace

ModbusServer::ModbusServer(const std::string& address, int port, Hatch& hatch) : hatch_(hatch) {
  clients_.fill(-1);
  modbus_ = ::modbus_new_tcp(address.c_str(), port);
  if (modbus_ != nullptr) listener_ = ::modbus_tcp_listen(modbus_, static_cast<int>(kClients));
  if (listener_ >= 0) return;
  const std::string why = ::modbus_strerror(errno);
  if (modbus_ != nullptr) ::modbus_free(modbus_);
  throw ServerError("Modbus cannot listen on " + address + ", port " + std::to_string(port) + ": " + why);
}

ModbusServer::~ModbusServer() {
  for (const int client : clients_)
    if (client >= 0) ::close(client);
  ::close(listener_);
  ::modbus_free(modbus_);
}

void ModbusServer::serve(const std::atomic<bool>& stop) {
  while (!stop.load(std::memory_order_relaxed)) {
    std::array<pollfd, kClients + 1> waited{};
    const bool room = std::find(clients_.begin(), clients_.end(), -1) != clients_.end();
    waited[0] = {room ? listener_ : -1, POLLIN, 0};
    for (std::size_t i = 0; i < kClients; ++i) waited[i + 1] = {clients_[i], POLLIN, 0};
    if (::poll(waited.data(), waited.size(), kSliceMs) <= 0) continue;
    if (waited[0].revents != 0) accept_client();
    for (std::size_t i = 0; i < kClients; ++i) {
      if (waited[i + 1].revents == 0 || answer(clients_[i])) continue;
      ::close(clients_[i]);
      clients_[i] = -1;
    }
  }
}

void ModbusServer::accept_client() {
  const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  const auto place = std::find(clients_.begin(), clients_.end(), -1);
  if (client >= 0 && place != clients_.end()) *place = client;
}

bool ModbusServer::answer(int client) {
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> query{};
  ::modbus_set_socket(modbus_, client);
  const int received = ::modbus_receive(modbus_, query.data());
  if (received <= static_cast<int>(kHeader)) return received == 0;
  // libmodbus knows the length of the usual functions; of others it leaves the rest where it is.
  const std::size_t stated = static_cast<std::size_t>(query[4] << 8 | query[5]);
  Pdu pdu;
  if (stated < 2 || stated > 1 + Pdu::kMostBytes || static_cast<std::size_t>(received) > kHeader - 1 + stated)
    return false;
  std::size_t have = static_cast<std::size_t>(received);
  while (have < kHeader - 1 + stated) {
    pollfd waited{client, POLLIN, 0};
    if (::poll(&waited, 1, kSliceMs) <= 0) return false;
    const ssize_t more = ::recv(client, query.data() + have, kHeader - 1 + stated - have, 0);
    if (more <= 0) return false;
    have += static_cast<std::size_t>(more);
  }
  pdu.size = static_cast<std::uint16_t>(have - kHeader);
  std::copy_n(query.data() + kHeader, pdu.size, pdu.bytes.begin());
  if (!ask_loop(pdu)) return true;  // nobody is to be answered
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> reply{};
  std::copy_n(query.begin(), kHeader, reply.begin());
  reply[4] = static_cast<std::uint8_t>((pdu.size + 1) >> 8);
  reply[5] = static_cast<std::uint8_t>(pdu.size + 1);
  std::copy_n(pdu.bytes.begin(), pdu.size, reply.begin() + kHeader);
  const std::size_t size = kHeader + pdu.size;
  return ::send(client, reply.data(), size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

bool ModbusServer::ask_loop(Pdu& pdu) {
  pdu.number = ++number_;
  bool answered = false;
  if (hatch_.request.put(pdu)) {
    Pdu reply;
    // The loop answers on its next tick; one that does not live is a server's failure.
    for (int tries = 0; tries < 500 && !answered; ++tries) {
      const timespec pause{0, 200'000};
      ::nanosleep(&pause, nullptr);
      answered = hatch_.answer.take(reply) && reply.number == pdu.number;
    }
    if (answered) pdu = reply;
  }
  if (!answered) {
    pdu.bytes[0] = static_cast<std::uint8_t>(pdu.bytes[0] | 0x80u);
    pdu.bytes[1] = kServerFailure;
    pdu.size = 2;
  }
  return pdu.size > 0;
}

}  // namespace furcula::linux_sbc
