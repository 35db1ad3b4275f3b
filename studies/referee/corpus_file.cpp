#include "referee/corpus_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "config/configuration.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"

namespace raypool::referee {
namespace {

using Json = nlohmann::ordered_json;

/// Calls with each line that is not empty, and its place.
void each_line(const std::string& path, const std::string& what,
               const std::function<void(const std::string&, const std::string&)>& call) {
  const std::string text = read_text_file(path, what);
  size_t number = 0;
  for (size_t first = 0, end = 0; first < text.size(); first = end + 1) {
    end = std::min(text.find('\n', first), text.size());
    ++number;
    const std::string line = text.substr(first, end - first);
    if (line.find_first_not_of(" \t\r") != std::string::npos) call(line, fmt::format("{}, line {}", path, number));
  }
}

/// What a line has besides its case must follow from its numbers.
void check_certificate(const std::string& line, const HitCase& hit_case, const std::string& where) {
  const Json said = parse_json(line, where), ours = parse_json(to_line(hit_case, certify(hit_case)), where);
  for (const char* key : {"hits", "allowed", "miss"}) {
    if (!said.contains(key) || said[key] == ours[key]) continue;
    throw InputError(fmt::format("{}: \"{}\" is {}, but the case's numbers give {}: correct it or leave it out", where,
                                 key, said[key].dump(), ours[key].dump()));
  }
}

/// Answers that were given before.
class Recorded : public Contender {
 public:
  explicit Recorded(const RecordedAnswers& recorded) : recorded_(recorded) {}
  std::vector<std::string> names() const override { return {recorded_.name}; }
  bool answers_any() const override { return false; }
  void answer(const HitCase& hit_case, Said* answers) override { *answers = recorded_.answers.at(hit_case.number); }

 private:
  const RecordedAnswers& recorded_;
};

}  // namespace

std::string to_line(const HitCase& hit_case, const Certificate& certificate) {
  Json json = to_json(hit_case);
  Json& hits = json["hits"] = Json::array();
  for (const Meeting& meeting : certificate.meetings) {
    hits.push_back({{"triangle", meeting.triangle},
                    {"at", name_of(meeting.passing)},
                    {"t", hex_text(meeting.nearest)},
                    {"exact", meeting.t.text()}});
  }
  json["allowed"] = certificate.allowed;
  json["miss"] = certificate.miss;
  return json.dump();
}

std::vector<HitCase> read_corpus(const std::string& path) {
  std::vector<HitCase> cases;
  each_line(path, "corpus", [&](const std::string& line, const std::string& where) {
    HitCase read = parse_hit_case(line, where);
    check_certificate(line, read, where);
    cases.push_back(std::move(read));
  });
  if (cases.empty()) throw InputError(path + ": has no case: give a line for each");
  return cases;
}

RecordedAnswers read_answers(const std::string& path, uint64_t cases) {
  std::vector<std::optional<HitAnswer>> found(cases);
  each_line(path, "file of answers", [&](const std::string& line, const std::string& where) {
    const NumberedAnswer read = parse_answer(line, where);
    if (read.number >= cases)
      throw InputError(fmt::format("{}: the corpus has no case {}, only those below {}", where, read.number, cases));
    if (found[read.number])
      throw InputError(fmt::format("{}: case {} is answered twice: keep one of them", where, read.number));
    found[read.number] = read.answer;
  });
  RecordedAnswers recorded;
  recorded.name = std::filesystem::path(path).stem().string();
  for (uint64_t i = 0; i < cases; ++i) {
    if (!found[i]) throw InputError(fmt::format("{}: case {} has no answer: each needs a line", path, i));
    recorded.answers.push_back(*found[i]);
  }
  return recorded;
}

std::unique_ptr<Contender> contender_of(const RecordedAnswers& recorded) {
  return std::make_unique<Recorded>(recorded);
}

}  // namespace raypool::referee
