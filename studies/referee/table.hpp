// The contenders' answers to a corpus, beside its certificates: a row each.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "referee/contender.hpp"
#include "referee/judge.hpp"

namespace raypool::referee {

/// The smallest case of a fault that was found.
struct Failing {
  uint64_t count = 0;
  HitCase smallest;  ///< of those as drawn, or minimised
  HitAnswer answer;  ///< to it
};

struct Row {
  std::string name;
  uint64_t cases = 0;
  Failing faults[kFaults];
  uint64_t times = 0;                                 ///< right hits
  double median = 0, percentile_99 = 0, largest = 0;  ///< errors of t, in units in the last place

  const Failing& of(Fault fault) const { return faults[static_cast<size_t>(fault)]; }
  uint64_t wrong() const {
    return of(Fault::FalseHit).count + of(Fault::LostHit).count + of(Fault::WrongTriangle).count;
  }
};

/// Any cases, by number from 0 on.
struct CaseSource {
  uint64_t count = 0;
  std::function<HitCase(uint64_t)> at;  ///< from several threads
};

struct RefereeOptions {
  uint32_t threads = 1;
  bool minimises = true;                 ///< the smallest case of each fault, if its contender still answers
  std::function<void(double)> progress;  ///< share of the cases; may be empty
};

/// `make` is called once a thread, and once more to minimise.
std::vector<Row> hold_match(const CaseSource& cases, const std::function<Contenders()>& make,
                            const RefereeOptions& options);

std::string table_of(const std::vector<Row>& rows);
/// Of each fault of each row; those that are the same as of the row before are left out.
std::string smallest_cases_of(const std::vector<Row>& rows);

/// Origin, direction, limit and triangles, in decimal digits where those are exact and few.
std::string text_of(const HitCase& hit_case);
std::string text_of(const HitAnswer& answer);
std::string text_of(const Certificate& certificate);

}  // namespace raypool::referee
