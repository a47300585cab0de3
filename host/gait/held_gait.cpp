#include "host/gait/held_gait.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "host/core/error.hpp"

namespace furcula::gait {
namespace {

using Number = identify::Dual<6>;

/// The angles of a stance as the integrator plays it, where the law has no path of its own.
JointPath played_stance(const Gait& gait) {
  constexpr std::size_t kIntervals = 24, kValues = 6 * kIntervals;
  StrideOptions options;
  options.lift_off = gait.task.lift_off;
  options.longest_step_s = 1e-3;
  options.energies = false;
  const double duration = stride_of(gait, options).stance;
  auto& times = options.samples[static_cast<std::size_t>(LegPhase::stance)];
  for (std::size_t i = 1; i < kValues; ++i)
    times.push_back(duration * static_cast<double>(i) / static_cast<double>(kValues));
  std::optional<Joints2<double>> first;
  Joints2<double> last;
  options.moment = [&](const Moment& m) {
    if (m.phase != LegPhase::stance) return;
    if (!first) first = m.angle;
    last = m.angle;
  };
  const StrideEnd<double> end = stride_of(gait, options);
  const auto& samples = end.samples[static_cast<std::size_t>(LegPhase::stance)];
  if (!end.whole || samples.size() + 1 != kValues)
    throw core::DataError("the gait makes no stride: " + std::string(end.why));
  std::vector<double> hip{first->hip}, knee{first->knee};
  for (const auto& s : samples) {
    hip.push_back(s.angle.hip);
    knee.push_back(s.angle.knee);
  }
  hip.push_back(last.hip);
  knee.push_back(last.knee);
  const Spline spline(kIntervals);
  return {duration, spline.fitted(hip), spline.fitted(knee)};
}

}  // namespace

HeldGait::HeldGait(const Gait& gait, const StanceGains& gains) : gait_(gait), gains_(gains) {
  if (const auto* free = std::get_if<FreeGait>(&gait_.motion)) {
    free_.emplace(gait_.machine, *free);
    path_.add(free->stance(), 0.0);
  } else {
    fourier_.emplace(std::get<FourierGait>(gait_.motion).law);
    path_.add(played_stance(gait_), 0.0);
  }
}

Apex<double> HeldGait::apex() const {
  return free_ ? free_->apex() : std::get<FourierGait>(gait_.motion).apex;
}

StrideEnd<double> HeldGait::stride(const Apex<double>& from, const StrideOptions& options) const {
  return with_law(
      [&](const auto& law) { return run_stride<double>(gait_.machine, law, law, from, options); });
}

std::vector<std::complex<double>> HeldGait::multipliers() const {
  StrideOptions options;
  options.lift_off = gait_.task.lift_off;
  options.energies = false;
  const auto values = apex().values();
  std::array<Number, 6> start;
  for (std::size_t i = 0; i < 6; ++i) start[i] = Number(values[i], static_cast<int>(i));
  const Apex<Number> from = Apex<Number>::of(start);
  std::array<Number, 6> end;
  if (free_) {
    const HeldLaw<FreeLaw> law(*free_, path_, gains_);
    end = run_stride<Number>(gait_.machine, law, law, from, options).apex.values();
  } else {
    const auto plain = fourier_->parameters().values();
    std::array<Number, FourierParameters<Number>::kCount> full;
    std::copy(plain.begin(), plain.end(), full.begin());
    const FourierLaw<Number> own(FourierParameters<Number>::of(full));
    const HeldLaw<FourierLaw<Number>> law(own, path_, gains_);
    const HeldLaw<FourierLaw<double>> plain_law(*fourier_, path_, gains_);
    end = run_stride<Number>(gait_.machine, law, plain_law, from, options).apex.values();
  }
  Eigen::Matrix<double, 6, 6> map;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      map(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = end[i].derivative(j);
  std::vector<std::complex<double>> out;
  if (!map.allFinite()) return out;
  const Eigen::Matrix<std::complex<double>, 6, 1> found = map.eigenvalues();
  out.assign(found.data(), found.data() + 6);
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  return out;
}

}  // namespace furcula::gait
