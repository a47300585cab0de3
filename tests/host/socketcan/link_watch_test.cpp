// Whether the interface is on the bus, by what the kernel says; and that the socket passes it on.
#include "host/socketcan/link_watch.hpp"

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "host/socketcan/can_socket.hpp"

using furcula::socketcan::CanSocket;
using furcula::socketcan::CanState;
using furcula::socketcan::LinkWatch;

TEST_CASE("a link that goes down is off until a frame is taken again, however often it is asked") {
  LinkWatch watch;
  CHECK(watch.state() == CanState::on);
  watch.note_receive(ENETDOWN);  // told once
  CHECK(watch.state() == CanState::down);
  for (int i = 0; i < 10; ++i) {
    watch.note_receive(EAGAIN);
    watch.note_send(ENETDOWN);
    CHECK(watch.state() == CanState::down);
  }
  watch.note_receive(0);
  CHECK(watch.state() == CanState::down);  // frames from before still lie in the queue
  watch.note_send(0);
  CHECK(watch.state() == CanState::on);
  CHECK(watch.times_off() == 1);
}

TEST_CASE("off the bus ends by a restart, or by the link down and up, and not by frames that seem to go") {
  LinkWatch watch;
  watch.note_error_frame(CAN_ERR_BUSOFF);
  watch.note_send(0);
  watch.note_send(ENOBUFS);
  CHECK(watch.state() == CanState::off);
  SECTION("restart-ms, or ip link set can0 type can restart") {
    watch.note_error_frame(CAN_ERR_RESTARTED);
    CHECK(watch.state() == CanState::on);
  }
  SECTION("down and up") {
    watch.note_receive(ENETDOWN);
    CHECK(watch.state() == CanState::down);
    watch.note_send(0);
    CHECK(watch.state() == CanState::on);
  }
  CHECK(watch.times_off() == 1);
  watch.note_error_frame(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED);
  CHECK(watch.state() == CanState::on);
  CHECK(watch.times_off() == 2);
}

TEST_CASE("a full queue says nothing of the link, an interface that is gone does") {
  LinkWatch watch;
  for (const int error : {ENOBUFS, EAGAIN, EINTR, 0}) {
    watch.note_send(error);
    watch.note_receive(error);
    CHECK(watch.state() == CanState::on);
  }
  watch.note_receive(ENODEV);
  CHECK(watch.state() == CanState::gone);
  watch.note_send(ENXIO);
  CHECK(watch.state() == CanState::gone);
  watch.note_receive(ENETDOWN);  // there again, and still down
  CHECK(watch.state() == CanState::down);
  watch.note_send(0);
  CHECK(watch.state() == CanState::on);
}

TEST_CASE("the socket tells of a controller that went off the bus and was restarted within one receive") {
  int ends[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends) == 0);
  CanSocket can(ends[0]);
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  frame.can_dlc = CAN_ERR_DLC;
  REQUIRE(::write(ends[1], &frame, sizeof frame) == sizeof frame);
  CHECK(can.receive().empty());
  CHECK(can.state() == CanState::off);
  frame.can_id = CAN_ERR_FLAG | CAN_ERR_RESTARTED;
  REQUIRE(::write(ends[1], &frame, sizeof frame) == sizeof frame);
  CHECK(can.receive().empty());
  CHECK(can.state() == CanState::on);
  for (const canid_t id : {CAN_ERR_BUSOFF, CAN_ERR_RESTARTED}) {
    frame.can_id = CAN_ERR_FLAG | id;
    REQUIRE(::write(ends[1], &frame, sizeof frame) == sizeof frame);
  }
  CHECK(can.receive().empty());
  CHECK(can.state() == CanState::on);
  CHECK(can.times_off() == 2);
  ::close(ends[1]);
}
