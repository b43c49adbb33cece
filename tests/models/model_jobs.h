#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace applique {

/// A decal on one of the third-party models, as a job file.
struct ModelJob {
  std::string name;
  std::filesystem::path file;
  bool surface_ends;  ///< The surface is smaller than the decal: part of it is cut.
};

/// Writes the jobs into `folder`, for the models and images under `data`; those whose files are missing are
/// left out. Features are the data's own picks where it has some, rays at the middle of a plain part
/// elsewhere.
std::vector<ModelJob> write_model_jobs(const std::filesystem::path& data,
                                       const std::filesystem::path& folder);

}  // namespace applique
