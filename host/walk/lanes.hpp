// Rollouts in lanes: eight robots at once, in float. A shared library of its own, built twice: for every x86-64, and for processors with
// AVX2 (x86-64-v3), which the dynamic linker takes by itself where it can (its folder glibc-hwcaps). Both give the same bits.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <span>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// Counters of the walks that were taken: of each lane of an ensemble, else the first alone.
using Taken = std::array<std::atomic<std::size_t>, kEnsemble>;

/// Takes walks until none is left, and writes what each did: of an ensemble that of robot `m` on walk `i` to out[kEnsemble * i + m]. Several
/// threads may do so with one `taken`.
void run_lanes(const dynamics::biped::Description& robot, const RolloutOptions& options,
               std::span<const Parameters> walks, Taken& taken, std::span<Rollout> out);

}  // namespace furcula::walk
