// A corpus as a file (docs/referee.md): a line a case, with its certificate.
#pragma once

#include <string>
#include <vector>

#include "referee/certificate.hpp"
#include "referee/contender.hpp"

namespace raypool::referee {

std::string to_line(const HitCase& hit_case, const Certificate& certificate);

/// Throws InputError when a line is no case, or has a certificate that is not that of its numbers.
std::vector<HitCase> read_corpus(const std::string& path);

/// The answers of a file, one a case of `cases`, under the name of the file. Throws InputError when a line is no
/// answer, or a case has none.
std::unique_ptr<Contender> answers_of_file(const std::string& path, uint64_t cases);

}  // namespace raypool::referee
