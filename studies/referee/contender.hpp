// Implementations that answer the cases of a corpus.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/hit_case.hpp"

namespace raypool::referee {

/// None: a case that it does not take.
using Said = std::optional<HitAnswer>;

/// One way to intersect, or several that share work. Of one thread.
class Contender {
 public:
  Contender() = default;
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;
  virtual ~Contender() = default;

  /// False: only the cases of the corpus itself, so that none can be minimised.
  virtual bool answers_any() const { return true; }
  /// One for each answer.
  virtual std::vector<std::string> names() const = 0;
  /// `answers` has a place for each name.
  virtual void answer(const HitCase& hit_case, Said* answers) = 0;
};
using Contenders = std::vector<std::unique_ptr<Contender>>;

/// One that is a function of a case.
template <typename Function>
class FunctionContender : public Contender {
 public:
  FunctionContender(std::string name, Function function) : name_(std::move(name)), function_(std::move(function)) {}
  std::vector<std::string> names() const override { return {name_}; }
  void answer(const HitCase& hit_case, Said* answers) override { *answers = function_(hit_case); }

 private:
  std::string name_;
  Function function_;
};
template <typename Function>
std::unique_ptr<Contender> contender(std::string name, Function function) {
  return std::make_unique<FunctionContender<Function>>(std::move(name), std::move(function));
}

/// The scene of a case.
Scene scene_of(const HitCase& hit_case);

}  // namespace raypool::referee
