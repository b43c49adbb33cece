#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "applique/base/types.h"
#include "applique/image/image.h"

namespace applique {

/// A mesh of a small test model: one primitive under one node of the same name.
struct SmallMesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;               ///< Empty: none.
  std::vector<std::array<double, 2>> uvs;  ///< Empty: none.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int material = 0;
};

struct SmallMaterial {
  std::string name;
  std::optional<Image> texture;
  std::array<double, 4> factor = {1, 1, 1, 1};
};

/// The grid of `cells` x `cells` squares over [-1, 1] x [-1, 1] at height `z` moved by `x`, facing +z; its
/// UVs cover the unit square, v down.
SmallMesh make_plane(const std::string& name, int cells, double x = 0, double z = 0);

/// Writes a GLB with these.
void write_small_model(const std::filesystem::path& path, const std::vector<SmallMesh>& meshes,
                       const std::vector<SmallMaterial>& materials);

/// Writes an image as a PNG.
void write_png(const std::filesystem::path& path, const Image& image);

/// A texture in which every texel has a value of its own.
Image make_noise(int size);

}  // namespace applique
