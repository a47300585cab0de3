#include "host/diagnose/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/identify/informative_windows.hpp"

namespace furcula::diagnose {

using identify::Channel;
using identify::Errors;
using identify::Recording;
using identify::Window;

std::string channel_name(Channel channel) {
  return channel == Channel::contact ? "contact"
         : channel == Channel::drive ? "torque"
         : channel == Channel::leg   ? "leg_angle"
                                     : "";
}

double explained_share(double before, double after, double floor) {
  constexpr double kNothing = 1e-3;  // of what there was: the floor is not known better
  const double explainable = before - floor;
  return explainable > kNothing * before ? std::clamp((before - after) / explainable, -9.99, 1.0) : 0.0;
}

HeldOut::HeldOut(const std::vector<Recording>& recordings, std::vector<Window> windows,
                 const model::Model& reference)
    : recordings_(recordings),
      position_(identify::channel_names(reference.kind).position),
      windows_(std::move(windows)) {
  constexpr std::size_t kMostRowsOfSample = 24'000, kFewestOfSample = 24;
  sample_ = identify::evenly(windows_, kMostRowsOfSample, kFewestOfSample);
  starts_ = identify::start_states(recordings_, windows_, reference);
  sample_starts_ = identify::start_states(recordings_, sample_, reference);
}

Errors HeldOut::errors(const model::Model& m) const {
  Errors errors = identify::prediction_errors(m, recordings_, windows_, starts_);
  if (const auto contact = identify::contact_errors(m, recordings_, windows_))
    errors[channel_name(Channel::contact)] = *contact;
  if (const auto drive = identify::drive_errors(m, recordings_, windows_))
    errors[channel_name(Channel::drive)] = *drive;
  if (const auto leg = identify::leg_angle_errors(m, recordings_, windows_, starts_))
    errors[channel_name(Channel::leg)] = *leg;
  return errors;
}

Errors HeldOut::noise_floor(const model::Model& m) const {
  return identify::noise_floor(m, recordings_, windows_, starts_);
}

std::vector<identify::ErrorSums> HeldOut::sums(const model::Model& m, Channel channel) const {
  return channel == Channel::contact ? identify::contact_sums(m, recordings_, windows_)
         : channel == Channel::drive ? identify::drive_sums(m, recordings_, windows_)
         : channel == Channel::leg   ? identify::leg_angle_sums(m, recordings_, windows_, starts_)
                                     : identify::position_sums(m, recordings_, windows_, starts_);
}

double HeldOut::sample_nmse(const model::Model& m) const {
  return nmse(identify::prediction_errors(m, recordings_, sample_, sample_starts_));
}

double HeldOut::sample_noise_floor(const model::Model& m) const {
  return nmse(identify::noise_floor(m, recordings_, sample_, sample_starts_));
}

double HeldOut::nmse(const Errors& e) const { return e.at(position_).nmse; }

double HeldOut::resolution(Channel channel) const {
  if (channel == Channel::contact) {
    for (const Window& w : windows_)
      if (std::isfinite(w.report_lag_s)) return w.report_spread_s;
    return 0.0;
  }
  if (channel == Channel::leg) {
    for (const Recording& r : recordings_)
      if (!r.leg_angle.empty()) return r.leg_angle_noise;
    return 0.0;
  }
  return recordings_.front().drive_noise;
}

}  // namespace furcula::diagnose
