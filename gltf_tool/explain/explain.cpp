#include "explain/explain.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "applique/region/clusters.h"
#include "applique/region/influence.h"
#include "applique/region/triangulation.h"

#include "explain/digits.h"
#include "explain/distortion.h"
#include "explain/image_view.h"
#include "explain/model_view.h"
#include "explain/palette.h"
#include "explain/plane_view.h"

namespace applique {
namespace {

using namespace draw;
using Step = SolveTrace::Step;

constexpr double faded = 0.45;            // how much of the image is left under drawings
constexpr double grid_spacing = 0.25;     // plane units: an eighth of the image's longer side
constexpr std::size_t growth_frames = 6;  // at most, when no step is named

constexpr double legend_share = 0.3;  // of a panel's height

constexpr double group_strength = 0.7;  // of a group's colour on white

const Rgba inside_fill = mix(palette::white, palette::sky, 0.45);
const Rgba outside_fill = mix(palette::white, palette::orange, 0.35);
const Rgba no_fill = {0, 0, 0, 0};

/// A picture in the making.
class Picture {
 public:
  Picture(const Model& model, const SolvedDecal& decal, const Device* device, const ExplainOptions& options)
      : model_(model),
        decal_(decal),
        device_(device),
        options_(options),
        targets_(targets_of(decal)),
        canvas_(options.size.width, options.size.height) {
    const Box whole = {{0, 0},
                       {static_cast<double>(options.size.width), static_cast<double>(options.size.height)}};
    canvas_.fill(whole.outline(), solid(palette::white));
  }

  Result<Image> draw() {
    switch (options_.stage) {
      case Stage::region:
        draw_region();
        break;
      case Stage::graph:
        draw_graph();
        break;
      case Stage::paths:
        APPLIQUE_CHECK(draw_paths());
        break;
      case Stage::seed:
        APPLIQUE_CHECK(draw_seed());
        break;
      case Stage::growth:
        APPLIQUE_CHECK(draw_growth());
        break;
      case Stage::warp:
        APPLIQUE_CHECK(draw_warp());
        break;
      case Stage::influence:
        draw_influence();
        break;
      case Stage::patch:
        APPLIQUE_CHECK(draw_final_patch());
        break;
      case Stage::distortion:
        APPLIQUE_CHECK(draw_both_distortions());
        break;
    }
    Image image = canvas_.image();
    image.channels = 3;
    return image;
  }

 private:
  [[nodiscard]] double image_aspect() const {
    return decal_.region.frame().width / decal_.region.frame().height;
  }
  [[nodiscard]] std::vector<Box> boxes(std::size_t count) const {
    return lay_out(options_.size, count, image_aspect());
  }

  /// The faded image with its contour; returns where it is.
  PlaneView draw_base(const Box& box, double strength = faded) {
    const PlaneView view = view_of_image(decal_, box);
    draw_image(canvas_, decal_, view, strength);
    draw_contour(canvas_, decal_.region.polygon(), view, pen_for(box).line);
    return view;
  }

  /// The image with pairs of features, thin ones below bold ones.
  void draw_pairs_panel(const Box& box, std::span<const FeaturePair> thin, std::span<const FeaturePair> bold,
                        const Rgba& colour) {
    const PlaneView view = draw_base(box);
    const Pen pen = pen_for(box);
    draw_pairs(canvas_, targets_, thin, view, pen.line, mix(palette::ink, palette::white, 0.35));
    draw_pairs(canvas_, targets_, bold, view, pen.bold, colour);
    draw_features(canvas_, targets_, view, pen);
  }

  /// The groups that move the image; where it moves as one, those that the region would have.
  [[nodiscard]] std::vector<std::uint32_t> groups() const {
    return decal_.map.groups > 1 ? decal_.map.feature_groups
                                 : cluster_features(decal_.region, targets_, decal_.map.graph);
  }

  void draw_region() {
    const auto panels = boxes(4);
    const Pen pen = pen_for(panels[0]);
    const FeatureGraph& graph = decal_.map.graph;
    const PlaneView view = draw_base(panels[0], 1);
    draw_features(canvas_, targets_, view, pen);
    draw_pairs_panel(panels[1], graph.visible, {}, palette::ink);
    const RegionTriangulation mesh = triangulate_region(decal_.region, targets_, graph.planar);
    draw_features(canvas_, targets_, draw_mesh(mesh, panels[2]), pen);
    draw_features(canvas_, targets_, draw_mesh(mesh, panels[3]), pen, groups());
  }

  /// A triangulation of the region with its contour; returns where it is.
  PlaneView draw_mesh(const RegionTriangulation& mesh, const Box& box) {
    const PlaneView view = draw_base(box);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.neighbours[t][k] < static_cast<std::int32_t>(t)) continue;  // drawn from there; the contour
        canvas_.line({view(mesh.points[mesh.triangles[t][(k + 1) % 3]]),
                      view(mesh.points[mesh.triangles[t][(k + 2) % 3]])},
                     pen_for(box).thin, solid(mix(palette::ink, palette::white, 0.3)));
      }
    return view;
  }

  void draw_graph() {
    const auto panels = boxes(3);
    const FeatureGraph& graph = decal_.map.graph;
    draw_pairs_panel(panels[0], graph.visible, {}, palette::ink);
    draw_pairs_panel(panels[1], {}, graph.planar, palette::green);
    draw_pairs_panel(panels[2], graph.planar, graph.tree, palette::blue);
  }

  /// The solver's paths on the surface, from feature to feature.
  [[nodiscard]] SurfaceLines paths_on_surface(double width) const {
    return {decal_.trace.paths, width, palette::blue};
  }

  Result<void> draw_on_model(const Box& box, const ModelDrawing& drawing) {
    APPLIQUE_ASSERT(device_ != nullptr);
    return draw_model(canvas_, *device_, model_, decal_, drawing, camera_for_drawing(decal_, box), box);
  }

  Result<void> draw_paths() {
    const auto panels = boxes(2);
    draw_pairs_panel(panels[0], {}, decal_.map.graph.tree, palette::blue);
    return draw_on_model(panels[1], {{}, {paths_on_surface(pen_for(panels[1]).bold)}});
  }

  /// A patch's faces and edges on the model.
  [[nodiscard]] ModelDrawing patch_on_model(const Patch& patch, const Box& box) const {
    return {{{faces_on_surface(patch), inside_fill}},
            {{edges_on_surface(decal_, patch), pen_for(box).thin, mix(palette::ink, palette::white, 0.2)}}};
  }

  Result<void> draw_seed() {
    const auto panels = boxes(2);
    const Step& seed = decal_.trace.steps.front();
    ModelDrawing drawing = patch_on_model(seed.patch, panels[0]);
    drawing.lines.push_back(paths_on_surface(pen_for(panels[0]).bold));
    APPLIQUE_CHECK(draw_on_model(panels[0], drawing));
    std::vector<Vec2> extent = seed.plane.raw();
    extent.insert(extent.end(), seed.contour.begin(), seed.contour.end());
    draw_step(seed, panels[1], fit(extent, panels[1]));
    return {};
  }

  /// A step's patch in the plane, coloured by what belongs to S, and the contour carried there.
  void draw_step(const Step& step, const Box& box, const PlaneView& view) {
    const Pen pen = pen_for(box);
    const Outline frame = box.outline();
    canvas_.begin_clip(std::span(&frame, 1));
    draw_patch(
        canvas_, step.patch, step.plane, view,
        [&](PatchFaceId q) {
          const auto& v = step.patch.faces[q].vertices;
          const bool inside =
              std::any_of(v.begin(), v.end(), [&](PatchVertexId w) { return step.inside[w] != 0; });
          return inside ? inside_fill : outside_fill;
        },
        pen.thin);
    draw_contour(canvas_, step.contour, view, pen.bold);
    draw_features(canvas_, step.features, view, pen);
    canvas_.end_clip();
  }

  Result<const Step*> find_step(std::size_t fallback) const {
    const std::size_t step = options_.step.value_or(fallback);
    if (step < decal_.trace.steps.size()) return &decal_.trace.steps[step];
    return fail(ErrorCode::option_invalid,
                fmt::format("decal '{}': no step {}; the growth has {}, counted from 0", decal_.job.name,
                            step, decal_.trace.steps.size()));
  }

  /// One step in the plane and on the model, or several in the plane, numbered.
  Result<void> draw_growth() {
    const std::vector<Step>& steps = decal_.trace.steps;
    if (options_.step) {
      APPLIQUE_TRY(const Step* step, find_step(0));
      const auto panels = boxes(2);
      draw_step(*step, panels[0], fit(step->contour, panels[0], 0.12));
      return draw_on_model(panels[1], patch_on_model(step->patch, panels[1]));
    }
    const std::size_t count = std::min(steps.size(), growth_frames);
    std::vector<std::size_t> shown;
    std::vector<Vec2> extent;
    for (std::size_t i = 0; i < count; ++i) {
      shown.push_back(count == 1 ? 0 : i * (steps.size() - 1) / (count - 1));
      const auto& contour = steps[shown.back()].contour;
      extent.insert(extent.end(), contour.begin(), contour.end());
    }
    // Patches on the way may be far larger than the last.
    extent.insert(extent.end(), steps.back().plane.begin(), steps.back().plane.end());
    const auto panels = lay_out(options_.size, count, aspect_of(extent));
    for (std::size_t i = 0; i < count; ++i) {
      draw_step(steps[shown[i]], panels[i], fit(extent, panels[i]));
      const double height = 1.6 * pen_for(panels[i]).mark;
      draw_number(canvas_, shown[i], panels[i].low + Vec2(height, height), height, solid(palette::ink));
    }
    return {};
  }

  /// The image with a grid and the ways of the features; and all of it in the plane.
  Result<void> draw_warp() {
    APPLIQUE_TRY(const Step* step, find_step(decal_.trace.steps.size() - 1));
    const auto panels = boxes(2);
    const Pen pen = pen_for(panels[0]);
    const ImageFrame& frame = decal_.region.frame();
    const Rgba grid = mix(palette::ink, palette::white, 0.3);

    const PlaneView image_view = draw_base(panels[0], 0.8);
    const Outline contour = image_view(decal_.region.polygon());
    canvas_.begin_clip(std::span(&contour, 1));
    for (double at = -1; at <= 1; at += grid_spacing) {
      canvas_.line({image_view({at, -1}), image_view({at, 1})}, pen.thin, solid(grid));
      canvas_.line({image_view({-1, at}), image_view({1, at})}, pen.thin, solid(grid));
    }
    canvas_.end_clip();
    draw_contour(canvas_, decal_.region.polygon(), image_view, pen.line);
    for (std::size_t k = 0; k < targets_.size(); ++k)
      canvas_.line({image_view(targets_[k]), image_view(step->features[k])}, pen.bold, solid(palette::blue));
    draw_features(canvas_, targets_, image_view, pen);

    const PlaneView plane_view = fit(step->contour, panels[1], 0.06);
    const double footprint = frame.pixels_per_unit() / plane_view.scale;
    const double half_line = 0.5 * pen.thin / plane_view.scale;
    paint_triangles(canvas_, step->plane.raw(), triangles_of(step->patch), plane_view, panels[1],
                    [&](std::size_t q, const std::array<double, 3>& weights) {
                      const auto& v = step->patch.faces[PatchFaceId(q)].vertices;
                      Vec2 z = 0;
                      for (std::size_t k = 0; k < 3; ++k) z += weights[k] * step->image[v[k]];
                      if (!decal_.region.contains(z)) return no_fill;
                      const auto off = [](double x) {
                        return std::abs(x - grid_spacing * std::round(x / grid_spacing));
                      };
                      if (std::min(off(z.real()), off(z.imag())) < half_line) return grid;
                      const Rgba colour = sample_image(decal_.image, frame.to_pixel(z), footprint);
                      return mix(palette::white, with_alpha(colour, 1), 0.8 * colour.a);
                    });
    draw_contour(canvas_, step->contour, plane_view, pen.line);
    draw_features(canvas_, step->features, plane_view, pen);
    return {};
  }

  /// The region coloured by how much each group of features moves it, and by the group that does most: the
  /// paper's segments.
  void draw_influence() {
    const auto panels = boxes(2);
    const std::vector<std::uint32_t> groups = this->groups();
    const InfluenceField field(decal_.region, targets_, decal_.map.graph, groups);
    const RegionTriangulation& mesh = field.triangulation();
    const auto labels = field.segment_labels();
    const auto blend = [&](std::size_t t, const std::array<double, 3>& weights) {
      Rgba sum = {0, 0, 0, 1};
      for (std::size_t k = 0; k < 3; ++k)
        for (std::uint32_t g = 0; g < field.groups(); ++g) {
          const double share = weights[k] * field.at_point(mesh.triangles[t][k])[g];
          sum.r += share * palette::group(g).r;
          sum.g += share * palette::group(g).g;
          sum.b += share * palette::group(g).b;
        }
      return mix(palette::white, sum, group_strength);
    };
    const auto label = [&](std::size_t t, const std::array<double, 3>&) {
      return mix(palette::white, palette::group(labels[t]), group_strength);
    };
    for (const auto& [box, colour] : {std::pair<Box, PlaceColour>{panels[0], blend}, {panels[1], label}}) {
      const PlaneView view = view_of_image(decal_, box);
      paint_triangles(canvas_, mesh.points, mesh.triangles, view, box, colour);
      draw_contour(canvas_, decal_.region.polygon(), view, pen_for(box).line);
      draw_features(canvas_, targets_, view, pen_for(box), groups);
    }
  }

  Result<void> draw_final_patch() {
    const auto panels = boxes(2);
    const DecalMap& map = decal_.map;
    APPLIQUE_CHECK(draw_on_model(panels[0], patch_on_model(map.patch, panels[0])));
    const PlaneView view = fit(map.image.raw(), panels[1]);
    draw_image(canvas_, decal_, view, 0.8);
    draw_patch(
        canvas_, map.patch, map.image, view, [](PatchFaceId) { return no_fill; },
        0.8 * pen_for(panels[1]).thin);
    draw_contour(canvas_, decal_.region.polygon(), view, pen_for(panels[1]).line);
    draw_features(canvas_, targets_, view, pen_for(panels[1]));
    return {};
  }

  /// Areas and angles, each on the model and in the image, with the meaning of the colours.
  Result<void> draw_both_distortions() {
    const auto panels = lay_out(options_.size, 2, 2 * image_aspect() + legend_share);
    for (const auto& [kind, panel] :
         {std::pair{Distortion::area, panels[0]}, std::pair{Distortion::angle, panels[1]}}) {
      const DistortionPicture picture = paint_distortion(decal_, kind);
      const double legend = legend_share * panel.size.imag();
      const Vec2 half(0.5 * (panel.size.real() - legend), panel.size.imag());
      ModelDrawing drawing;
      drawing.painting = &picture.painting;
      APPLIQUE_CHECK(draw_on_model({panel.low, half}, drawing));
      draw_distortion(canvas_, decal_, picture, {panel.low + half.real(), half});
      draw_legend(canvas_, picture, {panel.low + 2 * half.real(), {legend, panel.size.imag()}});
    }
    return {};
  }

  const Model& model_;
  const SolvedDecal& decal_;
  const Device* device_;
  const ExplainOptions& options_;
  std::vector<Vec2> targets_;  ///< The features in the image, plane units.
  Canvas canvas_;
};

}  // namespace

const std::vector<StageName>& stage_names() {
  static const std::vector<StageName> names = {
      {"region", Stage::region},       {"graph", Stage::graph},   {"paths", Stage::paths},
      {"seed", Stage::seed},           {"growth", Stage::growth}, {"warp", Stage::warp},
      {"influence", Stage::influence}, {"patch", Stage::patch},   {"distortion", Stage::distortion}};
  return names;
}

bool shows_model(const ExplainOptions& options) {
  switch (options.stage) {
    case Stage::paths:
    case Stage::seed:
    case Stage::patch:
    case Stage::distortion:
      return true;
    case Stage::growth:
      return options.step.has_value();
    default:
      return false;
  }
}

Result<Image> explain_decal(const Model& model, const SolvedDecal& decal, const Device* device,
                            const ExplainOptions& options) {
  return Picture(model, decal, device, options).draw();
}

}  // namespace applique
