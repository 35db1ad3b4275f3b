// The survivors that have been judged one by one, in a file, against those of a run.
#pragma once

#include <map>
#include <set>
#include <string>

namespace raypool::faulty {

/// What is known of a fault that nothing detects.
struct Judgement {
  bool equivalent = false;  ///< no program runs otherwise than on the sound machine
  std::string reason;
};

class Judgements {
 public:
  /// `path`: a JSON object with a list of {"survivor", "equivalent", "reason"} for each source; empty: nothing is
  /// judged, nor asked for. Throws InputError.
  Judgements(const std::string& path, const std::string& source);

  /// Counts a survivor of this run, and returns what is known of it: "equivalent: ...", "a gap: ...", or "NOT JUDGED".
  std::string survived(const std::string& id);
  int equivalent() const { return equivalent_; }  ///< survivors of this run
  int open() const { return open_; }              ///< not judged
  /// After the last survivor: prints what the file lacks and what it has too much. True if it is up to date.
  bool up_to_date() const;

 private:
  std::string path_;
  std::map<std::string, Judgement> judged_;
  std::set<std::string> survivors_;
  int equivalent_ = 0, open_ = 0;
};

}  // namespace raypool::faulty
