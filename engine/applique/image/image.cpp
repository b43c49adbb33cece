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

#include "applique/image/float_image.h"
#include "applique/image/webp.h"

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
      {"\x89PNG"sv, "png"},     {"\xff\xd8\xff"sv, "jpeg"}, {"II*\0"sv, "tiff"},
      {"MM\0*"sv, "tiff"},      {"GIF8"sv, "gif"},          {"BM"sv, "bmp"},
      {"v/1\x01"sv, "openexr"}, {"#?RADIANCE"sv, "hdr"},    {"#?RGBE"sv, "hdr"},
  };
  for (const auto& [signature, reader] : signatures) {
    if (starts_with(bytes, signature)) return reader;
  }
  const std::string extension = std::filesystem::path(name).extension().string();
  return extension.empty() ? "" : extension.substr(1);
}

/// Whether a PNG ends in the middle of a chunk. To be known before libpng finds it, which says so on the
/// standard error.
bool is_cut_off_png(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t signature = 8, frame = 12;  // A chunk's length, type and checksum.
  std::size_t at = signature;
  while (at < bytes.size()) {
    if (bytes.size() - at < frame) return true;
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | bytes[at + i];
    if (starts_with(bytes.subspan(at + 4), "IEND")) return false;
    if (length > bytes.size() - at - frame) return true;
    at += frame + length;
  }
  return false;
}

/// The first line of OpenImageIO's message for `input`: later ones say it again.
std::string reason_of(const OIIO::ImageInput& input) {
  std::string reason = input.geterror();
  reason.resize(std::min(reason.find('\n'), reason.size()));
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

/// How many of the first channels are the picture: colour and alpha come first, whatever else the file has
/// (depth, ids) later. 0: none that can be used.
int picture_channels(const OIIO::ImageSpec& spec) {
  const auto named = [&](std::size_t i, const char* name) {
    return spec.channelnames.size() > i && spec.channelnames[i] == name;
  };
  if (named(0, "R") && named(1, "G") && named(2, "B")) return named(3, "A") ? 4 : 3;
  if (named(0, "Y")) return named(1, "A") ? 2 : 1;
  return spec.nchannels >= 1 && spec.nchannels <= 4 ? spec.nchannels : 0;
}

void multiply_alpha(std::vector<float>& values, std::size_t channels) {
  for (std::size_t i = 0; i < values.size(); i += channels)
    for (std::size_t k = i; k + 1 < i + channels; ++k) values[k] *= values[i + channels - 1];
}

/// Floats fill the picture's frame, of which the file may hold a part only, or more.
Result<Image> read_floats(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, int channels,
                          const std::string& name, Floats floats) {
  const auto width = static_cast<std::size_t>(spec.width), count = static_cast<std::size_t>(channels);
  std::vector<float> stored(width * spec.height * count);
  if (!input.read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, stored.data()))
    return fail(ErrorCode::image_invalid, fmt::format("image '{}': {}", name, reason_of(input)));
  if (channels % 2 == 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") != 0)
    multiply_alpha(stored, count);
  const int frame_width = spec.full_width, frame_height = spec.full_height;
  if (spec.x == spec.full_x && spec.y == spec.full_y && spec.width == frame_width &&
      spec.height == frame_height)
    return image_of_floats(spec.width, spec.height, channels, stored, floats);
  APPLIQUE_CHECK(check_image_size(frame_width, frame_height, name));
  std::vector<float> frame(static_cast<std::size_t>(frame_width) * frame_height * count, 0.0F);
  const int left = spec.x - spec.full_x, top = spec.y - spec.full_y;
  for (int y = std::max(0, top); y < std::min(frame_height, top + spec.height); ++y)
    for (int x = std::max(0, left); x < std::min(frame_width, left + spec.width); ++x) {
      const auto from = static_cast<std::size_t>(y - top) * width + static_cast<std::size_t>(x - left);
      const auto to = static_cast<std::size_t>(y) * frame_width + static_cast<std::size_t>(x);
      std::copy_n(&stored[from * count], count, &frame[to * count]);
    }
  return image_of_floats(frame_width, frame_height, channels, frame, floats);
}

/// Divides colours by the alpha that is multiplied into them.
void make_straight(Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const std::uint32_t alpha = image.rgba[i + 3];
    if (alpha == 0) continue;
    for (std::size_t k = i; k < i + 3; ++k)
      image.rgba[k] =
          static_cast<std::uint16_t>(std::min((image.rgba[k] * 0xffffU + alpha / 2) / alpha, 0xffffU));
  }
}

template <class Stored>
std::vector<Stored> gather(const Image& image) {
  const auto store = [](std::uint16_t value) {
    if constexpr (sizeof(Stored) == 1)
      return to_8_bits(value);
    else
      return value;
  };
  const bool grey = image.channels < 3;
  const std::size_t pixels = image.rgba.size() / 4;
  std::vector<Stored> stored;
  stored.resize(pixels * static_cast<std::size_t>(image.channels));
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t* in = &image.rgba[4 * i];
    Stored* out = &stored[i * static_cast<std::size_t>(image.channels)];
    for (int k = 0; k < (grey ? 1 : 3); ++k) out[k] = store(in[k]);
    if (image.has_alpha()) out[image.channels - 1] = store(in[3]);
  }
  return stored;
}

/// Writes the image's channels in memory by OpenImageIO's encoder `format`, set up by `spec`.
Result<std::vector<std::uint8_t>> encode(const Image& image, const char* format, OIIO::ImageSpec spec) {
  APPLIQUE_ASSERT(image.rgba.size() == 4 * static_cast<std::size_t>(image.width) * image.height);
  spec.alpha_channel = image.has_alpha() ? image.channels - 1 : -1;
  std::vector<std::uint8_t> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
  const bool done = output && output->open(fmt::format("texture.{}", format), spec) &&
                    (spec.format == OIIO::TypeDesc::UINT16
                         ? output->write_image(spec.format, gather<std::uint16_t>(image).data())
                         : output->write_image(spec.format, gather<std::uint8_t>(image).data())) &&
                    output->close();
  if (!done) {
    return fail(ErrorCode::output_unwritable, fmt::format("{} cannot be encoded: {}", format,
                                                          output ? output->geterror() : OIIO::geterror()));
  }
  return bytes;
}

}  // namespace

bool has_transparency(const Image& image) {
  if (!image.has_alpha()) return false;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 0xffff) return true;
  return false;
}

Result<void> check_image_size(std::int64_t width, std::int64_t height, const std::string& name) {
  if (width <= largest_side && height <= largest_side && width * height <= most_pixels) return {};
  return fail(ErrorCode::image_invalid,
              fmt::format("image '{}': {} x {} pixels are too many; the most is {} a side and {} in all",
                          name, width, height, largest_side, most_pixels));
}

Image make_image(int width, int height, std::array<std::uint16_t, 4> colour) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.resize(4 * static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = colour[i % 4];
  return image;
}

Result<Image> read_image(const std::filesystem::path& path, Floats floats) {
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
  return decode_image(bytes, path.string(), floats);
}

namespace {

/// Without `pixels`, the image's `rgba` may stay empty.
Result<Image> decode(std::span<const std::uint8_t> bytes, const std::string& name, Floats floats,
                     bool pixels) {
  const auto invalid = [&](const std::string& reason) {
    return fail(ErrorCode::image_invalid, fmt::format("image '{}': {}", name, reason));
  };
  if (bytes.empty()) return invalid("the file is empty");
  if (starts_with(bytes, "\xabKTX")) {
    return invalid(
        "KTX textures cannot be read; convert it to PNG, for instance with `ktx extract` of KTX-Software, "
        "or, "
        "in a model, with `gltf-transform ktxdecompress`");
  }
  if (starts_with(bytes, "DDS ")) return invalid("DDS textures cannot be read; convert it to PNG");
  if (starts_with(bytes, "RIFF")) return decode_webp(bytes, name);
  const std::string reader = reader_of(bytes, name);
  const std::unique_ptr<OIIO::ImageInput> input = reader.empty() ? nullptr : OIIO::ImageInput::create(reader);
  if (!input || !input->supports("ioproxy")) {
    (void)OIIO::geterror();  // It keeps a message for this thread until someone takes it.
    return invalid("not an image format that can be read; use PNG, JPEG, WebP, TIFF, OpenEXR or HDR");
  }

  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  OIIO::Filesystem::IOProxy* proxy = &memory;
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  wishes.attribute("oiio:UnassociatedAlpha", 1);  // Colour stays straight, as stored.
  OIIO::ImageSpec spec;
  if (!input->open(name, spec, wishes)) return invalid(reason_of(*input));

  if (spec.width < 1 || spec.height < 1 || spec.depth > 1) return invalid("not a flat image");
  APPLIQUE_CHECK(check_image_size(spec.width, spec.height, name));
  const int channels = picture_channels(spec);
  if (channels == 0) {
    return invalid(
        fmt::format("{} channels; 1 to 4 can be used (grey, grey + alpha, RGB, RGBA)", spec.nchannels));
  }
  if (spec.format.is_floating_point()) return read_floats(*input, spec, channels, name, floats);
  const bool wide = spec.format == OIIO::TypeDesc::UINT16;
  if (!wide && spec.format != OIIO::TypeDesc::UINT8) {
    return invalid(fmt::format("its values are of type {}; 8-bit and 16-bit integers and floats can be used",
                               spec.format.c_str()));
  }
  Image image;
  image.width = spec.width;
  image.height = spec.height;
  image.channels = channels;
  image.bits = wide ? 16 : 8;
  if (!pixels) return image;
  if (reader == "png" && is_cut_off_png(bytes)) return invalid("the file is cut off; get a whole copy of it");
  const bool done = wide ? read_pixels<std::uint16_t>(*input, OIIO::TypeDesc::UINT16, image)
                         : read_pixels<std::uint8_t>(*input, OIIO::TypeDesc::UINT8, image);
  if (!done) return invalid(reason_of(*input));
  // Of the formats that are left, only TIFF may have alpha multiplied in.
  if (reader == "tiff" && image.has_alpha() && spec.get_int_attribute("oiio:UnassociatedAlpha") == 0)
    make_straight(image);
  return image;
}

}  // namespace

Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name, Floats floats) {
  return decode(bytes, name, floats, true);
}

Result<std::array<int, 2>> image_size(std::span<const std::uint8_t> bytes, const std::string& name) {
  APPLIQUE_TRY(const Image image, decode(bytes, name, Floats::light, false));
  return std::array{image.width, image.height};
}

Result<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const OIIO::TypeDesc type = image.bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("png:compressionLevel", png_level);
  spec.attribute("png:filter", png_filter_sub);
  return encode(image, "png", std::move(spec));
}

Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image, int quality) {
  Image opaque = image;
  if (opaque.has_alpha()) --opaque.channels;
  OIIO::ImageSpec spec(opaque.width, opaque.height, opaque.channels, OIIO::TypeDesc::UINT8);
  spec.attribute("compression", fmt::format("jpeg:{}", quality));
  spec.attribute("jpeg:subsampling", "4:4:4");
  return encode(opaque, "jpeg", std::move(spec));
}

}  // namespace applique
