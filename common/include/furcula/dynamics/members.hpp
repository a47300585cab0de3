// Lists of pointers to members, for structs that are walked through member by member.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace furcula::dynamics {

/// Two lists as one of members of `Struct`: first those of its base, then its own.
template <class Struct, class Base, class T, std::size_t N, std::size_t M>
constexpr std::array<T Struct::*, N + M> joined(const std::array<T Base::*, N>& of_base,
                                                const std::array<T Struct::*, M>& own) {
  std::array<T Struct::*, N + M> all{};
  std::size_t next = 0;
  for (const auto member : of_base) all[next++] = member;
  for (const auto member : own) all[next++] = member;
  return all;
}

/// The list if kAll, else an empty one.
template <bool kAll, class Member, std::size_t N>
constexpr auto only_if(const std::array<Member, N>& members) {
  if constexpr (kAll)
    return members;
  else
    return std::array<Member, 0>{};
}

/// Calls `f` with each of the members of a list, expanded at compile time: a loop that the compiler does not unroll would
/// load each pointer.
template <const auto& kMembers, class F>
constexpr void for_each(const F& f) {
  [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) { (f(kMembers[kIndex]), ...); }
  (std::make_index_sequence<kMembers.size()>{});
}

}  // namespace furcula::dynamics
