// The pictures beside two reports of sim, compared.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/report_comparison.hpp"

namespace raypool {

/// The member `picture` of a comparison (docs/use/report.md). `map`: file that gets the first picture in grey, with a
/// colour for the cause where the second one differs; empty: none. Throws InputError when a map is wanted and cannot be
/// made, or when what lies beside a picture cannot be read.
nlohmann::ordered_json compare_pictures(const Report& a, const Report& b, const std::string& map);

}  // namespace raypool
