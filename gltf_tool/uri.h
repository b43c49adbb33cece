#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "applique/base/error.h"

namespace applique {

/// "data:…" rather than a path.
bool is_data_uri(std::string_view uri);

/// A relative reference to a file: no scheme ("http:"), not a data URI, not empty.
bool is_relative_uri(std::string_view uri);

/// The bytes of a data URI, base64 or percent-encoded. `name` stands for it in errors (model_invalid).
Result<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri, const std::string& name);

/// "%20" becomes a space; a '%' that no two hex digits follow stays as it is.
std::string percent_decode(std::string_view text);

/// Everything but RFC 3986's unreserved characters and '/' becomes %XX.
std::string percent_encode(std::string_view text);

}  // namespace applique
