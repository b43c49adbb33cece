#include "compare/sites.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "applique/surface/surface_query.h"

#include "bust.h"
#include "compare/layouts.h"
#include "model.h"
#include "models.h"
#include "support/shapes.h"

namespace applique::compare {
namespace {

const Vec3 right = Vec3::UnitX(), upwards = Vec3::UnitY();

Site site_at(const std::string& name, SurfaceMesh mesh, const Vec3& place, const Vec3& up, double width) {
  Site site{name, std::move(mesh), {}, up, width};
  site.anchor = SurfaceQuery(site.mesh).nearest(place);
  return site;
}

Site plane() {
  return site_at("plane", shapes::plane(48, 48, 2, 2, 0.3).weld(), {1.03, 0.98, 0}, upwards, 1.5);
}

Site cylinder() {
  return site_at("cylinder", shapes::cylinder(72, 32, 0.5, 2).weld(), {0.5, 0, 1}, Vec3::UnitZ(), 1.6);
}

/// The frustum of a cone that opens downwards, three times as high as wide.
Site cone() {
  const auto point = [](double s, double t) {
    const double angle = 2 * std::numbers::pi * (s == 1 ? 0 : s), radius = 0.2 + 0.8 * t;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), -1.5 * radius);
  };
  return site_at("cone", shapes::grid(96, 32, point).weld(), {0.62, 0, -0.93}, Vec3::UnitZ(), 1.1);
}

SiteSource sphere(double reach) {
  const std::string name = fmt::format("sphere-{:.1f}", reach);
  return {name,
          fmt::format("sphere of 5120 faces; a disc of the image reaches {:.1f} rad from the anchor", reach),
          [=]() -> Result<Site> {
            // Beside the pole, which is a vertex.
            const Vec3 place = Vec3(0.03, 0.02, 1).normalized();
            return site_at(name, shapes::sphere(4, 1).weld(), place, upwards, 2 * reach / disc_share);
          }};
}

/// So steep that a projection loses it; the middle of the image is at its foot.
Site bump() {
  return site_at("bump", shapes::bump(64, 0.5, 0.12).weld(), {0.18, 0.07, 0}, upwards, 1.3);
}

const SurfaceMesh& bust_mesh() {
  static const SurfaceMesh mesh = [] {
    const assets::Mesh bust = assets::make_bust_mesh();
    return weld_surface(bust.positions, bust.triangles);
  }();
  return mesh;
}

Site nose() {
  return site_at("bust-nose", bust_mesh(), assets::bust_landmark("nose_tip"), upwards, 1.1);
}

Site ear() {
  const Vec3 outside = assets::head_to_scene({2, -0.1, -0.15});
  const Vec3 inwards = assets::head_to_scene({0, -0.1, -0.15}) - outside;
  Site site{"bust-ear", bust_mesh(), {}, upwards, 0.8};
  site.anchor = SurfaceQuery(site.mesh).first_hit(outside, inwards).value();
  return site;
}

/// A model, and the ray that hits it at the anchor.
struct ModelPlace {
  const char* name;
  const char* file;
  const char* place;  ///< For people.
  std::array<double, 3> origin, direction;
  double share;  ///< The image's width, share of the diagonal.
};

/// Where a model is far from flat.
const std::array<ModelPlace, 12> model_places = {{
    {"head-scan", "gltf/LeePerrySmith/LeePerrySmith.glb", "nose", {-0.1289, 1.0629, 9}, {0, 0, -1}, 0.2},
    {"nefertiti", "derived/gltf/nefertiti-lowres.glb", "nose", {0, -28, 400}, {0, 0, -1}, 0.2},
    {"face-mask", "derived/gltf/bff_face.glb", "nose", {0, 0.2386, 1}, {0, 0, -1}, 0.25},
    {"canonical-face", "derived/gltf/canonical_face_model.glb", "nose", {0, -1.13, 20}, {0, 0, -1}, 0.25},
    {"body", "derived/gltf/human_neutral.glb", "armpit", {0.17, 1.3, 2}, {0, 0, -1}, 0.15},
    {"hand", "derived/gltf/hand_closed.glb", "between thumb and palm", {-0.17, 0.38, 2}, {0, 0, -1}, 0.25},
    {"cow", "derived/gltf/spot.glb", "cheek", {2, 0.45, -0.3}, {-1, 0, 0}, 0.25},
    {"penguin", "derived/gltf/penguin.glb", "beak", {-0.1, 0.9, 5}, {0, 0, -1}, 0.25},
    {"monkey", "gltf/Suzanne/Suzanne.gltf", "nose", {0.005, -0.2, 3}, {0, 0, -1}, 0.2},
    {"duck", "gltf/Duck.glb", "cheek and bill", {0.6, 1.2, 3}, {0, 0, -1}, 0.25},
    {"wing-nut", "derived/gltf/wingnut.glb", "crease of a wing", {9, 0.2, 1.2}, {-1, 0, 0}, 0.25},
    {"torus", "derived/gltf/torus.glb", "outer rim", {3, 0.02, 0.01}, {-1, 0, 0}, 0.25},
}};

Result<Site> make_model_site(const ModelPlace& place, const std::filesystem::path& file) {
  APPLIQUE_TRY(const Model model, load_model(file));
  Site site{place.name, build_surface(model).mesh, {}, upwards, place.share * model.diagonal()};
  const Vec3 origin(place.origin.data()), direction(place.direction.data());
  const auto hit = SurfaceQuery(site.mesh).first_hit(origin, direction);
  if (!hit)
    return fail(ErrorCode::feature_missed,
                fmt::format("site '{}': the ray to its anchor misses {}", place.name, file.string()));
  site.anchor = *hit;
  return site;
}

}  // namespace

std::vector<SiteSource> own_sites() {
  return {
      {"plane", "jittered grid of 4608 faces", plane},
      {"cylinder", "4608 faces, the image 1.6 wide at radius 0.5", cylinder},
      {"cone", "frustum of 6144 faces, the image 1.1 wide half-way up its side", cone},
      sphere(1.0),
      sphere(1.3),
      sphere(2.0),
      sphere(2.6),
      {"bump",
       "8192 faces: a bump 0.5 high and 0.12 wide (as a Gaussian), the image 1.3 wide, its middle at the "
       "foot",
       bump},
      {"bust-nose", "the demo's bust, the image about the tip of the nose, half a head wide", nose},
      {"bust-ear", "the demo's bust, the image about the ear and twice as large", ear},
  };
}

std::vector<SiteSource> model_sites(const std::filesystem::path& data) {
  std::vector<SiteSource> sources;
  if (data.empty()) return sources;
  for (const ModelPlace& place : model_places) {
    const std::filesystem::path file = data / place.file;
    if (!std::filesystem::exists(file)) continue;
    sources.push_back({place.name,
                       fmt::format("{}: {}, the image {:.0f} % of the model's diagonal wide", place.file,
                                   place.place, 100 * place.share),
                       [&place, file] { return make_model_site(place, file); }});
  }
  return sources;
}

}  // namespace applique::compare
