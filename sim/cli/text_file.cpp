#include "cli/text_file.hpp"

#include "files/input_file.hpp"

namespace raypool {

std::string read_text(const std::string& path) {
  std::string text = read_text_file(path == "-" ? "/dev/stdin" : path, "file");
  use_line_feeds(text);
  return text;
}

}  // namespace raypool
