// What a node on the CAN bus does about a host's command frames.
#pragma once

#include "firmware/app/can_link.hpp"
#include "firmware/app/node.hpp"

namespace furcula::firmware {

/// What came as command frames since the last tick: a stop first, then the host's stream.
void obey_stream(auto& link, auto& node) {
  const CanRequest heard = link.take_request();
  if (heard.stop_apart || heard.stop_again) node.stop_from_anyone(heard.stop_apart);
  if (heard.came)
    static_cast<void>(node.stream({.request = static_cast<bus::Request>(heard.kind),
                                   .torque_amplitude_nm = heard.torque_amplitude_nm,
                                   .torque_period_s = heard.torque_period_s,
                                   .release_in_flight = heard.release_in_flight,
                                   .follows = heard.follows}));
  if (heard.hop_said) node.note_hop_said();
}

/// Right before a tick, on a board that does behind it what else was asked for: a stop does not wait, neither one of
/// a stream nor one that asks by the registers and is answered later.
void obey_stop(auto& link, auto& node) {
  if (link.registers().stop_waits()) node.stop_from_anyone(false);
  if (link.stop_waits()) obey_stream(link, node);
}

}  // namespace furcula::firmware
