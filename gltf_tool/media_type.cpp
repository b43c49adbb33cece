#include "media_type.h"

#include <cstring>
#include <string_view>

namespace applique {

std::string media_type_of(std::span<const std::uint8_t> bytes) {
  const auto starts_with = [&](std::string_view magic, std::size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
  };
  if (starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (starts_with("RIFF") && starts_with("WEBP", 8)) return "image/webp";
  if (starts_with("\xabKTX 20\xbb\r\n\x1a\n")) return "image/ktx2";
  return "";
}

std::string extension_of(const std::string& media_type) {
  if (media_type == "image/png") return ".png";
  if (media_type == "image/jpeg") return ".jpg";
  if (media_type == "image/webp") return ".webp";
  return media_type == "image/ktx2" ? ".ktx2" : "";
}

}  // namespace applique
