// The comparison's own arithmetic, and coordinates from outside. What the methods are worth is not judged
// here.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "applique/image/image.h"

#include "compare/comparison.h"
#include "compare/external.h"
#include "compare/page.h"
#include "compare/patch_file.h"
#include "compare/pictures.h"
#include "compare/pins.h"
#include "compare/summary.h"
#include "compare/tables.h"

namespace applique::compare {
namespace {

constexpr double float_error = 1e-4;  // what the file's floats leave of the figures

/// A folder that goes away with the object.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("applique-compare-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path_ / name).rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path path_;
};

Comparison cases(const std::string& only) {
  return make_cases(own_sites(), only);
}

/// A case, its default map, and its patch as another program would get it.
struct Exported {
  Comparison comparison;
  const Case* made;
  DecalMap ours;
  PatchFile patch;

  explicit Exported(const std::string& name)
      : comparison(cases(name)),
        made(comparison.find(name)),
        ours(solve_decal(site().mesh, *made->input).value()) {
    const Folder folder;
    EXPECT_TRUE(write_patch(folder / "patch.glb", name, site(), ours, made->input->region.frame()));
    patch = read_patch(folder / "patch.glb").value();
  }
  [[nodiscard]] const Site& site() const { return comparison.sites[made->site]; }
  [[nodiscard]] Figures measure(const PatchFile& file) const {
    const auto map = external_map(site(), *made->input, ours, file);
    return row_of(made->name, "external", map.value()).figures.value();
  }
  [[nodiscard]] Figures own() const { return *row_of(made->name, "own", ours).figures; }
};

void expect_same(const Figures& a, const Figures& b) {
  EXPECT_NEAR(a.l2, b.l2, float_error);
  EXPECT_NEAR(a.linf, b.linf, 10 * float_error);
  EXPECT_NEAR(a.angle, b.angle, float_error);
  EXPECT_NEAR(a.area, b.area, float_error);
  EXPECT_EQ(a.flips, b.flips);
  EXPECT_NEAR(a.residual_px, b.residual_px, 0.01);
  EXPECT_NEAR(a.coverage, b.coverage, float_error);
}

TEST(Compare, EveryCaseHasARowOfEveryMethod) {
  Comparison comparison = cases("plane/");
  const auto methods = contenders();
  solve_cases(comparison, methods, [](const CaseName&) { return false; });
  ASSERT_EQ(comparison.cases.size(), comparison.layouts.size() * pin_counts.size());
  ASSERT_EQ(comparison.rows.size(), comparison.cases.size() * methods.size());
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    const Row& row = comparison.rows[i];
    EXPECT_EQ(row.name, comparison.cases[i / methods.size()].name);
    EXPECT_EQ(row.method, methods[i % methods.size()].name);
    EXPECT_NE(row.figures.has_value(), row.status != "solved") << row.name.text() << ": " << row.status;
    EXPECT_FALSE(row.map);
  }
  const std::string csv = to_csv(full_table(comparison.rows));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'),
            static_cast<std::ptrdiff_t>(comparison.rows.size()) + 1);
}

/// Where maps differ most: on most of a sphere, round a spike, behind an ear. (The whole table takes two
/// minutes.)
TEST(Compare, TheDefaultIsStretchedLeastFlipsNothingAndMeetsEveryPin) {
  for (const char* surface : {"sphere-2.6/", "bump/", "bust-ear/"}) {
    Comparison comparison = cases(surface);
    solve_cases(comparison, contenders(), [](const CaseName&) { return false; });
    const MethodSummary ours = summarise(comparison.rows).front();
    ASSERT_EQ(ours.method, "isometric");
    EXPECT_EQ(ours.solved, ours.rows) << surface;
    EXPECT_GE(ours.least_l2, 0.75 * ours.rows) << surface;
    EXPECT_LE(ours.worst_ratio, 1.01) << surface;
    EXPECT_EQ(ours.flips, 0U) << surface;
    EXPECT_LT(ours.worst_residual_px, 1e-9) << surface;
    for (const Row& row : comparison.rows)
      if (row.method == "isometric" && row.figures) {
        EXPECT_LT(row.figures->coverage, 1.003) << row.name.text() << ": shown twice";
      }
  }
}

TEST(Compare, PinsAreWhereThePictureIsUndistorted) {
  const Comparison comparison = cases("plane/star/9");
  const Site& site = comparison.sites.at(0);
  const DecalInput& input = comparison.cases.at(0).input.value();
  ASSERT_EQ(input.features.size(), 9U);
  const double unit = site.width / image_size;
  for (const Feature& feature : input.features) {
    const Vec3 offset = position_of(site.mesh, feature.surface) - position_of(site.mesh, site.anchor);
    EXPECT_NEAR(offset.x(), unit * (feature.image.x - input.features[0].image.x), 1e-6);
    EXPECT_NEAR(offset.y(), -unit * (feature.image.y - input.features[0].image.y), 1e-6);
  }
}

TEST(Compare, APinThatTheMapDoesNotCoverIsAnError) {
  Comparison comparison = cases("plane/disc/1");
  comparison.sites[0].width = 20;  // ten times the plane
  const Layout& layout = comparison.layouts[0];
  const auto map = solve_decal(comparison.sites[0].mesh, one_pin(comparison.sites[0], layout, "wide"));
  const auto pins = pins_of_map(map.value(), layout, 9);
  ASSERT_FALSE(pins);
  EXPECT_NE(pins.error().message.find("pin 1 at (405, 235)"), std::string::npos) << pins.error().message;
}

TEST(Compare, OurCoordinatesFromOutsideScoreTheSame) {
  for (const char* name : {"sphere-1.3/disc/5", "sphere-1.3/strip/1"}) {
    SCOPED_TRACE(name);
    const Exported exported(name);
    EXPECT_EQ(exported.patch.name, name);
    EXPECT_EQ(exported.patch.triangles.size(), exported.ours.patch.faces.size());
    expect_same(exported.measure(exported.patch), exported.own());

    PatchFile turned = exported.patch;
    for (auto& [u, v] : turned.uvs) {
      const Vec2 z = std::polar(0.3, 2.0) * Vec2(u, v);
      u = 5 + z.real();
      v = -7 + z.imag();
    }
    expect_same(exported.measure(turned), exported.own());
  }
}

TEST(Compare, VerticesSplitAlongSeamsAreJoined) {
  const Exported exported("sphere-1.3/disc/5");
  PatchFile soup{exported.patch.name, {}, {}, {}};
  for (const auto& triangle : exported.patch.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t i : triangle) {
      soup.positions.push_back(exported.patch.positions[i]);
      soup.uvs.push_back(exported.patch.uvs[i]);
    }
    soup.triangles.push_back({first + 1, first + 2, first});  // a file may begin at any corner
  }
  expect_same(exported.measure(soup), exported.own());

  // One triangle moved away in the texture is a chart of its own: the rest is measured as before.
  PatchFile torn = soup;
  const Figures whole = exported.measure(soup);
  for (std::size_t i = 0; i < 3; ++i) torn.uvs[i][0] += 100;
  const Figures figures = exported.measure(torn);
  EXPECT_LT(figures.coverage, whole.coverage);
  EXPECT_NEAR(figures.l2, whole.l2, 0.01);
}

TEST(Compare, AKnownMapHasItsFigures) {
  const Exported exported("plane/disc/5");
  PatchFile drawn_out = exported.patch;
  for (auto& [u, v] : drawn_out.uvs) u *= 2;
  const Figures figures = exported.measure(drawn_out);
  // Singular values, surface to image, k and k / 2 with k^2 / 2 = 1 for equal areas.
  EXPECT_NEAR(figures.l2, std::sqrt(1.25), float_error);
  EXPECT_NEAR(figures.linf, std::sqrt(2.0), 10 * float_error);
  EXPECT_NEAR(figures.angle, 2, float_error);
  EXPECT_NEAR(figures.area, 1, float_error);
  EXPECT_EQ(figures.flips, 0U);
  // Every pin misses by what the best similarity about the first leaves of twice the width.
  const std::vector<Feature>& pins = exported.made->input->features;
  std::vector<Vec2> to, from;
  Vec2 scale = 0;
  double norm = 0, worst = 0;
  for (const Feature& pin : pins) {
    to.emplace_back(pin.image.x - pins[0].image.x, pins[0].image.y - pin.image.y);
    from.emplace_back(2 * to.back().real(), to.back().imag());
    scale += std::conj(from.back()) * to.back();
    norm += std::norm(from.back());
  }
  for (std::size_t k = 0; k < to.size(); ++k)
    worst = std::max(worst, std::abs(scale / norm * from[k] - to[k]));
  EXPECT_GT(worst, 10);
  EXPECT_NEAR(figures.residual_px, worst, 0.01);

  PatchFile mirrored = exported.patch;
  for (auto& [u, v] : mirrored.uvs) u = -u;
  EXPECT_GT(exported.measure(mirrored).flips, 100U);
}

TEST(Compare, FilesOfAnotherPatchAreRefused) {
  const Exported exported("plane/strip/2");
  PatchFile moved = exported.patch;
  moved.positions[3].z() += 0.01;
  const auto map = external_map(exported.site(), *exported.made->input, exported.ours, moved);
  ASSERT_FALSE(map);
  EXPECT_NE(map.error().message.find("vertex 3"), std::string::npos) << map.error().message;

  PatchFile rewired = exported.patch;
  rewired.triangles[0] = {0, 1, static_cast<std::uint32_t>(rewired.positions.size() - 1)};
  EXPECT_FALSE(external_map(exported.site(), *exported.made->input, exported.ours, rewired));

  const Folder folder;
  ASSERT_TRUE(write_patch(folder / "patch.glb", "elsewhere/disc/5", exported.site(), exported.ours,
                          exported.made->input->region.frame()));
  const auto row = measure_external(exported.comparison, "program", folder / "patch.glb");
  ASSERT_FALSE(row);
  EXPECT_NE(row.error().message.find("elsewhere/disc/5"), std::string::npos) << row.error().message;
}

Row row(const std::string& site, int pins, const std::string& method, double l2, std::uint32_t flips = 0,
        double coverage = 1, double residual = 0) {
  Row made{{site, "disc", pins}, method, "solved", Figures(), {}};
  made.figures->l2 = l2;
  made.figures->flips = flips;
  made.figures->coverage = coverage;
  made.figures->residual_px = residual;
  return made;
}

TEST(Summary, ComparesTheMethodsThatSolveWithinEachCase) {
  Row unsolved{{"c", "disc", 5}, "b", "not solved", {}, {}};
  const auto summaries =
      summarise({row("a", 1, "a", 9), row("a", 1, "b", 1),  // one pin: not counted
                 row("a", 2, "a", 1.2), row("a", 2, "b", 1.0, 7, 1, 30), row("b", 5, "a", 1.1),
                 row("b", 5, "b", 1.0, 0, 0.5, 20), row("c", 5, "a", 2, 0, 0.9), unsolved,
                 row("d", 9, "a", 1.5), row("d", 9, "b", 1.50001, 0, 0.995), row("e", 5, "a", 1.1),
                 row("e", 5, "b", 1.0, 1, 13),                          // folded over itself
                 row("f", 5, "a", 1.1), row("f", 5, "b", 1.0, 0, 1.5)}  // shown twice
      );
  ASSERT_EQ(summaries.size(), 2U);
  const MethodSummary &a = summaries[0], &b = summaries[1];
  EXPECT_EQ(a.method, "a");
  EXPECT_EQ(a.rows, 6);
  EXPECT_EQ(a.solved, 6);
  EXPECT_EQ(a.least_l2, 2);  // alone in c, tied in d
  EXPECT_EQ(a.whole, 6);
  EXPECT_EQ(a.least_l2_whole, 6);
  EXPECT_DOUBLE_EQ(a.worst_ratio, 1.2);
  EXPECT_DOUBLE_EQ(a.median_ratio, 1.1);
  EXPECT_DOUBLE_EQ(a.least_coverage, 0.9);
  EXPECT_EQ(b.rows, 6);
  EXPECT_EQ(b.solved, 5);
  EXPECT_EQ(b.least_l2, 5);
  EXPECT_EQ(b.whole, 1);  // in d alone
  EXPECT_EQ(b.least_l2_whole, 1);
  EXPECT_NEAR(b.worst_ratio, 1, 1e-4);
  EXPECT_EQ(b.flips, 8U);
  EXPECT_DOUBLE_EQ(b.worst_residual_px, 30);
}

TEST(TextTable, QuotesWhatItsFormsReserve) {
  const TextTable table{{"a", "b"}, {{"x, \"y\"", "p | <q>"}}};
  EXPECT_EQ(to_csv(table), "a,b\r\n\"x, \"\"y\"\"\",p | <q>\r\n");
  EXPECT_EQ(to_markdown(table), "| a | b |\n|---|---|\n| x, \"y\" | p \\| <q> |\n");
  EXPECT_NE(to_html(table).find("<td>x, &quot;y&quot;</td><td>p | &lt;q&gt;</td>"), std::string::npos);
}

TEST(Page, BeginsWithTheSummaryAndShowsItsPictures) {
  Comparison comparison = cases("sphere-1.0/star/5");
  solve_cases(comparison, contenders(), is_pictured);
  const Folder folder;
  ASSERT_TRUE(write_page(folder / "page", comparison, own_sites(), nullptr));
  const std::string markdown = folder.read("page/table.md"), html = folder.read("page/index.html");
  EXPECT_EQ(markdown.find("# Comparison\n\n| method | solved |"), 0U);
  EXPECT_EQ(folder.read("page/table.csv"), to_csv(full_table(comparison.rows)));
  const std::regex source("src=\"([^\"]*)\"");
  std::ptrdiff_t shown = 0;
  for (auto at = std::sregex_iterator(html.begin(), html.end(), source); at != std::sregex_iterator();
       ++at, ++shown)
    EXPECT_TRUE(std::filesystem::exists(folder / ("page/" + (*at)[1].str()))) << (*at)[1];
  EXPECT_EQ(shown, std::count_if(comparison.rows.begin(), comparison.rows.end(),
                                 [](const Row& r) { return r.map.has_value(); }));
  EXPECT_GT(shown, 0);
  EXPECT_EQ(read_image(folder / "page/sphere-1.0-star-5.png").value().width, shown * picture_size);
}

TEST(Blender, UnwrapsAnExportedPatch) {
  const char* has_numpy = "blender -b --python-exit-code 1 --python-expr 'import numpy' >/dev/null 2>&1";
  if (std::system(has_numpy) != 0)  // NOLINT: a command of our own
    GTEST_SKIP() << "Blender and its numpy are not installed (Debian: apt-get install blender python3-numpy)";
  const std::string name = "sphere-1.3/disc/5";
  const Exported exported(name);
  const Folder folder;
  ASSERT_TRUE(write_patch(folder / "patch.glb", name, exported.site(), exported.ours,
                          exported.made->input->region.frame()));
  const std::string command = "blender -b --python-exit-code 1 -P '" APPLIQUE_UNWRAP_SCRIPT "' -- '" +
                              (folder / "patch.glb").string() + "' '" + (folder / "unwrapped.glb").string() +
                              "' >/dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT: a command of our own
  const auto measured = measure_external(exported.comparison, "Blender", folder / "unwrapped.glb");
  ASSERT_TRUE(measured) << measured.error().message;
  const Figures& figures = measured->figures.value();
  EXPECT_EQ(figures.flips, 0U);
  EXPECT_LT(figures.angle, 1.1);  // conformal, but for the triangles' size
  EXPECT_GT(figures.coverage, 0.9);
  EXPECT_GT(figures.l2, 1);
}

}  // namespace
}  // namespace applique::compare
