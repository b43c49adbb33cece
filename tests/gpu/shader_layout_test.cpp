// The shaders' own account of their workgroups, bindings and push constants against what the C++ side uses.
#include <gtest/gtest.h>

#include "gpu/spirv_reflection.h"
#include "mesh_fragment.spv.h"
#include "render_types.h"
#include "transfer_cover.spv.h"
#include "transfer_nearest.spv.h"
#include "transfer_shade.spv.h"
#include "transfer_shade_large.spv.h"
#include "transfer_types.h"

namespace applique {
namespace {

using Bindings = std::vector<std::uint32_t>;

TEST(ShaderLayout, TransferShadersMatch) {
  const SpirvReflection cover = reflect_spirv(applique_spirv_transfer_cover);
  const SpirvReflection nearest = reflect_spirv(applique_spirv_transfer_nearest);
  const SpirvReflection shade = reflect_spirv(applique_spirv_transfer_shade);
  const SpirvReflection shade_large = reflect_spirv(applique_spirv_transfer_shade_large);
  for (const SpirvReflection& reflection : {cover, nearest, shade, shade_large}) {
    EXPECT_EQ(reflection.local_size,
              (std::array<std::uint32_t, 3>{shader::block_size, shader::block_size, 1}));
    EXPECT_EQ(reflection.push_size, sizeof(shader::TransferConstants));
    EXPECT_LE(reflection.push_size, 128U);  // What every device has.
  }
  // The last is a uniform buffer: of storage buffers every device has four for a shader, and some no more.
  EXPECT_EQ(cover.bindings, (Bindings{0, 1}));
  EXPECT_EQ(nearest.bindings, (Bindings{0, 1}));
  EXPECT_EQ(shade.bindings, (Bindings{0, 1, 2, 3, 4}));
  EXPECT_EQ(shade_large.bindings, (Bindings{0, 1, 2, 3, 4}));
}

TEST(ShaderLayout, RenderShadersMatch) {
  const SpirvReflection mesh = reflect_spirv(applique_spirv_mesh_fragment);
  EXPECT_EQ(mesh.bindings, (Bindings{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.push_size, sizeof(shader::RenderDraw));
}

}  // namespace
}  // namespace applique
