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

/// Draws the rows of cases as they come; all of a case are seen from where its first map is seen best.
class Gallery {
 public:
  Gallery(const std::filesystem::path& folder, const Comparison& comparison, const Device* device)
      : folder_(folder), comparison_(comparison), device_(device) {}

  /// The figures of a case, in HTML.
  Result<std::string> draw(const Case& shown) {
    std::string html;
    view_.reset();
    for (const Row& row : comparison_.rows) {
      if (row.name != shown.name) continue;
      html += "<figure>";
      if (row.map) {
        APPLIQUE_TRY(const std::string images, draw_map(shown, row));
        html += images;
      }
      html += fmt::format("<figcaption>{}</figcaption></figure>\n", caption_of(row));
    }
    return html;
  }

 private:
  Result<std::string> draw_map(const Case& shown, const Row& row) {
    const Site& site = comparison_.sites[shown.site];
    std::string html;
    if (device_ != nullptr) {
      if (!view_) view_ = view_case(site, *shown.input, *row.map);
      APPLIQUE_TRY(const Image model, picture_of_model(*device_, site, *shown.input, *row.map, *view_));
      APPLIQUE_TRY(const std::string image, add(row, "model", model));
      html += image;
    }
    APPLIQUE_TRY(const std::string image,
                 add(row, "coordinates", picture_of_coordinates(site, *shown.input, *row.map)));
    return html + image;
  }

  /// Writes the picture, and shows it.
  Result<std::string> add(const Row& row, const char* what, const Image& image) {
    std::string file =
        fmt::format("{}-{}-{}-{}-{}.png", row.name.site, row.name.region, row.name.pins, row.method, what);
    std::replace_if(
        file.begin(), file.end(), [](char c) { return c == ' ' || c == '/'; }, '-');
    APPLIQUE_CHECK(write_picture(folder_ / "pictures" / file, image));
    return fmt::format("<img src=\"pictures/{0}\" alt=\"{1} of {2} by {3}\">", escape_html(file), what,
                       escape_html(row.name.text()), escape_html(row.method));
  }

  const std::filesystem::path& folder_;
  const Comparison& comparison_;
  const Device* device_;
  std::optional<CaseView> view_;
};

Result<std::string> sections(const std::filesystem::path& folder, const Comparison& comparison,
                             const std::vector<SiteSource>& sources, const Device* device) {
  Gallery gallery(folder, comparison, device);
  std::string html;
  for (const SiteSource& source : sources) {
    const TextTable table = site_table(comparison.rows, source.name);
    if (table.rows.empty()) continue;
    html += fmt::format("<h2>{}</h2>\n<p>{}.</p>\n", escape_html(source.name), escape_html(source.about));
    for (const Case& shown : comparison.cases) {
      if (shown.name.site != source.name || !is_pictured(shown.name) || !shown.input) continue;
      APPLIQUE_TRY(const std::string figures, gallery.draw(shown));
      html += fmt::format("<p>{}, {} features:</p>\n<div class=\"methods\">\n{}</div>\n", shown.name.region,
                          shown.name.pins, figures);
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
