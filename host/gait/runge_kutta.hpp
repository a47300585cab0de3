// One step of Dormand and Prince's Runge-Kutta method of order 8 (the twelve stages of Hairer, Noersett and
// Wanner's DOP853), for checks that owe nothing to how a gait was found.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::gait {

namespace detail {

inline constexpr std::size_t kStages = 12;
inline constexpr std::array<double, kStages> kNode{0.0,
                                                   0.526001519587677318785587544488e-01,
                                                   0.789002279381515978178381316732e-01,
                                                   0.118350341907227396726757197510,
                                                   0.281649658092772603273242802490,
                                                   0.333333333333333333333333333333,
                                                   0.25,
                                                   0.307692307692307692307692307692,
                                                   0.651282051282051282051282051282,
                                                   0.6,
                                                   0.857142857142857142857142857142,
                                                   1.0};
using Row = std::array<double, kStages>;
inline constexpr std::array<Row, kStages> kStage{
    {{},
     {5.26001519587677318785587544488e-2},
     {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
     {2.95875854768068491816892993775e-2, 0.0, 8.87627564304205475450678981324e-2},
     {2.41365134159266685502369798665e-1, 0.0, -8.84549479328286085344864962717e-1,
      9.24834003261792003115737966543e-1},
     {3.7037037037037037037037037037e-2, 0.0, 0.0, 1.70828608729473871279604482173e-1,
      1.25467687566822425016691814123e-1},
     {3.7109375e-2, 0.0, 0.0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2,
      -1.7578125e-2},
     {3.70920001185047927108779319836e-2, 0.0, 0.0, 1.70383925712239993810214054705e-1,
      1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2,
      8.27378916381402288758473766002e-3},
     {6.24110958716075717114429577812e-1, 0.0, 0.0, -3.36089262944694129406857109825,
      -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1,
      2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1},
     {4.77662536438264365890433908527e-1, 0.0, 0.0, -2.48811461997166764192642586468,
      -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1,
      1.52792336328824235832596922938e1, -3.32882109689848629194453265587e1,
      -2.03312017085086261358222928593e-2},
     {-9.3714243008598732571704021658e-1, 0.0, 0.0, 5.18637242884406370830023853209,
      1.09143734899672957818500254654, -8.14978701074692612513997267357, -1.85200656599969598641566180701e1,
      2.27394870993505042818970056734e1, 2.49360555267965238987089396762, -3.0467644718982195003823669022},
     {2.27331014751653820792359768449, 0.0, 0.0, -1.05344954667372501984066689879e1,
      -2.00087205822486249909675718444, -1.79589318631187989172765950534e1, 2.79488845294199600508499808837e1,
      -2.85899827713502369474065508674, -8.87285693353062954433549289258, 1.23605671757943030647266201528e1,
      6.43392746015763530355970484046e-1}}};
inline constexpr Row kWeight{5.42937341165687622380535766363e-2,
                             0.0,
                             0.0,
                             0.0,
                             0.0,
                             4.45031289275240888144113950566,
                             1.89151789931450038304281599044,
                             -5.8012039600105847814672114227,
                             3.1116436695781989440891606237e-1,
                             -1.52160949662516078556178806805e-1,
                             2.01365400804030348374776537501e-1,
                             4.47106157277725905176885569043e-2};

/// Numbers with many derivatives take their time in themselves: for them nothing is laid out stage by stage, which a compiler
/// would take minutes for.
template <class T, std::size_t N>
std::array<T, N> moved(const std::array<T, N>& state, const std::array<std::array<T, N>, kStages>& k,
                       const Row& by, const T& h, std::size_t count) {
  std::array<T, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = by[0] * k[0][i];
  for (std::size_t j = 1; j < count; ++j) {
    if (by[j] == 0.0) continue;
    for (std::size_t i = 0; i < N; ++i) out[i] = out[i] + by[j] * k[j][i];
  }
  for (std::size_t i = 0; i < N; ++i) out[i] = state[i] + h * out[i];
  return out;
}
/// The state plus h times the sum of the stages before `kUpTo`; of all, by their weights, where that is kStages.
template <std::size_t kUpTo, class T, std::size_t N>
std::array<T, N> moved(const std::array<T, N>& state, const std::array<std::array<T, N>, kStages>& k,
                       const T& h) {
  constexpr Row kBy = kUpTo < kStages ? kStage[kUpTo < kStages ? kUpTo : 0] : kWeight;
  std::array<T, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = kBy[0] * k[0][i];
  const auto add = [&]<std::size_t J>(std::integral_constant<std::size_t, J>) {
    if constexpr (kBy[J] != 0.0)
      for (std::size_t i = 0; i < N; ++i) out[i] = out[i] + kBy[J] * k[J][i];
  };
  [&]<std::size_t... J>(std::index_sequence<J...>) {
    (add(std::integral_constant<std::size_t, J + 1>{}), ...);
  }
  (std::make_index_sequence<kUpTo - 1>{});
  for (std::size_t i = 0; i < N; ++i) out[i] = state[i] + h * out[i];
  return out;
}

}  // namespace detail

/// The state `h` after `time`, where its rates are `first`; f(time, state) -> rates.
template <class T, std::size_t N, class F>
std::array<T, N> runge_kutta_8(const T& time, const std::array<T, N>& state, const std::array<T, N>& first,
                               const T& h, const F& f) {
  std::array<std::array<T, N>, detail::kStages> k;
  k[0] = first;
  if constexpr (!std::is_floating_point_v<T>) {
    for (std::size_t s = 1; s < detail::kStages; ++s)
      k[s] = f(T(time + detail::kNode[s] * h), detail::moved(state, k, detail::kStage[s], h, s));
    return detail::moved(state, k, detail::kWeight, h, detail::kStages);
  } else {
    [&]<std::size_t... S>(std::index_sequence<S...>) {
      ((k[S + 1] = f(T(time + detail::kNode[S + 1] * h), detail::moved<S + 1>(state, k, h))), ...);
    }
    (std::make_index_sequence<detail::kStages - 1>{});
    return detail::moved<detail::kStages>(state, k, h);
  }
}
template <class T, std::size_t N, class F>
std::array<T, N> runge_kutta_8(const T& time, const std::array<T, N>& state, const T& h, const F& f) {
  return runge_kutta_8<T, N>(time, state, f(time, state), h, f);
}

}  // namespace furcula::gait
