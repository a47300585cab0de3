// What a node on the CAN bus does about a desk's command frames.
#pragma once

#include "firmware/app/can_link.hpp"
#include "firmware/app/node.hpp"

namespace furcula::firmware {

/// A command of the desk's stream, if one came.
void obey_stream(auto& link, auto& node) {
  const CanRequest heard = link.take_request();
  if (!heard.came) return;
  static_cast<void>(node.stream({.request = static_cast<bus::Request>(heard.kind),
                                 .torque_amplitude_nm = heard.torque_amplitude_nm,
                                 .torque_period_s = heard.torque_period_s,
                                 .release_in_flight = heard.release_in_flight}));
}

}  // namespace furcula::firmware
