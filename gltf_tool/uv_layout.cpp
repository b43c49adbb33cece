#include "uv_layout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bake_plan.h"
#include "texel_map.h"
#include "unroll.h"
#include "uv_atlas.h"
#include "uv_charts.h"
#include "uv_raster.h"

namespace applique {
namespace {

constexpr int largest_side = 8192;
constexpr int best_grid = 64;
constexpr double slimmest = 32;       // length to width of what a circle on the surface is in a layout
constexpr double coarsest = 32;       // pixels to a texel, along a line
constexpr double most_blurred = 0.1;  // of the decals' pixels
constexpr double fine_enough = 0.5;   // texels to a pixel: below, a bake warns

std::array<Vec3, 3> surface_corners(const SolvedJob& job, const SeparatedTriangle& t) {
  const ModelPart& part = job.model.parts[t.part];
  const auto& corners = part.triangles[t.triangle];
  return {part.positions[corners[0]], part.positions[corners[1]], part.positions[corners[2]]};
}

/// Length to width of what a circle becomes under the affine map between the triangles; infinite where one
/// has collapsed.
double slimness(const std::array<Texel, 3>& from, const std::array<Texel, 3>& to) {
  if (doubled_area(from) == 0) return HUGE_VAL;
  const auto [longer, shorter] = half_axes(map_between(from, to));
  return shorter > 0 ? longer / shorter : HUGE_VAL;
}

const PatchFace& patch_face(const SolvedJob& job, const SeparatedTriangle& t) {
  return job.decals[t.decal].map.patch.faces[t.faces.front()];
}

/// Whether the decal has the triangle in one piece.
bool is_whole(const SolvedJob& job, const SeparatedTriangle& t) {
  return job.decals[t.decal].surface->is_whole(patch_face(job, t).mesh_face);
}

/// A patch face in the embedding or in the image, in pixels.
std::array<Texel, 3> pixel_corners(const SolvedDecal& decal, const IdVector<PatchVertexId, Vec2>& places,
                                   const PatchFace& face) {
  const double pixels = decal.region.frame().pixels_per_unit();
  std::array<Texel, 3> corners = {};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 place = places[face.vertices[k]];
    corners[k] = {pixels * place.real(), -pixels * place.imag()};
  }
  return corners;
}

/// Texels a side that an atlas in place of a texture may have for the decal's sake.
int largest_wanted(const SolvedJob& job, const LayoutRequest& request) {
  return std::min(std::max({job.job.texture_size, request.texture[0], request.texture[1]}), largest_side);
}

/// Charts a part of the triangles and remembers the place of their corners.
class Charting {
 public:
  Charting(const SolvedJob& job, const LayoutRequest& request) : job_(job), request_(request) {
    corners.resize(request.triangles.size());
  }

  void run() {
    std::vector<std::uint32_t> unwrapped;
    std::vector<std::uint32_t> others;
    for (std::uint32_t i = 0; i < request_.triangles.size(); ++i)
      (request_.triangles[i].unwrap ? unwrapped : others).push_back(i);
    roll_out(follow_decals(unwrapped));
    roll_out(follow_decals(keep_old_layout(others)));
    if (request_.created_size != 0) return;
    for (const AtlasChart& chart : charts)
      if (!chart.kept) refine(chart);
    bound();
  }

  std::vector<std::array<Texel, 3>> corners;  ///< Old texels where the chart is kept, else new ones.
  std::vector<AtlasChart> charts;

 private:
  /// A chart has a texel for each pixel of the decal; more where the old texture has.
  void refine(const AtlasChart& chart) {
    constexpr double most = 16;
    std::vector<std::array<Texel, 3>> from;
    std::vector<std::array<Texel, 3>> to;
    for (const std::uint32_t i : chart.triangles) {
      const SeparatedTriangle& t = request_.triangles[i];
      if (job_.model.parts[t.part].uvs.empty()) return;
      from.push_back(corners[i]);
      to.push_back(texels_of(job_, t, request_.texture));
    }
    // Texels that lie askew to the old ones show these as they were when they are finer.
    const double finer = request_.triangles[chart.triangles.front()].unwrap ? 2 : 1;
    const double density = std::clamp(finer * usual_stretch(from, to), 1.0, most);
    for (const std::uint32_t i : chart.triangles)
      for (Texel& corner : corners[i])
        for (double& x : corner) x *= density;
  }

  /// What is laid out afresh takes no more than a part of the texture that is asked for: where a decal is
  /// small in its triangles, these would need many texels for each of its pixels.
  void bound() {
    constexpr double most = 0.5;
    double area = 0;
    for (const AtlasChart& chart : charts)
      for (const std::uint32_t i : chart.triangles)
        if (!chart.kept) area += 0.5 * std::abs(doubled_area(corners[i]));
    const double side = largest_wanted(job_, request_);
    const double scale = std::sqrt(most / area) * side;
    if (!(scale < 1)) return;
    for (const AtlasChart& chart : charts)
      for (const std::uint32_t i : chart.triangles)
        if (!chart.kept)
          for (Texel& corner : corners[i])
            for (double& x : corner) x *= scale;
  }

  /// Returns the triangles that cannot keep theirs.
  std::vector<std::uint32_t> keep_old_layout(const std::vector<std::uint32_t>& triangles) {
    std::map<std::array<double, 5>, std::uint32_t> places;
    std::vector<std::uint32_t> members;
    std::vector<ChartTriangle> list;
    std::vector<std::uint32_t> rest;
    for (const std::uint32_t i : triangles) {
      const SeparatedTriangle& t = request_.triangles[i];
      if (!has_texture_space(job_, t, request_.texture)) {
        rest.push_back(i);
        continue;
      }
      ChartTriangle triangle{texels_of(job_, t, request_.texture), {}};
      const auto surface = surface_corners(job_, t);
      for (std::size_t k = 0; k < 3; ++k) {
        const Texel& texel = triangle.corners[k];
        triangle.vertices[k] =
            places
                .try_emplace({surface[k].x(), surface[k].y(), surface[k].z(), texel[0], texel[1]},
                             static_cast<std::uint32_t>(places.size()))
                .first->second;
      }
      members.push_back(i);
      list.push_back(triangle);
    }
    add_charts(members, list, true);
    return rest;
  }

  /// Returns the triangles that the decals' embeddings do not lay out.
  std::vector<std::uint32_t> follow_decals(const std::vector<std::uint32_t>& triangles) {
    std::map<std::pair<std::size_t, PatchVertexId>, std::uint32_t> places;
    std::vector<std::uint32_t> members;
    std::vector<ChartTriangle> list;
    std::vector<std::uint32_t> rest;
    for (const std::uint32_t i : triangles) {
      const SeparatedTriangle& t = request_.triangles[i];
      const SolvedDecal& decal = job_.decals[t.decal];
      ChartTriangle triangle{pixel_corners(decal, decal.map.plane, patch_face(job_, t)), {}};
      if (!is_whole(job_, t) || !(slimness(flatten(job_, t), triangle.corners) <= slimmest)) {
        rest.push_back(i);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k)
        triangle.vertices[k] = places
                                   .try_emplace({t.decal, patch_face(job_, t).vertices[k]},
                                                static_cast<std::uint32_t>(places.size()))
                                   .first->second;
      members.push_back(i);
      list.push_back(triangle);
    }
    add_charts(members, list, false);
    return rest;
  }

  void roll_out(const std::vector<std::uint32_t>& members) {
    std::vector<SeparatedTriangle> triangles;
    for (const std::uint32_t i : members) triangles.push_back(request_.triangles[i]);
    const Unrolled unrolled = unroll(job_, triangles);
    for (std::size_t j = 0; j < members.size(); ++j) corners[members[j]] = unrolled.corners[j];
    add_charts(members, grow_charts(unrolled.corners, unrolled.beside), false);
  }

  void add_charts(const std::vector<std::uint32_t>& members, const std::vector<ChartTriangle>& list,
                  bool kept) {
    for (std::size_t j = 0; j < members.size(); ++j) corners[members[j]] = list[j].corners;
    add_charts(members, grow_charts(list), kept);
  }

  void add_charts(const std::vector<std::uint32_t>& members,
                  std::vector<std::vector<std::uint32_t>> grown_charts, bool kept) {
    for (auto& grown : grown_charts) {
      for (std::uint32_t& t : grown) t = members[t];
      charts.push_back({std::move(grown), kept, {0, 0}, {0, 0, 0, 0}});
    }
  }

  const SolvedJob& job_;
  const LayoutRequest& request_;
};

int floor_to(double value, int grid) {
  return static_cast<int>(std::floor(value / grid)) * grid;
}

int ceil_to(double value, int grid) {
  return static_cast<int>(std::ceil(value / grid)) * grid;
}

/// Finds the scale at which charts fit.
class Packing {
 public:
  Packing(const LayoutRequest& request, Charting charting)
      : request_(request), corners_(std::move(charting.corners)), charts_(std::move(charting.charts)) {}

  /// With `fineness` texels a unit, at most `most` texels a side.
  std::optional<UvLayout> pack(double scale, int fineness, int gutter_texels, int most, int grid) const {
    UvLayout layout;
    layout.corners = corners_;
    layout.charts = charts_;
    layout.fineness = fineness;
    layout.scale = scale;
    layout.gutter = (gutter_texels + fineness - 1) / fineness;
    std::vector<AtlasBox> boxes;
    for (AtlasChart& chart : layout.charts) {
      const double factor = chart.kept ? scale : scale / fineness;
      std::array<double, 2> lower = {HUGE_VAL, HUGE_VAL};
      std::array<double, 2> upper = {-HUGE_VAL, -HUGE_VAL};
      for (const std::uint32_t t : chart.triangles)
        for (Texel& corner : layout.corners[t])
          for (std::size_t c = 0; c < 2; ++c) {
            corner[c] *= factor;
            lower[c] = std::min(lower[c], corner[c]);
            upper[c] = std::max(upper[c], corner[c]);
          }
      AtlasBox box;
      for (std::size_t c = 0; c < 2; ++c) {
        if (!(upper[c] - lower[c] < most) || !(std::abs(lower[c]) < 1e8)) return std::nullopt;
        const int first = floor_to(lower[c] - layout.gutter, grid);
        chart.shift[c] = first;
        (c == 0 ? box.width : box.height) = ceil_to(upper[c] + layout.gutter - first, grid);
      }
      boxes.push_back(box);
    }
    const auto size = pack_boxes_into(boxes, fineness, most);
    if (!size) return std::nullopt;
    layout.size = *size;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      AtlasChart& chart = layout.charts[i];
      chart.box = {boxes[i].x, boxes[i].y, boxes[i].width, boxes[i].height};
      chart.shift[0] -= boxes[i].x;
      chart.shift[1] -= boxes[i].y;
      for (const std::uint32_t t : chart.triangles)
        for (Texel& corner : layout.corners[t])
          for (std::size_t c = 0; c < 2; ++c) corner[c] -= chart.shift[c];
    }
    return layout;
  }

  /// At the old scale. Moved by multiples of many texels, charts keep as many levels of the old mip pyramid:
  /// of as many as cost little room.
  std::optional<UvLayout> pack_exactly(int fineness, int gutter, int most) const {
    constexpr double dearest = 1.5;
    auto least = pack(1, fineness, gutter, most, request_.grid);
    if (!least) return std::nullopt;
    const auto area = [](const UvLayout& layout) { return double{1} * layout.size[0] * layout.size[1]; };
    for (int grid = best_grid; grid > request_.grid; grid /= 2)
      if (auto layout = pack(1, fineness, gutter, most, grid))
        if (area(*layout) <= dearest * area(*least)) return layout;
    return least;
  }

  /// The largest scale that fits, below `upper`.
  std::optional<UvLayout> pack_scaled(double upper, int gutter, int most) const {
    std::optional<UvLayout> best;
    double low = 0;
    double high = upper;
    double tried = std::min(upper, 1.0);
    constexpr int halvings = 24;
    for (int i = 0; i < halvings && high - low > 0.01 * high; ++i) {
      if (auto layout = pack(tried, 1, gutter, most, 1)) {
        best = std::move(layout);
        low = tried;
      } else {
        high = tried;
      }
      tried = low == 0 ? high / 4 : std::sqrt(low * high);
    }
    return best;
  }

 private:
  std::optional<std::array<int, 2>> pack_boxes_into(std::vector<AtlasBox>& boxes, int fineness,
                                                    int most) const {
    if (request_.created_size == 0) return pack_atlas(boxes, fineness, most);
    for (const AtlasBox& box : boxes)
      if (box.width > most) return std::nullopt;
    if (pack_boxes(boxes, most) > most) return std::nullopt;
    return std::array<int, 2>{most, most};
  }

  const LayoutRequest& request_;
  std::vector<std::array<Texel, 3>> corners_;
  std::vector<AtlasChart> charts_;
};

/// The odd number of texels along an old one at which nearly all of the decals' pixels keep their detail: not
/// their mean, since old layouts may be much denser in places than in others.
int wanted_fineness(const SolvedJob& job, const LayoutRequest& request,
                    const std::vector<AtlasChart>& charts) {
  std::vector<std::pair<double, double>> triangles;  // Texels along a pixel; pixels.
  double pixels = 0;
  for (const AtlasChart& chart : charts) {
    if (!chart.kept) continue;
    for (const std::uint32_t i : chart.triangles) {
      const SeparatedTriangle& t = request.triangles[i];
      const double there = pixels_on(job, t);
      if (there == 0) continue;
      const double texels = 0.5 * std::abs(doubled_area(texels_of(job, t, request.texture)));
      triangles.emplace_back(std::sqrt(texels / there), there);
      pixels += triangles.back().second;
    }
  }
  std::sort(triangles.begin(), triangles.end());
  double texels = fine_enough;
  double blurred = 0;
  for (const auto& [along, there] : triangles) {
    blurred += there;
    texels = along;
    if (blurred > most_blurred * pixels) break;
  }
  return texels < 0.99 * fine_enough ? static_cast<int>(std::ceil(1 / texels)) | 1 : 1;
}

std::string no_room(const SolvedJob& job, const LayoutRequest& request) {
  return fmt::format(
      "decal '{}': its {} triangles need more texture space of their own than {} x {} texels; give it "
      "\"uv_conflict\": \"share\", or \"output\": \"overlay\"",
      job.decals[request.triangles.front().decal].job.name, request.triangles.size(), largest_side,
      largest_side);
}

}  // namespace

double pixels_on(const SolvedJob& job, const SeparatedTriangle& t) {
  const SolvedDecal& decal = job.decals[t.decal];
  double pixels = 0;
  double share = 0;  // of the triangle, that the faces are
  for (const PatchFaceId f : t.faces) {
    const PatchFace& face = decal.map.patch.faces[f];
    pixels += 0.5 * std::abs(doubled_area(pixel_corners(decal, decal.map.image, face)));
    const FaceCorners& corners = decal.surface->corners_in_source(face.mesh_face);
    share += std::abs(doubled_area({Texel{corners[0][1], corners[0][2]}, Texel{corners[1][1], corners[1][2]},
                                    Texel{corners[2][1], corners[2][2]}}));
  }
  return share > 0 ? pixels / share : 0;
}

std::array<Texel, 3> texels_of(const SolvedJob& job, const SeparatedTriangle& t,
                               const std::array<int, 2>& texture) {
  const ModelPart& part = job.model.parts[t.part];
  std::array<Texel, 3> texels = {};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& uv = part.uvs[part.triangles[t.triangle][k]];
    texels[k] = {uv[0] * texture[0], uv[1] * texture[1]};
  }
  return texels;
}

std::vector<std::optional<std::array<Texel, 3>>> texels_through(const SolvedJob& job,
                                                                std::span<const SeparatedTriangle> triangles,
                                                                const UvMapping& mapping,
                                                                const std::array<int, 2>& texture) {
  std::map<std::uint32_t, std::vector<std::array<double, 2>>> uvs;
  std::vector<std::optional<std::array<Texel, 3>>> list;
  for (const SeparatedTriangle& t : triangles) {
    const ModelPart& part = job.model.parts[t.part];
    const auto [of_part, fresh] = uvs.try_emplace(t.part);
    if (fresh) of_part->second = uvs_through(job.model, part, mapping);
    auto& texels = list.emplace_back();
    if (of_part->second.empty()) continue;
    texels.emplace();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& uv = of_part->second[part.triangles[t.triangle][k]];
      (*texels)[k] = {uv[0] * texture[0], uv[1] * texture[1]};
    }
  }
  return list;
}

bool has_texture_space(const SolvedJob& job, const SeparatedTriangle& t, const std::array<int, 2>& texture) {
  if (texture[0] == 0 || job.model.parts[t.part].uvs.empty()) return false;
  return is_fine_enough(job, t, texels_of(job, t, texture));
}

bool is_fine_enough(const SolvedJob& job, const SeparatedTriangle& t, const std::array<Texel, 3>& texels) {
  if (!(std::abs(doubled_area(texels)) > 0)) return false;
  const SolvedDecal& decal = job.decals[t.decal];
  return std::all_of(t.faces.begin(), t.faces.end(), [&](PatchFaceId f) {
    const PatchFace& face = decal.map.patch.faces[f];
    const auto pixels = pixel_corners(decal, decal.map.image, face);
    const auto there = texels_inside(texels, decal.surface->corners_in_source(face.mesh_face));
    return doubled_area(pixels) == 0 || half_axes(map_between(pixels, there))[1] * coarsest >= 1;
  });
}

Result<UvLayout> lay_out_uvs(const SolvedJob& job, const LayoutRequest& request) {
  Charting charting(job, request);
  charting.run();
  int fineness = wanted_fineness(job, request, charting.charts);
  const int full_gutter = std::max(static_cast<int>(job.job.gutter), 1);
  const Packing packing(request, std::move(charting));
  if (request.created_size != 0) {
    for (int gutter = full_gutter; gutter > 0; gutter /= 2)
      if (auto layout = packing.pack_scaled(1e6, gutter, request.created_size)) return std::move(*layout);
    return fail(ErrorCode::not_solved, no_room(job, request));
  }
  const int most = largest_wanted(job, request);
  for (; fineness > 1; fineness -= 2)
    if (auto layout = packing.pack_exactly(fineness, full_gutter, most)) return std::move(*layout);
  for (int gutter = full_gutter; gutter > 0; gutter /= 2) {
    if (auto layout = packing.pack_exactly(1, gutter, largest_side)) return std::move(*layout);
    if (auto layout = packing.pack_scaled(1, gutter, largest_side)) return std::move(*layout);
  }
  return fail(ErrorCode::not_solved, no_room(job, request));
}

}  // namespace applique
