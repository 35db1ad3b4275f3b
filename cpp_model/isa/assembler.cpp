// The assembler: line by line into instructions, then labels into targets.
#include "isa/assembler.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <limits>
#include <map>
#include <vector>

#include "bits.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/encoding.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

constexpr size_t kLongestProgram = 65535;  // PCs have 16 bits, and FFFF hex is the end that is never reached

struct Place {
  int line = 0;
  int column = 0;
};

/// A label in an instruction, to be filled in when all labels are known.
struct Reference {
  size_t instruction;
  int lsb;
  std::string label;
  Place place;
};

bool is_word_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '$';
}

class Assembler {
 public:
  explicit Assembler(const std::string& source_name) : source_name_(source_name) {}

  Program run(std::string_view text) {
    place_.line = 0;
    while (!text.empty()) {
      const size_t end = text.find('\n');
      line_ = text.substr(0, end);
      text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
      ++place_.line;
      position_ = 0;
      parse_line();
    }
    resolve();
    return std::move(program_);
  }

 private:
  // Characters ------------------------------------------------------------------------------------------------------

  [[noreturn]] void fail(const Place& place, const std::string& what) const {
    throw InputError(fmt::format("{}:{}:{}: {}", source_name_, place.line, place.column, what));
  }
  Place here() const { return {place_.line, static_cast<int>(position_) + 1}; }
  void skip_space() {
    while (position_ < line_.size() && std::isspace(static_cast<unsigned char>(line_[position_]))) ++position_;
    if (position_ < line_.size() && line_[position_] == '#') position_ = line_.size();
  }
  bool at_end() {
    skip_space();
    return position_ == line_.size();
  }
  bool take(char c) {
    skip_space();
    if (position_ == line_.size() || line_[position_] != c) return false;
    ++position_;
    return true;
  }
  void expect(char c, const char* where) {
    if (!take(c)) fail(here(), fmt::format("expected '{}' {}, found {}", c, where, rest()));
  }
  /// The rest of the line's next piece, for messages.
  std::string rest() {
    if (at_end()) return "the end of the line";
    const size_t start = position_;
    size_t end = start;
    while (end < line_.size() && is_word_character(line_[end])) ++end;
    return fmt::format("'{}'", line_.substr(start, std::max<size_t>(1, end - start)));
  }
  std::string word() {
    skip_space();
    const size_t start = position_;
    while (position_ < line_.size() && is_word_character(line_[position_])) ++position_;
    return std::string(line_.substr(start, position_ - start));
  }
  /// A word that may begin with a sign and hold one after an exponent: a number in any notation.
  std::string number_text() {
    skip_space();
    const size_t start = position_;
    if (position_ < line_.size() && (line_[position_] == '-' || line_[position_] == '+')) ++position_;
    const bool hexadecimal = line_.substr(position_, 2) == "0x" || line_.substr(position_, 2) == "0X";
    while (position_ < line_.size()) {
      const char c = line_[position_];
      const bool exponent_sign = !hexadecimal && (c == '-' || c == '+') && position_ > start &&
                                 (line_[position_ - 1] == 'e' || line_[position_ - 1] == 'E');
      if (!is_word_character(c) && !exponent_sign) break;
      ++position_;
    }
    return std::string(line_.substr(start, position_ - start));
  }

  // Lines -----------------------------------------------------------------------------------------------------------

  void parse_line() {
    while (!at_end()) {
      const Place start = here();
      const size_t before = position_;
      const std::string name = word();
      if (name == ".kernel") {
        parse_kernel();
        return;
      }
      if (name == ".word") {
        append(parse_bits());
        finish_line();
        return;
      }
      if (!name.empty() && take(':')) {
        define_label(name, start);
        continue;  // an instruction may follow on the same line
      }
      position_ = before;
      parse_instruction();
      return;
    }
  }

  void finish_line() {
    if (!at_end()) fail(here(), fmt::format("expected the end of the line, found {}", rest()));
  }

  void append(uint64_t encoding) {
    if (program_.code.size() == kLongestProgram)
      fail({place_.line, 1}, fmt::format("a program has {} instructions at most", kLongestProgram));
    program_.code.push_back(encoding);
  }

  void define_label(const std::string& name, const Place& place) {
    if (std::isdigit(static_cast<unsigned char>(name[0])))
      fail(place, fmt::format("label '{}' begins with a digit; labels begin with a letter", name));
    if (!labels_.emplace(name, size32(program_.code)).second) {
      fail(place, fmt::format("label '{}' is defined twice; give one of them another name", name));
    }
  }

  void parse_kernel() {
    skip_space();
    const Place place = here();
    const std::string name = word();
    if (name.empty()) fail(place, fmt::format("expected the kernel's name, found {}", rest()));
    finish_line();
    define_label(name, place);
    program_.entries[name] = size32(program_.code);
  }

  uint64_t parse_bits() {
    skip_space();
    const Place place = here();
    const std::string text = number_text();
    uint64_t bits = 0;
    const char* end = text.data() + text.size();
    const bool prefix = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    const auto result = std::from_chars(text.data() + (prefix ? 2 : 0), end, bits, 16);
    if (!prefix || result.ec != std::errc() || result.ptr != end)
      fail(place, "expected 64 bits in hexadecimal, such as 0x1c00000000000000");
    return bits;
  }

  void parse_instruction() {
    Instruction parts;
    if (take('@')) {
      parts.guard_negated = take('!');
      parts.guard = parse_numbered('p', "predicate", kPredicates);
    }
    skip_space();
    const Place start = here();
    const std::string mnemonic = word();
    if (mnemonic.empty()) fail(start, fmt::format("expected an instruction, found {}", rest()));
    parts.info = find_instruction(mnemonic);
    if (parts.info == nullptr)
      fail(start, fmt::format("unknown instruction '{}'{}", mnemonic,
                              did_you_mean(mnemonic, mnemonics(), "docs/machine/isa.md lists all")));
    bool first = true;
    for (const Operand operand : parts.info->operands) {
      if (operand == Operand::None) continue;
      if (!first) expect(',', "before the next operand");
      first = false;
      parse_operand(operand, parts);
    }
    finish_line();
    append(encode(parts));
  }

  // Operands --------------------------------------------------------------------------------------------------------

  void parse_operand(Operand operand, Instruction& parts) {
    switch (operand) {
      case Operand::None:
        break;
      case Operand::Rd:
        parts.rd = parse_register();
        break;
      case Operand::Ra:
        parts.ra = parse_register();
        break;
      case Operand::Rb:
        parts.rb = parse_register();
        break;
      case Operand::Rc:
        parts.x = parse_register();
        break;
      case Operand::Pd:
        parts.rd = parse_numbered('p', "predicate", kPredicates);
        break;
      case Operand::Px:
        parts.x = parse_numbered('p', "predicate", kPredicates);
        break;
      case Operand::Pb:
        parts.rb = parse_numbered('p', "predicate", kPredicates);
        break;
      case Operand::B:
        parse_b(parts);
        break;
      case Operand::Address:
        parse_address(parts);
        break;
      case Operand::Word:
        parts.x = parse_small("ray word", kLastRayWord);
        break;
      case Operand::Argument:
        parts.immediate |= parse_small("argument", kArguments - 1);
        break;
      case Operand::Target:
        parts.immediate |= parse_target(0);
        break;
      case Operand::End: {
        const int lsb = has_operand(*parts.info, Operand::Target) ? field::kEnd.lsb : field::kTarget.lsb;
        parts.immediate |= parse_target(lsb) << lsb;
        break;
      }
    }
  }

  uint8_t parse_register() { return parse_numbered('r', "register", kRegisters); }

  uint8_t parse_numbered(char letter, const char* what, int count) {
    skip_space();
    const Place place = here();
    const std::string found = rest();
    const std::string name = word();
    if (name.size() < 2 || name[0] != letter || !std::isdigit(static_cast<unsigned char>(name[1]))) {
      fail(place,
           fmt::format("expected a {}, found {}; {}s are {}0 to {}{}", what, found, what, letter, letter, count - 1));
    }
    int number = 0;
    const char* end = name.data() + name.size();
    const auto result = std::from_chars(name.data() + 1, end, number);
    if (result.ec != std::errc() || result.ptr != end || number >= count || (name[1] == '0' && name.size() > 2)) {
      fail(place, fmt::format("unknown {} {}; {}s are {}0 to {}{}", what, name, what, letter, letter, count - 1));
    }
    return static_cast<uint8_t>(number);
  }

  void parse_b(Instruction& parts) {
    skip_space();
    if (position_ + 1 < line_.size() && line_[position_] == 'r' &&
        std::isdigit(static_cast<unsigned char>(line_[position_ + 1]))) {
      parts.rb = parse_register();
      return;
    }
    parts.b_is_immediate = true;
    const Place place = here();
    const std::string found = rest();
    const std::string text = number_text();
    if (text.empty()) fail(place, fmt::format("expected a register or an immediate, found {}", found));
    const bool is_float = looks_like_float(text);
    if (parts.info->immediate == ImmediateType::Float) {
      if (!is_float && !looks_hexadecimal(text)) {
        fail(place,
             fmt::format("'{}' is not a float; write {}.0 for the number, or 0x... for the bit pattern", text, text));
      }
    } else if (is_float && parts.info->immediate != ImmediateType::Either) {
      fail(place, fmt::format("{} takes an integer, not the float {}", parts.info->mnemonic, text));
    }
    parts.immediate = is_float ? parse_float(text, place) : parse_integer(text, place);
  }

  static bool looks_hexadecimal(const std::string& text) {
    return text.find("0x") != std::string::npos || text.find("0X") != std::string::npos;
  }
  static bool looks_like_float(const std::string& text) {
    if (looks_hexadecimal(text)) return false;
    return text.find_first_of(".eE") != std::string::npos || text == "inf" || text == "-inf" || text == "+inf";
  }

  uint32_t parse_float(const std::string& text, const Place& place) const {
    float value = 0;
    const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(begin, end, value);
    if (result.ec == std::errc::result_out_of_range) {
      fail(place, fmt::format("the float {} is too large or too small for single precision; write inf or 0.0", text));
    }
    if (result.ec != std::errc() || result.ptr != end) fail(place, fmt::format("'{}' is not a float", text));
    return as_bits(value);
  }

  uint32_t parse_integer(const std::string& text, const Place& place) const {
    size_t digits = text[0] == '-' || text[0] == '+' ? 1 : 0;
    const bool hexadecimal = looks_hexadecimal(text.substr(digits, 2));
    if (hexadecimal) digits += 2;
    int64_t value = 0;
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + digits, end, value, hexadecimal ? 16 : 10);
    if (result.ec == std::errc::invalid_argument || result.ptr != end || text[digits] == '-') {
      fail(place, fmt::format("'{}' is not a number", text));
    }
    if (text[0] == '-') value = -value;
    if (result.ec != std::errc() || value < std::numeric_limits<int32_t>::min() ||
        value > std::numeric_limits<uint32_t>::max()) {
      fail(place, fmt::format("{} does not fit in 32 bits; integers are -2147483648 to 4294967295", text));
    }
    return static_cast<uint32_t>(value);
  }

  void parse_address(Instruction& parts) {
    expect('[', "before an address");
    parts.ra = parse_register();
    skip_space();
    if (position_ < line_.size() && (line_[position_] == '+' || line_[position_] == '-')) {
      const std::string sign(1, line_[position_]);
      ++position_;
      skip_space();
      const Place place = here();
      const std::string found = rest();
      const std::string text = number_text();
      if (text.empty()) fail(place, fmt::format("expected a number of bytes, found {}", found));
      parts.immediate = parse_integer(sign + text, place);
    }
    expect(']', "after an address");
  }

  uint32_t parse_small(const char* what, int last) {
    skip_space();
    const Place place = here();
    const std::string found = rest();
    const std::string text = number_text();
    if (text.empty())
      fail(place, fmt::format("expected a {} number, found {}; {}s are 0 to {}", what, found, what, last));
    const uint32_t value = parse_integer(text, place);
    if (value > static_cast<uint32_t>(last))
      fail(place, fmt::format("there is no {} {}; {}s are 0 to {}", what, text, what, last));
    return value;
  }

  uint32_t parse_target(int lsb) {
    skip_space();
    const Place place = here();
    const std::string found = rest();
    const std::string name = word();
    if (name.empty()) fail(place, fmt::format("expected a label, found {}", found));
    if (!std::isdigit(static_cast<unsigned char>(name[0]))) {
      references_.push_back({program_.code.size(), lsb, name, place});
      return 0;
    }
    const uint32_t value = parse_integer(name, place);
    if (value > 0xffff)
      fail(place, fmt::format("target {} does not fit in 16 bits; instructions are 0 to 65535", name));
    return value;
  }

  void resolve() {
    for (const Reference& reference : references_) {
      const auto label = labels_.find(reference.label);
      if (label == labels_.end())
        fail(reference.place, fmt::format("label '{}' is not defined in this file{}", reference.label,
                                          did_you_mean(reference.label, label_names(), "")));
      program_.code[reference.instruction] |= static_cast<uint64_t>(label->second) << reference.lsb;
    }
  }

  static std::vector<std::string> mnemonics() {
    std::vector<std::string> names;
    for (const InstructionInfo& info : kInstructions) names.emplace_back(info.mnemonic);
    return names;
  }
  std::vector<std::string> label_names() const {
    std::vector<std::string> names;
    for (const auto& label : labels_) names.push_back(label.first);
    return names;
  }

  const std::string& source_name_;
  std::string_view line_;
  size_t position_ = 0;
  Place place_;
  Program program_;
  std::map<std::string, uint32_t> labels_;
  std::vector<Reference> references_;
};

}  // namespace

Program assemble(std::string_view text, const std::string& source_name) { return Assembler(source_name).run(text); }

}  // namespace raypool
