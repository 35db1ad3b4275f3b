#include "scene/obj_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>

#include "files/input_file.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

/// Behind short keys "#" begins a comment; behind longer ones stand names, which may have it.
bool takes_comments(std::string_view key) { return key.size() <= 2 || key.front() == '#'; }

template <typename Number>
bool read_number(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  // Both the too large (becomes infinite) and the too small (harmless) are out of range.
  if (result.ec == std::errc::result_out_of_range)
    value = static_cast<Number>(std::strtod(std::string(word).c_str(), nullptr));
  return result.ec != std::errc::invalid_argument && result.ptr == word.data() + word.size();
}

}  // namespace

std::string find_named_file(const std::string& folder, std::string name) {
  namespace fs = std::filesystem;
  const fs::path inside = folder;
  const auto is_file = [](const fs::path& path) {
    std::error_code none;
    return fs::is_regular_file(path, none);
  };
  if (is_file(inside / name)) return (inside / name).string();
  tell_missing((inside / name).string());
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path own = inside / name, beside = inside / fs::path(name).filename();
  for (const fs::path& path : {own, beside}) {
    if (is_file(path)) return path.string();
    std::error_code none;
    for (fs::directory_iterator entry(path.parent_path().empty() ? "." : path.parent_path(), none), end;
         !none && entry != end; entry.increment(none)) {
      if (lower_case(entry->path().filename().string()) == lower_case(path.filename().string()) &&
          is_file(entry->path()))
        return (path.parent_path() / entry->path().filename()).string();
    }
  }
  return "";
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

std::string_view next_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) words.push_back(word);
  return words;
}

bool read_float(std::string_view word, float& value) { return read_number(word, value); }

bool read_double(std::string_view word, double& value) {
  if (!read_number(word, value)) return false;
  // Next to the middle of two numbers of single precision the text decides: double may have lost its end.
  const double above = std::nextafter(value, INFINITY), below = std::nextafter(value, -INFINITY);
  if (static_cast<float>(above) == static_cast<float>(below)) return true;
  float single = 0;
  read_number(word, single);
  if (single != static_cast<float>(value)) value = single > static_cast<float>(value) ? above : below;
  return true;
}

double double_of(const ObjText& text, const ObjLine& line, std::string_view word, const char* what, float low,
                 float high) {
  double value = 0;
  if (!read_double(word, value))
    text.fail(line, fmt::format("'{}' in {} is not a number; correct the file", word, what));
  if (!(static_cast<float>(value) >= low && static_cast<float>(value) <= high)) {
    text.fail(line, fmt::format("{} has {}, which is not in {:g} .. {:g}; correct or rescale the file", what, word, low,
                                high));
  }
  return value;
}

ObjText::ObjText(const std::string& path, const std::string& what) : path_(path), text_(read_text_file(path, what)) {
  use_line_feeds(text_);
  const size_t zero = text_.find('\0');
  if (zero == std::string::npos) return;
  const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
  throw InputError(fmt::format("{}:{}: a zero byte: the {} is not text; check the path", path, line, what));
}

void ObjText::fail(const ObjLine& line, const std::string& message) const {
  throw InputError(fmt::format("{}:{}: {}", path_, line.number, message));
}

std::string_view ObjText::next_line() {
  const size_t end = std::min(text_.find('\n', place_), text_.size());
  std::string_view line = std::string_view(text_).substr(place_, end - place_);
  place_ = end + 1;
  ++number_;
  // Files that have been put together have the mark of the second one somewhere within.
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (line.substr(0, kByteOrderMark.size()) == kByteOrderMark) line.remove_prefix(kByteOrderMark.size());
  return line;
}

bool ObjText::next(ObjLine& statement) {
  while (place_ < text_.size()) {
    std::string_view line = trimmed(next_line());
    statement.number = number_;
    std::string_view rest = line;
    statement.key = next_word(rest);
    const bool comments = takes_comments(statement.key);
    // A comment goes to the end of its own line, whatever that ends in.
    const auto goes_on = [&](std::string_view part) {
      return !part.empty() && part.back() == '\\' && part.find(comments ? "#" : " #") == std::string_view::npos;
    };
    if (goes_on(line)) {
      joined_.clear();
      for (; goes_on(line) && place_ < text_.size(); line = trimmed(next_line()))
        joined_.append(line.substr(0, line.size() - 1)) += ' ';
      joined_ += line.substr(0, line.size() - (goes_on(line) ? 1 : 0));
      line = joined_;
    }
    statement.rest = comments ? line.substr(0, line.find('#')) : line;
    statement.key = next_word(statement.rest);
    statement.rest = trimmed(statement.rest);
    if (!statement.key.empty()) return true;
  }
  return false;
}

}  // namespace raypool
