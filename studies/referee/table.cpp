#include "referee/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>

#include "referee/minimise.hpp"

namespace raypool::referee {
namespace {

/// What one thread has of a row.
struct Tally {
  uint64_t cases = 0;
  Failing faults[kFaults];
  std::vector<float> errors;

  void add(const HitCase& hit_case, const HitAnswer& answer, const Verdict& verdict) {
    ++cases;
    if (verdict.timed) errors.push_back(static_cast<float>(verdict.error));
    for (size_t i = 0; i < kFaults; ++i) {
      if (verdict.faults[i]) keep(faults[i], {1, hit_case, answer});
    }
  }
  void add(Tally&& other) {
    cases += other.cases;
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
    for (size_t i = 0; i < kFaults; ++i) {
      if (other.faults[i].count != 0) keep(faults[i], other.faults[i]);
    }
  }

 private:
  /// Of two of the same size the one with the lower number is kept, whichever thread had it.
  static void keep(Failing& kept, const Failing& other) {
    const CaseSize a = size_of(other.smallest), b = size_of(kept.smallest);
    const bool smaller = kept.count == 0 || a < b || (!(b < a) && other.smallest.number < kept.smallest.number);
    const uint64_t count = kept.count + other.count;
    if (smaller) kept = other;
    kept.count = count;
  }
};

/// Cases from one thread after another, some at a time.
class Match {
 public:
  Match(const CaseSource& cases, const std::function<Contenders()>& make, const RefereeOptions& options)
      : cases_(cases), make_(make), options_(options) {}

  std::vector<Tally> run() {
    std::vector<std::thread> threads;
    for (uint32_t i = 1; i < options_.threads; ++i) threads.emplace_back([this] { work(false); });
    work(true);
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    return std::move(tallies_);
  }

 private:
  static constexpr uint64_t kAtOnce = 512;

  void work(bool reports) {
    try {
      std::vector<Tally> tallies = answer_cases(reports);
      const std::lock_guard<std::mutex> lock(mutex_);
      tallies_.resize(tallies.size());
      for (size_t i = 0; i < tallies.size(); ++i) tallies_[i].add(std::move(tallies[i]));
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failure_ = std::current_exception();
      next_ = cases_.count;
    }
  }
  std::vector<Tally> answer_cases(bool reports) {
    const Contenders contenders = make_();
    size_t count = 0;
    for (const auto& each : contenders) count += each->names().size();
    std::vector<Tally> tallies(count);
    std::vector<Said> answers(count);
    for (uint64_t first = next_.fetch_add(kAtOnce); first < cases_.count; first = next_.fetch_add(kAtOnce)) {
      for (uint64_t i = first; i < std::min(first + kAtOnce, cases_.count); ++i) {
        const HitCase hit_case = cases_.at(i);
        Said* place = answers.data();
        for (const auto& each : contenders) each->answer(hit_case, place), place += each->names().size();
        judge_all(hit_case, answers, tallies);
      }
      if (reports && options_.progress)
        options_.progress(static_cast<double>(first) / static_cast<double>(cases_.count));
    }
    return tallies;
  }
  static void judge_all(const HitCase& hit_case, const std::vector<Said>& answers, std::vector<Tally>& tallies) {
    const Certificate certificate = certify(hit_case);
    for (size_t i = 0; i < answers.size(); ++i) {
      if (answers[i]) tallies[i].add(hit_case, *answers[i], judge(hit_case, certificate, *answers[i]));
    }
  }

  const CaseSource& cases_;
  const std::function<Contenders()>& make_;
  const RefereeOptions& options_;
  std::atomic<uint64_t> next_{0};
  std::mutex mutex_;
  std::vector<Tally> tallies_;
  std::exception_ptr failure_;
};

void set_times(Row& row, std::vector<float>& errors) {
  row.times = errors.size();
  if (errors.empty()) return;
  const auto at = [&](double share) {
    const auto place = errors.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), place, errors.end());
    return static_cast<double>(*place);
  };
  row.median = at(0.5);
  row.percentile_99 = at(0.99);
  row.largest = at(1);
}

/// Reduces the smallest cases of the rows of a contender further.
class RowMinimiser {
 public:
  RowMinimiser(Contender& contender, Row* rows)
      : contender_(contender), rows_(rows), answers_(contender.names().size()) {}

  void run() {
    for (size_t i = 0; i < answers_.size(); ++i) {
      for (const Fault fault : kAllFaults) {
        if (rows_[i].of(fault).count != 0) minimise_one(i, fault);
      }
    }
  }

 private:
  void minimise_one(size_t i, Fault fault) {
    const auto spoils = [&](const HitCase& hit_case) {
      contender_.answer(hit_case, answers_.data());
      return answers_[i] && judge(hit_case, certify(hit_case), *answers_[i]).has(fault);
    };
    Failing& failing = rows_[i].faults[static_cast<size_t>(fault)];
    // Widths that go wrong alike have the same smallest case.
    const Failing* const before = i > 0 ? &rows_[i - 1].of(fault) : nullptr;
    const bool alike = before != nullptr && before->count == failing.count && spoils(before->smallest);
    failing.smallest = alike ? before->smallest : minimise(failing.smallest, spoils);
    contender_.answer(failing.smallest, answers_.data());
    failing.answer = *answers_[i];
  }

  Contender& contender_;
  Row* rows_;
  std::vector<Said> answers_;
};

std::string number_text(float x) {
  const std::string decimal = fmt::format("{}", x);
  return decimal.size() <= 6 && std::strtod(decimal.c_str(), nullptr) == static_cast<double>(x) ? decimal : hex_text(x);
}
std::string vector_text(const Vec3& v) {
  return fmt::format("({} {} {})", number_text(v.x), number_text(v.y), number_text(v.z));
}

std::string error_text(double error) {
  return error >= 10000 ? fmt::format("{:.0e}", error)
         : error >= 100 ? fmt::format("{:.0f}", error)
                        : fmt::format("{:.2f}", error);
}

}  // namespace

std::vector<Row> hold_match(const CaseSource& cases, const std::function<Contenders()>& make,
                            const RefereeOptions& options) {
  std::vector<Tally> tallies = Match(cases, make, options).run();
  std::vector<Row> rows;
  const Contenders contenders = make();
  for (const auto& each : contenders) {
    for (const std::string& name : each->names()) {
      Row row;
      row.name = name;
      if (rows.size() < tallies.size()) {
        Tally& tally = tallies[rows.size()];
        row.cases = tally.cases;
        std::copy(std::begin(tally.faults), std::end(tally.faults), row.faults);
        set_times(row, tally.errors);
      }
      rows.push_back(std::move(row));
    }
  }
  Row* first = rows.data();
  for (const auto& each : contenders) {
    if (options.minimises && each->answers_any()) RowMinimiser(*each, first).run();
    first += each->names().size();
  }
  return rows;
}

std::string table_of(const std::vector<Row>& rows) {
  std::string text = fmt::format("{:<24} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8}  {:>7} {:>7} {:>7}\n", "", "cases",
                                 "false", "lost", "wrong", "crack", "hits", "median", "99%", "largest");
  for (const Row& row : rows) {
    text += fmt::format("{:<24} {:>8}", row.name, row.cases);
    for (const Fault fault : kAllFaults) text += fmt::format(" {:>7}", row.of(fault).count);
    text += fmt::format(" {:>8}  {:>7} {:>7} {:>7}\n", row.times, error_text(row.median), error_text(row.percentile_99),
                        error_text(row.largest));
  }
  return text;
}

std::string smallest_cases_of(const std::vector<Row>& rows) {
  std::string text, before[kFaults];
  for (const Row& row : rows) {
    for (const Fault fault : kAllFaults) {
      const Failing& failing = row.of(fault);
      if (failing.count == 0) continue;
      const std::string shown = fmt::format(" {}\n answers {}; right is {}\n", text_of(failing.smallest),
                                            text_of(failing.answer), text_of(certify(failing.smallest)));
      if (shown == before[static_cast<size_t>(fault)]) continue;
      before[static_cast<size_t>(fault)] = shown;
      text += fmt::format("{}, {}: from case {}, {}\n{}", row.name, name_of(fault), failing.smallest.number,
                          failing.smallest.kind, shown);
    }
  }
  return text;
}

std::string text_of(const HitCase& hit_case) {
  const RayQuery& ray = hit_case.ray;
  std::string text = fmt::format("ray {} towards {}", vector_text(ray.origin), vector_text(ray.direction));
  if (!std::isinf(ray.limit)) text += fmt::format(" below {}", number_text(ray.limit));
  for (size_t i = 0; i < hit_case.triangles.size(); ++i) {
    const auto& corners = hit_case.triangles[i];
    text += fmt::format("; triangle {} {} {} {}", i, vector_text(corners[0]), vector_text(corners[1]),
                        vector_text(corners[2]));
  }
  return text;
}

std::string text_of(const HitAnswer& answer) {
  return answer.hit ? fmt::format("triangle {} at {}", answer.triangle, number_text(answer.t)) : "a miss";
}

std::string text_of(const Certificate& certificate) {
  std::string text = certificate.miss ? "a miss" : "";
  for (const uint32_t triangle : certificate.allowed) {
    const std::string t = certificate.meeting(triangle)->t.text();
    text += fmt::format("{}triangle {} at {}", text.empty() ? "" : " or ", triangle,
                        t.size() <= 24 ? t : fmt::format("{:.9g}", certificate.meeting(triangle)->t.approximately()));
  }
  return text;
}

}  // namespace raypool::referee
