// A corpus as a file (docs/use/referee.md): a line a case, with its certificate.
#pragma once

#include <string>
#include <vector>

#include "referee/certificate.hpp"
#include "referee/contender.hpp"

namespace raypool::referee {

std::string to_line(const HitCase& hit_case, const Certificate& certificate);

/// Throws InputError when a line is no case, or has a certificate that is not that of its numbers.
std::vector<HitCase> read_corpus(const std::string& path);

/// An implementation's answers to the cases, by number.
struct RecordedAnswers {
  std::string name;
  std::vector<HitAnswer> answers;
};
/// Of a file, with its name, one a case of `cases`. Throws InputError when a line is no answer, or a case has none.
RecordedAnswers read_answers(const std::string& path, uint64_t cases);
/// Answers what is recorded, which must outlive it.
std::unique_ptr<Contender> contender_of(const RecordedAnswers& recorded);

}  // namespace raypool::referee
