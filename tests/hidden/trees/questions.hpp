// Which causes a run of the blind suite asks about.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/hidden/trees/cases.hpp"

namespace furcula::hidden::trees {

/// `cases` questions, the tiers mixed so that a run that is cut short has asked of all. Effects come round in an
/// order that the seed decides. Empty `tiers`: all, but with an `effect` only those that plant it. Of legs
/// none is `tied` or `triple`.
std::vector<Question> draw_questions(std::uint64_t seed, std::size_t cases, std::vector<Tier> tiers,
                                     const std::string& effect, std::size_t joints, bool brief,
                                     bool leg = false);

}  // namespace furcula::hidden::trees
