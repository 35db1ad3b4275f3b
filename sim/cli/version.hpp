// The version, as reports and CHANGELOG.md name it.
#pragma once

namespace raypool {
inline constexpr const char* kVersion = "0.1.0";
}  // namespace raypool
