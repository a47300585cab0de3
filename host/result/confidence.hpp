// What a confidence is lowered by, of machines of every family.
#pragma once

namespace furcula::result {

/// How likely it is that none of the catalogue is the cause, where of what there is to explain names leave this share that a flexible law predicts.
/// Odds by the share: a fifth makes them even. In the blind suite of machines with one joint such names were right less often still, and real
/// machines have more than one cause.
inline double share_of_none(double unnamed_share) {
  constexpr double kOddsByShare = 5.0;
  const double odds = kOddsByShare * unnamed_share;
  return odds / (1.0 + odds);
}

}  // namespace furcula::result
