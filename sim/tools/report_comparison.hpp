// Two reports beside each other: what differs between the machines and what they drew, and what that did.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace raypool {

/// A report.json of `raypool sim`.
struct Report {
  std::string path;
  nlohmann::ordered_json json;
};

/// `path`: of a report, or of the folder that has one as report.json. Throws InputError when it is not a report.
Report load_report(const std::string& path);

/// `synthesis`: reports of synthesis, and folders of folders with one; of what lies in folders only reports count, and
/// the newest that fits. Throws InputError when one that is named is none. docs/use/report.md describes the result.
/// `map`: as of compare_pictures().
nlohmann::ordered_json compare_reports(const Report& a, const Report& b, const std::vector<std::string>& synthesis,
                                       const std::string& map = "");

/// The table for people, several lines.
std::string comparison_table(const nlohmann::ordered_json& comparison);

}  // namespace raypool
