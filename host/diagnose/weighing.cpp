#include "host/diagnose/weighing.hpp"

#include <algorithm>
#include <vector>

#include "host/diagnose/bootstrap.hpp"

namespace furcula::diagnose {

Weighing::Weighing(const SearchState& s)
    : s_(s), misfit_(overdispersion(s.chosen.fit, units_of(s.trainer.training.windows))) {
  const bool slips = std::any_of(s.trainer.recordings.begin(), s.trainer.recordings.end(),
                                 [](const identify::Recording& r) { return !r.slips.empty(); });
  if (slips) return;
  std::vector<identify::Window> apart;  // of overlapping ones
  for (const identify::Window& w : s.trainer.training.windows)
    if (apart.empty() || apart.back().recording != w.recording || w.first >= apart.back().last)
      apart.push_back(w);
  disturbed_ = evidence_under_disturbances(s.chosen.fitted, s.trainer.recordings, apart);
}

double Weighing::evidence_for(const Hypothesis& h, const std::optional<double>& of_motion) const {
  if (!of_motion) return s_.trainer.evidence_over(s_.chosen, h) / misfit_;
  return *of_motion +
         evidence_of(s_.chosen.fit, h.fit, s_.chosen.fit, s_.trainer.training.layers, false) / misfit_;
}

double Weighing::odds_for(const Hypothesis& h, const std::optional<double>& of_motion) const {
  return evidence_for(h, of_motion) + s_.trainer.prior(h.effects) - s_.trainer.prior(s_.chosen.effects);
}

bool Weighing::as_good(const Hypothesis& h) const {
  const std::optional<double> motion = of_motion(h);
  return the_same(h, s_.chosen) || odds_for(h, motion) > -kEqualEvidence ||
         (!motion && s_.trainer.preference(h, s_.chosen) < kEqualEvidence);
}

}  // namespace furcula::diagnose
