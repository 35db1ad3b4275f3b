#include "explore/area_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "config/data_folder.hpp"
#include "config/limits.hpp"
#include "config/settings.hpp"

namespace raypool::explore {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kRoot = "sqrt(", kTimes = " * ";

/// Of a field as a configuration is written; units are none of its fields.
double number_of(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
  return value.get<double>();
}

}  // namespace

AreaTable::AreaTable(const std::string& text, const std::string& file) : file_(file) {
  try {
    const Json json = Json::parse(text);
    for (const Json& row : json.at("blocks")) {
      Block block;
      block.of_unit = row.at("scope") == "unit";
      for (const auto& [name, mm2] : row.at("mm2").items()) {
        Term term;
        term.mm2 = mm2.get<double>();
        std::string_view factors = name;
        term.root = factors.substr(0, kRoot.size()) == kRoot && factors.back() == ')';
        if (term.root) factors = factors.substr(kRoot.size(), factors.size() - kRoot.size() - 1);
        while (!factors.empty()) {
          const size_t end = std::min(factors.find(kTimes), factors.size());
          const std::string_view factor = factors.substr(0, end);
          const size_t equals = factor.find('=');
          if (equals != factor.npos)
            term.factors.push_back({std::string(factor.substr(0, equals)), std::string(factor.substr(equals + 1))});
          else if (factor != "1")
            term.factors.push_back({std::string(factor), ""});
          factors.remove_prefix(std::min(factors.size(), end + kTimes.size()));
        }
        block.terms.push_back(std::move(term));
      }
      blocks_.push_back(std::move(block));
    }
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{} is not a table of areas: {}; make areas makes one", file, error.what()));
  }
}

double AreaTable::area_of(const Configuration& configuration, uint32_t units) const {
  const Json json = Json::parse(to_json(configuration));
  const auto value_of = [&](const Factor& factor) -> double {
    if (factor.field == "units") return units;
    // As many as there can be: the field may hold more.
    if (factor.field == "slow_lanes") return std::min(configuration.slow_lanes, configuration.lanes);
    const auto place = pointer_to(factor.field);
    if (!json.contains(place))
      throw InputError(fmt::format("{}: '{}' is not a field of a configuration", file_, factor.field));
    return factor.value.empty() ? number_of(json[place]) : json[place] == factor.value ? 1 : 0;
  };
  double area = 0;
  for (const Block& block : blocks_) {
    if (units == 0 && !block.of_unit) continue;
    for (const Term& term : block.terms) {
      double product = 1;
      for (const Factor& factor : term.factors) product *= value_of(factor);
      area += term.mm2 * (term.root ? std::sqrt(product) : product) * (block.of_unit ? std::max(units, 1u) : 1);
    }
  }
  return area;
}

std::string area_table_path() { return data_folder() + "/configs/areas/osu018.json"; }

}  // namespace raypool::explore
