#include "applique/gpu/renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "applique/gpu/buffer.h"
#include "applique/gpu/gpu_image.h"
#include "applique/gpu/graphics_pipeline.h"
#include "applique/image/decal_image.h"

#include "backdrop_fragment.spv.h"
#include "backdrop_vertex.spv.h"
#include "mesh_fragment.spv.h"
#include "mesh_vertex.spv.h"
#include "render_types.h"

namespace applique {
namespace {

constexpr VkFormat colour_format = VK_FORMAT_R8G8B8A8_SRGB;
constexpr VkFormat data_format = VK_FORMAT_R8G8B8A8_UNORM;
constexpr std::uint32_t texture_count = 4;  // Base colour, metallic and roughness, normal, emissive.
constexpr VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_4_BIT;  // Every device has it.
constexpr ImageUse unused = {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, 0};
constexpr ImageUse copy_target = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                  VK_ACCESS_TRANSFER_WRITE_BIT};

// Where a mesh lies in the common vertex and index buffers.
struct DrawRange {
  std::uint32_t first_index, indices;
  std::int32_t first_vertex;
};

struct Geometry {
  std::vector<RenderVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<DrawRange> ranges;  // By mesh.
};

Geometry pack_geometry(std::span<const RenderMesh> meshes) {
  Geometry geometry;
  for (const RenderMesh& mesh : meshes) {
    geometry.ranges.push_back({static_cast<std::uint32_t>(3 * geometry.triangles.size()),
                               static_cast<std::uint32_t>(3 * mesh.triangles.size()),
                               static_cast<std::int32_t>(geometry.vertices.size())});
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      RenderVertex vertex{};
      std::copy(mesh.positions[i].begin(), mesh.positions[i].end(), vertex.position);
      if (!mesh.normals.empty()) std::copy(mesh.normals[i].begin(), mesh.normals[i].end(), vertex.normal);
      if (!mesh.uvs.empty()) std::copy(mesh.uvs[i].begin(), mesh.uvs[i].end(), vertex.uv);
      geometry.vertices.push_back(vertex);
    }
    geometry.triangles.insert(geometry.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  }
  return geometry;
}

Vec3 to_vec3(const std::array<float, 3>& p) {
  return {p[0], p[1], p[2]};
}
shader::vec4 to_vec4(const Vec3& v, double w = 0) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
          static_cast<float>(w)};
}
shader::vec4 linear_colour(const std::array<float, 3>& c) {
  return to_vec4({srgb_to_linear(c[0]), srgb_to_linear(c[1]), srgb_to_linear(c[2])}, 1);
}

shader::RenderFrame make_frame(std::span<const RenderMesh> meshes, const Camera& camera,
                               const RenderOptions& options) {
  const Vec3 backward = (camera.eye - camera.target).normalized();
  double near = 1e300, far = 0;
  for (const RenderMesh& mesh : meshes) {
    for (const auto& position : mesh.positions) {
      const double depth = (camera.eye - to_vec3(position)).dot(backward);
      near = std::min(near, depth);
      far = std::max(far, depth);
    }
  }
  constexpr double nearest = 1e-5;  // of the farthest: depths are floats
  far = far > 0 ? 1.01 * far : 1;
  near = std::clamp(0.99 * near, nearest * far, 0.999 * far);
  const Eigen::Matrix4f matrix =
      view_projection(camera, static_cast<double>(options.width) / options.height, near, far).cast<float>();

  Vec3 right = camera.up.cross(backward);
  right = right.norm() > 0 ? right.normalized() : backward.unitOrthogonal();
  const Vec3 up = backward.cross(right);
  shader::RenderFrame frame{};
  std::copy(matrix.data(), matrix.data() + 16, frame.view_projection.begin());
  frame.eye = to_vec4(camera.eye);
  frame.key = to_vec4(Vec3(-0.55 * right + 0.65 * up + 0.8 * backward).normalized());
  frame.fill = to_vec4(Vec3(0.85 * right + 0.1 * up + 0.5 * backward).normalized());
  frame.rim = to_vec4(Vec3(0.45 * right + 0.7 * up - 0.6 * backward).normalized());
  frame.up = to_vec4(up);
  frame.background_top = linear_colour(options.background_top);
  frame.background_bottom = linear_colour(options.background_bottom);
  return frame;
}

// Halves an image until it fits the device: each pixel the mean of four.
Image halved(const Image& image) {
  Image half = make_image(std::max(1, image.width / 2), std::max(1, image.height / 2), {});
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < 4; ++c) {
        int sum = 0;
        for (int k = 0; k < 4; ++k) {
          sum += image.pixel(std::min(2 * x + k % 2, image.width - 1),
                             std::min(2 * y + k / 2, image.height - 1))[c];
        }
        half.pixel(x, y)[c] = static_cast<std::uint16_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

Result<GpuImage> upload_texture(const Device& device, const Image& image, VkFormat format) {
  const auto largest = static_cast<int>(device.properties().limits.maxImageDimension2D);
  if (std::max(image.width, image.height) > largest) return upload_texture(device, halved(image), format);
  GpuImageInfo info;
  info.name = "texture";
  info.width = static_cast<std::uint32_t>(image.width);
  info.height = static_cast<std::uint32_t>(image.height);
  info.format = format;
  info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.levels = static_cast<std::uint32_t>(std::bit_width(std::max(info.width, info.height)));
  APPLIQUE_TRY(GpuImage texture, GpuImage::create(device, info));

  std::vector<std::uint8_t> bytes(image.rgba.size());
  std::transform(image.rgba.begin(), image.rgba.end(), bytes.begin(),
                 [](std::uint16_t v) { return static_cast<std::uint8_t>((v + 128) / 257); });
  APPLIQUE_TRY(const Buffer staging,
               make_buffer(device, "texture upload", bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT));
  APPLIQUE_CHECK(device.run([&](VkCommandBuffer commands) {
    transition(device, commands, texture, 0, info.levels, unused, copy_target);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {info.width, info.height, 1};
    device.functions().vkCmdCopyBufferToImage(commands, staging.handle(), texture.handle(),
                                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    fill_levels(device, commands, texture);
  }));
  return texture;
}

VkSamplerAddressMode address_mode(WrapMode mode) {
  switch (mode) {
    case WrapMode::clamp:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case WrapMode::mirror:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case WrapMode::repeat:
      break;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

bool has_odd_sides(const Image* image) {
  const auto is_odd = [](int side) { return !std::has_single_bit(static_cast<unsigned>(side)); };
  return image != nullptr && (is_odd(image->width) || is_odd(image->height));
}

// Whether no triangle is so long in the texture that many repeats of it may fall into a pixel.
bool repeats_seldom(const RenderMesh& mesh) {
  constexpr float most = 16;  // repeats along a side
  if (mesh.uvs.empty()) return true;
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& from = mesh.uvs[corners[k]];
      const auto& to = mesh.uvs[corners[(k + 1) % 3]];
      if (!(std::hypot(to[0] - from[0], to[1] - from[1]) < most)) return false;
    }
    return true;
  });
}

// Whether the device's anisotropic filter may show the meshes. Mesa's llvmpipe takes the wrong texels of
// textures whose sides are no powers of two, so that edges become stairs even where it magnifies them, and
// goes over all texels that fall into a pixel, which may take for ever. Without it for one, then without it
// for all: a surface looks the same through either.
bool filters_anisotropically(const Device& device, std::span<const RenderMesh> meshes) {
  return device.properties().deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU ||
         std::all_of(meshes.begin(), meshes.end(), [](const RenderMesh& mesh) {
           return !has_odd_sides(mesh.base_colour) && !has_odd_sides(mesh.metallic_roughness) &&
                  !has_odd_sides(mesh.normal) && !has_odd_sides(mesh.emissive) && repeats_seldom(mesh);
         });
}

Result<DeviceObject<VkSampler>> make_sampler(const Device& device, WrapMode u, WrapMode v, bool anisotropic) {
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(device.handles().physical, &features);
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = VK_FILTER_LINEAR;
  info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = address_mode(u);
  info.addressModeV = address_mode(v);
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.anisotropyEnable = anisotropic ? features.samplerAnisotropy : VK_FALSE;
  info.maxAnisotropy = std::min(8.0F, device.properties().limits.maxSamplerAnisotropy);
  info.maxLod = VK_LOD_CLAMP_NONE;
  DeviceObject<VkSampler> sampler;
  APPLIQUE_VK_CREATE(device, sampler, vkCreateSampler, vkDestroySampler, &info);
  return sampler;
}

// The multisampled picture and depth, and the picture that they are resolved into.
struct Target {
  GpuImage colour, depth, resolved;
  DeviceObject<VkRenderPass> pass;
  DeviceObject<VkFramebuffer> framebuffer;
};

VkFormat depth_format(const Device& device) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device.handles().physical, VK_FORMAT_D32_SFLOAT, &properties);
  const bool has = (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
  return has ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_X8_D24_UNORM_PACK32;  // One of them is always there.
}

Result<Target> make_target(const Device& device, VkExtent2D size) {
  Target target;
  GpuImageInfo info;
  info.name = "picture";
  info.width = size.width;
  info.height = size.height;
  info.format = colour_format;
  info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  APPLIQUE_TRY(target.resolved, GpuImage::create(device, info));
  info.name = "multisampled picture";
  info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  info.samples = samples;
  APPLIQUE_TRY(target.colour, GpuImage::create(device, info));
  info.name = "depth";
  info.format = depth_format(device);
  info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  info.aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
  APPLIQUE_TRY(target.depth, GpuImage::create(device, info));

  std::array<VkAttachmentDescription, 3> attachments{};
  attachments[0] = {0,
                    colour_format,
                    samples,
                    VK_ATTACHMENT_LOAD_OP_CLEAR,
                    VK_ATTACHMENT_STORE_OP_DONT_CARE,
                    VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                    VK_ATTACHMENT_STORE_OP_DONT_CARE,
                    VK_IMAGE_LAYOUT_UNDEFINED,
                    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  attachments[1] = attachments[0];
  attachments[1].format = info.format;
  attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  attachments[2] = attachments[0];
  attachments[2].samples = VK_SAMPLE_COUNT_1_BIT;
  attachments[2].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachments[2].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachments[2].finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolve{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pResolveAttachments = &resolve;
  subpass.pDepthStencilAttachment = &depth;
  VkSubpassDependency dependency{};
  dependency.srcSubpass = 0;
  dependency.dstSubpass = VK_SUBPASS_EXTERNAL;
  dependency.srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  dependency.dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependency.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  dependency.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  VkRenderPassCreateInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  pass.attachmentCount = static_cast<std::uint32_t>(attachments.size());
  pass.pAttachments = attachments.data();
  pass.subpassCount = 1;
  pass.pSubpasses = &subpass;
  pass.dependencyCount = 1;
  pass.pDependencies = &dependency;
  APPLIQUE_VK_CREATE(device, target.pass, vkCreateRenderPass, vkDestroyRenderPass, &pass);

  const std::array<VkImageView, 3> views = {target.colour.view(), target.depth.view(),
                                            target.resolved.view()};
  VkFramebufferCreateInfo framebuffer{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  framebuffer.renderPass = target.pass.get();
  framebuffer.attachmentCount = static_cast<std::uint32_t>(views.size());
  framebuffer.pAttachments = views.data();
  framebuffer.width = size.width;
  framebuffer.height = size.height;
  framebuffer.layers = 1;
  APPLIQUE_VK_CREATE(device, target.framebuffer, vkCreateFramebuffer, vkDestroyFramebuffer, &framebuffer);
  return target;
}

// What each mesh's shaders read: the frame and its textures.
struct Descriptors {
  DeviceObject<VkDescriptorSetLayout> set_layout;
  DeviceObject<VkPipelineLayout> layout;
  std::map<std::pair<const Image*, VkFormat>, GpuImage> textures;
  std::map<std::pair<WrapMode, WrapMode>, DeviceObject<VkSampler>> samplers;
  DeviceObject<VkDescriptorPool> pool;
  std::vector<VkDescriptorSet> sets;  // By mesh, and one more with white.
};

Result<Descriptors> make_descriptors(const Device& device, std::span<const RenderMesh> meshes,
                                     const Buffer& frame) {
  const VkDevice handle = device.handles().device;
  Descriptors result;
  std::array<VkDescriptorSetLayoutBinding, 1 + texture_count> bindings;
  bindings[0] = {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1,
                 VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  for (std::uint32_t k = 1; k <= texture_count; ++k)
    bindings[k] = {k, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  VkDescriptorSetLayoutCreateInfo set_layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_layout.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set_layout.pBindings = bindings.data();
  APPLIQUE_VK_CREATE(device, result.set_layout, vkCreateDescriptorSetLayout, vkDestroyDescriptorSetLayout,
                     &set_layout);
  const VkPushConstantRange push{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(shader::RenderDraw)};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = result.set_layout.address();
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  APPLIQUE_VK_CREATE(device, result.layout, vkCreatePipelineLayout, vkDestroyPipelineLayout, &layout);

  const auto count = static_cast<std::uint32_t>(meshes.size() + 1);
  const std::array<VkDescriptorPoolSize, 2> sizes = {
      {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, count},
       {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, texture_count * count}}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = count;
  pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  APPLIQUE_VK_CREATE(device, result.pool, vkCreateDescriptorPool, vkDestroyDescriptorPool, &pool);
  const std::vector<VkDescriptorSetLayout> layouts(count, result.set_layout.get());
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = result.pool.get();
  allocate.descriptorSetCount = count;
  allocate.pSetLayouts = layouts.data();
  result.sets.resize(count);
  APPLIQUE_VK(device, vkAllocateDescriptorSets, handle, &allocate, result.sets.data());

  const Image white = make_image(1, 1, {65535, 65535, 65535, 65535});
  const RenderMesh plain;
  const bool anisotropic = filters_anisotropically(device, meshes);
  for (std::size_t i = 0; i < count; ++i) {
    const RenderMesh& mesh = i < meshes.size() ? meshes[i] : plain;
    DeviceObject<VkSampler>& sampler = result.samplers[{mesh.wrap_u, mesh.wrap_v}];
    if (sampler.get() == VK_NULL_HANDLE) {
      APPLIQUE_TRY(sampler, make_sampler(device, mesh.wrap_u, mesh.wrap_v, anisotropic));
    }
    const VkDescriptorBufferInfo buffer{frame.handle(), 0, VK_WHOLE_SIZE};
    const std::array<std::pair<const Image*, VkFormat>, texture_count> wanted = {
        {{mesh.base_colour, colour_format},
         {mesh.metallic_roughness, data_format},
         {mesh.normal, data_format},
         {mesh.emissive, colour_format}}};
    std::array<VkDescriptorImageInfo, texture_count> infos{};
    for (std::size_t k = 0; k < texture_count; ++k) {
      const Image* image = mesh.uvs.empty() ? nullptr : wanted[k].first;
      const auto [texture, fresh] = result.textures.try_emplace({image, wanted[k].second});
      if (fresh) {
        APPLIQUE_TRY(texture->second,
                     upload_texture(device, image != nullptr ? *image : white, wanted[k].second));
      }
      infos[k] = {sampler.get(), texture->second.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    }
    std::array<VkWriteDescriptorSet, 1 + texture_count> writes{};
    for (std::uint32_t k = 0; k < writes.size(); ++k) {
      writes[k].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      writes[k].dstSet = result.sets[i];
      writes[k].dstBinding = k;
      writes[k].descriptorCount = 1;
      writes[k].descriptorType = bindings[k].descriptorType;
    }
    writes[0].pBufferInfo = &buffer;
    for (std::size_t k = 0; k < texture_count; ++k) writes[1 + k].pImageInfo = &infos[k];
    device.functions().vkUpdateDescriptorSets(handle, static_cast<std::uint32_t>(writes.size()),
                                              writes.data(), 0, nullptr);
  }
  return result;
}

// Opaque and masked meshes as given, then blended ones from far to near.
std::vector<std::size_t> draw_order(std::span<const RenderMesh> meshes, const Camera& camera) {
  std::vector<std::size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto distance = [&](const RenderMesh& mesh) {
    Vec3 sum = Vec3::Zero();
    for (const auto& position : mesh.positions) sum += to_vec3(position);
    return (sum / static_cast<double>(std::max<std::size_t>(mesh.positions.size(), 1)) - camera.eye).norm();
  };
  std::vector<double> far(meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    far[i] = meshes[i].alpha_mode == AlphaMode::blend ? -distance(meshes[i]) : -1e300;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return far[a] < far[b]; });
  return order;
}

Image to_image(std::span<const std::uint8_t> bytes, const RenderOptions& options) {
  Image image = make_image(options.width, options.height, {});
  image.channels = 3;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    image.rgba[i] = i % 4 == 3 ? std::uint16_t{65535} : static_cast<std::uint16_t>(bytes[i] * 257);
  }
  return image;
}

}  // namespace

Result<Image> render(const Device& device, std::span<const RenderMesh> meshes, const Camera& camera,
                     const RenderOptions& options) {
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  const auto most =
      std::min({limits.maxFramebufferWidth, limits.maxFramebufferHeight, limits.maxImageDimension2D});
  if (options.width < 1 || options.height < 1 ||
      static_cast<std::uint32_t>(std::max(options.width, options.height)) > most) {
    return fail(ErrorCode::device_failed,
                fmt::format("a picture of {} x {} pixels cannot be drawn; '{}' draws 1 to {}", options.width,
                            options.height, device.name(), most));
  }
  const VkExtent2D size{static_cast<std::uint32_t>(options.width),
                        static_cast<std::uint32_t>(options.height)};
  const Geometry geometry = pack_geometry(meshes);
  const std::vector<shader::RenderFrame> frames = {make_frame(meshes, camera, options)};
  APPLIQUE_TRY(const Buffer vertices,
               make_buffer(device, "vertices", geometry.vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT));
  APPLIQUE_TRY(const Buffer indices,
               make_buffer(device, "indices", geometry.triangles, VK_BUFFER_USAGE_INDEX_BUFFER_BIT));
  APPLIQUE_TRY(const Buffer frame, make_buffer(device, "frame", frames, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT));
  APPLIQUE_TRY(const Target target, make_target(device, size));
  APPLIQUE_TRY(const Descriptors descriptors, make_descriptors(device, meshes, frame));

  const auto make_pipeline = [&](const GraphicsPipelineInfo& info) {
    return make_graphics_pipeline(device, info, descriptors.layout.get(), target.pass.get(), size, samples);
  };
  APPLIQUE_TRY(
      const DeviceObject<VkPipeline> backdrop,
      make_pipeline({"backdrop", applique_spirv_backdrop_vertex, applique_spirv_backdrop_fragment, true}));
  std::map<std::pair<bool, bool>, DeviceObject<VkPipeline>> pipelines;  // By blend, double-sided.
  for (const RenderMesh& mesh : meshes) {
    DeviceObject<VkPipeline>& pipeline = pipelines[{mesh.alpha_mode == AlphaMode::blend, mesh.double_sided}];
    if (pipeline.get() != VK_NULL_HANDLE) continue;
    APPLIQUE_TRY(pipeline, make_pipeline({"mesh", applique_spirv_mesh_vertex, applique_spirv_mesh_fragment,
                                          false, mesh.alpha_mode == AlphaMode::blend, mesh.double_sided}));
  }

  std::vector<std::uint8_t> bytes(4 * static_cast<std::size_t>(size.width) * size.height);
  APPLIQUE_TRY(const Buffer readback,
               Buffer::create(device, "readback", bytes.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT));
  const VolkDeviceTable& vk = device.functions();
  APPLIQUE_CHECK(device.run([&](VkCommandBuffer commands) {
    std::array<VkClearValue, 2> clear{};
    clear[1].depthStencil.depth = 1;
    VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    begin.renderPass = target.pass.get();
    begin.framebuffer = target.framebuffer.get();
    begin.renderArea = {{0, 0}, size};
    begin.clearValueCount = static_cast<std::uint32_t>(clear.size());
    begin.pClearValues = clear.data();
    vk.vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    const auto bind = [&](VkPipeline pipeline, const VkDescriptorSet& set) {
      vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
      vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, descriptors.layout.get(), 0, 1,
                                 &set, 0, nullptr);
    };
    bind(backdrop.get(), descriptors.sets.back());
    vk.vkCmdDraw(commands, 3, 1, 0, 0);

    const VkDeviceSize start = 0;
    const VkBuffer vertex_buffer = vertices.handle();
    vk.vkCmdBindVertexBuffers(commands, 0, 1, &vertex_buffer, &start);
    vk.vkCmdBindIndexBuffer(commands, indices.handle(), 0, VK_INDEX_TYPE_UINT32);
    for (const std::size_t i : draw_order(meshes, camera)) {
      const RenderMesh& mesh = meshes[i];
      const DrawRange& range = geometry.ranges[i];
      if (range.indices == 0) continue;
      bind(pipelines.at({mesh.alpha_mode == AlphaMode::blend, mesh.double_sided}).get(), descriptors.sets[i]);
      const auto& glow = mesh.emissive_factor;
      const bool relief = mesh.normal != nullptr && !mesh.uvs.empty();
      const shader::RenderDraw draw{mesh.base_colour_factor,
                                    {glow[0], glow[1], glow[2], 0},
                                    mesh.alpha_cutoff,
                                    static_cast<std::uint32_t>(mesh.alpha_mode),
                                    mesh.metallic,
                                    mesh.roughness,
                                    relief ? mesh.normal_scale : 0};
      vk.vkCmdPushConstants(commands, descriptors.layout.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(draw),
                            &draw);
      vk.vkCmdDrawIndexed(commands, range.indices, 1, range.first_index, range.first_vertex, 0);
    }
    vk.vkCmdEndRenderPass(commands);

    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {size.width, size.height, 1};
    vk.vkCmdCopyImageToBuffer(commands, target.resolved.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                              readback.handle(), 1, &copy);
    VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                            &barrier, 0, nullptr, 0, nullptr);
  }));
  APPLIQUE_CHECK(readback.read(device, std::as_writable_bytes(std::span(bytes))));
  return to_image(bytes, options);
}

}  // namespace applique
