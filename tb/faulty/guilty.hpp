// Does a lockstep's report send its reader to the right place? Where a fault is, and which modules instantiate which.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace raypool::faulty {

/// "warp" of "rp_warp.v": modules are called without their prefix here.
std::string module_of(const std::string& file);

/// Modules and the modules that instantiate them, from the Verilog.
class Hierarchy {
 public:
  explicit Hierarchy(const std::string& rtl_folder);
  /// Modules with an instance of it.
  const std::set<std::string>& parents(const std::string& module) const;
  /// `top` is the module, or has an instance of it somewhere below.
  bool contains(const std::string& top, const std::string& module) const;

 private:
  std::map<std::string, std::set<std::string>> parents_;
};

/// Files that the report's `look at` names first, without folder: before the first semicolon, and at most three. What a
/// simulator prints when it stops counts too.
std::vector<std::string> files_named(const std::string& report);

enum class Verdict { Right, Parent, Wrong, None };

/// Of the files named, against that of the fault: itself, or one that instantiates it.
Verdict judge(const Hierarchy& hierarchy, const std::vector<std::string>& named, const std::string& file);

/// Whether the fault's file is the first or the second of those named.
bool named_early(const std::vector<std::string>& named, const std::string& file);

}  // namespace raypool::faulty
