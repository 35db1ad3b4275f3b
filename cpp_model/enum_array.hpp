// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// An array that has an element for each member of an enumeration, 0 to Count - 1, and
// is indexed by them; by numbers too.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

namespace raypool {

template <typename Enum, typename T, size_t Count>
struct EnumArray : std::array<T, Count> {
  using std::array<T, Count>::operator[];
  constexpr T& operator[](Enum member) { return (*this)[static_cast<size_t>(member)]; }
  constexpr const T& operator[](Enum member) const { return (*this)[static_cast<size_t>(member)]; }
};

/// The number of a member.
template <typename Enum>
constexpr std::underlying_type_t<Enum> to_underlying(Enum member) {
  return static_cast<std::underlying_type_t<Enum>>(member);
}

}  // namespace raypool
