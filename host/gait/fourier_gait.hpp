// Gaits of the print's parametrisation (001 section IV): Fourier series as torques in stance, Bezier curves with a
// PD law in flight; 49 parameters and the state at the apex, optimised over splines and closed by shooting with
// derivatives through the events.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "host/gait/free_gait.hpp"
#include "host/gait/free_law.hpp"
#include "host/gait/stride.hpp"

namespace furcula::gait {

/// S is the scalar of the parameters.
template <class S>
struct FourierParameters {
  static constexpr std::size_t kOrder = 5, kDegree = 5, kCount = 49;
  struct Series {
    S mean{};
    std::array<S, kOrder> sine{}, cosine{};
  };
  using Curve = std::array<S, kDegree + 1>;

  S omega_radps{};
  Series hip, knee;
  Curve rise_hip{}, rise_knee{}, fall_hip{}, fall_knee{};
  S rise_s{}, fall_s{};  ///< what the curves' arguments are divided by; on the gait the durations

  /// In the order omega, hip's and knee's series (mean, sines, cosines), curves of rise and fall, durations.
  std::array<S, kCount> values() const {
    std::array<S, kCount> out;
    std::size_t n = 0;
    const_cast<FourierParameters*>(this)->each([&](S& v) { out[n++] = v; });
    return out;
  }
  static FourierParameters of(const std::array<S, kCount>& values) {
    FourierParameters p;
    std::size_t n = 0;
    p.each([&](S& v) { v = values[n++]; });
    return p;
  }
  template <class F>
  void each(const F& f) {
    f(omega_radps);
    for (Series* s : {&hip, &knee}) {
      f(s->mean);
      for (S& v : s->sine) f(v);
      for (S& v : s->cosine) f(v);
    }
    for (Curve* c : {&rise_hip, &rise_knee, &fall_hip, &fall_knee})
      for (S& v : *c) f(v);
    f(rise_s);
    f(fall_s);
  }
};

template <class S>
class FourierLaw {
 public:
  explicit FourierLaw(const FourierParameters<S>& p, const FlightGains& gains = {}) : p_(p), gains_(gains) {}

  Joints2<S> motors(LegPhase phase, const S& time, double, const Joints2<S>& angle,
                    const Joints2<S>& rate) const {
    if (phase == LegPhase::stance) return stance(time);
    const bool rises = phase == LegPhase::rise;
    const S& duration = rises ? p_.rise_s : p_.fall_s;
    const S s = time / duration;
    return {follow(rises ? p_.rise_hip : p_.fall_hip, s, duration, angle.hip, rate.hip),
            follow(rises ? p_.rise_knee : p_.fall_knee, s, duration, angle.knee, rate.knee)};
  }
  std::vector<double> breaks(LegPhase phase) const {
    if (phase == LegPhase::stance) return {};
    return {kLast * dynamics::value_of(phase == LegPhase::rise ? p_.rise_s : p_.fall_s)};
  }
  const FourierParameters<S>& parameters() const { return p_; }

 private:
  /// The curves run on past their end, so that no kink lies on the gait itself, and then hold.
  static constexpr double kLast = 1.25;

  Joints2<S> stance(const S& time) const {
    using std::cos;
    using std::sin;
    // Multiples of the angle by the sums of angles: one sine and one cosine.
    const S angle = p_.omega_radps * time;
    const S s1 = sin(angle), c1 = cos(angle);
    S s = s1, c = c1;
    Joints2<S> u{p_.hip.mean, p_.knee.mean};
    for (std::size_t n = 0; n < FourierParameters<S>::kOrder; ++n) {
      u.hip = u.hip + p_.hip.sine[n] * s + p_.hip.cosine[n] * c;
      u.knee = u.knee + p_.knee.sine[n] * s + p_.knee.cosine[n] * c;
      const S next = s * c1 + c * s1;
      c = c * c1 - s * s1;
      s = next;
    }
    return u;
  }
  S follow(const typename FourierParameters<S>::Curve& curve, const S& s, const S& duration, const S& angle,
           const S& rate) const {
    S wanted{}, wanted_rate{};
    const bool holds = dynamics::value_of(s) > kLast;
    bezier(curve, holds ? S(kLast) : s, wanted, wanted_rate);
    S u = gains_.kp_nmprad * (wanted - angle) - gains_.kd_nmsprad * rate;
    if (!holds) u = u + gains_.kd_nmsprad * (wanted_rate / duration);
    return u;
  }
  /// de Casteljau's way: value and derivative by s.
  static void bezier(const typename FourierParameters<S>::Curve& curve, const S& s, S& value, S& slope) {
    constexpr std::size_t n = FourierParameters<S>::kDegree;
    typename FourierParameters<S>::Curve c = curve;
    const S rest = 1.0 - s;
    for (std::size_t level = n; level > 1; --level)
      for (std::size_t i = 0; i < level; ++i) c[i] = rest * c[i] + s * c[i + 1];
    slope = static_cast<double>(n) * (c[1] - c[0]);
    value = rest * c[0] + s * c[1];
  }

  FourierParameters<S> p_;
  FlightGains gains_;
};

struct FourierGait {
  FourierParameters<double> law;
  Apex<double> apex;
  double cost = 0.0;
};

struct FourierResult {
  bool found = false;
  std::string status, worst;
  double violation = 0.0;
  int iterations = 0;
  double closure = 0.0;  ///< largest difference of a state after a stride
  FourierGait gait;
};

/// The parameters that come nearest to a gait of free torques.
FourierGait fourier_near(const Machine& machine, const FreeGait& gait);

struct FourierOptions {
  std::size_t stance_intervals = 24, flight_intervals = 10;
  int iterations = 300;
  double omega_factor = 1.0;  ///< of the series' base frequency to begin with
  std::function<bool(int iteration, double cost, double violation)> progress;
};
/// From a gait of free torques of the same task: first over splines, then by shooting until it closes.
FourierResult find_fourier_gait(const Machine& machine, const Task& task, const FreeGait& start,
                                const FourierOptions& options);

}  // namespace furcula::gait
