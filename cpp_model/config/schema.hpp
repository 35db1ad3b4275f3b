// The JSON Schema of configuration files, made from the tables that check them.
#pragma once

#include <string>

namespace raypool {

/// schemas/configuration.json
std::string configuration_schema();

}  // namespace raypool
