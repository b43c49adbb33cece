#include "solve_job.h"

#include <future>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "applique/region/outline.h"
#include "applique/surface/surface_query.h"

#include "instances.h"
#include "near_names.h"
#include "place.h"

namespace applique {
namespace {

/// The surfaces that the decals of a job use: decals with the same limits share one.
class SurfaceCache {
 public:
  struct Entry {
    std::shared_ptr<const ModelSurface> surface;
    std::unique_ptr<SurfaceQuery> query;
  };

  explicit SurfaceCache(const Model& model) : model_(&model) {}

  Result<const Entry*> find(const DecalJob& decal) {
    const std::string owner = fmt::format("decal '{}'", decal.name);
    APPLIQUE_TRY(auto nodes, resolve_references(decal.nodes, model_->document, "nodes", owner));
    APPLIQUE_TRY(auto materials, resolve_references(decal.materials, model_->document, "materials", owner));
    auto [place, fresh] = entries_.try_emplace({nodes, materials});
    Entry& entry = place->second;
    if (fresh) {
      entry.surface = std::make_shared<ModelSurface>(build_surface(*model_, nodes, materials));
      if (entry.surface->mesh.faces.empty())
        return fail(
            ErrorCode::feature_place_invalid,
            owner +
                ": no triangle of the model lies on the nodes and materials that it names; name others, "
                "or leave them out");
      entry.query = std::make_unique<SurfaceQuery>(entry.surface->mesh);
    }
    return &entry;
  }

 private:
  const Model* model_;
  std::map<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>, Entry> entries_;
};

struct LoadedImage {
  Result<Image> image;
  double seconds;
};

std::vector<std::future<LoadedImage>> start_reading_images(const Job& job) {
  std::vector<std::future<LoadedImage>> images;
  for (const DecalJob& decal : job.decals)
    images.push_back(std::async(std::launch::async, [path = decal.image] {
      const Stopwatch watch;
      Result<Image> image = read_image(path);
      return LoadedImage{std::move(image), watch.seconds()};
    }));
  return images;
}

/// Names the decal in an error that comes from a function that does not know it.
template <class T>
Result<T> of_decal(const DecalJob& decal, Result<T> result) {
  if (result || result.error().message.find(fmt::format("'{}'", decal.name)) != std::string::npos)
    return result;
  return fail(result.error().code, fmt::format("decal '{}': {}", decal.name, result.error().message));
}

/// The layers' images and the mask are read only once they are baked, but that they are there is to be known
/// before the work.
Result<void> check_layer_files(const DecalJob& decal) {
  const auto check = [](const std::filesystem::path& path, const std::string& label) -> Result<void> {
    if (path.empty() || std::filesystem::exists(path)) return {};
    return fail(ErrorCode::file_unreadable,
                fmt::format("{}: image '{}' does not exist", label, path.string()));
  };
  for (const DecalLayer& layer : decal.layers) APPLIQUE_CHECK(check(layer.image, label_of(decal, layer)));
  return check(decal.mask, mask_label_of(decal));
}

Result<std::vector<Pixel>> find_contour(const RegionChoice& choice, const Image& image) {
  constexpr double default_threshold = 0.5;
  if (const auto* contour = std::get_if<ContourRegion>(&choice)) return contour->contour;
  if (const auto* alpha = std::get_if<AlphaRegion>(&choice)) return alpha_outline(image, alpha->threshold);
  if (std::holds_alternative<AutomaticRegion>(choice) && has_transparency(image))
    return alpha_outline(image, default_threshold);
  return rectangle_outline(image);
}

Result<Region> find_region(const DecalJob& decal, const Image& image) {
  APPLIQUE_TRY(const auto contour, find_contour(decal.region, image));
  const auto width = static_cast<double>(image.width), height = static_cast<double>(image.height);
  return Region::from_contour(contour, {width, height, decal.mirrored});
}

/// A lone feature needs a size and a direction; several need none.
Result<void> check_lone_frame(const DecalJob& decal, std::vector<Warning>& warnings) {
  if (decal.features.size() > 1) {
    if (decal.size || decal.up)
      warnings.push_back(
          {"size_ignored", fmt::format("decal '{}': '{}' is not used, because several features fix "
                                       "scale and orientation by themselves",
                                       decal.name, decal.size ? "size" : "up")});
    return {};
  }
  if (decal.size && decal.up) return {};
  return fail(
      ErrorCode::size_missing,
      fmt::format(
          "decal '{}': a single feature fixes neither scale nor orientation; give {}, or a second feature",
          decal.name,
          decal.size ? "'up' (the direction of the image's upper edge)"
          : decal.up ? "'size' (the image's width in scene units)"
                     : "'size' (the image's width in scene units) and 'up' (the direction of its upper "
                       "edge)"));
}

/// A width that is a matter of the wrong unit rather than of taste.
void warn_of_size(const DecalJob& decal, const Model& model, std::vector<Warning>& warnings) {
  constexpr double least = 1e-5;
  if (decal.features.size() > 1 || !decal.size || *decal.size >= least * model.diagonal()) return;
  warnings.push_back(
      {"size_tiny",
       fmt::format("decal '{}': its \"size\" of {:.3g} is next to nothing on a model of {:.3g} across; it is "
                   "the image's width in scene units",
                   decal.name, *decal.size, model.diagonal())});
}

/// What a job asks of a decal, other than by default, that its output or its method has no use for.
std::vector<Warning> unused_options(const DecalJob& decal) {
  std::vector<Warning> warnings;
  const auto add = [&](const std::string& option, const std::string& why) {
    warnings.push_back({option + "_ignored",
                        fmt::format("decal '{}': '{}' is not used, because {}", decal.name, option, why)});
  };
  if (decal.output == DecalOutput::overlay) {
    if (decal.instance == Instance::all) add("instance", "an overlay lies on one node only");
    if (decal.uv_conflict != UvConflict::separate)
      add("uv_conflict", "an overlay has texture coordinates of its own");
  } else if (decal.offset) {
    add("offset", "only an overlay has one");
  }
  if (decal.method == Method::applique) return warnings;
  const std::string method = fmt::format("the method \"{}\" ", name_of(decal.method));
  if (decal.energy != Energy::isometric)
    add("energy", method + (decal.method == Method::paper ? "is conformal" : "has none to choose"));
  if (!decal.guide) add("guide", method + "has none");
  if (decal.overlap == Overlap::allow) add("overlap", method + "does not let the image go on over itself");
  return warnings;
}

/// The decal as the engine takes it, once its region and its features are known.
DecalInput input_of(const SolvedDecal& decal) {
  DecalInput input = {decal.job.name, decal.region, decal.features, std::nullopt};
  if (decal.job.size && decal.job.up) input.lone = LoneFrame{*decal.job.size, *decal.job.up};
  return input;
}

SolveOptions options_of(const DecalJob& decal) {
  SolveOptions options;
  options.method = decal.method;
  options.planar = decal.planar;
  options.parents = decal.parents;
  options.energy = decal.energy;
  options.guide = decal.guide;
  options.overlap = decal.overlap;
  options.divide = true;
  return options;
}

/// Whether it is an overlay on a skin: that moves the corners of triangles, between which viewers draw
/// straight, so that vertices within them would part from the surface.
bool keeps_to_triangles(const SolvedDecal& decal, const Model& model) {
  return decal.job.output == DecalOutput::overlay && lies_on_skin(decal, model);
}

/// Once more, as well as it can be had so; the decal is over parts of the triangles.
Result<void> solve_on_whole_triangles(SolvedDecal& decal, const SolveOptions& options) {
  constexpr double notably = 1.1;
  const MapQuality divided = decal.map.quality;
  const std::string why =
      "the model's triangles are too large for it, and those of an overlay on a skin cannot be divided";
  auto map = of_decal(decal.job, solve_decal(decal.whole_surface->mesh, input_of(decal), options));
  if (!map)
    return fail(map.error().code,
                fmt::format("{}; {}: give it \"output\": \"bake\"", map.error().message, why));
  decal.map = std::move(*map);
  decal.surface = decal.whole_surface;
  const MapQuality& whole = decal.map.quality;
  const auto worth = [](const MapQuality& quality) { return quality.coverage / quality.l2_stretch; };
  const auto folds = [](const MapQuality& quality) { return quality.flipped_plane + quality.flipped_image; };
  if (worth(divided) < notably * worth(whole) && folds(divided) >= folds(whole) &&
      whole.doubled + whole.left_out < hardly_doubled)
    return {};
  decal.warnings.push_back(
      {"overlay_coarse",
       fmt::format("decal '{}': {}; with \"output\": \"bake\" {:.1f} % of it would be shown in place of "
                   "{:.1f} %, at an L2 stretch of {:.2f} in place of {:.2f}",
                   decal.job.name, why, 100 * divided.coverage, 100 * whole.coverage, divided.l2_stretch,
                   whole.l2_stretch)});
  return {};
}

Result<void> solve_geometry(const Model& model, SurfaceCache& surfaces, SolvedDecal& decal, bool traced) {
  const std::string& name = decal.job.name;
  Stopwatch watch;
  APPLIQUE_TRY(decal.region, of_decal(decal.job, find_region(decal.job, decal.image)));
  decal.times.add("region", watch.lap());

  APPLIQUE_TRY(const SurfaceCache::Entry* entry, surfaces.find(decal.job));
  decal.whole_surface = decal.surface = entry->surface;
  decal.times.add("surface", watch.lap());

  APPLIQUE_CHECK(check_lone_frame(decal.job, decal.warnings));
  warn_of_size(decal.job, model, decal.warnings);
  for (std::size_t i = 0; i < decal.job.features.size(); ++i) {
    const JobFeature& feature = decal.job.features[i];
    const std::string label =
        fmt::format("decal '{}', feature {} at ({:.1f}, {:.1f})", name, i, feature.image.x, feature.image.y);
    APPLIQUE_TRY(const SurfacePoint point,
                 resolve_place(feature.place, model, *entry->surface, *entry->query, label));
    decal.features.push_back({feature.image, point, feature.depth});
  }
  decal.times.add("places", watch.lap());

  for (Warning& warning : unused_options(decal.job)) decal.warnings.push_back(std::move(warning));

  SolveOptions options = options_of(decal.job);
  if (traced) options.trace = &decal.trace;
  APPLIQUE_TRY(decal.map, of_decal(decal.job, solve_decal(entry->surface->mesh, input_of(decal), options)));
  if (decal.map.divided != nullptr) {
    decal.surface = std::make_shared<ModelSurface>(divided_surface(*decal.whole_surface, *decal.map.divided));
    options.divide = false;
    if (keeps_to_triangles(decal, model)) APPLIQUE_CHECK(solve_on_whole_triangles(decal, options));
  }
  decal.times.add("solve", watch.lap());
  return {};
}

}  // namespace

Result<std::vector<std::size_t>> resolve_references(const std::vector<Reference>& references,
                                                    const Document& document, const std::string& array,
                                                    const std::string& owner) {
  const auto elements = document.json.value(array, nlohmann::ordered_json::array());
  std::vector<std::size_t> found;
  for (const Reference& reference : references) {
    if (const auto* index = std::get_if<std::size_t>(&reference)) {
      if (*index >= elements.size())
        return fail(ErrorCode::feature_place_invalid,
                    fmt::format("{}: {} {}: the model has {} of them, counted from 0", owner, array, *index,
                                elements.size()));
      found.push_back(*index);
      continue;
    }
    const auto& name = std::get<std::string>(reference);
    const std::size_t before = found.size();
    std::vector<std::string> names;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const std::string element_name = elements[i].value("name", std::string());
      if (element_name == name) found.push_back(i);
      if (!element_name.empty()) names.push_back(element_name);
    }
    if (found.size() == before)
      return fail(ErrorCode::feature_place_invalid,
                  fmt::format("{}: {}: the model has no '{}', expected {}", owner, array, name,
                              suggest_names(name, names)));
  }
  return found;
}

Result<SolvedJob> solve_job(const Job& job, const StageCallback& on_stage, bool traced) {
  const auto begin_stage = [&](const std::string& stage, double done) {
    if (on_stage) on_stage(stage, done);
  };
  SolvedJob solved;
  solved.job = job;
  auto images = start_reading_images(job);

  begin_stage("loading the model", 0);
  Stopwatch watch;
  APPLIQUE_TRY(solved.model, load_model(job.model));
  solved.times.add("load_model", watch.lap());

  SurfaceCache surfaces(solved.model);
  constexpr double load_share = 0.3;  // of the work, for the progress bar
  for (std::size_t i = 0; i < job.decals.size(); ++i) {
    const DecalJob& decal_job = job.decals[i];
    begin_stage(
        fmt::format("solving '{}'", decal_job.name),
        load_share + (1 - load_share) * static_cast<double>(i) / static_cast<double>(job.decals.size()));
    SolvedDecal decal;
    decal.job = decal_job;
    LoadedImage loaded = images[i].get();
    decal.times.add("load_image", loaded.seconds);
    solved.times.add("load_images", watch.lap());  // what was waited for
    APPLIQUE_TRY(decal.image, of_decal(decal_job, std::move(loaded.image)));
    APPLIQUE_CHECK(check_layer_files(decal_job));
    APPLIQUE_CHECK(solve_geometry(solved.model, surfaces, decal, traced));
    decal.warnings.insert(decal.warnings.end(), decal.map.warnings.begin(), decal.map.warnings.end());
    solved.decals.push_back(std::move(decal));
    solved.times.add("solve", watch.lap());
  }
  return solved;
}

void suggest_features(SolvedJob& solved, const StageCallback& on_stage) {
  const Stopwatch watch;
  for (std::size_t i = 0; i < solved.decals.size(); ++i) {
    SolvedDecal& decal = solved.decals[i];
    if (on_stage)
      on_stage(fmt::format("looking for better features of '{}'", decal.job.name),
               static_cast<double>(i) / static_cast<double>(solved.decals.size()));
    SuggestOptions options;
    options.solve = options_of(decal.job);
    options.solve.divide = !keeps_to_triangles(decal, solved.model);
    decal.suggestion = suggest_feature(decal.whole_surface->mesh, input_of(decal), decal.map, options);
  }
  solved.times.add("suggest", watch.seconds());
}

}  // namespace applique
