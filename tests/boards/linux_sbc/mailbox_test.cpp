// The hand-over between the threads of furculad; of use under the preset tsan above all.
#include "boards/linux_sbc/mailbox.hpp"

#include <modbus/modbus.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <span>
#include <thread>

#include "boards/linux_sbc/histogram.hpp"
#include "host/modbus/tcp_server.hpp"

using namespace furcula;
using linux_sbc::Mailbox;

namespace {

/// A loop that answers each read of holding registers (function 3) with the addresses that were asked for.
class EchoLoop {
 public:
  explicit EchoLoop(Mailbox& mailbox)
      : thread_([this, &mailbox] {
          while (!stop_) {
            mailbox.attend(answer);
            std::this_thread::yield();
          }
        }) {}
  ~EchoLoop() {
    stop_ = true;
    thread_.join();
  }

 private:
  static bus::Response answer(std::span<const std::uint8_t> request) {
    bus::Response response;
    if (request[0] != 3) {
      response.put(request[0] | 0x80u);
      response.put(1);
      return response;
    }
    const std::uint16_t first = bus::modbus::word_at(request, 1);
    response.put(3);
    response.put(2u * request[4]);
    for (std::uint8_t i = 0; i < request[4]; ++i) {
      response.put((first + i) >> 8);
      response.put(first + i);
    }
    return response;
  }
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// The server on its own thread, on a port of the loopback that is not used.
struct Service : modbus::TcpService {
  explicit Service(Mailbox& mailbox)
      : modbus::TcpService("127.0.0.1", 0, [&mailbox](std::span<const std::uint8_t> request) {
          return mailbox.ask(request);
        }) {}
};

struct Master {
  explicit Master(const Service& service) : context(::modbus_new_tcp("127.0.0.1", service.port())) {
    ::modbus_set_response_timeout(context, 5, 0);
    REQUIRE(::modbus_connect(context) == 0);
  }
  ~Master() {
    ::modbus_close(context);
    ::modbus_free(context);
  }
  modbus_t* context;
};

}  // namespace

TEST_CASE("every value that one thread puts another takes once, in order and whole") {
  struct Value {
    std::uint32_t number = 0;
    std::uint32_t copies[30] = {};
  };
  static linux_sbc::Slot<Value> slot;
  constexpr std::uint32_t kMany = 20000;
  std::thread producer([] {
    for (std::uint32_t n = 1; n <= kMany;) {
      Value value{n, {}};
      for (auto& copy : value.copies) copy = n;
      if (slot.put(value))
        ++n;
      else
        std::this_thread::yield();
    }
  });
  std::uint32_t taken = 0, torn = 0, wrong_order = 0;
  while (taken < kMany) {
    Value value;
    if (!slot.take(value)) {
      std::this_thread::yield();
      continue;
    }
    if (value.number != ++taken) ++wrong_order;
    for (const auto copy : value.copies) torn += copy != value.number;
  }
  producer.join();
  CHECK(torn == 0);
  CHECK(wrong_order == 0);
  Value value;
  CHECK_FALSE(slot.take(value));
}

TEST_CASE("what is withdrawn is not taken, and what was taken is not withdrawn") {
  linux_sbc::Slot<int> slot;
  int value = 0;
  CHECK_FALSE(slot.withdraw());
  CHECK(slot.put(1));
  CHECK(slot.withdraw());
  CHECK_FALSE(slot.take(value));
  CHECK(slot.put(2));
  CHECK(slot.take(value));
  CHECK(value == 2);
  CHECK_FALSE(slot.withdraw());
}

TEST_CASE("of two threads, one that withdraws and one that takes, one alone has each value") {
  static linux_sbc::Slot<int> slot;
  std::atomic<bool> stop{false};
  int taken = 0;
  std::thread taker([&] {
    int value = 0;
    while (!stop) taken += slot.take(value) ? 1 : 0;
    taken += slot.take(value) ? 1 : 0;
  });
  constexpr int kMany = 20000;
  int put = 0, withdrawn = 0;
  for (int i = 0; i < kMany; ++i) {
    put += slot.put(i) ? 1 : 0;
    if (i % 3 == 0) std::this_thread::yield();
    withdrawn += slot.withdraw() ? 1 : 0;
  }
  stop = true;
  taker.join();
  CHECK(taken + withdrawn == put);
}

TEST_CASE("a full slot keeps what it has") {
  linux_sbc::Slot<int> slot;
  CHECK(slot.put(1));
  CHECK_FALSE(slot.put(2));
  int value = 0;
  REQUIRE(slot.take(value));
  CHECK(value == 1);
  CHECK(slot.put(3));
}

TEST_CASE(
    "libmodbus reads through the server and the mailbox what the loop answers, from two masters at once") {
  Mailbox mailbox;
  const EchoLoop loop(mailbox);
  const Service service(mailbox);
  const Master first(service), second(service);
  std::uint16_t words[100] = {};
  for (int round = 0; round < 50; ++round) {
    REQUIRE(::modbus_read_registers(first.context, 1000 + round, 100, words) == 100);
    CHECK(words[0] == 1000 + round);
    CHECK(words[99] == 1099 + round);
    REQUIRE(::modbus_read_registers(second.context, 7, 1, words) == 1);
    CHECK(words[0] == 7);
  }
  // What the loop refuses comes back as that exception.
  CHECK(::modbus_write_register(first.context, 1, 1) == -1);
  CHECK(errno == EMBXILFUN);
}

TEST_CASE(
    "a loop that does not answer is a server's failure, and the next request is not answered by an old answer") {
  Mailbox mailbox;
  const Service service(mailbox);
  const Master master(service);
  std::uint16_t word = 0;
  CHECK(::modbus_read_registers(master.context, 1, 1, &word) == -1);
  CHECK(errno == EMBXSFAIL);
  const EchoLoop late(mailbox);  // answers the old request first
  int read = -1;
  // It may take a while until that thread runs.
  for (int tries = 0; tries < 2000 && read != 1; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    read = ::modbus_read_registers(master.context, 77, 1, &word);
  }
  REQUIRE(read == 1);
  CHECK(word == 77);
}

TEST_CASE("a request that was reported as failed is never done, however late the loop comes") {
  Mailbox mailbox;
  const std::array<std::uint8_t, 5> request{3, 0, 1, 0, 1};
  const bus::Response response = mailbox.ask(request);
  REQUIRE(response.size == 2);
  CHECK(response.bytes[0] == (3 | 0x80));
  CHECK(response.bytes[1] == static_cast<std::uint8_t>(bus::ModbusException::device_failure));
  int done = 0;
  const auto count = [&](std::span<const std::uint8_t>) {
    ++done;
    return bus::Response();
  };
  for (int tick = 0; tick < 10; ++tick) mailbox.attend(count);
  CHECK(done == 0);
}

TEST_CASE("whether a request is done and what is said of it agree, wherever the loop comes between") {
  Mailbox mailbox;
  std::atomic<int> done{0};
  std::atomic<bool> stop{false};
  // Looks about when the 100 ms are over, and takes its time with what it finds.
  std::thread loop([&] {
    for (unsigned round = 0; !stop; ++round) {
      std::this_thread::sleep_for(std::chrono::milliseconds(96 + round % 16));
      mailbox.attend([&](std::span<const std::uint8_t> request) {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        ++done;
        bus::Response response;
        response.put(request[0]);
        return response;
      });
    }
  });
  int told_done = 0;
  const std::array<std::uint8_t, 5> request{3, 0, 1, 0, 1};
  for (int round = 0; round < 30; ++round) told_done += mailbox.ask(request).bytes[0] == 3 ? 1 : 0;
  stop = true;
  loop.join();
  CHECK(done == told_done);
  CHECK(told_done > 0);
}

#ifdef FURCULA_COUNTS_ALLOCATIONS
extern "C" unsigned long furcula_allocations();

TEST_CASE("after the start a request takes no memory, on no thread") {
  Mailbox mailbox;
  const EchoLoop loop(mailbox);
  const Service service(mailbox);
  const Master master(service);
  std::uint16_t words[100] = {};
  const unsigned long before = furcula_allocations();
  int read = 0;
  for (int round = 0; round < 20; ++round) read += ::modbus_read_registers(master.context, 7, 100, words);
  CHECK(furcula_allocations() == before);
  CHECK(read == 2000);
}
#endif

TEST_CASE("a histogram puts each duration into its bin, and says so of mean, maximum and share") {
  linux_sbc::Histogram h;
  for (int i = 0; i < 998; ++i) h.add(3'000);  // 2 to 4 us
  h.add(900);
  h.add(5'000'000);
  CHECK(h.count() == 1000);
  CHECK(h.count(0) == 1);
  CHECK(h.count(2) == 998);
  CHECK(h.most_ns() == 5'000'000);
  CHECK(h.mean_us() == Approx((998 * 3.0 + 0.9 + 5000.0) / 1000.0));
  CHECK(h.quantile_us(0.99) == 4.0);
  CHECK(h.quantile_us(1.0) == 5000.0);
  h.add(-5);
  CHECK(h.count(0) == 2);
  h.add(1'000'000'000'000);
  CHECK(h.count(linux_sbc::Histogram::kBins - 1) == 1);
}

TEST_CASE("a histogram may be read while it is filled") {
  linux_sbc::Histogram h;
  std::thread writer([&h] {
    for (int i = 0; i < 20000; ++i) h.add(i * 10);
  });
  std::uint64_t last = 0;
  while (last < 20000) {
    const std::uint64_t now = h.count();
    CHECK(now >= last);
    last = now;
    if (h.text("x").empty()) break;
  }
  writer.join();
  CHECK(h.count() == 20000);
}
