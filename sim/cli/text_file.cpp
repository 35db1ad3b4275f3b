#include "cli/text_file.hpp"

#include "files/input_file.hpp"

namespace raypool {

std::string read_text(const std::string& path) { return read_file(path == "-" ? "/dev/stdin" : path, "file"); }

}  // namespace raypool
