// The cases: a rig with hidden causes drawn from a seed, its recordings, and the model that the diagnosis
// gets, which does not know of them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "tests/hidden/laws.hpp"
#include "tests/hidden/machine.hpp"
#include "tests/hidden/rig.hpp"

namespace furcula::hidden {

/// How large the planted effect is: see sizes.cpp. Small is near what the sensors let one see, large is
/// plain.
enum class Size { small, medium, large };

/// How far the model's free parameters are from the truth.
enum class Nominal {
  scattered,  ///< drawn: a mass within 3 %, a damping within 10 %
  exact,      ///< not at all
  wrong       ///< each by 5 %, up or down
};

/// What the suite asks in groups.
enum class Tier { large, medium, small, pairs, clean, outside };
inline constexpr Tier kTiers[] = {Tier::large, Tier::medium, Tier::small,
                                  Tier::pairs, Tier::clean,  Tier::outside};

struct Question {
  std::uint64_t seed = 0;
  Kind kind = Kind::hopper_linear;
  std::vector<std::string> laws;  ///< none: a clean case
  Size size = Size::medium;       ///< of each; causes outside of the catalogue have one size
  Nominal nominal = Nominal::scattered;
  bool more_columns = false;  ///< some cases get the optional columns that the kind's rig can log
  bool clutched = false;   ///< a hopper with a clutch, which one that a clutch's law is asked of has anyway
  bool disturbed = false;  ///< by random forces, impacts and ground, of which the sizes are drawn
  bool manoeuvre = false;  ///< a hopper folds its leg in flight, its spring let go meanwhile if clutched
};

struct Case {
  Question question;
  Kind kind = Kind::hopper_linear;
  Size size = Size::medium;
  Truth truth;           ///< `truth.planted` are the hidden causes
  model::Model model;    ///< nominal; some of its parameters free
  bool weighed = false;  ///< hopper: the mass is known and held
  bool ground_pulled = false;
  double resolution = 0.0;     ///< one count of the position sensor, m or rad
  double typical_input = 0.0;  ///< axes: RMS of the command without the effect, N or N m
  double top_speed = 0.0;      ///< axes: 95 % of the samples are slower, m/s or rad/s
  std::vector<log::Log> training, held_out;
  std::vector<Trajectory> held_out_truth;  ///< what really happened while `held_out` was recorded

  /// Whether a cause outside of the catalogue is planted.
  bool outside() const;
  /// One line: seed, kind, effects, size and the true values.
  std::string description() const;
};

std::string_view name(Size size);
std::string_view name(Nominal nominal);
std::string_view name(Tier tier);

/// The same case for the same question, always. Each law must be one that the kind can have.
Case draw_case(const Question& question);
Case draw_case(std::uint64_t seed, Kind kind, std::string_view law, Size size = Size::medium);
Case draw_clean_case(std::uint64_t seed, Kind kind);

/// The suite's `index`-th question of a tier: its seed is `seed + index`, and the laws and kinds that the
/// catalogue of this build knows come round in an order that `seed` decides. `kind_name` and `law` restrict
/// them; empty: all. No laws where there are none to ask (a tier of effects is then a clean case).
Question question_of(Tier tier, std::uint64_t seed, std::uint64_t index, std::string_view kind_name = {},
                     std::string_view law = {});

}  // namespace furcula::hidden
