// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Fields of a configuration by name, as `--set FIELD=VALUE` changes them: every field that a configuration file may
// hold, of the unit and of the chip.
#pragma once

#include <string>
#include <vector>

#include "config/parameter_table.hpp"

namespace raypool {

struct ConfigurationField {
  std::string path;  ///< "warps", "alus.flt.count", "chip.ray_pool.size"
  Range range;
};

/// All but the name, in the order of the tables.
std::vector<ConfigurationField> fields();

/// Where a configuration file has the field of this path.
nlohmann::ordered_json::json_pointer pointer_to(std::string path);

/// Puts "FIELD=VALUE" into `json`, the content of a configuration file; one text may hold several, with spaces between.
/// Values of another type than the field's are refused; whether the value is possible is checked when the file is read.
/// Throws InputError, which names the nearest fields when there is none such.
void set_fields(nlohmann::ordered_json& json, const std::vector<std::string>& texts);

/// The paths that `texts` set, each once, in the order of fields(), "name" first.
std::vector<std::string> paths_set(const std::vector<std::string>& texts);

/// The value of a field as people read it; of a configuration that is written with all of them.
std::string value_text(const nlohmann::ordered_json& configuration, const std::string& path);

}  // namespace raypool
