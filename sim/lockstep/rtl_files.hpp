// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where modules are described, for reports that send their reader there.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace raypool::lockstep {

/// "rtl/chip/rp_controller.v, rtl/chip/rp_chip.v" of {"controller", "chip"}: names of modules without their prefix.
/// A name that no module has stays as it is.
std::string rtl_files(std::initializer_list<std::string_view> modules);

}  // namespace raypool::lockstep
