// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which words of an intersection kernels need, and the compact record that holds no others.
#pragma once

#include <vector>

#include "kernel/intermediate.hpp"
#include "machine/common/packages.hpp"

namespace raypool::kernel {

/// The layout of the record for these kernels, recorded with whole intersections. A word is needed if one of them reads
/// it, or exports it without having written it. Words of the ray stay where they are, since an export takes them from
/// there; words of the hit fill the places of those that no kernel needs, where no kernel writes these before it has
/// read them, then those behind the ray.
RecordLayout compact_layout(const std::vector<Function>& kernels);

/// A kernel that was recorded with whole intersections then has its words where the layout has them, without reads of
/// absent words whose value nothing uses. Throws InputError for another word that the layout lacks.
void place_words(Function& kernel, const RecordLayout& layout);

}  // namespace raypool::kernel
