#pragma once

#include <string>
#include <string_view>

namespace applique {

/// Where and why text that a parser turned down is no JSON: "line 3, column 20: found '}' where ',' or ']' is
/// expected". Lines and columns count from 1, columns in bytes.
std::string explain_json_error(std::string_view text);

}  // namespace applique
