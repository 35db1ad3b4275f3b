// The text of OBJ and MTL files: lines, words and numbers, with the sentence about one that is wrong.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raypool {

/// A statement: a line, with those joined to it that a "\" at its end continues it on; in their place is a blank.
struct ObjLine {
  size_t number = 0;  ///< of its first line in the file, from 1
  std::string_view key;
  std::string_view rest;  ///< behind the key, without blanks at either end
};

class ObjText {
 public:
  /// `what` names the file in sentences: "OBJ file". Throws InputError.
  ObjText(const std::string& path, const std::string& what);
  /// Takes the next statement that has a key and is no comment; false behind the last one. What it points to lasts
  /// until the next call. A comment behind the values of a key of one or two letters is left out; behind longer keys it
  /// may be part of a name.
  bool next(ObjLine& line);
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const ObjLine& line, const std::string& message) const;

 private:
  std::string_view next_line();

  std::string path_, text_, joined_;
  size_t place_ = 0, number_ = 0;
};

/// The path of a file that another one names: in `folder`, or below it. Exporters of Windows write "\" between folders,
/// whole paths of the machine that they ran on, and do not mind upper and lower case. Empty: it is nowhere.
std::string find_named_file(const std::string& folder, std::string name);

/// Takes the next word off the front of `text`; empty at its end.
std::string_view next_word(std::string_view& text);
std::vector<std::string_view> words_of(std::string_view text);
std::string lower_case(std::string text);
std::string_view trimmed(std::string_view text);

/// Reads a decimal number and nothing after it; the result may be infinite or NaN if the text is.
bool read_float(std::string_view word, float& value);
/// The same in double; rounded to single precision it is what read_float() reads.
bool read_double(std::string_view word, double& value);
/// The same as part of `line`, in single precision within low .. high; `what` begins the sentence if it is not:
/// "vertex".
double double_of(const ObjText& text, const ObjLine& line, std::string_view word, const char* what, float low,
                 float high);
inline float number_of(const ObjText& text, const ObjLine& line, std::string_view word, const char* what, float low,
                       float high) {
  return static_cast<float>(double_of(text, line, word, what, low, high));
}

}  // namespace raypool
