// SocketCAN, see can_socket.hpp.
#include "host/socketcan/can_socket.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace furcula::socketcan {
namespace {

std::string last_error() { return std::generic_category().message(errno); }

std::int64_t realtime_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

can_frame to_kernel(const bus::Frame& frame) {
  can_frame out{};
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0u) | (frame.remote ? CAN_RTR_FLAG : 0u);
  out.can_dlc = frame.size;
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

bus::Frame from_kernel(const can_frame& frame) {
  bus::Frame out;
  out.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  out.remote = (frame.can_id & CAN_RTR_FLAG) != 0;
  out.id = frame.can_id & (out.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  out.size = std::min<std::uint8_t>(frame.can_dlc, 8);
  std::copy_n(frame.data, out.data.size(), out.data.begin());
  return out;
}

}  // namespace

CanSocket::CanSocket(const std::string& interface, std::span<const std::uint32_t> ids)
    : interface_(interface), id_count_(std::min(ids.size(), kMostIds)) {
  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof(request.ifr_name))
    throw CanError("'" + interface + "' is no name of a CAN interface");
  fd_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) throw CanError("this kernel has no SocketCAN (" + last_error() + "): modprobe can_raw");
  const auto fail = [this](const std::string& message) {
    ::close(fd_);
    throw CanError(message);
  };
  std::memcpy(request.ifr_name, interface.data(), interface.size());
  if (::ioctl(fd_, SIOCGIFINDEX, &request) != 0)
    fail("there is no CAN interface '" + interface + "'; ip link lists those that there are");
  if (::ioctl(fd_, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0)
    fail("the CAN interface '" + interface + "' is down: ip link set " + interface +
         " up type can bitrate 1000000");
  std::copy_n(ids.begin(), id_count_, ids_.begin());
  if (bind_to_interface() != 0)
    fail("the CAN interface '" + interface + "' cannot be bound: " + last_error());
}

int CanSocket::bind_to_interface() {
  ifreq request{};
  std::memcpy(request.ifr_name, interface_.data(), interface_.size());
  if (::ioctl(fd_, SIOCGIFINDEX, &request) != 0) return errno;
  std::array<can_filter, kMostIds> filters{};
  for (std::size_t i = 0; i < id_count_; ++i)
    filters[i] = {ids_[i], CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG};
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  if (id_count_ > 0)
    ::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                 static_cast<socklen_t>(id_count_ * sizeof(can_filter)));
  ::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors));
  ::setsockopt(fd_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
  ::setsockopt(fd_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  return ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ? 0 : errno;
}

CanSocket::~CanSocket() {
  if (fd_ >= 0) ::close(fd_);
}

std::span<const Received> CanSocket::receive() {
  can_frame frames[kBatch];
  iovec parts[kBatch];
  mmsghdr messages[kBatch] = {};
  alignas(cmsghdr) char extra[kBatch][CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))];
  for (std::size_t i = 0; i < kBatch; ++i) {
    parts[i] = {&frames[i], sizeof(frames[i])};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_control = extra[i];
    messages[i].msg_hdr.msg_controllen = sizeof(extra[i]);
  }
  const int n = ::recvmmsg(fd_, messages, kBatch, MSG_DONTWAIT, nullptr);
  watch_.note_receive(n < 0 ? errno : 0);
  std::size_t count = 0;
  const std::int64_t now_ns = n > 0 ? realtime_ns() : 0;
  for (int i = 0; i < n; ++i) {
    if (messages[i].msg_len != sizeof(can_frame)) continue;
    Received& received = received_[count];
    received.age_ns = 0;
    msghdr& header = messages[i].msg_hdr;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != SOL_SOCKET) continue;
      if (c->cmsg_type == SO_TIMESTAMPNS) {
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(c), sizeof(stamp));
        // The stamp is of the clock that may be set; a step of it counts as no age, or as the oldest.
        received.age_ns = std::clamp<std::int64_t>(
            now_ns - (std::int64_t{1'000'000'000} * stamp.tv_sec + stamp.tv_nsec), 0, 1'000'000'000);
      } else if (c->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t dropped = 0;
        std::memcpy(&dropped, CMSG_DATA(c), sizeof(dropped));
        counters_.overflowed += dropped - dropped_;
        dropped_ = dropped;
      }
    }
    if ((frames[i].can_id & CAN_ERR_FLAG) != 0) {
      count_error(frames[i].can_id, frames[i].data);
      continue;
    }
    received.frame = from_kernel(frames[i]);
    ++counters_.received;
    ++count;
  }
  return {received_, count};
}

void CanSocket::count_error(std::uint32_t id, const unsigned char* data) {
  ++counters_.error_frames;
  watch_.note_error_frame(id);
  if ((id & CAN_ERR_BUSOFF) != 0) ++counters_.bus_off;
  if ((id & CAN_ERR_CRTL) != 0 && data[1] != 0) ++counters_.controller_errors;
  if ((id & CAN_ERR_ACK) != 0) ++counters_.no_acknowledge;
}

bool CanSocket::send(std::span<const bus::Frame> frames) {
  can_frame out[kBatch];
  iovec parts[kBatch];
  mmsghdr messages[kBatch] = {};
  const std::size_t count = std::min(frames.size(), kBatch);
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = to_kernel(frames[i]);
    parts[i] = {&out[i], sizeof(out[i])};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  if (count == 0) return true;
  const int n = ::sendmmsg(fd_, messages, static_cast<unsigned>(count), MSG_DONTWAIT);
  watch_.note_send(n < 0 ? errno : 0);
  if (watch_.state() == CanState::gone && !interface_.empty() && --until_look_ == 0) {
    until_look_ = kLookAfter;
    bind_to_interface();
  }
  const std::size_t sent = n > 0 ? static_cast<std::size_t>(n) : 0;
  counters_.sent += sent;
  counters_.refused += frames.size() - sent;
  return sent == frames.size();
}

}  // namespace furcula::socketcan
