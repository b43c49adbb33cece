#include "applique/image/image.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

namespace applique {
namespace {

// No texture or picture comes near; a header that claims more is broken or hostile.
constexpr int largest_side = 32768;
constexpr std::int64_t most_pixels = std::int64_t{1} << 28;

// The fastest level, since the file is an output of a quick command; the filter (libpng's
// PNG_FILTER_SUB) costs nothing and takes a fifth off photographs.
constexpr int png_level = 1;
constexpr int png_filter_sub = 0x10;

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// OpenImageIO's reader for these bytes: by the first bytes, or by the file's extension for formats that have
/// no signature.
std::string reader_of(std::span<const std::uint8_t> bytes, const std::string& name) {
  using namespace std::string_view_literals;
  static constexpr std::pair<std::string_view, const char*> signatures[] = {
      {"\x89PNG"sv, "png"}, {"\xff\xd8\xff"sv, "jpeg"}, {"RIFF"sv, "webp"}, {"II*\0"sv, "tiff"},
      {"MM\0*"sv, "tiff"},  {"GIF8"sv, "gif"},          {"BM"sv, "bmp"},
  };
  for (const auto& [signature, reader] : signatures) {
    if (starts_with(bytes, signature)) return reader;
  }
  const std::string extension = std::filesystem::path(name).extension().string();
  return extension.empty() ? "" : extension.substr(1);
}

/// The last line of OpenImageIO's message for `input`; it may be empty.
std::string reason_of(const OIIO::ImageInput& input) {
  std::string reason = input.geterror();
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  while (!reason.empty() && (reason.back() == ' ' || reason.back() == '.')) reason.pop_back();
  return reason.empty() ? "the data is broken" : reason;
}

template <class Stored>
void spread(const std::vector<Stored>& stored, int channels, std::vector<std::uint16_t>& rgba) {
  constexpr std::uint16_t scale = sizeof(Stored) == 1 ? 257 : 1;
  const bool grey = channels < 3;
  const bool alpha = channels == 2 || channels == 4;
  const std::size_t pixels = rgba.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const Stored* in = &stored[i * static_cast<std::size_t>(channels)];
    std::uint16_t* out = &rgba[4 * i];
    for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint16_t>(in[grey ? 0 : k] * scale);
    out[3] = alpha ? static_cast<std::uint16_t>(in[channels - 1] * scale) : std::uint16_t{0xffff};
  }
}

template <class Stored>
bool read_pixels(OIIO::ImageInput& input, OIIO::TypeDesc type, Image& image) {
  std::vector<Stored> stored(static_cast<std::size_t>(image.width) * image.height * image.channels);
  if (!input.read_image(0, 0, 0, image.channels, type, stored.data())) return false;
  image.rgba.resize(4 * static_cast<std::size_t>(image.width) * image.height);
  spread(stored, image.channels, image.rgba);
  return true;
}

template <class Stored>
std::vector<Stored> gather(const Image& image) {
  constexpr int shift = sizeof(Stored) == 1 ? 8 : 0;
  const bool grey = image.channels < 3;
  const std::size_t pixels = image.rgba.size() / 4;
  std::vector<Stored> stored;
  stored.resize(pixels * static_cast<std::size_t>(image.channels));
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t* in = &image.rgba[4 * i];
    Stored* out = &stored[i * static_cast<std::size_t>(image.channels)];
    for (int k = 0; k < (grey ? 1 : 3); ++k) out[k] = static_cast<Stored>(in[k] >> shift);
    if (image.has_alpha()) out[image.channels - 1] = static_cast<Stored>(in[3] >> shift);
  }
  return stored;
}

}  // namespace

Image make_image(int width, int height, std::array<std::uint16_t, 4> colour) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.resize(4 * static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = colour[i % 4];
  return image;
}

Result<Image> read_image(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  const auto unreadable = [&](int cause) {
    return fail(ErrorCode::file_unreadable,
                fmt::format("image '{}' cannot be read: {}", path.string(), std::strerror(cause)));
  };
  if (!file) return unreadable(errno);
  std::vector<std::uint8_t> bytes;
  std::error_code no_size;
  const auto size = std::filesystem::file_size(path, no_size);
  if (!no_size) bytes.reserve(static_cast<std::size_t>(size));
  std::vector<std::uint8_t> block(std::size_t{1} << 16);
  while (const std::size_t read = std::fread(block.data(), 1, block.size(), file.get())) {
    bytes.insert(bytes.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(read));
  }
  if (std::ferror(file.get())) return unreadable(errno);
  return decode_image(bytes, path.string());
}

namespace {

/// Without `pixels`, the image's `rgba` stays empty.
Result<Image> decode(std::span<const std::uint8_t> bytes, const std::string& name, bool pixels) {
  const auto invalid = [&](const std::string& reason) {
    return fail(ErrorCode::image_invalid, fmt::format("image '{}': {}", name, reason));
  };
  if (bytes.empty()) return invalid("the file is empty");
  if (starts_with(bytes, "\xabKTX")) {
    return invalid("KTX textures cannot be read; convert it to PNG, JPEG or WebP");
  }
  const std::string reader = reader_of(bytes, name);
  const std::unique_ptr<OIIO::ImageInput> input = reader.empty() ? nullptr : OIIO::ImageInput::create(reader);
  if (!input || !input->supports("ioproxy")) {
    (void)OIIO::geterror();  // It keeps a message for this thread until someone takes it.
    return invalid("not an image format that can be read; use PNG, JPEG, WebP or TIFF");
  }

  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  OIIO::Filesystem::IOProxy* proxy = &memory;
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  wishes.attribute("oiio:UnassociatedAlpha", 1);  // Colour stays straight, as stored.
  OIIO::ImageSpec spec;
  if (!input->open(name, spec, wishes)) return invalid(reason_of(*input));

  if (spec.width < 1 || spec.height < 1 || spec.depth > 1) return invalid("not a flat image");
  if (spec.width > largest_side || spec.height > largest_side ||
      std::int64_t{spec.width} * spec.height > most_pixels) {
    return invalid(fmt::format("{} x {} pixels are too many; the most is {} a side and {} in all", spec.width,
                               spec.height, largest_side, most_pixels));
  }
  if (spec.nchannels < 1 || spec.nchannels > 4) {
    return invalid(
        fmt::format("{} channels; 1 to 4 can be used (grey, grey + alpha, RGB, RGBA)", spec.nchannels));
  }
  const bool wide = spec.format == OIIO::TypeDesc::UINT16;
  if (!wide && spec.format != OIIO::TypeDesc::UINT8) {
    return invalid(
        fmt::format("its values are of type {}; 8-bit and 16-bit integers can be used", spec.format.c_str()));
  }
  Image image;
  image.width = spec.width;
  image.height = spec.height;
  image.channels = spec.nchannels;
  image.bits = wide ? 16 : 8;
  if (!pixels) return image;
  const bool done = wide ? read_pixels<std::uint16_t>(*input, OIIO::TypeDesc::UINT16, image)
                         : read_pixels<std::uint8_t>(*input, OIIO::TypeDesc::UINT8, image);
  if (!done) return invalid(reason_of(*input));
  return image;
}

}  // namespace

Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  return decode(bytes, name, true);
}

Result<std::array<int, 2>> image_size(std::span<const std::uint8_t> bytes, const std::string& name) {
  APPLIQUE_TRY(const Image image, decode(bytes, name, false));
  return std::array{image.width, image.height};
}

Result<std::vector<std::uint8_t>> encode_png(const Image& image) {
  APPLIQUE_ASSERT(image.rgba.size() == 4 * static_cast<std::size_t>(image.width) * image.height);
  const bool wide = image.bits == 16;
  const OIIO::TypeDesc type = wide ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  spec.alpha_channel = image.has_alpha() ? image.channels - 1 : -1;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("png:compressionLevel", png_level);
  spec.attribute("png:filter", png_filter_sub);
  std::vector<std::uint8_t> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
  const bool done = output && output->open("texture.png", spec) &&
                    (wide ? output->write_image(type, gather<std::uint16_t>(image).data())
                          : output->write_image(type, gather<std::uint8_t>(image).data())) &&
                    output->close();
  if (!done) {
    return fail(ErrorCode::output_unwritable,
                fmt::format("PNG cannot be encoded: {}", output ? output->geterror() : OIIO::geterror()));
  }
  return bytes;
}

}  // namespace applique
