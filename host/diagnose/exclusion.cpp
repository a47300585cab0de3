// One machine or two, see exclusion.hpp.
#include "host/diagnose/exclusion.hpp"

#include <algorithm>
#include <cmath>

#include "host/diagnose/bootstrap.hpp"

namespace furcula::diagnose {
namespace {

/// A fit of all windows but those of one recording, as one of all: those are left what a window of the others is left, a row.
identify::Fit as_of_all(const identify::Fit& without, const std::vector<identify::WindowShare>& all,
                        const std::vector<identify::Window>& windows, std::size_t recording) {
  identify::Fit fit = without;
  fit.shares.clear();
  std::array<identify::ChannelShare, identify::kChannels> others;
  for (std::size_t c = 0; c < identify::kChannels; ++c)
    others[c] = channel(without, static_cast<identify::Channel>(c));
  std::size_t next = 0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (windows[k].recording != recording) {
      fit.shares.push_back(without.shares[next++]);
      continue;
    }
    identify::WindowShare share;
    for (std::size_t c = 0; c < identify::kChannels; ++c) {
      const double rows = all[k].channels[c].rows;
      const double part = others[c].rows > 0.0 ? rows / others[c].rows : 0.0;
      share.channels[c] = {part * others[c].squares, rows, part * others[c].effective_rows};
    }
    fit.shares.push_back(std::move(share));
  }
  return fit;
}

}  // namespace

double log_odds_of_another(const Trainer& trainer, const Selection& selection, const Hypothesis& set,
                           std::size_t recording, const identify::Fit& without) {
  const std::vector<identify::Window>& windows = trainer.training.windows;
  std::vector<identify::Window> others;
  for (const identify::Window& w : windows)
    if (w.recording != recording) others.push_back(w);
  const Hypothesis& chosen = selection.chosen;
  const Units units = units_of(others);
  // As the others scatter among themselves: what is asked is whether the one is of their kind. Each of them is worth one independent number
  // at least, however its rows hang together.
  const double of_unit = channel(chosen.fit, identify::Channel::motion).effective_rows /
                         static_cast<double>(trainer.training.layers * units.size());
  const double misfit = std::min(overdispersion(without, units), std::max(of_unit, 1.0));
  const identify::Fit another = as_of_all(without, chosen.fit.shares, windows, recording);
  const double evidence = evidence_of(chosen.fit, another, chosen.fit, trainer.training.layers);
  const double price = chi_square_point(1.0, static_cast<double>(set.unknowns.size()));
  const double of_another = evidence / misfit + trainer.prior(set.effects) - trainer.prior(chosen.effects) -
                            price + 2.0 * std::log(kOddsOfAnother);
  double of_one = 0.0;  // of the chosen set itself
  for (const Weighed& one : selection.pool) of_one = std::max(of_one, one.evidence / misfit + one.prior);
  return of_another - of_one;
}

}  // namespace furcula::diagnose
