#include "json_error.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace applique {
namespace {

using nlohmann::json;

/// Reads text for its first fault only.
class FaultFinder : public nlohmann::json_sax<json> {
 public:
  std::size_t position = 0;  ///< Bytes read, with the one at fault.
  std::string token;         ///< The last one.
  std::string reason;        ///< The library's.
  bool too_large = false;    ///< A number is.

  bool parse_error(std::size_t at, const std::string& last, const json::exception& error) override {
    constexpr int out_of_range = 406;
    position = at;
    token = last;
    reason = error.what();
    too_large = error.id == out_of_range;
    return false;
  }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
};

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// What the library expected, in the words of who writes JSON; empty: it does not say.
std::string expectation(std::string_view reason) {
  constexpr std::string_view mark = "; expected ";
  const std::size_t at = reason.find(mark);
  if (at == std::string_view::npos) return {};
  const std::string_view wanted = reason.substr(at + mark.size());
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 5> words = {
      {{"string literal", "a name in double quotes"},
       {"end of input", "the end of the text"},
       {"'}'", "',' or '}'"},
       {"']'", "',' or ']'"},
       {"'[', '{', or a literal", "a value"}}};
  const auto known =
      std::find_if(words.begin(), words.end(), [&](const auto& word) { return word.first == wanted; });
  return std::string(known == words.end() ? wanted : known->second);
}

/// Faults inside a string or a number.
std::string malformed_token(std::string_view reason) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> faults = {
      {{"missing closing quote", "a string has no closing quote"},
       {"must be escaped",
        "a string has a line break or another control character in it, which is written as \\n or \\u00.."},
       {"ill-formed UTF-8", "a string is not UTF-8"},
       {"forbidden character after backslash",
        "a string has a backslash that begins no escape sequence; write it as \\\\, or a path with /"},
       {"invalid string", "a string has a broken \\u sequence"},
       {"invalid number", "a number is malformed"}}};
  const auto known = std::find_if(faults.begin(), faults.end(),
                                  [&](const auto& fault) { return contains(reason, fault.first); });
  return std::string(known == faults.end() ? "" : known->second);
}

std::string sentence_of(const FaultFinder& fault, std::string_view found) {
  if (fault.too_large) return fmt::format("the number {} is too large", found);
  if (const std::string malformed = malformed_token(fault.reason); !malformed.empty()) return malformed;
  const std::string expected = expectation(fault.reason);
  if (contains(fault.reason, "unexpected end of input"))
    return expected.empty() ? "the text ends too early"
                            : fmt::format("the text ends where {} is expected", expected);
  return expected.empty() ? fmt::format("found '{}', which is no value", found)
                          : fmt::format("found '{}' where {} is expected", found, expected);
}

}  // namespace

std::string explain_json_error(std::string_view text) {
  FaultFinder fault;
  json::sax_parse(text, &fault);
  const std::size_t end = std::min(fault.position, text.size());
  // The library clears the token for strings and numbers only; anything else at fault is a single byte.
  const bool whole = !contains(fault.reason, "invalid literal") && !contains(fault.reason, "unexpected '") &&
                     fault.token.size() <= end &&
                     text.substr(end - fault.token.size(), fault.token.size()) == fault.token;
  const std::size_t length = whole ? fault.token.size() : std::min<std::size_t>(end, 1);
  const std::size_t start = end - length;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(start), '\n');
  const std::size_t line_start = start == 0 ? 0 : text.rfind('\n', start - 1) + 1;
  return fmt::format("line {}, column {}: {}", line, start - line_start + 1,
                     sentence_of(fault, text.substr(start, length)));
}

}  // namespace applique
