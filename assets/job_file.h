#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "applique/base/error.h"
#include "applique/base/types.h"

namespace applique::assets {

/// A feature of a job: a pixel of the image on a position of the model.
nlohmann::ordered_json feature(Pixel image, const Vec3& position);

/// Writes a job of one decal: NAME.png by `features` on the model; `more` is added to the decal.
Result<void> write_job(const std::filesystem::path& path, const std::string& model, const std::string& name,
                       const nlohmann::ordered_json& features, const nlohmann::ordered_json& more = {});

}  // namespace applique::assets
