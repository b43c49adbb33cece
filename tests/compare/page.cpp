#include "compare/page.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "compare/pictures.h"
#include "compare/tables.h"
#include "output_file.h"

namespace applique::compare {
namespace {

constexpr const char* style = R"(<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 90em; margin: 2em auto; padding: 0 1em; }
p { max-width: 60em; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { border-bottom: 1px solid #ddd; padding: 2px 10px; text-align: left; }
.methods { display: flex; flex-wrap: wrap; gap: 12px; }
figure { margin: 0; width: 250px; }
figure img { width: 100%; display: block; }
figcaption { font-size: 13px; }
</style>
)";

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return fail(ErrorCode::output_unwritable, fmt::format("{}: {}", folder.string(), error.message()));
  return {};
}

Result<void> write_picture(const std::filesystem::path& path, const Image& image) {
  APPLIQUE_TRY(const auto png, encode_png(image));
  return write_file(path, png);
}

std::string caption_of(const Row& row) {
  if (!row.figures) return fmt::format("<b>{}</b><br>{}", escape_html(row.method), escape_html(row.status));
  const Figures& f = *row.figures;
  return fmt::format("<b>{}</b><br>L2 {:.4f}, {} flips, residual {:.2g} px, coverage {:.1f} %",
                     escape_html(row.method), f.l2, f.flips, f.residual_px, 100 * f.coverage);
}

/// A name as a file's.
std::string file_name(const std::string& name) {
  std::string file = name + ".png";
  std::replace_if(
      file.begin(), file.end(), [](char c) { return c == ' ' || c == '/'; }, '-');
  return file;
}

/// Draws the maps of a case: for each method its picture, and all of them side by side on a sheet. All are
/// seen from where the first is seen best.
class CasePictures {
 public:
  CasePictures(const std::filesystem::path& folder, const Site& site, const Case& shown, const Device* device)
      : folder_(folder), site_(site), shown_(shown), device_(device) {}

  /// The method's figure, in HTML.
  Result<std::string> add(const Row& row) {
    std::string image;
    if (row.map) {
      APPLIQUE_TRY(Image picture, draw(*row.map));
      const std::string file = file_name(row.name.text() + "-" + row.method);
      APPLIQUE_CHECK(write_picture(folder_ / "pictures" / file, picture));
      columns_.push_back(std::move(picture));
      image = fmt::format("<img src=\"pictures/{}\" alt=\"{} by {}\">", escape_html(file),
                          escape_html(row.name.text()), escape_html(row.method));
    }
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", image, caption_of(row));
  }

  Result<void> write_sheet() const {
    if (columns_.empty()) return {};
    return write_picture(folder_ / file_name(shown_.name.text()), join(columns_));
  }

 private:
  /// The surface above the texture coordinates.
  Result<Image> draw(const DecalMap& map) {
    std::vector<Image> pictures;
    if (device_ != nullptr) {
      if (!view_) view_ = view_case(site_, *shown_.input, map);
      APPLIQUE_TRY(pictures.emplace_back(), picture_of_model(*device_, site_, *shown_.input, map, *view_));
    }
    pictures.push_back(picture_of_coordinates(site_, *shown_.input, map));
    return stack(pictures);
  }

  const std::filesystem::path& folder_;
  const Site& site_;
  const Case& shown_;
  const Device* device_;
  std::optional<CaseView> view_;
  std::vector<Image> columns_;
};

/// The pictures of a case and their captions, in HTML.
Result<std::string> figures_of(const Case& shown, const std::filesystem::path& folder,
                               const Comparison& comparison, const Device* device) {
  CasePictures pictures(folder, comparison.sites[shown.site], shown, device);
  std::string html =
      fmt::format("<p>{}, {} features:</p>\n<div class=\"methods\">\n", shown.name.region, shown.name.pins);
  for (const Row& row : comparison.rows) {
    if (row.name != shown.name) continue;
    APPLIQUE_TRY(const std::string figure, pictures.add(row));
    html += figure;
  }
  APPLIQUE_CHECK(pictures.write_sheet());
  return html + "</div>\n";
}

Result<std::string> sections(const std::filesystem::path& folder, const Comparison& comparison,
                             const std::vector<SiteSource>& sources, const Device* device) {
  std::string html;
  for (const SiteSource& source : sources) {
    const TextTable table = site_table(comparison.rows, source.name);
    if (table.rows.empty()) continue;
    html += fmt::format("<h2>{}</h2>\n<p>{}.</p>\n", escape_html(source.name), escape_html(source.about));
    for (const Case& shown : comparison.cases) {
      if (shown.name.site != source.name || !is_pictured(shown.name) || !shown.input) continue;
      APPLIQUE_TRY(const std::string figures, figures_of(shown, folder, comparison, device));
      html += figures;
    }
    html += "<details><summary>All figures</summary>\n" + to_html(table) + "</details>\n";
  }
  return html;
}

Result<std::string> page(const std::filesystem::path& folder, const Comparison& comparison,
                         const std::vector<SiteSource>& sources, const Device* device) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Comparison</title>\n" +
      std::string(style) + "</head><body>\n<h1>Comparison</h1>\n" + to_html(summary_table(comparison.rows));
  for (const std::string& note : comparison.notes) html += "<p><b>" + escape_html(note) + "</b></p>\n";
  for (const std::string& paragraph : explanations()) html += "<p>" + escape_html(paragraph) + "</p>\n";
  html +=
      "<p>Upper pictures: a checkered image on the surface, a ring on it where a feature is pinned, and a "
      "ball "
      "on the surface where it is pinned to. Lower pictures: the texture coordinates of the faces in the "
      "image; "
      "white faces keep their size, in vermilion ones the image is drawn out, in blue ones pressed together "
      "(full colour: by two), black ones are turned over; a ring where a feature belongs, an orange point "
      "where "
      "the map has it.</p>\n";
  APPLIQUE_TRY(const std::string body, sections(folder, comparison, sources, device));
  return html + body + "</body></html>\n";
}

}  // namespace

bool is_pictured(const CaseName& name) {
  constexpr int shown_pins = 5;
  return name.region == "star" && name.pins == shown_pins;
}

Result<void> write_page(const std::filesystem::path& folder, const Comparison& comparison,
                        const std::vector<SiteSource>& sources, const Device* device) {
  APPLIQUE_CHECK(make_folder(folder / "pictures"));
  APPLIQUE_CHECK(write_file(folder / "table.csv", to_csv(full_table(comparison.rows))));
  APPLIQUE_CHECK(write_file(folder / "table.md", to_markdown(comparison, sources)));
  APPLIQUE_TRY(const std::string html, page(folder, comparison, sources, device));
  return write_file(folder / "index.html", html);
}

}  // namespace applique::compare
