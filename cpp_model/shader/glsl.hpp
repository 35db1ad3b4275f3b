// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Shaders in GLSL as SPIR-V, by glslangValidator and spirv-opt.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raypool::shader {

/// The SPIR-V of a file: GLSL, of which the ending names the stage (.rgen, .rchit, .rmiss), or SPIR-V (.spv). Functions
/// are inlined. Throws InputError with file and line for mistakes, and when a tool is missing.
std::vector<uint32_t> spirv_of(const std::string& path);

}  // namespace raypool::shader
