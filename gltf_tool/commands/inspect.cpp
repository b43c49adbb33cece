#include "commands/inspect.h"

#include <cstdio>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "../inspect.h"

namespace applique {
namespace {

using Lines = fmt::memory_buffer;

template <class... Args>
void line(Lines& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
  out.push_back('\n');
}

std::string quoted(const std::string& name) {
  return name.empty() ? "" : fmt::format(" '{}'", name);
}

void write_parts(Lines& out, const ModelSummary& summary) {
  line(out, "parts ({} triangles):", summary.triangles);
  for (const PartSummary& part : summary.parts)
    line(out, "  node {}{}, mesh {}{}, primitive {}: {} triangles, {} vertices, {}", part.node,
         quoted(part.node_name), part.mesh, quoted(part.mesh_name), part.primitive, part.triangles,
         part.vertices, part.material ? fmt::format("material {}", *part.material) : "no material");
}

void write_material(Lines& out, const MaterialSummary& material) {
  line(out, "  {}{}: {} triangles",
       material.material ? fmt::format("material {}", *material.material) : "no material",
       quoted(material.name), material.triangles);
  if (!material.texture_problem.empty())
    line(out, "    texture: {}", material.texture_problem);
  else if (material.texture_size)
    line(out, "    texture: {} x {}, {:.0f} % in use, {:.4g} texels a scene unit",
         (*material.texture_size)[0], (*material.texture_size)[1], 100 * material.covered_texels,
         material.texel_density);
  else
    line(out, "    texture: none; a decal brings one");
  if (material.triangles_without_uvs == material.triangles) {
    line(out, "    texture coordinates: none; a decal makes some for the triangles under it");
    return;
  }
  line(out, "    texture coordinates: {}, from ({:.3f}, {:.3f}) to ({:.3f}, {:.3f})",
       fmt::join(material.uv_sets, ", "), material.uv_lower[0], material.uv_lower[1], material.uv_upper[0],
       material.uv_upper[1]);
  if (material.triangles_without_uvs > 0)
    line(out, "    {} triangles without texture coordinates", material.triangles_without_uvs);
  if (material.shared_texels > 0)
    line(out,
         "    {:.1f} % of the covered texels are shown more than once: a decal there gets texture space of "
         "its "
         "own",
         100 * material.shared_texels);
  if (material.mirrored > 0)
    line(out, "    {:.1f} % of the triangles are mirrored in the texture", 100 * material.mirrored);
  if (material.collapsed_triangles > 0)
    line(out, "    {} triangles have no area in the texture", material.collapsed_triangles);
}

void write_surface(Lines& out, const ModelSummary& summary) {
  line(out, "surface (welded): {} vertices in {} connected pieces", summary.surface_vertices,
       summary.components);
  line(out,
       "  {} open edges, {} non-manifold edges cut open, {} vertices split, {} degenerate triangles dropped",
       summary.boundary_edges, summary.non_manifold_edges, summary.split_vertices,
       summary.degenerate_triangles);
  line(out, "  from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", summary.lower.x(),
       summary.lower.y(), summary.lower.z(), summary.upper.x(), summary.upper.y(), summary.upper.z());
}

std::string describe(const ModelSummary& summary) {
  Lines out;
  line(out, "{} nodes, {} meshes, {} scenes, {} skins, {} animations, {} cameras, {} morph targets",
       summary.nodes, summary.meshes, summary.scenes, summary.skins, summary.animations, summary.cameras,
       summary.morph_targets);
  if (!summary.extensions_used.empty()) line(out, "extensions: {}", fmt::join(summary.extensions_used, ", "));
  write_parts(out, summary);
  line(out, "materials:");
  for (const MaterialSummary& material : summary.materials) write_material(out, material);
  write_surface(out, summary);
  for (const Warning& warning : summary.warnings) line(out, "warning: {}", warning.message);
  return fmt::to_string(out);
}

}  // namespace

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command = add_subcommand(app, "inspect", "Tell what is in a model: what a job can refer to",
                                     "  applique inspect model.glb\n"
                                     "  applique inspect model.glb --json");
  command->add_option("MODEL", arguments.model, "The model, .glb or .gltf")->required();
  command->add_flag("--json", arguments.json, "Write JSON");
  return command;
}

Result<void> run_inspect(const InspectArguments& arguments, const CommonArguments& /*common*/) {
  APPLIQUE_TRY(const Model model, load_model(arguments.model));
  const ModelSummary summary = inspect_model(model);
  const std::string text = arguments.json ? to_json(summary).dump(2) + "\n" : describe(summary);
  std::fwrite(text.data(), 1, text.size(), stdout);
  return {};
}

}  // namespace applique
