#pragma once

#include <string>
#include <vector>

namespace applique::compare {

/// A table of text, written as people and programs read it. Cells hold no line breaks.
struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< Each as long as the header.
};

std::string to_csv(const TextTable& table);  ///< RFC 4180.
std::string to_markdown(const TextTable& table);
std::string to_html(const TextTable& table);

/// Text as it stands in HTML.
std::string escape_html(const std::string& text);

}  // namespace applique::compare
