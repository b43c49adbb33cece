#include "applique/gpu/device.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "applique/gpu/pipeline_cache.h"

namespace applique {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

// Filled by the validation layers' callback, from any thread.
struct MessageLog {
  std::mutex mutex;
  std::vector<std::string> messages;
};

VKAPI_ATTR VkBool32 VKAPI_CALL collect_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto* log = static_cast<MessageLog*>(user);
  const std::lock_guard lock(log->mutex);
  log->messages.emplace_back(data->pMessage);
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(MessageLog* log) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = collect_message;
  info.pUserData = log;
  return info;
}

bool has_validation_layer() {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, validation_layer) == 0;
  });
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

int rank_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 1;
  }
}

std::optional<std::uint32_t> find_queue_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((families[i].queueFlags & needed) == needed) return i;
  }
  return std::nullopt;
}

// Why a device cannot be used; empty if it can.
std::string reason_against(VkPhysicalDevice physical, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_1) return "it has no Vulkan 1.1";
  if (!find_queue_family(physical)) return "it has no queue for both graphics and compute";
  return {};
}

struct Choice {
  VkPhysicalDevice physical;
  VkPhysicalDeviceProperties properties;
};

tl::unexpected<Error> no_device_present() {
  return fail(
      ErrorCode::no_device,
      "no Vulkan device is present; install a driver (the package mesa-vulkan-drivers has a software one)");
}

Result<Choice> choose_device(VkInstance instance, const std::string& selector) {
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance, &count, devices.data());
  const bool by_index = !selector.empty() && std::all_of(selector.begin(), selector.end(),
                                                         [](unsigned char c) { return std::isdigit(c); });
  std::optional<Choice> best;
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    const std::string name = properties.deviceName;
    const bool wanted =
        selector.empty() || (by_index ? selector == std::to_string(i)
                                      : lower_case(name).find(lower_case(selector)) != std::string::npos);
    const std::string reason =
        wanted ? reason_against(devices[i], properties) : "it is not the one asked for";
    if (!reason.empty()) {
      reasons.push_back(fmt::format("{} '{}': {}", i, name, reason));
    } else if (!best || rank_of(properties.deviceType) > rank_of(best->properties.deviceType)) {
      best = Choice{devices[i], properties};
    }
  }
  if (best) return *best;
  if (devices.empty()) return no_device_present();
  const std::string asked =
      selector.empty() ? "no Vulkan device fits" : fmt::format("no Vulkan device is '{}'", selector);
  return fail(ErrorCode::no_device, fmt::format("{}: {}", asked, fmt::join(reasons, "; ")));
}

}  // namespace

// The instance and device are owned here; everything else works on `handles` alone.
struct Device::State {
  DeviceHandles handles;
  VolkDeviceTable functions{};
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  std::string name;
  VkCommandPool command_pool = VK_NULL_HANDLE;
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;
  std::size_t stored_cache_size = 0;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  // This instance's own: volk's globals are those of the instance made last, which may lack the extension.
  PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name = nullptr;
  bool debug_utils = false;
  MessageLog log;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();

  Result<void> create_instance(bool validation);
  Result<void> create_device(const Choice& choice);
  void save_pipeline_cache();
};

Device::State::~State() {
  if (handles.device != VK_NULL_HANDLE) {
    functions.vkDeviceWaitIdle(handles.device);
    if (pipeline_cache != VK_NULL_HANDLE) save_pipeline_cache();
    functions.vkDestroyPipelineCache(handles.device, pipeline_cache, nullptr);
    functions.vkDestroyCommandPool(handles.device, command_pool, nullptr);
    functions.vkDestroyDevice(handles.device, nullptr);
  }
  if (messenger != VK_NULL_HANDLE) destroy_messenger(handles.instance, messenger, nullptr);
  if (handles.instance != VK_NULL_HANDLE) vkDestroyInstance(handles.instance, nullptr);
}

Result<void> Device::State::create_instance(bool validation) {
  if (volkInitialize() != VK_SUCCESS) {
    return fail(ErrorCode::no_device, "the Vulkan loader (libvulkan.so.1) is not installed");
  }
  validation = validation && has_validation_layer();
  debug_utils = validation;
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "applique";
  application.apiVersion = VK_API_VERSION_1_1;
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkDebugUtilsMessengerCreateInfoEXT messages = messenger_info(&log);
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (validation) {
    info.pNext = &messages;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
  }
  if (const VkResult result = vkCreateInstance(&info, nullptr, &handles.instance); result != VK_SUCCESS) {
    handles.instance = VK_NULL_HANDLE;
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return no_device_present();
    return fail(ErrorCode::no_device,
                fmt::format("vkCreateInstance failed with {}; check the Vulkan drivers with "
                            "vulkaninfo",
                            static_cast<int>(result)));
  }
  volkLoadInstanceOnly(handles.instance);
  if (validation) {
    vkCreateDebugUtilsMessengerEXT(handles.instance, &messages, nullptr, &messenger);
    destroy_messenger = vkDestroyDebugUtilsMessengerEXT;
    set_object_name = vkSetDebugUtilsObjectNameEXT;
  }
  return {};
}

Result<void> Device::State::create_device(const Choice& choice) {
  handles.physical = choice.physical;
  handles.queue_family = *find_queue_family(choice.physical);
  properties = choice.properties;
  name = properties.deviceName;
  vkGetPhysicalDeviceMemoryProperties(handles.physical, &memory);

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = handles.queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceFeatures available{}, features{};
  vkGetPhysicalDeviceFeatures(handles.physical, &available);
  features.samplerAnisotropy = available.samplerAnisotropy;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.pEnabledFeatures = &features;
  if (const VkResult result = vkCreateDevice(handles.physical, &info, nullptr, &handles.device);
      result != VK_SUCCESS) {
    handles.device = VK_NULL_HANDLE;
    return device_failure("vkCreateDevice", result);
  }
  volkLoadDeviceTable(&functions, handles.device);
  functions.vkGetDeviceQueue(handles.device, handles.queue_family, 0, &handles.queue);

  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool.queueFamilyIndex = handles.queue_family;
  if (const VkResult result = functions.vkCreateCommandPool(handles.device, &pool, nullptr, &command_pool);
      result != VK_SUCCESS) {
    return device_failure("vkCreateCommandPool", result);
  }
  const std::vector<std::uint8_t> stored = read_pipeline_cache(pipeline_cache_path(properties), properties);
  stored_cache_size = stored.size();
  VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  cache.initialDataSize = stored.size();
  cache.pInitialData = stored.data();
  if (const VkResult result =
          functions.vkCreatePipelineCache(handles.device, &cache, nullptr, &pipeline_cache);
      result != VK_SUCCESS) {
    return device_failure("vkCreatePipelineCache", result);
  }
  return {};
}

void Device::State::save_pipeline_cache() {
  const std::filesystem::path path = pipeline_cache_path(properties);
  std::size_t size = 0;
  if (path.empty() ||
      functions.vkGetPipelineCacheData(handles.device, pipeline_cache, &size, nullptr) != VK_SUCCESS ||
      size == stored_cache_size) {
    return;
  }
  std::vector<std::uint8_t> bytes(size);
  if (functions.vkGetPipelineCacheData(handles.device, pipeline_cache, &size, bytes.data()) != VK_SUCCESS)
    return;
  bytes.resize(size);
  write_pipeline_cache(path, bytes);
}

bool validation_wanted() {
  const char* value = std::getenv("APPLIQUE_VALIDATION");
  return value && std::strcmp(value, "1") == 0;
}

Device::Device(std::unique_ptr<State> state) : state_(std::move(state)) {}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

Result<Device> Device::create(const DeviceRequest& request) {
  auto state = std::make_unique<State>();
  APPLIQUE_CHECK(state->create_instance(request.validation));
  APPLIQUE_TRY(const Choice choice, choose_device(state->handles.instance, request.selector));
  APPLIQUE_CHECK(state->create_device(choice));
  return Device(std::move(state));
}

const std::string& Device::name() const {
  return state_->name;
}
const VkPhysicalDeviceProperties& Device::properties() const {
  return state_->properties;
}
const VkPhysicalDeviceMemoryProperties& Device::memory() const {
  return state_->memory;
}
const DeviceHandles& Device::handles() const {
  return state_->handles;
}
const VolkDeviceTable& Device::functions() const {
  return state_->functions;
}
VkPipelineCache Device::pipeline_cache() const {
  return state_->pipeline_cache;
}

std::vector<std::string> Device::validation_messages() const {
  const std::lock_guard lock(state_->log.mutex);
  return state_->log.messages;
}

Result<void> Device::run(const std::function<void(VkCommandBuffer)>& record) const {
  const VkDevice device = state_->handles.device;
  const VolkDeviceTable& vk = state_->functions;
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = state_->command_pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  APPLIQUE_VK(*this, vkAllocateCommandBuffers, device, &allocate, &commands);
  VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence fence = VK_NULL_HANDLE;
  VkResult result = vk.vkCreateFence(device, &fence_info, nullptr, &fence);
  if (result == VK_SUCCESS) {
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    result = vk.vkBeginCommandBuffer(commands, &begin);
  }
  if (result == VK_SUCCESS) {
    record(commands);
    result = vk.vkEndCommandBuffer(commands);
  }
  if (result == VK_SUCCESS) {
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    result = vk.vkQueueSubmit(state_->handles.queue, 1, &submit, fence);
  }
  if (result == VK_SUCCESS) result = vk.vkWaitForFences(device, 1, &fence, VK_TRUE, UINT64_MAX);
  vk.vkDestroyFence(device, fence, nullptr);
  vk.vkFreeCommandBuffers(device, state_->command_pool, 1, &commands);
  if (result != VK_SUCCESS) return device_failure("running commands", result);
  return {};
}

void Device::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
  if (!state_->debug_utils) return;
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = name.c_str();
  state_->set_object_name(state_->handles.device, &info);
}

tl::unexpected<Error> device_failure(const char* call, VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return fail(
          ErrorCode::device_failed,
          fmt::format("{}: the Vulkan device is out of memory; use a smaller texture or image, or another "
                      "device",
                      call));
    case VK_ERROR_DEVICE_LOST:
      return fail(ErrorCode::device_failed,
                  fmt::format("{}: the Vulkan device was lost; try again, or use another device", call));
    default:
      return fail(ErrorCode::device_failed,
                  fmt::format("{}: failed with VkResult {}", call, static_cast<int>(result)));
  }
}

Result<std::uint32_t> find_memory_type(const Device& device, std::uint32_t allowed,
                                       VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred) {
  const VkPhysicalDeviceMemoryProperties& memory = device.memory();
  for (const VkMemoryPropertyFlags flags : {required | preferred, required}) {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      if ((allowed >> i & 1) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  return fail(ErrorCode::device_failed, "the Vulkan device has no memory of the kind that is needed");
}

}  // namespace applique
