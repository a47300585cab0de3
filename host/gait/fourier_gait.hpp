// Gaits of the print's parametrisation (001 section IV): Fourier series as torques in stance, Bezier curves with a
// PD law in flight; 49 parameters and the state at the apex, optimised over splines and closed by shooting with
// derivatives through the events.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "furcula/dynamics/sine_cosine.hpp"
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
  static constexpr std::size_t kDegree = FourierParameters<S>::kDegree;
  using Curve = typename FourierParameters<S>::Curve;

 public:
  explicit FourierLaw(const FourierParameters<S>& p, const FlightGains& gains = {})
      : p_(p),
        gains_(gains),
        rise_{powers(p.rise_hip), powers(p.rise_knee), 1.0 / p.rise_s},
        fall_{powers(p.fall_hip), powers(p.fall_knee), 1.0 / p.fall_s} {}

  Joints2<S> motors(LegPhase phase, const S& time, double, const Joints2<S>& angle,
                    const Joints2<S>& rate) const {
    if (phase == LegPhase::stance) return stance(time);
    const Way& way = phase == LegPhase::rise ? rise_ : fall_;
    const S s = time * way.per_s;
    return {follow(way.hip, s, way.per_s, angle.hip, rate.hip),
            follow(way.knee, s, way.per_s, angle.knee, rate.knee)};
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
    // Multiples of the angle by the sums of angles: one sine and one cosine.
    const auto [s1, c1] = dynamics::sine_cosine(S(p_.omega_radps * time));
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
  S follow(const Curve& curve, const S& s, const S& per_s, const S& angle, const S& rate) const {
    const bool holds = dynamics::value_of(s) > kLast;
    const S at = holds ? S(kLast) : s;
    S value = curve[kDegree], slope(0.0);
    for (std::size_t k = kDegree; k-- > 0;) {
      slope = slope * at + value;
      value = value * at + curve[k];
    }
    const S u = gains_.kp_nmprad * (value - angle) - gains_.kd_nmsprad * rate;
    return holds ? u : S(u + gains_.kd_nmsprad * (slope * per_s));
  }
  /// A Bezier curve's factors of 1, s, s^2, ...
  static Curve powers(Curve c) {
    double ways = 1.0;
    for (std::size_t k = 0; k <= kDegree; ++k) {
      for (std::size_t i = kDegree; i > k; --i) c[i] = c[i] - c[i - 1];
      c[k] = ways * c[k];
      ways *= static_cast<double>(kDegree - k) / static_cast<double>(k + 1);
    }
    return c;
  }

  struct Way {
    Curve hip, knee;
    S per_s;
  };

  FourierParameters<S> p_;
  FlightGains gains_;
  Way rise_, fall_;
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
