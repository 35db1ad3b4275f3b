// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Mistyped names: the nearest right ones, and how a message asks for them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raypool {

/// Letters that must be changed, added, removed, or swapped with the next one, to turn `a` into `b`.
size_t spelling_distance(std::string_view a, std::string_view b);

/// Whether a name at this distance can be what the user meant: about a letter in three is wrong.
bool is_misspelling(std::string_view given, size_t distance);

/// The names with the least distance to `given`, in their order. Case does not count, and a name may be cut short.
/// Empty if no name is near enough.
std::vector<std::string> nearest_names(std::string_view given, const std::vector<std::string>& names);

/// The end of a refusal: ": did you mean asm or isa? (`advice`)", with at most three names, or "; `advice`" without.
/// `advice` may be empty.
std::string did_you_mean(const std::vector<std::string>& nearest, std::string_view advice);

/// The same for the nearest of `names`.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& names, std::string_view advice);

}  // namespace raypool
