#include "faulty/guilty.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "isa/input_error.hpp"

namespace raypool::faulty {
namespace {

constexpr size_t kMostNamed = 3;

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": the file cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::string module_of(const std::string& file) {
  const std::string kPrefix = "rp_";
  const size_t begin = file.compare(0, kPrefix.size(), kPrefix) == 0 ? kPrefix.size() : 0;
  return file.substr(begin, file.rfind('.') - begin);
}

Hierarchy::Hierarchy(const std::string& rtl_folder) {
  std::map<std::string, std::string> modules, headers;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(rtl_folder)) {
    if (entry.path().extension() == ".v") modules[module_of(entry.path().filename())] = read_text(entry.path());
    if (entry.path().extension() == ".vh") headers[entry.path().filename()] = read_text(entry.path());
  }
  static const std::regex kInstance(R"(\n *rp_([a-z_0-9]+) (#\(|[a-z_0-9]+ \())"),
      kInclude(R"re(`include "([a-z_0-9]+\.vh)")re");
  for (const auto& [name, text] : modules) {
    std::string whole = text;
    for (auto i = std::sregex_iterator(text.begin(), text.end(), kInclude); i != std::sregex_iterator(); ++i)
      whole += "\n" + headers[(*i)[1]];
    for (auto i = std::sregex_iterator(whole.begin(), whole.end(), kInstance); i != std::sregex_iterator(); ++i)
      if (modules.count((*i)[1]) != 0) parents_[(*i)[1]].insert(name);
  }
}

const std::set<std::string>& Hierarchy::parents(const std::string& module) const {
  static const std::set<std::string> kNone;
  const auto found = parents_.find(module);
  return found == parents_.end() ? kNone : found->second;
}

bool Hierarchy::contains(const std::string& top, const std::string& module) const {
  if (top == module) return true;
  const std::set<std::string>& above = parents(module);
  return std::any_of(above.begin(), above.end(), [&](const std::string& parent) { return contains(top, parent); });
}

std::vector<std::string> files_named(const std::string& report) {
  static const std::string kLookAt = "look at: ";
  const size_t line = report.find(kLookAt);
  std::string clause = report;
  if (line != std::string::npos) clause = report.substr(line, report.find_first_of(";\n", line) - line);
  if (line == std::string::npos && report.find("%Error") == std::string::npos) return {};
  static const std::regex kFile(R"(rtl/[a-z]+/([a-z_0-9]+\.vh?))");
  std::vector<std::string> files;
  for (auto i = std::sregex_iterator(clause.begin(), clause.end(), kFile); i != std::sregex_iterator(); ++i)
    if (files.size() < kMostNamed && std::find(files.begin(), files.end(), (*i)[1]) == files.end())
      files.push_back((*i)[1]);
  return files;
}

Verdict judge(const Hierarchy& hierarchy, const std::vector<std::string>& named, const std::string& file) {
  if (named.empty()) return Verdict::None;
  if (std::find(named.begin(), named.end(), file) != named.end()) return Verdict::Right;
  const std::set<std::string>& parents = hierarchy.parents(module_of(file));
  const bool parent = std::any_of(named.begin(), named.end(),
                                  [&](const std::string& name) { return parents.count(module_of(name)) != 0; });
  return parent ? Verdict::Parent : Verdict::Wrong;
}

bool named_early(const std::vector<std::string>& named, const std::string& file) {
  constexpr size_t kEarly = 2;
  const auto end = named.begin() + static_cast<std::ptrdiff_t>(std::min(kEarly, named.size()));
  return std::find(named.begin(), end, file) != end;
}

}  // namespace raypool::faulty
