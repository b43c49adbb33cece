#include "place.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "near_names.h"

namespace applique {
namespace {

constexpr double default_max_distance = 0.02;  // Of the model's diagonal.
constexpr double sum_tolerance = 1e-6;         // Of barycentrics in a job.
constexpr double uv_tolerance = 1e-9;          // How far outside a triangle a barycentric may be.

using Uv = std::array<double, 2>;

std::string shown(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string shown(const Reference& reference) {
  if (const auto* name = std::get_if<std::string>(&reference)) return fmt::format("'{}'", *name);
  return fmt::format("{}", std::get<std::size_t>(reference));
}

/// Barycentrics without what rounding left below 0, sum 1.
std::array<double, 3> tidy(std::array<double, 3> weights) {
  double sum = 0;
  for (double& weight : weights) sum += weight = std::max(weight, 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

class Resolver {
 public:
  Resolver(const Model& model, const ModelSurface& surface, const SurfaceQuery& query,
           const std::string& owner)
      : model_(model), surface_(surface), query_(query), owner_(owner) {}

  Result<SurfacePoint> operator()(const PositionPlace& place) const {
    if (surface_.mesh.faces.empty()) return missed("there is no surface to put it on");
    const SurfacePoint point = query_.nearest(place.position);
    const double distance = (position_of(surface_.mesh, point) - place.position).norm();
    const double limit = place.max_distance.value_or(default_max_distance * model_.diagonal());
    if (distance <= limit) return point;
    return fail(
        ErrorCode::feature_too_far,
        fmt::format(
            "{}: position {} is {:.4g} from the surface, more than {} {:.4g}; the nearest point is {}",
            owner_, shown(place.position), distance,
            place.max_distance ? "its max_distance of"
                               : "the default max_distance, 2 % of the model's diagonal,",
            limit, shown(position_of(surface_.mesh, point))));
  }

  Result<SurfacePoint> operator()(const RayPlace& place) const {
    if (const auto point = query_.first_hit(place.origin, place.direction)) return *point;
    return missed(fmt::format("the ray from {} along {} does not meet the surface", shown(place.origin),
                              shown(place.direction)));
  }

  Result<SurfacePoint> operator()(const UvPlace& place) const {
    APPLIQUE_TRY(const auto materials, resolve(place.material, "materials", "material"));
    bool has_faces = false;
    bool has_uvs = false;
    for (const FaceId f : ids<FaceId>(surface_.mesh.faces.size())) {
      const auto& source = surface_.source(f);
      const ModelPart& part = model_.parts[source.part];
      if (!part.material || std::find(materials.begin(), materials.end(), *part.material) == materials.end())
        continue;
      has_faces = true;
      if (part.uvs.empty()) continue;
      has_uvs = true;
      const auto& corners = part.triangles[source.triangle];
      const std::array<Uv, 3> uvs = {part.uvs[corners[0]], part.uvs[corners[1]], part.uvs[corners[2]]};
      if (const auto weights = find_uv(place.uv, uvs, model_.materials[*part.material]))
        return SurfacePoint{f, *weights};
    }
    if (!has_faces)
      return invalid(fmt::format("no triangle of the surface has the material {}", shown(place.material)));
    if (!has_uvs)
      return fail(
          ErrorCode::uvs_missing,
          fmt::format(
              "{}: the material {} is on triangles without texture coordinates; name a position instead",
              owner_, shown(place.material)));
    return missed(fmt::format("no triangle of the material {} has the texture coordinates ({:.6g}, {:.6g})",
                              shown(place.material), place.uv[0], place.uv[1]));
  }

  Result<SurfacePoint> operator()(const VertexPlace& place) const {
    APPLIQUE_TRY(const std::size_t index, find_part(place.mesh, place.primitive));
    const ModelPart& part = model_.parts[index];
    if (place.vertex >= part.positions.size())
      return invalid(fmt::format("vertex {} is not there: primitive {} of mesh {} has {} vertices",
                                 place.vertex, place.primitive, shown(place.mesh), part.positions.size()));
    for (const FaceId f : ids<FaceId>(surface_.mesh.faces.size())) {
      const auto& source = surface_.source(f);
      if (source.part != index) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        if (part.triangles[source.triangle][k] != place.vertex) continue;
        SurfacePoint point{f, {0, 0, 0}};
        point.barycentric[k] = 1;
        return point;
      }
    }
    return invalid(fmt::format("vertex {} of mesh {}, primitive {}, is a corner of no triangle", place.vertex,
                               shown(place.mesh), place.primitive));
  }

  Result<SurfacePoint> operator()(const TrianglePlace& place) const {
    double sum = 0;
    for (const double weight : place.barycentric) {
      if (!(weight >= 0)) return invalid(fmt::format("the barycentric coordinate {} is negative", weight));
      sum += weight;
    }
    if (!(std::abs(sum - 1) <= sum_tolerance))
      return invalid(fmt::format("the barycentric coordinates add up to {:.9g} instead of 1", sum));
    APPLIQUE_TRY(const std::size_t index, find_part(place.mesh, place.primitive));
    const ModelPart& part = model_.parts[index];
    if (place.triangle >= part.triangles.size())
      return invalid(fmt::format("triangle {} is not there: primitive {} of mesh {} has {} triangles",
                                 place.triangle, place.primitive, shown(place.mesh), part.triangles.size()));
    auto weights = tidy(place.barycentric);
    if (part.mirrored) std::swap(weights[1], weights[2]);
    for (const FaceId f : ids<FaceId>(surface_.mesh.faces.size())) {
      const auto& source = surface_.source(f);
      if (source.part == index && source.triangle == place.triangle) return SurfacePoint{f, weights};
    }
    return invalid(
        fmt::format("triangle {} of mesh {}, primitive {}, is degenerate and no part of the surface",
                    place.triangle, shown(place.mesh), place.primitive));
  }

 private:
  tl::unexpected<Error> invalid(const std::string& what) const {
    return fail(ErrorCode::feature_place_invalid, fmt::format("{}: {}", owner_, what));
  }
  tl::unexpected<Error> missed(const std::string& what) const {
    return fail(ErrorCode::feature_missed, fmt::format("{}: {}", owner_, what));
  }

  /// The indices that a reference names in a collection of the document; several may have one name.
  Result<std::vector<std::size_t>> resolve(const Reference& reference, const char* collection,
                                           const char* kind) const {
    const std::size_t count = count_of(model_.document, collection);
    if (const auto* index = std::get_if<std::size_t>(&reference)) {
      if (*index < count) return std::vector<std::size_t>{*index};
      return invalid(fmt::format("{} {} is not there: the model has {} {}", kind, *index, count, collection));
    }
    const std::string& wanted = std::get<std::string>(reference);
    std::vector<std::size_t> found;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
      const auto* name = find(model_.document.json[collection][i], {"name"});
      if (name == nullptr || !name->is_string()) continue;
      names.push_back(name->get<std::string>());
      if (names.back() == wanted) found.push_back(i);
    }
    if (found.empty())
      return invalid(
          fmt::format("the model has no {} '{}'; expected {}", kind, wanted, suggest_names(wanted, names)));
    return found;
  }

  /// The one part of the surface that shows a primitive of a mesh.
  Result<std::size_t> find_part(const Reference& mesh, std::size_t primitive) const {
    APPLIQUE_TRY(const auto meshes, resolve(mesh, "meshes", "mesh"));
    std::vector<char> on_surface(model_.parts.size(), 0);
    for (const auto& source : surface_.sources) on_surface[source.part] = 1;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < model_.parts.size(); ++i) {
      const ModelPart& part = model_.parts[i];
      if (on_surface[i] != 0 && part.primitive == primitive &&
          std::find(meshes.begin(), meshes.end(), part.mesh) != meshes.end())
        found.push_back(i);
    }
    if (found.size() == 1) return found.front();
    if (found.empty())
      return invalid(fmt::format("primitive {} of mesh {} is not on the surface", primitive, shown(mesh)));
    return invalid(fmt::format("primitive {} of mesh {} is shown {} times; name the one node with \"nodes\"",
                               primitive, shown(mesh), found.size()));
  }

  /// The values that a sampler shows at coordinate `x` and that lie between the bounds: x itself, x plus
  /// whole numbers, or their mirror images.
  static std::vector<double> wrapped(double x, WrapMode wrap, double lower, double upper) {
    if (wrap == WrapMode::clamp) return {x};
    const double period = wrap == WrapMode::repeat ? 1 : 2;
    std::vector<double> values;
    const auto add = [&](double base) {
      constexpr int most = 64;  // One triangle over more repeats than this is asked for its first ones only.
      double k = std::ceil((lower - base) / period - uv_tolerance);
      for (int i = 0; i < most && base + k * period <= upper + uv_tolerance; ++i, ++k)
        values.push_back(base + k * period);
    };
    add(x);
    if (wrap == WrapMode::mirror) add(-x);
    return values;
  }

  static std::optional<std::array<double, 3>> find_uv(const Uv& uv, const std::array<Uv, 3>& t,
                                                      const ModelMaterial& material) {
    const auto [lower_u, upper_u] = std::minmax({t[0][0], t[1][0], t[2][0]});
    const auto [lower_v, upper_v] = std::minmax({t[0][1], t[1][1], t[2][1]});
    const double area = doubled_area(t);
    if (area == 0) return std::nullopt;
    for (const double u : wrapped(uv[0], material.wrap_u, lower_u, upper_u))
      for (const double v : wrapped(uv[1], material.wrap_v, lower_v, upper_v)) {
        const auto part = [&](std::size_t a, std::size_t b) {
          return ((t[a][0] - u) * (t[b][1] - v) - (t[a][1] - v) * (t[b][0] - u)) / area;
        };
        const std::array<double, 3> weights = {part(1, 2), part(2, 0), part(0, 1)};
        if (std::min({weights[0], weights[1], weights[2]}) >= -uv_tolerance) return tidy(weights);
      }
    return std::nullopt;
  }

  const Model& model_;
  const ModelSurface& surface_;
  const SurfaceQuery& query_;
  const std::string& owner_;
};

}  // namespace

Result<SurfacePoint> resolve_place(const Place& place, const Model& model, const ModelSurface& surface,
                                   const SurfaceQuery& query, const std::string& owner) {
  return std::visit(Resolver(model, surface, query, owner), place);
}

}  // namespace applique
