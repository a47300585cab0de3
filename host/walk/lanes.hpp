// Rollouts in lanes: eight robots at once, sixteen with AVX-512, in float. A shared library of its own, built for several kinds of x86-64
// (furcula_lanes in host/CMakeLists.txt): the dynamic linker takes the one for the processor. All give the same bits.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/member.hpp"
#include "host/walk/trace.hpp"

namespace furcula::walk {

/// Takes jobs from `next` on until none is left, and writes what each did. Several threads may do so with one `next`. `members`
/// are the ensemble, each with the controller of `robot`; without them the jobs are `robot`'s.
void run_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
               const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
               std::span<Rollout> out);

/// The same with what each measures, every so many ticks.
void trace_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
                 const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
                 long ticks_a_row, std::span<Trace> out);

}  // namespace furcula::walk
