#include "compare/text_table.h"

#include <string_view>

namespace applique::compare {
namespace {

/// `text` with each of the characters replaced.
template <class Replace>
std::string replaced(const std::string& text, const Replace& replacement) {
  std::string out;
  for (const char c : text) out += replacement(c);
  return out;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  return '"' + replaced(text, [](char c) { return c == '"' ? std::string("\"\"") : std::string(1, c); }) +
         '"';
}

std::string markdown_cell(const std::string& text) {
  return replaced(text, [](char c) { return c == '|' ? std::string("\\|") : std::string(1, c); });
}

/// Cells between `open` and `close`, `between` them.
template <class Cell>
std::string line(const std::vector<std::string>& cells, std::string_view open, std::string_view between,
                 std::string_view close, const Cell& cell) {
  std::string out(open);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) out += between;
    out += cell(cells[i]);
  }
  out += close;
  return out;
}

}  // namespace

std::string escape_html(const std::string& text) {
  return replaced(text, [](char c) {
    switch (c) {
      case '&':
        return std::string("&amp;");
      case '<':
        return std::string("&lt;");
      case '>':
        return std::string("&gt;");
      case '"':
        return std::string("&quot;");
      default:
        return std::string(1, c);
    }
  });
}

std::string to_csv(const TextTable& table) {
  std::string out = line(table.header, "", ",", "\r\n", csv_cell);
  for (const auto& row : table.rows) out += line(row, "", ",", "\r\n", csv_cell);
  return out;
}

std::string to_markdown(const TextTable& table) {
  std::string out = line(table.header, "| ", " | ", " |\n", markdown_cell);
  out += line(table.header, "|", "|", "|\n", [](const std::string&) { return "---"; });
  for (const auto& row : table.rows) out += line(row, "| ", " | ", " |\n", markdown_cell);
  return out;
}

std::string to_html(const TextTable& table) {
  std::string out = "<table>\n" + line(table.header, "<tr><th>", "</th><th>", "</th></tr>\n", escape_html);
  for (const auto& row : table.rows) out += line(row, "<tr><td>", "</td><td>", "</td></tr>\n", escape_html);
  return out + "</table>\n";
}

}  // namespace applique::compare
