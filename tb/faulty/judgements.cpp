#include "faulty/judgements.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "isa/input_error.hpp"

namespace raypool::faulty {

Judgements::Judgements(const std::string& path, const std::string& source) : path_(path) {
  if (path.empty()) return;
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: the judged survivors cannot be read", path));
  try {
    const nlohmann::json all = nlohmann::json::parse(file);
    for (const auto& entry : all.at(source))
      judged_[entry.at("survivor").get<std::string>()] = {entry.at("equivalent").get<bool>(),
                                                          entry.at("reason").get<std::string>()};
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: no list {} of {{survivor, equivalent, reason}}: {}", path, source, error.what()));
  }
}

std::string Judgements::survived(const std::string& id) {
  survivors_.insert(id);
  const auto judged = judged_.find(id);
  if (judged == judged_.end()) {
    ++open_;
    return "NOT JUDGED";
  }
  equivalent_ += judged->second.equivalent;
  return (judged->second.equivalent ? "equivalent: " : "a gap: ") + judged->second.reason;
}

bool Judgements::up_to_date() const {
  int stale = 0;
  for (const auto& [id, judgement] : judged_) {
    if (survivors_.count(id) != 0) continue;
    ++stale;
    fmt::print("stale: \"{}\" is in {} and did not survive\n", id, path_);
  }
  if (path_.empty() || (open_ == 0 && stale == 0)) return true;
  fmt::print("{} is not up to date: {} survivors are not judged, {} entries are stale\n", path_, open_, stale);
  return false;
}

}  // namespace raypool::faulty
