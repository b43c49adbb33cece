#include "uri.h"

#include <array>
#include <cctype>
#include <optional>

namespace applique {
namespace {

std::optional<std::uint8_t> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<std::uint8_t>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F') return static_cast<std::uint8_t>(c - 'A' + 10);
  return std::nullopt;
}

std::optional<std::uint32_t> base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a' + 26);
  if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0' + 52);
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return std::nullopt;
}

Result<std::vector<std::uint8_t>> decode_base64(std::string_view text, const std::string& name) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t pending = 0;
  int bits = 0;
  for (const char c : text) {
    const auto digit = base64_digit(c);
    if (!digit) return fail(ErrorCode::model_invalid, name + ": its data URI is not valid base64");
    pending = (pending << 6) | *digit;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(pending >> bits));
    }
  }
  return bytes;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

bool is_relative_uri(std::string_view uri) {
  if (uri.empty() || uri.front() == '/') return false;
  const auto end = uri.find_first_of(":/?#");
  return end == std::string_view::npos || uri[end] != ':';
}

std::string percent_decode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      const auto high = hex_digit(text[i + 1]);
      const auto low = hex_digit(text[i + 2]);
      if (high && low) {
        decoded.push_back(static_cast<char>(*high * 16 + *low));
        i += 2;
        continue;
      }
    }
    decoded.push_back(text[i]);
  }
  return decoded;
}

std::string percent_encode(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 128 && std::isalnum(byte) != 0) ||
        std::string_view("-._~/").find(c) != std::string_view::npos) {
      encoded.push_back(c);
    } else {
      encoded.push_back('%');
      encoded.push_back(digits[byte / 16]);
      encoded.push_back(digits[byte % 16]);
    }
  }
  return encoded;
}

Result<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri, const std::string& name) {
  const auto comma = uri.find(',');
  if (comma == std::string_view::npos)
    return fail(ErrorCode::model_invalid, name + ": its data URI has no comma before the data");
  const std::string_view head = uri.substr(0, comma);
  if (head.ends_with(";base64")) return decode_base64(uri.substr(comma + 1), name);
  const std::string text = percent_decode(uri.substr(comma + 1));
  return std::vector<std::uint8_t>(text.begin(), text.end());
}

}  // namespace applique
